#include "umbra/bench/report/history.h"

#include <gtest/gtest.h>

#include "umbra/bench/lab/results.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

using Kind = HistoryCell::Kind;

/// One method in one scene; `ms` a round, and `wrong` of 1000 points.
Results kept(double ms, std::uint64_t wrong, double calibration = 10) {
    Results results;
    results.scene.name   = "court";
    results.scene.origin = results.facts.extent.min = results.facts.extent.max = {0, 0, 0};
    results.turns.emplace();
    results.turns->calibration_ms = std::vector<double>(8, calibration);
    results.turns->noise_bar      = 0.05;
    results.turns->threads = results.turns->processors = 1;
    results.reference.name                             = "exact";
    MethodRecord method;
    method.id = method.name = method.text = "maps";
    method.serves                         = {"approximately", ""};
    method.ran                            = true;
    method.times.emplace();
    TimingRecord build{.median = ms / 4, .min = 0, .max = ms, .runs = 8}, visibility = build;
    visibility.median = ms - ms / 4;
    for (int i = 0; i < 8; ++i) {  // all different, as clocks give them
        build.samples.push_back(ms / 4);
        visibility.samples.push_back((ms - ms / 4) * (1 + 0.001 * i));
    }
    TimingRecord aim{.median = 0, .min = 0, .max = 0, .runs = 8};
    aim.samples                        = std::vector<double>(8, 0);
    method.times->phases.build_ms      = build;
    method.times->phases.aim_ms        = aim;
    method.times->phases.visibility_ms = visibility;
    ErrorRecord error;
    error.points         = 1000;
    error.interior.lit   = wrong;
    error.interior.umbra = 0;
    method.errors        = {error};
    results.methods      = {method};
    return results;
}

class HistoryOfCommits : public testing::Test {
protected:
    void keep(const std::string& commit, const Results& results) {
        static_cast<void>(folder_.write(commit + "/court/results.json", record_text(results)));
        folders_.push_back(folder_.path() / commit);
    }
    [[nodiscard]] std::vector<HistoryCell> cells() const { return read_history(folders_).rows.at(0).cells; }

    TemporaryFolder folder_;
    std::vector<std::filesystem::path> folders_;
};

TEST_F(HistoryOfCommits, CellsAreAgainstTheFirst) {
    keep("a", kept(40, 3));
    keep("b", kept(40.5, 3));  // within the noise bar
    keep("c", kept(50, 3));
    keep("d", kept(30, 2));
    keep("e", kept(40, 4));
    keep("f", kept(80, 3, 20));  // a machine that takes twice the time
    Results refused           = kept(1, 0);
    refused.methods[0].serves = {"not", "no area lights"};
    refused.methods[0].ran    = false;
    refused.methods[0].times  = {};
    keep("g", refused);
    refused.methods[0].failed.emplace();
    refused.methods[0].failed->message = "threw";
    keep("h", refused);
    Results other         = kept(1, 0);
    other.methods[0].text = "maps:size=2";
    keep("i", other);
    const History history = read_history(folders_);
    EXPECT_EQ(history.commits, (std::vector<std::string>{"a", "b", "c", "d", "e", "f", "g", "h", "i"}));
    ASSERT_EQ(history.rows.size(), 2u);
    EXPECT_EQ(history.rows[0].scene, "court");
    EXPECT_EQ(history.rows[0].method, "maps");
    std::vector<Kind> kinds;
    for (const HistoryCell& cell : history.rows[0].cells) kinds.push_back(cell.kind);
    EXPECT_EQ(kinds, (std::vector<Kind>{Kind::equal, Kind::equal, Kind::slower, Kind::faster, Kind::wrong, Kind::equal,
                                        Kind::refused, Kind::wrong, Kind::absent}));
    EXPECT_DOUBLE_EQ(history.rows[0].cells[2].ratio, 1.25);
    EXPECT_DOUBLE_EQ(history.rows[0].cells[5].ms, 40);
    EXPECT_EQ(history.rows[0].cells[4].says, "0.4 % of the points are wrong outside the edge band, before 0.3 %");
    EXPECT_EQ(history.rows[1].cells[8].kind, Kind::equal);

    EXPECT_EQ(history_text(history),
              "a: 1 absent, 1 equal\nb: 1 absent, 1 equal\nc: 1 absent, 1 slower\nd: 1 absent, 1 faster\n"
              "e: 1 absent, 1 wrong\nf: 1 absent, 1 equal\ng: 1 absent, 1 refused\nh: 1 absent, 1 wrong\n"
              "i: 1 absent, 1 equal\n"
              "c: court maps: slower: +25 %\n"
              "e: court maps: wrong: 0.4 % of the points are wrong outside the edge band, before 0.3 %\n"
              "h: court maps: wrong: threw\n");
    const std::string page = history_page(history);
    // The fastest, 30 ms, is blue; the slowest, 50 ms, white.
    EXPECT_NE(page.find("<td class=\"slower\" style=\"--blue: 0\">50.0 <b>+25 %</b></td><td class=\"faster\" "
                        "style=\"--blue: 100\">30.0 <b>-25 %</b></td><td class=\"wrong\"><b>wrong</b><small>0.4 %"),
              std::string::npos)
        << page;
    EXPECT_NE(page.find("<td class=\"refused\">not served<small>no area lights</small></td>"), std::string::npos);
}

TEST_F(HistoryOfCommits, NoiseAndFewRoundsSayNothing) {
    Results loud          = kept(50, 3);
    loud.turns->noise_bar = 0.5;
    Results few           = kept(50, 3);
    for (auto* phase : {&few.methods[0].times->phases.build_ms, &few.methods[0].times->phases.visibility_ms})
        (*phase)->samples.resize(1);
    keep("a", kept(40, 3));
    keep("b", loud);
    keep("c", few);
    EXPECT_EQ(cells()[1].kind, Kind::equal);
    EXPECT_EQ(cells()[2].kind, Kind::equal);
    EXPECT_DOUBLE_EQ(cells()[2].ratio, 1.25);
}

TEST_F(HistoryOfCommits, FoldersWithoutRecordsAreRefused) {
    keep("a", kept(40, 3));
    folders_.push_back(folder_.path() / "none");
    EXPECT_THROW(static_cast<void>(read_history(folders_)), InputError);
    std::filesystem::create_directories(folders_.back());
    EXPECT_THROW(static_cast<void>(read_history(folders_)), InputError);
    static_cast<void>(folder_.write("none/results.json", R"({"schema": 2, "rungs": []})"));  // another command's
    EXPECT_THROW(static_cast<void>(read_history(folders_)), InputError);
}

}  // namespace
}  // namespace umbra
