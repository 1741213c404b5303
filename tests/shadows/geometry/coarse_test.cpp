// Coarser occluders: what is joined, what stays, and what rays then answer.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/geometry/coarse.h"
#include "umbra/tests/support/mesh_scene.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

/// A sheet of n x n squares.
Scene grid(int n, float width) {
    const Mesh sheet = make_plane(width, width, n);
    return scene_of(sheet.positions, sheet.triangles);
}

double area(const Scene& scene, const std::vector<uvec3>& triangles) {
    double sum = 0;
    for (const uvec3 t : triangles) {
        const dvec3 a(scene.positions[t.x]), b(scene.positions[t.y]), c(scene.positions[t.z]);
        sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
}

std::size_t with_area(const std::vector<uvec3>& triangles) {
    std::size_t count = 0;
    for (const uvec3 t : triangles) count += t.x != t.y && t.y != t.z && t.z != t.x;
    return count;
}

TEST(Coarse, LeavesWhatIsFarApart) {
    const Scene scene = grid(8, 8);
    EXPECT_EQ(coarse_triangles(scene, 0.5), scene.triangles);
    EXPECT_EQ(coarse_triangles(scene, 1e-30), scene.triangles) << "cells whose numbers no integer holds";
}

TEST(Coarse, JoinsVerticesAndKeepsTheBorder) {
    const Scene scene               = grid(64, 8);  // squares 1/8 wide
    const std::vector<uvec3> coarse = coarse_triangles(scene, 1);
    EXPECT_EQ(coarse.size(), scene.triangles.size()) << "each keeps its number";
    EXPECT_LT(with_area(coarse), scene.triangles.size() / 20);
    std::set<std::uint32_t> used;
    for (std::size_t t = 0; t < coarse.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            used.insert(coarse[t][k]);
            const vec3 from = scene.positions[scene.triangles[t].x], to = scene.positions[coarse[t][k]];
            EXPECT_LT(glm::length(from - to), 2.0f * std::sqrt(2.0f)) << t;
        }
    for (const std::uint32_t corner : {0u, 64u, 65u * 64, 65u * 65 - 1})
        EXPECT_TRUE(used.contains(corner)) << "a corner of the sheet is the vertex that its cell keeps";
    EXPECT_NEAR(area(scene, coarse), 64, 64 * 0.02);
}

TEST(Coarse, KeepsNoTriangleTwiceAndJoinsNoObjects) {
    Scene scene = grid(16, 1);
    add_object(scene, "above", {{-0.5f, 0.01f, 0.5f}, {0.5f, 0.01f, 0.5f}, {0.5f, 0.01f, -0.5f}}, {}, {{0, 1, 2}}, 0);
    const std::vector<uvec3> coarse = coarse_triangles(scene, 0.4);
    EXPECT_EQ(coarse.back(), scene.triangles.back());
    std::set<std::set<std::uint32_t>> seen;
    for (const uvec3 t : coarse) {
        if (t.x == t.y) continue;
        EXPECT_TRUE(seen.insert({t.x, t.y, t.z}).second) << t.x << " " << t.y << " " << t.z;
    }
}

TEST(Coarse, MakesOneSheetOfTwoThatAreCloseTogether) {
    const Scene one              = grid(4, 1);
    std::vector<vec3> positions  = one.positions;
    std::vector<uvec3> triangles = one.triangles;
    const auto first             = static_cast<std::uint32_t>(positions.size());
    for (const vec3 p : one.positions) positions.push_back(p + vec3(0, 0.01f, 0));
    for (const uvec3 t : one.triangles) triangles.emplace_back(t.x + first, t.z + first, t.y + first);
    const Scene slab = scene_of(positions, triangles);
    for (const double cell : {0.2, 0.3}) {
        const std::size_t whole = with_area(coarse_triangles(one, cell));
        EXPECT_GT(whole, 0u);
        EXPECT_EQ(with_area(coarse_triangles(slab, cell)), whole) << cell;
    }
    EXPECT_EQ(with_area(coarse_triangles(slab, 0.004)), slab.triangles.size());
}

/// A floor, a ball of many triangles above it, and a lamp.
Scene ball_scene(LightKind kind) {
    Scene scene = grid(1, 8);
    Mesh ball   = make_sphere(1, 64, 64);
    for (vec3& p : ball.positions) p.y += 2;
    add_object(scene, "ball", ball.positions, {}, ball.triangles, 0);
    Light light;
    light.name     = "lamp";
    light.kind     = kind;
    light.position = {0, 6, 0}, light.direction = {0, -1, 0};
    light.edge_u = {1, 0, 0}, light.edge_v = {0, 0, -1};
    scene.lights     = {light};
    scene.camera.eye = {0, 5, 9}, scene.camera.target = {0, 0, 0};
    scene.width = 96, scene.height = 54;
    return scene;
}

TEST(Coarse, RaysMeetTheCoarserBall) {
    for (const LightKind kind : {LightKind::point, LightKind::rectangle}) {
        const Scene scene       = ball_scene(kind);
        const PointBatch points = primary(scene);
        const auto s            = [&](const std::string& method) {
            MethodCase rays(method, scene);
            rays.prepare(0);
            return rays.visibility(points, 0).s;
        };
        const auto mae = [&](const std::vector<float>& a, const std::vector<float>& b) {
            double sum = 0;
            for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
            return sum / double(a.size());
        };
        const auto fine = s("ray_traced");
        EXPECT_EQ(s("ray_traced:coarseness=0"), fine);
        const double small = mae(s("ray_traced:coarseness=0.01"), fine),
                     large = mae(s("ray_traced:coarseness=0.1"), fine);
        EXPECT_GT(small, 0);
        EXPECT_LT(small, 0.02);
        EXPECT_GT(large, 2 * small);
        EXPECT_LT(large, 0.2) << "there is a shadow";
        const auto size = [&](const char* method) {
            MethodCase rays(method, scene);
            rays.build();
            return rays.built().memory_bytes();
        };
        EXPECT_LT(size("ray_traced:coarseness=0.1"), size("ray_traced:cull=none") / 2) << "fewer triangles in the tree";
    }
}

/// The coarser ball lies above the fine one in places: rays start above it, so that few of the ball's own points are dark.
TEST(Coarse, RaysStartAboveTheCoarserBall) {
    const Scene scene       = ball_scene(LightKind::point);
    const PointBatch points = primary(scene);
    const auto s            = [&](const std::string& method) {
        MethodCase rays(method, scene);
        rays.prepare(0);
        return rays.visibility(points, 0).s;
    };
    const auto fine = s("ray_traced"), coarse = s("ray_traced:coarseness=0.02");
    std::size_t lit = 0, dark = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle || scene.triangle_object[points.triangle[i]] != 1u ||
            !is_open(points, 0, i) || fine[i] != 1)
            continue;
        ++lit, dark += coarse[i] < 1 ? 1 : 0;
    }
    EXPECT_GT(lit, 50u);
    EXPECT_LT(double(dark), 0.05 * double(lit));
}

TEST(Coarse, BlameNamesTrianglesOfTheBall) {
    const Scene scene       = ball_scene(LightKind::point);
    const PointBatch points = primary(scene);
    MethodCase rays("ray_traced:coarseness=0.05", scene);
    rays.prepare(0);
    const VisibilityPlane plane = rays.visibility(points, 0);
    std::vector<TriangleId> blockers(points.size());
    rays.blame(points, 0, blockers);
    std::size_t dark = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i) || plane.s[i] != 0) continue;
        ASSERT_LT(blockers[i], scene.triangles.size());
        EXPECT_EQ(scene.triangle_object[blockers[i]], 1u);
        ++dark;
    }
    EXPECT_GT(dark, 100u);
}

}  // namespace
}  // namespace umbra
