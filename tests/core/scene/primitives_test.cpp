// Bodies against closed forms of the polyhedra that they are, and against the topology of the bodies that they
// approximate.
#include "umbra/core/scene/primitives.h"

#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

namespace umbra {
namespace {

struct Measures {
    double area = 0, volume = 0;
    int vertices = 0, edges = 0, faces = 0;
    int boundary = 0, nonmanifold = 0, misoriented = 0, degenerate = 0;
    int normals_against_face = 0;
    int euler() const { return vertices - edges + faces; }
};

Measures measure(const Mesh& mesh) {
    Measures m;
    std::map<std::array<float, 3>, int> vertex;
    const auto id = [&](std::uint32_t i) {
        const vec3 p = mesh.positions[i];
        return vertex.try_emplace({p.x, p.y, p.z}, static_cast<int>(vertex.size())).first->second;
    };
    std::map<std::pair<int, int>, std::array<int, 2>> runs;  // of each edge, in either direction
    for (const uvec3& t : mesh.triangles) {
        const dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const dvec3 n = glm::cross(b - a, c - a);
        m.area += glm::length(n) / 2;
        m.volume += glm::dot(a, glm::cross(b, c)) / 6;
        m.degenerate += glm::length(n) == 0;
        const std::array<int, 3> v{id(t.x), id(t.y), id(t.z)};
        for (unsigned k = 0; k < 3; ++k) {
            const int i = v[k], j = v[(k + 1) % 3];
            runs[{std::min(i, j), std::max(i, j)}][i < j]++;
        }
        for (int k = 0; k < 3; ++k)
            if (!mesh.normals.empty()) m.normals_against_face += glm::dot(n, dvec3(mesh.normals[t[k]])) <= 0;
    }
    for (const auto& [edge, count] : runs) {
        m.boundary += count[0] + count[1] == 1;
        m.nonmanifold += count[0] + count[1] > 2;
        m.misoriented += count[0] + count[1] == 2 && count[0] != 1;
    }
    m.vertices = static_cast<int>(vertex.size());
    m.edges    = static_cast<int>(runs.size());
    m.faces    = static_cast<int>(mesh.triangles.size());
    return m;
}

void expect_closed(const Mesh& mesh, int euler) {
    const Measures m = measure(mesh);
    EXPECT_EQ(m.boundary, 0);
    EXPECT_EQ(m.nonmanifold, 0);
    EXPECT_EQ(m.misoriented, 0);
    EXPECT_EQ(m.degenerate, 0);
    EXPECT_EQ(m.euler(), euler);
    EXPECT_GT(m.volume, 0) << "turned inside out";
    EXPECT_EQ(m.normals_against_face, 0);
    for (const vec3 n : mesh.normals) ASSERT_NEAR(glm::length(n), 1, 1e-6);
}

// Area of the regular n-gon in a circle of radius r, and its perimeter.
double polygon_area(double r, int n) { return n / 2.0 * r * r * std::sin(2 * kPi / n); }
double perimeter(double r, int n) { return 2 * n * r * std::sin(kPi / n); }

TEST(Primitives, PlaneIsOpenAndFacesUp) {
    for (const int divisions : {1, 7}) {
        const Mesh mesh  = make_plane(3, 2, divisions);
        const Measures m = measure(mesh);
        EXPECT_EQ(m.faces, 2 * divisions * divisions);
        EXPECT_EQ(m.boundary, 4 * divisions);
        EXPECT_EQ(m.misoriented, 0);
        EXPECT_NEAR(m.area, 6, 1e-6);
        for (const uvec3& t : mesh.triangles)
            EXPECT_GT(
                glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]).y, 0);
    }
}

TEST(Primitives, Box) {
    const Mesh mesh = make_box({1, 2, 4});
    EXPECT_EQ(mesh.positions.size(), 8u);
    expect_closed(mesh, 2);
    EXPECT_DOUBLE_EQ(measure(mesh).volume, 8);
    EXPECT_DOUBLE_EQ(measure(mesh).area, 28);
}

TEST(Primitives, SphereIsTheInscribedPolyhedron) {
    for (const auto& [longitudes, latitudes] : {std::pair{3, 2}, {4, 3}, {32, 16}, {7, 50}}) {
        const Mesh mesh = make_sphere(2, longitudes, latitudes);
        expect_closed(mesh, 2);
        // A stack of frusta of pyramids between rings of radius r sin(polar).
        double volume = 0;
        for (int j = 0; j < latitudes; ++j) {
            const double a = kPi * j / latitudes, b = kPi * (j + 1) / latitudes;
            const double upper = polygon_area(2 * std::sin(a), longitudes),
                         lower = polygon_area(2 * std::sin(b), longitudes);
            volume += 2 * (std::cos(a) - std::cos(b)) / 3 * (upper + lower + std::sqrt(upper * lower));
        }
        EXPECT_NEAR(measure(mesh).volume, volume, 1e-5 * volume) << longitudes << " x " << latitudes;
        for (const vec3 p : mesh.positions) EXPECT_NEAR(glm::length(p), 2, 1e-6);
    }
    EXPECT_NEAR(measure(make_sphere(1, 400, 200)).volume, 4 * kPi / 3, 2e-3);
}

TEST(Primitives, CylinderIsAPrism) {
    const int n     = 17;
    const Mesh mesh = make_cylinder(1.5f, 3, n);
    expect_closed(mesh, 2);
    EXPECT_NEAR(measure(mesh).volume, 3 * polygon_area(1.5, n), 1e-5);
    EXPECT_NEAR(measure(mesh).area, 3 * perimeter(1.5, n) + 2 * polygon_area(1.5, n), 1e-5);
}

TEST(Primitives, ConeIsAPyramid) {
    const int n     = 11;
    const Mesh mesh = make_cone(1.5f, 3, n);
    expect_closed(mesh, 2);
    EXPECT_NEAR(measure(mesh).volume, polygon_area(1.5, n), 1e-5);
    const double slant = std::hypot(3, 1.5 * std::cos(kPi / n));
    EXPECT_NEAR(measure(mesh).area, perimeter(1.5, n) * slant / 2 + polygon_area(1.5, n), 1e-5);
    EXPECT_FLOAT_EQ(mesh.positions[0].y, 1.5f);
}

TEST(Primitives, TorusHasOneHoleAndPappusVolume) {
    const Mesh mesh = make_torus(2, 0.5f, 64, 24);
    expect_closed(mesh, 0);
    EXPECT_EQ(measure(mesh).vertices, 64 * 24);
    // Pappus for the inscribed tube, with a polygon's perimeter in place of the circle's.
    EXPECT_NEAR(measure(mesh).volume, perimeter(2, 64) * std::cos(kPi / 64) * polygon_area(0.5, 24), 2e-3);
    EXPECT_NEAR(measure(make_torus(2, 0.5f, 600, 200)).volume, 2 * kPi * 2 * kPi * 0.25, 2e-3);
}

TEST(Primitives, DiskIsOpenAndFacesUp) {
    const Mesh mesh  = make_disk(2, 9);
    const Measures m = measure(mesh);
    EXPECT_EQ(m.boundary, 9);
    EXPECT_EQ(m.euler(), 1);
    EXPECT_NEAR(m.area, polygon_area(2, 9), 1e-5);
    EXPECT_EQ(m.normals_against_face, 0);
    for (const vec3 n : mesh.normals) EXPECT_EQ(n, vec3(0, 1, 0));
}

TEST(Primitives, TooFewSegmentsAreRefused) {
    EXPECT_THROW((void)make_sphere(1, 2, 8), std::invalid_argument);
    EXPECT_THROW((void)make_torus(1, 0.2f, 8, 2), std::invalid_argument);
    EXPECT_THROW((void)make_plane(1, 1, 0), std::invalid_argument);
}

TEST(Transformed, MirroringKeepsTheOutsideOut) {
    const mat4 turn   = glm::rotate(mat4(1), 0.7f, vec3(1, 2, 3));
    const mat4 mirror = glm::translate(mat4(1), vec3(5, -3, 2)) * turn * glm::scale(mat4(1), vec3(-2, 3, 0.5f));
    for (const Mesh& mesh : {make_cone(1, 2, 12), make_torus(2, 0.5f, 16, 8), make_cylinder(1, 1, 9)}) {
        const Mesh moved = transformed(mesh, mirror);
        expect_closed(moved, measure(mesh).euler());
        EXPECT_NEAR(measure(moved).volume, 3 * measure(mesh).volume, 1e-4);
    }
}

TEST(Transformed, NormalsStayPerpendicularUnderUnevenScale) {
    const Mesh moved = transformed(make_sphere(1, 24, 12), glm::scale(mat4(1), vec3(1, 3, 0.25f)));
    for (std::size_t i = 0; i < moved.positions.size(); ++i) {
        const vec3 p        = moved.positions[i];
        const vec3 gradient = glm::normalize(vec3(p.x, p.y / 9, p.z * 16));  // of x^2 + (y/3)^2 + (4z)^2
        EXPECT_NEAR(glm::dot(gradient, moved.normals[i]), 1, 1e-5);
    }
}

TEST(Transformed, FlatteningHasNormalsStill) {
    const Mesh moved = transformed(make_sphere(1, 8, 4), glm::scale(mat4(1), vec3(1, 0, 1)));
    EXPECT_EQ(moved.normals.front(), vec3(0, 1, 0));
    EXPECT_EQ(moved.normals.back(), vec3(0, -1, 0));
}

// Every position of a box given once a face, as files that hold normals do: welding must find them again.
Mesh exploded_box() {
    const Mesh box = make_box(vec3(2));
    Mesh mesh;
    for (const uvec3& t : box.triangles) {
        for (int k = 0; k < 3; ++k) mesh.positions.push_back(box.positions[t[k]]);
        const auto n = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.triangles.emplace_back(n - 3, n - 2, n - 1);
    }
    return mesh;
}

TEST(AveragedNormals, WeightByAngleMakesABoxSymmetric) {
    // Two triangles of one face meet at some corners, one at others: by angle each face counts the same.
    const Mesh mesh = with_averaged_normals(exploded_box());
    ASSERT_EQ(mesh.positions.size(), 8u);
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_NEAR(glm::distance(mesh.normals[i], glm::normalize(mesh.positions[i])), 0, 1e-6);
}

/// A corner of a box whose three sides have areas 2, 3 and 6; the last, across z, is one triangle there.
TEST(AveragedNormals, WeightsAreThoseThatAreAskedFor) {
    const Mesh corner{{{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}, {0, 0, 1}, {3, 0, 1}, {0, 2, 1}},
                      {},
                      {{0, 1, 3}, {1, 2, 3}, {1, 0, 5}, {0, 4, 5}, {0, 3, 6}, {4, 0, 6}}};
    const auto normal_at_corner = [&](NormalWeights weights) {
        const Mesh mesh = with_averaged_normals(corner, 180, weights);
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            if (mesh.positions[i] == vec3(0)) return dvec3(mesh.normals[i]);
        return dvec3(0);
    };
    const auto expect = [&](NormalWeights weights, dvec3 sum) {
        EXPECT_NEAR(glm::distance(normal_at_corner(weights), glm::normalize(sum)), 0, 1e-6) << int(weights);
    };
    expect(NormalWeights::angle, {1, 1, 1});
    expect(NormalWeights::area, {2, 3, 3});
    expect(NormalWeights::equal, {2, 2, 1});
}

TEST(AveragedNormals, CreaseKeepsTheEdgesOfABox) {
    const Mesh mesh = with_averaged_normals(exploded_box(), 60);
    ASSERT_EQ(mesh.positions.size(), 24u);
    for (const vec3 n : mesh.normals) EXPECT_EQ(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1.0f);
    expect_closed(mesh, 2);
    EXPECT_EQ(with_averaged_normals(exploded_box(), 90).positions.size(), 8u) << "90 degrees are no more than 90";
}

TEST(AveragedNormals, CreaseOfACylinderIsItsRim) {
    const Mesh mesh = with_averaged_normals(make_cylinder(1, 2, 36), 45);
    EXPECT_EQ(mesh.positions.size(), 4u * 36 + 2);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        EXPECT_TRUE(mesh.normals[i].y == 0 || std::abs(mesh.normals[i].y) > 0.9999f);
}

TEST(AveragedNormals, SphereGetsItsOwnNormals) {
    const Mesh mesh = with_averaged_normals(make_sphere(3, 48, 24));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        EXPECT_GT(glm::dot(mesh.normals[i], glm::normalize(mesh.positions[i])), 0.9995f);
}

TEST(AveragedNormals, SignOfZeroDoesNotSplit) {
    const Mesh mesh = with_averaged_normals(
        {{{0.0f, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, 0}, {0, 1, -0.0f}, {-1, 0, 0}}, {}, {{0, 1, 2}, {3, 4, 5}}});
    EXPECT_EQ(mesh.positions.size(), 4u);
}

TEST(AveragedNormals, FacesThatCancelAndDegenerateOnesGetTheFaceNormal) {
    // The same triangle from both sides, and one without area beside it.
    const Mesh mesh = with_averaged_normals(
        {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {6, 6, 6}, {7, 7, 7}}, {}, {{0, 1, 2}, {0, 2, 1}, {3, 4, 5}}});
    ASSERT_EQ(mesh.triangles.size(), 3u);
    for (const vec3 n : mesh.normals) EXPECT_EQ(n, vec3(0));
}

TEST(AveragedNormals, BodiesThatTouchInOnePositionKeepApart) {
    Mesh pair        = make_box(vec3(1));
    const Mesh other = transformed(make_box(vec3(1)), glm::translate(mat4(1), vec3(1)));
    pair.positions.insert(pair.positions.end(), other.positions.begin(), other.positions.end());
    for (const uvec3& t : other.triangles) pair.triangles.push_back(t + uvec3(8));
    EXPECT_EQ(with_averaged_normals(pair).positions.size(), 16u);
}

}  // namespace
}  // namespace umbra
