// Teaching scenes show what they say: known answers on the scene files themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/facing.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/scene/fog.h"
#include "umbra/shadows/radiosity/exchange.h"
#include "umbra/tests/support/lit_everywhere.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

Scene scene_named(const std::string& name) { return load_scene(std::string(UMBRA_SCENES) + "/" + name + ".json"); }

std::vector<VisibilityPlane> exact_planes(const Scene& scene, const PointBatch& points) {
    std::vector<VisibilityPlane> planes;
    MethodCase run("exact", scene);
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        run.prepare(light);
        planes.push_back(run.visibility(points, light));
    }
    return planes;
}

std::string object_at(const Scene& scene, const PointBatch& points, std::size_t i) {
    const TriangleId t = points.triangle[i];
    return t == kNoTriangle ? "" : scene.objects[scene.triangle_object[t]].name;
}

double triangle_area(const Scene& scene, TriangleId t) {
    const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

/// The hollow: the upper half of the ring's right part, where it faces the middle.
TEST(LectureScenes, TheHollowIsDarkForThreeReasons) {
    const Scene scene       = scene_named("three_reasons");
    const PointBatch points = primary(scene);
    std::vector<std::uint32_t> hollow;
    for (std::uint32_t i = 0; i < points.size(); ++i)
        if (object_at(scene, points, i) == "ring" && points.normal(i).x < -0.9f && points.px[i] > 0.6f &&
            points.py[i] > 0.03f && std::abs(points.pz[i]) < 0.15f)
            hollow.push_back(i);
    ASSERT_GT(hollow.size(), 50u);
    const PointBatch asked = pick(points, hollow);
    MethodCase run("exact", scene);
    const std::array<std::string, 3> reasons{"faces away", "board", "ring"};
    for (LightId light = 0; light < 3; ++light) {
        run.prepare(light);
        const VisibilityPlane plane = run.visibility(asked, light);
        std::vector<TriangleId> who(asked.size(), kNoTriangle);
        run.blame(asked, light, who);
        for (std::size_t i = 0; i < asked.size(); ++i) {
            if (asked.facing[light][i] == Facing::away) {
                EXPECT_EQ(reasons[light], "faces away");
                continue;
            }
            ASSERT_TRUE(plane.defined(i));
            EXPECT_EQ(plane.s[i], 0) << scene.lights[light].name;
            ASSERT_NE(who[i], kNoTriangle);
            EXPECT_EQ(scene.objects[scene.triangle_object[who[i]]].name, reasons[light]);
        }
    }
}

/// The lit fraction of the area, by triangles: half for the sun, (1 - r / d) / 2 for a lamp at the distance d from the
/// middle.
TEST(LectureScenes, TheLitShareIsAHalfOrLess) {
    const Scene scene = scene_named("lit_share");
    for (const char* ball : {"left_ball", "right_ball"}) {
        double all = 0, lit[2]{};
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
            if (scene.objects[scene.triangle_object[t]].name != ball) continue;
            all += triangle_area(scene, t);
            for (LightId light = 0; light < 2; ++light)
                if (side_of_light(scene.lights[light], scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2)) > 0)
                    lit[light] += triangle_area(scene, t);
        }
        EXPECT_NEAR(lit[0] / all, 0.5, 0.01) << ball;
        EXPECT_NEAR(lit[1] / all, 0.25, 0.015) << ball;
    }
}

/// The fraction of the ground in shadow that the eye sees: none with the sun behind it, much with the sun before it.
TEST(LectureScenes, ARoughSurfaceHidesItsShadowsFromTheLight) {
    const Scene scene       = scene_named("rough_ground");
    const PointBatch points = primary(scene);
    const auto planes       = exact_planes(scene, points);
    std::array<double, 2> dark{};
    std::size_t seen = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        ++seen;
        for (LightId light = 0; light < 2; ++light)
            dark[light] += !points.asks(light, i) || (planes[light].defined(i) && planes[light].s[i] == 0);
    }
    ASSERT_EQ(seen, points.size());
    EXPECT_EQ(scene.lights[0].name, "behind_the_eye");
    EXPECT_LT(dark[0] / double(seen), 0.002);  // silhouettes, where float directions are not quite the same
    EXPECT_GT(dark[1] / double(seen), 0.4);
}

TEST(LectureScenes, FogHidesShadowsAndLeavesVisibility) {
    const Scene scene       = scene_named("fog_colonnade");
    const PointBatch points = primary(scene);
    Scene clear             = scene;
    clear.fog.law           = FogLaw::none;
    const auto planes       = exact_planes(scene, points);
    EXPECT_EQ(planes[0].s, exact_planes(clear, points)[0].s);
    const Image foggy = shade(scene, points, planes), bare = shade(clear, points, planes);
    std::set<std::string> seen;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        seen.insert(object_at(scene, points, i));
        const double d = glm::length(exact_position(scene, points, i) - dvec3(scene.camera.eye));
        const double f = std::exp(-std::pow(double(scene.fog.density) * d, 2));
        ASSERT_NEAR(foggy.at(i, 0), f * bare.at(i, 0) + (1 - f) * scene.fog.colour.x, 2e-6);
    }
    EXPECT_TRUE(seen.contains("column_1") && seen.contains("column_8"));
}

TEST(LectureScenes, NothingLeavesTheClosedRoom) {
    const Scene scene       = scene_named("closed_room");
    const PointBatch points = primary(scene);
    EXPECT_EQ(std::ranges::count(points.triangle, kNoTriangle), 0);
    Exchange exchange(scene, {.size = 0.1, .light_samples = 4});
    for (int step = 0; step < 40; ++step) exchange.shoot();
    // Form factors are taken from centre to patch, so that a coarse patch sends somewhat more or less than all.
    EXPECT_NEAR(exchange.arrived(), 1, 0.08);
}

TEST(LectureScenes, FlatShadingIsRightOnFacesUnderSunAndInfiniteViewer) {
    const Scene scene       = scene_named("flat_is_right");
    const PointBatch points = primary(scene);
    const Image flat        = shaded(ShadingModel::flat, scene, points).linear,
                gouraud     = shaded(ShadingModel::gouraud, scene, points).linear,
                phong       = shaded(ShadingModel::phong, scene, points).linear;
    std::size_t faces = 0, bent = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::string object = object_at(scene, points, i);
        if (object.empty()) continue;
        if (object == "drum") {
            bent += flat.at(i, 0) != phong.at(i, 0);
            continue;
        }
        ++faces;
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(flat.at(i, c), phong.at(i, c)) << object;
            ASSERT_NEAR(gouraud.at(i, c), phong.at(i, c), 1e-6) << object;
        }
    }
    EXPECT_GT(faces, 20000u);
    EXPECT_GT(bent, 500u);
}

/// The picture as if nothing were hidden from the lights.
Image lit_picture(const Scene& scene, const PointBatch& points) {
    return shade(scene, points, lit_everywhere(scene, points));
}

/// Each pixel of a total is the sum of those of its terms, which are whole pixels apart.
TEST(LectureScenes, TheTotalIsTheSumOfItsTerms) {
    const Scene scene            = scene_named("terms_of_the_sum");
    const PointBatch points      = primary(scene);
    const Image image            = lit_picture(scene, points);
    constexpr std::size_t kApart = 150;  // pixels between two columns
    const auto green             = [&](std::size_t i) { return double(image.at(i, 1)); };
    for (const char* degrees : {"60", "25", "0"}) {
        const std::string row = std::string("_") + degrees;
        std::size_t compared = 0, lit = 0, shining = 0;
        for (std::size_t i = 0; i + 3 * kApart < points.size(); ++i) {
            if (object_at(scene, points, i) != "ambient" + row ||
                object_at(scene, points, i + kApart) != "diffuse" + row ||
                object_at(scene, points, i + 2 * kApart) != "specular" + row ||
                object_at(scene, points, i + 3 * kApart) != "total" + row)
                continue;
            ++compared;
            lit += green(i + kApart) > 0, shining += green(i + 2 * kApart) > 0.1;
            EXPECT_NEAR(green(i + 3 * kApart), green(i) + green(i + kApart) + green(i + 2 * kApart), 2e-3);
        }
        EXPECT_GT(compared, 6000u) << degrees;
        EXPECT_GT(lit, 4000u) << degrees;
        EXPECT_GT(shining, 100u) << degrees;
    }
}

/// The specular part alone: its largest value is k_s, and fewer pixels see half of that the larger n is.
TEST(LectureScenes, ShininessShrinksTheHighlightAndKsDimsIt) {
    const Scene scene = scene_named("phong_parameters");
    Scene matt        = scene;
    for (Material& m : matt.materials) m.k_s = vec3(0);
    const PointBatch points = primary(scene);
    const Image whole = lit_picture(scene, points), diffuse = lit_picture(matt, points);
    for (const int k : {100, 75, 50, 25, 0}) {
        std::size_t before = points.size();
        for (const int n : {5, 10, 20, 40}) {
            const std::string name = "k" + std::to_string(k) + "_n" + std::to_string(n);
            double peak            = 0;
            std::size_t bright     = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (object_at(scene, points, i) != name) continue;
                const double specular = double(whole.at(i, 0)) - double(diffuse.at(i, 0));
                peak                  = std::max(peak, specular);
                bright += specular > 0.005 * k;
            }
            EXPECT_NEAR(peak, k / 100.0, 0.02) << name;
            if (k == 0) continue;
            EXPECT_LT(bright, before) << name;
            EXPECT_GT(bright, 20u) << name;
            before = bright;
        }
    }
}

TEST(LectureScenes, OpenGLsMaterialsReflectMoreThanArrives) {
    const Scene scene    = scene_named("opengl_materials");
    std::size_t too_much = 0, named = 0;
    for (const Material& m : scene.materials) too_much += std::max({m.k_d.r + m.k_s.r, m.k_d.g + m.k_s.g}) > 1.00001f;
    for (const std::string& w : scene.warnings) named += w.find("reflects more light") != std::string::npos;
    EXPECT_EQ(named, too_much);
    EXPECT_EQ(too_much, 10u);
    const auto gold = std::ranges::find(scene.materials, "gold", &Material::name);
    ASSERT_NE(gold, scene.materials.end());
    EXPECT_FLOAT_EQ(gold->shininess, 51.2f);
    EXPECT_EQ(gold->k_a, vec3(0.24725f, 0.1995f, 0.0745f));
}

}  // namespace
}  // namespace umbra
