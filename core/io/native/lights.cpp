#include "umbra/core/io/native/lights.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/native/directions.h"
#include "umbra/core/io/scene_terms.h"

namespace umbra {
namespace {

using Keys = std::vector<std::string_view>;

LightKind read_kind(const JsonText& json, const JsonValue& v) {
    const auto& members = json.object(v, "a light");
    const auto type = std::find_if(members.begin(), members.end(), [](const JsonMember& m) { return m.key == "type"; });
    if (type == members.end()) json.fail(v, "a light has no \"type\"");
    return json.choice<LightKind>(type->value, "light type");
}

Keys keys_of(LightKind kind) {
    Keys keys{"type", "name", "colour", "intensity", "diffuse", "specular", "ambient"};
    const auto add = [&](const Keys& more) { keys.insert(keys.end(), more.begin(), more.end()); };
    if (kind != LightKind::directional) add({"position", "attenuation", "clamp", "range"});
    switch (kind) {
        case LightKind::directional: add({"direction"}); break;
        case LightKind::point: break;
        case LightKind::spot: add({"direction", "target", "falloff", "exponent", "cutoff", "inner"}); break;
        case LightKind::rectangle: add({"size", "direction", "target", "up", "edge_u", "edge_v"}); break;
        case LightKind::disk: add({"direction", "target", "radius"}); break;
        case LightKind::sphere: add({"radius"}); break;
    }
    return keys;
}

void read_intensities(const JsonText& json, const JsonFields& f, Light& light) {
    const vec3 base      = colour_or(json, f, "colour", vec3(1));
    const auto intensity = static_cast<float>(f.number("intensity", kNotNegative, 1));
    f.exclude("colour", "diffuse");
    light.diffuse  = intensity * colour_or(json, f, "diffuse", base);
    light.specular = intensity * colour_or(json, f, "specular", base);
    light.ambient  = colour_or(json, f, "ambient", vec3(0));
}

void read_position(const JsonText& json, const JsonFields& f, Light& light) {
    light.position = vec3(json.vector(f.require("position"), "position", kAnyNumber));
    light.range    = static_cast<float>(f.number("range", kPositive, 0));
    if (const JsonValue* a = f.find("attenuation")) light.attenuation = read_attenuation(json, *a);
    light.attenuation.clamp = f.boolean("clamp", true);
}

void read_spot(const JsonText& json, const JsonFields& f, Light& light) {
    light.direction = direction_or_target(json, f, light.position, std::nullopt);
    if (const JsonValue* falloff = f.find("falloff"))
        light.spot.falloff = json.choice<SpotFalloff>(*falloff, "falloff");
    light.spot.exponent = static_cast<float>(f.number("exponent", kNotNegative, double(light.spot.exponent)));
    const double cutoff = f.number("cutoff", kConeAngle, 45);
    const double inner  = f.number("inner", kInnerConeAngle, 0);
    if (inner >= cutoff)
        json.fail(*f.find("inner"),
                  fmt::format("inner is {:g} degrees, cutoff {:g}, expected inner below cutoff", inner, cutoff));
    light.spot.cutoff = static_cast<float>(glm::radians(cutoff));
    light.spot.inner  = static_cast<float>(glm::radians(inner));
}

/// Two edges, or a size and where it faces.
void read_rectangle(const JsonText& json, const JsonFields& f, Light& light) {
    for (const std::string_view other : {"size", "direction", "target", "up"}) f.exclude("edge_u", other);
    if (f.find("edge_u") || f.find("edge_v")) {
        light.edge_u  = read_direction(json, f.require("edge_u"), "edge_u");
        light.edge_v  = read_direction(json, f.require("edge_v"), "edge_v");
        const dvec3 u = glm::normalize(dvec3(light.edge_u)), v = glm::normalize(dvec3(light.edge_v));
        if (std::abs(glm::dot(u, v)) > 1e-4)
            json.fail(*f.find("edge_v"), "edge_v is not perpendicular to edge_u, as a rectangle's edges are");
        return;
    }
    constexpr std::string_view expected = "two numbers [width, height]";
    const JsonValue& v                  = f.require("size");
    const auto& size                    = json.array(v, "size", expected);
    if (size.size() != 2) json.wrong_type(v, "size", expected);
    const dvec3 axis = glm::normalize(dvec3(direction_or_target(json, f, light.position, vec3(0, -1, 0))));
    dvec3 up{0, 1, 0};
    if (const JsonValue* given = f.find("up")) {
        up = glm::normalize(dvec3(read_direction(json, *given, "up")));
        if (is_parallel(up, axis)) json.fail(*given, "up is parallel to the direction that the light faces");
    } else if (is_parallel(up, axis)) {
        up = {0, 0, 1};
    }
    const dvec3 u = glm::normalize(glm::cross(up, axis));
    light.edge_u  = vec3(json.number(size[0], "width", kPositive) * u);
    light.edge_v  = vec3(json.number(size[1], "height", kPositive) * glm::cross(axis, u));
}

}  // namespace

Light read_native_light(const JsonText& json, const JsonValue& v) {
    Light light;
    light.kind = read_kind(json, v);
    const JsonFields f(json, v, fmt::format("a {} light", to_string(light.kind)), keys_of(light.kind));
    light.name = f.string("name", "");
    read_intensities(json, f, light);
    if (light.kind == LightKind::directional)
        light.direction = read_direction(json, f.require("direction"), "direction");
    else
        read_position(json, f, light);
    if (light.kind == LightKind::spot) read_spot(json, f, light);
    if (light.kind == LightKind::rectangle) read_rectangle(json, f, light);
    if (light.kind == LightKind::disk) light.direction = direction_or_target(json, f, light.position, vec3(0, -1, 0));
    if (light.kind == LightKind::disk || light.kind == LightKind::sphere)
        light.radius = static_cast<float>(json.number(f.require("radius"), "radius", kPositive));
    return light;
}

}  // namespace umbra
