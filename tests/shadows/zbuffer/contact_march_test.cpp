// Contact shadows: a march through the picture, beside what is known of the scene and the picture.
#include "umbra/shadows/zbuffer/contact_march.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/base/parallel.h"
#include "umbra/tests/support/map_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

std::vector<float> answers(const Scene& scene, const PointBatch& points, const std::string& choice) {
    MethodCase run(choice, scene);
    run.prepare(0);
    return run.visibility(points, 0).s;
}

/// Small boxes on a floor, under a light from the side.
Scene boxes(const Light& light) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(8, 8));
    add_mesh(scene, "large", make_box({0.6f, 0.5f, 0.6f}), {-0.8f, 0.25f, 0.2f});
    add_mesh(scene, "small", make_box({0.2f, 0.15f, 0.2f}), {0.7f, 0.075f, 0.5f});
    scene.lights        = {light};
    scene.camera.eye    = {0.3f, 3, 3};
    scene.camera.target = {0, 0.2f, 0};
    scene.width = 320, scene.height = 240;
    return scene;
}

const Light kLights[] = {directional_light({-2, -1, 0.4f}), point_light({3, 2, -1})};

/// A map so coarse, and a bias so large, that it loses the contacts.
const std::string kCoarse = "shadow_zbuffer:resolution=64,bias=manual,constant=20";

TEST(ContactMarch, FindsTheContactsThatABiasLoses) {
    for (const Light& light : kLights) {
        const Scene scene       = boxes(light);
        const PointBatch points = primary(scene);
        const auto exact = answers(scene, points, "exact"), map = answers(scene, points, kCoarse),
                   contact = answers(scene, points, kCoarse + ",contact_steps=64,contact_length=0.5");
        const auto thick = answers(scene, points, kCoarse + ",contact_steps=64,contact_length=0.5,contact_thickness=2");
        int too_thick = 0, lost = 0, still = 0, added = 0, lit = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_open(points, 0, i)) continue;
            EXPECT_LE(contact[i], map[i]);
            lost += exact[i] == 0 && map[i] > 0;
            still += exact[i] == 0 && contact[i] > 0;
            added += exact[i] == 1 && map[i] > 0 && contact[i] == 0;
            too_thick += exact[i] == 1 && map[i] > 0 && thick[i] == 0;
            lit += exact[i] == 1;
        }
        EXPECT_GT(lost, 400);
        EXPECT_LT(still, lost / 4);
        EXPECT_LT(added, lit / 500);
        EXPECT_GT(too_thick, 2 * added) << "what passes behind the boxes";
    }
}

TEST(ContactMarch, GoesNoFurtherThanItsLengthAndTheLight) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(4, 4));
    add_mesh(scene, "roof", make_box({1, 0.2f, 1}), {0, 1.1f, 0});
    scene.lights        = {point_light({0, 3, 0})};
    scene.camera.eye    = {0, 1, 6};
    scene.camera.target = {0, 1, 0};
    scene.width = 400, scene.height = 400;
    const PointBatch picture = primary(scene);
    // In front of the box, as the camera sees it, and behind its front: straight above, both pass it.
    const dvec3 before(0, 0, 0.6), behind(0, 0, 0.4);
    for (const Light& light : {point_light({0, 3, 0.6f}), directional_light({0, -1, 0})}) {
        EXPECT_FALSE(march(scene, picture, before, light, {200, 2, 2}));
    }
    for (const Light& light : {point_light({0, 3, 0.4f}), directional_light({0, -1, 0})}) {
        const auto hit = march(scene, picture, behind, light, {40, 2, 2});
        ASSERT_TRUE(hit);
        EXPECT_GE(picture.triangle[*hit], scene.objects[1].first_triangle);
        // Below the box, at 1 above the floor, it has not come to the box.
        EXPECT_FALSE(march(scene, picture, behind, light, {40, 0.98, 2}));
        EXPECT_TRUE(march(scene, picture, behind, light, {200, 1.15, 2}));
    }
    // Normals of one-sided materials need not face the eye.
    PointBatch away = picture;
    for (std::size_t i = 0; i < away.size(); ++i) away.nx[i] *= -1, away.ny[i] *= -1, away.nz[i] *= -1;
    EXPECT_EQ(march(scene, away, behind, directional_light({0, -1, 0}), {40, 2, 2}),
              march(scene, picture, behind, directional_light({0, -1, 0}), {40, 2, 2}));
    // What lets light through is seen and passed.
    Scene open                             = scene;
    open.objects[1].switches.casts_shadows = false;
    EXPECT_FALSE(march(open, picture, behind, directional_light({0, -1, 0}), {40, 2, 2}));
    // Nothing beyond the light blocks.
    EXPECT_FALSE(march(scene, picture, behind, point_light({0, 0.9f, 0.4f}), {40, 2, 2}));
    // Further behind what is seen than that is thick: behind it, not in it.
    EXPECT_FALSE(march(scene, picture, {0, 0, -0.4}, directional_light({0, -1, 0}), {200, 2, 0.8}));
    EXPECT_TRUE(march(scene, picture, {0, 0, -0.4}, directional_light({0, -1, 0}), {200, 2, 1}));
}

TEST(ContactMarch, APlaneDoesNotShadeItselfHoweverFlatItIsSeen) {
    Scene scene;
    add_mesh(scene, "floor", make_plane(20, 20));
    scene.width = 200, scene.height = 100;
    for (const float height : {5.0f, 0.5f, 0.05f})
        for (const vec3 direction : {vec3(-1, -0.01f, 0), vec3(0.1f, -0.01f, 1), vec3(0.3f, -1, -0.2f)}) {
            scene.lights            = {directional_light(direction)};
            scene.camera.eye        = {0.3f, height, 9};
            scene.camera.target     = {0, 0, 0};
            const PointBatch points = primary(scene);
            const auto s            = answers(scene, points, "shadow_zbuffer:contact_steps=8");
            for (std::size_t i = 0; i < s.size(); ++i)
                if (is_open(points, 0, i)) {
                    ASSERT_EQ(s[i], 1) << height;
                }
        }
}

TEST(ContactMarch, WhatThePictureDoesNotShowCastsNothing) {
    // The camera sees the floor before the box's shadow, not the box.
    Scene scene             = boxes(kLights[0]);
    scene.camera.eye        = {-1.5f, 2, 0.3f};
    scene.camera.target     = {-1.5f, 0, 0.25f};
    scene.camera.fov_y      = 10;
    const PointBatch points = primary(scene);
    ASSERT_LT(std::ranges::max(points.triangle), scene.objects[1].first_triangle) << "only the floor";
    EXPECT_EQ(answers(scene, points, kCoarse + ",contact_steps=64,contact_length=2,contact_thickness=2"),
              answers(scene, points, kCoarse));
}

TEST(ContactMarch, AnswersDoNotDependOnTheRasterOrTheThreads) {
    const Scene scene       = boxes(kLights[0]);
    const PointBatch points = primary(scene);
    std::vector<std::uint32_t> which;
    for (std::uint32_t i = 1; i < points.size(); i += 11) which.push_back(i);
    const std::string settings = kCoarse + ",contact_steps=16,contact_length=0.5";
    const auto all             = answers(scene, points, settings);
    const auto few             = answers(scene, pick(points, which), settings);
    int changed                = 0;
    const auto map             = answers(scene, points, kCoarse);
    for (std::size_t k = 0; k < which.size(); ++k) {
        ASSERT_EQ(few[k], all[which[k]]) << which[k];
        changed += few[k] != map[which[k]];
    }
    EXPECT_GT(changed, 30);
    const ThreadLimit limit(1);
    EXPECT_EQ(answers(scene, points, settings), all);
}

TEST(ContactMarch, WhatDependsOnTheCameraIsSaid) {
    const Scene scene = boxes(kLights[0]);
    const auto why    = [&](const char* choice) { return MethodCase(choice, scene).serves().why; };
    EXPECT_EQ(why("shadow_zbuffer").find("camera"), std::string::npos);
    EXPECT_NE(why("shadow_zbuffer:contact_steps=8").find("camera"), std::string::npos);
    EXPECT_NE(why("shadow_zbuffer:rotation=gradient").find("camera"), std::string::npos);
}

TEST(ContactMarch, BlamesWhatThePictureShows) {
    const Scene scene       = boxes(kLights[0]);
    const PointBatch points = primary(scene);
    MethodCase run(kCoarse + ",contact_steps=64,contact_length=0.5", scene);
    run.prepare(0);
    const auto s = run.visibility(points, 0).s, map = answers(scene, points, kCoarse);
    std::vector<std::uint32_t> which;
    for (std::uint32_t i = 0; i < points.size(); ++i)
        if (is_open(points, 0, i) && s[i] == 0 && map[i] == 1) which.push_back(i);
    ASSERT_GT(which.size(), 300u);
    std::vector<TriangleId> blockers(which.size());
    run.blame(pick(points, which), 0, blockers);
    for (const TriangleId t : blockers) {
        ASSERT_NE(t, kNoTriangle);
        EXPECT_GE(t, scene.objects[1].first_triangle) << "a box, not the floor";
    }
}

}  // namespace
}  // namespace umbra
