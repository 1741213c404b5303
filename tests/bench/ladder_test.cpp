// Ladders: the rule by which a method breaks, and what every ladder promises.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>

#include "umbra/bench/cli/ladder_command.h"
#include "umbra/bench/ladders/ladder_break.h"
#include "umbra/bench/ladders/ladder_record.h"
#include "umbra/bench/ladders/ladder_run.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/json_schema.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

RungOutcome outcome_of(How how, std::uint64_t points, std::uint64_t wrong_shadow, std::uint64_t wrong_light,
                       std::uint64_t undefined = 0) {
    RungOutcome o;
    o.service               = {how, "planted"};
    o.points                = points;
    o.undefined             = undefined;
    o.false_shadow.interior = wrong_shadow;
    o.false_light.interior  = wrong_light;
    o.can_show              = {1000, 500, 500};
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

RungOutcome holding(std::uint64_t lit, std::uint64_t shadow) {
    RungOutcome o = outcome_of(How::approximately, 1000, 0, 0);
    o.can_show    = {1000, lit, shadow};
    return o;
}

TEST(BreakRule, HoldingWithTooFewPointsOfAKindIsNotJudged) {
    // 100 of a kind are needed, of 1000 points and of any fewer; above, 1 %.
    const Climb c = climb(run_of({holding(500, 500), holding(100, 100), holding(500, 99), holding(99, 500)}), 0);
    EXPECT_FALSE(c.breaks_at.has_value());
    EXPECT_EQ(c.not_judged_from, 2u);
    EXPECT_EQ(c.why, "99 interior shadow points of 1000 compared, at least 100 are needed");
    EXPECT_FALSE(climb(run_of({holding(500, 99), holding(100, 100)}), 0).not_judged_from.has_value());
    EXPECT_TRUE((InteriorPoints{50000, 500, 500}.enough()));
    EXPECT_FALSE((InteriorPoints{50001, 500, 501}.enough()));
    EXPECT_EQ((InteriorPoints{50001, 500, 501}.lacking()),
              "500 interior lit points of 50001 compared, at least 501 are needed");
    EXPECT_EQ((InteriorPoints{50000, 500, 500}.lacking()), "");
}

TEST(BreakRule, ABreakCountsWhateverElseIsInThePicture) {
    RungOutcome o = outcome_of(How::approximately, 1000, 9, 0);
    o.can_show    = {1000, 1000, 0};
    const Climb c = climb(run_of({o, holding(500, 0)}), 0);
    EXPECT_EQ(c.breaks_at, 0u);
    EXPECT_FALSE(c.not_judged_from.has_value());
}

TEST(BreakRule, ARungThatIsNotJudgedDoesNotEndTheLadder) {
    LadderRun run         = run_of({outcome_of(How::exactly, 100, 0, 0), {}, outcome_of(How::exactly, 100, 0, 1)});
    run.rungs[1].unjudged = "no shadow";
    run.rungs[1].outcomes.clear();
    EXPECT_EQ(climb(run, 0).breaks_at, 2u);
    const LadderRecord ladder = ladder_record(run);
    EXPECT_EQ(climb_in_words(ladder.methods[0], ladder), "100 ");
    EXPECT_EQ(ladder.methods[0].rungs.size(), 2u);
    EXPECT_EQ(ladder.rungs.size(), 3u);
    run.rungs[2] = run.rungs[1];
    EXPECT_EQ(climb(run, 0).not_judged_from, 1u);
    EXPECT_EQ(climb(run, 0).why, "no shadow");
    const LadderRecord cut = ladder_record(run);
    EXPECT_EQ(climb_in_words(cut.methods[0], cut), "not judged from 10");
}

TEST(InteriorPoints, AreThoseAtWhichAConstantAnswerIsWrong) {
    const std::unique_ptr<RungStage> stage = set_stage(find_ladder("far_from_origin").scene(1));
    const VisibilityPlane& truth           = stage->truth.planes[0];
    const InteriorPoints all               = interior_points(stage->scene, stage->points, 0, truth, truth);
    const auto band                        = edge_band(stage->points, 0, truth, 0.5f);
    InteriorPoints expected;
    for (std::size_t i = 0; i < stage->points.size(); ++i) {
        if (!stage->points.asks(0, i) || !truth.defined(i)) continue;
        ++expected.compared;
        if (band[i] == 0) ++(truth.s[i] == 1 ? expected.lit : expected.shadow);
    }
    EXPECT_EQ(all.compared, expected.compared);
    EXPECT_EQ(all.lit, expected.lit);
    EXPECT_EQ(all.shadow, expected.shadow);
    EXPECT_GT(all.shadow, 500u);
    // What a method leaves undefined shows nothing about it.
    VisibilityPlane lit_only = truth;
    for (std::size_t i = 0; i < lit_only.s.size(); ++i)
        if (stage->points.asks(0, i) && lit_only.s[i] == 0) lit_only.answer[i] = Answer::undefined;
    const InteriorPoints answered = interior_points(stage->scene, stage->points, 0, truth, lit_only);
    EXPECT_EQ(answered.lit, all.lit);
    EXPECT_EQ(answered.shadow, 0u);
}

TEST(BreakRule, AnExceptionIsABreakWithItsMessage) {
    RungOutcome o = outcome_of(How::approximately, 0, 0, 0);
    o.stopped     = "out of range";
    const Climb c = climb(run_of({o}), 0);
    EXPECT_EQ(c.breaks_at, 0u);
    EXPECT_EQ(c.why, "out of range");
}

TEST(BreakRule, AMethodThatTakesTooLongIsNotAskedAgain) {
    Ladder two = find_ladder("gap");
    two.rungs.resize(3);
    const LadderRun run = climb_ladder(two, {parse_method("ray_traced")}, {}, 0);
    ASSERT_EQ(run.rungs.size(), 3u);
    EXPECT_TRUE(run.rungs[0].outcomes[0].ran());
    const Climb c = climb(run, 0);
    EXPECT_EQ(c.not_served_from, 1u);
    EXPECT_NE(c.why.find("s of a thread's processor time on rung 0.1, and 0 s are allowed"), std::string::npos)
        << c.why;
    EXPECT_FALSE(climb(climb_ladder(two, {parse_method("ray_traced")}), 0).not_served_from.has_value());
}

TEST(BreakRule, WrongPointsAreCountedByHoldingPlanesAgainstTheTruth) {
    // On the harmless rung ray_traced is right; a truth that is turned over in the interior breaks it.
    const std::unique_ptr<RungStage> stage = set_stage(find_ladder("far_from_origin").scene(1));
    const MethodChoice rays                = parse_method("ray_traced");
    const RungOutcome before               = outcome(*stage, rays);
    EXPECT_EQ(before.interior(), 0u);
    EXPECT_GT(before.points, 1000u);
    for (float& s : stage->truth.planes[0].s) s = 1 - s;
    const RungOutcome after = outcome(*stage, rays);
    EXPECT_TRUE(after.broken());
    EXPECT_GT(after.false_light.interior, after.false_shadow.interior);  // most of the floor was lit
    EXPECT_EQ(after.kind, "false light");  // exact can name nothing that blocks what is lit
}

TEST(MinimalScene, KeepsWhatTheDefectNeedsAndDropsTheRest) {
    const Scene whole = find_ladder("far_from_origin").scene(1);
    // The defect: the tetrahedron's first triangle is there, and so is any of the box.
    const vec3 apex  = whole.vertex(whole.objects[2].first_triangle, 0);
    const auto still = [&](const Scene& s) {
        bool tip = false, box = false;
        for (TriangleId t = 0; t < s.triangles.size(); ++t) {
            const std::string& name = s.objects[s.triangle_object[t]].name;
            tip                     = tip || (name == "tetrahedron" && s.vertex(t, 0) == apex);
            box                     = box || name == "box";
        }
        return tip && box;
    };
    ASSERT_TRUE(still(whole));
    const Scene part = minimal_scene(whole, still, 1000);
    EXPECT_TRUE(still(part));
    EXPECT_EQ(part.triangles.size(), 2u);
    EXPECT_EQ(part.objects.size(), 2u);
    EXPECT_EQ(part.positions.size(), 6u);
    EXPECT_LE(minimal_scene(whole, still, 3).triangles.size(), whole.triangles.size());
    EXPECT_TRUE(still(minimal_scene(whole, still, 3)));
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

class LadderCommand : public testing::Test {
protected:
    LadderCommand() {
        options_.out     = folder_.path() / "out";
        options_.command = "umbra ladder";
        // Bias breaks here whatever becomes of the methods: a shadow map cannot tell a gap of a millionth.
        options_.names   = {"grazing_sun", "tiny_scene"};
        options_.methods = {"shadow_zbuffer:resolution=64", "ray_traced"};
    }
    TemporaryFolder folder_;
    LadderOptions options_;
};

TEST_F(LadderCommand, WritesWhatItsSchemaSaysAndScenesThatBreakAgain) {
    const LaddersRecord record = climb_ladders(options_);
    EXPECT_TRUE(fits(schema_of<LaddersRecord>("").dump(), text_of(options_.out / "results.json")));

    int breaks = 0;
    for (const LadderRecord& ladder : record.ladders)
        for (const ClimbRecord& method : ladder.methods) {
            EXPECT_EQ(method.rungs.size(), ladder.rungs.size());
            EXPECT_EQ(method.shown.has_value(), method.breaks_at.has_value());
            if (!method.shown) continue;
            ++breaks;
            const BreakRecord& b = *method.shown;
            for (const std::string& file : {b.scene, b.visibility, b.truth, b.classes})
                EXPECT_TRUE(fs::exists(options_.out / "breaks" / file)) << file;
            const Scene scene = load_scene(options_.out / "breaks" / b.scene);
            EXPECT_LE(scene.triangles.size(), b.triangles_before);
            const RungOutcome again = outcome(*set_stage(scene), parse_method(method.text));
            EXPECT_TRUE(again.broken()) << b.scene;
            EXPECT_EQ(again.interior(), b.interior) << b.scene;
            EXPECT_EQ(again.kind, method.kind);
        }
    EXPECT_GE(breaks, 1);

    const std::string page = text_of(options_.out / "index.html");
    EXPECT_NE(page.find("Grazing light"), std::string::npos);
    EXPECT_NE(page.find("breaks/grazing_sun.shadow_zbuffer.classes.png"), std::string::npos);
    EXPECT_EQ(page.find("{{"), std::string::npos);
    EXPECT_EQ(page.find("://"), std::string::npos) << "the page names a host";
    EXPECT_NE(ladder_table(record.ladders).find("grazing_sun"), std::string::npos);
}

TEST_F(LadderCommand, SchemaRefusesWhatItShould) {
    options_.names     = {"tiny_scene"};
    const Json good    = to_record(climb_ladders(options_));
    const auto accepts = [schema = schema_of<LaddersRecord>("").dump()](const Json& record) {
        return fits(schema, record.dump());
    };
    EXPECT_TRUE(accepts(good));
    Json bad                             = good;
    bad["ladders"][0]["rungs"][0]["lit"] = -1;
    EXPECT_FALSE(accepts(bad));
    bad                                     = good;
    bad["ladders"][0]["methods"][0]["kind"] = "gremlins";
    EXPECT_FALSE(accepts(bad));
    bad = good;
    bad["ladders"][0]["methods"][0].erase("breaks_at");
    EXPECT_FALSE(accepts(bad));
}

TEST_F(LadderCommand, ReplacesItsOwnResultsAndNothingElse) {
    options_.names = {"tiny_scene"};
    (void)climb_ladders(options_);
    std::ofstream(options_.out / "breaks/stale.json") << "{}";
    EXPECT_THROW((void)climb_ladders(options_), InputError);
    EXPECT_TRUE(fs::exists(options_.out / "breaks/stale.json")) << "no record names it: it is somebody's";
    fs::remove(options_.out / "breaks/stale.json");

    // What an older version wrote is ours, too.
    auto old      = nlohmann::json::parse(text_of(options_.out / "results.json"));
    old["schema"] = 1;
    std::ofstream(options_.out / "results.json") << old;
    (void)climb_ladders(options_);
    EXPECT_EQ(nlohmann::json::parse(text_of(options_.out / "results.json"))["schema"], 2);
    (void)climb_ladders(options_);

    for (const auto& [name, text] :
         {std::pair{"results.json", R"({"schema": 2, "methods": []})"}, {"notes.txt", "mine"}}) {
        fs::remove_all(options_.out);
        fs::create_directories(options_.out);
        std::ofstream(options_.out / name) << text;
        EXPECT_THROW((void)climb_ladders(options_), InputError) << name;
        EXPECT_EQ(text_of(options_.out / name), text);
    }
}

TEST_F(LadderCommand, NamesTheLaddersThatThereAre) {
    options_.names = {"no_such_ladder"};
    try {
        (void)climb_ladders(options_);
        FAIL();
    } catch (const UsageError& e) {
        EXPECT_NE(std::string(e.what()).find("tiny_scene"), std::string::npos);
    }
    EXPECT_FALSE(fs::exists(options_.out));
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
    const Ladder& ladder                   = *GetParam();
    const Scene scene                      = ladder.scene(ladder.rungs[0]);
    const std::unique_ptr<RungStage> stage = set_stage(scene);
    std::uint64_t lit = 0, dark = 0;
    for (LightId j = 0; j < scene.lights.size(); ++j)
        for (std::size_t i = 0; i < stage->points.size(); ++i) {
            if (stage->points.facing[j][i] < Facing::partly) continue;
            lit += stage->truth.planes[j].s[i] > 0.9f;
            dark += stage->truth.planes[j].s[i] < 0.1f;
        }
    EXPECT_GE(lit, 200u);
    if (ladder.wrong_sum == nullptr) {
        EXPECT_GE(dark, 100u);
    }
}

/// The ladder up to the rung that would take long: what is beyond is left to `umbra ladder`.
Ladder shortened(const Ladder& whole) {
    constexpr std::size_t kMostWork = 2000;  // triangles times lights
    Ladder ladder                   = whole;
    std::size_t rungs               = 0;
    for (; rungs < whole.rungs.size(); ++rungs) {
        const Scene scene = whole.scene(whole.rungs[rungs]);
        if (scene.triangles.size() * scene.lights.size() > kMostWork) break;
    }
    ladder.rungs.resize(std::max<std::size_t>(1, rungs));
    return ladder;
}

/// Lines of tests/data/ladders.txt by "LADDER METHOD"; whether the method has any line at all.
struct Recorded {
    std::map<std::string, std::string> lines;
    [[nodiscard]] bool knows(std::string_view method) const {
        return std::ranges::any_of(lines,
                                   [&](const auto& line) { return line.first.ends_with(fmt::format(" {}", method)); });
    }
};

Recorded read_recorded() {
    Recorded recorded;
    std::ifstream in(UMBRA_TEST_DATA "/ladders.txt");
    for (std::string line; std::getline(in, line);) recorded.lines[line.substr(0, line.find(':'))] = line;
    return recorded;
}

/// Those that run on every scene and those that have a record, or the one that UMBRA_METHOD names
/// (./umbra test --method NAME).
std::vector<MethodChoice> judged_methods() {
    const char* only        = std::getenv("UMBRA_METHOD");
    const Recorded recorded = read_recorded();
    std::vector<MethodChoice> choices;
    for (const MethodInfo* info : methods())
        if (only != nullptr ? info->name == only : !info->reference && (info->by_default || recorded.knows(info->name)))
            choices.emplace_back(*info);
    return choices;
}

/// One answer for every point. It claims least, so that it may be wrong at kBreakingShare of the points.
template <int answer>
class Constant final : public Method {
public:
    explicit Constant(const Settings&) {}
    [[nodiscard]] Service serves(const SceneFacts&) const override { return {How::approximately, "planted"}; }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        for (std::size_t i = 0; i < looked.points.size(); ++i)
            if (looked.points.asks(aimed.light, i)) out.s[i] = answer;
    }
};
const MethodInfo kAlwaysLit{
    .name = "always_lit", .title = "Always lit", .paper = "", .summary = "", .create = create<Constant<1>>};
const MethodInfo kAlwaysDark{
    .name = "always_dark", .title = "Always dark", .paper = "", .summary = "", .create = create<Constant<0>>};

/// Takes the two planted methods out of a climb again, and expects that no rung was judged on which one of them holds.
void expect_planted_breaks(LadderRun& run) {
    run.methods.resize(run.methods.size() - 2, MethodChoice(kAlwaysLit));
    std::size_t judged = 0;
    for (Rung& rung : run.rungs) {
        if (!rung.unjudged.empty()) continue;
        ++judged;
        for (const bool lit : {true, false}) {
            const RungOutcome& o = rung.outcomes[run.methods.size() + (lit ? 0 : 1)];
            EXPECT_TRUE(o.broken()) << (lit ? "always lit" : "always dark") << " holds at " << rung.value;
        }
        rung.outcomes.resize(run.methods.size());
    }
    EXPECT_TRUE(run.rungs[0].unjudged.empty()) << run.rungs[0].unjudged;
    // Where a scene comes apart in its coordinates there is nothing to judge; the ladder ends soon after.
    EXPECT_GE(judged + 2, run.rungs.size());
}

/// tests/data/ladders.txt holds where every method breaks: a change for the better is to be seen as well as one for the
/// worse. A method without any line is skipped, and the test says how to record it. To record all of them:
///     rm tests/data/ladders.txt
///     UMBRA_RECORD_LADDERS=$PWD/tests/data/ladders.txt .build/release/tests/ladder_test --gtest_filter='*BreaksWhere*'
TEST_P(EveryLadder, BreaksWhereItIsRecordedAndNeverWhoServesExactly) {
    const Ladder whole                 = shortened(*GetParam());
    std::vector<MethodChoice> climbing = judged_methods();
    climbing.emplace_back(kAlwaysLit);
    climbing.emplace_back(kAlwaysDark);
    LadderRun run = climb_ladder(whole, climbing);
    if (whole.wrong_sum == nullptr) expect_planted_breaks(run);
    for (const Rung& rung : run.rungs)
        for (std::size_t m = 0; m < rung.outcomes.size(); ++m) {
            const RungOutcome& o  = rung.outcomes[m];
            const std::string who = run.methods.empty() ? "the sum" : run.methods[m].text();
            EXPECT_EQ(o.stopped, "") << who << " at " << rung.value;
            if (o.service.how == How::exactly) {
                EXPECT_EQ(o.interior(), 0u) << who << " at " << rung.value << " says exactly: " << o.service.why;
            }
        }

    const LadderRecord ladder = ladder_record(run);
    const Recorded recorded   = read_recorded();
    const char* recording     = std::getenv("UMBRA_RECORD_LADDERS");
    if (recording == nullptr) {
        ASSERT_GT(recorded.lines.size(), 100u);
    }
    std::string missing;
    for (const ClimbRecord& method : ladder.methods) {
        const std::string& name = method.name;
        const auto key          = fmt::format("{} {}", GetParam()->name, name);
        const auto found        = fmt::format("{}: {}", key, climb_in_words(method, ladder));
        if (recording != nullptr)
            std::ofstream(recording, std::ios::app) << found << '\n';
        else if (!recorded.knows(name))
            missing += fmt::format(
                "\n{}\n{} has no line in tests/data/ladders.txt; to record it: "
                "UMBRA_RECORD_LADDERS=tests/data/ladders.txt ./umbra test --method {}",
                found, name, name);
        else
            EXPECT_EQ(found, recorded.lines.contains(key) ? recorded.lines.at(key) : "no line");
    }
    if (!missing.empty()) GTEST_SKIP() << missing;
}

INSTANTIATE_TEST_SUITE_P(All, EveryLadder, testing::ValuesIn(ladders().begin(), ladders().end()),
                         [](const auto& tested) { return std::string(tested.param->name); });

}  // namespace
}  // namespace umbra
