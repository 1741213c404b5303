#include "umbra/core/io/gltf/lights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/gltf/extras.h"
#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/scene/names.h"

namespace umbra {
namespace {

// Exporters write pi/2 with few digits, and equal angles for a hard edge.
constexpr Range kWrittenConeAngle{kConeAngleRadians.min, 1.571, kConeAngleRadians.words};
// They also write the largest float, or 0, for a light without a limit.
constexpr Range kWrittenRange{0, HUGE_VAL, "a number of at least 0"};
constexpr double kSameAngle = 1e-6;  ///< relative

void read_cone(const JsonText& json, const JsonValue& spot, std::string_view what, Spot& cone, GltfNotes& notes) {
    (void)json.object(spot, "spot");
    double outer       = number_or(json, &spot, "outerConeAngle", kWrittenConeAngle, kPi / 4);
    const double inner = number_or(json, &spot, "innerConeAngle", kNotNegative, 0);
    if (outer > kConeAngleRadians.max) ++notes.wide_spots, outer = kConeAngleRadians.max;
    cone.falloff = SpotFalloff::smooth;
    cone.cutoff  = static_cast<float>(outer);
    cone.inner   = static_cast<float>(inner);
    if (inner < outer * (1 - kSameAngle)) return;
    if (inner > outer * (1 + kSameAngle))
        json.fail(spot,
                  fmt::format("{}: innerConeAngle {:g} is not less than outerConeAngle {:g}", what, inner, outer));
    ++notes.hard_spots;
    cone.inner = cone.cutoff;
}

/// The extension divides by max(0.001, cos inner - cos outer), SpotFalloff::smooth by the difference alone. Where that
/// is less than 0.001 the inner angle moves inwards until it is; where no angle is far enough inside, the light has its
/// inner angle at the axis and less of its intensity.
void widen_ramp(Light& light) {
    constexpr double kLeast = 1e-3;
    const double cos_outer  = std::cos(static_cast<double>(light.spot.cutoff));
    const double cos_inner  = std::cos(static_cast<double>(light.spot.inner));
    if (light.spot.inner == light.spot.cutoff || cos_inner - cos_outer >= kLeast) return;
    const double share = std::min(1.0, (1 - cos_outer) / kLeast);
    light.spot.inner   = static_cast<float>(std::acos(std::min(1.0, cos_outer + kLeast)));
    light.diffuse *= static_cast<float>(share * share);
    light.specular *= static_cast<float>(share * share);
}

/// Sets the name; returns the key "type", or null.
const JsonValue* start_light(const JsonText& json, const JsonValue& v, std::string_view what, Light& light) {
    (void)json.object(v, what);
    light.name = name_or(json, v, "");
    return find_member(v, "type");
}

}  // namespace

std::optional<Light> read_punctual_light(const JsonText& json, const JsonValue& v, std::size_t index, GltfNotes& notes,
                                         std::vector<std::string>& warnings) {
    const auto what = fmt::format("lights[{}]", index);
    Light light;
    const JsonValue* type = start_light(json, v, what, light);
    if (!type) json.fail(v, what + " has no type, expected directional, point or spot");
    const std::string& kind = json.string(*type, "type");
    static constexpr std::array kKinds{LightKind::directional, LightKind::point, LightKind::spot};
    const auto known = std::find_if(kKinds.begin(), kKinds.end(), [&](LightKind k) { return name_of(k) == kind; });
    if (known == kKinds.end()) {
        warnings.push_back(
            fmt::format("{} \"{}\" is of the unknown type \"{:.40}\" (known: directional, point, spot): "
                        "it is left out.",
                        what, light.name, kind));
        return std::nullopt;
    }
    light.kind         = *known;
    const dvec3 colour = vector_or(json, &v, "color", kNotNegative, dvec3(1));
    light.diffuse      = vec3(colour * number_or(json, &v, "intensity", kNotNegative, 1));
    light.specular     = light.diffuse;
    light.attenuation  = {0, 0, 1, false};
    if (const JsonValue* range = find_member(v, "range")) {
        const double given = json.number(*range, "range", kWrittenRange);
        if (given == 0)
            warnings.push_back(fmt::format("{} \"{}\" has the range 0, which the extension forbids: it has no limit.",
                                           what, light.name));
        light.range = given > kMaxCoordinate ? 0 : static_cast<float>(given);
        if (light.kind == LightKind::directional) {
            light.range = 0;
            warnings.push_back(fmt::format("{} \"{}\" is directional: its range is ignored.", what, light.name));
        }
    }
    if (light.kind == LightKind::directional) light.attenuation = {1, 0, 0, true};
    if (light.kind == LightKind::spot) {
        const JsonValue* spot = find_member(v, "spot");
        if (!spot) json.fail(v, what + " is a spot light without \"spot\", expected \"spot\": {}");
        read_cone(json, *spot, what, light.spot, notes);
    }
    if (const JsonValue* extras = find_umbra(v)) apply_light_extras(json, *extras, light);
    if (light.kind == LightKind::spot && light.spot.falloff == SpotFalloff::smooth) widen_ramp(light);
    return light;
}

std::optional<Light> read_flat_light(const JsonText& json, const JsonValue& v, std::size_t index,
                                     std::vector<std::string>& warnings) {
    const auto what = fmt::format("lights[{}]", index);
    Light light;
    const JsonValue* type  = start_light(json, v, what, light);
    const std::string kind = type ? json.string(*type, "type") : "rect";
    if (kind != "rect" && kind != "disk") {
        warnings.push_back(
            fmt::format("{} \"{}\" of {} is of the unknown type \"{:.40}\" (known: rect, disk): it is left out.", what,
                        light.name, kAreaLights, kind));
        return std::nullopt;
    }
    const double size = number_or(json, &v, "size", kPositive, 1);
    double area       = 0;
    if (kind == "rect") {
        light.kind            = LightKind::rectangle;
        const JsonValue* rect = find_member(v, "rect");
        if (rect) (void)json.object(*rect, "rect");
        const double width = size * number_or(json, rect, "aspect", kPositive, 1);
        light.edge_u       = vec3(width, 0, 0);
        light.edge_v       = vec3(0, -size, 0);
        area               = width * size;
    } else {
        light.kind   = LightKind::disk;
        light.radius = static_cast<float>(size / 2);
        area         = kPi * size * size / 4;
    }
    const dvec3 colour = vector_or(json, &v, "color", kNotNegative, dvec3(1));
    light.diffuse      = vec3(colour * (number_or(json, &v, "intensity", kNotNegative, 1000) * area));
    light.specular     = light.diffuse;
    light.attenuation  = {0, 0, 1, false};
    return light;
}

void scale_area_light(const dmat4& scene_from_node, dvec3 along, Light& light) {
    double scale = 0;
    for (int k = 0; k < 3; ++k) scale = std::max(scale, glm::length(dvec3(scene_from_node[k])));
    if (light.kind == LightKind::rectangle) {
        const dvec3 d(light.direction);
        const dvec3 across = glm::normalize(glm::cross(d, along));
        light.edge_v       = vec3(across * (scale * glm::length(dvec3(light.edge_v))));
        light.edge_u       = vec3(glm::cross(across, d) * (scale * glm::length(dvec3(light.edge_u))));
    } else {
        light.radius = static_cast<float>(scale * static_cast<double>(light.radius));
    }
    light.diffuse *= static_cast<float>(scale * scale);
    light.specular *= static_cast<float>(scale * scale);
}

}  // namespace umbra
