// What a run of ladders records, from a run made by hand whose figures are all different.
#include "umbra/bench/ladders/ladder_record.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "umbra/bench/ladders/ladder_cells.h"
#include "umbra/bench/ladders/ladder_page.h"
#include "umbra/bench/ladders/ladder_run.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/json_schema.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

/// Two rungs, 1 and 2: the first method is wrong at 3, then at 14 of 1000 points; the second never serves.
LadderRun run_by_hand() {
    LadderRun run{&find_ladder("needles"), {parse_method("shadow_zbuffer"), parse_method("ray_traced")}, {}};
    for (const int k : {0, 1}) {
        Rung& rung          = run.rungs.emplace_back();
        rung.value          = k + 1;
        rung.truth          = "exact";
        rung.surface_points = 10, rung.lit = 11, rung.umbra = 12, rung.penumbra = 13, rung.on_boundary = 14;
        RungOutcome wrong;
        wrong.service      = {How::approximately, "by hand"};
        wrong.points       = 1000;
        wrong.undefined    = 5;
        wrong.false_shadow = k == 0 ? VisibilityError::Kind{1, 20} : VisibilityError::Kind{6, 21};
        wrong.false_light  = k == 0 ? VisibilityError::Kind{2, 30} : VisibilityError::Kind{8, 31};
        wrong.mae          = 0.25;
        wrong.kind         = "leak";
        RungOutcome none;
        none.service  = {How::not_at_all, "it cannot"};
        rung.outcomes = {wrong, none};
    }
    return run;
}

TEST(LadderRecord, EachFigureHasItsPlace) {
    const Json ladder = to_record(ladder_record(run_by_hand()));
    EXPECT_EQ(ladder["rungs"][0]["surface_points"], 10);
    EXPECT_EQ(ladder["rungs"][0]["lit"], 11);
    EXPECT_EQ(ladder["rungs"][0]["umbra"], 12);
    EXPECT_EQ(ladder["rungs"][0]["penumbra"], 13);
    EXPECT_EQ(ladder["rungs"][0]["on_boundary"], 14);
    const Json &method = ladder["methods"][0], &rung = method["rungs"][1];
    EXPECT_EQ(rung["points"], 1000);
    EXPECT_EQ(rung["undefined"], 5);
    EXPECT_EQ(rung["false_shadow"], (Json{{"interior", 6}, {"edge", 21}}));
    EXPECT_EQ(rung["false_light"], (Json{{"interior", 8}, {"edge", 31}}));
    EXPECT_NEAR(rung["interior_share"], 0.014, 1e-12);
    EXPECT_EQ(rung["broken"], true);
    EXPECT_EQ(method["rungs"][0]["broken"], false);
    EXPECT_EQ(method["breaks_at"], 2.0);
    EXPECT_EQ(method["kind"], "leak");
}

/// A rung without a wrong point has null as its kind; one without figures has none.
TEST(LadderRecord, FiguresAreThereWhereTheMethodRan) {
    LadderRun run                 = run_by_hand();
    run.rungs[0].outcomes[0].kind = "";
    const LadderRecord record     = ladder_record(run);
    const Json ladder             = to_record(record);
    const Json right = ladder["methods"][0]["rungs"][0], none = ladder["methods"][1]["rungs"][0];
    EXPECT_TRUE(right.contains("kind"));
    EXPECT_TRUE(right["kind"].is_null());
    EXPECT_EQ(none, (Json{{"serves", {{"how", "not"}, {"why", "it cannot"}}}}));
    EXPECT_EQ(record.methods[1].rungs[0].points, std::nullopt);
}

/// What `read_ladders` says of a record with this ladder.
std::string message_of(const Json& ladder) {
    const TemporaryFolder folder;
    try {
        (void)read_ladders(
            folder.write("results.json", Json{{"schema", kResultsSchema}, {"ladders", Json::array({ladder})}}.dump()));
    } catch (const InputError& error) {
        const std::string message = error.what();
        return message.substr(message.find(':') + 1);
    }
    return "read";
}

TEST(LadderRecord, IsReadAsItWasWritten) {
    LaddersRecord record{.breaking_share = 0.005, .ladders = {ladder_record(run_by_hand())}};
    record.ladders[0].methods[0].first_rung_ms.emplace();
    record.ladders[0].methods[0].shown =
        BreakRecord{"a.json", "a.S.png", "a.truth.png", "a.classes.png", "sun", 40, 20, 5, 14, 720, 30};
    record.failed.push_back({.ladder = "needles", .method = "ray_traced", .failure = {.message = "out of range"}});
    const std::string text = to_record(record).dump();
    const TemporaryFolder folder;
    EXPECT_EQ(to_record(read_ladders(folder.write("results.json", text))).dump(), text);
    EXPECT_TRUE(fits(schema_of<LaddersRecord>("").dump(), text));
    EXPECT_EQ(text.find("\"rung\":"), std::string::npos) << "the whole ladder failed";
}

TEST(LadderRecord, BrokenOnesAreRefusedWithTheirPlace) {
    const Json good = to_record(ladder_record(run_by_hand()));
    EXPECT_EQ(message_of(good), "read");
    const auto changed = [&](const char* pointer, const Json& value) {
        Json bad                         = good;
        bad[Json::json_pointer(pointer)] = value;
        return message_of(bad);
    };
    EXPECT_EQ(changed("/methods/0/breaks_at", 7),
              "/ladders/0/methods/0/breaks_at: found 7, expected the value of a rung");
    EXPECT_EQ(changed("/methods/1/not_served_from", 0.5),
              "/ladders/0/methods/1/not_served_from: found 0.5, expected the value of a rung");
    EXPECT_EQ(changed("/methods/0/text", ""), "/ladders/0/methods/0/text: found \"\", expected a non-empty string");
    EXPECT_EQ(changed("/rungs/1/value", nullptr), "/ladders/0/rungs/1/value: found nothing, expected a value");
    EXPECT_EQ(changed("/rungs/1/lit", "12"), "/ladders/0/rungs/1/lit: found \"12\", expected a number");
}

/// Without presets, judged rungs and times, which earlier versions did not write.
TEST(LadderRecord, OfEarlierVersionsIsShown) {
    Json ladder = to_record(ladder_record(run_by_hand()));
    for (Json& method : ladder["methods"])
        for (const char* key : {"preset", "judged_rungs", "least_coverage"}) method.erase(key);
    ladder["methods"][0]["breaks_at"] = nullptr;
    const TemporaryFolder folder;
    const LaddersRecord record = read_ladders(
        folder.write("results.json", Json{{"schema", kResultsSchema}, {"ladders", Json::array({ladder})}}.dump()));
    const auto cells = ladder_table_view(record, "page")["rows"][0]["cells"];
    EXPECT_EQ(cells[0]["words"], "holds");
    EXPECT_EQ(cells[0]["note"], "") << "nothing is said of what is not known";
}

TEST(LadderRecord, WordsAndTableNameTheRung) {
    const LadderRecord ladder = ladder_record(run_by_hand());
    EXPECT_EQ(climb_in_words(ladder.methods[0], ladder), "2 leak");
    EXPECT_EQ(climb_in_words(ladder.methods[1], ladder), "not served");
    const auto table = ladder_table_view({.ladders = {ladder}}, "page");
    EXPECT_EQ(table["rows"][0]["cells"][0]["words"], "2");
    EXPECT_EQ(table["rows"][0]["cells"][0]["kind"], "leak");
    EXPECT_EQ(table["rows"][0]["cells"][1]["note"], "not served");
    EXPECT_EQ(table["rows"][0]["range"], "1 to 2");
}

/// Five rungs of ten: two are judged by what the first method answers, 0.8 and 0.6 of the points; on one it leaves most
/// of them open, on one it answers too few in shadow, and on one nobody is judged. Five were not climbed.
TEST(LadderRecord, HoldsSaysOfWhat) {
    LadderRun run{&find_ladder("needles"), {parse_method("shadow_zbuffer"), parse_method("ray_traced")}, {}};
    const std::size_t all = run.ladder->rungs.size();
    ASSERT_GE(all, 5u);
    struct Answered {
        std::uint64_t points, undefined, shadow;
    };
    for (const Answered a :
         {Answered{3000, 7000, 900}, {8000, 2000, 900}, {6000, 4000, 5}, {0, 0, 0}, {6000, 4000, 900}}) {
        Rung& rung = run.rungs.emplace_back();
        rung.value = double(run.rungs.size());
        rung.truth = "exact";
        if (a.points == 0) {
            rung.unjudged = "nothing is in view";
            continue;
        }
        RungOutcome part;
        part.service = {How::approximately, "by hand"};
        part.points = a.points, part.undefined = a.undefined;
        part.can_show     = {a.points, 900, a.shadow};
        RungOutcome whole = part;
        whole.points += whole.undefined, whole.undefined = 0;
        whole.can_show = {whole.points, 900, 900};
        rung.outcomes  = {part, whole};
    }
    const LadderRecord ladder = ladder_record(run);
    EXPECT_EQ(ladder.methods[0].judged_rungs, 2u);
    EXPECT_NEAR(ladder.methods[0].least_coverage.value_or(0), 0.6, 1e-12);
    EXPECT_EQ(ladder.methods[1].judged_rungs, 4u);
    EXPECT_EQ(climb_in_words(ladder.methods[0], ladder), "holds") << "words that goldens have";
    const std::string part  = fmt::format("judged on 2 of {} rungs, answers 60 % of the points or more", all),
                      whole = fmt::format("judged on 4 of {} rungs", all);
    const auto table_of     = [](const LadderRecord& one) { return ladder_table(std::span(&one, 1)); };
    const std::string text  = table_of(ladder);
    EXPECT_NE(text.find("holds (" + part + ")"), std::string::npos) << text;
    EXPECT_NE(text.find("holds (" + whole + ")"), std::string::npos) << text;
    const auto cells = ladder_table_view({.ladders = {ladder}}, "page")["rows"][0]["cells"];
    EXPECT_EQ(cells[0]["words"], "holds");
    EXPECT_EQ(cells[0]["note"], part);
    EXPECT_EQ(cells[1]["note"], whole);
    // A rung of its own, all of whose points it answers.
    run.rungs = {run.rungs.back()};
    EXPECT_NE(table_of(ladder_record(run)).find(fmt::format("holds (judged on 1 of {} rungs", all)), std::string::npos);
    LadderRecord one_rung;
    one_rung.rungs.resize(1);
    EXPECT_EQ(left_out_in_words(one_rung, {.judged_rungs = 1, .least_coverage = 1}), "");
    EXPECT_EQ(left_out_in_words(one_rung, {.judged_rungs = 1, .least_coverage = 0.5}), "answers 50 % of the points");
    EXPECT_EQ(left_out_in_words(one_rung, {.breaks_at = 0, .judged_rungs = 1, .least_coverage = 0.5}), "");
}

/// Two lights: the points of a rung are those of both.
TEST(LadderRecord, PointsAreSumsOverLights) {
    const TemporaryFolder folder;
    const auto stage     = set_stage(load_scene(folder.write("two.json", R"({
        "size": [24, 16], "camera": {"eye": [0, 3, 4], "target": [0, 0, 0]},
        "lights": [{"type": "directional", "direction": [0, -1, 0]}, {"type": "directional", "direction": [1, -1, 0]}],
        "objects": [{"type": "plane", "size": 40}]})")));
    std::uint64_t points = 0;
    for (LightId j = 0; j < 2; ++j)
        points += visibility_error(stage->points, j, stage->truth.planes[j], stage->truth.planes[j], 0.5f).points;
    EXPECT_EQ(points, 2u * 24 * 16);
    EXPECT_EQ(outcome(*stage, parse_method("shadow_volumes")).points, points);
}

}  // namespace
}  // namespace umbra
