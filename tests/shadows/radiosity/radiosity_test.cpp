// Radiosity: form factors by formulas, patches and elements as what they are, exchange in rooms whose light is known,
// and S_j against `exact`.
#include "umbra/shadows/radiosity/radiosity.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/radiosity/exchange.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

using patches::Elements;
using patches::form_factor;
using patches::InPatch;
using patches::Patches;
using patches::PatchId;

/// A box whose faces look inwards, of one material.
Scene room(float k_d, float emission) {
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].k_d       = vec3(k_d);
    scene.materials[0].emission  = vec3(emission);
    scene.materials[0].two_sided = false;
    Mesh box                     = make_box({2, 1, 3});
    for (uvec3& t : box.triangles) std::swap(t[1], t[2]);
    add_object(scene, "room", box.positions, {}, box.triangles, 0);
    return scene;
}

// John Howell, A Catalog of Radiation Heat Transfer Configuration Factors: B-3, B-4.
TEST(FormFactor, IsAsKnownForRectangles) {
    for (const auto& [a, b, c] : {std::array{1.0, 1.0, 1.0}, std::array{0.2, 3.0, 0.5}, std::array{5.0, 0.1, 2.0}}) {
        const double x = a / c, y = b / c, rx = std::sqrt(1 + x * x), ry = std::sqrt(1 + y * y);
        const double parallel = (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2 * kPi);
        const std::array<dvec3, 4> above{dvec3(0, c, 0), dvec3(a, c, 0), dvec3(a, c, b), dvec3(0, c, b)};
        EXPECT_NEAR(form_factor(dvec3(0), {0, 1, 0}, above), parallel, 1e-14);
        const double across = (std::atan(b / c) - c / std::hypot(a, c) * std::atan(b / std::hypot(a, c))) / (2 * kPi);
        EXPECT_NEAR(form_factor(dvec3(0), {1, 0, 0}, above), across, 1e-14);
        const std::array<dvec3, 4> turned{above[3], above[2], above[1], above[0]};
        EXPECT_NEAR(form_factor(dvec3(0), {0, 1, 0}, turned), parallel, 1e-14);
        EXPECT_EQ(form_factor(dvec3(0), {0, -1, 0}, above), 0);
    }
}

TEST(FormFactor, AddsUpToOneInARoom) {
    const Scene scene = room(0, 0);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> inside(-0.45, 0.45);
    for (int k = 0; k < 100; ++k) {
        const dvec3 p = dvec3(2, 1, 3) * dvec3(inside(random), inside(random), inside(random));
        const dvec3 n = glm::normalize(dvec3(inside(random), inside(random), inside(random)));
        double sum    = 0;
        for (TriangleId t = 0; t < scene.triangles.size(); ++t)
            sum += form_factor(
                p, n, std::array{dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)), dvec3(scene.vertex(t, 2))});
        EXPECT_NEAR(sum, 1, 1e-12);
    }
}

TEST(Patches, CoverEveryTriangleOnce) {
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "two", {{0, 0, 0}, {1, 0, 0}, {0, 0, 7}, {3, 0, 3}}, {}, {{0, 1, 2}, {1, 3, 2}}, 0);
    for (const double longest : {100.0, 2.0, 0.3}) {
        const Patches patches(scene, longest);
        std::vector<double> area(2, 0);
        for (PatchId k = 0; k < patches.size(); ++k) {
            const auto [a, b, c] = patches.corners(k);
            const double twice   = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
            EXPECT_GT(twice, 0);
            area[patches.triangle(k)] += twice / 2;
            EXPECT_LE(patches.longest_edge(k), longest);
            for (const dvec2 uv : {dvec2(0.2, 0.3), dvec2(0.7, 0.2), dvec2(0.1, 0.85)}) {
                const dvec2 at   = a + uv.x * (b - a) + uv.y * (c - a);
                const InPatch in = patches.find(patches.triangle(k), at.x, at.y);
                EXPECT_EQ(in.patch, k);
                EXPECT_NEAR(in.u, uv.x, 1e-9);
                EXPECT_NEAR(in.v, uv.y, 1e-9);
            }
        }
        for (const double sum : area) EXPECT_NEAR(sum, 0.5, 1e-12);
        for (const dvec2 corner : {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1)})
            EXPECT_LT(patches.find(1, corner.x, corner.y).patch, patches.size());
    }
}

TEST(Elements, AreCutWhereTheValueChangesAndInterpolateIt) {
    Elements flat, step;
    flat.grow([](double u, double v) { return static_cast<float>(0.25 + 0.02 * u + 0.01 * v); }, 5, 0.05f);
    EXPECT_EQ(flat.leaves(), 1u);
    EXPECT_FLOAT_EQ(flat.at(0.3, 0.4, true), 0.25f + 0.02f * 0.3f + 0.01f * 0.4f);
    EXPECT_FLOAT_EQ(flat.at(0.3, 0.4, false), 0.25f + 0.01f);

    const auto edge = [](double u, double v) { return u + 0.5 * v > 0.371 ? 1.0f : 0.0f; };
    step.grow(edge, 5, 0.05f);
    EXPECT_GT(step.leaves(), 100u);
    std::size_t wrong = 0;
    std::set<std::size_t> seen;
    for (int i = 0; i < 100; ++i)
        for (int j = 0; i + j < 100; ++j) {
            const double u = (i + 0.31) / 100, v = (j + 0.17) / 100;
            seen.insert(step.leaf(u, v));
            const float value = step.at(u, v, true);
            // An element is 1/32 of the patch wide.
            if (std::abs(u + 0.5 * v - 0.371) > 0.05) wrong += std::abs(value - edge(u, v)) > 1e-6f ? 1 : 0;
        }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(seen.size(), step.leaves() / 2);
}

/// A shadow that lies between the corners is seen where it crosses the middle of an edge.
TEST(Elements, AreCutWhereOnlyTheMiddleOfAnEdgeDiffers) {
    Elements elements;
    elements.grow([](double u, double v) { return std::hypot(u - 0.5, v) < 0.2 ? 0.0f : 1.0f; }, 5, 0.05f);
    EXPECT_GT(elements.leaves(), 20u);
    EXPECT_EQ(elements.at(0.5, 0.01, true), 0);
    EXPECT_EQ(elements.at(0.1, 0.01, true), 1);
}

/// All that leaves a wall arrives at others: everywhere I = emission / (1 - k_d).
TEST(Exchange, FillsARoomEvenly) {
    for (const float k_d : {0.0f, 0.5f, 0.8f}) {
        const Scene scene = room(k_d, 0.25f);
        Exchange exchange(scene, {0.2, 1});
        EXPECT_EQ(exchange.unshot(), 1);
        for (int step = 0; step < 200'000 && exchange.unshot() > 1e-5; ++step) exchange.shoot();
        EXPECT_LE(exchange.unshot(), 1e-5);
        const double expected = 0.25 / (1 - static_cast<double>(k_d));
        for (Exchange::SideId side = 0; side < exchange.sides(); side += 2) {
            EXPECT_NEAR(exchange.direct(side).x, 0.25, 1e-7);
            EXPECT_NEAR(exchange.direct(side).y + exchange.indirect(side).y, expected, 2e-4);
        }
        EXPECT_NEAR(exchange.arrived(), 1, 0.03);  // a patch's centre stands for all of it where it is received
    }
}

TEST(Exchange, FormFactorsOfARoomAddUpToOne) {
    const Scene scene = room(0.5f, 1);
    const Exchange exchange(scene, {0.15, 1});
    for (Exchange::SideId from = 0; from < exchange.sides(); from += 14) {
        double sum = 0;
        for (Exchange::SideId to = 0; to < exchange.sides(); ++to) sum += exchange.form_factor(from, to);
        EXPECT_NEAR(sum, 1, 1e-12) << from;
    }
}

TEST(Exchange, LightsLeaveOutTheirExceptions) {
    Scene scene;
    scene.materials.resize(1);
    for (const float x : {0.0f, 2.0f})
        add_object(scene, x == 0 ? "near" : "far", {{x, 0, 0}, {x, 0, 1}, {x + 1, 0, 0}}, {}, {{0, 1, 2}}, 0);
    Light sun;
    sun.kind      = LightKind::directional;
    sun.direction = {0, -1, 0};
    sun.except    = {"far"};
    scene.lights.push_back(sun);
    const Exchange exchange(scene, {0.2, 1});
    PointBatch points;
    points.eye = {0, 5, 0};
    points.resize(2);
    for (TriangleId t = 0; t < 2; ++t) set_point(points, t, scene, t, 0.3f, 0.3f);
    EXPECT_GT(exchange.direct(exchange.side_at(points, 0)).x, 0.5);
    EXPECT_EQ(exchange.direct(exchange.side_at(points, 1)).x, 0);
}

/// A sheet under a lid: dark, unless it receives no shadows, or the lid casts none.
TEST(Exchange, LightsWhatReceivesNoShadows) {
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "sheet", {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, {}, {{0, 1, 2}}, 0);
    add_object(scene, "lid", {{-9, 1, -9}, {-9, 1, 9}, {9, 1, 9}, {9, 1, -9}}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
    Light sun;
    sun.kind      = LightKind::directional;
    sun.direction = {0, -1, 0};
    scene.lights.push_back(sun);
    PointBatch points;
    points.eye = {0, 0.5f, 0};
    points.resize(1);
    set_point(points, 0, scene, 0, 0.3f, 0.3f);
    const auto direct = [&] {
        const Exchange exchange(scene, {0.2, 1});
        return exchange.direct(exchange.side_at(points, 0)).x;
    };
    EXPECT_EQ(direct(), 0);
    scene.objects[0].switches.receives_shadows = false;
    EXPECT_GT(direct(), 0.5);
    scene.objects[0].switches.receives_shadows = true;
    scene.objects[1].switches.casts_shadows    = false;
    EXPECT_GT(direct(), 0.5);
}

/// Two plates that face each other exchange light; with a sheet between them they do not.
TEST(Exchange, DoesNotPassThroughSurfaces) {
    for (const bool sheet : {false, true}) {
        Scene scene;
        scene.materials.resize(2);
        scene.materials[0].emission = vec3(1);
        add_object(scene, "lamp", {{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
        add_object(scene, "floor", {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}, {}, {{0, 1, 2}, {0, 2, 3}}, 1);
        if (sheet)
            add_object(scene, "sheet", {{-9, 1, -9}, {-9, 1, 9}, {9, 1, 9}, {9, 1, -9}}, {}, {{0, 1, 2}, {0, 2, 3}}, 1);
        Exchange exchange(scene, {0.1, 1});
        for (int step = 0; step < 400; ++step) exchange.shoot();
        PointBatch points;
        points.resize(1);
        points.eye = {0, 0.5f, 0};
        set_point(points, 0, scene, 2, 0.4f, 0.3f);
        const vec3 light = exchange.indirect_at(points)[0];
        if (sheet)
            EXPECT_EQ(light.x, 0);
        else
            EXPECT_GT(light.x, 0.1f);
    }
}

/// A rectangle light over a sheet over a floor.
Scene sheet_under_panel() {
    Scene scene;
    scene.materials.resize(1);
    const Mesh floor = make_plane(8, 8);
    add_object(scene, "floor", floor.positions, {}, floor.triangles, 0);
    add_object(scene, "sheet", {{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
    Light panel;
    panel.name = "panel", panel.kind = LightKind::rectangle, panel.position = {0.5f, 4, 0.25f};
    panel.edge_u = {2, 0, 0}, panel.edge_v = {0, 0, 2}, panel.direction = {0, -1, 0};
    scene.lights.push_back(panel);
    scene.camera.eye = {0, 3.5f, 6}, scene.camera.target = {0, 0, 0};
    scene.width = 160, scene.height = 90;
    return scene;
}

double rmse(const Scene& scene, const std::string& choice) {
    const PointBatch points = primary(scene);
    MethodCase exact("exact:measure=irradiance", scene), method(choice, scene);
    exact.prepare(0), method.prepare(0);
    const VisibilityPlane truth = exact.visibility(points, 0), found = method.visibility(points, 0);
    double sum = 0, asked = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i) || !truth.defined(i)) continue;
        sum += std::pow(double(found.s[i]) - double(truth.s[i]), 2);
        ++asked;
    }
    return std::sqrt(sum / asked);
}

TEST(Radiosity, ComesCloserToExactWithSmallerElementsAndMoreRays) {
    const Scene scene   = sheet_under_panel();
    const double coarse = rmse(scene, "radiosity:size=0.125,levels=0,samples=256"),
                 finer  = rmse(scene, "radiosity:size=0.0625,levels=0,samples=256"),
                 fine   = rmse(scene, "radiosity:size=0.0625,levels=4,threshold=0.01,samples=256"),
                 noisy  = rmse(scene, "radiosity:size=0.0625,levels=4,threshold=0.01,samples=4"),
                 flat   = rmse(scene, "radiosity:size=0.125,levels=0,samples=256,interpolation=constant");
    EXPECT_LT(finer, coarse / 2);
    EXPECT_LT(fine, finer / 2);
    EXPECT_LT(fine, 0.004);
    EXPECT_GT(noisy, 4 * fine);
    EXPECT_GT(flat, coarse);
}

TEST(Radiosity, CutsPatchesOnlyWherePenumbraeAre) {
    const Scene scene       = sheet_under_panel();
    const PointBatch points = primary(scene);
    MethodCase run("radiosity:levels=4", scene), whole("radiosity:levels=0", scene);
    run.prepare(0), whole.prepare(0);
    const auto& cut        = as<RadiosityElements>(run.aimed());
    const auto& uncut      = as<RadiosityElements>(whole.aimed());
    const auto elements_of = [](const RadiosityElements& of) {
        std::size_t count = 0;
        for (const auto& side : of.sides)
            for (const Elements& patch : side) count += patch.leaves();
        return count;
    };
    EXPECT_GT(elements_of(cut), 4 * elements_of(uncut));
    EXPECT_LT(elements_of(cut), 100 * elements_of(uncut));
    const VisibilityPlane found = run.visibility(points, 0);
    // Where a patch is one element, S_j changes by no more than the threshold over it.
    std::map<PatchId, std::pair<float, float>> ranges;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i)) continue;
        const auto [patch, leaf] = cut.element(points, i);
        if (leaf != 0) continue;
        auto& [low, high] = ranges.try_emplace(patch, found.s[i], found.s[i]).first->second;
        low = std::min(low, found.s[i]), high = std::max(high, found.s[i]);
    }
    EXPECT_GT(ranges.size(), 20u);
    for (const auto& [patch, range] : ranges) EXPECT_LE(range.second - range.first, 0.0501f) << patch;
}

}  // namespace
}  // namespace umbra
