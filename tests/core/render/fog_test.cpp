// Fog: its laws, its place in the sum, and its form in scene files.
#include "umbra/core/scene/fog.h"

#include <gtest/gtest.h>

#include <cmath>

#include "umbra/bench/studies/light/shading_models.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/io/scene_writer.h"
#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

TEST(Fog, FollowsItsLaws) {
    Fog fog;
    EXPECT_EQ(fog_share(fog, 7), 1);
    fog.density = 0.25f;
    fog.law     = FogLaw::exponential;
    EXPECT_DOUBLE_EQ(fog_share(fog, 8), std::exp(-2.0));
    fog.law = FogLaw::exponential_squared;
    EXPECT_DOUBLE_EQ(fog_share(fog, 8), std::exp(-4.0));
    EXPECT_EQ(fog_share(fog, 0), 1);
    fog.law = FogLaw::linear, fog.start = 2, fog.end = 10, fog.near_share = 0.75f, fog.far_share = 0.25f;
    for (const auto& [distance, share] :
         {std::pair{0.0, 0.75}, {2.0, 0.75}, {6.0, 0.5}, {8.0, 0.375}, {10.0, 0.25}, {99.0, 0.25}})
        EXPECT_DOUBLE_EQ(fog_share(fog, distance), share) << distance;
}

/// A wall that glows, seen straight on from 4 away.
Scene glowing_wall(Projection projection) {
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].emission = vec3(1, 0.5f, 0);
    scene.materials[0].k_a      = vec3(0);
    add_object(scene, "wall", {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
    scene.camera.eye = {0, 0, 4}, scene.camera.target = {0, 0, 0}, scene.camera.fov_y = 90;
    scene.camera.projection = projection, scene.camera.height = 8;
    scene.width = 33, scene.height = 33;
    scene.fog.law = FogLaw::exponential, scene.fog.density = 0.1f, scene.fog.colour = vec3(0, 0.25f, 1);
    return scene;
}

Image picture(const Scene& scene, ShadingModel model = ShadingModel::phong) {
    const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, scene.width, scene.height);
    return shade_by(model, scene, points, [](const PointBatch&) { return std::vector<VisibilityPlane>{}; }).linear;
}

TEST(Fog, IsAsThickAsTheWayToTheEye) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
        for (const FogDistance distance : {FogDistance::radial, FogDistance::depth}) {
            Scene scene        = glowing_wall(projection);
            scene.fog.distance = distance;
            const Image image  = picture(scene);
            const bool radial  = distance == FogDistance::radial && projection == Projection::perspective;
            for (const int x : {0, 8, 16, 32}) {
                // Pixel centres are 8/33 apart on the wall.
                const double across = (x - 16) * 8.0 / 33, way = radial ? std::hypot(4, across) : 4;
                const double f = std::exp(-static_cast<double>(0.1f) * way);
                const auto i   = static_cast<std::size_t>(16 * 33 + x);
                EXPECT_NEAR(image.at(i, 0), f, 1e-6);
                EXPECT_NEAR(image.at(i, 1), f * 0.5 + (1 - f) * 0.25, 1e-6);
                EXPECT_NEAR(image.at(i, 2), 1 - f, 1e-6);
            }
        }
}

/// Gouraud shading has the fog of its vertices: thicker than that of the wall's middle.
TEST(Fog, OfVerticesIsNotThatOfPixels) {
    const Scene scene    = glowing_wall(Projection::perspective);
    const std::size_t at = 16 * 33 + 16;
    const double corner  = std::exp(-static_cast<double>(0.1f) * std::sqrt(4.0 * 4 + 9 * 9 + 9 * 9));
    EXPECT_NEAR(picture(scene, ShadingModel::gouraud).at(at, 0), corner, 1e-6);
    EXPECT_NEAR(picture(scene).at(at, 0), std::exp(-0.4), 1e-6);
}

/// f of the distance to the light is part of its f_att; a light at infinity is as bright as without fog.
TEST(Fog, DimsLightsWhereItSaysSo) {
    Scene scene                 = glowing_wall(Projection::perspective);
    scene.materials[0].emission = vec3(0);
    scene.materials[0].k_d      = vec3(1);
    scene.fog.colour            = vec3(0);
    Light lamp;
    lamp.position  = {0, 0, 6};
    scene.lights   = {lamp};
    const auto lit = [&] {
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, scene.width, scene.height);
        return double(shade_by(ShadingModel::phong, scene, points, [&](const PointBatch& asked) {
                          return lit_everywhere(scene, asked);
                      }).linear.at(16 * 33 + 16, 0));
    };
    const double clear = lit(), share = std::exp(-static_cast<double>(0.1f) * 6);
    EXPECT_GT(clear, 0.5);
    scene.fog.dims_lights = true;
    EXPECT_NEAR(lit(), clear * share, 1e-6);
    scene.lights[0].kind      = LightKind::directional;
    scene.lights[0].direction = {0, 0, -1};
    EXPECT_NEAR(lit(), clear, 1e-6);
}

TEST(Fog, IsReadAndWritten) {
    const TemporaryFolder folder;
    const auto read = [&](const std::string& fog) {
        return load_scene(folder.write(
            "scene.json", R"({"fog": )" + fog + R"(, "lights": [], "objects": [{"type": "box", "size": [1, 1, 1]}]})"));
    };
    Scene scene = read(
        R"({"law": "linear", "start": 2, "end": 9.5, "near": 0.9, "far": 0.1, "colour": [0.1, 0.2, 0.3], "distance": "depth"})");
    for (int round = 0; round < 2; ++round) {
        EXPECT_EQ(scene.fog.law, FogLaw::linear);
        EXPECT_EQ(scene.fog.distance, FogDistance::depth);
        EXPECT_EQ(scene.fog.colour, vec3(0.1f, 0.2f, 0.3f));
        EXPECT_EQ(scene.fog.start, 2);
        EXPECT_EQ(scene.fog.end, 9.5f);
        EXPECT_EQ(scene.fog.near_share, 0.9f);
        EXPECT_EQ(scene.fog.far_share, 0.1f);
        (void)folder.write("again.json", native_text(scene));
        scene = load_scene(folder.path() / "again.json");
    }
    scene = read(R"({"law": "exponential_squared", "density": 0.5, "dims_lights": true})");
    (void)folder.write("again.json", native_text(scene));
    scene = load_scene(folder.path() / "again.json");
    EXPECT_EQ(scene.fog.law, FogLaw::exponential_squared);
    EXPECT_EQ(scene.fog.density, 0.5f);
    EXPECT_TRUE(scene.fog.dims_lights);

    for (const auto& [fog, expected] : {std::pair{R"({})", "law"},
                                        {R"({"law": "thick"})", "exponential_squared"},
                                        {R"({"law": "exponential"})", "density"},
                                        {R"({"law": "exponential", "density": -1})", "density"},
                                        {R"({"law": "exponential", "density": 1, "end": 3})", "linear fog"},
                                        {R"({"law": "linear", "end": 3, "density": 1})", "exponential fog"},
                                        {R"({"law": "linear", "start": 3, "end": 3})", "beyond the start"},
                                        {R"({"law": "linear", "end": 3, "near": 2})", "near"}}) {
        try {
            (void)read(fog);
            ADD_FAILURE() << fog << " was read";
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find(expected), std::string::npos) << e.what();
        }
    }
}

}  // namespace
}  // namespace umbra
