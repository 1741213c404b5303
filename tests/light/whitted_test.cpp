// Ray tracing after Whitted against values worked out by hand: directions, factors, counts, and what it cannot see.
#include "umbra/bench/studies/light/whitted.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "umbra/bench/studies/light/mirrored_light.h"
#include "umbra/bench/studies/light/optics.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/asked.h"
#include "umbra/tests/support/lit_everywhere.h"

namespace umbra {
namespace {

/// Gives off `emission` and nothing else.
std::uint32_t add_glow(Scene& scene, vec3 emission) {
    Material m;
    m.k_a = m.k_d = vec3(0), m.emission = emission;
    scene.materials.push_back(m);
    return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

std::uint32_t add_mirror(Scene& scene, float reflect, vec3 emission = vec3(0)) {
    const std::uint32_t m      = add_glow(scene, emission);
    scene.materials[m].reflect = reflect;
    return m;
}

std::uint32_t add_glass(Scene& scene, float transmit, float index, float reflect = 0) {
    const std::uint32_t m                  = add_mirror(scene, reflect);
    scene.materials[m].transmit            = transmit;
    scene.materials[m].index_of_refraction = index;
    return m;
}

void add_quad(Scene& scene, vec3 a, vec3 b, vec3 c, vec3 d, std::uint32_t material) {
    add_object(scene, "quad", {a, b, c, d}, {}, {{0, 1, 2}, {0, 2, 3}}, material);
}

RayTree tree_of(const Scene& scene, const TreeOptions& options = {}) {
    return trace_rays(RayScene(scene), scene, points_of(scene), options);
}

Image picture_of(const Scene& scene, const RayTree& tree, int depth = 5) {
    const AskVisibility ask = [&](const PointBatch& points) { return lit_everywhere(scene, points); };
    return gather(scene, tree, light_of_rays(scene, tree, ask), depth);
}

vec3 pixel(const Image& image, std::size_t i) { return {image.at(i, 0), image.at(i, 1), image.at(i, 2)}; }

/// One ray, from `eye` towards `target`.
Scene one_ray(vec3 eye, vec3 target) {
    Scene scene;
    scene.camera.eye = eye, scene.camera.target = target;
    scene.camera.up = {0.1f, 1, 0.2f};
    scene.width = scene.height = 1;
    return scene;
}

/// Panes one behind the other, seen straight on: what each gives counts by its opacity and by what those before it let
/// through, however they are ordered in the scene.
TEST(Whitted, PanesAreBlendedFromTheNearest) {
    Scene scene      = one_ray({0, 0, 5}, {0, 0, 0});
    scene.background = vec3(0.25f, 0.5f, 1);
    const auto pane  = [&](float z, float opacity, vec3 emission) {
        const std::uint32_t m      = add_glow(scene, emission);
        scene.materials[m].opacity = opacity;
        add_quad(scene, {-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}, m);
    };
    const vec3 red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1);
    pane(-1, 0.7f, green), pane(1, 0.25f, red), pane(0, 0.5f, blue);
    const auto expect = [&](const RayTree& tree, dvec3 right) {
        const vec3 got = pixel(picture_of(scene, tree), 0);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(double(got[c]), right[c], 1e-6) << c;
    };
    const RayTree tree = tree_of(scene);
    ASSERT_EQ(tree.levels.size(), 4u);
    const dvec3 behind_all(scene.background);
    expect(tree, 0.25 * dvec3(red) + 0.75 * (0.5 * dvec3(blue) + 0.5 * (0.7 * dvec3(green) + 0.3 * behind_all)));
    EXPECT_EQ(tree.levels[0].counts.total, 0u);
    EXPECT_NEAR(tree.levels[3].rays[0].weight, 0.75 * 0.5 * 0.3, 1e-7);
    // An opaque one hides what is behind it, and what transmits bends light instead.
    scene.materials[2].opacity = 1;
    const RayTree two          = tree_of(scene);
    EXPECT_EQ(two.levels.size(), 2u);
    expect(two, 0.25 * dvec3(red) + 0.75 * dvec3(blue));
    // Stained glass: what is behind it is multiplied by its colour, what it gives by itself is not.
    scene.materials[1].transmit_colour = vec3(1, 0.5f, 0.25f);
    expect(two, 0.25 * dvec3(red) + 0.75 * 0.25 * dvec3(blue));
}

/// The eye sees through it what a mirror shows of it.
TEST(Whitted, WhatTheEyeDoesNotSeeIsSeenInMirrors) {
    Scene scene = one_ray({0, 0, 5}, {0, 0, 0});
    add_quad(scene, {-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, add_mirror(scene, 0.5f));
    add_quad(scene, {-9, -9, 2}, {9, -9, 2}, {9, 9, 2}, {-9, 9, 2}, add_glow(scene, {1, 0.5f, 0}));
    EXPECT_EQ(pixel(picture_of(scene, tree_of(scene)), 0), vec3(1, 0.5f, 0));
    scene.objects[1].switches.seen_by_camera = false;
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        scene.camera.projection = projection, scene.camera.height = 1;
        const RayTree tree = tree_of(scene);
        ASSERT_EQ(tree.levels.size(), 2u);
        EXPECT_EQ(scene.triangle_object[tree.levels[0].points.triangle[0]], 0u);
        EXPECT_EQ(scene.triangle_object[tree.levels[1].points.triangle[0]], 1u);
        EXPECT_EQ(pixel(picture_of(scene, tree), 0), vec3(0.5f, 0.25f, 0));
        const RayScene rays(scene);
        EXPECT_EQ(trace_eye_rays(rays, scene, frame(scene.camera, 1, 1)).triangle, tree.levels[0].points.triangle);
    }
}

/// Of 16 neighbouring pixels, 16 times opacity see the pane alone. Two panes of one opacity look like one.
TEST(Whitted, ScreenDoorShowsAPaneOrWhatIsBehindIt) {
    Scene scene;
    scene.camera.eye = {0, 0, 5}, scene.camera.target = {0, 0, 0};
    scene.camera.fov_y = 10;
    scene.width = scene.height = 16;
    const auto pane            = [&](float z, float opacity, vec3 emission) {
        const std::uint32_t m      = add_glow(scene, emission);
        scene.materials[m].opacity = opacity;
        add_quad(scene, {-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}, m);
    };
    const vec3 red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1);
    pane(1, 0.375f, red), pane(0, 0.375f, green), pane(-1, 1, blue);
    const auto counts = [&] {
        const Image image =
            picture_of(scene, tree_of(scene, {.least_weight = 0, .transparency = Transparency::screen_door}));
        std::array<int, 3> of{};
        for (std::size_t i = 0; i < image.pixels(); ++i)
            for (std::size_t c = 0; c < 3; ++c) of[c] += image.at(i, c) == 1;
        return of;
    };
    EXPECT_EQ(counts(), (std::array{96, 0, 160})) << "the second pane is hidden by the first";
    scene.materials[1].opacity = 0.75f;
    EXPECT_EQ(counts(), (std::array{96, 96, 64}));
    scene.materials[0].opacity = 0;
    EXPECT_EQ(counts(), (std::array{0, 192, 64}));
}

/// Rays of a lobe cos^n: their mean cosine from the mirrored direction is (n + 1) / (n + 2), evenly around it.
TEST(Whitted, GlossyRaysAreSpreadByTheShininess) {
    for (const float n : {4.0f, 50.0f, 1e6f}) {
        Scene scene;
        scene.camera.eye = {0, 3, 3}, scene.camera.target = {0, 0, 0};
        scene.camera.fov_y = 0.01f;
        scene.width = scene.height   = 100;
        const std::uint32_t m        = add_mirror(scene, 1);
        scene.materials[m].shininess = n;
        add_quad(scene, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, m);
        const RayTree tree = tree_of(scene, {.least_weight = 0, .glossy = true});
        ASSERT_EQ(tree.levels.size(), 2u);
        const dvec3 mirrored = glm::normalize(dvec3(0, 1, -1));
        double sum           = 0;
        dvec3 mean(0);
        for (const SecondaryRay& ray : tree.levels[1].rays) {
            EXPECT_NEAR(glm::length(ray.direction), 1, 1e-12);
            EXPECT_GT(ray.direction.y, 0);
            sum += glm::dot(ray.direction, mirrored);
            mean += ray.direction;
        }
        const auto rays     = static_cast<double>(tree.levels[1].rays.size());
        const double cosine = (double(n) + 1) / (double(n) + 2);
        EXPECT_EQ(rays, 1e4);
        EXPECT_NEAR(sum / rays, cosine, 0.02 * (1 - cosine) + (n < 10 ? 0.02 : 1e-6));
        EXPECT_NEAR(glm::dot(glm::normalize(mean), mirrored), 1, n < 10 ? 2e-3 : 1e-4);
        // The same rays whichever others are traced.
        const RayTree again = tree_of(scene, {.least_weight = 0, .everywhere = true, .glossy = true});
        for (std::size_t i = 0; i < 100; ++i)
            EXPECT_EQ(again.levels[1].rays[i].direction, tree.levels[1].rays[i].direction);
    }
}

TEST(Optics, MirrorTurnsTheNormalPartAlone) {
    const dvec3 d = glm::normalize(dvec3(1, -2, 0.5)), n(0, 1, 0);
    EXPECT_EQ(mirrored(d, n), dvec3(d.x, -d.y, d.z));
    EXPECT_EQ(mirrored(d, -n), mirrored(d, n));
}

TEST(Optics, SnellBendsByTheRatioOfSines) {
    for (const double index : {1.0, 1.33, 1.5, 2.4})
        for (const double degrees : {0.0, 10.0, 45.0, 80.0}) {
            const double in = degrees * kPi / 180;
            const dvec3 d(std::sin(in), -std::cos(in), 0), n(0, 1, 0);
            const auto out = refracted(d, n, 1 / index);
            ASSERT_TRUE(out);
            EXPECT_NEAR(out->x, std::sin(in) / index, 1e-12);
            EXPECT_NEAR(glm::length(*out), 1, 1e-12);
            EXPECT_LT(out->y, 0);
            // And back again on the same path.
            const auto back = refracted(-*out, -n, index);
            ASSERT_TRUE(back);
            EXPECT_NEAR(glm::length(*back + d), 0, 1e-7);
        }
}

TEST(Optics, NothingIsRefractedBeyondTheCriticalAngle) {
    const double critical = std::asin(1 / 1.5);
    const auto out        = [](double in) {
        return refracted(dvec3(std::sin(in), -std::cos(in), 0), dvec3(0, 1, 0), 1.5).has_value();
    };
    EXPECT_TRUE(out(critical - 1e-6));
    EXPECT_FALSE(out(critical + 1e-6));
}

/// A ball over a floor, a point light, a sun and fog; no mirrors.
Scene plain() {
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].k_s = vec3(0.5f), scene.materials[0].shininess = 20;
    const Mesh sphere = make_sphere(1, 16, 8), floor = make_plane(8, 8);
    add_object(scene, "ball", sphere.positions, sphere.normals, sphere.triangles, 0);
    std::vector<vec3> low = floor.positions;
    for (vec3& p : low) p.y -= 1;
    add_object(scene, "floor", low, {}, floor.triangles, 0);
    Light lamp;
    lamp.name = "lamp", lamp.position = {2, 3, 2};
    scene.lights.push_back(lamp);
    lamp.kind = LightKind::directional, lamp.direction = {1, -2, -1};
    scene.lights.push_back(lamp);
    scene.camera.eye = {0, 2, 5};
    scene.background = {0.2f, 0.3f, 0.4f};
    scene.width = 64, scene.height = 48;
    return scene;
}

TEST(Whitted, WithoutMirrorsIsThePictureOfTheSum) {
    Scene scene = plain();
    for (const FogLaw law : {FogLaw::none, FogLaw::exponential}) {
        scene.fog.law = law, scene.fog.density = 0.1f;
        const PointBatch points = points_of(scene);
        const RayTree tree      = tree_of(scene);
        ASSERT_EQ(tree.levels.size(), 1u);
        EXPECT_EQ(picture_of(scene, tree).data, shade(scene, points, lit_everywhere(scene, points)).data);
    }
}

/// The same picture whether eye rays come from the raster or one by one, and where mirrored rays start everywhere.
TEST(Whitted, PictureIsTheSameWhicheverRaysAreTraced) {
    Scene scene                = plain();
    scene.materials[0].reflect = 0.3f;
    scene.materials.push_back(scene.materials[0]);
    scene.materials[1].reflect = 0;
    scene.objects[1].material  = 1;
    const RayTree raster       = tree_of(scene);
    const RayScene rays(scene);
    const CameraFrame frame_of = frame(scene.camera, scene.width, scene.height);
    PointBatch eye             = trace_eye_rays(rays, scene, frame_of);
    const PointBatch& packets  = raster.levels[0].points;
    EXPECT_EQ(eye.triangle, packets.triangle);
    EXPECT_EQ(eye.u, packets.u);
    EXPECT_EQ(eye.nx, packets.nx);
    const RayTree everywhere = trace_rays(rays, scene, std::move(eye), {.everywhere = true});
    EXPECT_EQ(picture_of(scene, everywhere).data, picture_of(scene, raster).data);
    EXPECT_EQ(raster.levels[1].counts.reflected,
              static_cast<std::uint64_t>(std::ranges::count_if(
                  packets.triangle, [&](TriangleId t) { return t != kNoTriangle && scene.triangle_object[t] == 0; })));
    EXPECT_EQ(everywhere.levels[1].counts.reflected, raster.levels[0].counts.met);
    const RayTree few = tree_of(scene, {.least_weight = 0.5}),
                  all = trace_rays(rays, scene, points_of(scene), {.least_weight = 0.5, .everywhere = true});
    EXPECT_EQ(picture_of(scene, all).data, picture_of(scene, few).data);
    EXPECT_NE(picture_of(scene, few).data, picture_of(scene, raster).data);
    scene.camera.projection = Projection::orthographic, scene.camera.height = 3;
    EXPECT_EQ(trace_eye_rays(rays, scene, frame(scene.camera, 64, 48)).u, points_of(scene).u);
}

/// Points, and the directions that mirrors turn, are those of the places through which the rays pass.
TEST(EyePlaces, PointsAndDirectionsAreThoseOfThePlaces) {
    Scene scene               = plain();
    const CameraFrame picture = frame(scene.camera, 16, 12), raster = frame(scene.camera, 64, 48);
    const RayScene rays(scene);
    for (const EyePlaces places : kEyePlaces) {
        PointBatch eye     = trace_eye_rays(rays, scene, raster, places, 4);
        const RayTree tree = trace_rays(rays, scene, std::move(eye), {.eye_places = places, .side = 4});
        std::size_t met = 0, beside = 0;
        for (std::size_t i = 0; i < tree.levels[0].points.size(); ++i) {
            const std::size_t row = i / 64, column = i % 64;
            const dvec2 place = eye_place(raster, places, 4, i);
            const double part = places == EyePlaces::random ? 4 : 1;
            EXPECT_EQ(std::floor(place.x / part), std::floor(static_cast<double>(column) / part));
            EXPECT_EQ(std::floor(place.y / part), std::floor(static_cast<double>(row) / part));
            if (tree.levels[0].points.triangle[i] == kNoTriangle) continue;
            const dvec2 seen = dvec2(raster.project(exact_position(scene, tree.levels[0].points, i)));
            EXPECT_NEAR(seen.x, place.x, 1e-3);
            EXPECT_NEAR(seen.y, place.y, 1e-3);
            const dvec3 to = glm::normalize(exact_position(scene, tree.levels[0].points, i) - picture.eye);
            EXPECT_NEAR(glm::distance(incoming(tree, 0, i), to), 0, 1e-5);
            beside += std::abs(place.x - static_cast<double>(column) - 0.5) > 0.1 ? 1 : 0;
            ++met;
        }
        ASSERT_GT(met, 500u);
        if (places == EyePlaces::regular)
            EXPECT_EQ(beside, 0u);
        else
            EXPECT_GT(beside, met / 2);
    }
}

/// An edge that rises by one pixel over the picture. Regular places see it in steps, those in a grid with less noise
/// than independent ones. Errors of 4 x 4 rays: (1 / 4) / sqrt(12); the mean of 2 sqrt(p (1 - p)) / 16 over the row
/// that is cut; the mean of sqrt(p (1 - p)) / 4.
TEST(EyePlaces, RandomOnesTradeStepsForNoise) {
    Scene scene;
    const std::uint32_t glow = add_glow(scene, vec3(1));
    add_quad(scene, {-9, -9, 0}, {9, -9, 0}, {9, 0.0625f, 0}, {-9, -0.0625f, 0}, glow);
    scene.camera.eye = {0, 0, 5}, scene.camera.target = {0, 0, 0};
    scene.camera.projection = Projection::orthographic;
    constexpr int kWidth = 240, kHeight = 40;  // 0.05 units a pixel along a height of 2
    scene.camera.height = 2;
    const RayScene rays(scene);
    const CameraFrame raster = frame(scene.camera, 4 * kWidth, 4 * kHeight);
    std::map<EyePlaces, double> error;
    for (const EyePlaces places : kEyePlaces) {
        const PointBatch eye = trace_eye_rays(rays, scene, raster, places, 4);
        double squares = 0, sum = 0;
        std::set<int> counts;
        for (int x = 0; x < kWidth; ++x) {
            int lit = 0;
            for (int y = 4 * kHeight / 2 - 40; y < 4 * kHeight / 2 + 40; ++y)
                for (int k = 0; k < 4; ++k)
                    lit += eye.triangle[static_cast<std::size_t>(y * 4 * kWidth + 4 * x + k)] != kNoTriangle ? 1 : 0;
            // Of 20 rows of pixels, the lower half and what the edge adds or takes.
            const double height = (static_cast<double>(x) + 0.5 - kWidth / 2.0) * 0.05 * 0.125 / 18 / 0.05;
            const double wrong  = lit / 16.0 - (10 + height);
            squares += wrong * wrong, sum += wrong;
            counts.insert(lit);
        }
        error[places] = std::sqrt(squares / kWidth);
        EXPECT_LT(std::abs(sum / kWidth), 0.02) << to_string(places) << ": as much too light as too dark";
        if (places == EyePlaces::regular)
            EXPECT_LE(counts.size(), 8u);
        else
            EXPECT_GT(counts.size(), 12u);
    }
    EXPECT_LT(error[EyePlaces::jittered], 0.9 * error[EyePlaces::regular]);
    EXPECT_GT(error[EyePlaces::random], 1.5 * error[EyePlaces::jittered]);
}

/// A wall of two halves that glow, over a floor that mirrors and gives off nothing.
TEST(Whitted, AMirrorFloorShowsTheColourOfTheMirroredPoint) {
    Scene scene;
    const vec3 left(0.25f, 0.5f, 0.125f), right(0.75f, 0.0625f, 1);
    const std::uint32_t floor = add_mirror(scene, 1), one = add_glow(scene, left), other = add_glow(scene, right);
    add_quad(scene, {-9, 0, 9}, {9, 0, 9}, {9, 0, -4}, {-9, 0, -4}, floor);
    add_quad(scene, {-9, 0, -4}, {0.3f, 0, -4}, {0.3f, 20, -4}, {-9, 20, -4}, one);
    add_quad(scene, {0.3f, 0, -4}, {9, 0, -4}, {9, 20, -4}, {0.3f, 20, -4}, other);
    scene.camera.eye = {0, 2, 3}, scene.camera.target = {0.5f, 0, -1};
    scene.width = 60, scene.height = 40;
    const RayTree tree      = tree_of(scene);
    const Image image       = picture_of(scene, tree);
    const PointBatch& eye   = tree.levels[0].points;
    std::size_t seen_in_two = 0;
    for (std::size_t i = 0; i < eye.size(); ++i) {
        if (eye.triangle[i] == kNoTriangle || scene.triangle_object[eye.triangle[i]] != 0) continue;
        // The straight line from the eye's mirror image, (0, -2, 3), through the floor point, on to the wall.
        const dvec3 image_eye(0, -2, 3), p(eye.position(i));
        const double x = image_eye.x + (p.x - image_eye.x) * 7 / (3 - p.z);
        if (std::abs(x - 0.3) < 1e-4 || std::abs(x) > 8.9) continue;
        EXPECT_EQ(pixel(image, i), x < 0.3 ? left : right) << i;
        ++seen_in_two;
    }
    EXPECT_GT(seen_in_two, 300u);
}

/// A mirror across the whole view shows what the mirrored eye sees, highlights included: V is against the ray.
TEST(Whitted, AMirrorShowsWhatTheMirroredEyeSees) {
    Scene scene      = plain();
    scene.camera.eye = {-1, 1, -4}, scene.camera.target = {-1, 1, -9};
    scene.camera.fov_y = 30;
    Scene seen         = scene;
    seen.camera.eye = {-1, 1, -14}, seen.camera.target = {-1, 1, -9};
    const std::uint32_t m = add_mirror(scene, 1);
    add_quad(scene, {-30, -30, -9}, {30, -30, -9}, {30, 30, -9}, {-30, 30, -9}, m);
    const Image mirror = picture_of(scene, tree_of(scene)), direct = picture_of(seen, tree_of(seen));
    std::size_t alike = 0, surfaces = 0;
    const PointBatch points = points_of(seen);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t flipped = i / 64 * 64 + 63 - i % 64;
        surfaces += points.triangle[i] != kNoTriangle ? 1 : 0;
        alike += glm::length(pixel(mirror, flipped) - pixel(direct, i)) < 1e-4f ? 1 : 0;
    }
    EXPECT_GT(surfaces, 300u);
    EXPECT_GE(alike, points.size() - 2);  // pixels on silhouettes
}

/// Through a slab of thickness D a ray keeps its direction and is shifted by D sin(a) (1 - cos(a) / (n cos(b))).
TEST(Whitted, ASlabShiftsARay) {
    const double a = 50 * kPi / 180, n = 1.5, thickness = 0.7;
    Scene scene             = one_ray(vec3(0), vec3(vec2(float(std::sin(a)), float(-std::cos(a))), 0));
    const std::uint32_t m   = add_glass(scene, 1, float(n));
    const Mesh slab         = make_box({40, 0.7f, 40});
    std::vector<vec3> moved = slab.positions;
    for (vec3& p : moved) p.y -= 2;
    add_object(scene, "slab", moved, {}, slab.triangles, m);
    const RayTree tree = tree_of(scene);
    ASSERT_EQ(tree.levels.size(), 3u);
    EXPECT_EQ(tree.levels[1].rays[0].kind, RayKind::refracted);
    const double b = std::asin(std::sin(a) / n);
    EXPECT_NEAR(tree.levels[1].rays[0].direction.x, std::sin(b), 1e-6);
    const dvec3 out = tree.levels[2].rays[0].direction;
    EXPECT_NEAR(out.x, std::sin(a), 1e-6);
    EXPECT_NEAR(out.y, -std::cos(a), 1e-6);
    const dvec3 left   = exact_position(scene, tree.levels[1].points, 0);
    const double shift = glm::length(left - glm::dot(left, out) * out);  // from the line through the eye
    EXPECT_NEAR(shift, thickness * std::sin(a) * (1 - std::cos(a) / (n * std::cos(b))), 1e-5);
    EXPECT_EQ(tree.levels[2].counts.met, 0u);
}

/// From inside glass: within the critical angle of 41.8 degrees a ray leaves, beyond it all is mirrored.
TEST(Whitted, BeyondTheCriticalAngleAllIsMirrored) {
    const auto seen = [](double degrees) {
        const double in       = degrees * kPi / 180;
        Scene scene           = one_ray(vec3(0), vec3(float(std::sin(in)), float(std::cos(in)), 0));
        const std::uint32_t m = add_glass(scene, 0.75f, 1.5f, 0.125f);
        const Mesh body       = make_box({40, 2, 40});
        add_object(scene, "body", body.positions, {}, body.triangles, m);
        return tree_of(scene, {.depth = 2});
    };
    const RayTree leaves = seen(30);
    EXPECT_EQ(leaves.levels[0].counts.total, 0u);
    ASSERT_EQ(leaves.levels[1].rays.size(), 2u);
    EXPECT_EQ(leaves.levels[1].rays[0].kind, RayKind::reflected);
    EXPECT_EQ(leaves.levels[1].rays[0].factor, 0.125);
    EXPECT_EQ(leaves.levels[1].rays[1].factor, 0.75);
    EXPECT_NEAR(leaves.levels[1].rays[1].direction.x, 1.5 * 0.5, 1e-6);
    const RayTree stays = seen(45);
    EXPECT_EQ(stays.levels[0].counts.total, 1u);
    ASSERT_EQ(stays.levels[1].rays.size(), 1u);
    EXPECT_EQ(stays.levels[1].rays[0].kind, RayKind::reflected);
    EXPECT_EQ(stays.levels[1].rays[0].factor, 0.875);
    EXPECT_NEAR(stays.levels[1].rays[0].direction.y, -std::sqrt(0.5), 1e-6);
}

/// A ray between the eye's two mirrors at x = 1 and x = -1, both up to y = 1.5, which rises by a half from one to the
/// other.
Scene corridor() {
    Scene scene = one_ray(vec3(0), vec3(4, 1, 0));
    scene.width = 5, scene.height = 3;
    scene.camera.projection   = Projection::orthographic;
    scene.camera.height       = 0.01f;
    const std::uint32_t right = add_mirror(scene, 0.5f, vec3(1, 0, 0.25f)),
                        left  = add_mirror(scene, 0.25f, vec3(0, 1, 0.5f));
    add_quad(scene, {1, -1, -1}, {1, -1, 1}, {1, 1.5f, 1}, {1, 1.5f, -1}, right);
    add_quad(scene, {-1, -1, -1}, {-1, -1, 1}, {-1, 1.5f, 1}, {-1, 1.5f, -1}, left);
    return scene;
}

/// It meets mirrors at the heights 0.25, 0.75 and 1.25; the next would be at 1.75.
TEST(Whitted, CountsRaysOfACorridorByDepth) {
    const RayTree tree = tree_of(corridor());
    ASSERT_EQ(tree.levels.size(), 4u);
    const std::uint64_t all = 15;
    for (std::size_t d = 0; d < 4; ++d) {
        const RayCounts& counts = tree.levels[d].counts;
        EXPECT_EQ(counts.eye, d == 0 ? all : 0) << d;
        EXPECT_EQ(counts.reflected, d == 0 ? 0 : all) << d;
        EXPECT_EQ(counts.refracted, 0u) << d;
        EXPECT_EQ(counts.met, d < 3 ? all : 0) << d;
        EXPECT_EQ(counts.shadow, 0u) << d;
        EXPECT_EQ(counts.too_deep + counts.too_light, 0u) << d;
    }
    EXPECT_EQ(rays_by_eye_ray(tree), std::vector<std::uint32_t>(15, 4));

    const RayTree two = tree_of(corridor(), {.depth = 2});
    ASSERT_EQ(two.levels.size(), 2u);
    EXPECT_EQ(two.levels[1].counts.too_deep, all);
    EXPECT_EQ(two.levels[0].counts.too_deep, 0u);

    // Weights are 1, 0.5 and 0.125.
    const RayTree light = tree_of(corridor(), {.least_weight = 0.2});
    ASSERT_EQ(light.levels.size(), 2u);
    EXPECT_EQ(light.levels[1].counts.too_light, all);
    EXPECT_EQ(tree_of(corridor(), {.least_weight = 0.125}).levels.size(), 3u);
}

TEST(Whitted, FactorsMultiplyAlongThePath) {
    Scene scene        = corridor();
    scene.background   = vec3(0.5f);
    const RayTree tree = tree_of(scene);
    const dvec3 right(1, 0, 0.25), left(0, 1, 0.5), sky(0.5);
    const dvec3 expected[] = {right, right + 0.5 * left, right + 0.5 * left + 0.125 * right,
                              right + 0.5 * left + 0.125 * right + 0.0625 * sky};
    for (int depth = 1; depth <= 4; ++depth) {
        const vec3 found = pixel(picture_of(scene, tree, depth), 7);
        for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(found[c], float(expected[depth - 1][c])) << depth;
    }
    EXPECT_EQ(pixel(picture_of(scene, tree, 9), 7), pixel(picture_of(scene, tree, 4), 7));
}

/// Fog lies on every part of the path but the last, which leaves the scene.
TEST(Whitted, FogLiesBetweenMirrorsToo) {
    Scene scene        = corridor();
    scene.fog.law      = FogLaw::exponential;
    scene.fog.density  = 0.3f;
    scene.fog.colour   = vec3(0.5f);
    const RayTree tree = tree_of(scene, {.depth = 2});
    const vec3 found   = pixel(picture_of(scene, tree), 7);
    const double slope = std::sqrt(1 + 0.0625);
    const double near = std::exp(-0.3 * slope), far = std::exp(-0.3 * 2 * slope);  // 1 and 2 units in x
    const dvec3 right(1, 0, 0.25), left(0, 1, 0.5), fog(0.5);
    const dvec3 expected = near * (right + 0.5 * (far * left + (1 - far) * fog)) + (1 - near) * fog;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 1e-5);
}

/// Every triangle tested for every ray finds what the tree of boxes finds; a glass ball turns the central ray as the
/// formula of two refractions says.
TEST(Whitted, SearchAndTreeFindTheSameAndGlassTurnsAsItShould) {
    Scene scene           = one_ray({-3, 0.5f, 0}, {0, 0.5f, 0});
    const std::uint32_t m = add_glass(scene, 0.9f, 1.5f, 0.1f);
    const Mesh ball       = make_sphere(1, 256, 128);
    add_object(scene, "ball", ball.positions, ball.normals, ball.triangles, m);
    const RayTree tree = tree_of(scene);
    const RayScene rays(scene);
    std::size_t compared = 0;
    for (std::size_t level = 1; level < tree.levels.size(); ++level)
        for (std::size_t i = 0; i < tree.levels[level].rays.size(); ++i) {
            const Ray ray = secondary_ray(scene, tree, level, i);
            EXPECT_EQ(first_by_search(rays, scene, ray), tree.levels[level].points.triangle[i]);
            ++compared;
        }
    EXPECT_GE(compared, 6u);
    // Into the ball, and out of it: the second ray of level 1, and the first refracted one that starts there.
    const auto& third = tree.levels[2].rays;
    const auto out    = std::ranges::find_if(
           third, [](const SecondaryRay& ray) { return ray.parent == 1 && ray.kind == RayKind::refracted; });
    ASSERT_NE(out, third.end());
    const double in = std::asin(0.5), bent = std::asin(0.5 / 1.5);
    EXPECT_NEAR(std::acos(out->direction.x), 2 * (in - bent), 0.01);
    EXPECT_NEAR(out->weight, 0.81, 1e-6);
}

/// Whatever the light does by way of a mirror, S_j asks for the straight segment: the point stays dark under every
/// method, although the path light - mirror - floor is free.
TEST(Whitted, LightByWayOfAMirrorIsNotSeen) {
    Scene scene = one_ray({0, 3, 4}, vec3(0));
    scene.materials.resize(1);
    const std::uint32_t mirror = add_mirror(scene, 1);
    add_quad(scene, {-6, 0, 6}, {6, 0, 6}, {6, 0, -6}, {-6, 0, -6}, 0);
    add_quad(scene, {-2, 0, 3}, {-2, 0, -3}, {-2, 3, -3}, {-2, 3, 3}, mirror);                 // faces +x
    add_quad(scene, {0.4f, 1, 0.3f}, {0.8f, 1, 0.3f}, {0.8f, 1, -0.1f}, {0.4f, 1, -0.1f}, 0);  // before the light
    Light lamp;
    lamp.name = "lamp", lamp.position = {1, 2, 0};
    scene.lights.push_back(lamp);
    const RayScene rays(scene);

    // The light's mirror image is (-5, 2, 0): the path from the floor meets the mirror at (-2, 0.8, 0) and then
    // nothing.
    const dvec3 p(0), at(-2, 0.8, 0), light(1, 2, 0);
    const TriangleId floor = points_of(scene).triangle[0];
    ASSERT_EQ(scene.triangle_object[floor], 0u);
    const TriangleId met = first_by_search(rays, scene, {p, glm::normalize(at - p), floor, dvec3(0, 1, 0)});
    ASSERT_NE(met, kNoTriangle);
    EXPECT_EQ(scene.triangle_object[met], 1u);
    EXPECT_NEAR(glm::length(glm::normalize(light - at) - mirrored(glm::normalize(at - p), dvec3(1, 0, 0))), 0, 1e-12);
    EXPECT_EQ(first_by_search(rays, scene, {at, glm::normalize(light - at), met, dvec3(1, 0, 0)}), kNoTriangle);

    // The same path, found by the program; it ends where a body is between mirror and floor.
    const std::vector<MirrorPlane> planes = mirror_planes(scene);
    ASSERT_EQ(planes.size(), 1u);
    EXPECT_NEAR(planes[0].area, 18, 1e-6);
    EXPECT_EQ(lit_by_mirrors(rays, scene, points_of(scene), 0, planes), std::vector<std::uint8_t>{1});
    Scene blocked = scene;
    add_quad(blocked, {-1, 0.2f, 1}, {-1, 0.2f, -1}, {-1, 0.6f, -1}, {-1, 0.6f, 1}, 0);
    EXPECT_EQ(lit_by_mirrors(RayScene(blocked), blocked, points_of(scene), 0, planes), std::vector<std::uint8_t>{0});
    Scene sunny               = scene;
    sunny.lights[0].kind      = LightKind::directional;
    sunny.lights[0].direction = vec3(at - light);
    EXPECT_EQ(lit_by_mirrors(rays, sunny, points_of(scene), 0, planes), std::vector<std::uint8_t>{1});
    sunny.lights[0].direction.x = 3;
    EXPECT_EQ(lit_by_mirrors(rays, sunny, points_of(scene), 0, planes), std::vector<std::uint8_t>{0});

    const SceneFacts facts = find_facts(scene);
    const RayTree tree     = tree_of(scene);
    std::size_t asked      = 0;
    for (const MethodInfo* info : methods()) {
        Asked method(*info);
        if (!verdict(method.method(), facts)) continue;
        method.build(scene, facts);
        method.aim(0);
        EXPECT_LT(method.visibility(tree.levels[0].points, 0).s[0], 0.5f) << info->name;
        const Image image =
            gather(scene, tree,
                   light_of_rays(scene, tree,
                                 [&](const PointBatch& points) { return std::vector{method.visibility(points, 0)}; }),
                   5);
        EXPECT_FLOAT_EQ(image.at(0, 0), 0.1f) << info->name;  // the ambient term alone
        ++asked;
    }
    EXPECT_GE(asked, 7u);
}

/// S_j is asked at what mirrors show, and undefined answers are counted.
TEST(Whitted, AsksForShadowsByDepthAndCountsUndefinedAnswers) {
    Scene scene                = plain();
    scene.materials[0].reflect = 0.5f;
    const RayTree tree         = tree_of(scene, {.depth = 3});
    ASSERT_EQ(tree.levels.size(), 3u);
    std::vector<std::size_t> sizes;
    const TreeLight light = light_of_rays(scene, tree, [&](const PointBatch& points) {
        sizes.push_back(points.size());
        std::vector<VisibilityPlane> planes = lit_everywhere(scene, points);
        if (sizes.size() == 2) std::ranges::fill(planes[0].answer, Answer::undefined);
        return planes;
    });
    std::uint64_t pairs   = 0;
    for (std::size_t level = 0; level < 3; ++level) {
        EXPECT_EQ(sizes[level], tree.levels[level].counts.traced());
        std::uint64_t here = 0;
        for (std::size_t i = 0; i < sizes[level]; ++i)
            for (LightId j = 0; j < 2; ++j) here += tree.levels[level].points.asks(j, i) ? 1 : 0;
        EXPECT_EQ(tree.levels[level].counts.shadow, here);
        pairs += here;
    }
    std::size_t turned = 0;  // away from the eye: the ball is seen from below in the floor
    for (std::size_t level = 1; level < 3; ++level)
        for (std::size_t i = 0; i < sizes[level]; ++i) {
            const PointBatch& points = tree.levels[level].points;
            if (points.triangle[i] == kNoTriangle) continue;
            const dvec3 n(points.normal(i));
            EXPECT_LE(glm::dot(n, tree.levels[level].rays[i].direction), 1e-6) << level << ' ' << i;
            turned += glm::dot(n, dvec3(points.eye) - dvec3(points.position(i))) < 0 ? 1 : 0;
        }
    EXPECT_GT(turned, 20u);
    std::uint64_t of_the_lamp = 0;
    for (std::size_t i = 0; i < sizes[1]; ++i) of_the_lamp += tree.levels[1].points.asks(0, i) ? 1 : 0;
    EXPECT_EQ(light.undefined, of_the_lamp);
    EXPECT_GT(of_the_lamp, 50u);
    EXPECT_GT(pairs, 1000u);
    EXPECT_THROW((void)light_of_rays(scene, tree, [&](const PointBatch&) { return std::vector<VisibilityPlane>(2); }),
                 std::logic_error);
}

/// The perspective transform keeps lines straight and changes angles, so that the cosine is another there.
TEST(WrongSpace, AnglesChangeUnderThePerspectiveTransform) {
    Scene scene = plain();
    scene.lights.resize(1);
    scene.lights[0].attenuation.c1 = 1;
    scene.materials[0].k_a         = vec3(0);
    scene.materials[0].k_s         = vec3(0);
    scene.materials[0].k_d         = vec3(1);
    const PointBatch points        = points_of(scene);
    const CameraFrame& view        = *points.raster;
    const Image sum                = shade(scene, points, lit_everywhere(scene, points));
    const dvec3 light(scene.lights[0].position);
    // Of a point, in units of half the window: x, y, and 1 - 1 / depth, as a z-buffer has it.
    const auto transformed = [&](dvec3 p) {
        const dvec3 q = view.project(p);
        return dvec3(2 * q.x / view.width - 1, 1 - 2 * q.y / view.height, 1 / q.z - 1);
    };
    const auto rotated = [&](dvec3 p) {
        const dvec3 q = p - view.eye;
        return dvec3(glm::dot(q, view.right), glm::dot(q, view.up), -glm::dot(q, view.forward));
    };
    const auto cosine = [&](const auto& map, std::size_t i) {
        const TriangleId t = points.triangle[i];
        const dvec3 a = map(dvec3(scene.vertex(t, 0))), b = map(dvec3(scene.vertex(t, 1))),
                    c = map(dvec3(scene.vertex(t, 2))), p = map(exact_position(scene, points, i));
        return glm::dot(glm::normalize(glm::cross(b - a, c - a)), glm::normalize(map(light) - p));
    };
    double worst             = 0;
    std::size_t floor_points = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle || scene.triangle_object[points.triangle[i]] != 1) continue;
        const dvec3 p = exact_position(scene, points, i), to_light = light - p;
        const double expected = to_light.y / glm::length(to_light);  // the floor faces up
        EXPECT_NEAR(sum.at(i, 0), expected, 1e-5);
        EXPECT_NEAR(cosine(rotated, i), expected, 1e-9) << "turning the scene before the eye keeps angles";
        worst = std::max(worst, std::abs(cosine(transformed, i) - expected));
        ++floor_points;
    }
    EXPECT_GT(floor_points, 500u);
    EXPECT_GT(worst, 0.2);
}

}  // namespace
}  // namespace umbra
