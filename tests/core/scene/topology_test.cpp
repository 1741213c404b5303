#include "umbra/core/scene/topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "umbra/tests/support/mesh_scene.h"

namespace umbra {
namespace {

Topology topology_of(const Scene& scene) {
    return find_topology(scene, 0, static_cast<std::uint32_t>(scene.triangles.size()));
}

TEST(Topology, WeldsEqualPositionsAndZeroWithMinusZero) {
    // Two triangles with positions of their own that meet in an edge, once written with -0.
    const Scene scene = scene_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, -0.0f, 0}, {-0.0f, 0, -0.0f}, {0, -1, 0}},
                                 {{0, 1, 2}, {3, 4, 5}});
    const Topology t  = topology_of(scene);
    EXPECT_EQ(t.position.size(), 4u);
    ASSERT_EQ(t.edges.size(), 5u);
    const auto shared = std::find_if(t.edges.begin(), t.edges.end(), [](const Edge& e) { return e.count == 2; });
    ASSERT_NE(shared, t.edges.end());
    EXPECT_NE(t.uses[shared->first].forward, t.uses[shared->first + 1].forward);
    EXPECT_EQ(t.uses[shared->first].triangle, 0u);
    EXPECT_EQ(t.uses[shared->first].side, 0);
    EXPECT_EQ(t.uses[shared->first + 1].triangle, 1u);
}

TEST(Topology, KeepsPositionsApartThatDifferInTheLastBit) {
    const Scene scene =
        scene_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {std::nextafter(1.0f, 2.0f), 0, 0}}, {{0, 1, 2}, {0, 3, 2}});
    EXPECT_EQ(topology_of(scene).position.size(), 4u);
}

TEST(Topology, UnusedPositionsAreNoVertices) {
    const Scene scene = scene_of({{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {8, 8, 8}}, {{1, 2, 3}});
    EXPECT_EQ(topology_of(scene).position.size(), 3u);
}

TEST(Topology, EveryUseRunsItsEdge) {
    // A random soup over few positions, so that edges of many triangles occur, and corners that repeat.
    std::mt19937 random(1);
    std::vector<vec3> positions(40);
    for (vec3& p : positions) p = {float(random() % 3), float(random() % 3), float(random() % 3)};
    std::vector<uvec3> triangles(500);
    for (uvec3& t : triangles) t = {random() % 40, random() % 40, random() % 40};
    const Scene scene = scene_of(positions, triangles);
    const Topology t  = topology_of(scene);

    std::size_t sides = 0;
    for (std::uint32_t i = 0; i < 500; ++i)
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(positions[t.position[t.triangles[i][k]]], positions[triangles[i][k]]);
            sides += !t.repeats_a_corner(i);
        }
    EXPECT_EQ(t.uses.size(), sides);
    std::uint32_t next = 0;
    for (std::size_t e = 0; e < t.edges.size(); ++e) {
        const Edge& edge = t.edges[e];
        EXPECT_LT(edge.a, edge.b);
        EXPECT_EQ(edge.first, next);
        if (e > 0) {
            EXPECT_TRUE(std::pair(t.edges[e - 1].a, t.edges[e - 1].b) < std::pair(edge.a, edge.b));
        }
        for (std::uint32_t u = edge.first; u < edge.first + edge.count; ++u) {
            const uvec3 v = t.triangles[t.uses[u].triangle];
            EXPECT_EQ(v[t.uses[u].side], t.uses[u].forward ? edge.a : edge.b);
            EXPECT_EQ(v[(t.uses[u].side + 1) % 3], t.uses[u].forward ? edge.b : edge.a);
        }
        next += edge.count;
    }
    EXPECT_EQ(next, t.uses.size());
}

TEST(Topology, ATriangleThatRepeatsACornerLeavesItsNeighboursAlone) {
    // A needle without width between two triangles: (0, 1, 1) would run the edge of the two both ways.
    const Scene scene = scene_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 1}, {1, 0, 3}});
    const Topology t  = topology_of(scene);
    EXPECT_EQ(t.edges.size(), 5u);
    EXPECT_TRUE(std::all_of(t.edges.begin(), t.edges.end(), [](const Edge& e) { return e.count <= 2; }));
}

TEST(Topology, OneObjectOfSeveral) {
    Scene scene = scene_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
    add_object(scene, "second", {{1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {}, {{0, 2, 1}}, 0);
    const Topology second = find_topology(scene, 1, 1);
    EXPECT_EQ(second.position.size(), 3u);
    EXPECT_EQ(scene.positions[second.position[1]], vec3(1, 1, 0));
    EXPECT_EQ(topology_of(scene).position.size(), 4u) << "over the whole scene the two share an edge";
}

TEST(Topology, DegenerateMeansExactlyOnOneLine) {
    const auto third = 1.0f / 3.0f;
    EXPECT_TRUE(is_degenerate({0, 0, 0}, {1, 1, 1}, {3, 3, 3}));
    EXPECT_TRUE(is_degenerate({0, 0, 0}, {third, third, 1}, {2 * third, 2 * third, 2}));
    EXPECT_TRUE(is_degenerate({1, 2, 3}, {1, 2, 3}, {4, 5, 6}));
    EXPECT_FALSE(is_degenerate({0, 0, 0}, {third, third, 1}, {2 * third, std::nextafter(2 * third, 1.0f), 2}));
    EXPECT_FALSE(is_degenerate({0, 0, 0}, {1e-30f, 0, 0}, {0, 1e-30f, 0})) << "its area underflows in float only";
    // A far sliver whose area is below the rounding of its products in double.
    EXPECT_FALSE(is_degenerate({1e10f, 0, 1e-30f}, {2e10f, 0, 0}, {4e10f, 0, 0}));
}

}  // namespace
}  // namespace umbra
