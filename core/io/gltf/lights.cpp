#include "umbra/core/io/gltf/lights.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "umbra/core/io/gltf/extras.h"
#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/scene/names.h"

namespace umbra {
std::optional<Light> read_punctual_light(const JsonText& json, const JsonValue& v, std::size_t index,
                                         std::vector<std::string>& warnings) {
    const auto what = fmt::format("lights[{}]", index);
    (void)json.object(v, what);
    Light light;
    light.name            = name_or(json, v, "");
    const JsonValue* type = find_member(v, "type");
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
        light.range = static_cast<float>(json.number(*range, "range", kPositive));
        if (light.kind == LightKind::directional) {
            light.range = 0;
            warnings.push_back(fmt::format("{} \"{}\" is directional: its range is ignored.", what, light.name));
        }
    }
    if (light.kind == LightKind::directional) light.attenuation = {1, 0, 0, true};
    if (light.kind == LightKind::spot) {
        const JsonValue* spot = find_member(v, "spot");
        if (!spot) json.fail(v, what + " is a spot light without \"spot\", expected \"spot\": {}");
        (void)json.object(*spot, "spot");
        const double outer = number_or(json, spot, "outerConeAngle", kConeAngleRadians, kPi / 4);
        const double inner = number_or(json, spot, "innerConeAngle", kNotNegative, 0);
        light.spot.falloff = SpotFalloff::smooth;
        light.spot.cutoff  = static_cast<float>(outer);
        light.spot.inner   = static_cast<float>(inner);
        if (light.spot.inner >= light.spot.cutoff)
            json.fail(*spot,
                      fmt::format("{}: innerConeAngle {:g} is not less than outerConeAngle {:g}", what, inner, outer));
    }
    if (const JsonValue* extras = find_umbra(v)) apply_light_extras(json, *extras, light);
    return light;
}

}  // namespace umbra
