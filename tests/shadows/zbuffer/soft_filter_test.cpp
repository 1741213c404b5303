// PCSS: penumbrae of area lights by a search for blockers, beside closed forms and the exact fraction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

/// A long edge at `height` over a floor, parallel to z, that hides the side of negative x from a square light 4 above.
Scene edge_over_floor(float height, LightKind kind = LightKind::rectangle) {
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "floor", {{-4, 0, -1}, {4, 0, -1}, {4, 0, 1}, {-4, 0, 1}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    add_object(scene, "sheet", {{-6, height, -6}, {0, height, -6}, {0, height, 6}, {-6, height, 6}}, {},
               {{0, 2, 1}, {0, 3, 2}}, 0);
    Light light;
    light.name      = "light";
    light.kind      = kind;
    light.position  = {0, 4, 0};
    light.direction = {0, -1, 0};
    light.edge_u = {0.5f, 0, 0}, light.edge_v = {0, 0, -0.5f};
    light.radius            = 0.28f;
    scene.lights            = {light};
    scene.camera.projection = Projection::orthographic;
    scene.camera.eye        = {0, -3, 0};
    scene.camera.target     = {0, 0, 0};
    scene.camera.up         = {0, 0, 1};
    scene.camera.height     = 1;
    scene.width = 400, scene.height = 8;
    return scene;
}

/// Points of the floor from x = -2 to 2, seen from above though the sheet hides them from most cameras.
PointBatch line_on_floor(const Scene& scene) {
    PointBatch points;
    points.eye = {0, 3, 0};
    points.resize(801);
    for (std::size_t i = 0; i < points.size(); ++i) {
        // (x, 0, -0.75) in triangle 0: corners (-4, 0, -1), (4, 0, 1), (4, 0, -1).
        const float x = -2 + static_cast<float>(i) / 200, z = -0.75f;
        const float u = (z + 1) / 2, v = (x + 4) / 8 - u;
        set_point(points, i, scene, 0, u, v);
    }
    face_lights(points, scene);
    return points;
}

/// How far apart the first point that sees less than 95 % of the light and the last that sees more than 5 % are.
double penumbra_width(const Scene& scene, const char* method) {
    MethodCase run(method, scene);
    run.prepare(0);
    const PointBatch points     = line_on_floor(scene);
    const VisibilityPlane plane = run.visibility(points, 0);
    double first = 1e9, last = -1e9;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (plane.s[i] > 0.05f) first = std::min(first, double(points.px[i]));
        if (plane.s[i] < 0.95f) last = std::max(last, double(points.px[i]));
    }
    return std::max(0.0, last - first);
}

/// w = size (d_r - d_b) / d_b, with d from the light: of the sum over a line, the middle 90 % of a square light.
TEST(SoftFilter, PenumbraIsAsWideAsTheBlockerIsFar) {
    double before = 0;
    for (const float height : {0.3f, 0.7f, 1.2f}) {
        const Scene scene  = edge_over_floor(height);
        const double whole = 0.5 * double(height) / (4 - double(height));
        const double exact = penumbra_width(scene, "exact"), soft = penumbra_width(scene, "shadow_zbuffer@soft");
        EXPECT_NEAR(exact, 0.9 * whole, 0.012);
        EXPECT_GT(soft, 0.6 * exact) << height;
        EXPECT_LT(soft, 1.6 * exact) << height;
        EXPECT_GT(soft, before);
        EXPECT_LT(penumbra_width(scene, "shadow_zbuffer"), 0.012);
        before = soft;
    }
}

double mean_error(const Scene& scene, const char* method) {
    MethodCase exact("exact", scene), run(method, scene);
    const PointBatch points = primary(scene);
    double sum              = 0;
    std::size_t n           = 0;
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        exact.prepare(j), run.prepare(j);
        const VisibilityPlane right = exact.visibility(points, j), got = run.visibility(points, j);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_open(points, j, i) || !got.defined(i)) continue;
            sum += std::abs(double(got.s[i]) - double(right.s[i]));
            ++n;
        }
    }
    return sum / static_cast<double>(n);
}

TEST(SoftFilter, ComesCloserThanTheLightsCentre) {
    for (const auto& [name, share] : {std::pair{"umbra_penumbra", 0.6}, {"eclipse", 0.6}, {"light_sizes", 0.9}}) {
        Scene scene = load_scene(std::string(UMBRA_SCENES) + "/" + name + ".json");
        scene.width = 160, scene.height = 90;
        const double centre = mean_error(scene, "shadow_zbuffer"), soft = mean_error(scene, "shadow_zbuffer@soft");
        EXPECT_LT(soft, share * centre) << name;
        EXPECT_GT(soft, 0) << name;
    }
}

/// No blockers, no shadow; and everything behind a sheet without an edge nearby is dark.
TEST(SoftFilter, FarFromEdgesItIsLitOrDark) {
    const Scene scene = edge_over_floor(0.7f, LightKind::disk);
    MethodCase run("shadow_zbuffer@soft", scene);
    run.prepare(0);
    const PointBatch points     = line_on_floor(scene);
    const VisibilityPlane plane = run.visibility(points, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.px[i] < -0.6f) {
            EXPECT_EQ(plane.s[i], 0) << points.px[i];
        }
        if (points.px[i] > 0.6f) {
            EXPECT_EQ(plane.s[i], 1) << points.px[i];
        }
    }
}

TEST(SoftFilter, OfHardLightsItIsPcf) {
    Scene scene            = edge_over_floor(0.7f);
    scene.lights[0].kind   = LightKind::point;
    const PointBatch floor = line_on_floor(scene);
    MethodCase soft("shadow_zbuffer@soft", scene), pcf("shadow_zbuffer:filter=pcf", scene);
    soft.prepare(0), pcf.prepare(0);
    // The map of `soft` is a little wider: filters may reach further over its border.
    const auto a = soft.visibility(floor, 0).s, b = pcf.visibility(floor, 0).s;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (std::abs(floor.px[i]) > 0.02f) {
            EXPECT_EQ(a[i], b[i]) << floor.px[i];
        }
}

}  // namespace
}  // namespace umbra
