// Ladders: the rule by which a method breaks, and what every ladder promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/ladder_run.h"

namespace umbra {
namespace {

RungOutcome outcome_of(How how, std::uint64_t points, std::uint64_t wrong_shadow, std::uint64_t wrong_light,
                       std::uint64_t undefined = 0) {
    RungOutcome o;
    o.service               = {how, "planted"};
    o.points                = points;
    o.undefined             = undefined;
    o.false_shadow.interior = wrong_shadow;
    o.false_light.interior  = wrong_light;
    return o;
}

LadderRun run_of(std::vector<RungOutcome> outcomes) {
    LadderRun run;
    run.ladder = ladders()[0];
    run.methods.push_back(parse_method("ray_traced"));
    for (std::size_t r = 0; r < outcomes.size(); ++r) {
        Rung& rung = run.rungs.emplace_back();
        rung.value = std::pow(10.0, double(r));
        rung.outcomes.push_back(std::move(outcomes[r]));
    }
    return run;
}

TEST(BreakRule, WhoServesExactlyBreaksAtTheFirstWrongPoint) {
    const Climb c = climb(run_of({outcome_of(How::exactly, 10000, 0, 0), outcome_of(How::exactly, 10000, 0, 1)}), 0);
    EXPECT_EQ(c.breaks_at, 1u);
}

TEST(BreakRule, WhoServesApproximatelyBreaksAboveTheShareAndNotAtIt) {
    const auto at_share = static_cast<std::uint64_t>(10000 * kBreakingShare);
    EXPECT_FALSE(climb(run_of({outcome_of(How::approximately, 10000, at_share, 0)}), 0).breaks_at.has_value());
    // False shadows and false lights count together.
    EXPECT_EQ(climb(run_of({outcome_of(How::approximately, 10000, at_share, 1)}), 0).breaks_at, 0u);
}

TEST(BreakRule, OnlyTheFirstBreakCountsEvenIfItHealsAgain) {
    const Climb c = climb(run_of({outcome_of(How::approximately, 100, 0, 0), outcome_of(How::approximately, 100, 9, 0),
                                  outcome_of(How::approximately, 100, 0, 0)}),
                          0);
    EXPECT_EQ(c.breaks_at, 1u);
}

TEST(BreakRule, EdgeErrorsNeverBreak) {
    RungOutcome o       = outcome_of(How::exactly, 100, 0, 0);
    o.false_shadow.edge = 100;
    EXPECT_FALSE(climb(run_of({o}), 0).breaks_at.has_value());
}

TEST(BreakRule, NotServingIsAnAnswerAndNoBreak) {
    const Climb c = climb(run_of({outcome_of(How::exactly, 100, 0, 0), outcome_of(How::not_at_all, 0, 0, 0)}), 0);
    EXPECT_FALSE(c.breaks_at.has_value());
    EXPECT_EQ(c.not_served_from, 1u);
    EXPECT_EQ(c.why, "planted");
}

TEST(BreakRule, LeavingMostPointsOpenIsSilence) {
    const Climb c = climb(run_of({outcome_of(How::exactly, 100, 0, 0), outcome_of(How::exactly, 10, 0, 0, 90)}), 0);
    EXPECT_FALSE(c.breaks_at.has_value());
    EXPECT_EQ(c.silent_from, 1u);
}

TEST(BreakRule, AnExceptionIsABreakWithItsMessage) {
    RungOutcome o = outcome_of(How::approximately, 0, 0, 0);
    o.stopped     = "out of range";
    const Climb c = climb(run_of({o}), 0);
    EXPECT_EQ(c.breaks_at, 0u);
    EXPECT_EQ(c.why, "out of range");
}

TEST(BreakRule, WrongPointsAreCountedByHoldingPlanesAgainstTheTruth) {
    // On the harmless rung ray_traced is right; a truth that is turned over in the interior breaks it.
    RungStage stage          = set_stage(find_ladder("far_from_origin").scene(1));
    const MethodChoice rays  = parse_method("ray_traced");
    const RungOutcome before = outcome(stage, rays);
    EXPECT_EQ(before.interior(), 0u);
    EXPECT_GT(before.points, 1000u);
    for (float& s : stage.truth[0].s) s = 1 - s;
    const RungOutcome after = outcome(stage, rays);
    EXPECT_TRUE(after.broken());
    EXPECT_GT(after.false_light.interior, after.false_shadow.interior);  // most of the floor was lit
    EXPECT_EQ(after.kind, "false light");
}

class EveryLadder : public testing::TestWithParam<const Ladder*> {};

TEST_P(EveryLadder, HasItsWordsAndGeometricRungs) {
    const Ladder& ladder = *GetParam();
    EXPECT_FALSE(ladder.title.empty());
    EXPECT_FALSE(ladder.about.empty());
    EXPECT_EQ(&find_ladder(ladder.name), &ladder);
    ASSERT_GE(ladder.rungs.size(), 2u);
    const bool rises = ladder.rungs[1] > ladder.rungs[0];
    for (std::size_t r = 1; r < ladder.rungs.size(); ++r)
        EXPECT_EQ(ladder.rungs[r] > ladder.rungs[r - 1], rises) << "rung " << r;
}

TEST_P(EveryLadder, MakesTheSameScenesEachTime) {
    for (const double rung : GetParam()->rungs) {
        const Scene a = GetParam()->scene(rung), b = GetParam()->scene(rung);
        EXPECT_EQ(a.positions, b.positions);
        EXPECT_EQ(a.triangles, b.triangles);
        ASSERT_EQ(a.lights.size(), b.lights.size());
        for (const vec3& p : a.positions)
            for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(double(p[k])), kMaxCoordinate);
        EXPECT_FALSE(a.lights.empty());
        EXPECT_LE(a.width * a.height, 160 * 120) << "ladders are climbed in seconds";
    }
}

TEST_P(EveryLadder, ShowsLightAndShadowOnItsFirstRung) {
    const Ladder& ladder  = *GetParam();
    const Scene scene     = ladder.scene(ladder.rungs[0]);
    const RungStage stage = set_stage(scene);
    std::uint64_t lit = 0, dark = 0;
    for (LightId j = 0; j < scene.lights.size(); ++j)
        for (std::size_t i = 0; i < stage.points.size(); ++i) {
            if (stage.points.facing[j][i] < Facing::partly) continue;
            lit += stage.truth[j].s[i] > 0.9f;
            dark += stage.truth[j].s[i] < 0.1f;
        }
    EXPECT_GE(lit, 200u);
    if (ladder.wrong_sum == nullptr) {
        EXPECT_GE(dark, 100u);
    }
}

INSTANTIATE_TEST_SUITE_P(All, EveryLadder, testing::ValuesIn(ladders().begin(), ladders().end()),
                         [](const auto& tested) { return std::string(tested.param->name); });

}  // namespace
}  // namespace umbra
