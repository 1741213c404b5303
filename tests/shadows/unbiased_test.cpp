// Sampling methods are correct on average: compared with closed forms and with `exact` by a test whose rate of false
// alarms is known. And the test itself: it keeps to that rate, and it sees biases of stated size.
#include "umbra/tests/support/unbiased.h"
#include "umbra/core/render/gbuffer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "umbra/bench/gate/golden_planes.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

constexpr int kSeeds = 64;

std::string described(const BiasTest& test) {
    return fmt::format("p {:.2g} over {} groups; the worst is off by {:.5f} where S = {:.2f}; standard error {:.5f}",
                       test.p, test.groups, test.bias, test.expected, test.resolution);
}

/// A rectangle light over a half-plane: the penumbra is known in closed form.
struct HalfPlane {
    KnownScene known         = known_scene("penumbra_of_half_plane");
    SceneFacts facts         = find_facts(known.scene);
    PointBatch points        = primary_points(RayScene(known.scene), known.scene, known.scene.camera, 240, 135);
    VisibilityPlane expected = by_formula(known, points, 0);

    BiasTest test(const std::function<VisibilityPlane(int)>& sample, int seeds = kSeeds) const {
        return bias_test(expected, seeds, sample);
    }
    std::function<VisibilityPlane(int)> planes(const std::string& choice = "ray_traced") const {
        return seeded_planes(parse_method(choice), known.scene, facts, points, 0);
    }
};

// ---- the gate -------------------------------------------------------------------------------------------------------

class EverySampler : public testing::TestWithParam<const char*> {};

TEST_P(EverySampler, IsUnbiasedAgainstTheClosedForm) {
    const HalfPlane scene;
    for (const int samples : {3, 16}) {
        const BiasTest test =
            scene.test(scene.planes(fmt::format("ray_traced:sampler={},samples={}", GetParam(), samples)));
        EXPECT_GT(test.groups, 10);
        EXPECT_GT(test.p, kFalseAlarm) << samples << " samples: " << described(test);
        EXPECT_LT(test.resolution, 0.008 / std::sqrt(samples)) << "or it says little";
    }
}

INSTANTIATE_TEST_SUITE_P(Unbiased, EverySampler, testing::Values("random", "stratified", "regular", "r2", "sobol"),
                         [](const auto& sampler) { return std::string(sampler.param); });

class EveryAreaLight : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(EveryAreaLight, IsSampledWithoutBias) {
    const PreparedScene prepared = prepare_scene(GetParam(), {96, 54});
    const Reference reference    = default_reference(prepared.facts);
    if (!reference.exact) GTEST_SKIP() << reference.note;
    const MethodRun exact = run_method(reference.choice, prepared.scene, prepared.facts, prepared.points);
    for (const MethodInfo* info : methods())
        for (LightId j = 0; j < prepared.scene.lights.size(); ++j) {
            const MethodChoice choice(*info);
            if (!is_sampled(choice, prepared.scene.lights[j])) continue;
            const BiasTest test = bias_test(exact.planes[j], kSeeds,
                                            seeded_planes(choice, prepared.scene, prepared.facts, prepared.points, j));
            EXPECT_GT(test.p, kFalseAlarm)
                << info->name << ", " << prepared.scene.lights[j].name << ": " << described(test);
        }
}

std::vector<std::filesystem::path> scenes_with_area_lights() {
    return {UMBRA_SCENES "/umbra_penumbra.json", UMBRA_SCENES "/light_sizes.json", UMBRA_SCENES "/eclipse.json"};
}
INSTANTIATE_TEST_SUITE_P(Unbiased, EveryAreaLight, testing::ValuesIn(scenes_with_area_lights()),
                         [](const auto& scene) { return scene.param.stem().string(); });

// ---- the gate keeps its rate, and can fail --------------------------------------------------------------------------

/// Noise of the size and kind that samples have, and no bias.
TEST(BiasTest, RaisesFalseAlarmsAtItsRate) {
    const HalfPlane scene;
    std::mt19937 random(7);
    const auto unbiased = [&](int) {
        VisibilityPlane plane = scene.expected;
        for (float& s : plane.s)
            s = static_cast<float>(std::binomial_distribution<int>(16, static_cast<double>(s))(random)) / 16;
        return plane;
    };
    int below = 0, tests = 200;
    double least = 1;
    for (int k = 0; k < tests; ++k) {
        const double p = scene.test(unbiased, 16).p;
        below += p < 0.1;
        least = std::min(least, p);
    }
    // One test in ten is expected below 0.1 at most, and Bonferroni loses little: 20 +- 4.2.
    EXPECT_LT(below, 20 + 5 * 4.3);
    EXPECT_GT(below, 20 - 4 * 4.3);
    EXPECT_GT(least, kFalseAlarm);
}

TEST(BiasTest, SeesAShiftOfAFewStandardErrors) {
    const HalfPlane scene;
    const auto planes     = scene.planes();
    const double error    = scene.test(planes).resolution;
    const auto shifted_by = [&](double bias) {
        return [&planes, bias](int seed) {
            VisibilityPlane plane = planes(seed);
            for (float& s : plane.s) s += static_cast<float>(bias);
            return plane;
        };
    };
    EXPECT_LT(error, 0.001);
    for (const double sign : {-1.0, 1.0}) {
        EXPECT_LT(scene.test(shifted_by(sign * 10 * error)).p, kFalseAlarm);
        EXPECT_GT(scene.test(shifted_by(sign * 0.5 * error)).p, kFalseAlarm);
    }
}

/// The mean over the whole penumbra is right then: it is symmetric about S = 1/2.
TEST(BiasTest, SeesALightThatIsSampledTooNarrow) {
    const HalfPlane scene;
    Scene narrow = scene.known.scene;
    narrow.lights[0].edge_u *= 0.96f;
    const BiasTest test = scene.test(seeded_planes(parse_method("ray_traced"), narrow, scene.facts, scene.points, 0));
    EXPECT_LT(test.p, kFalseAlarm) << described(test);
}

TEST(BiasTest, SeesALightThatIsElsewhere) {
    const HalfPlane scene;
    Scene moved = scene.known.scene;
    moved.lights[0].position.x += 0.01f;
    const BiasTest test = scene.test(seeded_planes(parse_method("ray_traced"), moved, scene.facts, scene.points, 0));
    EXPECT_LT(test.p, kFalseAlarm) << described(test);
}

TEST(BiasTest, SeesASampleThatIsForgotten) {
    const HalfPlane scene;
    const auto planes = scene.planes();
    const auto test   = scene.test([&](int seed) {
        VisibilityPlane plane = planes(seed);
        for (float& s : plane.s) s *= 63.0f / 64;
        return plane;
    });
    EXPECT_LT(test.p, kFalseAlarm) << described(test);
}

TEST(BiasTest, SeesASeedThatIsIgnored) {
    const HalfPlane scene;
    const VisibilityPlane always = scene.planes()(1);
    EXPECT_EQ(scene.test([&](int) { return VisibilityPlane(always); }).p, 0);
}

TEST(BiasTest, AllowsForTheReferencesDoubt) {
    const HalfPlane scene;
    VisibilityPlane off = scene.expected;
    for (float& s : off.s) s = std::clamp(s + 0.01f, 0.0f, 1.0f);
    EXPECT_LT(bias_test(off, kSeeds, scene.planes()).p, kFalseAlarm);
    off.half_width.assign(off.size(), 0.01f);
    EXPECT_GT(bias_test(off, kSeeds, scene.planes()).p, kFalseAlarm);
}

}  // namespace
}  // namespace umbra
