#include "umbra/shadows/geometry/edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "umbra/core/base/error.h"
#include "umbra/tests/support/mesh_scene.h"

namespace umbra {
namespace {

// Of any soup under a sun in the zenith: the number of triangles over or under a point is what the edges change on the
// way there from infinity.
TEST(Edges, ChangesAddUpToTheNumberOfTriangles) {
    std::mt19937 random(1);
    std::vector<vec3> positions(12);
    for (vec3& p : positions) p = {random() % 7, random() % 7, random() % 7};
    std::vector<uvec3> triangles(40);
    for (uvec3& t : triangles) t = {random() % 12, random() % 12, random() % 12};
    const Scene scene = scene_of(positions, triangles);
    const OccluderMesh mesh(scene);
    Light sun;
    sun.kind           = LightKind::directional;
    sun.direction      = {0, -1, 0};
    const auto signs   = sides_of_light(scene, sun);
    const auto changes = mesh.edges.changes(signs);
    int most           = 0;
    for (double x = 0.0371; x < 6; x += 0.5)
        for (double z = 0.0193; z < 6; z += 0.5) {
            int count = 0, by_edges = 0;
            const auto side = [&](vec3 a, vec3 b) {  // of the point to the line through a and b, from above
                return (z - double(a.z)) * double(b.x - a.x) - (x - double(a.x)) * double(b.z - a.z) > 0;
            };
            for (TriangleId t = 0; t < triangles.size(); ++t) {
                const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), c = scene.vertex(t, 2);
                const int sides = int{side(a, b)} + int{side(b, c)} + int{side(c, a)};
                count += mesh.blocks(t) && sides % 3 == 0 && signs[t] != 0;
            }
            for (const ChangeEdge& e : changes) {
                const vec3 a = mesh.position(e.a), b = mesh.position(e.b);
                EXPECT_LT(e.a, e.b);
                EXPECT_NE(e.change, 0);
                const bool rises = double(a.z) < z;
                if (rises == (double(b.z) < z) || side(a, b) == rises) continue;
                by_edges += rises ? e.change : -e.change;  // to its left where it runs towards us, along z
            }
            EXPECT_EQ(by_edges, count) << x << ' ' << z;
            most = std::max(most, count);
        }
    EXPECT_GT(most, 3);
}

// Turned normals say from where the two triangles of an edge cancel, whichever way they are wound.
TEST(Edges, PointsOnOppositeSidesOfTurnedNormalsSeeNoChange) {
    for (const uvec3 other : {uvec3(1, 0, 3), uvec3(0, 1, 3)})
        for (const vec3 eye : {vec3(0, 5, 0), vec3(0, -5, 0), vec3(5, 0.1f, 0), vec3(-5, 0.1f, 0)}) {
            const Scene scene = scene_of({{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {1, 1, 0}}, {{0, 1, 2}, other});
            const OccluderMesh mesh(scene);
            Light lamp;
            lamp.kind        = LightKind::point;
            lamp.position    = eye;
            const auto sides = sides_of_light(scene, lamp);
            ASSERT_EQ(mesh.edges.size(), 5u);
            const auto uses = mesh.edges.uses(0);
            ASSERT_EQ(uses.size(), 2u);
            bool front[2];
            for (std::size_t k = 0; k < 2; ++k) {
                const TriangleId t = uses[k].triangle;
                const vec3 n       = normal_unless_thin(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
                front[k]           = glm::dot(turned(n, uses[k]), eye) > 0;
            }
            EXPECT_EQ(mesh.edges.change(0, [&](TriangleId t) { return sides[t]; }) == 0, front[0] != front[1]);
        }
}

TEST(Edges, ThinTrianglesHaveNoNormal) {
    EXPECT_EQ(normal_unless_thin({0, 0, 0}, {1, 0, 0}, {2, 1e-7f, 0}), vec3(0));
    EXPECT_EQ(normal_unless_thin({0, 0, 0}, {1, 0, 0}, {2, 1e-4f, 0}), vec3(0, 0, 1));
}

/// Triangles are numbered in 31 bits.
TEST(Edges, RefusesTrianglesThatItCannotNumber) {
    Topology topology;
    topology.triangles.resize(1);
    topology.first_triangle = 0x7fffffffu;
    EXPECT_NO_THROW(EdgeList{topology});
    topology.triangles.resize(2);
    EXPECT_THROW(EdgeList{topology}, MethodError);
    topology.first_triangle = 0xffffffffu;
    EXPECT_THROW(EdgeList{topology}, MethodError);
}

TEST(Edges, OfOccludersAreThoseThatBlockLight) {
    // The second triangle has no area.
    Scene scene = scene_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 1, 3}});
    const OccluderMesh mesh(scene);
    EXPECT_TRUE(mesh.blocks(0) && mesh.has_area(0));
    EXPECT_FALSE(mesh.blocks(1) || mesh.has_area(1));
    EXPECT_EQ(mesh.edges.size(), 3u);
    scene.transparent           = TransparentOccluders::multiply;
    scene.materials[0].transmit = 0.5f;
    const OccluderMesh glass(scene);
    EXPECT_TRUE(!glass.blocks(0) && glass.has_area(0) && !glass.has_area(1));
    EXPECT_EQ(glass.edges.size(), 0u);

    const EdgeList all(find_topology(scene, 1, 1), 10);
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(all[0].a, 10u);
    EXPECT_EQ(all.uses(0)[0].triangle, 1u);
}

}  // namespace
}  // namespace umbra
