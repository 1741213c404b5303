// Effects of interpolation between vertices on a picture: silhouettes, polygons turned in their plane, normals that are
// not the surface's, and the choice of triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "umbra/core/image/metrics.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/lit_everywhere.h"

namespace umbra {
namespace {

/// A lamp above the origin; seen from above through an orthographic camera that shows [-1, 1] in z.
Scene seen_from_above(vec3 lamp) {
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].k_a = vec3(0), scene.materials[0].k_d = vec3(1);
    Light light;
    light.name = "lamp", light.position = lamp;
    scene.lights.push_back(light);
    scene.camera.eye = {0, 5, 0}, scene.camera.target = {0, 0, 0}, scene.camera.up = {0, 0, -1};
    scene.camera.projection = Projection::orthographic, scene.camera.height = 2;
    scene.width = 64, scene.height = 64;
    return scene;
}

double diffuse(vec3 lamp, vec3 p) { return (lamp.y - p.y) / glm::length(lamp - p); }

std::size_t surfaces(const PointBatch& points) {
    return points.size() - static_cast<std::size_t>(std::ranges::count(points.triangle, kNoTriangle));
}

double from_phong(const Scene& scene, const PointBatch& points) {
    return image_error(shaded(ShadingModel::gouraud, scene, points).linear,
                       shaded(ShadingModel::phong, scene, points).linear)
        .rmse;
}

/// Vertices alone are lit: the finer the faces, the nearer Gouraud shading comes to Phong's, with the square of the
/// edge.
TEST(Triangulation, FinerFacesComeCloserToPhong) {
    std::vector<double> errors;
    for (const int n : {1, 2, 3, 5, 10, 40}) {
        Scene scene      = seen_from_above({0, 0.5f, 0});
        const Mesh plane = make_plane(2, 2, n);
        add_object(scene, "quad", plane.positions, {}, plane.triangles, 0);
        const PointBatch points = points_of(scene);
        ASSERT_EQ(surfaces(points), points.size()) << n;
        errors.push_back(from_phong(scene, points));
    }
    EXPECT_GT(errors[0], 0.25);  // one face: the bright middle is missed
    EXPECT_LT(errors[3], errors[2]);
    EXPECT_LT(errors[4], errors[3]);
    EXPECT_NEAR(errors[4] / errors[5], 16, 5);
}

/// In the middle of a quad its diagonal's ends count, and the other two corners do not.
TEST(Triangulation, TheDiagonalShows) {
    const vec3 lamp{-0.8f, 0.5f, -0.8f};
    const std::array<vec3, 4> corners{vec3(-1, 0, -1), vec3(-1, 0, 1), vec3(1, 0, 1), vec3(1, 0, -1)};
    double middle[2]{};
    for (const bool other : {false, true}) {
        Scene scene = seen_from_above(lamp);
        scene.width = scene.height = 65;  // a pixel in the middle
        const std::vector<uvec3> triangles =
            other ? std::vector<uvec3>{{0, 1, 3}, {1, 2, 3}} : std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}};
        add_object(scene, "quad", {corners.begin(), corners.end()}, {}, triangles, 0);
        const PointBatch points = points_of(scene);
        middle[other]           = shaded(ShadingModel::gouraud, scene, points).linear.at(points.size() / 2, 0);
    }
    EXPECT_NEAR(middle[0], (diffuse(lamp, corners[0]) + diffuse(lamp, corners[2])) / 2, 1e-5);
    EXPECT_NEAR(middle[1], (diffuse(lamp, corners[1]) + diffuse(lamp, corners[3])) / 2, 1e-5);
    EXPECT_GT(std::abs(middle[0] - middle[1]), 0.1);
}

/// Values at the corners of a polygon, interpolated along its two edges on the row y = 0 and then along the row, at x =
/// 0: as scan converters draw polygons of four corners.
double along_rows(const std::array<std::pair<double, double>, 4>& corners, const std::array<double, 4>& values) {
    std::vector<std::pair<double, double>> ends;  // x, value
    for (std::size_t k = 0; k < 4; ++k) {
        const auto [x0, y0] = corners[k];
        const auto [x1, y1] = corners[(k + 1) % 4];
        if ((y0 < 0) == (y1 < 0)) continue;
        const double t = y0 / (y0 - y1);
        ends.emplace_back(x0 + t * (x1 - x0), values[k] + t * (values[(k + 1) % 4] - values[k]));
    }
    const double t = ends[0].first / (ends[0].first - ends[1].first);
    return ends[0].second + t * (ends[1].second - ends[0].second);
}

/// The lectures' polygon whose shading changes as it turns: four corners interpolated along rows. Triangles do not
/// change.
TEST(Interpolation, APolygonTurnedInItsPlaneChangesAndATriangleDoesNot) {
    const std::array<double, 4> values{1, 0, 0, 0};
    std::set<double> seen;
    for (const double degrees : {0.0, 20.0, 44.0}) {
        std::array<std::pair<double, double>, 4> corners;
        for (std::size_t k = 0; k < 4; ++k) {
            const double angle = (degrees + 45 + 90 * double(k)) * kPi / 180;
            corners[k]         = {std::cos(angle), std::sin(angle)};
        }
        seen.insert(std::round(along_rows(corners, values) * 1000));
    }
    EXPECT_EQ(seen.size(), 3u);

    std::vector<double> middle;
    for (const double degrees : {0.0, 20.0, 44.0, 100.0}) {
        Scene scene         = seen_from_above({0, 1, 0});
        scene.camera.height = 3;
        const double angle  = degrees * kPi / 180;
        const auto turned   = [&](double x, double z) {
            return vec3(float(x * std::cos(angle) - z * std::sin(angle)), 0,
                          float(x * std::sin(angle) + z * std::cos(angle)));
        };
        // The lamp is over the corner that is in the middle, so that only distances to it count.
        scene.lights[0].position = turned(0.2, 0.1) + vec3(0, 1, 0);
        add_object(scene, "triangle", {turned(-1, -1), turned(0, 1.2), turned(1, -0.6)}, {}, {{0, 1, 2}}, 0);
        scene.width = scene.height = 65;
        const PointBatch points    = points_of(scene);
        const std::size_t centre   = points.size() / 2;
        ASSERT_NE(points.triangle[centre], kNoTriangle);
        middle.push_back(shaded(ShadingModel::gouraud, scene, points).linear.at(centre, 0));
    }
    for (const double value : middle) EXPECT_NEAR(value, middle[0], 1e-5);
}

/// A folded sheet whose normals are averaged: they all point up, and the folds are gone.
TEST(Interpolation, AveragedNormalsHideAZigzag) {
    Scene scene               = seen_from_above({0, 0, 0});
    scene.lights[0].kind      = LightKind::directional;
    scene.lights[0].direction = {-1, -1, 0};
    Mesh sheet;
    for (int k = 0; k <= 8; ++k)
        for (const float z : {-1.0f, 1.0f})
            sheet.positions.emplace_back(-1 + 0.25f * float(k), k % 2 == 0 ? 0 : 0.1f, z);
    for (std::uint32_t k = 0; k < 8; ++k) {
        sheet.triangles.emplace_back(2 * k, 2 * k + 1, 2 * k + 2);
        sheet.triangles.emplace_back(2 * k + 1, 2 * k + 3, 2 * k + 2);
    }
    const Mesh smooth = with_averaged_normals(sheet);
    add_object(scene, "sheet", smooth.positions, smooth.normals, smooth.triangles, 0);
    const PointBatch points = points_of(scene);
    const auto spread       = [&](ShadingModel model) {
        const Image picture = shaded(model, scene, points).linear;
        float least = 1, most = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (std::abs(points.px[i]) > 0.7f) continue;  // the first and the last fold have one side alone
            least = std::min(least, picture.at(i, 0)), most = std::max(most, picture.at(i, 0));
        }
        return most - least;
    };
    // Faces rise and fall by 0.1 on 0.25: N.L is cos(45 degrees -+ atan(0.4)).
    EXPECT_NEAR(spread(ShadingModel::flat), std::cos(kPi / 4 - std::atan(0.4)) - std::cos(kPi / 4 + std::atan(0.4)),
                1e-5);
    EXPECT_LT(spread(ShadingModel::phong), 1e-5);
    EXPECT_LT(spread(ShadingModel::gouraud), 1e-5);
}

/// A ball of eight sides looks smooth inside, and its outline has eight sides: an octagon's area.
TEST(Interpolation, SilhouettesStayPolygons) {
    Scene scene         = seen_from_above({0, 5, 0});
    scene.camera.height = 2.2f;
    scene.width = scene.height = 220;
    const Mesh ball            = make_sphere(1, 8, 16);
    add_object(scene, "ball", ball.positions, ball.normals, ball.triangles, 0);
    const PointBatch points = points_of(scene);
    const double area       = double(surfaces(points)) / 1e4;  // 100 pixels a unit
    EXPECT_NEAR(area, 2 * std::sqrt(2.0), 0.01);
    EXPECT_LT(area, 0.95 * kPi);
    // Inside, where its normals point to the lamp above, it is as bright as a ball.
    const Image phong        = shaded(ShadingModel::phong, scene, points).linear;
    const std::size_t middle = std::size_t(110) * 220 + 110;
    EXPECT_NEAR(phong.at(middle, 0), 1, 1e-3);
}

}  // namespace
}  // namespace umbra
