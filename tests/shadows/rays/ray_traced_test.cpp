#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/facts.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/asked.h"

namespace umbra {
namespace {

VisibilityPlane trace(const Scene& scene, const PointBatch& points, const std::string& settings = "",
                      LightId light = 0) {
    Asked method(settings.empty() ? "ray_traced" : "ray_traced:" + settings);
    SceneFacts facts;
    facts.hard_lights_only = !is_area(scene.lights[light].kind);
    method.build(scene, facts);
    method.aim(light);
    EXPECT_GT(method.memory_bytes(), 0u);
    return method.visibility(points, light);
}

void add_quad(Scene& scene, vec3 a, vec3 b, vec3 c, vec3 d) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    add_object(scene, "quad", {a, b, c, d}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
}

/// Points on the first quad (from corner a, along its edges ab and ad, shares in [0, 1]).
PointBatch points_on_quad(const Scene& scene, const std::vector<dvec2>& places, vec3 eye = vec3(0, 1e6f, 0)) {
    PointBatch batch;
    batch.eye = eye;
    batch.resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double x = places[i].x, y = places[i].y;  // a + x ab + y ad
        if (x > y)
            set_point(batch, i, scene, 0, static_cast<float>(x - y), static_cast<float>(y));
        else
            set_point(batch, i, scene, 1, static_cast<float>(x), static_cast<float>(y - x));
    }
    face_lights(batch, scene);
    return batch;
}

Light light_of(LightKind kind, vec3 position) {
    Light light;
    light.name     = "light";
    light.kind     = kind;
    light.position = position;
    return light;
}

// ---- penumbrae in closed form --------------------------------------------------------------------------------------

constexpr double kLightHeight = 4, kOccluderHeight = 2.5;

/// A floor from x = -8 to 8 and a half-plane x >= 0 above it; both so long that their ends do not matter.
Scene half_plane_scene(Light light, vec3 shift = vec3(0)) {
    Scene scene;
    const auto h = static_cast<float>(kOccluderHeight);
    add_quad(scene, shift + vec3(-8, 0, 8), shift + vec3(8, 0, 8), shift + vec3(8, 0, -8), shift + vec3(-8, 0, -8));
    add_quad(scene, shift + vec3(0, h, 64), shift + vec3(64, h, 64), shift + vec3(64, h, -64), shift + vec3(0, h, -64));
    light.position += shift + vec3(0, static_cast<float>(kLightHeight), 0);
    scene.lights.push_back(light);
    return scene;
}

/// The share of a disk on one side of a line at distance t radii from its centre; t = 1: all.
double disk_share(double t) {
    t = std::clamp(t, -1.0, 1.0);
    return 1 - (std::acos(t) - t * std::sqrt(1 - t * t)) / kPi;
}

double exact_share(const Light& light, double x, double z) {
    const double H = kLightHeight, h = kOccluderHeight;
    const double edge = -x * (H - h) / h;  // where the occluder's edge, seen from x, crosses the light's plane
    if (light.kind == LightKind::rectangle) {
        const double a = 0.5 * static_cast<double>(light.edge_u.x);
        return std::clamp((edge + a) / (2 * a), 0.0, 1.0);
    }
    if (light.kind == LightKind::disk) return disk_share(edge / static_cast<double>(light.radius));
    // Sphere: the circle where the cone from p touches it, cut by the plane through p and the occluder's edge.
    const dvec3 p(x, 0, z), centre(0, H, 0);
    const double d = glm::length(centre - p), r = static_cast<double>(light.radius);
    const dvec3 n      = (centre - p) / d;
    const double R     = r * std::sqrt(d * d - r * r) / d;
    const dvec3 middle = centre - n * (r * r / d);
    dvec3 m            = glm::normalize(dvec3(h, x, 0));  // normal of the plane through (x, 0) and (0, h), to the shade
    const double side  = -glm::dot(m, middle - p);        // > 0: the middle is lit
    return disk_share(side / std::sqrt(1 - glm::dot(m, n) * glm::dot(m, n)) / R);
}

/// Receiver points across the penumbra and on both sides of it.
std::vector<dvec2> sweep(int count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<dvec2> places;
    for (int i = 0; i < count; ++i) places.emplace_back(0.3 + 0.4 * (i + 0.5) / count, 0.3 + 0.4 * uniform(random));
    return places;
}

Light area_light(LightKind kind) {
    Light light     = light_of(kind, vec3(0));
    light.direction = vec3(0, -1, 0);
    light.edge_u    = vec3(1.5f, 0, 0);
    light.edge_v    = vec3(0, 0, 1);
    light.radius    = 0.75f;
    return light;
}

class Penumbra : public testing::TestWithParam<LightKind> {};
INSTANTIATE_TEST_SUITE_P(All, Penumbra, testing::Values(LightKind::rectangle, LightKind::disk, LightKind::sphere),
                         [](const auto& p) { return std::string(to_string(p.param)); });

void expect_closed_form(const Scene& scene, vec3 shift, const std::string& settings, double allowed) {
    const std::vector<dvec2> places = sweep(2000);
    const PointBatch points         = points_on_quad(scene, places, shift + vec3(0, 100, 0));
    const VisibilityPlane answer    = trace(scene, points, settings);
    double squares = 0, bias = 0;
    int penumbra = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double want  = exact_share(scene.lights[0], -8 + 16 * places[i].x, 8 - 16 * places[i].y);
        const double error = static_cast<double>(answer.s[i]) - want;
        penumbra += want > 0 && want < 1;
        if (want == 0) {
            EXPECT_EQ(answer.s[i], 0) << i;
        }
        if (want == 1) {
            EXPECT_EQ(answer.s[i], 1) << i;
        }
        squares += error * error;
        bias += error;
    }
    EXPECT_GT(penumbra, 400);
    EXPECT_LT(std::sqrt(squares / penumbra), allowed);  // over the penumbra alone, which is where errors are
    EXPECT_LT(std::abs(bias / penumbra), 0.1 * allowed);
    testing::Test::RecordProperty("rmse", std::to_string(std::sqrt(squares / penumbra)));
}

TEST_P(Penumbra, SobolMatchesTheClosedForm) {
    expect_closed_form(half_plane_scene(area_light(GetParam())), vec3(0), "sampler=sobol,samples=256", 0.01);
}

TEST_P(Penumbra, EverySamplerConvergesToTheClosedForm) {
    const Scene scene = half_plane_scene(area_light(GetParam()));
    expect_closed_form(scene, vec3(0), "sampler=random,samples=1024", 0.02);
    expect_closed_form(scene, vec3(0), "sampler=stratified,samples=250", 0.012);
    expect_closed_form(scene, vec3(0), "sampler=r2,samples=512", 0.01);
    expect_closed_form(scene, vec3(0), "sampler=regular,samples=1024", 0.02);
    expect_closed_form(scene, vec3(0), "sampler=random,samples=3", 0.3);
}

/// The floor's points are rounded to eighths there, their names are not.
TEST_P(Penumbra, FarFromTheOriginTheSame) {
    const vec3 shift(1 << 20, 1 << 19, -(1 << 20));
    expect_closed_form(half_plane_scene(area_light(GetParam()), shift), shift, "samples=256", 0.01);
}

/// Area common to two disks of radii a and b at distance d.
double lens(double d, double a, double b) {
    if (d >= a + b) return 0;
    if (d <= std::abs(a - b)) return kPi * std::min(a, b) * std::min(a, b);
    const double x = (d * d + a * a - b * b) / (2 * d), y = d - x;
    return a * a * std::acos(x / a) - x * std::sqrt(a * a - x * x) + b * b * std::acos(y / b) -
           y * std::sqrt(b * b - y * y);
}

TEST(RayTraced, CoaxialDiskBlocker) {
    const double H = 4, h = 1.5, R = 0.75, b = 0.5;
    Scene scene;
    add_quad(scene, vec3(-8, 0, 8), vec3(8, 0, 8), vec3(8, 0, -8), vec3(-8, 0, -8));
    std::vector<vec3> rim;
    std::vector<uvec3> fan;
    for (std::uint32_t i = 0; i < 720; ++i) {
        rim.emplace_back(b * std::cos(i * kPi / 360), h, b * std::sin(i * kPi / 360));
        if (i > 1) fan.emplace_back(0, i, i - 1);
    }
    add_object(scene, "blocker", rim, {}, fan, 0);
    scene.lights.push_back(area_light(LightKind::disk));
    scene.lights[0].position = vec3(0, H, 0);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0.35, 0.65);
    std::vector<dvec2> places;
    for (int i = 0; i < 2000; ++i) places.emplace_back(uniform(random), uniform(random));
    const PointBatch points      = points_on_quad(scene, places);
    const VisibilityPlane answer = trace(scene, points, "samples=256");
    double squares               = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double d    = 16 * glm::length(places[i] - dvec2(0.5));
        const double want = 1 - lens(d * (H / h - 1), R, b * H / h) / (kPi * R * R);
        squares += std::pow(static_cast<double>(answer.s[i]) - want, 2);
    }
    EXPECT_LT(std::sqrt(squares / 2000), 0.01);
}

// ---- hard lights ---------------------------------------------------------------------------------------------------

Scene random_triangles(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-1, 1), size(-0.2f, 0.2f);
    Scene scene;
    scene.materials.emplace_back();
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
        const vec3 a(place(random), place(random), place(random));
        for (int k = 0; k < 3; ++k) positions.push_back(a + vec3(size(random), size(random), size(random)));
        triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    add_object(scene, "soup", positions, {}, triangles, 0);
    return scene;
}

/// Whether any triangle but `own` lies between, by brute force in double; `margin` says how clear that is.
bool blocked(const Scene& scene, dvec3 p, dvec3 direction, double tfar, TriangleId own, double& margin) {
    margin   = 1;
    bool any = false;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
        if (t == own) continue;
        const dvec3 a(scene.vertex(t, 0)), e1 = dvec3(scene.vertex(t, 1)) - a, e2 = dvec3(scene.vertex(t, 2)) - a;
        const dvec3 q    = glm::cross(direction, e2);
        const double det = glm::dot(e1, q);
        const dvec3 s    = p - a;
        const double u = glm::dot(s, q) / det, v = glm::dot(direction, glm::cross(s, e1)) / det;
        const double at     = glm::dot(e2, glm::cross(s, e1)) / det;
        const double inside = std::min({u, v, 1 - u - v, at, tfar - at});
        any |= inside > 0;
        margin = std::min(margin, std::abs(inside));
    }
    return any;
}

class HardLight : public testing::TestWithParam<LightKind> {};
INSTANTIATE_TEST_SUITE_P(All, HardLight, testing::Values(LightKind::point, LightKind::spot, LightKind::directional),
                         [](const auto& p) { return std::string(to_string(p.param)); });

TEST_P(HardLight, AgreesWithBruteForceInDouble) {
    Scene scene = random_triangles(300, 2);
    scene.lights.push_back(light_of(GetParam(), vec3(0.3f, 2, 0.5f)));
    scene.lights[0].direction = vec3(0.3f, -2, 0.7f);
    scene.camera.eye          = vec3(0, 0.5f, 3);
    scene.camera.target       = vec3(0);
    const int width = 131, height = 77;
    const PointBatch points      = primary_points(RayScene(scene), scene, scene.camera, width, height);
    const VisibilityPlane answer = trace(scene, points);
    int lit = 0, dark = 0, doubtful = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.facing[0][i] != Facing::front) {
            EXPECT_EQ(answer.s[i], 0);
            continue;
        }
        const dvec3 p(points.position(i));
        const bool parallel = GetParam() == LightKind::directional;
        const dvec3 d       = parallel ? -dvec3(scene.lights[0].direction) : dvec3(scene.lights[0].position) - p;
        double margin       = 0;
        const bool want     = blocked(scene, p, d, parallel ? 1e300 : 1, points.triangle[i], margin);
        (want ? dark : lit) += 1;
        if (answer.s[i] == (want ? 0.0f : 1.0f)) continue;
        EXPECT_LT(margin, 1e-5) << i;
        ++doubtful;
    }
    EXPECT_GT(lit, 500);
    EXPECT_GT(dark, 500);
    EXPECT_LT(doubtful, 3);
    // The same points without their raster, in an order that fills no packet evenly.
    PointBatch list = points;
    list.raster.reset();
    EXPECT_EQ(trace(scene, list).s, answer.s);
}

TEST(RayTraced, NothingBeyondTheLightBlocks) {
    Scene scene;
    add_quad(scene, vec3(-1, 0, 1), vec3(1, 0, 1), vec3(1, 0, -1), vec3(-1, 0, -1));
    add_quad(scene, vec3(-9, 2, 9), vec3(9, 2, 9), vec3(9, 2, -9), vec3(-9, 2, -9));
    for (float height : {1.0f, 1.99f, 2.0f, 2.01f}) {  // at 2 the light is a point of the upper quad: only touched
        scene.lights.assign(1, light_of(LightKind::point, vec3(0.2f, height, 0.1f)));
        for (float s : trace(scene, points_on_quad(scene, sweep(64))).s)
            EXPECT_EQ(s, height <= 2 ? 1.0f : 0.0f) << height;
    }
    scene.lights.assign(1, light_of(LightKind::directional, vec3(0)));  // straight down
    for (float s : trace(scene, points_on_quad(scene, sweep(64))).s) EXPECT_EQ(s, 0.0f);
}

TEST(RayTraced, ALampsOwnTrianglesDoNotBlockIt) {
    Scene scene;
    add_quad(scene, vec3(-8, 0, 8), vec3(8, 0, 8), vec3(8, 0, -8), vec3(-8, 0, -8));
    add_quad(scene, vec3(-0.75f, 3, 0.5f), vec3(0.75f, 3, 0.5f), vec3(0.75f, 3, -0.5f), vec3(-0.75f, 3, -0.5f));
    scene.lights.push_back(area_light(LightKind::rectangle));
    scene.lights[0].position = vec3(0, 3, 0);
    std::vector<dvec2> places;
    for (int row = 0; row < 32; ++row)
        for (int column = 0; column < 32; ++column) places.emplace_back((column + 0.3) / 32, (row + 0.6) / 32);
    for (float s : trace(scene, points_on_quad(scene, places), "samples=64").s) EXPECT_EQ(s, 1.0f);
}

TEST(RayTraced, WhatIsCloseToALampButDoesNotTouchItCasts) {
    // A plate of 1 x 1 close below a light at height 4, or above it.
    for (const float gap : {1e-2f, 1e-4f, 1e-5f, 4e-6f})
        for (const bool beneath : {true, false}) {
            Scene scene;
            add_quad(scene, {-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4});
            const float y = beneath ? 4 - gap : 4 + gap;
            add_quad(scene, {-0.5f, y, -0.5f}, {-0.5f, y, 0.5f}, {0.5f, y, 0.5f}, {0.5f, y, -0.5f});
            scene.lights.push_back(light_of(LightKind::point, {0.25f, 4, 0.125f}));
            std::vector<dvec2> places;
            for (int i = 0; i < 400; ++i) places.emplace_back((i % 20 + 0.3) / 20, (i / 20 + 0.6) / 20);  // NOLINT
            const VisibilityPlane answer = trace(scene, points_on_quad(scene, places));
            for (const float s : answer.s) ASSERT_EQ(s, beneath ? 0.0f : 1.0f) << gap;
        }
}

TEST(RayTraced, APointLightVeryFarIsADirection) {
    Scene scene         = random_triangles(300, 2);
    scene.camera.eye    = vec3(0, 0.5f, 3);
    scene.camera.target = vec3(0);
    scene.lights.push_back(light_of(LightKind::directional, vec3(0)));
    scene.lights[0].direction = vec3(-0.25f, -1, -0.5f);
    for (float far : {1e7f, 1e12f, 1e18f})
        scene.lights.push_back(light_of(LightKind::point, vec3(0.25f, 1, 0.5f) * far));
    const PointBatch points         = primary_points(RayScene(scene), scene, scene.camera, 200, 150);
    const VisibilityPlane direction = trace(scene, points);
    for (LightId j = 1; j < scene.lights.size(); ++j) {
        const VisibilityPlane far = trace(scene, points, "", j);
        int differ                = 0;
        for (std::size_t i = 0; i < points.size(); ++i) differ += far.s[i] != direction.s[i];
        EXPECT_LT(differ, 4) << j;
    }
}

// ---- offsets -------------------------------------------------------------------------------------------------------

/// A convex body never shadows what faces the light. Turned, so that no coordinate is round.
Scene convex_ball(int longitudes, int latitudes, vec3 centre, float radius) {
    const dvec3 axis  = glm::normalize(dvec3(0.3, 0.8, 0.2));
    const dvec3 other = glm::normalize(glm::cross(axis, dvec3(0.3, 0.2, 0.9)));
    const dmat3 turn(other, axis, glm::cross(other, axis));
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * longitudes + i % longitudes); };
    for (int j = 0; j <= latitudes; ++j)
        for (int i = 0; i < longitudes; ++i) {
            const double a = 2 * kPi * i / longitudes, b = kPi * j / latitudes;
            const double s = j == 0 || j == latitudes ? 0 : std::sin(b);
            positions.emplace_back(dvec3(centre) + static_cast<double>(radius) *
                                                       (turn * dvec3(s * std::cos(a), std::cos(b), s * std::sin(a))));
        }
    for (int j = 0; j < latitudes; ++j)
        for (int i = 0; i < longitudes; ++i) {
            if (j > 0) triangles.emplace_back(at(i, j), at(i + 1, j), at(i, j + 1));
            if (j + 1 < latitudes) triangles.emplace_back(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
    Scene scene;
    scene.materials.emplace_back();
    add_object(scene, "ball", positions, {}, triangles, 0);
    return scene;
}

/// Shadow where there can be none, among points that see the light at more than a tenth of a degree.
int acne(const Scene& scene, const PointBatch& points, const std::string& settings) {
    const VisibilityPlane answer = trace(scene, points, settings);
    int wrong                    = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.facing[0][i] != Facing::front) continue;
        const vec3 towards = to_light(scene.lights[0], points.position(i)).direction;
        wrong += answer.s[i] < 1 && glm::dot(towards, points.normal(i)) > 1.7e-3f;
    }
    return wrong;
}

TEST(Offset, OnAConvexBallNoPolicyShowsAcneButNoOffsetDoes) {
    for (vec3 centre : {vec3(0), vec3(30, -20, 10)}) {
        Scene scene = convex_ball(120, 61, centre, 1);
        scene.lights.push_back(light_of(LightKind::point, centre + vec3(2, 3, 4)));
        scene.camera.eye        = centre + vec3(0.5f, 1, 4);
        scene.camera.target     = centre;
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 640, 480);
        EXPECT_EQ(acne(scene, points, "offset=skip_triangle"), 0);
        EXPECT_EQ(acne(scene, points, "offset=integer_offset"), 0);
        EXPECT_EQ(acne(scene, points, "offset=epsilon"), 0);
        EXPECT_GT(acne(scene, points, "offset=epsilon,epsilon=0"), 1000);
    }
}

/// Planes in any attitude, one quad lying twice in each: the second copy must not block the first.
TEST(Offset, CoplanarDuplicatesDoNotBlock) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int without = 0;
    for (int round = 0; round < 40; ++round) {
        const dvec3 n = glm::normalize(dvec3(uniform(random), uniform(random), uniform(random)));
        const dvec3 u = glm::normalize(glm::cross(n, dvec3(0.2, 0.5, 0.7))), v = glm::cross(n, u);
        const dvec3 c = 0.7 * dvec3(uniform(random), uniform(random), uniform(random));
        Scene scene;
        for (int copy = 0; copy < 2; ++copy)
            add_quad(scene, vec3(c - u - v), vec3(c + u - v), vec3(c + u + v), vec3(c - u + v));
        scene.lights.push_back(light_of(LightKind::point, vec3(c + 0.5 * n + 0.4 * u)));
        std::vector<dvec2> places;
        for (int i = 0; i < 2000; ++i) places.emplace_back(0.5 + 0.49 * uniform(random), 0.5 + 0.49 * uniform(random));
        const PointBatch points = points_on_quad(scene, places, vec3(c + 9.0 * n));
        EXPECT_EQ(acne(scene, points, ""), 0) << round;
        without += acne(scene, points, "offset=epsilon,epsilon=0");
    }
    EXPECT_GT(without, 1000);
}

/// A wall on the floor: behind it the shadow begins at its foot.
TEST(Offset, ContactShadowsReachTheContact) {
    Scene scene;
    add_quad(scene, vec3(-1, 0, 1), vec3(1, 0, 1), vec3(1, 0, -1), vec3(-1, 0, -1));
    add_quad(scene, vec3(0, 0, 1), vec3(0, 0, -1), vec3(0, 1, -1), vec3(0, 1, 1));
    scene.lights.push_back(light_of(LightKind::point, vec3(-3, 1, 0)));
    std::vector<dvec2> places;
    for (int k = 8; k < 22; ++k) places.emplace_back(0.5 + std::ldexp(1, -k), 0.4);
    const PointBatch points = points_on_quad(scene, places);
    for (float s : trace(scene, points).s) EXPECT_EQ(s, 0.0f);
    const std::vector<float> lifted = trace(scene, points, "offset=epsilon,epsilon=0.01").s;
    EXPECT_EQ(std::accumulate(lifted.begin(), lifted.end(), 0.0f), 0.0f);  // the wall is higher than the lift
}

// ---- area lights and planes ----------------------------------------------------------------------------------------

TEST(RayTraced, WhatLiesBehindThePointsPlaneIsNotSeen) {
    Scene scene;
    add_quad(scene, vec3(-8, 0, 8), vec3(8, 0, 8), vec3(8, 0, -8), vec3(-8, 0, -8));
    scene.lights.push_back(light_of(LightKind::rectangle, vec3(12, 0.25f, 0)));  // upright, 5/8 of it above the floor
    scene.lights[0].edge_u  = vec3(0, 2, 0);
    scene.lights[0].edge_v  = vec3(0, 0, 1);
    const PointBatch points = points_on_quad(scene, sweep(64));
    EXPECT_EQ(points.facing[0][0], Facing::partly);
    for (float s : trace(scene, points, "samples=256").s) EXPECT_NEAR(s, 0.625f, 0.01f);
}

TEST(RayTraced, InsideASphereLightNothingBlocks) {
    Scene scene;
    add_quad(scene, vec3(-1, 0, 1), vec3(1, 0, 1), vec3(1, 0, -1), vec3(-1, 0, -1));
    scene.lights.push_back(area_light(LightKind::sphere));
    scene.lights[0].radius  = 5;
    const PointBatch points = points_on_quad(scene, sweep(64));
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_FALSE(points.asks(0, i));
        EXPECT_EQ(points.decided(0, i), 1.0f);
    }
}

// ---- determinism ---------------------------------------------------------------------------------------------------

TEST(RayTraced, SameBitsForAnyNumberOfThreads) {
    Scene scene = convex_ball(60, 31, vec3(0, 1, 0), 1);
    add_quad(scene, vec3(-8, 0, 8), vec3(8, 0, 8), vec3(8, 0, -8), vec3(-8, 0, -8));
    scene.lights.push_back(area_light(LightKind::sphere));
    scene.lights[0].position = vec3(2, 4, 1);
    scene.camera.eye         = vec3(0, 3, 6);
    scene.camera.target      = vec3(0);
    const PointBatch points  = primary_points(RayScene(scene), scene, scene.camera, 161, 99);
    std::vector<float> one;
    {
        const ThreadLimit limit(1);
        one = trace(scene, points, "samples=11").s;
    }
    const ThreadLimit limit(2);
    EXPECT_EQ(trace(scene, points, "samples=11").s, one);
    EXPECT_EQ(trace(scene, points, "samples=11,seed=0").s, one);
    EXPECT_NE(trace(scene, points, "samples=11,seed=1").s, one);
    for (float s : one) EXPECT_EQ(s * 11, std::round(s * 11));
}

TEST(RayTraced, SaysHowItServes) {
    // Never exactly: rays are floats.
    SceneFacts facts;
    const auto service = [&](const char* text) { return Asked(text).serves(facts); };
    const Service hard = service("ray_traced"), lifted = service("ray_traced:offset=epsilon");
    facts.hard_lights_only = false;
    const Service soft     = service("ray_traced:samples=9");
    for (const Service& s : {hard, lifted, soft}) EXPECT_EQ(s.how, How::approximately);
    EXPECT_NE(hard.why, lifted.why);
    EXPECT_NE(soft.why.find("9 rays"), std::string::npos) << soft.why;
}

}  // namespace
}  // namespace umbra
