// Points of area lights fill them evenly: parts whose area is known have their part of the points.
#include "umbra/core/render/light_points.h"

#include <gtest/gtest.h>

#include <functional>

#include "umbra/core/render/sampling.h"

namespace umbra {
namespace {

constexpr int kPoints = 4000;
/// An additive recurrence is within some log(n) / n of a part's area; pseudo-random points would be within 0.007.
constexpr double kUneven = 0.005;

Light light_of(LightKind kind) {
    Light light;
    light.kind      = kind;
    light.position  = {1, 2, 3};
    light.direction = glm::normalize(vec3(1, -2, 0.5f));
    light.radius    = 0.5f;
    light.edge_u    = {2, 1, 0};
    light.edge_v    = {0, 0, 3};
    return light;
}

/// The fraction of the points, as seen from `p`, for which `holds`.
double part(const Light& light, dvec3 p, const std::function<bool(dvec3)>& holds) {
    int n = 0;
    for (int k = 0; k < kPoints; ++k) n += holds(light_point(light, p, k));
    return double(n) / kPoints;
}

TEST(LightPoints, FillARectangle) {
    const Light light = light_of(LightKind::rectangle);
    const dvec3 c(light.position), u(light.edge_u), v(light.edge_v);
    const auto at_u = [&](dvec3 q) { return glm::dot(q - c, u) / glm::dot(u, u); };
    const auto at_v = [&](dvec3 q) { return glm::dot(q - c, v) / glm::dot(v, v); };
    const dvec3 p(0);
    EXPECT_EQ(part(light, p, [&](dvec3 q) { return std::abs(at_u(q)) <= 0.5 && std::abs(at_v(q)) <= 0.5; }), 1);
    EXPECT_EQ(part(light, p, [&](dvec3 q) { return glm::length(q - c - at_u(q) * u - at_v(q) * v) < 1e-12; }), 1);
    for (const double x : {-0.25, 0.0, 0.375}) {
        EXPECT_NEAR(part(light, p, [&](dvec3 q) { return at_u(q) < x; }), x + 0.5, kUneven);
        EXPECT_NEAR(part(light, p, [&](dvec3 q) { return at_v(q) < x; }), x + 0.5, kUneven);
        EXPECT_NEAR(part(light, p, [&](dvec3 q) { return at_u(q) < x && at_v(q) > x; }), (0.5 + x) * (0.5 - x),
                    kUneven);
    }
}

/// Points of a disk around `c` across `n`: rings by their areas, sectors by their angles.
void expect_even_disk(const Light& light, dvec3 p, dvec3 c, dvec3 n, double radius) {
    EXPECT_EQ(part(light, p, [&](dvec3 q) { return std::abs(glm::dot(q - c, n)) < 1e-12; }), 1);
    EXPECT_EQ(part(light, p, [&](dvec3 q) { return glm::length(q - c) <= radius * (1 + 1e-12); }), 1);
    for (const double r : {0.25, 0.5, 0.75})
        EXPECT_NEAR(part(light, p, [&](dvec3 q) { return glm::length(q - c) < r * radius; }), r * r, kUneven) << r;
    const dvec3 u = glm::normalize(glm::cross(n, dvec3(0.3, 0.5, 0.8))), v = glm::cross(n, u);
    EXPECT_NEAR(part(light, p, [&](dvec3 q) { return glm::dot(q - c, u) > 0; }), 0.5, kUneven);
    EXPECT_NEAR(part(light, p, [&](dvec3 q) { return glm::dot(q - c, u) > 0 && glm::dot(q - c, v) > 0; }), 0.25,
                kUneven);
}

TEST(LightPoints, FillADisk) {
    const Light light = light_of(LightKind::disk);
    expect_even_disk(light, dvec3(0), dvec3(light.position), glm::normalize(dvec3(light.direction)), 0.5);
}

/// The tangent cone of a sphere of radius r at distance d touches it in a circle r^2 / d before the centre.
TEST(LightPoints, FillTheDiskThatAPointSeesOfASphere) {
    const Light light = light_of(LightKind::sphere);
    const dvec3 p(-1, 0.5, 2), to = dvec3(light.position) - p, n = glm::normalize(to);
    const double d = glm::length(to), before = 0.25 / d;
    expect_even_disk(light, p, dvec3(light.position) - before * n, n, std::sqrt(0.25 - before * before));
    const dvec3 inside(1, 2.25, 3);
    EXPECT_EQ(light_point(light, inside, 7), dvec3(light.position));
}

}  // namespace
}  // namespace umbra
