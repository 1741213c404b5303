// What a command works on where its line leaves that open, and what a method may take: one rule for all commands.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "umbra/bench/lab/at_work.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/planted_method.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

TEST(ChosenScenes, HaveNamesAndFoldersThatDifferInMoreThanTheirCase) {
    const TemporaryFolder folder;
    const std::vector<fs::path> files{folder.path() / "a/X.json", folder.path() / "b/x.json",
                                      folder.path() / "c/y.json", folder.path() / "d/X.json",
                                      folder.path() / "e/x-2.json"};
    const std::vector<ChosenScene> scenes = chosen_scenes(files);
    ASSERT_EQ(scenes.size(), files.size());
    const std::vector<std::string> names{"X", "x-2", "y", "X-3", "x-2-2"};
    for (std::size_t k = 0; k < files.size(); ++k) {
        EXPECT_EQ(scenes[k].file, files[k]);
        EXPECT_EQ(scenes[k].name, names[k]);
        EXPECT_EQ(scenes[k].folder, names[k]);
    }
    const ChosenScene odd = chosen_scenes(std::vector<fs::path>{folder.path() / "what?.json"}).front();
    EXPECT_EQ(odd.name, "what?");
    EXPECT_EQ(odd.folder, "what_");
}

TEST(ChosenScenes, AreGivenOnceHoweverTheyAreSpelled) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("a/x.json", "{}");
    try {
        (void)chosen_scenes(std::vector<fs::path>{file, folder.path() / "a/../a/x.json"});
        FAIL();
    } catch (const UsageError& e) {
        EXPECT_NE(std::string(e.what()).find("is given twice, expected each scene once"), std::string::npos);
    }
}

std::set<std::string> names_of(const std::vector<MethodChoice>& methods) {
    std::set<std::string> names;
    for (const MethodChoice& choice : methods) names.emplace(choice.info->name);
    return names;
}

TEST(ChosenMethods, AreThoseThatAreNamed) {
    const std::vector<std::string> typed{"ray_traced:samples=4", "shadow_volumes"};
    const std::vector<MethodChoice> further{parse_method("brute_force")};
    const std::vector<MethodChoice> chosen = chosen_methods(typed, further, {});
    ASSERT_EQ(chosen.size(), 3u);
    EXPECT_EQ(chosen[0].text(), "ray_traced:samples=4");
    EXPECT_EQ(chosen[2].text(), "brute_force");
    EXPECT_THROW((void)chosen_methods(std::vector<std::string>{"crayon"}, {}, {}), UsageError);
}

/// alias_free runs where the list of canonical scenes names it, and brute_force where it is named alone.
TEST(ChosenMethods, RunByThemselvesOnEachOfTheScenes) {
    const TemporaryFolder folder;
    folder.write("canonical.txt", "# scenes\nfirst.json alias_free radiosity\nsecond.json alias_free\n");
    const fs::path first = folder.path() / "first.json", second = folder.path() / "second.json";
    const auto on = [](const std::vector<fs::path>& scenes) { return names_of(chosen_methods({}, {}, scenes)); };
    EXPECT_TRUE(on({first}).contains("radiosity"));
    EXPECT_TRUE(on({first, second}).contains("alias_free"));
    EXPECT_FALSE(on({first, second}).contains("radiosity"));
    EXPECT_FALSE(on({folder.path() / "own.json"}).contains("alias_free"));
    EXPECT_TRUE(on({folder.path() / "own.json"}).contains("shadow_zbuffer"));
    for (const std::string name : {"alias_free", "radiosity", "shadow_zbuffer"})
        EXPECT_TRUE(on({}).contains(name)) << name << ": reports show it";
    EXPECT_FALSE(on({}).contains("brute_force")) << "no report shows it";
}

/// A box over a floor under two lights, 24 x 16 pixels.
class Limited : public testing::Test {
protected:
    Limited() {
        planted_behaviour        = {};
        planted_behaviour.answer = [](LightId, std::size_t, std::size_t, int) { return PlantedAnswer{1}; };
    }
    ~Limited() override { planted_behaviour = {}; }
    [[nodiscard]] MethodRun run(const MethodChoice& choice, const Budget& budget,
                                std::optional<LightId>* at = nullptr) {
        return run_method(choice, prepared_.scene, prepared_.facts, prepared_.points, at, budget);
    }

    TemporaryFolder folder_;
    PreparedScene prepared_ =
        prepare_scene(folder_.write("box.json", R"({"camera": {"eye": [3, 4, 6], "target": [0, 0, 0]}, "size": [24, 16],
            "lights": [{"name": "one", "type": "directional", "direction": [0.1, -1, 0]},
                       {"name": "two", "type": "directional", "direction": [0, -1, 0.2]}],
            "objects": [{"name": "floor", "type": "plane", "size": [8, 8]},
                        {"name": "box", "type": "box", "size": [1, 1, 1], "transform": [{"translate": [0, 1.5, 0]}]}]})"),
                      {});
    MethodInfo planted_ = planted_method();
};

TEST_F(Limited, AMethodIsCutShortAtTheLightThatItsTimeEndsAt) {
    planted_behaviour.work = [](Phase phase, LightId) {
        if (phase == Phase::aim) std::this_thread::sleep_for(std::chrono::milliseconds(400));
    };
    std::optional<LightId> at;
    try {
        (void)run(MethodChoice(planted_), {.seconds = 0.6}, &at);
        FAIL();
    } catch (const CutShort& e) {
        const std::string message = e.what();
        EXPECT_TRUE(message.starts_with("cut short after ")) << message;
        EXPECT_NE(message.find("the budget is 0.6 s (--budget)"), std::string::npos) << message;
    }
    EXPECT_EQ(at, LightId{1}) << "400 ms for the first, and 800 for both";
    EXPECT_NO_THROW((void)run(MethodChoice(planted_), {.seconds = 60}));
    EXPECT_NO_THROW((void)run(MethodChoice(planted_), {}));
}

TEST_F(Limited, TheLimitIsLiftedForWhatIsAskedLater) {
    const MethodRun ran = run(MethodChoice(planted_), {.seconds = 60});
    ran.work->limit({.seconds = 1e-9});
    EXPECT_THROW((void)ran.work->ask(prepared_.points, 0), CutShort);
    ran.work->lift_limit();
    EXPECT_NO_THROW((void)ran.work->ask(prepared_.points, 0));
}

TEST_F(Limited, MemoryIsWhatTheValuesHold) {
    planted_behaviour.memory_bytes = std::size_t{5} << 20;
    try {
        (void)run(MethodChoice(planted_), {.bytes = 4 << 20});
        FAIL();
    } catch (const CutShort& e) {
        EXPECT_EQ(std::string(e.what()).find("cut short at "), 0u) << e.what();
        EXPECT_NE(std::string(e.what()).find("the budget is 4 MiB (--memory-budget)"), std::string::npos) << e.what();
    }
    EXPECT_NO_THROW((void)run(MethodChoice(planted_), {.bytes = 1 << 30}));
}

TEST_F(Limited, AnOutcomeHasTheErrorsOrTheFailure) {
    Truths truths(prepared_.scene, prepared_.facts, prepared_.points, {});
    Trial trial{
        .truth = [&](const MethodRun& ran) -> const MethodRun& { return truths.of(ran.work->method()).ran.run; }};
    const auto found = [&] {
        return outcome(MethodChoice(planted_), prepared_.scene, prepared_.facts, prepared_.points, trial);
    };
    const Outcome whole = found();
    EXPECT_FALSE(whole.failed);
    ASSERT_EQ(whole.explained.size(), 2u);
    const VisibilityError& error = whole.explained[0].error;
    EXPECT_GT(error.false_light.interior + error.false_light.edge, 0u) << "always lit, under a box";

    trial.then           = [](const Outcome&) { throw std::runtime_error("too late"); };
    const Outcome failed = found();
    ASSERT_TRUE(failed.failed);
    EXPECT_EQ(failed.failed->message, "too late");
    EXPECT_FALSE(failed.failed->cut);
    EXPECT_TRUE(failed.explained.empty());

    trial.then = [](const Outcome&) { throw InputError("a full disk"); };
    EXPECT_THROW((void)found(), InputError) << "that is no fault of the method";
    trial.then   = {};
    trial.budget = {.seconds = 1e-9};
    ASSERT_TRUE(found().failed);
    EXPECT_TRUE(found().failed->cut);
}

TEST_F(Limited, AReferenceThatNobodyNamesIsReplacedWhenItIsCutShort) {
    Truths truths(prepared_.scene, prepared_.facts, prepared_.points, {.budget = {.seconds = 1e-9}});
    const Truth& truth = truths.main();
    ASSERT_TRUE(truth.failed);
    EXPECT_TRUE(truth.failed->cut);
    EXPECT_FALSE(truth.reference.exact);
    EXPECT_EQ(truth.reference.choice.info->name, "ray_traced");
    EXPECT_EQ(&truths.main(), &truth) << "it is found once";

    Truths named(prepared_.scene, prepared_.facts, prepared_.points,
                 {.reference = "exact", .budget = {.seconds = 1e-9}});
    EXPECT_THROW((void)named.main(), CutShort);
}

/// A setting that follows another keeps what both have in common, and nothing else: the number of texels begins with
/// `aim`, the least share of a plane with `build`.
TEST(MethodAtWork, ASettingThatFollowsAnotherAnswersAsIfItCameFirst) {
    const PreparedScene p = prepare_scene(fs::path(UMBRA_SCENES) / "sun_on_plane.json", {48, 27});
    for (const auto& [from, to] : {std::pair{"shadow_zbuffer:resolution=512", "shadow_zbuffer:resolution=16"},
                                   std::pair{"planar_projection", "planar_projection:plane_share=1"}}) {
        MethodAtWork kept(parse_method(from), p.scene, p.facts), fresh(parse_method(to), p.scene, p.facts);
        const VisibilityPlane before = kept.ask(p.points, 0);
        kept.set(parse_method(to));
        const VisibilityPlane again = kept.ask(p.points, 0), first = fresh.ask(p.points, 0);
        EXPECT_TRUE(again.s == first.s && again.answer == first.answer) << to;
        EXPECT_FALSE(before.s == first.s && before.answer == first.answer) << to << " answers as " << from;
    }
}

}  // namespace
}  // namespace umbra
