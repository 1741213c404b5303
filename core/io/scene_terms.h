// The terms that native scene files and extras.umbra of glTF files write alike. Internal to core.
#pragma once

#include <string_view>
#include <vector>

#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// A number for grey, [r, g, b] in linear light, or "#rrggbb" in sRGB.
[[nodiscard]] vec3 read_colour(const JsonText& json, const JsonValue& v, std::string_view what);
[[nodiscard]] vec3 colour_or(const JsonText& json, const JsonFields& fields, std::string_view key, vec3 fallback);

/// [c1, c2, c3], not all of them 0; clamped. Or "photometric": 1 / d^2, not clamped.
[[nodiscard]] Attenuation read_attenuation(const JsonText& json, const JsonValue& v);

/// [width, height] in pixels.
void read_picture_size(const JsonText& json, const JsonValue& v, Scene& scene);

/// The keys of a material, and their meaning; a term that is not given keeps its value.
[[nodiscard]] const std::vector<std::string_view>& material_keys();
void apply_material_terms(const JsonText& json, const JsonFields& fields, Material& material);

/// The keys of kObjectSwitches; a switch that is not given keeps its value.
void apply_object_switches(const JsonFields& fields, ObjectSwitches& switches);

/// ambient, background, tone, exposure, viewer, the variants of the sum, and fog; a term that is not given keeps its
/// value.
void apply_picture_terms(const JsonText& json, const JsonFields& fields, Scene& scene);

}  // namespace umbra
