// Written scenes read back to the same bits.
#include "umbra/core/io/scene_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <random>

#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

Scene read_back(const Scene& scene) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "scene.json") << native_text(scene);
    return load_scene(folder.path() / "scene.json");
}

std::uint32_t bits(float x) { return std::bit_cast<std::uint32_t>(x); }
uvec3 bits(vec3 v) { return {bits(v.x), bits(v.y), bits(v.z)}; }

void expect_same_light(const Light& a, const Light& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(bits(a.position), bits(b.position)) << a.name;
    EXPECT_EQ(bits(a.direction), bits(b.direction)) << a.name;
    EXPECT_EQ(bits(a.edge_u), bits(b.edge_u));
    EXPECT_EQ(bits(a.edge_v), bits(b.edge_v));
    EXPECT_EQ(bits(a.radius), bits(b.radius));
    EXPECT_EQ(bits(a.range), bits(b.range));
    EXPECT_EQ(bits(a.ambient), bits(b.ambient));
    EXPECT_EQ(bits(a.diffuse), bits(b.diffuse));
    EXPECT_EQ(bits(a.specular), bits(b.specular));
    EXPECT_EQ(bits(a.attenuation.c1), bits(b.attenuation.c1));
    EXPECT_EQ(bits(a.attenuation.c2), bits(b.attenuation.c2));
    EXPECT_EQ(bits(a.attenuation.c3), bits(b.attenuation.c3));
    EXPECT_EQ(a.attenuation.clamp, b.attenuation.clamp);
    EXPECT_EQ(a.spot.falloff, b.spot.falloff);
    EXPECT_EQ(bits(a.spot.exponent), bits(b.spot.exponent));
    EXPECT_EQ(bits(a.spot.cutoff), bits(b.spot.cutoff)) << a.name;
    EXPECT_EQ(bits(a.spot.inner), bits(b.spot.inner)) << a.name;
    EXPECT_EQ(bits(a.along), bits(b.along));
    EXPECT_EQ(a.except, b.except);
    EXPECT_EQ(a.photometry != nullptr, b.photometry != nullptr);
    if (a.photometry && b.photometry) {
        EXPECT_EQ(a.photometry->candela, b.photometry->candela);
    }
    EXPECT_EQ(a.camera_pose.has_value(), b.camera_pose.has_value());
}

void expect_same_material(const Material& a, const Material& b) {
    EXPECT_EQ(bits(a.k_a), bits(b.k_a));
    EXPECT_EQ(bits(a.k_d), bits(b.k_d));
    EXPECT_EQ(bits(a.k_s), bits(b.k_s));
    EXPECT_EQ(bits(a.O_d), bits(b.O_d));
    EXPECT_EQ(bits(a.O_s), bits(b.O_s));
    EXPECT_EQ(bits(a.emission), bits(b.emission));
    EXPECT_EQ(bits(a.shininess), bits(b.shininess));
    EXPECT_EQ(a.lobe, b.lobe);
    EXPECT_EQ(a.two_sided, b.two_sided);
    EXPECT_EQ(a.cutout, b.cutout);
    EXPECT_EQ(bits(a.opacity), bits(b.opacity));
    EXPECT_EQ(bits(a.reflect), bits(b.reflect));
    EXPECT_EQ(bits(a.transmit), bits(b.transmit));
    EXPECT_EQ(bits(a.index_of_refraction), bits(b.index_of_refraction));
    EXPECT_EQ(bits(a.tangent), bits(b.tangent));
    EXPECT_EQ(a.lobes.size(), b.lobes.size());
}

void expect_same(const Scene& a, const Scene& b) {
    ASSERT_EQ(a.triangles.size(), b.triangles.size());
    for (TriangleId t = 0; t < a.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            ASSERT_EQ(bits(a.vertex(t, k)), bits(b.vertex(t, k))) << "triangle " << t;
            ASSERT_EQ(bits(a.normals[a.triangles[t][k]]), bits(b.normals[b.triangles[t][k]])) << "triangle " << t;
        }
    EXPECT_EQ(a.triangle_object, b.triangle_object);
    ASSERT_EQ(a.objects.size(), b.objects.size());
    for (std::size_t o = 0; o < a.objects.size(); ++o) {
        EXPECT_EQ(a.objects[o].name, b.objects[o].name);
        EXPECT_EQ(a.objects[o].first_triangle, b.objects[o].first_triangle);
        EXPECT_EQ(a.objects[o].triangle_count, b.objects[o].triangle_count);
        EXPECT_EQ(a.objects[o].switches, b.objects[o].switches);
        expect_same_material(a.materials[a.objects[o].material], b.materials[b.objects[o].material]);
    }
    ASSERT_EQ(a.lights.size(), b.lights.size());
    for (std::size_t j = 0; j < a.lights.size(); ++j) expect_same_light(a.lights[j], b.lights[j]);
    EXPECT_EQ(a.title, b.title);
    EXPECT_EQ(a.shows, b.shows);
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.camera.projection, b.camera.projection);
    EXPECT_EQ(bits(a.camera.eye), bits(b.camera.eye));
    EXPECT_EQ(bits(a.camera.target), bits(b.camera.target));
    EXPECT_EQ(bits(a.camera.up), bits(b.camera.up));
    EXPECT_EQ(bits(a.camera.projection == Projection::perspective ? a.camera.fov_y : a.camera.height),
              bits(b.camera.projection == Projection::perspective ? b.camera.fov_y : b.camera.height));
    EXPECT_EQ(bits(a.ambient), bits(b.ambient));
    EXPECT_EQ(bits(a.background), bits(b.background));
    EXPECT_EQ(a.tone, b.tone);
    EXPECT_EQ(bits(a.exposure), bits(b.exposure));
    EXPECT_EQ(a.local_viewer, b.local_viewer);
    EXPECT_EQ(a.light_ambient, b.light_ambient);
    EXPECT_EQ(a.specular_colour, b.specular_colour);
    EXPECT_EQ(a.ambient_coefficient, b.ambient_coefficient);
    EXPECT_EQ(a.transparent, b.transparent);
}

/// Floats of all magnitudes that scenes may have, and the awkward ones.
class Floats {
public:
    float any() {
        constexpr float awkward[] = {0.0f, -0.0f, 0.1f, 1.0f / 3, 1e18f, -1e18f, 0x1p-149f, 0x1.fffffep-127f, 16777216};
        const auto pick           = std::uniform_int_distribution<std::size_t>(0, 40)(random_);
        if (pick < std::size(awkward)) return awkward[pick];
        const float mantissa = std::uniform_real_distribution<float>(-1, 1)(random_);
        return std::ldexp(mantissa, std::uniform_int_distribution<int>(-60, 59)(random_));
    }
    float share() { return std::uniform_real_distribution<float>(0, 1)(random_); }
    vec3 vector() { return {any(), any(), any()}; }
    vec3 colour() { return {share(), share(), share()}; }
    vec3 unit() { return vec3(glm::normalize(dvec3(share() - 0.5f, share() - 0.5f, share() + 0.1f))); }

private:
    std::mt19937 random_{7};
};

TEST(SceneWriter, EveryFloatKeepsItsBits) {
    Floats floats;
    Scene scene;
    scene.title         = "quotes \" and \\ and \n, \u00e4";
    scene.shows         = "Nothing.";
    scene.width         = 31;
    scene.height        = 17;
    scene.tone          = ToneMap::hue;
    scene.exposure      = 0.3f;
    scene.local_viewer  = false;
    scene.ambient       = floats.colour();
    scene.background    = floats.colour();
    scene.camera.eye    = {0.1f, 1e-7f, 3};
    scene.camera.target = {1.0f / 3, 2, 1e9f};
    scene.camera.up     = {0.2f, 1, 0.7f};
    scene.camera.fov_y  = 0.00123f;
    for (int m = 0; m < 3; ++m) {
        Material material;
        material.name                = m == 2 ? "" : "the same";
        material.k_a                 = floats.colour();
        material.k_d                 = 0.5f * floats.colour();
        material.k_s                 = 0.5f * floats.colour();
        material.O_d                 = floats.colour();
        material.O_s                 = floats.colour();
        material.emission            = floats.colour();
        material.shininess           = 1e6f / 3;
        material.lobe                = m == 1 ? Lobe::blinn_phong : Lobe::phong;
        material.two_sided           = m != 1;
        material.cutout              = m == 1;
        material.opacity             = floats.share();
        material.reflect             = floats.share();
        material.transmit            = floats.share();
        material.index_of_refraction = 1.33f;
        scene.materials.push_back(material);
    }
    for (std::uint32_t o = 0; o < 3; ++o) {
        std::vector<vec3> positions, normals;
        std::vector<uvec3> triangles;
        for (std::uint32_t i = 0; i < 300; ++i) {
            positions.push_back(floats.vector());
            normals.push_back(o == 0 || i % 7 == 0 ? vec3(0) : floats.unit());
            if (i >= 2) triangles.push_back({i, i / 2, i - 2});
        }
        add_object(scene, "object", positions, normals, triangles, o);
        scene.objects[o].switches.*kObjectSwitches.at(o).is_on = false;
    }
    int n = 0;
    for (const LightKind kind : {LightKind::directional, LightKind::point, LightKind::spot, LightKind::rectangle,
                                 LightKind::disk, LightKind::sphere, LightKind::spot, LightKind::spot}) {
        Light light;
        light.name     = fmt::format("light_{}", ++n);
        light.kind     = kind;
        light.diffuse  = floats.colour();
        light.specular = floats.colour();
        light.ambient  = floats.colour();
        if (kind == LightKind::directional) light.direction = {0.7f, -0.1f, 1e-9f};
        if (kind == LightKind::spot || kind == LightKind::disk) light.direction = floats.unit();
        if (kind != LightKind::directional) {
            light.position    = floats.vector();
            light.range       = 1e3f / 7;
            light.attenuation = {floats.share(), floats.share(), floats.share(), n % 2 == 0};
        }
        if (kind == LightKind::spot)
            light.spot = {static_cast<SpotFalloff>(n % 3), 7 * floats.share(), 0.3f + floats.share(),
                          0.3f * floats.share()};
        if (kind == LightKind::disk || kind == LightKind::sphere) light.radius = 1e-12f / 3;
        if (kind == LightKind::rectangle) {
            light.edge_u    = {0.1f, 0, 0};
            light.edge_v    = {0, 0, 1.0f / 3};
            light.direction = {0, -1, 0};
        }
        scene.lights.push_back(light);
    }
    expect_same(scene, read_back(scene));

    scene.camera.projection = Projection::orthographic;
    scene.camera.height     = 1e-6f / 7;
    expect_same(scene, read_back(scene));
}

class WrittenScene : public testing::TestWithParam<std::string> {};

TEST_P(WrittenScene, IsTheSceneThatWasRead) {
    const Scene scene = load_scene(std::filesystem::path(UMBRA_SCENES) / (GetParam() + ".json"));
    expect_same(scene, read_back(scene));
}

INSTANTIATE_TEST_SUITE_P(All, WrittenScene,
                         testing::Values("eclipse", "faulty_meshes", "goniometric", "self_shadow", "six_lights",
                                         "spot_stage", "umbra_penumbra", "warnock"),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace umbra
