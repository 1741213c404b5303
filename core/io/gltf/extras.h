// Terms that glTF lacks, from `extras.umbra`: Phong terms, area lights, and terms of the whole scene. Internal to core.
#pragma once

#include <optional>

#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// The object extras.umbra of a glTF object, or null.
[[nodiscard]] const JsonValue* find_umbra(const JsonValue& object);
/// That of the scene that the file shows.
[[nodiscard]] const JsonValue* find_scene_umbra(const JsonText& json);

// Each refuses keys that it does not know, and changes only the terms that are given.
void apply_material_extras(const JsonText& json, const JsonValue& umbra, Material& material);
void apply_light_extras(const JsonText& json, const JsonValue& umbra, Light& light);

struct NodeExtras {
    std::optional<Light> light;  ///< a rectangle, disk or sphere that `transform` places
    ObjectSwitches switches{};   ///< of the node's mesh
};
/// Refuses switches where there is no mesh to apply them to.
[[nodiscard]] NodeExtras read_node_extras(const JsonText& json, const JsonValue& umbra, const dmat4& transform,
                                          bool has_mesh);

struct SceneExtras {
    bool ambient  = false;
    bool exposure = false;
};
/// Returns which terms were given.
SceneExtras apply_scene_extras(const JsonText& json, const JsonValue& umbra, Scene& scene);

}  // namespace umbra
