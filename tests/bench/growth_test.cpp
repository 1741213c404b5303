// Growth: families are what they say, planted exponents and crossings are found, theory is compared with.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "umbra/bench/studies/motion/growth.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/json_schema.h"
#include "umbra/tests/support/planted_method.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

// ---- Families

TEST(GrowthFamilies, HaveTheSizesThatTheyAreAskedFor) {
    for (const GrowthFamily& family : growth_families())
        for (const double x : {family.least, family.least * family.factor * family.factor}) {
            const Scene scene  = family.scene(x);
            const double found = family.size(scene, x);
            EXPECT_LT(std::abs(found / x - 1), 0.15) << family.name << " " << x;
            const SceneFacts facts = find_facts(scene);
            for (std::size_t o = 1; o < facts.objects.size(); ++o)
                EXPECT_TRUE(facts.objects[o].closed) << family.name << ": bodies are closed";
        }
    EXPECT_THROW((void)find_growth_family("triangels"), UsageError);
}

TEST(GrowthFamilies, ShadeTheSamePartOfThePictureAtEverySize) {
    for (const char* name : {"triangles", "bodies", "pixels"}) {
        const GrowthFamily& family = find_growth_family(name);
        std::vector<double> shaded;
        for (const double x :
             {family.least * family.factor * family.factor, family.least * std::pow(family.factor, 4)}) {
            const PreparedScene prepared = prepare_growth(family, x);
            const MethodRun run =
                run_method(parse_method("ray_traced"), prepared.scene, prepared.facts, prepared.points);
            double dark = 0, all = 0;
            for (std::size_t i = 0; i < prepared.points.size(); ++i)
                if (prepared.points.asks(0, i)) dark += run.planes[0].s[i] < 0.5f, ++all;
            shaded.push_back(dark / all);
        }
        EXPECT_GT(shaded[0], 0.03) << name;
        EXPECT_NEAR(shaded[1] / shaded[0], 1, 0.2) << name;
    }
}

TEST(GrowthFamilies, SetTheParameterThatGrows) {
    const GrowthFamily &samples = find_growth_family("samples"), &triangles = find_growth_family("triangles");
    ASSERT_EQ(samples.at(parse_method("ray_traced"), 64).size(), 1u);
    EXPECT_EQ(samples.at(parse_method("ray_traced"), 64)[0].text(), "ray_traced:samples=64");
    EXPECT_EQ(samples.at(parse_method("planar_projection"), 16)[0].text(), "planar_projection:light_samples=16");
    EXPECT_TRUE(samples.at(parse_method("shadow_volumes"), 64).empty());
    EXPECT_EQ(triangles.at(parse_method("shadow_volumes"), 64)[0].text(), "shadow_volumes");
}

TEST(GrowthFamilies, SizesAreGeometric) {
    EXPECT_EQ(find_growth_family("lights").sizes(16), (std::vector<double>{1, 2, 4, 8, 16}));
    EXPECT_EQ(find_growth_family("triangles").sizes(1e5).size(), 5u);
    EXPECT_TRUE(find_growth_family("lights").sizes(0.5).empty());
}

// ---- Planted growth

/// Planted methods whose phases take known powers of the size by a clock of the test's own. The seed tells them apart:
/// seed 0 has visibility 1024 x^0.5, seed 1 has x^1.5 / 4, which is as much at x = 4096. All times are whole numbers,
/// so that equal ones are equal.
class PlantedGrowth : public testing::Test {
protected:
    PlantedGrowth() {
        planted_behaviour        = {};
        planted_behaviour.answer = [this](LightId, std::size_t, std::size_t, int seed) {
            asked_ = seed;
            return PlantedAnswer{1};
        };
        planted_behaviour.memory_bytes = 1000;
        planted_behaviour.work         = [this](Phase phase, LightId) {
            if (phase == Phase::build) now_ += x_ / 128;
            if (phase == Phase::aim) now_ += 3;
        };
        options_.longest_ms      = 1e12;
        options_.turns.rounds    = 6;
        options_.turns.budget_ms = 1e12;
        options_.turns.clock     = [this] {
            // Read twice around visibility: the second time, the method has been asked.
            if (asked_ >= 0) now_ += asked_ == 0 ? 1024 * std::sqrt(x_) : x_ * std::sqrt(x_) / 4;
            asked_ = -1;
            return now_;
        };
        options_.progress = [this](const std::string& what) {
            x_ = static_cast<double>(std::stod(what.substr(what.find(": ") + 2)));
        };
    }
    ~PlantedGrowth() override { planted_behaviour = {}; }

    [[nodiscard]] std::vector<MethodChoice> choices() const {
        MethodChoice other(info_);
        other.settings.set("seed", 1.0);
        return {MethodChoice(info_), other};
    }
    MethodInfo info_ = planted_method();
    GrowthOptions options_;
    double now_ = 0, x_ = 1;
    int asked_ = -1;
};

/// A family of the test's own: its scene stays and its size is what is asked for.
const GrowthFamily kPlanted{"planted",
                            "Planted",
                            "Nothing grows but time.",
                            "units",
                            256,
                            65536,
                            1e6,
                            4,
                            [](double) { return find_growth_family("lights").scene(1); },
                            [](const Scene&, double x) { return x; }};

TEST_F(PlantedGrowth, FramesAreSumsOfThePhasesThatTheyRepeat) {
    GrowthPoint point{.times = {.choice = MethodChoice(info_)}};
    point.times.build = {1}, point.times.aim = {2}, point.times.look = {4}, point.times.visibility = {8};
    EXPECT_EQ(GrowthSeries::rounds(point, Quantity::camera_frame), std::vector<double>{4 + 8});
    EXPECT_EQ(GrowthSeries::rounds(point, Quantity::light_frame), std::vector<double>{2 + 8});
    EXPECT_EQ(GrowthSeries::rounds(point, Quantity::object_frame), std::vector<double>{1 + 2 + 4 + 8});
}

TEST_F(PlantedGrowth, ExponentsAreFound) {
    const GrowthRun run = run_growth(kPlanted, choices(), 65536, options_);
    EXPECT_EQ(run.sizes, (std::vector<double>{256, 1024, 4096, 16384, 65536}));
    const auto exponent = [&](std::size_t series, Quantity quantity) {
        const std::optional<PowerLaw> fit = fit_growth(run.series[series], quantity);
        EXPECT_TRUE(fit.has_value());
        EXPECT_EQ(fit->range.low, 1024) << "256 is less than a hundredth of the largest";
        EXPECT_EQ(fit->range.high, 65536);
        EXPECT_EQ(fit->points, 4);
        return fit->exponent;
    };
    EXPECT_NEAR(exponent(0, Quantity::build), 1, 1e-6);
    EXPECT_NEAR(exponent(0, Quantity::aim), 0, 1e-6);
    EXPECT_NEAR(exponent(0, Quantity::camera_frame), 0.5, 1e-6);
    EXPECT_NEAR(exponent(1, Quantity::camera_frame), 1.5, 1e-6);
    EXPECT_NEAR(exponent(0, Quantity::memory), 0, 1e-6);
}

TEST_F(PlantedGrowth, CrossingsLieBetweenTheSizesAroundThem) {
    const GrowthRun run = run_growth(kPlanted, choices(), 65536, options_);
    const auto found    = measured_crossings(run.series[0], run.series[1], Quantity::camera_frame);
    ASSERT_EQ(found.size(), 1u);
    // They are equal at 4096, which counts for neither.
    EXPECT_EQ(found[0].between, (std::vector<double>{1024, 16384}));
    EXPECT_NEAR(found[0].x, 4096, 1e-6);
    EXPECT_EQ(found[0].below, "planted:seed=1") << "x^0.5 is more below";
    EXPECT_EQ(found[0].above, "planted");
    EXPECT_TRUE(measured_crossings(run.series[0], run.series[0], Quantity::camera_frame).empty());
    const Json json = to_record(family_record(run));
    ASSERT_FALSE(json["crossings"].empty());
    EXPECT_EQ(json["crossings"][0]["below"], "planted:seed=1");
    EXPECT_NEAR(json["crossings"][0]["fitted"]["x"].get<double>(), 4096, 1e-3);
    EXPECT_TRUE(json["external"].is_null());
}

/// At 256: build 256 / 128, aim 3, no look, visibility 1024 sqrt(256).
TEST_F(PlantedGrowth, TheTableHasEachPhaseInItsColumn) {
    planted_behaviour.memory_bytes = 2500000;
    const GrowthRun run            = run_growth(kPlanted, {MethodChoice(info_)}, 256, options_);
    const std::string table        = growth_table(
               {.machine = {.cpu = "A CPU", .threads = 2}, .load_average = {1, 1}, .growth = {family_record(run)}});
    EXPECT_NE(table.find(fmt::format("{:>12} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "256", "2.00", "3.00", "0.00",
                                     "16384.00", "2.50")),
              std::string::npos)
        << table;
    const GrowthPoint& point = run.series[0].points[0];
    EXPECT_EQ(GrowthSeries::rounds(point, Quantity::light_frame), std::vector<double>(6, 3 + 16384));
    EXPECT_EQ(GrowthSeries::rounds(point, Quantity::object_frame), std::vector<double>(6, 2 + 3 + 16384));
}

TEST_F(PlantedGrowth, TooShortOrTooLongIsLeftOut) {
    const auto work        = planted_behaviour.work;
    planted_behaviour.work = [&](Phase phase, LightId light) {
        work(phase, light);
        if (phase == Phase::aim) now_ -= 2.99;
    };
    options_.longest_ms = 65000;
    const GrowthRun run = run_growth(kPlanted, {MethodChoice(info_)}, 65536, options_);
    EXPECT_FALSE(fit_growth(run.series[0], Quantity::aim)) << "0.01 ms cannot be timed";
    EXPECT_EQ(run.series[0].points.size(), 3u) << "4096 is the first that takes over 65 s";
    EXPECT_NE(run.series[0].left_out.find("at 4096"), std::string::npos) << run.series[0].left_out;
}

TEST_F(PlantedGrowth, AMethodThatThrowsIsLeftOutFromThereOn) {
    const auto work        = planted_behaviour.work;
    planted_behaviour.work = [&](Phase phase, LightId light) {
        work(phase, light);
        if (x_ == 1024 && phase == Phase::build) throw std::runtime_error("a planted defect");
    };
    const GrowthRun run = run_growth(kPlanted, {MethodChoice(info_), parse_method("ray_traced")}, 4096, options_);
    EXPECT_EQ(run.series[0].points.size(), 1u);
    EXPECT_EQ(run.series[0].left_out, "failed at 1024: a planted defect");
    EXPECT_EQ(run.series[1].points.size(), 3u);
}

// ---- Theory

TEST(GrowthTheory, IntervalsThatMeetAgree) {
    const Theory theory{{1, 1.15}, ""};
    EXPECT_EQ(compare_with_theory({0.7, 0.99}, theory), "below");
    EXPECT_EQ(compare_with_theory({0.7, 1.0}, theory), "agrees");
    EXPECT_EQ(compare_with_theory({1.15, 1.3}, theory), "agrees");
    EXPECT_EQ(compare_with_theory({1.16, 1.3}, theory), "above");
    EXPECT_EQ(compare_with_theory({0.2, 1.9}, theory), "undecided") << "too wide to say";
    EXPECT_EQ(compare_with_theory({-2, 0.9}, theory), "below") << "wide, but apart";
}

TEST(GrowthTheory, IsAboutMethodsAndPhasesThatThereAre) {
    std::size_t rows = 0;
    for (const GrowthFamily& family : growth_families())
        for (const MethodInfo* info : methods())
            for (const Quantity quantity : kQuantities)
                if (const auto theory = growth_theory(family.name, info->name, quantity)) {
                    EXPECT_LE(theory->exponent.low, theory->exponent.high);
                    EXPECT_FALSE(theory->why.empty());
                    ++rows;
                }
    EXPECT_GT(rows, 40u);
    EXPECT_FALSE(growth_theory("triangles", "nobody", Quantity::build));
}

// ---- The command

TEST(GrowthCommand, WritesWhatTheSchemaSaysAndAPage) {
    const TemporaryFolder folder;
    GrowthCommand command;
    command.over                 = {"triangles", "resolution"};
    command.methods              = {"shadow_zbuffer", "shadow_volumes"};
    command.options.turns.rounds = 2;
    command.options.longest_ms   = 0;  // one size: this is about what is written
    command.out                  = folder.path() / "out";
    const GrowthRecord measured  = measure_growth(command);
    const Json record            = to_record(measured);
    const std::string written    = text_of(command.out / "results.json");
    EXPECT_EQ(Json::parse(written), record);
    EXPECT_TRUE(fits(schema_of<GrowthRecord>("").dump(), written));
    ASSERT_EQ(record["growth"].size(), 2u);
    EXPECT_EQ(record["growth"][1]["methods"][0]["points"][0]["text"], "shadow_zbuffer:resolution=256");
    EXPECT_TRUE(record["growth"][1]["methods"][1]["points"].empty());
    const std::string page = text_of(command.out / "index.html"), table = growth_table(measured);
    EXPECT_NE(page.find("<section id=\"triangles\""), std::string::npos);
    EXPECT_NE(page.find("class=\"line\""), std::string::npos);
    EXPECT_EQ(page.find("{{"), std::string::npos);
    EXPECT_NE(table.find("has no parameter for resolution"), std::string::npos);
    Json changed                               = record;
    changed["growth"][0]["methods"][0]["sums"] = 1;
    EXPECT_FALSE(fits(schema_of<GrowthRecord>("").dump(), changed.dump()));
}

TEST(GrowthCommand, ComparesTwoWaysOfShadowVolumesWithOthersFigures) {
    const TemporaryFolder folder;
    GrowthCommand command;
    command.over                 = {"pixels"};
    command.methods              = {"shadow_volumes:edges=silhouette", "shadow_volumes:edges=per_triangle"};
    command.most                 = 256.0 * 256;
    command.options.turns.rounds = 2;
    command.out                  = folder.path() / "out";
    const GrowthRecord measured  = measure_growth(command);
    const Json record            = to_record(measured);
    const Json& check            = record["growth"][0]["external"];
    ASSERT_FALSE(check.is_null());
    ASSERT_EQ(check["ours"].size(), 2u);
    EXPECT_EQ(check["ours"][1]["pixels"], 65536.0);
    EXPECT_NEAR(check["theirs"][0]["ratio"].get<double>(), 0.515, 1e-3);
    EXPECT_TRUE(fits(schema_of<GrowthRecord>("").dump(), record.dump()));
    EXPECT_NE(growth_table(measured).find("dormon/ShadowsTestData"), std::string::npos);
    EXPECT_NE(text_of(command.out / "index.html").find("an external check"), std::string::npos);
}

TEST(GrowthCommand, RefusesAMaximumThatFitsNothing) {
    const TemporaryFolder folder;
    GrowthCommand command;
    command.out  = folder.path() / "out";
    command.most = 1e4;
    EXPECT_THROW((void)measure_growth(command), UsageError) << "of which size?";
    command.over = {"triangles"};
    for (const double most : {10.0, 1e9}) {
        command.most = most;
        EXPECT_THROW((void)measure_growth(command), UsageError) << most;
    }
    EXPECT_FALSE(fs::exists(command.out));
}

}  // namespace
}  // namespace umbra
