// The sum at eight points at a time has the bits of the sum at one.
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <random>

#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/render/sum.h"

namespace umbra {
namespace {

/// S_j at random: 0, 1, anything between, not defined.
std::vector<VisibilityPlane> any_visibility(const Scene& scene, const PointBatch& points, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> share(0, 1);
    std::vector<VisibilityPlane> planes;
    for (std::size_t j = 0; j < scene.lights.size(); ++j) {
        VisibilityPlane& plane = planes.emplace_back(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            plane.s[i] = random() % 3 == 0 ? share(random) : static_cast<float>(random() % 2);
            if (random() % 20 == 0) plane.answer[i] = Answer::undefined;
        }
    }
    return planes;
}

struct Comparison {
    std::size_t points = 0, differ = 0;
    bool lanes = false;
};

/// The picture against the sum at one point after the other.
Comparison compare(const Scene& scene, int width, int height, unsigned seed = 1) {
    const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, width, height);
    const auto planes       = any_visibility(scene, points, seed);
    const PhongSum sum(scene, *points.raster);
    const Image image = shade(scene, points, planes);
    Image one         = image;
    Comparison found{0, 0, sum.has_lanes(planes)};
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle)
            write_light(one, i, scene.background);
        else
            write_light(one, i, sum.at(points, i, shading_normal(scene, points, i), planes));
        found.points += points.triangle[i] != kNoTriangle;
        for (std::size_t c = 0; c < 3; ++c)
            found.differ += std::bit_cast<std::uint32_t>(one.at(i, c)) != std::bit_cast<std::uint32_t>(image.at(i, c));
    }
    return found;
}

TEST(SumEight, CanonicalScenes) {
    std::size_t with_lanes = 0, without = 0, points = 0;
    for (const auto& file : std::filesystem::directory_iterator(UMBRA_SCENES)) {
        if (file.path().extension() != ".json") continue;
        Scene scene;
        try {
            scene = load_scene(file.path());
        } catch (const std::exception&) {
            continue;  // a mesh that was not fetched
        }
        const Comparison found = compare(scene, 163, 91);  // not a multiple of eight
        EXPECT_EQ(found.differ, 0u) << scene.name;
        points += found.points;
        ++(found.lanes ? with_lanes : without);
    }
    EXPECT_GT(with_lanes, 20u);
    EXPECT_GT(without, 1u);
    EXPECT_GT(points, 200000u);
}

/// Every kind of light and of material before the same points.
Scene everything(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1), both(-1, 1);
    const auto vector = [&] { return vec3(both(random), both(random), both(random)); };
    const auto colour = [&] { return vec3(unit(random), unit(random), unit(random)); };
    Scene scene;
    for (int m = 0; m < 4; ++m) {
        Material material;
        material.O_d = colour(), material.emission = 0.1f * colour();
        material.k_d = colour(), material.k_a = colour();
        material.k_s       = m == 0 ? vec3(0) : colour();
        material.lobe      = m % 2 == 0 ? Lobe::blinn_phong : Lobe::phong;
        material.shininess = m == 1 ? 0 : std::exp(6 * unit(random));
        material.two_sided = m != 3;
        scene.materials.push_back(material);
    }
    for (std::uint32_t o = 0; o < 12; ++o) {
        std::vector<vec3> positions, normals;
        std::vector<uvec3> triangles;
        for (std::uint32_t t = 0; t < 6; ++t) {
            const vec3 at = 2.0f * vector();
            for (int k = 0; k < 3; ++k) {
                positions.push_back(at + 0.8f * vector());
                normals.push_back(random() % 5 == 0 ? vec3(0) : glm::normalize(vector()));
            }
            triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
        }
        add_object(scene, "object" + std::to_string(o), positions, o % 3 == 0 ? std::vector<vec3>{} : normals,
                   triangles, o % 4);
    }
    for (const LightKind kind : {LightKind::point, LightKind::directional, LightKind::spot, LightKind::rectangle,
                                 LightKind::disk, LightKind::sphere}) {
        Light light;
        light.name      = std::string(to_string(kind));
        light.kind      = kind;
        light.position  = 3.0f * vector();
        light.direction = glm::normalize(-light.position);
        light.edge_u = {0.5f, 0, 0}, light.edge_v = {0, 0, 0.5f}, light.radius = 0.3f;
        light.diffuse = colour(), light.specular = random() % 3 == 0 ? vec3(0) : colour();
        light.ambient = 0.1f * colour();
        if (random() % 2 == 0) light.attenuation = {0.2f, 0.3f, 0.4f, random() % 2 == 0};
        if (random() % 2 == 0) light.range = 3;
        if (random() % 3 == 0) light.except = {"object1", "object5"};
        scene.lights.push_back(light);
    }
    scene.local_viewer  = random() % 3 != 0;
    scene.camera.eye    = {0, 1, 6};
    scene.camera.target = {0, 0, 0};
    if (random() % 4 == 0) scene.camera.projection = Projection::orthographic, scene.camera.height = 5;
    return scene;
}

TEST(SumEight, EveryLightAndMaterial) {
    for (unsigned seed = 1; seed <= 60; ++seed) {
        const Comparison found = compare(everything(seed), 61, 43, seed);
        EXPECT_EQ(found.differ, 0u) << seed;
        EXPECT_TRUE(found.lanes) << seed;
        EXPECT_GT(found.points, 200u) << seed;
    }
}

TEST(SumEight, LightsInThePointsThemselves) {
    Scene scene = everything(3);
    for (Light& light : scene.lights) light.position = scene.vertex(0, 0), light.attenuation = {0, 0, 1, false};
    EXPECT_EQ(compare(scene, 61, 43).differ, 0u);
    scene.camera.eye = scene.vertex(0, 0) + vec3(0, 1e-30f, 0);
    EXPECT_EQ(compare(scene, 61, 43).differ, 0u);
}

TEST(SumEight, LeavesOtherScenesToTheSumAtOnePoint) {
    const auto has_lanes = [](const Scene& scene, bool coloured = false) {
        CameraFrame camera;
        const std::vector<VisibilityPlane> planes(scene.lights.size(), VisibilityPlane(1, coloured));
        return PhongSum(scene, camera).has_lanes(planes);
    };
    const Scene scene = everything(1);
    EXPECT_TRUE(has_lanes(scene));
    EXPECT_FALSE(has_lanes(scene, true));
    Scene other   = scene;
    other.fog.law = FogLaw::linear;
    EXPECT_FALSE(has_lanes(other));
    other               = scene;
    other.light_ambient = LightAmbient::attenuated;
    EXPECT_FALSE(has_lanes(other));
    other = scene;
    other.materials[0].lobes.emplace_back();
    EXPECT_FALSE(has_lanes(other));
}

}  // namespace
}  // namespace umbra
