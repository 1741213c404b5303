// Lights in scene files, and their effect on the sum: the photometric law, goniometric lights, ambient
// terms, lights that are off, that leave out objects, that are fixed to the camera.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/io/scene_writer.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/render/sum.h"
#include "umbra/core/scene/facts.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

/// Two triangles in y = 0 that face up, white, with a corner each at the origin ("near") and at (10, 0, 0) ("far").
/// `members`: of the scene; the ambient light is 0 unless they say otherwise.
std::string scene_text(const std::string& members) {
    return R"({"camera": {"eye": [0, 3, 4], "target": [0, 0, 0]}, "materials": {"white": {"k_a": 0.5, "k_d": 1}},)" +
           members + (members.find("\"ambient\": ") < members.find("\"lights\"") ? "" : R"(, "ambient": 0)") +
           R"(, "objects": [
        {"type": "triangles", "name": "near", "material": "white", "positions": [[0, 0, 0], [0, 0, 1], [1, 0, 0]],
         "triangles": [[0, 1, 2]]},
        {"type": "triangles", "name": "far", "material": "white", "positions": [[10, 0, 0], [10, 0, 1], [11, 0, 0]],
         "triangles": [[0, 1, 2]]}]})";
}

Scene scene_with(const std::string& members) {
    const TemporaryFolder folder;
    return load_scene(folder.write("scene.json", scene_text(members)));
}

/// The sum at the first corner of a triangle, S_j as given.
double sum_at(const Scene& scene, TriangleId t, float s = 1) {
    PointBatch points;
    points.eye = scene.camera.eye;
    points.resize(1);
    set_point(points, 0, scene, t, 0, 0);
    face_lights(points, scene);
    std::vector<VisibilityPlane> planes(scene.lights.size(), VisibilityPlane(1));
    for (VisibilityPlane& plane : planes) plane.s[0] = s;
    return PhongSum(scene, frame(scene.camera, 2, 2)).at(points, 0, {0, 1, 0}, planes).r;
}

void expect_refused(const std::string& members, const std::string& expected) {
    try {
        (void)scene_with(members);
        ADD_FAILURE() << members << " was read";
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find(expected), std::string::npos) << e.what();
    }
}

/// E = I cos(theta) / d^2, also nearer than 1.
TEST(PhotometricLaw, IrradianceIsIntensityTimesCosineOverDistanceSquared) {
    for (const dvec3 at : {dvec3(0, 2, 0), dvec3(3, 4, 0), dvec3(-5, 1, 2), dvec3(0, 0.25, 0)}) {
        const Scene scene = scene_with(fmt::format(
            R"("lights": [{{"type": "point", "position": [{}, {}, {}], "intensity": 7, "attenuation": "photometric"}}])",
            at.x, at.y, at.z));
        const double d    = glm::length(at);
        EXPECT_NEAR(sum_at(scene, 0) / (7 * (at.y / d) / (d * d)), 1, 1e-6);
    }
    EXPECT_FALSE(scene_with(R"("lights": [{"type": "disk", "position": [0, 1, 0], "radius": 1,
                                          "attenuation": "photometric"}])")
                     .lights[0]
                     .attenuation.clamp);
    EXPECT_TRUE(scene_with(R"("lights": [{"type": "point", "position": [0, 1, 0], "attenuation": "photometric",
                                         "clamp": true}])")
                    .lights[0]
                    .attenuation.clamp);
    expect_refused(R"("lights": [{"type": "point", "position": [0, 1, 0], "attenuation": "photometrc"}])",
                   "did you mean \"photometric\"");
}

/// A square that glows, seen from 4 and from 8 away.
TEST(Radiance, StaysWhereIrradianceFallsWithTheSquare) {
    double irradiance[2] = {};
    for (const int away : {0, 1}) {
        Scene scene;
        scene.materials.resize(1);
        scene.materials[0].emission = vec3(0.75f);
        scene.materials[0].k_a      = vec3(0);
        add_object(scene, "square", {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}}, {},
                   {{0, 1, 2}, {0, 2, 3}}, 0);
        scene.camera.eye = {0, 0, away == 0 ? 4.0f : 8.0f}, scene.camera.target = vec3(0), scene.camera.fov_y = 20;
        constexpr int kSide     = 800;
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, kSide, kSide);
        const Image image       = shade(scene, points, {});
        const CameraFrame view  = *points.raster;
        const double pixel      = std::pow(2 * view.half_width / kSide, 2);
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const float value = image.at(static_cast<std::size_t>(y * kSide + x), 0);
                if (value == 0) continue;
                ASSERT_EQ(value, 0.75f);  // the radiance, at every distance
                const dvec3 ray     = view.ray_direction(x + 0.5, y + 0.5);
                const double cosine = glm::dot(glm::normalize(ray), view.forward);
                irradiance[away] += static_cast<double>(value) * cosine * pixel * std::pow(cosine, 3);
            }
    }
    // pi L sin^2 of a small square: L A / d^2 from far away; of this size, 3 % less at 4.
    EXPECT_NEAR(irradiance[1], 0.75 / 64, 0.75 / 64 * 0.02);
    EXPECT_NEAR(irradiance[0] / irradiance[1], 4, 0.1);
}

TEST(LightAmbient, IsAttenuatedWhereTheSceneSaysSo) {
    const std::string light = R"("lights": [{"type": "point", "position": [0, 2, 0], "ambient": 0.5, "intensity": 0,
                                "attenuation": "photometric"}])";
    for (const float s : {0.0f, 1.0f}) {  // never shadowed
        EXPECT_NEAR(sum_at(scene_with(light), 0, s), 0.25, 1e-6);
        EXPECT_NEAR(sum_at(scene_with(R"("light_ambient": "constant",)" + light), 1, s), 0.25, 1e-6);
        const Scene attenuated = scene_with(R"("light_ambient": "attenuated",)" + light);
        EXPECT_NEAR(sum_at(attenuated, 0, s), 0.25 / 4, 1e-6);
        EXPECT_NEAR(sum_at(attenuated, 1, s), 0.25 / 104, 1e-6);
    }
    // The spot's factor acts on it, too, as in OpenGL: nothing outside the cone.
    const Scene spot = scene_with(R"("light_ambient": "attenuated", "lights": [{"type": "spot", "position": [0, 2, 0],
                                     "direction": [0, -1, 0], "cutoff": 30, "ambient": 1, "intensity": 0}])");
    EXPECT_NEAR(sum_at(spot, 0), 0.5, 1e-6);
    EXPECT_EQ(sum_at(spot, 1), 0);
    expect_refused(R"("light_ambient": "far", "lights": [])", "constant");
}

/// Emission and the global ambient light are outside the sum over lights: two lights do not count them twice, as they
/// would where DE2 prints them.
TEST(LightAmbient, GlobalOneAndEmissionCountOnce) {
    const std::string light   = R"({"type": "point", "position": [0, 2, 0], "ambient": 0.25, "intensity": 0})";
    Scene one                 = scene_with(R"("ambient": 1, "lights": [)" + light + "]");
    Scene two                 = scene_with(R"("ambient": 1, "lights": [)" + light + "," + light + "]");
    one.materials[0].emission = two.materials[0].emission = vec3(0.125f);
    EXPECT_NEAR(sum_at(one, 0), 0.125 + 0.5 * 1.25, 1e-6);
    EXPECT_NEAR(sum_at(two, 0), 0.125 + 0.5 * 1.5, 1e-6);
}

TEST(Lights, ThatAreOffAreAbsent) {
    const std::string lamp = R"({"type": "point", "position": [0, 2, 0]})";
    const std::string off  = R"({"name": "lamp", "type": "point", "position": [1, 2, 0], "ambient": 1, "on": false})";
    const Scene one        = scene_with(R"("lights": [)" + lamp + "]");
    const Scene two        = scene_with(R"("lights": [)" + off + "," + lamp + "]");
    ASSERT_EQ(two.lights.size(), 1u);
    EXPECT_EQ(native_text(one), native_text(two));
    const Scene dark = scene_with(R"("lights": [)" + off + "]");
    EXPECT_TRUE(dark.lights.empty()) << "no light is assumed";
    EXPECT_EQ(sum_at(dark, 0), 0);
    expect_refused(R"("lights": [{"type": "point", "on": false}])", "position");
}

TEST(Lights, LeaveOutObjects) {
    const std::string light = R"("lights": [{"type": "directional", "direction": [0, -1, 0], "ambient": 0.5 )";
    const Scene all         = scene_with(light + "}]");
    const Scene scene       = scene_with(light + R"(, "except": ["far"]}])");
    EXPECT_NEAR(sum_at(all, 1), 1.25, 1e-6);
    EXPECT_EQ(sum_at(scene, 0), sum_at(all, 0));
    EXPECT_EQ(sum_at(scene, 1), 0) << "neither diffuse nor ambient";

    // S_j is asked as before: a matter of geometry.
    PointBatch points;
    points.eye = scene.camera.eye;
    points.resize(1);
    set_point(points, 0, scene, 1, 0, 0);
    face_lights(points, scene);
    EXPECT_EQ(points.facing[0][0], Facing::front);

    Light parts;
    parts.except = {"mesh"};
    EXPECT_FALSE(lights_object(parts, "mesh"));
    EXPECT_FALSE(lights_object(parts, "mesh/part"));
    EXPECT_TRUE(lights_object(parts, "meshes"));
    expect_refused(light + R"(, "except": ["fer"]}])", "unknown object \"fer\" (did you mean \"far\"?");
    expect_refused(light + R"(, "except": "far"}])", "a list of names of objects");
}

TEST(Lights, FixedToTheCameraMoveWithIt) {
    Scene scene = scene_with(R"("lights": [
        {"name": "head", "type": "spot", "position": [0, 0, 0], "direction": [0, 0, -1], "fixed_to": "camera"},
        {"name": "right", "type": "point", "position": [2, 0, 0], "fixed_to": "camera"},
        {"name": "panel", "type": "rectangle", "position": [0, 1, 0], "size": [2, 1], "direction": [0, 0, -1],
         "fixed_to": "camera"},
        {"name": "still", "type": "point", "position": [2, 0, 0], "fixed_to": "scene"}])");
    for (const vec3 eye : {vec3(0, 3, 4), vec3(5, 1, -2)}) {
        scene.camera.eye = eye;
        place_fixed_lights(scene);
        const CameraFrame camera = frame(scene.camera, 1, 1);
        EXPECT_EQ(scene.lights[0].position, eye);
        EXPECT_LT(glm::distance(dvec3(scene.lights[0].direction), camera.forward), 1e-6);
        EXPECT_LT(glm::distance(dvec3(scene.lights[1].position), camera.eye + 2.0 * camera.right), 1e-5);
        EXPECT_LT(glm::distance(dvec3(scene.lights[2].position), camera.eye + camera.up), 1e-5);
        EXPECT_LT(glm::distance(dvec3(scene.lights[2].direction), camera.forward), 1e-6);
        EXPECT_NEAR(glm::length(scene.lights[2].edge_u), 2, 1e-5);
        EXPECT_EQ(scene.lights[3].position, vec3(2, 0, 0));
    }
    EXPECT_EQ(find_facts(scene).lights[0].place, LightPlace::at_eye);
}

/// Lights have no geometry: a ray into one meets the surface behind it.
TEST(Lights, AreNotSeen) {
    const Scene scene       = scene_with(R"("background": 0.25, "lights": [
        {"type": "sphere", "position": [0, 0, -1], "radius": 0.9, "intensity": 9, "fixed_to": "camera"}])");
    const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 16, 9);
    EXPECT_EQ(points.triangle[0], kNoTriangle);
    const std::vector<VisibilityPlane> lit(1, VisibilityPlane(points.size()));
    EXPECT_EQ(shade(scene, points, lit).at(0, 0), 0.25f);
}

/// Warnock's rule: brightness falls with the distance from the eye, where the light is. The scene's light has
/// 1 / (c1 + c2 d), limited to 1.
TEST(Warnock, IsAnAttenuatedLightAtTheEye) {
    const Scene scene = load_scene(std::string(UMBRA_SCENES) + "/warnock.json");
    ASSERT_EQ(scene.lights.size(), 1u);
    ASSERT_TRUE(scene.lights[0].camera_pose);
    EXPECT_EQ(find_facts(scene).lights[0].place, LightPlace::at_eye);
    PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 160, 90);
    face_lights(points, scene);
    std::vector<VisibilityPlane> lit(1, VisibilityPlane(points.size()));
    lit[0].s.assign(points.size(), 1.0f);  // a light at the eye reaches every point that the eye sees
    const Image image = shade(scene, points, lit);
    double nearest = 0, farthest = 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        const Material& m    = scene.material(points.triangle[i]);
        const dvec3 way      = dvec3(scene.camera.eye) - dvec3(points.position(i));
        const double d       = glm::length(way);
        const double cosine  = std::max(0.0, glm::dot(shading_normal(scene, points, i), way / d));
        const Attenuation& a = scene.lights[0].attenuation;
        const double depth   = std::min(1.0, 1 / (static_cast<double>(a.c1) + static_cast<double>(a.c2) * d));
        const double diffuse = static_cast<double>(scene.lights[0].diffuse.r * m.k_d.r * m.O_d.r);
        EXPECT_NEAR(image.at(i, 0), static_cast<double>(scene.ambient.r * m.k_a.r * m.O_d.r) + depth * diffuse * cosine,
                    1e-5);
        nearest = std::max(nearest, depth), farthest = std::min(farthest, depth);
    }
    EXPECT_GT(nearest, 2 * farthest) << "the scene is deep enough to see it";
}

constexpr const char* kTable = R"("distribution": {"vertical": [0, 45, 90], "candela": [[100, 40, 0]]})";

/// 2 above one triangle; the other is at atan(5) from straight down, between 40 and 0 cd, at the distance sqrt(104).
TEST(Goniometric, FollowsItsTable) {
    const std::string light = std::string(R"("lights": [{"type": "point", "position": [0, 2, 0], )") + kTable;
    const Scene scene       = scene_with(light + "}]");
    EXPECT_NEAR(sum_at(scene, 0), 100 / 4.0, 1e-4);
    const double angle = glm::degrees(std::atan(5.0));
    EXPECT_NEAR(sum_at(scene, 1), 40 * (90 - angle) / 45 * (2 / std::sqrt(104.0)) / 104, 1e-6);
    // Aimed at the other one, and brought to one half.
    const Scene aimed = scene_with(light + R"(, "target": [10, 0, 0], "intensity": 0.5}])");
    EXPECT_NEAR(sum_at(aimed, 1), 0.5 * 100 * (2 / std::sqrt(104.0)) / 104, 1e-6);
    EXPECT_TRUE(find_facts(scene).has_goniometric);
}

/// Half planes from 0 to 180 degrees: `along` turns the table about the light's axis.
TEST(Goniometric, TurnsAboutItsAxis) {
    const auto lit = [](const char* along) {
        return sum_at(scene_with(fmt::format(
                          R"("lights": [{{"type": "point", "position": [0, 2, 0], "along": {}, "attenuation": [1, 0, 0],
                             "distribution": {{"vertical": [0, 90], "horizontal": [0, 90, 180],
                                               "candela": [[0, 900], [0, 90], [0, 0]]}}}}])",
                          along)),
                      1);
    };
    const double cosine = 2 / std::sqrt(104.0), down = glm::degrees(std::atan(5.0)) / 90;
    EXPECT_NEAR(lit("[1, 0, 0]"), 900 * down * cosine, 1e-3);
    EXPECT_NEAR(lit("[0, 0, 1]"), 90 * down * cosine, 1e-3);
    EXPECT_NEAR(lit("[0, 0, -1]"), 90 * down * cosine, 1e-3);
    EXPECT_NEAR(lit("[-1, 0, 0]"), 0, 1e-3);
    EXPECT_NEAR(lit("[1, 7, 0]"), 900 * down * cosine, 1e-3) << "only what is perpendicular to the axis counts";
}

TEST(Goniometric, SceneReadsItsFile) {
    const Scene scene = load_scene(std::string(UMBRA_SCENES) + "/goniometric.json");
    ASSERT_FALSE(scene.lights.empty());
    const Light& light = scene.lights[0];
    ASSERT_TRUE(light.photometry);
    EXPECT_EQ(light.photometry->horizontal.size(), 7u);
    EXPECT_FALSE(light.attenuation.clamp);
    EXPECT_EQ(light.attenuation.c3, 1);
    // Written and read again, the table is inline and the same.
    const TemporaryFolder folder;
    const Scene again = load_scene(folder.write("again.json", native_text(scene)));
    EXPECT_EQ(again.lights[0].photometry->candela, light.photometry->candela);
    EXPECT_EQ(native_text(again), native_text(scene));
}

TEST(Goniometric, FaultsAreNamed) {
    const std::string begin = R"("lights": [{"type": "point", "position": [0, 2, 0], )";
    expect_refused(begin + R"("ies": "nowhere.ies"}])", "the photometric file cannot be read");
    expect_refused(begin + R"("direction": [0, 1, 0]}])", "direction is of a point light with ies or distribution");
    expect_refused(begin + R"("ies": "a.ies", )" + kTable + "}]", "distribution");
    expect_refused(begin + kTable + R"(, "along": [0, 2, 0]}])", "along is parallel");
    expect_refused(begin + R"("distribution": {"vertical": [0, 90], "candela": [[1, 2], [3, 4]]}}])",
                   "candela has 2 lists");
    expect_refused(begin + R"("distribution": {"vertical": [0, 90], "candela": [[1]]}}])", "1 intensities");
    expect_refused(begin + R"("distribution": {"vertical": [0, 90], "candela": [[1, -2]]}}])", "an intensity of -2");
    expect_refused(begin + R"("distribution": {"type": "D", "vertical": [0], "candela": [[1]]}}])", "C, B, A");
}

/// Everything that this file's scenes may say, written and read again.
TEST(SceneLights, AreReadAndWritten) {
    const Scene scene = scene_with(
        std::string(R"("light_ambient": "attenuated", "specular_colour": "O_d", "ambient_coefficient": "k_d",
        "lights": [{"type": "point", "position": [0.1, 2, 0], "direction": [0.3, -1, 0], "along": [0, 0, 1], )") +
        kTable + R"(}, {"type": "spot", "position": [0, 0.1, 0], "direction": [0.1, 0, -0.7], "fixed_to": "camera",
                   "except": ["far"]}])");
    const TemporaryFolder folder;
    const Scene again = load_scene(folder.write("again.json", native_text(scene)));
    EXPECT_EQ(again.light_ambient, LightAmbient::attenuated);
    EXPECT_EQ(again.specular_colour, SpecularColour::O_d);
    EXPECT_EQ(again.ambient_coefficient, AmbientCoefficient::k_d);
    ASSERT_EQ(again.lights.size(), 2u);
    for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_EQ(again.lights[j].position, scene.lights[j].position);
        EXPECT_EQ(again.lights[j].direction, scene.lights[j].direction);
        EXPECT_EQ(again.lights[j].along, scene.lights[j].along);
        EXPECT_EQ(again.lights[j].except, scene.lights[j].except);
    }
    EXPECT_TRUE(again.lights[1].camera_pose);
    EXPECT_EQ(native_text(again), native_text(scene));
}

}  // namespace
}  // namespace umbra
