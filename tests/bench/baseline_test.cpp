// An accepted run of benchmarks against a new one, with planted times.
#include "umbra/bench/gate/baseline.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "umbra/core/base/error.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

using Json = nlohmann::ordered_json;

/// Repetitions around `ms`, within 1 %.
std::vector<double> around(double ms) { return {ms * 1.01, ms * 0.99, ms, ms * 1.005, ms * 0.995}; }

BenchmarkRun run(double speed, const std::map<std::string, double>& times) {
    BenchmarkRun r{{}, around(20 * speed), around(20 * speed)};
    for (const auto& [name, ms] : times) r.times[name] = around(ms * speed);
    return r;
}

Change change_of(const BaselineReport& report, const std::string& name) {
    for (const BenchmarkChange& c : report.changes)
        if (c.name == name) return c.change;
    throw std::logic_error("no " + name);
}

TEST(Baseline, AMachineThatIsSlowerTodayChangesNothing) {
    const std::map<std::string, double> times{{"a", 5}, {"b", 70}};
    const BaselineReport report = compare_with_baseline(run(1.7, times), run(1, times));
    EXPECT_EQ(change_of(report, "a"), Change::none);
    EXPECT_EQ(change_of(report, "b"), Change::none);
    EXPECT_NEAR(report.calibration, 1.7, 1e-12);
    EXPECT_NEAR(report.changes[0].ratio.median, 1, 1e-12);
    EXPECT_FALSE(slowest(report));
    EXPECT_GT(report.noise_bar, 0);
    EXPECT_LE(report.noise_bar, 0.021) << "repetitions differ by 2 %";
}

/// b takes 30 % more and c a third less, on a machine that takes half of the time.
TEST(Baseline, SlowerAndFasterAreFoundBehindTheMachine) {
    const BaselineReport report = compare_with_baseline(run(0.5, {{"a", 5}, {"b", 91}, {"c", 6}, {"new", 1}}),
                                                        run(1, {{"a", 5}, {"b", 70}, {"c", 9}, {"gone", 1}}));
    EXPECT_EQ(change_of(report, "a"), Change::none);
    EXPECT_EQ(change_of(report, "b"), Change::slower);
    EXPECT_EQ(change_of(report, "c"), Change::faster);
    EXPECT_EQ(change_of(report, "new"), Change::added);
    EXPECT_EQ(change_of(report, "gone"), Change::removed);
    EXPECT_EQ(report.changes[0].name, "b") << "slowest first";
    ASSERT_TRUE(slowest(report));
    EXPECT_NEAR(*slowest(report), 1.3, 1e-12);

    const Json record = baseline_json(report);
    EXPECT_EQ(record["benchmarks"][0]["change"], "slower");
    EXPECT_NEAR(record["benchmarks"][0]["ratio"].get<double>(), 1.3, 1e-12);
    // Of five against five, twice 1 - 2 (1 + 1) / 252: the second least of times over the second largest of
    // calibrations.
    EXPECT_NEAR(record["benchmarks"][0]["coverage"].get<double>(), 1 - 8.0 / 252, 1e-12);
    const std::string text = baseline_markdown(report);
    EXPECT_NE(text.find("5 benchmarks: 1 slower, 1 faster, 1 without a difference, 1 new, 1 gone."), std::string::npos)
        << text;
    EXPECT_NE(text.find("| b | slower | 1.300 |"), std::string::npos) << text;
}

TEST(Baseline, NothingIsSaidWithoutAControlOrWithFewRepetitions) {
    BenchmarkRun now = run(1, {{"a", 10}}), then = run(1, {{"a", 5}});
    then.calibration_again.clear();
    EXPECT_EQ(change_of(compare_with_baseline(now, then), "a"), Change::none);
    then = run(1, {{"a", 5}});
    then.times["a"].resize(2);
    EXPECT_EQ(change_of(compare_with_baseline(now, then), "a"), Change::none);
    const BaselineReport few = compare_with_baseline(now, then);
    EXPECT_TRUE(baseline_json(few)["benchmarks"][0]["interval"][0].is_null());
    EXPECT_NE(baseline_markdown(few).find("| none: 2 repetitions are too few |"), std::string::npos);
}

/// A change within what the calibration differs from itself by is none.
TEST(Baseline, NoiseBarIsTheControls) {
    BenchmarkRun now = run(1, {{"a", 5.4}}), then = run(1, {{"a", 5}});
    EXPECT_EQ(change_of(compare_with_baseline(now, then), "a"), Change::slower);
    now.calibration_again       = around(22);
    const BaselineReport report = compare_with_baseline(now, then);
    EXPECT_GT(report.noise_bar, 0.1);
    EXPECT_EQ(change_of(report, "a"), Change::none);
}

class BaselineFiles : public testing::Test {
protected:
    static Json entry(const std::string& name, double time, const std::string& unit = "ms") {
        return {{"name", name}, {"run_type", "iteration"}, {"real_time", time}, {"cpu_time", 99}, {"time_unit", unit}};
    }
    std::filesystem::path file(const std::string& name, const Json& benchmarks) const {
        return folder_.write(name, Json{{"context", {{"date", name}}}, {"benchmarks", benchmarks}}.dump());
    }
    TemporaryFolder folder_;
};

TEST_F(BaselineFiles, RepetitionsAreReadAndAggregatesAndFailuresAreNot) {
    Json mean = entry("a/manual_time_mean", 7), failed = entry("b", 1);
    mean["run_type"]         = "aggregate";
    failed["error_occurred"] = true;
    const BenchmarkRun run   = read_benchmark_run(
          file("run.json", Json::array({entry("calibration/manual_time", 20), entry("calibration/again/manual_time", 21),
                                        entry("a/manual_time", 5), entry("a/manual_time", 6000, "us"),
                                        entry("c/manual_time/threads:1", 1, "s"), entry("d", 4e6, "ns"), mean, failed})));
    EXPECT_EQ(run.calibration, (std::vector<double>{20}));
    EXPECT_EQ(run.calibration_again, (std::vector<double>{21}));
    EXPECT_EQ(run.times,
              (std::map<std::string, std::vector<double>>{{"a", {5, 6}}, {"c/threads:1", {1000}}, {"d", {4}}}));
}

TEST_F(BaselineFiles, JoinedFilesAreOne) {
    const auto first  = file("first", Json::array({entry("calibration", 20), entry("a", 1)}));
    const auto second = file("second", Json::array({entry("calibration", 22), entry("b", 2)}));
    const Json joined = merged_benchmarks({first, second});
    EXPECT_EQ(joined["context"]["date"], "first");
    EXPECT_EQ(joined["benchmarks"].size(), 4u);
    const BenchmarkRun run = read_benchmark_run(folder_.write("joined", joined.dump()));
    EXPECT_EQ(run.calibration, (std::vector<double>{20, 22}));
    EXPECT_EQ(run.times.size(), 2u);
}

TEST_F(BaselineFiles, MessagesSayWhatWasFound) {
    const auto message = [](const std::filesystem::path& path) -> std::string {
        try {
            (void)read_benchmark_run(path);
        } catch (const InputError& e) {
            return e.what();
        }
        return "no error";
    };
    const auto ends = [](const std::string& text, const std::string& with) { return text.ends_with(with); };
    EXPECT_TRUE(ends(message(folder_.path() / "none"), "none: cannot be opened"));
    EXPECT_TRUE(ends(message(folder_.write("text", "no JSON")),
                     "text: expected the JSON that Google Benchmark writes, an object with an array \"benchmarks\""));
    EXPECT_TRUE(ends(message(file("bare", Json::array({entry("a", 1)}))),
                     "bare: no benchmark \"calibration\", which all others are relative to"));
    EXPECT_TRUE(ends(message(file("unit", Json::array({entry("a", 1, "years")}))),
                     "unit: a: expected \"real_time\" and a \"time_unit\" of s, ms, us or ns"));
    EXPECT_TRUE(
        ends(message(file("number", Json::array({1}))), "number: a benchmark without \"name\", expected a string"));
}

}  // namespace
}  // namespace umbra
