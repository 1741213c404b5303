// Silhouettes: known bodies, chains that close, and McGuire's expected number.
#include "umbra/shadows/volumes/silhouettes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "umbra/core/base/parallel.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

Scene scene_of(const std::vector<Mesh>& meshes) {
    Scene scene;
    scene.materials.emplace_back();
    for (const Mesh& m : meshes)
        add_object(scene, "object" + std::to_string(scene.objects.size()), m.positions, {}, m.triangles, 0);
    return scene;
}

Light towards(vec3 travel) {
    Light light;
    light.kind      = LightKind::directional;
    light.direction = travel;
    return light;
}

SilhouetteMeshes meshes_of(const Scene& scene) { return {scene, find_object_facts(scene)}; }

/// Sum of the angles between the normals of neighbouring triangles over pi, of a closed mesh.
double expected_silhouette(const Scene& scene) {
    const SilhouetteMeshes meshes = meshes_of(scene);
    const auto normal             = [&](TriangleId t) { return glm::normalize(area_normal(scene, t)); };
    double sum                    = 0;
    for (const Neighbours& e : meshes.objects()[0].neighbours()) {
        const dvec3 l = normal(e.left), r = normal(e.right);
        sum += std::atan2(glm::length(glm::cross(l, r)), glm::dot(l, r));
    }
    return sum / kPi;
}

TEST(Silhouettes, ABoxHasSixFromEverywhere) {
    const auto statistics = silhouette_statistics(scene_of({make_box({1, 2, 3})}), 1000, 1);
    ASSERT_EQ(statistics.size(), 1u);
    EXPECT_EQ(statistics[0].object, "object0");
    EXPECT_EQ(statistics[0].directions, 1000u);
    EXPECT_EQ(statistics[0].mean, 6);
    EXPECT_EQ(statistics[0].standard_error, 0);
}

TEST(Silhouettes, TheMeanIsTheSumOfDihedralAnglesOverPi) {
    for (const Mesh& mesh : {make_sphere(1, 24, 12), make_torus(1, 0.4f, 24, 14), make_cone(1, 2, 17)}) {
        const Scene scene     = scene_of({mesh});
        const double expected = expected_silhouette(scene);
        for (const std::uint64_t seed : {1u, 2u, 3u}) {
            const SilhouetteStatistics s = silhouette_statistics(scene, 5000, seed)[0];
            EXPECT_GT(s.standard_error, 0);
            EXPECT_LT(std::abs(s.mean - expected), 3.5 * s.standard_error) << s.mean << " expected " << expected;
        }
    }
}

TEST(Silhouettes, DirectionsDependOnTheSeedAndNotOnThreads) {
    const Scene scene = scene_of({make_torus(1, 0.4f, 24, 14), make_plane(1, 1)});
    const auto all    = silhouette_statistics(scene, 1000, 5);
    const auto other  = silhouette_statistics(scene, 1000, 6);
    const ThreadLimit one(1);
    const auto single = silhouette_statistics(scene, 1000, 5);
    for (std::size_t o = 0; o < 2; ++o) {
        EXPECT_EQ(all[o].mean, single[o].mean);
        EXPECT_EQ(all[o].standard_error, single[o].standard_error);
    }
    EXPECT_NE(all[0].mean, other[0].mean);
}

TEST(Silhouettes, TheBorderOfAnOpenMeshAlwaysCounts) {
    EXPECT_EQ(silhouette_statistics(scene_of({make_plane(1, 1)}), 500, 1)[0].mean, 4);
    // A misoriented pair is the same square to the light.
    Mesh plane = make_plane(1, 1);
    std::swap(plane.triangles[0][0], plane.triangles[0][1]);
    EXPECT_EQ(silhouette_statistics(scene_of({plane}), 500, 1)[0].mean, 4);
    // Three triangles on one edge: it and the six others.
    Mesh fan;
    fan.positions = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0.1f}, {-1, 0, 0.2f}, {0.3f, 0, 1}};
    fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    EXPECT_EQ(silhouette_statistics(scene_of({fan}), 500, 1)[0].mean, 7);
}

TEST(Silhouettes, KnowsClosedMeshesAndSolids) {
    const Mesh box = make_box({1, 1, 1});
    Mesh open = box, inward = box, touching = box, mixed = box, flipped = box;
    open.triangles.pop_back();
    for (uvec3& t : inward.triangles) std::swap(t[1], t[2]);
    std::swap(flipped.triangles[3][0], flipped.triangles[3][1]);
    const auto append = [](Mesh& to, const Mesh& from, vec3 at, bool flip) {
        const auto base = static_cast<std::uint32_t>(to.positions.size());
        for (const vec3 p : from.positions) to.positions.push_back(p + at);
        for (const uvec3 t : from.triangles) to.triangles.push_back(base + (flip ? uvec3(t[1], t[0], t[2]) : t));
    };
    append(touching, box, {1, 1, 1}, false);  // at one corner
    append(mixed, box, {3, 0, 0}, true);
    const Scene scene             = scene_of({box, open, inward, touching, mixed, flipped, make_torus(1, 0.3f, 9, 7)});
    const auto facts              = find_object_facts(scene);
    const SilhouetteMeshes meshes = meshes_of(scene);
    const bool closed[]           = {true, false, true, false, true, false, true};
    const bool solid[]            = {true, false, false, false, false, false, true};
    for (std::size_t o = 0; o < 7; ++o) {
        EXPECT_EQ(meshes.objects()[o].closed(), closed[o]) << o;
        EXPECT_EQ(meshes.objects()[o].soup().size() == 0, closed[o]) << o;
        EXPECT_EQ(facts[o].solid, solid[o]) << o;
    }
}

TEST(Silhouettes, ATriangleInAPlaneWithTheLightFacesItNot) {
    const Scene scene = scene_of({make_box({2, 2, 2})});
    int sum = 0, absolute = 0;
    for (const std::int8_t f : sides_of_light(scene, towards({0, -1, 0}))) sum += f, absolute += f * f;
    EXPECT_EQ(sum, 0);
    EXPECT_EQ(absolute, 4);  // top and bottom; the other four faces are seen edge on
    Light light;             // in the planes of the top and of the face at +x
    light.position = {1, 1, 5};
    absolute       = 0;
    for (const std::int8_t f : sides_of_light(scene, light)) absolute += f * f;
    EXPECT_EQ(absolute, 8);
}

// A box with a corner in the middle of an edge: a triangle without area closes it.
TEST(Silhouettes, ATriangleWithoutAreaLeavesAMeshASolid) {
    Mesh box          = make_box({2, 2, 2});
    const uvec3 last  = box.triangles.back();
    const auto middle = static_cast<std::uint32_t>(box.positions.size());
    box.positions.push_back(0.5f * (box.positions[last[0]] + box.positions[last[1]]));
    box.triangles.back() = {last[0], middle, last[2]};
    box.triangles.push_back({middle, last[1], last[2]});
    box.triangles.push_back({last[0], last[1], middle});
    const Scene scene = scene_of({box});
    const auto facts  = find_object_facts(scene);
    EXPECT_EQ(facts[0].degenerate_triangles, 1u);
    EXPECT_FALSE(facts[0].closed);
    EXPECT_TRUE(facts[0].manifold);
    EXPECT_TRUE(facts[0].solid);
    EXPECT_TRUE(meshes_of(scene).objects()[0].closed());
}

// The neighbours of every edge as the triangles themselves name them, of closed meshes that lie behind one another in a
// scene and that share positions.
TEST(Silhouettes, NeighboursRunTheirEdgeInBothDirections) {
    const Scene scene =
        scene_of({make_plane(1, 1), make_torus(1, 0.4f, 9, 7), make_box({1, 1, 1}), make_cone(1, 2, 5)});
    const SilhouetteMeshes meshes = meshes_of(scene);
    std::map<std::pair<std::uint32_t, std::uint32_t>, TriangleId> runs;  // directed edge -> its triangle
    for (TriangleId t = 0; t < scene.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const uvec3 v = meshes.triangles()[t];
            runs.insert({{v[k], v[(k + 1) % 3]}, t});
        }
    for (std::size_t o = 1; o < 4; ++o) {
        auto edge             = runs.begin();
        const auto neighbours = meshes.objects()[o].neighbours();
        EXPECT_EQ(2 * neighbours.size(), 3 * scene.objects[o].triangle_count);
        const TriangleId first = scene.objects[o].first_triangle, end = first + scene.objects[o].triangle_count;
        for (const Neighbours& n : neighbours) {
            while (edge->first.first > edge->first.second || edge->second < first || edge->second >= end) ++edge;
            EXPECT_EQ(n.left, edge->second);
            EXPECT_EQ(n.right, runs.at({edge->first.second, edge->first.first}));
            ++edge;
        }
    }
}

TEST(Silhouettes, SidesOfALightAreExact) {
    Mesh open = make_box({1, 3, 2});
    open.triangles.pop_back();
    const Scene scene = scene_of({make_sphere(1, 12, 7), open, make_box({1, 3, 2})});
    std::mt19937 random(1);
    const auto grid = [&] { return vec3(random() % 5, random() % 5, random() % 5) - 2.0f; };
    int in_plane    = 0;
    for (int round = 0; round < 40; ++round) {
        Light light      = towards(grid() + vec3(0, 0, 0.25f));
        light.kind       = round % 2 ? LightKind::directional : LightKind::point;
        light.position   = 0.5f * grid();
        const auto found = sides_of_light(scene, light);
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
            const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
            using Exact            = glm::vec<3, long double>;
            const Exact n          = glm::cross(Exact(b) - Exact(a), Exact(c) - Exact(a));
            const Exact d          = round % 2 ? -Exact(light.direction) : Exact(light.position) - Exact(a);
            const long double side = glm::dot(n, d);
            const bool sphere      = t < scene.objects[0].triangle_count;  // long double rounds its products
            if (sphere && std::abs(side) < 1e-15L * glm::length(d)) continue;
            EXPECT_EQ(found[t], (side > 0) - (side < 0)) << t;
            in_plane += side == 0;
        }
    }
    EXPECT_GT(in_plane, 100);
}

TEST(Silhouettes, ASunAboveABoxSeesASquare) {
    const Scene scene                    = scene_of({make_box({2, 2, 2})});
    const SilhouetteMeshes meshes        = meshes_of(scene);
    std::vector<std::int8_t> orientation = sides_of_light(scene, towards({0, -1, 0}));
    for (std::int8_t& t : orientation) t = std::max<std::int8_t>(t, 0);
    const auto edges = meshes.edges(orientation);
    ASSERT_EQ(edges.size(), 4u);
    for (const ChangeEdge& e : edges) {
        EXPECT_EQ(std::abs(e.change), 1);
        EXPECT_EQ(meshes.vertices()[e.a].y, 1);
        EXPECT_EQ(meshes.vertices()[e.b].y, 1);
    }
}

// Whatever triangles are chosen and however they are oriented, their boundary runs into every vertex as often as out.
TEST(Silhouettes, EdgesCloseForAnySoup) {
    std::mt19937 random(1);
    for (int round = 0; round < 20; ++round) {
        Mesh soup;
        for (int k = 0; k < 12; ++k) soup.positions.emplace_back(random() % 7, random() % 7, random() % 7);
        for (int k = 0; k < 60; ++k) soup.triangles.emplace_back(random() % 12, random() % 12, random() % 12);
        const Scene scene             = scene_of({soup, make_sphere(1, 8, 5)});
        const SilhouetteMeshes meshes = meshes_of(scene);
        std::vector<std::int8_t> orientation(scene.triangles.size());
        for (std::int8_t& t : orientation) t = static_cast<std::int8_t>(static_cast<int>(random() % 3) - 1);
        std::map<std::uint32_t, int> flow;
        std::size_t edges = 0;
        for (const ChangeEdge& e : meshes.edges(orientation)) {
            EXPECT_NE(e.change, 0);
            flow[e.a] += e.change;
            flow[e.b] -= e.change;
            ++edges;
        }
        EXPECT_GT(edges, 20u);
        for (const auto& [vertex, sum] : flow) EXPECT_EQ(sum, 0) << vertex;
    }
}

}  // namespace
}  // namespace umbra
