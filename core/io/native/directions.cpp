#include "umbra/core/io/native/directions.h"

#include <fmt/format.h>

namespace umbra {

vec3 read_direction(const JsonText& json, const JsonValue& v, std::string_view what) {
    const vec3 d(json.vector(v, what, kAnyNumber));
    if (d == vec3(0)) json.fail(v, fmt::format("{} is (0, 0, 0), expected a vector with a direction", what));
    return d;
}

vec3 direction_or_target(const JsonText& json, const JsonFields& f, vec3 position, const dvec3& origin,
                         std::optional<vec3> fallback) {
    f.exclude("direction", "target");
    if (const JsonValue* t = f.find("target")) {
        const dvec3 d = json.vector(*t, "target", kAnyNumber) - origin - dvec3(position);
        if (vec3(d) == vec3(0)) json.fail(*t, "target is the same point as position, expected another point");
        return vec3(d);
    }
    if (fallback && !f.find("direction")) return *fallback;
    return read_direction(json, f.require("direction"), "direction");
}

bool is_parallel(dvec3 up, dvec3 axis) {
    return glm::length(glm::cross(glm::normalize(up), glm::normalize(axis))) < 1e-5;
}

}  // namespace umbra
