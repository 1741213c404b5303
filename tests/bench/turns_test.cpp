// Times in turns, with a method and a clock that the test holds: who ran when, on which build, and who is recorded
// with which time.
#include "umbra/bench/lab/turns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include "umbra/core/render/gbuffer.h"

namespace umbra {
namespace {

struct FakeOptions {
    int tree = 1, map = 1, grid = 0, samples = 1;
};

/// One call of a phase: on which build, with which settings.
struct Call {
    Phase phase;
    int build;
    FakeOptions options;
    LightId light = 0;
};

struct Fake {
    double now = 0;
    std::vector<Call> calls;
    int builds = 0;
    std::function<void(const Call&)> extra;  ///< may move the clock further, or throw
    bool serves = true;
};
Fake fake;

/// What is outside the clock.
constexpr double kOutside = 1e6;

/// Values end outside the clock.
struct FakeBuilt final : Built {
    using Built::Built;
    ~FakeBuilt() override { fake.now += kOutside; }
    int number = fake.builds++;
};
struct FakeAimed final : Aimed {
    FakeAimed(const Built& from, LightId at, std::size_t size) : Aimed(from, at), bytes(size) {}
    ~FakeAimed() override { fake.now += kOutside; }
    [[nodiscard]] std::size_t memory_bytes() const override { return bytes; }
    std::size_t bytes;
};
struct FakeLooked final : Looked {
    using Looked::Looked;
    ~FakeLooked() override { fake.now += kOutside; }
};

/// Takes 100 `tree` to build, 10 `map` to aim, 20 `grid` to look, `samples` for visibility; the second light twice that
/// of aim and visibility.
class FakeMethod final : public MethodWith<FakeOptions> {
public:
    explicit FakeMethod(const Settings& settings) : MethodWith(settings) { fake.now += kOutside; }
    [[nodiscard]] Service serves(const SceneFacts&) const override {
        return {fake.serves ? How::approximately : How::not_at_all, "as the test says"};
    }
    void warm_up(const Scene&, const SceneFacts&) const override { fake.now += kOutside; }
    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        auto built = std::make_unique<FakeBuilt>(scene, facts);
        spend({Phase::build, built->number, options}, 100 * options.tree);
        return built;
    }
    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        spend({Phase::aim, as<FakeBuilt>(built).number, options, light}, 10.0 * options.map * (1 + light));
        return std::make_unique<FakeAimed>(built, light, 1000u * static_cast<unsigned>(options.map));
    }
    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override {
        spend({Phase::look, as<FakeBuilt>(built).number, options}, 20.0 * options.grid);
        return std::make_unique<FakeLooked>(points);
    }
    void visibility(const Aimed& aimed, const Looked&, Visibility out) const override {
        for (const float s : out.s) ASSERT_EQ(s, 0) << "the plane is not cleared";
        for (float& s : out.s) s = 1;
        const LightId light = aimed.light;
        spend({Phase::visibility, as<FakeBuilt>(aimed.built).number, options, light},
              1.0 * options.samples * (1 + light));
    }

private:
    static void spend(const Call& call, double ms) {
        fake.now += ms;
        fake.calls.push_back(call);
        if (fake.extra) fake.extra(call);
    }
};

MethodInfo fake_method(std::string_view name) {
    MethodInfo info;
    info.name       = name;
    info.parameters = {
        parameter<&FakeOptions::tree>("tree", "A number.", {.phase = Phase::build, .min = 0, .max = 1000}),
        parameter<&FakeOptions::map>("map", "A number.", {.phase = Phase::aim, .min = 0, .max = 1000}),
        parameter<&FakeOptions::grid>("grid", "A number.", {.phase = Phase::look, .min = 0, .max = 1000}),
        parameter<&FakeOptions::samples>("samples", "A number.", {.min = 0, .max = 1000})};
    info.create = create<FakeMethod>;
    return info;
}

class TurnsTest : public testing::Test {
protected:
    void SetUp() override {
        fake                       = {};
        Scene& scene               = prepared_.scene;
        const std::vector<vec3> at = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 0}};
        scene.materials.emplace_back();
        add_object(scene, "floor", at, {}, {{0, 1, 2}}, 0);
        scene.camera.eye = {0, 3, 0.1f};
        scene.lights.resize(2);
        for (Light& light : scene.lights) light.position = {0, 5, 0};
        prepared_.facts           = find_facts(scene);
        prepared_.points          = primary_points(RayScene(scene), scene, scene.camera, 4, 2);
        options_.clock            = [] { return fake.now; };
        options_.budget_ms        = 1e12;
        options_.calibration_loop = [] { fake.now += 20; };
    }

    [[nodiscard]] static MethodChoice choice(const MethodInfo& info, int tree, int map, int samples, int grid = 0) {
        MethodChoice c(info);
        c.settings.set("tree", tree);
        c.settings.set("map", map);
        c.settings.set("samples", samples);
        c.settings.set("grid", grid);
        return c;
    }

    PreparedScene prepared_;
    TurnOptions options_;
    const MethodInfo a_ = fake_method("a"), b_ = fake_method("b");
};

/// What a choice's phases take by the fake's definition, over both lights.
double build_ms(const MethodChoice& c) { return 100 * c.settings.value("tree"); }
double aim_ms(const MethodChoice& c) { return 30 * c.settings.value("map"); }
double look_ms(const MethodChoice& c) { return 20 * c.settings.value("grid"); }
double visibility_ms(const MethodChoice& c) { return 3 * c.settings.value("samples"); }

/// A setting that is slow is so under its own name, whatever the order; neighbours keep their times.
TEST_F(TurnsTest, EachTimeIsRecordedUnderItsOwnSetting) {
    std::vector<MethodChoice> choices;
    for (int k = 0; k < 12; ++k) choices.push_back(choice(k % 2 ? a_ : b_, 1 + k / 4, 1 + k % 5, 1 + 7 * k, k % 3));
    options_.rounds   = 5;
    const Turns turns = time_in_turns(prepared_, choices, options_);
    ASSERT_EQ(turns.settings.size(), choices.size());
    for (std::size_t k = 0; k < choices.size(); ++k) {
        const TurnTimes& t    = turns.settings[k];
        const MethodChoice& c = choices[k];
        EXPECT_EQ(t.choice.text(), c.text());
        const std::vector<double> build(5, build_ms(c)), aim(5, aim_ms(c)), visibility(5, visibility_ms(c));
        EXPECT_EQ(t.build, build) << k;
        EXPECT_EQ(t.aim, aim) << k;
        EXPECT_EQ(t.look, std::vector<double>(5, look_ms(c))) << k;
        EXPECT_EQ(t.visibility, visibility) << k;
        EXPECT_EQ(t.light_aim[1], std::vector<double>(5, aim_ms(c) * 2 / 3));
        EXPECT_EQ(t.light_visibility[0], std::vector<double>(5, visibility_ms(c) / 3));
        EXPECT_EQ(t.cold.build, build_ms(c));
        EXPECT_EQ(t.cold.aim, (std::vector{aim_ms(c) / 3, aim_ms(c) * 2 / 3}));
        EXPECT_EQ(t.cold.look, look_ms(c));
        EXPECT_EQ(t.cold.visibility, (std::vector{visibility_ms(c) / 3, visibility_ms(c) * 2 / 3}));
        EXPECT_EQ(t.cold.all(), build_ms(c) + aim_ms(c) + look_ms(c) + visibility_ms(c));
        EXPECT_EQ(totals(t), std::vector<double>(5, t.cold.all()));
        EXPECT_EQ(t.memory_bytes, 1000 * c.settings.value("map"));
        EXPECT_FALSE(t.only_cold);
        EXPECT_EQ(t.failed, "");
        EXPECT_EQ(t.order.size(), 5u);
    }
    EXPECT_EQ(turns.calibration, std::vector<double>(5, 20));
}

/// In each round: one new build for each group, and on that build every setting of the group, each with its own look
/// and, light after light, aim and visibility.
TEST_F(TurnsTest, SettingsOfOneBuildShareIt) {
    const std::vector<MethodChoice> choices{choice(a_, 2, 1, 1), choice(a_, 3, 1, 1), choice(a_, 2, 5, 1),
                                            choice(b_, 2, 1, 1), choice(a_, 2, 1, 9), choice(b_, 2, 1, 3)};
    options_.rounds   = 4;
    const Turns turns = time_in_turns(prepared_, choices, options_);

    std::map<int, std::vector<Call>> by_build;
    for (const Call& call : fake.calls) by_build[call.build].push_back(call);
    const std::pair<Phase, LightId> expected[] = {
        {Phase::look, 0}, {Phase::aim, 0}, {Phase::visibility, 0}, {Phase::aim, 1}, {Phase::visibility, 1}};
    for (const auto& [build, calls] : by_build) {
        EXPECT_EQ(calls[0].phase, Phase::build);
        for (std::size_t i = 1; i < calls.size(); ++i) {
            EXPECT_EQ(calls[i].options.tree, calls[0].options.tree);
            EXPECT_EQ(std::pair(calls[i].phase, calls[i].light), expected[(i - 1) % 5]) << i;
        }
    }
    // Three groups (a tree=2, a tree=3, b tree=2) in the cold round and four more, and the control's twin in four.
    EXPECT_EQ(by_build.size(), 3u * 5 + 4);
    // Six settings in five rounds, the twin in four.
    EXPECT_EQ(fake.calls.size(), by_build.size() + std::size(expected) * (6 * 5 + 4));
    for (const TurnTimes& t : turns.settings) EXPECT_EQ(t.build.size(), 4u);
}

/// The build that is shared is the one that was measured in that round.
TEST_F(TurnsTest, ASharedBuildIsTheSameSampleForAll) {
    double drift = 0;
    fake.extra   = [&](const Call& call) {
        if (call.phase == Phase::build) fake.now += ++drift;
    };
    const Turns turns =
        time_in_turns(prepared_, std::vector{choice(a_, 1, 1, 1), choice(a_, 1, 2, 1), choice(b_, 1, 1, 1)}, options_);
    EXPECT_EQ(turns.settings[0].build, turns.settings[1].build);
    EXPECT_NE(turns.settings[0].build, turns.settings[2].build);
    EXPECT_EQ(std::set<double>(turns.settings[0].build.begin(), turns.settings[0].build.end()).size(), 7u);
}

TEST_F(TurnsTest, OrderIsDrawnForEachRoundAndFixedByTheSeed) {
    std::vector<MethodChoice> choices;
    for (int k = 0; k < 6; ++k) choices.push_back(choice(a_, 1 + k, 1, 1));
    options_.rounds        = 200;
    const auto orders_with = [&](std::uint32_t seed) {
        options_.seed = seed;
        std::vector<std::vector<int>> orders;
        for (const TurnTimes& t : time_in_turns(prepared_, choices, options_).settings) orders.push_back(t.order);
        return orders;
    };
    const auto first = orders_with(1);
    EXPECT_EQ(orders_with(1), first);
    EXPECT_NE(orders_with(2), first);
    // Each position in a round is taken once (the twin has the one that is left), and over 200 rounds each setting has
    // each of the seven positions about 200 / 7 = 29 times, with a deviation of 5: five deviations are 4 to 54.
    std::map<std::pair<std::size_t, int>, int> counts;
    for (std::size_t round = 0; round < 200; ++round) {
        std::set<int> taken;
        for (std::size_t k = 0; k < 6; ++k) {
            taken.insert(first[k][round]);
            ++counts[{k, first[k][round]}];
        }
        EXPECT_EQ(taken.size(), 6u);
        EXPECT_GE(*taken.begin(), 0);
        EXPECT_LE(*taken.rbegin(), 6);
    }
    EXPECT_EQ(counts.size(), 42u);
    for (const auto& [where, n] : counts) {
        EXPECT_GE(n, 4);
        EXPECT_LE(n, 54);
    }
}

/// Members of one group follow one another, in an order that changes, and the twin has a build of its own.
TEST_F(TurnsTest, OrderWithinAGroupIsDrawnToo) {
    options_.rounds   = 50;
    const Turns turns = time_in_turns(prepared_, std::vector{choice(a_, 1, 1, 1), choice(a_, 1, 1, 2)}, options_);
    int forward       = 0;
    for (std::size_t round = 0; round < 50; ++round) {
        const int step = turns.settings[1].order[round] - turns.settings[0].order[round];
        EXPECT_EQ(std::abs(step), 1);
        forward += step == 1;
    }
    EXPECT_GE(forward, 8) << "of 50 throws 25, with a deviation of 3.5: five deviations";
    EXPECT_LE(forward, 42);
}

/// The cheapest setting runs twice a round; the bar is what its two runs differ by.
TEST_F(TurnsTest, ControlGivesTheNoiseBar) {
    const std::vector choices{choice(a_, 5, 1, 1), choice(b_, 1, 1, 1), choice(a_, 1, 2, 1)};
    EXPECT_EQ(time_in_turns(prepared_, choices, options_).noise_bar, 0) << "the fake clock has no noise";
    // Every second build of b takes 13.3 ms more: its 133 ms become 146.3, which is 10 % of a whole run.
    int builds = 0;
    fake.extra = [&](const Call& call) {
        if (call.phase == Phase::build && call.options.tree == 1 && ++builds % 2 == 0) fake.now += 13.3;
    };
    const Turns turns = time_in_turns(prepared_, choices, options_);
    ASSERT_TRUE(turns.control);
    EXPECT_EQ(*turns.control, 1u);
    ASSERT_TRUE(turns.twin);
    EXPECT_EQ(turns.twin->build.size(), 7u);
    EXPECT_EQ(turns.twin->order.size(), 7u);
    EXPECT_GT(turns.noise_bar, 0);
    EXPECT_LE(turns.noise_bar, 0.1 + 1e-9);
}

/// Of 3000 ms, one of 10333 ms has none: its cold run is all there is. One of 133 ms has all of its seven rounds, and
/// one of 433 ms three, which the whole pays for, and no fourth, as its part is 1000.
TEST_F(TurnsTest, BudgetIsRespectedAndSaid) {
    options_.budget_ms = 3000;
    const Turns turns  = time_in_turns(
         prepared_, std::vector{choice(a_, 1, 1, 1), choice(a_, 103, 1, 1), choice(b_, 4, 1, 1)}, options_);
    EXPECT_EQ(turns.settings[0].build.size(), 7u);
    EXPECT_EQ(turns.settings[1].build, std::vector<double>{10300});
    EXPECT_TRUE(turns.settings[1].only_cold);
    EXPECT_TRUE(turns.settings[1].order.empty());
    EXPECT_EQ(turns.settings[2].build.size(), 3u);
    EXPECT_EQ(turns.calibration.size(), 7u);
    EXPECT_EQ(turn_times_record(turns.settings[1]).phases.build_ms->runs, 1u);
}

/// A quarter of 3000 ms is for the three that are not ranked, 250 each: one of 433 ms has its first run alone, one of 233
/// a round. They take nothing from the ranked one, and the control, which is none of the ranked, has all its rounds.
TEST_F(TurnsTest, WhatIsNotRankedTakesALittle) {
    options_.budget_ms = 3000;
    options_.ranked    = 1;
    const Turns turns  = time_in_turns(
         prepared_, std::vector{choice(a_, 4, 1, 1), choice(b_, 4, 1, 1), choice(b_, 1, 1, 1), choice(a_, 2, 1, 1)},
         options_);
    EXPECT_EQ(turns.settings[0].build.size(), 6u) << "of 433 ms";
    EXPECT_TRUE(turns.settings[1].only_cold);
    EXPECT_EQ(turns.settings[2].build.size(), 7u);
    EXPECT_EQ(turns.twin->build.size(), 7u);
    EXPECT_EQ(turns.settings[3].build.size(), 1u);
}

/// 133 ms twice (with the twin) and 833 ms make rounds of 1099 ms: two of them fit into 3000.
TEST_F(TurnsTest, FewerThanThreeRoundsWhereTheBudgetEnds) {
    options_.budget_ms = 3000;
    const Turns turns  = time_in_turns(prepared_, std::vector{choice(a_, 1, 1, 1), choice(b_, 8, 1, 1)}, options_);
    EXPECT_EQ(turns.settings[0].build.size(), 7u);
    EXPECT_EQ(turns.settings[1].build.size(), 2u);
    EXPECT_FALSE(turns.settings[1].only_cold);
}

/// Known first runs are kept as the cold ones and decide what is affordable.
TEST_F(TurnsTest, FirstRunsThatAreKnownAreNotRepeated) {
    options_.first     = {RunTimes{1, {2, 3}, 6, {4, 5}}, RunTimes{1e9, {2, 3}, 6, {4, 5}}};
    options_.budget_ms = 1e6;
    options_.rounds    = 2;
    const Turns turns  = time_in_turns(prepared_, std::vector{choice(a_, 1, 1, 1), choice(b_, 1, 1, 1)}, options_);
    EXPECT_EQ(turns.settings[0].cold.build, 1);
    EXPECT_EQ(turns.settings[0].cold.aim, (std::vector<double>{2, 3}));
    EXPECT_EQ(turns.settings[0].cold.look, 6);
    EXPECT_EQ(turns.settings[0].cold.visibility, (std::vector<double>{4, 5}));
    EXPECT_EQ(turns.settings[0].build.size(), 2u);
    EXPECT_EQ(turns.settings[1].build, std::vector<double>{1e9});
    EXPECT_EQ(fake.calls.size(), 2u * 2 * 6) << "two rounds of the first setting and of its twin";
    options_.first.pop_back();
    EXPECT_THROW((void)time_in_turns(prepared_, std::vector{choice(a_, 1, 1, 1), choice(b_, 1, 1, 1)}, options_),
                 std::logic_error);
}

/// One that throws in the third round keeps what it has; those who share its build go on, on another.
TEST_F(TurnsTest, AFailureIsOneSettingsOwn) {
    int aims   = 0;
    fake.extra = [&](const Call& call) {
        if (call.phase == Phase::aim && call.options.map == 7 && ++aims > 2 * 3) throw std::runtime_error("no map");
    };
    const Turns turns =
        time_in_turns(prepared_, std::vector{choice(a_, 1, 7, 1), choice(a_, 1, 2, 1), choice(a_, 1, 3, 1)}, options_);
    EXPECT_EQ(turns.settings[0].failed, "no map");
    EXPECT_EQ(turns.settings[0].build.size(), 2u) << "the cold run and two rounds";
    EXPECT_EQ(turns.settings[0].order.size(), 2u);
    for (const std::size_t k : {1u, 2u}) {
        EXPECT_EQ(turns.settings[k].failed, "");
        EXPECT_EQ(turns.settings[k].build, std::vector<double>(7, 100));
        EXPECT_EQ(turns.settings[k].aim, std::vector<double>(7, aim_ms(turns.settings[k].choice)));
    }
}

TEST_F(TurnsTest, FailureInTheFirstRunLeavesNoSamples) {
    fake.extra = [](const Call& call) {
        if (call.options.map == 7) throw std::runtime_error("never");
    };
    const Turns turns = time_in_turns(prepared_, std::vector{choice(a_, 1, 7, 1), choice(a_, 1, 2, 1)}, options_);
    EXPECT_EQ(turns.settings[0].failed, "never");
    EXPECT_TRUE(turns.settings[0].build.empty());
    EXPECT_EQ(turns.settings[1].build.size(), 7u);
    EXPECT_THROW((void)turn_times_record(turns.settings[0]), std::logic_error);
}

TEST_F(TurnsTest, WhatDoesNotServeIsNotRun) {
    fake.serves       = false;
    const Turns turns = time_in_turns(prepared_, std::vector{choice(a_, 1, 1, 1)}, options_);
    EXPECT_EQ(turns.settings[0].service.how, How::not_at_all);
    EXPECT_TRUE(turns.settings[0].build.empty());
    EXPECT_TRUE(fake.calls.empty());
    EXPECT_TRUE(turns.calibration.empty());
    EXPECT_EQ(turns.noise_bar, std::numeric_limits<double>::infinity());
}

TEST_F(TurnsTest, JsonKeepsSamplesAndOrder) {
    TurnTimes t{choice(a_, 1, 1, 1)};
    t.build      = {3, 1, 2};
    t.aim        = {6, 4, 5};
    t.look       = {0, 2, 1};
    t.visibility = {9, 8, 70};
    t.order      = {2, 0, 1};
    t.cold       = {30, {20, 40}, 10, {90}};
    EXPECT_EQ(
        to_record(turn_times_record(t)),
        Json::parse(R"({"build_ms": {"median": 2.0, "min": 1.0, "max": 3.0, "runs": 3, "samples": [3.0, 1.0, 2.0]},
                              "aim_ms": {"median": 5.0, "min": 4.0, "max": 6.0, "runs": 3, "samples": [6.0, 4.0, 5.0]},
                              "look_ms": {"median": 1.0, "min": 0.0, "max": 2.0, "runs": 3,
                                          "samples": [0.0, 2.0, 1.0]},
                              "visibility_ms": {"median": 9.0, "min": 8.0, "max": 70.0, "runs": 3,
                                                "samples": [9.0, 8.0, 70.0]},
                              "cold": {"build_ms": 30.0, "aim_ms": 60.0, "look_ms": 10.0, "visibility_ms": 90.0},
                              "order": [2, 0, 1]})"));
}

}  // namespace
}  // namespace umbra
