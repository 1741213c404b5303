// Soft shadow volumes see the samples that ray_traced sees: counts by hand on one edge, and ray_traced on everything
// else, bit for bit.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

#include <fmt/format.h>

#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/sampling.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

constexpr LightKind kAreaKinds[] = {LightKind::rectangle, LightKind::disk, LightKind::sphere};

Light area_light(LightKind kind, vec3 position) {
    Light light;
    light.name      = "light";
    light.kind      = kind;
    light.position  = position;
    light.direction = {0, -1, 0};
    light.edge_u    = {1.5f, 0, 0};
    light.edge_v    = {0, 0, -1};
    light.radius    = 0.75f;
    return light;
}

void add(Scene& scene, const std::vector<vec3>& positions, const std::vector<uvec3>& triangles,
         const std::string& name = "object") {
    if (scene.materials.empty()) scene.materials.emplace_back();
    add_object(scene, name, positions, {}, triangles, 0);
}

void add_floor(Scene& scene, float half, float y = 0, vec3 by = vec3(0)) {
    add(scene,
        {by + vec3(-half, y, half), by + vec3(half, y, half), by + vec3(half, y, -half), by + vec3(-half, y, -half)},
        {{0, 1, 2}, {0, 2, 3}});
}

PointBatch picture(Scene& scene, vec3 eye, vec3 target, int width = 96, int height = 64) {
    scene.camera.eye = eye, scene.camera.target = target;
    scene.width = width, scene.height = height;
    PointBatch points = primary(scene);
    face_lights(points, scene);
    return points;
}

VisibilityPlane answer(const std::string& method, const Scene& scene, const PointBatch& points, LightId light) {
    MethodCase run(method, scene);
    run.prepare(light);
    return run.visibility(points, light);
}

/// What two methods say of a light.
struct Comparison {
    std::size_t points = 0, penumbra = 0, differ = 0;
    double samples = 0;  ///< by which they differ
    Comparison& operator+=(const Comparison& c) {
        points += c.points, penumbra += c.penumbra, differ += c.differ, samples += c.samples;
        return *this;
    }
};

/// With rays that no shaft replaces, since soft_volumes asks the same shafts.
Comparison compare(const Scene& scene, const PointBatch& points, LightId light, int samples,
                   const std::string& more = "") {
    const std::string settings  = fmt::format("samples={}{}", samples, more);
    const VisibilityPlane rays  = answer("ray_traced:cull=none," + settings, scene, points, light),
                          edges = answer("soft_volumes:" + settings, scene, points, light);
    Comparison found;
    for (std::size_t i = 0; i < points.size(); ++i) {
        found.points += is_open(points, light, i);
        found.penumbra += rays.s[i] > 0 && rays.s[i] < 1;
        found.differ += rays.s[i] != edges.s[i];
        found.samples += samples * std::abs(double(rays.s[i]) - double(edges.s[i]));
    }
    return found;
}

// ---- by hand -------------------------------------------------------------------------------------------------------

/// A rectangle light at height 4, a sheet x >= 0 at height 2.5, wider than any point of the floor can look past: from
/// the floor at x, its edge is projected to x - 4 / 2.5 x.
TEST(SoftVolumes, CountsTheSamplesOnTheLitSideOfOneEdge) {
    Scene scene;
    add_floor(scene, 8);
    add(scene, {{0, 2.5f, 8}, {8, 2.5f, 8}, {8, 2.5f, -8}, {0, 2.5f, -8}}, {{0, 1, 2}, {0, 2, 3}});
    scene.lights            = {area_light(LightKind::rectangle, {0, 4, 0})};
    const PointBatch points = picture(scene, {0, 2, 7}, {0, 0, 0});
    constexpr int kSamples  = 250;
    for (const Sampler sampler : {Sampler::random, Sampler::stratified, Sampler::sobol}) {
        const char* name = sampler == Sampler::random ? "random" : sampler == Sampler::sobol ? "sobol" : "stratified";
        const VisibilityPlane got =
            answer(fmt::format("soft_volumes:samples={},sampler={},seed=7", kSamples, name), scene, points, 0);
        const SampleSet set(sampler, kSamples, 7);
        int penumbra = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_open(points, 0, i) || points.triangle[i] > 1) continue;
            const dvec3 p   = exact_position(scene, points, i);
            const double at = (p.x - p.x * 4 / 2.5) / 0.75;  // on the light, -1 to 1
            int seen = 0, close = 0;
            for (int first = 0; first < kSamples; first += 8) {
                Samples8 samples;
                set.eight(set.key(i), first, samples);
                for (int k = 0; k < std::min(8, kSamples - first); ++k) {
                    const double x = 2 * double(samples.x[k]) - 1;
                    seen += x < at;
                    close += std::abs(x - at) < 1e-5;
                }
            }
            penumbra += seen > 0 && seen < kSamples;
            ASSERT_NEAR(double(got.s[i]) * kSamples, seen, close + 1e-3) << i;
        }
        EXPECT_GT(penumbra, 300);
    }
}

// ---- ray_traced ----------------------------------------------------------------------------------------------------

struct SoupOptions {
    std::uint32_t triangles = 200;
    float size              = 0.4f;
    float grid              = 0;  ///< coordinates are multiples of this: shared and crossing edges, one plane for many
    vec3 centre{0};
};

/// Triangles anywhere in a box above a floor, wound anyhow.
Scene soup(unsigned seed, const SoupOptions& o, LightKind kind) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-1, 1), size(-o.size, o.size);
    const auto round = [&](vec3 p) { return o.grid > 0 ? glm::round(p / o.grid) * o.grid : p; };
    Scene scene;
    add_floor(scene, 3, -1.25f, o.centre);
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (std::uint32_t i = 0; i < o.triangles; ++i) {
        const vec3 a(place(random), place(random), place(random));
        for (int k = 0; k < 3; ++k)
            positions.push_back(o.centre + round(a + vec3(size(random), size(random), size(random))));
        triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    add(scene, positions, triangles, "soup");
    scene.lights           = {area_light(kind, o.centre + vec3(0.3f, 2.5f, 0.5f))};
    scene.lights[0].edge_u = {0.8f, 0.1f, 0.2f};
    scene.lights[0].edge_v = {0.1f, 0.2f, -0.6f};
    if (kind == LightKind::disk) scene.lights[0].direction = glm::normalize(vec3(0.2f, -1, 0.1f));
    scene.lights[0].radius = 0.4f;
    return scene;
}

class AreaLight : public testing::TestWithParam<LightKind> {};
INSTANTIATE_TEST_SUITE_P(All, AreaLight, testing::ValuesIn(kAreaKinds),
                         [](const auto& p) { return std::string(to_string(p.param)); });

TEST_P(AreaLight, SeesTheSamplesThatRaysSeeThroughAnySoup) {
    Comparison all;
    for (unsigned seed = 0; seed < 6; ++seed)
        for (const float size : {0.1f, 0.4f, 1.5f}) {
            const std::uint32_t triangles = size > 1 ? 20 : 200;
            Scene scene                   = soup(seed, {triangles, size}, GetParam());
            const PointBatch points       = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0});
            all += compare(scene, points, 0, 61, ",sampler=random");
        }
    EXPECT_GT(all.penumbra, 20000u);
    EXPECT_EQ(all.differ, 0u) << all.samples;
}

/// Corners in one another's planes, on one another's edges, triangles twice or folded back.
TEST_P(AreaLight, SeesTheSamplesThatRaysSeeThroughASoupOnAGrid) {
    Comparison all;
    for (unsigned seed = 0; seed < 12; ++seed) {
        Scene scene             = soup(seed, {150, 0.6f, 0.25f}, GetParam());
        const PointBatch points = picture(scene, {0.1f, 0.55f, 3}, {0, -0.5f, 0});
        all += compare(scene, points, 0, 64);
    }
    EXPECT_GT(all.penumbra, 20000u);
    EXPECT_EQ(all.differ, 0u) << all.samples;
}

TEST_P(AreaLight, FarFromTheOriginTheSame) {
    for (const vec3 centre : {vec3(1 << 12), vec3(1 << 18, -(1 << 17), 0), vec3(1e6f, 0, 3e6f)}) {
        Scene scene             = soup(3, {150, 0.4f, 0, centre}, GetParam());
        const PointBatch points = picture(scene, centre + vec3(0, 0.5f, 3), centre + vec3(0, -0.5f, 0));
        const Comparison found  = compare(scene, points, 0, 64);
        EXPECT_GT(found.points, 1000u) << centre.x;
        EXPECT_EQ(found.differ, 0u) << centre.x;
    }
}

TEST_P(AreaLight, TheHorizonCutsIt) {
    Scene scene = soup(5, {120, 0.3f}, GetParam());
    for (const float height : {-1.2f, -1.0f, -0.5f}) {  // the floor is at -1.25
        scene.lights[0].position  = {4, height, 0.2f};
        scene.lights[0].edge_u    = {0.1f, 0.8f, 0};
        scene.lights[0].edge_v    = {0, 0.1f, 0.8f};
        scene.lights[0].direction = {-1, 0.1f, 0};
        const PointBatch points   = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0});
        std::size_t partly        = 0;
        for (const Facing f : points.facing[0]) partly += f == Facing::partly;
        EXPECT_GT(partly, 200u);
        const Comparison found = compare(scene, points, 0, 64);
        EXPECT_GT(found.penumbra, 500u);
        EXPECT_EQ(found.differ, 0u) << height;
    }
}

/// Points of a rough ground so close to their triangles' edges that neighbours begin where rays do.
TEST_P(AreaLight, CreasesNextToThePoint) {
    std::mt19937 random(8);
    std::uniform_real_distribution<float> height(-0.15f, 0.15f);
    constexpr std::uint32_t n = 9;
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            positions.emplace_back(0.25f * static_cast<float>(i) - 1, height(random),
                                   1 - 0.25f * static_cast<float>(j));
            const std::uint32_t k = n * j + i;
            if (i + 1 < n && j + 1 < n)
                triangles.emplace_back(k, k + 1, k + n + 1), triangles.emplace_back(k, k + n + 1, k + n);
        }
    Scene scene;
    add(scene, positions, triangles);
    scene.lights              = {area_light(GetParam(), {2, 0.3f, 1})};
    scene.lights[0].edge_u    = {0, 1, 0};
    scene.lights[0].edge_v    = {0.5f, 0, -1};
    scene.lights[0].direction = glm::normalize(vec3(-1, -0.1f, -0.5f));
    PointBatch points;
    points.eye = {0, 100, 0};
    points.resize(triangles.size() * 3 * 24);
    std::size_t next = 0;
    for (TriangleId t = 0; t < triangles.size(); ++t)
        for (int side = 0; side < 3; ++side)
            for (int k = 0; k < 24; ++k) {
                const float far = std::ldexp(1.0f, -2 - k), along = 0.1f + 0.03f * static_cast<float>(k);
                const float u = side == 0 ? far : side == 1 ? along * (1 - far) : (1 - far) * along;
                const float v = side == 1 ? far : side == 0 ? along * (1 - far) : (1 - far) * (1 - along);
                set_point(points, next++, scene, t, u, v);
            }
    face_lights(points, scene);
    const Comparison found = compare(scene, points, 0, 256);
    EXPECT_GT(found.penumbra, 1000u);
    EXPECT_EQ(found.differ, 0u) << found.samples;
}

/// Points of a tilted floor from 2^-8 to 2^-25 before the feet of blades that share no corner with it.
TEST_P(AreaLight, ContactsNextToThePoint) {
    Scene scene;
    add(scene, {{-2, 0.3f, 2}, {2, -0.1f, 2}, {2, -0.3f, -2}, {-2, 0.1f, -2}}, {{0, 1, 2}, {0, 2, 3}});
    scene.lights              = {area_light(GetParam(), {4, 0.8f, 0.4f})};
    scene.lights[0].edge_u    = {0, 1.5f, 0};
    scene.lights[0].edge_v    = {0, 0, 1.5f};
    scene.lights[0].direction = {-1, 0, 0};
    PointBatch points;
    points.eye                  = {0, 100, 0};
    constexpr std::size_t kFeet = 12, kSteps = 18;
    points.resize(kFeet * kSteps);
    for (std::size_t f = 0; f < kFeet; ++f)
        for (std::size_t k = 0; k < kSteps; ++k)
            set_point(points, f * kSteps + k, scene, 0, 0.3f, 0.1f + 0.05f * static_cast<float>(f));
    for (std::size_t f = 0; f < kFeet; ++f) {
        const vec3 foot(exact_position(scene, points, f * kSteps));
        add(scene, {foot, foot + vec3(0.02f, 0.3f, 0.03f), foot + vec3(0.02f, 0.25f, -0.03f)}, {{0, 1, 2}});
        for (std::size_t k = 0; k < kSteps; ++k) {
            const float far = std::ldexp(1.0f, -8 - static_cast<int>(k));
            set_point(points, f * kSteps + k, scene, 0, 0.3f - far, 0.1f + 0.05f * static_cast<float>(f));
        }
    }
    face_lights(points, scene);
    const Comparison found = compare(scene, points, 0, 256);
    EXPECT_GT(found.penumbra, 100u);
    EXPECT_EQ(found.differ, 0u) << found.samples;
}

TEST_P(AreaLight, VeryFarOrVerySmall) {
    for (const float distance : {50.0f, 1e4f, 1e7f, 1e12f})
        for (const float share : {1e-4f, 0.1f}) {  // of the distance
            Scene scene               = soup(7, {100, 0.4f}, GetParam());
            scene.lights[0].position  = vec3(0.3f, 0.8f, 0.2f) * distance;
            scene.lights[0].edge_u    = {share * distance, 0, 0};
            scene.lights[0].edge_v    = {0, 0, -share * distance};
            scene.lights[0].direction = {0, -1, 0};
            scene.lights[0].radius    = share * distance;
            const PointBatch points   = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0});
            const Comparison found    = compare(scene, points, 0, 64);
            EXPECT_GT(found.points, 1000u);
            EXPECT_EQ(found.differ, 0u) << distance << " " << share;
        }
}

/// Sheets below the light, through it and in its plane, at distances down to where rays end.
TEST_P(AreaLight, WhatIsCloseToItOrPassesThroughIt) {
    for (const float below : {0.5f, 1e-2f, 1e-3f, 1e-4f, 3e-5f, 1e-5f, 0.0f, -1e-5f, -0.01f})
        for (const float tilt : {0.0f, 1e-4f, 0.3f}) {
            Scene scene;
            add_floor(scene, 4);
            const float y = 3 - below;
            add(scene,
                {{-0.3f, y - tilt, 0.4f}, {0.5f, y + tilt, 0.4f}, {0.5f, y + tilt, -0.2f}, {-0.3f, y - tilt, -0.2f}},
                {{0, 1, 2}, {0, 2, 3}});
            scene.lights            = {area_light(GetParam(), {0, 3, 0})};
            scene.lights[0].radius  = 0.5f;
            const PointBatch points = picture(scene, {0, 2, 6}, {0, 0, 0}, 64, 48);
            EXPECT_EQ(compare(scene, points, 0, 64).differ, 0u) << below << " " << tilt;
        }
}

/// The order of triangles, which way round they are, and whether neighbours share corners change nothing.
TEST_P(AreaLight, TrianglesInAnyOrderAndAnyOrientation) {
    Scene scene     = soup(11, {60, 0.5f}, GetParam());
    const Mesh ball = make_sphere(0.7f, 16, 9);
    add(scene, ball.positions, ball.triangles, "ball");
    const PointBatch points    = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0});
    const VisibilityPlane want = answer("soft_volumes:samples=64", scene, points, 0);
    EXPECT_EQ(compare(scene, points, 0, 64).differ, 0u);
    std::mt19937 random(1);
    Scene flipped = scene;
    for (uvec3& t : flipped.triangles) {
        if (random() % 2 == 0) std::swap(t[1], t[2]);  // named points keep their triangle and lose their place
        for (auto turns = random() % 3; turns > 0; --turns) t = {t[1], t[2], t[0]};
    }
    // Points by position: the same floor.
    for (TriangleId t : {0u, 1u}) flipped.triangles[t] = scene.triangles[t];
    PointBatch floor;
    std::vector<std::uint32_t> on_floor;
    for (std::uint32_t i = 0; i < points.size(); ++i)
        if (points.triangle[i] < 2) on_floor.push_back(i);
    floor = pick(points, on_floor);
    EXPECT_GT(on_floor.size(), 1500u);
    const std::vector<float> as_it_was = answer("soft_volumes:samples=64", scene, floor, 0).s;
    EXPECT_EQ(answer("soft_volumes:samples=64", flipped, floor, 0).s, as_it_was);
    Scene shuffled = scene;
    std::shuffle(shuffled.triangles.begin() + 2, shuffled.triangles.end(), random);
    EXPECT_EQ(answer("soft_volumes:samples=64", shuffled, floor, 0).s, as_it_was);
    Scene torn = scene;
    torn.positions.clear();
    for (uvec3& t : torn.triangles) {
        for (int k = 0; k < 3; ++k) {
            torn.positions.push_back(scene.positions[t[k]]);
            t[k] = static_cast<std::uint32_t>(torn.positions.size() - 1);
        }
    }
    EXPECT_EQ(answer("soft_volumes:samples=64", torn, floor, 0).s, as_it_was);
}

TEST_P(AreaLight, SameBitsForAnyNumberOfThreads) {
    Scene scene             = soup(2, {200, 0.4f}, GetParam());
    const PointBatch points = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0}, 161, 99);
    std::vector<float> one;
    {
        const ThreadLimit limit(1);
        one = answer("soft_volumes:samples=37", scene, points, 0).s;
    }
    const ThreadLimit limit(2);
    EXPECT_EQ(answer("soft_volumes:samples=37", scene, points, 0).s, one);
    EXPECT_NE(answer("soft_volumes:samples=37,seed=1", scene, points, 0).s, one);
}

/// What Contract asks of methods on scenes without an area light, which it does not serve.
TEST_P(AreaLight, PhasesMayBeCalledAgainAndBatchesNeedNoRaster) {
    const Scene other = soup(1, {80, 0.3f}, LightKind::disk);
    Scene scene       = soup(2, {200, 0.4f}, GetParam());
    scene.lights.push_back(area_light(LightKind::sphere, {0, 2, 0}));
    const PointBatch points = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0});
    MethodCase run("soft_volumes:samples=32", scene);
    run.build(other);
    run.aim(0);
    run.build();
    run.aim(1);
    run.aim(0);
    const std::vector<float> want = answer("soft_volumes:samples=32", scene, points, 0).s;
    EXPECT_EQ(run.visibility(points, 0).s, want);
    PointBatch list = points;
    list.raster.reset();
    EXPECT_EQ(run.visibility(list, 0).s, want);
    EXPECT_TRUE(run.visibility(PointBatch(pick(points, {})), 0).s.empty());
}

TEST(SoftVolumes, EverySamplerAndAnyCount) {
    Scene scene             = soup(4, {200, 0.4f}, LightKind::disk);
    const PointBatch points = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0});
    for (const char* sampler : {"random", "stratified", "regular", "r2", "sobol"})
        for (const int samples : {1, 3, 8, 100, 1000})
            EXPECT_EQ(compare(scene, points, 0, samples, fmt::format(",sampler={},seed=3", sampler)).differ, 0u)
                << sampler << " " << samples;
}

/// Points across the narrow penumbra of a sheet's slanted edge, under a light so small that rounding moves the edge
/// over samples: without rays for samples in doubt, some are taken for the wrong side.
TEST_P(AreaLight, SamplesInDoubtTakeRays) {
    Scene scene;
    add_floor(scene, 2);
    add(scene, {{-0.3f, 1.25f, 2}, {2, 1.1f, 2}, {2, 1.2f, -2}, {0.4f, 1.3f, -2}}, {{0, 1, 2}, {0, 2, 3}});
    scene.lights           = {area_light(GetParam(), {0, 2, 0})};
    scene.lights[0].edge_u = {4e-3f, 0, 0};
    scene.lights[0].edge_v = {0, 0, -4e-3f};
    scene.lights[0].radius = 2e-3f;
    PointBatch points;
    points.eye = {0, 100, 0};
    points.resize(3000);
    // Where the shadow of the sheet's edge crosses z = 0 on the floor: between its ends' shadows.
    const auto shadow = [](dvec3 q) { return dvec3(0, 2, 0) + (q - dvec3(0, 2, 0)) * (2 / (2 - q.y)); };
    const dvec3 a = shadow({-0.3, 1.25, 2}), b = shadow({0.4, 1.3, -2});
    const double x = a.x + (b.x - a.x) * a.z / (a.z - b.z);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double at = x + 1.2e-2 * (double(i) / double(points.size()) - 0.5);
        set_point(points, i, scene, 0, static_cast<float>(at / 4), 0.5f);
    }
    face_lights(points, scene);
    const std::string samples      = "samples=1024";
    const std::vector<float> rays  = answer("ray_traced:cull=none," + samples, scene, points, 0).s,
                             trace = answer("soft_volumes:" + samples, scene, points, 0).s,
                             count = answer("soft_volumes:" + samples + ",doubtful=count", scene, points, 0).s;
    EXPECT_EQ(trace, rays);
    std::size_t differ = 0, penumbra = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        penumbra += rays[i] > 0 && rays[i] < 1;
        differ += count[i] != rays[i];
    }
    EXPECT_GT(penumbra, 1000u);
    EXPECT_GT(differ, 10u);
}

TEST(SoftVolumes, WhatLetsLightThroughDoesNotBlock) {
    Scene scene = soup(9, {100, 0.5f}, LightKind::rectangle);
    scene.materials.resize(2);
    scene.materials[1].opacity = 0.4f;
    scene.objects[1].material  = 1;
    Scene more                 = soup(10, {50, 0.5f}, LightKind::rectangle);
    add(scene, more.positions, more.triangles, "opaque");
    const PointBatch points = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0});
    for (const auto rule : {TransparentOccluders::ignore, TransparentOccluders::block}) {
        scene.transparent = rule;
        EXPECT_EQ(compare(scene, points, 0, 64).differ, 0u);
    }
}

/// Every scene of the project that has an area light.
TEST(SoftVolumes, SeesTheSamplesThatRaysSeeInCanonicalScenes) {
    std::size_t lights = 0;
    Comparison all;
    for (const auto& file : std::filesystem::directory_iterator(UMBRA_SCENES)) {
        if (file.path().extension() != ".json") continue;
        Scene scene;
        try {
            scene = load_scene(file.path());
        } catch (const std::exception&) {
            continue;  // a mesh that was not fetched
        }
        if (scene.triangles.size() > 100000) continue;  // seconds
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 160, 90);
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            if (!is_area(scene.lights[j].kind)) continue;
            const Comparison found = compare(scene, points, j, 64);
            EXPECT_EQ(found.differ, 0u) << scene.name << " light " << j << ": " << found.samples << " samples";
            ++lights;
            all += found;
        }
    }
    EXPECT_GE(lights, 6u);  // of the scenes that need no fetched mesh
    EXPECT_GT(all.penumbra, 5000u);
}

// ---- what it says of itself ----------------------------------------------------------------------------------------

TEST(SoftVolumes, ServesScenesThatHaveAnAreaLight) {
    SceneFacts facts;
    const Asked method("soft_volumes");
    EXPECT_EQ(method.serves(facts).how, How::not_at_all);
    facts.hard_lights_only = false;
    EXPECT_EQ(method.serves(facts).how, How::approximately);
}

TEST(SoftVolumes, ALightWithoutAnAreaTakesTheRayOfRayTraced) {
    Scene scene = soup(6, {200, 0.4f}, LightKind::rectangle);
    Light point = scene.lights[0];
    point.kind  = LightKind::point;
    scene.lights.push_back(point);
    point.kind      = LightKind::directional;
    point.direction = {0.2f, -1, 0.1f};
    scene.lights.push_back(point);
    const PointBatch points = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0});
    for (const LightId j : {1u, 2u}) {
        const Comparison found = compare(scene, points, j, 16);
        EXPECT_EQ(found.differ, 0u);
        EXPECT_EQ(found.penumbra, 0u);
    }
}

TEST(SoftVolumes, BlamesATriangleThatBlocksAndCountsItsMemory) {
    Scene scene             = soup(6, {200, 0.4f}, LightKind::rectangle);
    const PointBatch points = picture(scene, {0, 0.5f, 3}, {0, -0.5f, 0});
    MethodCase run("soft_volumes:samples=16", scene);
    run.prepare(0);
    MethodCase rays("ray_traced:samples=16", scene);
    rays.prepare(0);
    const VisibilityPlane plane = run.visibility(points, 0);
    std::vector<std::uint32_t> dark;
    for (std::uint32_t i = 0; i < points.size(); ++i)
        if (is_open(points, 0, i) && plane.s[i] < 1) dark.push_back(i);
    const PointBatch asked = pick(points, dark);
    std::vector<TriangleId> blamed(asked.size()), by_rays(asked.size());
    run.blame(asked, 0, blamed);
    rays.blame(asked, 0, by_rays);
    EXPECT_EQ(blamed, by_rays);
    EXPECT_GT(std::count_if(blamed.begin(), blamed.end(), [](TriangleId t) { return t != kNoTriangle; }), 1000);
    // The trees and the samples of ray_traced, and an edge or more a triangle.
    EXPECT_GT(run.memory_bytes(), rays.memory_bytes() + 200 * sizeof(float) * 6);
}

}  // namespace
}  // namespace umbra
