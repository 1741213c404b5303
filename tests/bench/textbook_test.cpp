// Textbook forms beside default forms: which breaks earlier, on ladders made by hand, and what `umbra ladder` records.
#include "umbra/bench/ladders/textbook_view.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <optional>
#include <set>

#include "umbra/bench/cli/ladder_command.h"
#include "umbra/bench/ladders/ladder_page.h"
#include "umbra/core/base/error.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/html_table.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

using other_readers::HtmlTable;

/// A method on a ladder; `at` are rungs, 0: none.
ClimbRecord method(const std::string& name, bool textbook, int breaks_at, int silent_from = 0,
                   const std::vector<double>& ms = {}) {
    const auto rung = [](int r) { return r == 0 ? std::nullopt : std::optional<double>(r); };
    return {.name          = name,
            .title         = "The " + name,
            .text          = textbook ? name + ":k=v" : name,
            .preset        = textbook ? "textbook" : "default",
            .breaks_at     = rung(breaks_at),
            .kind          = breaks_at ? std::optional<std::string>("leak") : std::nullopt,
            .silent_from   = rung(silent_from),
            .first_rung_ms = ms};
}

/// Rungs 1, 2, 3, 4.
LadderRecord ladder(const std::string& name, const std::vector<ClimbRecord>& methods) {
    LadderRecord l{{name, "Ladder " + name, "", "metres"}, {}, 0, methods};
    for (const double r : {1, 2, 3, 4}) {
        Rung& rung    = l.rungs.emplace_back();
        rung.value    = r;
        rung.truth    = "exact";
        rung.can_show = {200, 100, 100};
    }
    return l;
}

LaddersRecord record(const std::vector<LadderRecord>& ladders) { return {.breaking_share = 0.005, .ladders = ladders}; }

class TextbookForms : public testing::Test {
protected:
    TemporaryFolder folder;
};

TEST_F(TextbookForms, BreakEarlierLaterAtTheSameRungOrCannotBeCompared) {
    struct Case {
        int textbook, textbook_silent, by_default, default_silent;
        Textbook outcome;
        int rungs;
    };
    for (const Case& c : {Case{2, 0, 4, 0, Textbook::earlier, 2}, Case{2, 0, 0, 0, Textbook::earlier, 3},
                          Case{4, 0, 3, 0, Textbook::later, -1}, Case{0, 0, 1, 0, Textbook::later, -4},
                          Case{3, 0, 3, 0, Textbook::same, 0}, Case{0, 0, 0, 0, Textbook::same, 0},
                          Case{0, 2, 0, 4, Textbook::same, 0}, Case{3, 0, 0, 3, Textbook::not_compared, 0},
                          Case{3, 0, 0, 4, Textbook::earlier, 2}, Case{0, 2, 3, 0, Textbook::not_compared, 0}}) {
        const LadderRecord l                    = ladder("a", {method("m", false, c.by_default, c.default_silent),
                                                               method("m", true, c.textbook, c.textbook_silent)});
        const std::vector<ClimbRecord>& methods = l.methods;
        EXPECT_FALSE(is_textbook_twin(l, methods[0]));
        EXPECT_TRUE(is_textbook_twin(l, methods[1]));
        const TextbookClimb climb = compare_with_textbook(l, methods[1], methods[0]);
        EXPECT_EQ(climb.outcome, c.outcome) << c.textbook << " " << c.by_default;
        EXPECT_EQ(climb.rungs, c.rungs) << c.textbook << " " << c.by_default;
    }
}

TEST_F(TextbookForms, TablesOfThePage) {
    const LaddersRecord all =
        record({ladder("a", {method("m", false, 0, 0, {3, 30, 3.3}), method("m", true, 2, 0, {2, 20, 2.2}),
                             method("n", false, 1), method("n", true, 3)}),
                ladder("b", {method("m", false, 4, 0, {5, 5, 5}), method("m", true, 3, 0, {2, 2, 2}),
                             method("n", false, 0), method("n", true, 0)}),
                ladder("c", {method("m", false, 2), method("m", true, 2)})});
    (void)folder.write("results.json", to_record(all).dump());
    write_ladder_page(folder.path());
    std::ifstream in(folder.path() / "index.html");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    const HtmlTable times(page, "textbook-times-caption"), rungs(page, "textbook-caption");
    EXPECT_EQ(times.at("The m", "Textbook form"), "k=v");
    EXPECT_EQ(times.at("The m", "Ladders"), "3");
    EXPECT_EQ(times.at("The m", "Breaks earlier"), "2");
    EXPECT_EQ(times.at("The m", "Breaks later"), "0");
    EXPECT_EQ(times.at("The m", "Time, default / textbook"), "2.00 1.50–2.50");
    EXPECT_EQ(times.at("The n", "Ladders"), "2");
    EXPECT_EQ(times.at("The n", "Breaks earlier"), "0");
    EXPECT_EQ(times.at("The n", "Breaks later"), "1");
    EXPECT_EQ(times.at("The n", "Time, default / textbook"), "–");
    EXPECT_EQ(rungs.at("Ladder ametres", "The m / Textbook"), "2leak");
    EXPECT_EQ(rungs.at("Ladder ametres", "The m / Default"), "holds");
    EXPECT_EQ(rungs.at("Ladder ametres", "The m / Gain"), "+3 rungs");
    EXPECT_EQ(rungs.at("Ladder ametres", "The n / Textbook"), "3leak");
    EXPECT_EQ(rungs.at("Ladder ametres", "The n / Default"), "1leak");
    EXPECT_EQ(rungs.at("Ladder ametres", "The n / Gain"), "−2 rungs");
    EXPECT_EQ(rungs.at("Ladder bmetres", "The m / Gain"), "+1 rung");
    EXPECT_EQ(rungs.at("Ladder bmetres", "The n / Gain"), "");
    EXPECT_EQ(rungs.at("Ladder cmetres", "The m / Gain"), "no row Ladder cmetres") << "nothing differs";
    EXPECT_NE(
        page.find("Of 5 climbs (a method on a ladder) the textbook form breaks at an earlier rung than the default "
                  "form on 2, at a later one on 1."),
        std::string::npos);
    EXPECT_NE(page.find("<td class=\"first wrong\">2<small>leak</small>"), std::string::npos);
    // The table of all ladders has the default forms.
    EXPECT_EQ(HtmlTable(page, "ladders-caption").at("Ladder a", "The m"), "holds");
    EXPECT_EQ(HtmlTable(page, "ladders-caption").at("Ladder a", "The m, textbook"), "no column The m, textbook");
}

TEST_F(TextbookForms, NothingIsShownWhereOneFormWasClimbed) {
    EXPECT_FALSE(textbook_view(record({ladder("a", {method("m", true, 2)})}), "").is_object());
    EXPECT_FALSE(textbook_view(record({ladder("a", {method("m", false, 2)})}), "").is_object());
}

TEST_F(TextbookForms, AreClimbedAndTimedByDefault) {
    LadderOptions options;
    options.names            = {"duplicate_faces"};
    options.out              = folder.path() / "out";
    options.only_by_default  = true;
    const LaddersRecord done = climb_ladders(options);
    std::size_t textbook = 0, by_default = 0;
    for (const ClimbRecord& m : done.ladders[0].methods) {
        (m.preset == "textbook" ? textbook : by_default)++;
        EXPECT_EQ(parse_method(m.name + "@" + m.preset.value_or("")).text(), m.text);
        const std::vector<double> times = m.first_rung_ms.value_or(std::vector<double>());
        EXPECT_FALSE(times.empty()) << m.text;
        for (const double ms : times) EXPECT_GT(ms, 0);
    }
    EXPECT_EQ(by_default, 4u);
    EXPECT_EQ(textbook, 4u);
}

/// Without the report's choice, also the methods that reports show on some scenes alone.
TEST_F(TextbookForms, AllThatReportsShowClimb) {
    LadderOptions options;
    options.names            = {"gap"};
    options.out              = folder.path() / "out";
    const LaddersRecord done = climb_ladders(options);
    std::set<std::string> climbed, shown;
    for (const ClimbRecord& m : done.ladders[0].methods) climbed.insert(m.name);
    for (const MethodInfo* info : methods())
        if (info->is_shown() && !info->reference) shown.emplace(info->name);
    EXPECT_EQ(climbed, shown);
    EXPECT_TRUE(climbed.contains("scan_line"));
}

TEST_F(TextbookForms, OneSceneShowsWhereAFormBreaks) {
    LadderOptions options;
    options.names            = {"sliver_occluder", "disk_near_receiver"};
    options.methods          = {"planar_projection", "planar_projection@textbook"};
    options.out              = folder.path() / "out";
    const LaddersRecord done = climb_ladders(options);
    EXPECT_FALSE(done.ladders[0].methods[1].shown.has_value());
    EXPECT_FALSE(done.ladders[1].methods[0].breaks_at.has_value());
    const std::optional<BreakRecord>& textbook = done.ladders[1].methods[1].shown;
    ASSERT_TRUE(textbook.has_value()) << done.ladders[1].methods[1].breaks_at.value_or(0);
    for (const std::string& file : {textbook->scene, textbook->visibility, textbook->truth, textbook->classes})
        EXPECT_TRUE(std::filesystem::exists(options.out / "breaks" / file));
    std::ifstream in(options.out / "index.html");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    EXPECT_NE(page.find("<b>Planar projection, textbook</b> at 0.1 scene sizes above the floor: penumbra"),
              std::string::npos);
}

}  // namespace
}  // namespace umbra
