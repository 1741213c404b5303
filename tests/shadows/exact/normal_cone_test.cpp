// Cones of normals: nothing that they leave out is a silhouette.
#include "umbra/shadows/exact/normal_cone.h"

#include <gtest/gtest.h>

#include <random>

namespace umbra {
namespace {

using exact_visibility::NormalCone;

/// Two planes through the origin at all angles, those of nearly flat meshes among them, and points at which they turn
/// different sides: no cone of both may say that the point is on one side.
TEST(NormalCone, KnowsPlanesThatAPointLiesBetween) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto anywhere = [&] { return dvec3(unit(random), unit(random), unit(random)); };
    std::size_t between = 0, one_sided = 0;
    for (int k = 0; k < 200000; ++k) {
        const double angle = std::pow(10.0, -5 + 5 * std::abs(unit(random)));
        const dvec3 n = glm::normalize(anywhere()), m = glm::normalize(n + angle * anywhere());
        const dvec3 edge = glm::cross(n, m);
        if (!(glm::length(edge) > 0)) continue;
        // A point near both planes, beside the edge.
        const dvec3 beside    = glm::normalize(glm::cross(n, edge));
        const dvec3 p         = beside + 2 * angle * unit(random) * n;
        const NormalCone cone = NormalCone::joined(NormalCone::around(vec3(n), 0), NormalCone::around(vec3(m), 0));
        const bool says       = cone.one_sided(Box{vec3(0), vec3(0)}, p);
        if (glm::dot(n, p) * glm::dot(m, p) < 0) {
            ++between;
            EXPECT_FALSE(says) << angle;
        } else {
            one_sided += says;
        }
    }
    EXPECT_GT(between, 1000u);
    EXPECT_GT(one_sided, 1000u);  // else it is no use
}

}  // namespace
}  // namespace umbra
