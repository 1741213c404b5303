#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <string>

#include "umbra/core/base/error.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/planar/outline.h"
#include "umbra/shadows/planar/project.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

void add(Scene& scene, const std::string& name, const Mesh& mesh, const mat4& m = mat4(1)) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    const Mesh placed = transformed(mesh, m);
    add_object(scene, name, placed.positions, {}, placed.triangles, 0);
}
mat4 at(vec3 p) { return glm::translate(mat4(1), p); }

Light light_at(vec3 position) {
    Light light;
    light.position = position;
    return light;
}

VisibilityPlane project(const Scene& scene, const PointBatch& points, const std::string& choice = "planar_projection") {
    MethodCase run(choice, scene);
    run.prepare(0);
    return run.visibility(points, 0);
}

TEST(PlanarProjection, DefinesItsPlanesAndNothingElse) {
    const KnownScene known  = known_scene("two_lights");
    const PointBatch points = primary(known.scene);
    const SceneFacts facts  = find_facts(known.scene);
    const auto plane        = project(known.scene, points);
    std::size_t on = 0, off = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i)) continue;
        const bool planar = std::any_of(facts.planes.begin(), facts.planes.end(), [&](const PlanarReceiver& p) {
            return std::binary_search(p.triangles.begin(), p.triangles.end(), points.triangle[i]);
        });
        EXPECT_EQ(plane.defined(i), planar);
        ++(planar ? on : off);
    }
    EXPECT_GT(on, 1000u);
    EXPECT_GT(off, 100u) << "the ball";
}

TEST(PlanarProjection, SaysHowItServes) {
    const auto how = [](const Scene& scene, const std::string& choice) { return MethodCase(choice, scene).serves(); };
    const Scene boxes = known_scene("box_from_front").scene;
    EXPECT_EQ(how(boxes, "planar_projection").how, How::to_rounding);
    EXPECT_NE(how(boxes, "planar_projection").why.find("100 %"), std::string::npos);
    EXPECT_EQ(how(boxes, "planar_projection:plane_share=0.95").how, How::not_at_all);
    EXPECT_EQ(how(known_scene("penumbra_of_half_plane").scene, "planar_projection").how, How::approximately);
    Scene ball;
    add(ball, "ball", make_sphere(1, 64, 32));
    ball.lights.push_back(light_at({0, 5, 0}));
    EXPECT_EQ(how(ball, "planar_projection").how, How::not_at_all);
}

/// Two triangles of 10^12, the second 1 above the first, at one corner where they slope: those are taken for one plane,
/// which cannot hold the shadow of the one on the other. Level ones are told apart.
TEST(PlanarProjection, SaysToRoundingOfExactPlanesOnly) {
    const float far = 1e12f;
    for (const bool slopes : {false, true}) {
        Mesh floor{{{-far, 0, -far}, {far, 0, -far}, {0, 0, far}}, {}, {{0, 2, 1}}};
        if (slopes)
            for (vec3& x : floor.positions) x.y = x.x;
        Scene scene;
        add(scene, "floor", floor);
        floor.positions[2].y = std::nextafter(floor.positions[2].x + 1, far);
        if (!slopes)
            for (vec3& x : floor.positions) x.y = 1;
        add(scene, "other", floor);
        scene.lights.push_back(light_at({0, 5, 0}));
        const Service service = MethodCase("planar_projection", scene).serves();
        EXPECT_EQ(service.how, slopes ? How::approximately : How::to_rounding);
        EXPECT_EQ(service.why.find("flat up to the rounding of floats only") != std::string::npos, slopes);
    }
}

TEST(PlanarProjection, LeavesSmallerPlanesOpenWhereTheShareIsRaised) {
    const Scene scene       = known_scene("box_from_front").scene;
    const PointBatch points = primary(scene);
    const auto plane        = project(scene, points, "planar_projection:plane_share=0.5");
    for (std::size_t i = 0; i < points.size(); ++i)
        if (is_open(points, 0, i)) {
            EXPECT_EQ(plane.defined(i), scene.triangle_object[points.triangle[i]] == 0) << "only the floor";
        }
}

/// Scenes of any size and position give what brute force gives.
TEST(PlanarProjection, IsExactAtEveryScale) {
    for (const float scale : {1e-6f, 1e-3f, 1e4f, 1e9f}) {
        Scene scene = known_scene("beyond_light_and_floor").scene;
        for (vec3& p : scene.positions) p *= scale;
        scene.lights[0].position *= scale;
        scene.camera.eye *= scale;
        const PointBatch points = primary(scene);
        // Brute force has an absolute slack: it gets the scene in its usual size, at the same points.
        Scene usual    = known_scene("beyond_light_and_floor").scene;
        const auto got = project(scene, points), right = brute_force(usual, points, 0);
        std::size_t compared = 0, wrong = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_open(points, 0, i) || !got.defined(i) || !right.defined(i)) continue;
            ++compared;
            wrong += got.s[i] != right.s[i];
        }
        EXPECT_GT(compared, 3000u) << scale;
        // Scaling rounds every vertex again, so that a point or two may change sides.
        EXPECT_LE(wrong, 2u) << scale;
    }
}

/// A fine mesh, light at a slant, dense points: one seam between two triangles that lets light through would show.
TEST(PlanarProjection, HasNoPinholes) {
    Scene scene;
    add(scene, "floor", make_plane(8, 8), glm::rotate(mat4(1), 0.2f, vec3(0.6f, 0, 0.8f)));
    add(scene, "torus", make_torus(1, 0.45f, 160, 80), glm::rotate(at({0, 1.7f, 0}), 0.7f, vec3(1, 0, 0)));
    scene.lights.push_back(light_at({1.5f, 6, 0.7f}));
    scene.camera.eye        = {0, 7, 5};
    scene.width             = 640;
    scene.height            = 400;
    const PointBatch points = primary(scene);
    const auto got = project(scene, points), right = project(scene, points, "exact");
    std::size_t umbra = 0, wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i) || !got.defined(i) || !right.defined(i)) continue;
        umbra += right.s[i] == 0;
        wrong += got.s[i] != right.s[i];
    }
    EXPECT_GT(umbra, 10000u);
    EXPECT_EQ(wrong, 0u);
}

/// Points whose ray passes exactly through an edge that two occluders share: whichever way rounding turns, one of the
/// two must catch it. From a light at height 4, an edge's ends a at height 2 and b at height 3 fall on exactly 2 a and
/// 4 b; there lie the ends of an edge of the floor, and its middle is the point.
TEST(PlanarProjection, SharedEdgesAreWatertight) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> anywhere(0.1f, 1.0f);
    std::size_t lit = 0, asked = 0;
    for (int i = 0; i < 500; ++i) {
        const vec3 a(-anywhere(random), 2, anywhere(random)), b(anywhere(random), 3, anywhere(random));
        const vec3 front(0.5f * (a.x + b.x), 2.5f, a.z + b.z + 1), back(0.5f * (a.x + b.x), 2.5f, -a.z - b.z - 1);
        Scene scene;
        add(scene, "floor", Mesh{{{2 * a.x, 0, 2 * a.z}, {4 * b.x, 0, 4 * b.z}, {0, 0, 20}}, {}, {{0, 1, 2}}});
        add(scene, "roof", Mesh{{a, b, front, back}, {}, {{0, 1, 2}, {1, 0, 3}}});
        scene.lights.push_back(light_at({0, 4, 0}));
        PointBatch points;
        points.eye = {0, 10, 0};
        points.resize(1);
        set_point(points, 0, scene, 0, 0.5f, 0.0f);
        face_lights(points, scene);
        const auto plane = project(scene, points);
        asked += plane.defined(0);
        lit += plane.s[0] != 0;
    }
    EXPECT_EQ(asked, 500u);
    EXPECT_EQ(lit, 0u);
}

/// Far from the origin a tilted floor is only as flat as its vertices' rounding: here 2e-4, under a low sun.
TEST(PlanarProjection, RoughTiltedFloorUnderALowSun) {
    Scene scene;
    const mat4 place_far = glm::translate(mat4(1), vec3(3000, 2000, -4000));
    const mat4 tilt      = glm::rotate(place_far, 0.4f, vec3(0.6f, 0, 0.8f));
    add(scene, "floor", make_plane(8, 8, 10), tilt);
    add(scene, "box", make_box({0.5f, 0.5f, 0.5f}), glm::translate(tilt, vec3(1, 0.6f, 0)));
    add(scene, "ball", make_sphere(0.3f, 24, 12), glm::translate(tilt, vec3(-1, 0.6f, 1)));
    Light sun;
    sun.kind      = LightKind::directional;
    sun.direction = vec3(tilt * vec4(-1, -0.12f, 0.3f, 0));
    scene.lights.push_back(sun);
    scene.camera.eye        = vec3(tilt * vec4(0, 5, 5, 1));
    scene.camera.target     = vec3(tilt * vec4(0, 0, 0, 1));
    scene.width             = 640;
    scene.height            = 400;
    const PointBatch points = primary(scene);
    const auto got = project(scene, points), right = project(scene, points, "exact");
    std::size_t umbra = 0, wrong = 0, undefined = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i) || scene.triangle_object[points.triangle[i]] != 0) continue;
        undefined += !got.defined(i);
        if (!got.defined(i) || !right.defined(i)) continue;
        umbra += right.s[i] == 0;
        wrong += got.s[i] != right.s[i];
    }
    EXPECT_EQ(undefined, 0u);
    EXPECT_GT(umbra, 3000u);
    EXPECT_EQ(wrong, 0u);
}

/// A light that lies on an occluder is hidden by it nowhere but in the occluder's own plane.
TEST(PlanarProjection, LightOnAnOccluderIsNotHiddenByIt) {
    // Vertex, edge and inside of a slanted triangle, edge and inside of a level one.
    const Mesh slanted{{{-1, 1, 0.25f}, {1, 1, 0.25f}, {0, 3, 1}}, {}, {{0, 1, 2}}};
    const Mesh level{{{-1, 2, -1}, {1, 2, -1}, {0, 2, 2}}, {}, {{0, 1, 2}}};
    const auto umbra = [](const Mesh& occluder, vec3 light) {
        Scene scene;
        add(scene, "floor", make_plane(8, 8));
        add(scene, "occluder", occluder);
        scene.lights.push_back(light_at(light));
        scene.width             = 96;
        scene.height            = 64;
        scene.camera.eye        = {0, 4, 7};
        const PointBatch points = primary(scene);
        const auto plane        = project(scene, points);
        std::size_t n           = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            n += is_open(points, 0, i) && scene.triangle_object[points.triangle[i]] == 0 && plane.s[i] == 0;
        return n;
    };
    EXPECT_EQ(umbra(slanted, {0, 3, 1}), 0u);
    EXPECT_EQ(umbra(slanted, {0, 1, 0.25f}), 0u);
    EXPECT_EQ(umbra(slanted, {0, 2, 0.625f}), 0u);
    EXPECT_EQ(umbra(level, {0, 2, -1}), 0u);
    EXPECT_EQ(umbra(level, {0, 2, 0}), 0u);
    EXPECT_GT(umbra(level, {0, 2.5f, 0}), 500u) << "a little above it, it does hide the floor";
}

TEST(PlanarProjection, LightInOrUnderThePlaneLeavesItDark) {
    for (const float height : {0.0f, -1.0f}) {
        Scene scene;
        add(scene, "floor", make_plane(8, 8));
        add(scene, "box", make_box({1, 1, 1}), at({0, 1, 0}));
        scene.materials[0].two_sided = false;
        scene.lights.push_back(light_at({3, height, 0}));
        const PointBatch points = primary(scene);
        const auto plane        = project(scene, points);
        for (std::size_t i = 0; i < points.size(); ++i)
            if (points.triangle[i] != kNoTriangle && scene.triangle_object[points.triangle[i]] == 0) {
                ASSERT_EQ(plane.s[i], 0);
                ASSERT_TRUE(plane.defined(i));
            }
    }
}

/// Lights with an area over a half-plane x > 0 at height 2, light centre at height 4: S in closed form.
class Penumbra : public testing::Test {
protected:
    static double rmse(const Light& light, int samples, const std::function<double(double)>& s_of_x) {
        Scene scene             = known_scene("penumbra_of_half_plane").scene;
        scene.lights[0]         = light;
        const PointBatch points = primary(scene);
        const auto plane        = project(scene, points, "planar_projection:light_samples=" + std::to_string(samples));
        double sum              = 0;
        std::size_t n           = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points.facing[0][i] != Facing::front || scene.triangle_object[points.triangle[i]] != 0) continue;
            const double d = static_cast<double>(plane.s[i]) - s_of_x(place(scene, points, i).x);
            sum += d * d;
            ++n;
        }
        EXPECT_GT(n, 3000u);
        return std::sqrt(sum / static_cast<double>(n));
    }
    /// Share of a disk on the near side of a chord at `t` radii from its centre.
    static double disk_share(double t) {
        t = std::clamp(t, -1.0, 1.0);
        return 1 - (std::acos(t) - t * std::sqrt(1 - t * t)) / kPi;
    }
    static Light light_of(LightKind kind) {
        Light light     = light_at({0, 4, 0});
        light.kind      = kind;
        light.edge_u    = {1.5f, 0, 0};
        light.edge_v    = {0, 0, -1.5f};
        light.direction = {0, 1, 0};
        light.radius    = 0.75f;
        return light;
    }
};

/// A light that is half under the floor: the floor sees the upper half of it.
TEST_F(Penumbra, OfALightThatThePlaneCuts) {
    Scene scene               = known_scene("penumbra_of_half_plane").scene;
    scene.lights[0]           = light_of(LightKind::rectangle);
    scene.lights[0].position  = {3.9f, 0, 0};
    scene.lights[0].edge_u    = {0, 1, 0};
    scene.lights[0].direction = {1, 0, 0};
    const PointBatch points   = primary(scene);
    const auto plane          = project(scene, points);
    std::size_t seen          = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.facing[0][i] != Facing::partly) continue;
        ASSERT_EQ(plane.s[i], 0.5f);
        ++seen;
    }
    EXPECT_GT(seen, 3000u);
}

TEST_F(Penumbra, OfARectangle) {
    const auto s = [](double x) { return std::clamp((-x + 0.75) / 1.5, 0.0, 1.0); };
    EXPECT_LT(rmse(light_of(LightKind::rectangle), 64, s), 0.01);
    EXPECT_LT(rmse(light_of(LightKind::rectangle), 1024, s), 0.001);
}

TEST_F(Penumbra, OfADisk) {
    const auto s = [](double x) { return disk_share(-x / 0.75); };
    EXPECT_LT(rmse(light_of(LightKind::disk), 64, s), 0.02);
    EXPECT_LT(rmse(light_of(LightKind::disk), 1024, s), 0.003);
}

TEST_F(Penumbra, OfASphere) {
    // The floor point x sees the sphere within a cone; the plane through x and the edge cuts it.
    const auto s = [](double x) {
        const double distance = std::hypot(x, 4.0);
        const double edge     = std::hypot(x, 2.0);                    // to the half-plane's edge (0, 2)
        const double sine  = (-x * 2 - (-x) * 4) / (edge * distance);  // angle from the edge to the centre, both from x
        const double cone  = 0.75 / distance;
        const double chord = std::tan(std::asin(sine)) / std::tan(std::asin(cone));
        return disk_share(-chord);
    };
    EXPECT_LT(rmse(light_of(LightKind::sphere), 64, s), 0.03);
    EXPECT_LT(rmse(light_of(LightKind::sphere), 1024, s), 0.015) << "the nearness of the light is left out";
}

/// An area light's shadows are made in aim, once for each sample, and visibility adds nothing.
TEST(PlanarProjection, AimHoldsTheShadowsOfEverySample) {
    const Scene scene       = known_scene("penumbra_of_half_plane").scene;
    const PointBatch points = primary(scene);
    const auto bytes        = [&](int samples) {
        MethodCase run("planar_projection:light_samples=" + std::to_string(samples), scene);
        run.build();
        const std::size_t built = run.memory_bytes();
        run.aim(0);
        const std::size_t aimed = run.memory_bytes();
        (void)run.visibility(points, 0);
        EXPECT_EQ(run.memory_bytes(), aimed);
        return aimed - built;
    };
    EXPECT_GT(bytes(16), 16 * sizeof(planar::Shadow));
    EXPECT_NEAR(static_cast<double>(bytes(64)), 4.0 * static_cast<double>(bytes(16)),
                0.2 * 4.0 * static_cast<double>(bytes(16)));
}

/// Both settings answer alike: what they hold tells them apart. Edges that triangles share are found in build, and of
/// a ball's shadow only its outline is kept.
TEST(PlanarProjection, ProjectsTheEdgesThatTheSettingNames) {
    Scene scene;
    add(scene, "floor", make_plane(8, 8));
    add(scene, "ball", make_sphere(0.5f, 64, 32), at({0, 1, 0}));
    scene.lights.push_back(light_at({0, 4, 0}));
    const auto bytes = [&](const std::string& edges) {
        MethodCase run("planar_projection:edges=" + edges, scene);
        run.build();
        const std::size_t built = run.memory_bytes();
        run.aim(0);
        return std::pair(built, run.memory_bytes() - built);
    };
    const auto [weighted_build, weighted_aim] = bytes("weighted");
    const auto [single_build, single_aim]     = bytes("per_triangle");
    EXPECT_GT(weighted_build, 2 * single_build);
    EXPECT_LT(2 * weighted_aim, single_aim);
}

/// More samples than memory holds are refused with a number that fits, which then does fit.
TEST(PlanarProjection, RefusesMoreSamplesThanMemoryHolds) {
    const Scene scene      = known_scene("penumbra_of_half_plane").scene;
    const SceneFacts facts = find_facts(scene);
    planar::Occluders occluders{&scene, {}, std::vector(scene.triangles.size(), planar::Occluders::kNoPlane)};
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) occluders.triangles.push_back(t);
    const std::vector<planar::Receiver> receivers{planar::make_receiver(scene, facts.planes[0], 0, +1),
                                                  planar::make_receiver(scene, facts.planes[0], 0, -1)};
    const auto project = [&](int samples, double limit) {
        return planar::project(occluders, nullptr, receivers, planar::sources_of(scene.lights[0], samples), limit);
    };
    const auto limit = static_cast<double>(planar::memory_bytes(project(20, 1e9)));
    try {
        (void)project(64, limit);
        FAIL() << "64 samples fit into the memory of 20";
    } catch (const UsageError& e) {
        const std::string what = e.what();
        EXPECT_NE(what.find("light_samples=64 take"), std::string::npos) << what;
        const std::string fit = "; light_samples=";
        ASSERT_NE(what.find(fit), std::string::npos) << what;
        const int samples = std::stoi(what.substr(what.find(fit) + fit.size()));
        EXPECT_GE(samples, 18);
        EXPECT_NO_THROW((void)project(samples, limit));
    }
    EXPECT_NO_THROW((void)project(1, 1)) << "one source is never refused";
}

}  // namespace
}  // namespace umbra
