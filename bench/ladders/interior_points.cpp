#include "umbra/bench/ladders/interior_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/errors/error_causes.h"

namespace umbra {
namespace {

/// What a method of one answer, given where `answers` is, has wrong.
ClassPlane classes_of_constant(float s, const Scene& scene, const PointBatch& points, LightId light,
                               const VisibilityPlane& truth, const VisibilityPlane& answers) {
    VisibilityPlane constant = answers;
    std::fill(constant.s.begin(), constant.s.end(), s);
    ClassPlane classes = error_classes(points, light, constant, truth, visibility_tolerance(scene.lights[light].kind));
    mark_terminator(classes, scene, points, light);
    return classes;
}

std::uint64_t least_of_a_kind(std::uint64_t compared) {
    return std::max(kLeastOfAKind, static_cast<std::uint64_t>(std::ceil(kLeastShareOfAKind * double(compared))));
}

}  // namespace

InteriorPoints& InteriorPoints::operator+=(const InteriorPoints& other) {
    compared += other.compared;
    lit += other.lit;
    shadow += other.shadow;
    return *this;
}

bool InteriorPoints::enough() const { return std::min(lit, shadow) >= least_of_a_kind(compared); }

std::string InteriorPoints::lacking() const {
    if (enough()) return "";
    const auto [count, kind] = lit < shadow ? std::pair(lit, "lit") : std::pair(shadow, "shadow");
    return fmt::format("{} interior {} points of {} compared, at least {} are needed", count, kind, compared,
                       least_of_a_kind(compared));
}

InteriorPoints interior_points(const Scene& scene, const PointBatch& points, LightId light,
                               const VisibilityPlane& truth, const VisibilityPlane& answers) {
    const ClassPlane dark = classes_of_constant(0, scene, points, light, truth, answers);
    const ClassPlane lit  = classes_of_constant(1, scene, points, light, truth, answers);
    const auto count      = [](const ClassPlane& classes, const auto& is) {
        return static_cast<std::uint64_t>(std::count_if(classes.begin(), classes.end(), is));
    };
    return {count(dark, is_compared), count(dark, [](ErrorClass c) { return c == ErrorClass::false_shadow; }),
            count(lit, [](ErrorClass c) { return c == ErrorClass::false_light; })};
}

}  // namespace umbra
