#include "umbra/core/render/gbuffer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "umbra/core/base/parallel.h"
#include "umbra/tests/support/mesh_scene.h"
#include "umbra/tests/support/same_points.h"

namespace umbra {
namespace {

/// `count` triangles of random size and position in the unit cube.
Scene random_triangles(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-1, 1), size(-0.3f, 0.3f);
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (int i = 0; i < count; ++i) {
        const vec3 a(place(random), place(random), place(random));
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (int k = 0; k < 3; ++k) positions.push_back(a + vec3(size(random), size(random), size(random)));
        triangles.emplace_back(first, first + 1, first + 2);
    }
    return scene_of(positions, triangles);
}

/// A closed ball of quads cut in two, with its poles on the axis y.
Scene ball(int longitudes, int latitudes, dmat3 turn = dmat3(1)) {
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * longitudes + i % longitudes); };
    for (int j = 0; j <= latitudes; ++j)
        for (int i = 0; i < longitudes; ++i) {
            const double a = 2 * kPi * i / longitudes, b = kPi * j / latitudes;
            const double s = j == 0 || j == latitudes ? 0 : std::sin(b);
            positions.emplace_back(turn * dvec3(s * std::cos(a), std::cos(b), s * std::sin(a)));
        }
    for (int j = 0; j < latitudes; ++j)
        for (int i = 0; i < longitudes; ++i) {
            if (j > 0) triangles.emplace_back(at(i, j), at(i + 1, j), at(i, j + 1));
            if (j + 1 < latitudes) triangles.emplace_back(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
    return scene_of(positions, triangles);
}

struct DoubleHit {
    TriangleId triangle = kNoTriangle;
    double t            = 1e300;
    double margin       = 0;  ///< least barycentric weight: how far inside the triangle
};

/// Nearest triangle by brute force in double [Tomas Moeller, Ben Trumbore, Fast, Minimum Storage Ray/Triangle
/// Intersection, 1997].
DoubleHit brute_force(const Scene& scene, dvec3 origin, dvec3 direction) {
    DoubleHit best;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
        const dvec3 a(scene.vertex(t, 0)), e1 = dvec3(scene.vertex(t, 1)) - a, e2 = dvec3(scene.vertex(t, 2)) - a;
        const dvec3 p    = glm::cross(direction, e2);
        const double det = glm::dot(e1, p);
        if (det == 0) continue;
        const dvec3 s  = origin - a;
        const double u = glm::dot(s, p) / det, v = glm::dot(direction, glm::cross(s, e1)) / det;
        const double distance = glm::dot(e2, glm::cross(s, e1)) / det;
        const double margin   = std::min({u, v, 1 - u - v});
        if (margin >= 0 && distance > 0 && distance < best.t) best = {t, distance, margin};
    }
    return best;
}

Camera camera_at(vec3 eye, vec3 target) {
    Camera camera;
    camera.eye    = eye;
    camera.target = target;
    return camera;
}

class Projections : public testing::TestWithParam<Projection> {};

TEST_P(Projections, FindsWhatBruteForceInDoubleFinds) {
    const Scene scene = random_triangles(400, 7);
    Camera camera     = camera_at({0.4f, 0.3f, 3}, {0, 0, 0});
    camera.projection = GetParam();
    const RayScene rays(scene);
    const int width = 101, height = 67;  // no whole packets, no whole tiles
    const PointBatch batch = primary_points(rays, scene, camera, width, height);
    int hits = 0, doubtful = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto i          = static_cast<std::size_t>(y * width + x);
            const dvec3 origin    = batch.raster->ray_origin(x + 0.5, y + 0.5);
            const dvec3 direction = batch.raster->ray_direction(x + 0.5, y + 0.5);
            const DoubleHit want  = brute_force(scene, origin, direction);
            if (batch.triangle[i] != want.triangle) {  // only where the ray passes an edge within rounding
                ++doubtful;
                const TriangleId got = batch.triangle[i];
                EXPECT_TRUE(want.margin < 1e-5 || (got != kNoTriangle && batch.u[i] < 1e-5f) || batch.v[i] < 1e-5f)
                    << x << ' ' << y << " got " << got << " want " << want.triangle << " margin " << want.margin;
                continue;
            }
            if (want.triangle == kNoTriangle) continue;
            ++hits;
            const dvec3 seen = origin + want.t * direction;
            EXPECT_LT(glm::length(seen - dvec3(batch.position(i))), 2e-5) << x << ' ' << y;
            const dvec3 back = batch.raster->project(dvec3(batch.position(i)));
            EXPECT_NEAR(back.x, x + 0.5, 0.01);
            EXPECT_NEAR(back.y, y + 0.5, 0.01);
            EXPECT_LE(glm::dot(batch.normal(i), vec3(direction)), 1e-6f);
        }
    }
    EXPECT_GT(hits, 2000);
    EXPECT_LT(doubtful, 3);
}

INSTANTIATE_TEST_SUITE_P(All, Projections, testing::Values(Projection::perspective, Projection::orthographic),
                         [](const auto& p) {
                             return p.param == Projection::perspective ? "perspective" : "orthographic";
                         });

TEST(PrimaryPoints, NoRayLeavesAClosedBall) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int round = 0; round < 8; ++round) {
        const dvec3 axis       = glm::normalize(dvec3(uniform(random), uniform(random), uniform(random)));
        const dvec3 other      = glm::normalize(glm::cross(axis, dvec3(0.3, 0.2, 0.9)));
        const Scene scene      = ball(64, 33, round == 0 ? dmat3(1) : dmat3(other, axis, glm::cross(other, axis)));
        Camera camera          = camera_at(0.1f * vec3(other), vec3(0.2f, 1, 0.1f));
        camera.fov_y           = 120;
        const PointBatch batch = primary_points(RayScene(scene), scene, camera, 400, 300);
        EXPECT_EQ(std::count(batch.triangle.begin(), batch.triangle.end(), kNoTriangle), 0) << "round " << round;
    }
}

/// Orthographic rays through every vertex and along every edge of a grid of unit quads.
TEST(PrimaryPoints, RaysThroughVerticesAndEdgesHit) {
    const int n = 16;
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) positions.emplace_back(i, j, 0);
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i;
            triangles.emplace_back(a, a + 1, a + n + 2);
            triangles.emplace_back(a, a + n + 2, a + n + 1);
        }
    const Scene scene      = scene_of(positions, triangles);
    Camera camera          = camera_at({8.25f, 8.25f, 5}, {8.25f, 8.25f, 0});
    camera.projection      = Projection::orthographic;
    camera.height          = 16;  // 32 pixels: centres at multiples of a half, from 0.5 to 16
    const PointBatch batch = primary_points(RayScene(scene), scene, camera, 32, 32);
    EXPECT_EQ(std::count(batch.triangle.begin(), batch.triangle.end(), kNoTriangle), 0);
    EXPECT_EQ(batch.px[0], 0.5f);
    EXPECT_EQ(batch.py[0], 16.0f);
}

TEST(PrimaryPoints, SameBitsForAnyNumberOfThreads) {
    const Scene scene   = ball(700, 350);  // large enough that Embree builds in parallel
    const Camera camera = camera_at({0.5f, 0.8f, 3}, {0, 0, 0});
    const auto points   = [&](int threads) {
        const ThreadLimit limit(threads);
        return primary_points(RayScene(scene), scene, camera, 640, 360);
    };
    const PointBatch one = points(1);
    expect_same(one, points(2));
    expect_same(one, points(2));
}

TEST(PrimaryPoints, SurfacePointsAreNamedInsideTheirTriangle) {
    const Scene scene      = ball(200, 100);
    const PointBatch batch = primary_points(RayScene(scene), scene, camera_at({0, 0, 2.5f}, {0, 0, 0}), 500, 500);
    for (std::size_t i = 0; i < batch.size(); ++i) {
        if (batch.triangle[i] == kNoTriangle) continue;
        ASSERT_GE(batch.u[i], 0);
        ASSERT_GE(batch.v[i], 0);
        ASSERT_LE(static_cast<double>(batch.u[i]) + static_cast<double>(batch.v[i]), 1);
        PointBatch again;
        again.eye = batch.eye;
        again.resize(1);
        set_point(again, 0, scene, batch.triangle[i], batch.u[i], batch.v[i]);
        ASSERT_EQ(again.u[0], batch.u[i]);
        ASSERT_EQ(again.v[0], batch.v[i]);
        ASSERT_EQ(again.position(0), batch.position(i));
        ASSERT_EQ(again.normal(0), batch.normal(i));
        ASSERT_EQ(again.flipped[0], batch.flipped[i]);
    }
}

/// Where all coordinates stay floats, neither distance from the origin nor scale changes what a ray meets.
TEST(PrimaryPoints, FarFromTheOriginAndAtEveryScaleTheSame) {
    std::mt19937 random(11);
    std::uniform_int_distribution<int> place(-64, 64);
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (std::uint32_t i = 0; i < 300; ++i) {
        for (int k = 0; k < 3; ++k)
            positions.push_back(vec3(place(random), place(random), place(random)) * (k == 0 ? 1 / 8.0f : 1 / 16.0f));
        triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    const auto points = [&](vec3 shift, float scale) {
        std::vector<vec3> moved;
        for (vec3 p : positions) moved.push_back((p + shift) * scale);
        const Scene scene   = scene_of(moved, triangles);
        const Camera camera = camera_at((vec3(2, 3, 24) + shift) * scale, shift * scale);
        return primary_points(RayScene(scene), scene, camera, 160, 120);
    };
    const PointBatch here = points(vec3(0), 1);
    EXPECT_GT(std::count_if(here.triangle.begin(), here.triangle.end(), [](TriangleId t) { return t != kNoTriangle; }),
              5000);
    for (const PointBatch& there : {points(vec3(1 << 19, -(1 << 18), 1 << 17), 1), points(vec3(0), 0x1p50f),
                                    points(vec3(0), 0x1p-50f), points(vec3(1 << 19), 0x1p-60f)}) {
        EXPECT_EQ(here.triangle, there.triangle);
        EXPECT_EQ(here.u, there.u);
        EXPECT_EQ(here.v, there.v);
    }
}

TEST(PrimaryPoints, ASceneWithoutTrianglesShowsNothing) {
    const Scene scene;
    const PointBatch batch = primary_points(RayScene(scene), scene, Camera{}, 3, 2);
    EXPECT_EQ(batch.triangle, std::vector<TriangleId>(6, kNoTriangle));
}

TEST(RayScene, CountsItsMemory) {
    const RayScene small(ball(10, 5)), large(ball(300, 150));
    EXPECT_GT(small.memory_bytes(), 90 * 12u);
    EXPECT_GT(large.memory_bytes(), 89400 * 24u);
    EXPECT_LT(large.memory_bytes(), 89400 * 400u);
}

TEST(RayScene, ClearanceIsTheLeastDistanceOverAllTriangles) {
    const Scene scene = random_triangles(200, 5);
    const RayScene rays(scene);
    std::mt19937 random(6);
    std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
    for (int i = 0; i < 200; ++i) {
        const dvec3 p(coordinate(random), coordinate(random), coordinate(random));
        // By many points of every triangle: never nearer, and close where they lie densely.
        double least = 8;
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
            const dvec3 a(rays.space().point(scene.vertex(t, 0))), b(rays.space().point(scene.vertex(t, 1))),
                c(rays.space().point(scene.vertex(t, 2)));
            for (int u = 0; u <= 40; ++u)
                for (int v = 0; u + v <= 40; ++v)
                    least = std::min(least, glm::length(a + (b - a) * (u / 40.0) + (c - a) * (v / 40.0) - p));
        }
        const double got = rays.clearance(p, 8);
        EXPECT_LE(got, least * (1 + 1e-12));
        EXPECT_GT(got, least - 0.05);
        EXPECT_DOUBLE_EQ(rays.clearance(p, got / 2), got / 2) << "nothing is that near";
    }
    const dvec3 on(rays.space().point(scene.vertex(7, 1)));
    EXPECT_LT(rays.clearance(on, 1), 1e-15);
    EXPECT_EQ(rays.clearance(dvec3(100), 0.5), 0.5);
}

TEST(RayScene, OccludedSkipsTheNamedTriangleOnly) {
    const RayScene rays(
        scene_of({{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {-1, 1, -1}, {1, 1, -1}, {0, 1, 1}}, {{0, 1, 2}, {3, 4, 5}}));
    ShadowPacket packet;
    const TriangleId skip[] = {kNoTriangle, 0, 1, kNoTriangle, 0};
    const float tfar[]      = {2, 2, 2, 0.25f, 0.75f};  // from y = -0.5 to 1.5, 0 and to above the first
    for (int k = 0; k < 5; ++k) {
        const vec3 origin = rays.space().point(vec3(0, -0.5f, 0)), direction = rays.space().vector(dvec3(0, 1, 0));
        packet.org_x[k] = origin.x, packet.org_y[k] = origin.y, packet.org_z[k] = origin.z;
        packet.dir_x[k] = direction.x, packet.dir_y[k] = direction.y, packet.dir_z[k] = direction.z;
        packet.tfar[k]  = tfar[k];
        packet.id[k]    = skip[k];
        packet.valid[k] = -1;
    }
    std::vector<ShadowRay> list(5);
    for (int k = 0; k < 5; ++k) {
        list[k].org_x = packet.org_x[k], list[k].org_y = packet.org_y[k], list[k].org_z = packet.org_z[k];
        list[k].dir_x = packet.dir_x[k], list[k].dir_y = packet.dir_y[k], list[k].dir_z = packet.dir_z[k];
        list[k].tfar = packet.tfar[k], list[k].id = packet.id[k];
    }
    rays.occluded(packet);
    EXPECT_LT(packet.tfar[0], 0);
    EXPECT_LT(packet.tfar[1], 0);  // the other one blocks
    EXPECT_LT(packet.tfar[2], 0);
    EXPECT_EQ(packet.tfar[3], 0.25f);
    EXPECT_EQ(packet.tfar[4], 0.75f);
    EXPECT_EQ(packet.tfar[5], 0);
    rays.occluded(list);
    for (int k = 0; k < 5; ++k) EXPECT_EQ(list[k].tfar, packet.tfar[k]) << k;
}

TEST(FlushDenormals, EndsWithItsScope) {
    volatile float tiny = 0x1p-140f;
    {
        const FlushDenormals flush;
        EXPECT_EQ(tiny * 1.0f, 0.0f);
    }
    EXPECT_EQ(tiny * 1.0f, 0x1p-140f);
}

}  // namespace
}  // namespace umbra
