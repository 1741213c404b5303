// Spheres and boxes among meshes: what is one, with which size, and what only looks like one.
#include "umbra/bench/studies/light/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include <glm/gtc/matrix_transform.hpp>

#include "umbra/core/io/scene_io.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

Scene scene_of(const std::vector<Mesh>& meshes) {
    Scene scene;
    scene.materials.resize(1);
    for (const Mesh& mesh : meshes) add_object(scene, "mesh", mesh.positions, mesh.normals, mesh.triangles, 0);
    return scene;
}

Mesh moved(Mesh mesh, vec3 by) {
    for (vec3& p : mesh.positions) p += by;
    return mesh;
}

/// Two meshes as one, without any vertex in common.
Mesh joined(Mesh a, const Mesh& b) {
    const auto first = static_cast<std::uint32_t>(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
    for (const uvec3 t : b.triangles) a.triangles.push_back(t + first);
    return a;
}

/// Every triangle has vertices of its own.
Mesh soup(const Mesh& mesh) {
    Mesh apart;
    for (const uvec3 t : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(apart.positions.size());
        for (int k = 0; k < 3; ++k) {
            apart.positions.push_back(mesh.positions[t[k]]);
            if (!mesh.normals.empty()) apart.normals.push_back(mesh.normals[t[k]]);
        }
        apart.triangles.emplace_back(first, first + 1, first + 2);
    }
    return apart;
}

mat4 turned() {
    return glm::translate(mat4(1), vec3(4, -2, 1)) * glm::rotate(mat4(1), 0.7f, glm::normalize(vec3(1, 2, -1)));
}

std::size_t bodies_in(const Mesh& mesh) { return find_bodies(scene_of({mesh})).list.size(); }

TEST(FindBodies, SphereHasItsCentreAndRadius) {
    const Bodies bodies = find_bodies(scene_of({make_plane(3, 3, 5), moved(make_sphere(2, 12, 6), vec3(3, -1, 5))}));
    ASSERT_EQ(bodies.list.size(), 1u);
    const Body& ball = bodies.list[0];
    EXPECT_EQ(ball.kind, BodyKind::sphere);
    EXPECT_NEAR(glm::length(ball.centre - dvec3(3, -1, 5)), 0, 1e-6);
    EXPECT_NEAR(ball.radius, 2, 1e-6);
    EXPECT_FALSE(ball.inside_out);
    EXPECT_EQ(ball.object, 1u);
    EXPECT_EQ(ball.holder, 50u);
    for (TriangleId t = 0; t < bodies.of_mesh.size(); ++t) EXPECT_EQ(bodies.of_mesh[t], t < 50 ? kNoBody : 0) << t;
    EXPECT_EQ(bodies.count(BodyKind::sphere), 1u);
    EXPECT_EQ(bodies.count(BodyKind::box), 0u);
    EXPECT_EQ(bodies.triangles(), 120u);
}

/// Cut unevenly, so that the mean of its vertices is not its centre.
TEST(FindBodies, CentreIsNotTheMeanOfVertices) {
    Mesh ball = make_sphere(1, 24, 12);
    for (std::size_t i = 0; i < ball.positions.size(); ++i) {
        const dvec3 n   = glm::normalize(dvec3(ball.positions[i]) + dvec3(0, 0.6, 0));
        ball.normals[i] = vec3(n), ball.positions[i] = vec3(dvec3(5, 0, 0) + 3.0 * n);
    }
    const Bodies bodies = find_bodies(scene_of({ball}));
    ASSERT_EQ(bodies.list.size(), 1u);
    EXPECT_NEAR(glm::length(bodies.list[0].centre - dvec3(5, 0, 0)), 0, 1e-6);
    EXPECT_NEAR(bodies.list[0].radius, 3, 1e-6);
}

TEST(FindBodies, BoxHasItsAxesInAnyOrientation) {
    for (const mat4& m : {mat4(1), turned()}) {
        const Bodies bodies = find_bodies(scene_of({transformed(make_box({1, 2, 3}), m)}));
        ASSERT_EQ(bodies.list.size(), 1u);
        const Body& box = bodies.list[0];
        EXPECT_EQ(box.kind, BodyKind::box);
        EXPECT_FALSE(box.inside_out);
        EXPECT_NEAR(glm::length(box.centre - dvec3(m[3])), 0, 1e-6);
        std::array<bool, 3> seen{};
        for (int k = 0; k < 3; ++k) {
            const int original = static_cast<int>(std::lround(2 * box.half_size[k])) - 1;  // sizes are 1, 2, 3
            ASSERT_TRUE(original >= 0 && original < 3);
            seen[static_cast<std::size_t>(original)] = true;
            EXPECT_NEAR(2 * box.half_size[k], original + 1, 1e-6);
            EXPECT_NEAR(std::abs(glm::dot(box.axes[k], dvec3(m[original]))), 1, 1e-6);
        }
        EXPECT_TRUE(seen[0] && seen[1] && seen[2]);
    }
}

/// Vertices for each face, or for each triangle: connected by their positions alone.
TEST(FindBodies, CylinderConeAndTorusHaveTheirAxesAndSizes) {
    const auto check = [](const Mesh& mesh, BodyKind kind, double radius, double half) {
        const Bodies bodies = find_bodies(scene_of({transformed(mesh, turned())}));
        ASSERT_EQ(bodies.list.size(), 1u) << static_cast<int>(kind);
        const Body& body = bodies.list[0];
        EXPECT_EQ(body.kind, kind);
        EXPECT_FALSE(body.inside_out);
        EXPECT_NEAR(body.radius, radius, 1e-5);
        EXPECT_NEAR(body.half_size.z, half, 1e-5);
        const dvec3 axis(mat3(turned()) * vec3(0, 1, 0));
        EXPECT_NEAR(kind == BodyKind::cone ? glm::dot(body.axes[2], axis) : std::abs(glm::dot(body.axes[2], axis)), 1,
                    1e-6);
        EXPECT_NEAR(glm::length(body.centre - dvec3(vec3(turned()[3]))), 0, 1e-5);
        EXPECT_NEAR(glm::determinant(body.axes), 1, 1e-9);
        EXPECT_EQ(bodies.triangles(), mesh.triangles.size());
    };
    for (const int segments : {12, 32, 100}) {
        check(make_cylinder(0.7f, 3, segments), BodyKind::cylinder, 0.7, 1.5);
        check(make_cylinder(2, 1, segments), BodyKind::cylinder, 2, 0.5);
        check(make_cone(0.7f, 3, segments), BodyKind::cone, 0.7, 1.5);
        check(make_cone(2, 1, segments), BodyKind::cone, 2, 0.5);
        check(make_torus(2, 0.5f, segments, 13), BodyKind::torus, 2, 0.5);
        check(make_torus(1, 0.9f, segments, 16), BodyKind::torus, 1, 0.9);
    }
}

TEST(FindBodies, WhatIsAlmostTurnedIsNone) {
    const auto none = [](Mesh mesh, const std::function<void(Mesh&)>& change) {
        change(mesh);
        EXPECT_EQ(bodies_in(mesh), 0u);
    };
    for (const Mesh& mesh : {make_cylinder(1, 3, 32), make_cone(1, 3, 32), make_torus(2, 0.5f, 32, 16)}) {
        EXPECT_EQ(bodies_in(mesh), 1u);
        none(mesh, [](Mesh& m) {
            for (vec3& p : m.positions) p.x *= 1.01f;
        });
        none(mesh, [](Mesh& m) { m.positions[3] *= 1.01f; });
        none(mesh, [](Mesh& m) { m.normals.clear(); });
        none(mesh, [](Mesh& m) { m.normals[3] = vec3(0.6f, 0.48f, 0.64f); });
        none(mesh, [](Mesh& m) { m.triangles.pop_back(); });
    }
}

TEST(FindBodies, ConnectsEqualPositionsWhereVerticesAreNotShared) {
    EXPECT_EQ(bodies_in(soup(make_box({1, 2, 3}))), 1u);
    EXPECT_EQ(bodies_in(soup(make_sphere(1, 12, 6))), 1u);
    Mesh box = soup(make_box({1, 2, 3}));
    for (std::size_t t = 0; t < box.triangles.size(); ++t) {
        const vec3 a = box.positions[3 * t], b = box.positions[3 * t + 1], c = box.positions[3 * t + 2];
        for (int k = 0; k < 3; ++k) box.normals.push_back(glm::normalize(glm::cross(b - a, c - a)));
    }
    EXPECT_EQ(bodies_in(box), 1u) << "normals of its faces";
    EXPECT_EQ(bodies_in(with_averaged_normals(make_box({1, 2, 3}))), 0u) << "shaded as if it were round";
}

/// NFF: spheres of one material are one object; a negative radius is seen from inside.
TEST(FindBodies, SpheresOfOneObjectStayApart) {
    const TemporaryFolder folder;
    const auto file = folder.write("balls.nff", "f 1 0 0 1 0 0 0 1\ns 0 0 0 1\ns 1.5 0 0 1\ns 0 5 0 -2\n");
    Scene scene     = load_scene(file);
    ASSERT_EQ(scene.objects.size(), 1u);
    Bodies bodies = find_bodies(scene);
    ASSERT_EQ(bodies.list.size(), 3u);
    EXPECT_EQ(bodies.triangles(), scene.triangles.size());
    EXPECT_NEAR(bodies.list[1].centre.x, 1.5, 1e-6) << "the second interpenetrates the first";
    EXPECT_NEAR(bodies.list[2].radius, 2, 1e-6);
    EXPECT_FALSE(bodies.list[0].inside_out);
    EXPECT_TRUE(bodies.list[2].inside_out);
    for (TriangleId t = 0; t < scene.triangles.size(); ++t)
        EXPECT_EQ(bodies.of_mesh[t], t * 3 / scene.triangles.size()) << t;
    for (vec3& p : scene.positions) p += vec3(0, 0, 7);
    EXPECT_NEAR(find_bodies(scene).list[1].centre.z, 7, 1e-6) << "found again where the mesh was moved";
}

/// One on top of the other, with a face or a corner in common.
TEST(FindBodies, TouchingBodiesStayApart) {
    const Mesh box = make_box({1, 1, 1});
    EXPECT_EQ(bodies_in(joined(box, moved(box, {0, 1, 0}))), 2u);
    EXPECT_EQ(bodies_in(joined(box, moved(box, {1, 1, 1}))), 2u);
    const Mesh ball = make_sphere(1, 12, 6);
    EXPECT_EQ(bodies_in(joined(ball, moved(ball, {0, 2, 0}))), 2u);
}

TEST(FindBodies, WhatOnlyLooksLikeABodyIsNone) {
    const Mesh ball = make_sphere(1, 24, 12), box = make_box({1, 2, 3});
    const auto changed = [](Mesh mesh, const auto& change) {
        change(mesh);
        return mesh;
    };
    EXPECT_EQ(bodies_in(ball), 1u);
    EXPECT_EQ(bodies_in(make_plane(1, 1, 4)), 0u);
    EXPECT_EQ(bodies_in(make_sphere(1, 4, 2)), 0u) << "8 triangles";
    EXPECT_EQ(bodies_in(transformed(ball, glm::scale(mat4(1), vec3(1, 1.01f, 1)))), 0u) << "an ellipsoid";
    EXPECT_EQ(bodies_in(changed(ball, [](Mesh& m) { m.positions[40] *= 0.99f; })), 0u) << "dented";
    EXPECT_EQ(bodies_in(changed(ball, [](Mesh& m) { m.triangles.pop_back(); })), 0u) << "open";
    EXPECT_EQ(bodies_in(changed(ball, [](Mesh& m) { m.normals.clear(); })), 0u) << "of flat facets";
    EXPECT_EQ(bodies_in(changed(ball, [](Mesh& m) { m.normals[40] = vec3(0, 1, 0); })), 0u) << "with a bump";
    EXPECT_EQ(bodies_in(changed(ball, [](Mesh& m) { std::swap(m.triangles[30].x, m.triangles[30].y); })), 0u);
    EXPECT_EQ(bodies_in(box), 1u);
    EXPECT_EQ(bodies_in(changed(box, [](Mesh& m) { m.triangles.pop_back(); })), 0u) << "open";
    EXPECT_EQ(bodies_in(changed(box, [](Mesh& m) { m.positions[0] *= 1.01f; })), 0u) << "a corner pulled out";
    EXPECT_EQ(bodies_in(changed(box, [](Mesh& m) { std::swap(m.triangles[3].x, m.triangles[3].y); })), 0u);
    mat4 shear(1);
    shear[1][0] = 0.01f;
    EXPECT_EQ(bodies_in(transformed(box, shear)), 0u) << "sheared";
    EXPECT_EQ(bodies_in(transformed(box, glm::scale(mat4(1), vec3(1, 0, 1)))), 0u) << "flat";
}

}  // namespace
}  // namespace umbra
