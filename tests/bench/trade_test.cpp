// The page of sweeps: every figure where its headings say, fronts and sentences as worked out by hand, marks where
// their values are.
#include "umbra/bench/sweep/trade_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>

#include "trade_fixture.h"
#include "umbra/bench/sweep/trade_chart.h"
#include "umbra/bench/sweep/trade_findings.h"
#include "umbra/bench/sweep/trade_views.h"
#include "umbra/tests/support/html_table.h"

namespace umbra {
namespace {

using namespace report_fixture;
using other_readers::HtmlTable;

class Trade : public Report {
protected:
    void put_sweeps(const json& first, const json& second) {
        write(out / "trade/court/results.json", first.dump());
        write(out / "trade/yard/results.json", second.dump());
        write(out / "trade/results.json", json{{"schema", kResultsSchema}, {"sweeps", {"court", "yard"}}}.dump());
    }
    void SetUp() override {
        Report::SetUp();
        put_sweeps(trade_fixture::court(), trade_fixture::yard());
    }
    /// The page of both scenes, as a report writes it.
    std::string page() {
        write_report({out}, out);
        return read(out / "trade/index.html");
    }
    [[nodiscard]] SweptScene court() const { return read_swept_scene(out / "trade/court/results.json"); }
    [[nodiscard]] SweptScene yard() const { return read_swept_scene(out / "trade/yard/results.json"); }
};

/// Where the marks of a plot are, by what they say of themselves: "TEXT: COST ms, ERROR".
struct Mark {
    std::string text;
    double cost, error, x, y;
    bool beaten;
};
std::vector<Mark> marks_of(const std::string& html) {
    std::vector<Mark> marks;
    static const std::regex mark(
        "<g class=\"mark-\\d( beaten)?\"><title>([^<]*): ([0-9.]+) ms, ([0-9.]+)</title>.*<path "
        "transform=\"translate\\(([0-9.]+) ([0-9.]+)\\)");
    for (std::sregex_iterator at(html.begin(), html.end(), mark), end; at != end; ++at)
        marks.push_back({(*at)[2], std::stod((*at)[3]), std::stod((*at)[4]), std::stod((*at)[5]), std::stod((*at)[6]),
                         (*at)[1].matched});
    return marks;
}

TEST_F(Trade, TableHoldsEachFigureInItsRowAndColumn) {
    const HtmlTable table(page(), "scene-1-caption");
    const auto expect = [&](const std::string& row, const std::vector<std::string>& cells) {
        const std::vector<std::string> columns = {"Cost, ms",          "RMSE of S / Worst view",
                                                  "RMSE of S / Bound", "RMSE of S / Front",
                                                  "Memory, MiB",       "Coverage, %"};
        for (std::size_t c = 0; c < columns.size(); ++c)
            EXPECT_EQ(table.at(row, columns[c]), cells[c]) << row << columns[c];
    };
    expect("shadow_zbuffer:resolution=512 fast", {"1.20 1.14–1.32", "0.0550", "0.0660", "1", "3.00", "100"});
    expect("shadow_zbuffer", {"2.50 2.38–2.75", "0.0210", "0.0252", "2", "3.00", "100"});
    expect("shadow_zbuffer:resolution=4096", {"4.00 3.80–4.40", "0.0300", "0.0360", "", "3.00", "100"});
    expect("ray_traced", {"5.00 4.75–5.50", "0.0125", "0.0150", "3", "3.00", "100"});
    expect("ray_traced:samples=64", {"20.0 19.0–22.0", "0.00310", "0.00372", "4", "3.00", "100"});
    expect("ray_traced:samples=256", {"90.0 85.5–99.0", "0.00200", "0.00240", "", "3.00", "100"});
    expect("exact", {"62.0 58.9–68.2", "0", "0", "5", "3.00", "100"});
    expect("planar_projection it leaves 40 % of the points undefined",
           {"0.500 0.475–0.550", "0", "0", "", "3.00", "60"});
    expect("shadow_volumes failed: out of patience", {"–", "–", "–", "", "3.00", "100"});
    expect("shadow_zbuffer:resolution=8192 it was not timed", {"–", "0.0150", "0.0180", "", "3.00", "100"});
}

TEST_F(Trade, RowsAreInTheOrderOfTheirCosts) {
    // Behind each word of a setting a narrow page may break it.
    EXPECT_TRUE(contains(page(), "<code>shadow_<wbr>zbuffer:<wbr>resolution=<wbr>512</code>"));
    const std::string html = std::regex_replace(page(), std::regex("<wbr>"), "");
    std::size_t last       = html.find("id=\"scene-1-caption\"");
    for (const char* text :
         {"planar_projection", "shadow_zbuffer:resolution=512", "shadow_zbuffer", "shadow_zbuffer:resolution=4096",
          "ray_traced", "ray_traced:samples=64", "exact", "ray_traced:samples=256", "shadow_volumes"}) {
        const std::size_t at = html.find(fmt::format("<code>{}</code>", text), last);
        ASSERT_NE(at, std::string::npos) << text;
        last = at;
    }
}

TEST_F(Trade, FrontsLeaveOutWhatIsBeatenNotTimedOrAnswersForTooFewPoints) {
    const auto texts = [](const SweptScene& scene) {
        std::vector<std::string> all;
        for (const std::size_t i : front_of(scene, 0)) all.push_back(scene.settings[i].text);
        return all;
    };
    EXPECT_EQ(texts(court()), (std::vector<std::string>{"shadow_zbuffer:resolution=512", "shadow_zbuffer", "ray_traced",
                                                        "ray_traced:samples=64", "exact"}));
    EXPECT_EQ(texts(yard()), (std::vector<std::string>{"ray_traced", "shadow_zbuffer", "exact"}));
}

TEST_F(Trade, OneSentenceAScene) {
    EXPECT_EQ(staircase_in_words(court(), 0),
              "Cheapest down to an error of 0.0210: The shadow_zbuffer; below that down to 0.00310: The ray_traced; "
              "exactly 0: The exact, at 3.10 times the cost of the step before.");
    const std::string other =
        "Cheapest down to an error of 0.0200: The ray_traced; below that down to 0.0100: The shadow_zbuffer; exactly "
        "0: The exact, at 4.00 times the cost of the step before.";
    EXPECT_EQ(staircase_in_words(yard(), 0), other);
    const std::string html = page();
    EXPECT_TRUE(
        contains(html, "<div><dt><a href=\"#scene-2\">The yard</a></dt><dd>RMSE of S: " + other + "</dd></div>"));
    EXPECT_TRUE(contains(html, "The camera moves 10 times a second, a light once a second, an object never."));
    EXPECT_TRUE(contains(html, "less than 4 % are not distinguishable"));
    EXPECT_TRUE(contains(
        read(out / "index.html"),
        "<div><dt><a href=\"trade/index.html#scene-2\">The yard</a></dt><dd>RMSE of S: " + other + "</dd></div>"))
        << "of which error it speaks";
}

TEST_F(Trade, SentencesWhereThereIsNoStaircase) {
    json one = trade_fixture::scene(
        "one", {trade_fixture::setting("exact", 0, 8, {0, 0}), trade_fixture::setting("ray_traced", 0, 9, {0.1, 0.1})});
    write(folder / "one.json", one.dump());
    EXPECT_EQ(staircase_in_words(read_swept_scene(folder / "one.json"), 0),
              "The exact (defaults) is the cheapest and its error is exactly 0.");
    one["sweep"]["settings"].erase(0);
    write(folder / "one.json", one.dump());
    EXPECT_EQ(staircase_in_words(read_swept_scene(folder / "one.json"), 0),
              "Cheapest down to an error of 0.100: The ray_traced; no setting has a smaller error.");
    one["sweep"]["settings"][0]["cost_ms"] = nullptr;
    write(folder / "one.json", one.dump());
    EXPECT_EQ(staircase_in_words(read_swept_scene(folder / "one.json"), 0), "No setting was both timed and compared.");
}

TEST_F(Trade, AtFixedErrors) {
    const HtmlTable table(page(), "fixed-caption");
    struct Row {
        const char *name, *zbuffer, *rays, *exact;
    };
    // court: 1.2, 2.5 or 20 is the least cost; yard: 1, 2 or 8.
    for (const Row& row :
         {Row{"The court / 0.1", "1.00 resolution=5121.20 ms", "4.17 defaults5.00 ms", "51.7 defaults62.0 ms"},
          {"The court / 0.03", "1.00 defaults2.50 ms", "2.00 defaults5.00 ms", "24.8 defaults62.0 ms"},
          {"The court / 0.01", "–", "1.00 samples=6420.0 ms", "3.10 defaults62.0 ms"},
          {"The court / 0.003", "–", "1.45 samples=25690.0 ms", "1.00 defaults62.0 ms"},
          {"The court / exactly 0", "–", "–", "1.00 defaults62.0 ms"},
          {"The yard / 0.1", "2.00 defaults2.00 ms", "1.00 defaults1.00 ms", "8.00 defaults8.00 ms"},
          {"The yard / 0.01", "1.00 defaults2.00 ms", "–", "4.00 defaults8.00 ms"},
          {"Geometric mean over scenes / 0.1", "1.41 2 of 2 scenes", "2.04 2 of 2 scenes", "20.3 2 of 2 scenes"},
          {"Geometric mean over scenes / 0.01", "1.00 1 of 2 scenes", "1.00 1 of 2 scenes", "3.52 2 of 2 scenes"}}) {
        EXPECT_EQ(table.at(row.name, "The shadow_zbuffer"), row.zbuffer) << row.name;
        EXPECT_EQ(table.at(row.name, "The ray_traced"), row.rays) << row.name;
        EXPECT_EQ(table.at(row.name, "The exact"), row.exact) << row.name;
        // It is within every error of the court, but answers for 60 % of the points; it was not run in the yard.
        EXPECT_EQ(table.at(row.name, "The planar_projection"),
                  std::string(row.name).starts_with("The court") ? "– covers 60 %" : "–")
            << row.name;
    }
}

TEST_F(Trade, MethodsThatWereTimedOnMoreScenesStandFirst) {
    std::vector<std::string> names;
    for (const SweptMethod& method : swept_methods({court(), yard()})) names.push_back(method.name);
    // Two scenes each; one; none, since it failed.
    EXPECT_EQ(names, (std::vector<std::string>{"shadow_zbuffer", "ray_traced", "exact", "planar_projection",
                                               "shadow_volumes"}));
}

/// 2, 2.3 and 2.5 ms at a noise bar of 20 %: the second costs what the first does, the third what the second does.
TEST_F(Trade, SentencesNameWhatNoiseDoesNotTellApart) {
    json noisy         = trade_fixture::scene("yard", {trade_fixture::setting("shadow_zbuffer", 0, 2, {0.01, 0.01}),
                                                       trade_fixture::setting("ray_traced", 0, 2.3, {0.005, 0.005}),
                                                       trade_fixture::setting("exact", 0, 2.5, {0, 0})});
    const auto finding = [&](const json& noise_bar) {
        noisy["sweep"]["turns"]["noise_bar"] = noise_bar;
        write(folder / "one.json", noisy.dump());
        return staircase_in_words(read_swept_scene(folder / "one.json"), 0);
    };
    EXPECT_EQ(finding(0.2),
              "Cheapest down to an error of 0.0100: The shadow_zbuffer (as cheap, as far as noise tells: The "
              "ray_traced); below that down to 0.00500: The ray_traced (as cheap, as far as noise tells: The exact); "
              "exactly 0: The exact, at a cost that noise does not tell from that of the step before.");
    EXPECT_EQ(finding(0.02),
              "Cheapest down to an error of 0.0100: The shadow_zbuffer; below that down to 0.00500: The ray_traced; "
              "exactly 0: The exact, at 1.09 times the cost of the step before.");
    const std::string not_ranked =
        "Not ranked: times vary by more than 30 %, or are of fewer than six rounds: too much to say which setting is the "
        "cheapest.";
    EXPECT_EQ(finding(0.4), not_ranked);
    EXPECT_EQ(finding(nullptr), not_ranked) << "of too few rounds to know the noise";
    // Two without an error.
    noisy["sweep"]["settings"][1]["views"][0]["metrics"]["rmse"] = 0;
    noisy["sweep"]["settings"][1]["views"][1]["metrics"]["rmse"] = 0;
    noisy["sweep"]["settings"].erase(0);
    EXPECT_EQ(finding(0.1),
              "The ray_traced (defaults) (as cheap, as far as noise tells: The exact) is the cheapest and its error is "
              "exactly 0.");
    EXPECT_EQ(finding(0.08), "The ray_traced (defaults) is the cheapest and its error is exactly 0.");
}

TEST_F(Trade, LoudScenesHaveNeitherFrontNorStaircase) {
    json loud                           = trade_fixture::yard();
    loud["sweep"]["turns"]["noise_bar"] = 22.14;
    put_sweeps(trade_fixture::court(), loud);
    const std::string html = page(), second = html.substr(html.find("id=\"scene-2\""));
    EXPECT_TRUE(contains(second, "Not ranked: times vary by more than 30 %"));
    EXPECT_TRUE(contains(second, "less than 2214 % are not distinguishable on this machine. Sweep it again"));
    EXPECT_TRUE(contains(second, "<path class=\"staircase\" d=\"\"/>"));
    EXPECT_FALSE(contains(second, "cheapest\">"));
    EXPECT_FALSE(contains(second, " times the cost"));
    const std::vector<Mark> marks = marks_of(second);
    EXPECT_EQ(marks.size(), 3u);
    for (const Mark& m : marks) EXPECT_FALSE(m.beaten) << m.text;
    EXPECT_EQ(HtmlTable(html, "scene-2-caption").at("ray_traced", "RMSE of S / Front"), "");
    EXPECT_TRUE(contains(read(out / "index.html"), "<dd>RMSE of S: Not ranked"));
    EXPECT_FALSE(contains(html.substr(0, html.find("id=\"scene-2\"")), "Sweep it again"));
}

/// What is missing altogether is off by the reach or more.
TEST_F(Trade, FiguresThatMayBeLargerSaySo) {
    json torn                                            = trade_fixture::yard();
    torn["sweep"]["settings"][1]["views"][1]["at_least"] = {"rmse"};
    torn["sweep"]["settings"][0]["views"][1]["at_least"] = {"flip"};
    put_sweeps(trade_fixture::court(), torn);
    const std::string html = page();
    const HtmlTable table(html, "scene-2-caption");
    EXPECT_EQ(table.at("ray_traced", "RMSE of S / Worst view"), "≥ 0.0200");
    EXPECT_EQ(table.at("shadow_zbuffer", "RMSE of S / Worst view"), "0.0100");
    EXPECT_TRUE(contains(html,
                         "Cheapest down to an error of at least 0.0200: The ray_traced; below that down to "
                         "0.0100: The shadow_zbuffer;"));
    EXPECT_TRUE(contains(html, "<code>defaults</code>: ≥ 0.0200 at 1.00 ms"));
}

/// At a noise bar of 20 % 2.5 and 2.4 ms are the same cost; at 40 % the costs of a scene say nothing.
TEST_F(Trade, NothingIsRankedBelowTheNoise) {
    const auto fixed = [&](double noise_bar, double rays_ms) {
        json quiet = trade_fixture::scene("court", {trade_fixture::setting("shadow_zbuffer", 0, 2, {0.01, 0.01}),
                                                    trade_fixture::setting("ray_traced", 0, 5, {0.01, 0.01})});
        json noisy = trade_fixture::scene("yard", {trade_fixture::setting("shadow_zbuffer", 0, 2.4, {0.01, 0.01}),
                                                   trade_fixture::setting("ray_traced", 0, rays_ms, {0.01, 0.01})});
        noisy["sweep"]["turns"]["noise_bar"] = noise_bar;
        write(folder / "one.json", quiet.dump());
        write(folder / "two.json", noisy.dump());
        const std::vector<SweptScene> scenes{read_swept_scene(folder / "one.json"),
                                             read_swept_scene(folder / "two.json")};
        return fixed_errors_view(scenes, swept_methods(scenes));
    };
    const auto best = [](const json& view, std::size_t scene, std::size_t method) {
        return view["groups"][scene]["rows"][0]["cells"][method]["best"].get<bool>();
    };
    const json quiet = fixed(0.2, 2.5);
    ASSERT_EQ(quiet["groups"].size(), 2u);
    EXPECT_TRUE(best(quiet, 0, 0));
    EXPECT_FALSE(best(quiet, 0, 1));
    EXPECT_TRUE(best(quiet, 1, 0));
    EXPECT_TRUE(best(quiet, 1, 1)) << "4 % dearer, at a bar of 20 %";
    EXPECT_FALSE(best(fixed(0.02, 2.5), 1, 1));
    EXPECT_EQ(quiet["loud"], "");
    const json loud = fixed(0.4, 2.5);
    ASSERT_EQ(loud["groups"].size(), 1u);
    EXPECT_EQ(loud["groups"][0]["scene"], "The court");
    EXPECT_EQ(loud["loud"], "The yard");
}

TEST_F(Trade, MarksAreWhereTheirFiguresAre) {
    const std::string html        = page();
    const std::string first       = html.substr(0, html.find("id=\"scene-2\""));
    const std::vector<Mark> marks = marks_of(first);
    ASSERT_EQ(marks.size(), 7u);
    const auto named = [&](const std::string& text) {
        return *std::find_if(marks.begin(), marks.end(), [&](const Mark& m) { return m.text == text; });
    };
    // A decade of the cost and of the error, from two marks each; all others follow.
    const Mark fast = named("shadow_zbuffer:resolution=512"), rays = named("ray_traced:samples=64");
    const double decade_x = (rays.x - fast.x) / std::log10(20 / 1.2);
    const double decade_y = (rays.y - fast.y) / std::log10(0.055 / 0.0031);
    EXPECT_GT(decade_x, 50);
    EXPECT_GT(decade_y, 50);
    double lane = 0;
    for (const Mark& m : marks) {
        EXPECT_NEAR(m.x, fast.x + decade_x * std::log10(m.cost / 1.2), 0.3) << m.text;
        if (m.error > 0) {
            EXPECT_NEAR(m.y, fast.y + decade_y * std::log10(0.055 / m.error), 0.3) << m.text;
            lane = std::max(lane, m.y);
        }
    }
    EXPECT_GT(named("exact").y, lane + 5) << "without error: below the axis";
    for (const Mark& m : marks)
        EXPECT_EQ(m.beaten, m.text == "shadow_zbuffer:resolution=4096" || m.text == "ray_traced:samples=256") << m.text;
    // The staircase: down at the cost of a setting, across at its error to the cost of the next.
    const auto xy = [&](const char* text) { return std::pair{named(text).x, named(text).y}; };
    std::string path;
    for (const auto& [x, y] : {xy("shadow_zbuffer:resolution=512"), xy("shadow_zbuffer"), xy("ray_traced"),
                               xy("ray_traced:samples=64"), xy("exact")})
        path += path.empty() ? fmt::format("M{:.1f} 14.0V{:.1f}", x, y) : fmt::format("H{:.1f}V{:.1f}", x, y);
    EXPECT_TRUE(contains(first, fmt::format("<path class=\"staircase\" d=\"{}H430.0\"/>", path)));
    // The ticks say the same as the marks: 10 ms, 0.01.
    std::smatch tick;
    ASSERT_TRUE(
        std::regex_search(first, tick, std::regex("x=\"([0-9.]+)\" y=\"[0-9.]+\" text-anchor=\"middle\">10</text>")));
    EXPECT_NEAR(std::stod(tick[1]), fast.x + decade_x * std::log10(10 / 1.2), 0.3);
}

TEST_F(Trade, LinesThroughAMarkAreItsIntervals) {
    const json chart = pareto_chart(
        {{"a", {10, 1, 100}, {0.01, 0.1, 1.0}, 0, 1}, {"b", {1000, 1000, 1000}, {0.001, 0.001, {}}, 1, 2}});
    const auto at = [&](std::size_t mark, const char* key) {
        return std::stod(chart["marks"][mark][key].get<std::string>());
    };
    const double decade_x = at(0, "x_high") - at(0, "x"), decade_y = at(0, "y") - at(0, "y_high");
    EXPECT_GT(decade_x, 20);
    EXPECT_GT(decade_y, 20);
    EXPECT_NEAR(at(0, "x") - at(0, "x_low"), decade_x, 0.2);
    EXPECT_NEAR(at(0, "y_low") - at(0, "y"), decade_y, 0.2);
    EXPECT_NEAR(at(1, "x") - at(0, "x"), 2 * decade_x, 0.2);
    EXPECT_EQ(chart["marks"][1]["y_low"], chart["marks"][1]["y_high"]) << "no bound, one value";
}

TEST_F(Trade, LabelsOfTheFrontCoverNeitherMarksNorEachOther) {
    std::vector<ParetoPoint> points;
    for (int i = 0; i < 24; ++i) {
        const double cost = std::pow(10, 0.1 * i), error = std::pow(10, -0.1 * i);
        points.push_back({"", {cost, cost, cost}, {error, error, {}}, std::size_t(i % 3), std::size_t(i + 1)});
    }
    const json chart = pareto_chart(points);
    std::vector<std::array<double, 4>> labels;
    for (const json& m : chart["marks"]) {
        if (m["label_x"].get<std::string>().empty()) continue;
        const double x = std::stod(m["label_x"].get<std::string>()), y = std::stod(m["label_y"].get<std::string>());
        labels.push_back({x, y - 9, x + 6.1 * double(m["front"].get<std::string>().size()), y + 3});
    }
    EXPECT_GE(labels.size(), 20u);
    const auto apart = [](const std::array<double, 4>& a, const std::array<double, 4>& b) {
        return a[2] <= b[0] + 0.1 || b[2] <= a[0] + 0.1 || a[3] <= b[1] + 0.1 || b[3] <= a[1] + 0.1;
    };
    for (std::size_t i = 0; i < labels.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) EXPECT_TRUE(apart(labels[i], labels[j])) << i << " " << j;
        for (const json& m : chart["marks"]) {
            const double x = std::stod(m["x"].get<std::string>()), y = std::stod(m["y"].get<std::string>());
            EXPECT_TRUE(apart(labels[i], {x - 6, y - 6, x + 6, y + 6})) << i << " " << m["front"];
        }
    }
}

/// 12 problems: the z-buffer and the rays are the cheapest at 3 each, exact at 6, and exact solves all.
TEST_F(Trade, ProfileBeginsWithHowOftenAMethodIsTheCheapest) {
    const std::string html = page();
    EXPECT_TRUE(contains(html, "over 12 problems"));
    const std::string chart = html.substr(html.find("id=\"profile-title\""));
    const auto tick         = [&](const char* label) {
        std::smatch found;
        std::regex_search(chart, found,
                                  std::regex(fmt::format("y=\"([0-9.]+)\" dy=\"4\" text-anchor=\"end\">{}</text>", label)));
        return std::stod(found[1]);
    };
    const std::regex line("<path class=\"line\" d=\"M76.0 ([0-9.]+)(?:H[0-9.]+V([0-9.]+))*H430.0\"/>");
    std::vector<std::pair<double, double>> ends;
    for (std::sregex_iterator at(chart.begin(), chart.end(), line), end; at != end; ++at)
        ends.emplace_back(std::stod((*at)[1]), std::stod((*at)[2]));
    ASSERT_EQ(ends.size(), 3u) << "planar projection and shadow volumes solve none";
    EXPECT_NEAR(ends[0].first, tick("25 %"), 0.1);
    EXPECT_NEAR(ends[1].first, tick("25 %"), 0.1);
    EXPECT_NEAR(ends[2].first, tick("50 %"), 0.1);
    EXPECT_NEAR(ends[2].second, tick("100 %"), 0.1);
    // The z-buffer has a setting within 5 of 12; the rays have one within 6.
    EXPECT_NEAR(ends[0].second, tick("0 %") + (tick("100 %") - tick("0 %")) * 5 / 12, 0.1);
    EXPECT_NEAR(ends[1].second, tick("0 %") + (tick("100 %") - tick("0 %")) * 6 / 12, 0.1);
}

TEST_F(Trade, OtherMetricsHavePlotsOfTheirOwn) {
    json results                = trade_fixture::court();
    results["sweep"]["metrics"] = {{{"name", "flip"}, {"unit", ""}, {"doc", "F."}},
                                   {{"name", "rmse"}, {"unit", ""}, {"doc", "R."}},
                                   {{"name", "psnr"}, {"unit", "dB"}, {"doc", "P."}}};
    for (json& s : results["sweep"]["settings"])
        for (json& view : s["views"]) view["metrics"]["flip"] = 0.5;
    put_sweeps(results, trade_fixture::yard());
    const std::string html = page();
    const HtmlTable table(html, "scene-1-caption");
    EXPECT_EQ(table.at("exact", "FLIP of the picture, mean / Worst view"), "0.500");
    EXPECT_EQ(table.at("exact", "FLIP of the picture, mean / Bound"), "–");
    EXPECT_EQ(table.at("shadow_zbuffer:resolution=512 fast", "FLIP of the picture, mean / Front"), "1");
    EXPECT_EQ(table.at("exact", "RMSE of S / Front"), "5");
    EXPECT_FALSE(contains(html, "psnr"));
}

TEST_F(Trade, PageHoldsNamesAsText) {
    json results                            = trade_fixture::court();
    results["scene"]["title"]               = "<script>alert(1)</script>";
    results["sweep"]["settings"][3]["text"] = "shadow_zbuffer:<b>&\"";
    put_sweeps(results, trade_fixture::yard());
    const std::string html = page();
    EXPECT_FALSE(contains(html, "<script>alert"));
    EXPECT_FALSE(contains(html, "<b>&"));
    EXPECT_TRUE(contains(html, "&lt;script&gt;alert(1)"));
    EXPECT_FALSE(contains(html, "{{"));
    EXPECT_FALSE(contains(html, "/somewhere"));
}

TEST_F(Trade, LinksLeadToFilesThatCanBeHandedOut) {
    (void)page();
    EXPECT_TRUE(links_hold(out / "index.html"));
    EXPECT_TRUE(links_hold(out / "trade/index.html"));
    // Swept elsewhere: the report's folder gets copies.
    write_report({out / "trade"}, folder / "other");
    EXPECT_TRUE(links_hold(folder / "other/trade/index.html"));
    fs::remove_all(out);
    EXPECT_TRUE(links_hold(folder / "other/index.html"));
    EXPECT_TRUE(links_hold(folder / "other/trade/index.html"));
    const std::string html = read(folder / "other/trade/index.html");
    EXPECT_TRUE(contains(html, "<a href=\"../index.html\">Report</a>"));
}

TEST_F(Trade, RefusesWhatIsNoSweep) {
    const auto refused = [&](const json& results, const std::string& part) {
        write(folder / "bad.json", results.dump());
        try {
            (void)read_swept_scene(folder / "bad.json");
            ADD_FAILURE() << "not refused: " << part;
        } catch (const InputError& error) {
            EXPECT_TRUE(contains(error.what(), part)) << error.what();
        }
    };
    json results                                                   = trade_fixture::yard();
    results["sweep"]["settings"][0]["views"][1]["metrics"]["rmse"] = -0.1;
    refused(results, "/sweep/settings/0/views/1/metrics/rmse: found -0.1, expected at least 0");
    results                                    = trade_fixture::yard();
    results["sweep"]["settings"][2]["cost_ms"] = "cheap";
    refused(results, "/sweep/settings/2/cost_ms: found \"cheap\", expected a number");
    results                      = trade_fixture::yard();
    results["sweep"]["workload"] = {{"camera", 0}, {"light", 0}, {"object", 0}};
    refused(results, "/sweep/workload: found an object, expected something that moves");
    results.erase("sweep");
    refused(results, "/sweep: found nothing, expected a value");
}

}  // namespace
}  // namespace umbra
