// Ways to find what rays meet: each finds what a test of every triangle finds, with fewer tests.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "umbra/bench/studies/light/search_ways.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

Scene balls_on_a_floor() {
    Scene scene;
    scene.materials.emplace_back();
    const Mesh floor = make_plane(20, 20), ball = make_sphere(1, 32, 16);
    add_object(scene, "floor", floor.positions, {}, floor.triangles, 0);
    for (int k = 0; k < 5; ++k) {
        std::vector<vec3> moved = ball.positions;
        for (vec3& p : moved) p += vec3(3.1f * static_cast<float>(k - 2), 1.2f, static_cast<float>(k % 2));
        add_object(scene, "ball", moved, {}, ball.triangles, 0);
    }
    return scene;
}

/// Half of them in any direction from anywhere, half along an axis, from one triangle.
std::vector<Ray> drawn_rays(const Scene& scene) {
    std::mt19937 draw(7);
    std::uniform_real_distribution<double> at(-8, 8), turn(-1, 1);
    std::vector<Ray> rays;
    for (int k = 0; k < 4000; ++k) {
        Ray ray{.origin = {at(draw), at(draw), at(draw)}, .direction = {turn(draw), turn(draw), turn(draw)}};
        if (k % 2 == 1) {
            const TriangleId t = static_cast<TriangleId>(draw() % scene.triangles.size());
            ray.origin = (dvec3(scene.vertex(t, 0)) + dvec3(scene.vertex(t, 1)) + dvec3(scene.vertex(t, 2))) / 3.0;
            ray.from   = t;
            ray.normal = glm::normalize(glm::cross(dvec3(scene.vertex(t, 1)) - dvec3(scene.vertex(t, 0)),
                                                   dvec3(scene.vertex(t, 2)) - dvec3(scene.vertex(t, 0))));
            if (k % 4 == 3) ray.direction = {0, k % 8 == 3 ? 1 : -1, 0};
        }
        ray.direction = glm::normalize(ray.direction);
        rays.push_back(ray);
    }
    return rays;
}

TEST(SearchWays, FindWhatATestOfEveryTriangleFinds) {
    const Scene scene = balls_on_a_floor();
    const RayScene traced(scene);
    const std::vector<Ray> rays = drawn_rays(scene);
    for (const SearchWay way : kSearchWays) {
        const SpaceSearch search(way, scene);
        SearchSteps steps;
        std::size_t met = 0;
        for (const Ray& ray : rays) {
            const TriangleId expected = first_by_search(traced, scene, ray),
                             found    = search.first(ray, least_distance(traced, ray), steps);
            met += found != kNoTriangle ? 1 : 0;
            ASSERT_EQ(found == kNoTriangle, expected == kNoTriangle) << to_string(way);
            if (found != expected) {  // neighbours that share the edge
                EXPECT_NEAR(distance_to_plane(scene, ray, found), distance_to_plane(scene, ray, expected), 1e-9)
                    << to_string(way);
            }
        }
        EXPECT_GT(met, 1000u);
        const auto tests = static_cast<double>(steps.triangles) / static_cast<double>(rays.size());
        EXPECT_LT(tests, 0.03 * static_cast<double>(scene.triangles.size())) << to_string(way);
        EXPECT_GT(steps.volumes, rays.size()) << to_string(way);
    }
}

TEST(SearchWays, ServeFlatAndTinyScenes) {
    Scene scene;
    scene.materials.emplace_back();
    const Mesh floor = make_plane(2, 2);
    add_object(scene, "floor", floor.positions, {}, floor.triangles, 0);
    for (const SearchWay way : kSearchWays) {
        SearchSteps steps;
        const SpaceSearch search(way, scene);
        EXPECT_NE(search.first({.origin = {0.25, 1, 0.5}, .direction = {0, -1, 0}}, 0, steps), kNoTriangle)
            << to_string(way);
        EXPECT_EQ(search.first({.origin = {0.25, 1, 0.5}, .direction = {0, 1, 0}}, 0, steps), kNoTriangle)
            << to_string(way);
        EXPECT_EQ(search.first({.origin = {0.25, 1, 0.5}, .direction = {0, -1, 0}, .reach = 0.5}, 0, steps),
                  kNoTriangle)
            << to_string(way);
    }
}

TEST(GrowthFactor, IsThatOfAGeometricRow) {
    EXPECT_NEAR(growth_factor({3, 6, 12, 24}), 2, 1e-12);
    EXPECT_NEAR(growth_factor({8, 2}), 0.25, 1e-12);
    EXPECT_NEAR(growth_factor({1, 4, 4, 1}), 1, 1e-12) << "slopes cancel";
}

}  // namespace
}  // namespace umbra
