// Scan-line shadows against `exact`, where spans, cells around the light and coplanar triangles matter.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

struct Compared {
    std::size_t lit = 0, umbra = 0, different = 0;
};

/// Of all pixels that the light can reach and that `exact` defines.
Compared against_exact(const Scene& scene) {
    const PointBatch points = primary(scene);
    Compared compared;
    MethodCase scan("scan_line", scene), exact("exact", scene);
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        scan.prepare(light);
        exact.prepare(light);
        const VisibilityPlane found = scan.visibility(points, light), truth = exact.visibility(points, light);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_open(points, light, i) || !truth.defined(i)) continue;
            ++(truth.s[i] > 0 ? compared.lit : compared.umbra);
            compared.different += found.s[i] != truth.s[i];
        }
    }
    return compared;
}

Scene seen_from(vec3 eye, vec3 target) {
    Scene scene;
    scene.materials.emplace_back();
    scene.camera.eye = eye, scene.camera.target = target;
    scene.width = 160, scene.height = 100;
    return scene;
}

void add_lamp(Scene& scene, vec3 position) {
    Light lamp;
    lamp.name     = "lamp" + std::to_string(scene.lights.size());
    lamp.position = position;
    scene.lights.push_back(lamp);
}

/// Triangles in all directions around a lamp in a room: each face of the cube of cells has its own.
TEST(ScanLine, AgreesWithExactAroundALampInTheMiddle) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        Scene scene             = seen_from({3.1f, 2.7f, 3.4f}, {0, -0.2f, 0});
        scene.camera.projection = projection, scene.camera.height = 0.9f;
        std::mt19937 random(7);
        std::normal_distribution<float> normal;
        std::uniform_real_distribution<float> distance(0.5f, 2), size(0.05f, 0.35f);
        for (int n = 0; n < 150; ++n) {
            const vec3 centre = glm::normalize(vec3(normal(random), normal(random), normal(random))) * distance(random);
            std::vector<vec3> corners;
            for (int k = 0; k < 3; ++k)
                corners.push_back(centre + size(random) * vec3(normal(random), normal(random), normal(random)));
            add_object(scene, "t" + std::to_string(n), corners, {}, {{0, 1, 2}}, 0);
        }
        const Mesh room = make_box({8, 8, 8});
        add_object(scene, "room", room.positions, {}, room.triangles, 0);
        add_lamp(scene, {0, 0, 0});
        const Compared compared = against_exact(scene);
        EXPECT_GT(compared.lit, 3000u);
        EXPECT_GT(compared.umbra, 1000u);
        EXPECT_EQ(compared.different, 0u);
    }
}

/// The barycentrics of a triangle a million times as wide as its pixels put points beside the line of their row, by
/// more than a shadow is away from them.
TEST(ScanLine, AsksPointsThatLieBesideTheirRow) {
    Scene scene      = seen_from({0, 2, 3}, {0, 0, 0});
    const Mesh floor = make_plane(1e5f, 1e5f), square = make_plane(0.5f, 0.5f);
    add_object(scene, "floor", floor.positions, {}, floor.triangles, 0);
    for (int n = 0; n < 12; ++n) {
        std::vector<vec3> raised = square.positions;
        const int line           = n / 4;
        for (vec3& p : raised) {
            const double angle = 0.1 + 0.5 * n;
            p = vec3(float(p.x * std::cos(angle) - p.z * std::sin(angle)) - 1.6f + 1.1f * float(n % 4), 0.3f,
                     float(p.x * std::sin(angle) + p.z * std::cos(angle)) - 1.2f + 1.1f * float(line));
        }
        add_object(scene, "square" + std::to_string(n), raised, {}, square.triangles, 0);
    }
    add_lamp(scene, {1.5f, 4, 1});
    const Compared compared = against_exact(scene);
    EXPECT_GT(compared.umbra, 1000u);
    EXPECT_EQ(compared.different, 0u);
}

/// Rounding puts points of a slanting triangle on either side of its plane; its twin hides none of them.
TEST(ScanLine, TwinsInOnePlaneDoNotDarkenEachOther) {
    Scene scene = seen_from({0.3f, 3, 4}, {0, 0, 0});
    const std::vector<vec3> corners{{-2, 0.31f, 1.7f}, {2.1f, -0.43f, 1.3f}, {0.2f, 0.71f, -2.3f}};
    add_object(scene, "sheet", corners, {}, {{0, 1, 2}}, 0);
    add_object(scene, "twin", corners, {}, {{1, 2, 0}}, 0);
    add_object(scene, "turned_twin", corners, {}, {{2, 1, 0}}, 0);
    add_lamp(scene, {0.7f, 3.1f, 0.9f});
    const Compared compared = against_exact(scene);
    EXPECT_GT(compared.lit, 1000u);
    EXPECT_EQ(compared.umbra, 0u);
    EXPECT_EQ(compared.different, 0u);
}

}  // namespace
}  // namespace umbra
