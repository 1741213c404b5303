// exact looks once for the edges of many points that lie together: each point's answer is the one that it gets alone.
#include <gtest/gtest.h>

#include <random>

#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/adversarial_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

constexpr std::size_t kTile = 128;  ///< points of a batch without a raster that are looked at together

struct Compared {
    std::size_t points = 0, penumbra = 0, different = 0;
};

/// All points of `batch` at once, and each by itself.
void compare(MethodCase& exact, const PointBatch& batch, LightId light, Compared& compared) {
    const VisibilityPlane together = exact.visibility(batch, light);
    for (std::uint32_t i = 0; i < batch.size(); ++i) {
        if (batch.triangle[i] == kNoTriangle || !batch.asks(light, i)) continue;
        const VisibilityPlane alone = exact.visibility(pick(batch, std::span(&i, 1)), light);
        ++compared.points;
        compared.penumbra += alone.s[0] > 0 && alone.s[0] < 1;
        compared.different += together.s[i] != alone.s[0] || together.answer[i] != alone.answer[0] ||
                              together.half_width[i] != alone.half_width[0];
    }
}

/// Around each of the scene's points as many as a tile holds, on its triangle, at most `spread` of the triangle away.
PointBatch clusters(const AdversarialScene& made, float spread, std::mt19937& random) {
    std::uniform_real_distribution<float> offset(-spread, spread);
    PointBatch batch;
    batch.eye = made.points.eye;
    batch.resize(made.points.size() * kTile);
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const std::size_t at = i / kTile;
        const TriangleId t   = made.points.triangle[at];
        if (t != kNoTriangle)
            set_point(batch, i, made.scene, t, std::abs(made.points.u[at] + offset(random)),
                      std::abs(made.points.v[at] + offset(random)));
    }
    face_lights(batch, made.scene);
    return batch;
}

TEST(ExactGroups, AnswerAsEachPointAloneOnAdversarialScenes) {
    std::mt19937 random(5);
    Compared compared;
    for (std::uint64_t seed = 1; seed <= 36; ++seed) {
        const AdversarialScene made = adversarial_scene(seed, LightsWanted::area, 2, 3);
        MethodCase exact("exact", made.scene);
        for (LightId light = 0; light < made.scene.lights.size(); ++light) {
            exact.prepare(light);
            const float spread = seed % 3 == 0 ? 0.3f : seed % 3 == 1 ? 0.01f : 1e-5f;
            compare(exact, clusters(made, spread, random), light, compared);
        }
    }
    EXPECT_EQ(compared.different, 0u) << "of " << compared.points;
    EXPECT_GT(compared.points, 5000u);
    EXPECT_GT(compared.penumbra, 1000u);
}

/// Where coordinates are denormal floats, no rounding is small beside them.
TEST(ExactGroups, AnswerAsEachPointAloneInTinyScenes) {
    std::mt19937 random(6);
    Compared compared;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        AdversarialScene made = adversarial_scene(seed, LightsWanted::area, 2, 2);
        constexpr float scale = 0x1p-138f;
        for (vec3& p : made.scene.positions) p *= scale;
        for (Light& light : made.scene.lights)
            light.position *= scale, light.edge_u *= scale, light.edge_v *= scale, light.radius *= scale;
        MethodCase exact("exact", made.scene);
        for (LightId light = 0; light < made.scene.lights.size(); ++light) {
            exact.prepare(light);
            compare(exact, clusters(made, 0.01f, random), light, compared);
        }
    }
    EXPECT_EQ(compared.different, 0u) << "of " << compared.points;
    EXPECT_GT(compared.points, 100u);
}

TEST(ExactGroups, AnswerAsEachPointAloneInPictures) {
    for (const char* name : {"umbra_penumbra", "closed_room", "light_sizes", "eclipse"}) {
        Scene scene = load_scene(std::filesystem::path(UMBRA_SCENES) / (std::string(name) + ".json"));
        scene.width = 80, scene.height = 45;
        const PointBatch points = primary(scene);
        MethodCase exact("exact", scene);
        Compared compared;
        for (LightId light = 0; light < scene.lights.size(); ++light) {
            if (!is_area(scene.lights[light].kind)) continue;
            exact.prepare(light);
            compare(exact, points, light, compared);
        }
        EXPECT_GT(compared.penumbra, 100u) << name;
        EXPECT_EQ(compared.different, 0u) << name << ", of " << compared.points;
    }
}

}  // namespace
}  // namespace umbra
