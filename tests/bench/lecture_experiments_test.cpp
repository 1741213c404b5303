// The experiments of the lectures: what is measured along a line of each picture is what the topic's formula says.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "umbra/bench/base/files.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/report/formula.h"
#include "umbra/bench/report/lecture_experiments.h"
#include "umbra/bench/report/lecture_shows.h"
#include "umbra/bench/report/report.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

ExperimentRecord run(const std::string& id, const json& experiment, const TemporaryFolder& folder) {
    return run_experiment(id, experiment, lecture_experiments()["base"], folder.path(), UMBRA_SCENES);
}

std::vector<std::string> ids_of_experiments() {
    std::vector<std::string> ids;
    for (const auto& [id, experiment] : lecture_experiments()["experiments"].items()) ids.push_back(id);
    return ids;
}

class EveryExperiment : public testing::TestWithParam<std::string> {};

TEST_P(EveryExperiment, IsWhatItsFormulaSays) {
    const TemporaryFolder folder;
    const json& experiment        = lecture_experiments()["experiments"][GetParam()];
    const ExperimentRecord record = run(GetParam(), experiment, folder);
    for (const ExperimentPicture& picture : record.pictures) {
        EXPECT_TRUE(fs::exists(folder.path() / picture.file.name)) << picture.name;
        EXPECT_TRUE(fs::exists(folder.path() / picture.scene.name)) << picture.name;
    }
    for (const ExperimentCurve& curve : record.curves) {
        ASSERT_EQ(curve.x.size(), curve.formula.size()) << curve.name;
        const auto known = std::ranges::count_if(curve.formula, [](double value) { return std::isfinite(value); });
        EXPECT_GT(known, 0.7 * static_cast<double>(curve.formula.size())) << curve.name << " leaves most open";
        if (curve.measured.empty()) continue;
        ASSERT_EQ(curve.x.size(), curve.measured.size()) << curve.name;
        ASSERT_TRUE(curve.deviation) << curve.name << ": no pixel is judged";
        EXPECT_LT(*curve.deviation, *curve.limit) << curve.name;
        for (std::size_t k = 0; HasFailure() && k < curve.x.size(); ++k)
            if (std::abs(curve.measured[k] - curve.formula[k]) >= *curve.limit)
                ADD_FAILURE() << curve.name << " at " << curve.x[k] << ": measured " << curve.measured[k]
                              << ", expected " << curve.formula[k];
    }
    // A formula that is wrong by a twentieth, or its opposite where it is 0 or 1, is seen.
    json planted = experiment;
    for (json& variant : planted["variants"])
        if (variant.contains("formula"))
            variant["formula"] = "1.05 * (" + variant["formula"].get<std::string>() + ") + 0.05 * (0 > (" +
                                 variant["formula"].get<std::string>() + ") - 0.01)";
    for (const ExperimentCurve& curve : run(GetParam(), planted, folder).curves)
        if (curve.deviation && *curve.limit < 0.03) {
            EXPECT_GT(*curve.deviation, *curve.limit) << curve.name;
        }
}

INSTANTIATE_TEST_SUITE_P(Lectures, EveryExperiment, testing::ValuesIn(ids_of_experiments()),
                         [](const auto& test) { return test.param; });

/// A formula that is wrong in one place: the deviation is above the limit, so that the test above and the page show it.
TEST(LectureExperiments, PlantedFormulasAreSeen) {
    const TemporaryFolder folder;
    for (const auto& [id, right, wrong] : {std::array{"A3", "h / sqrt(h^2 + x^2)^3", "h / sqrt(h^2 + x^2)^2"},
                                           {"A5", "(c^4 - t)", "(c^2 - t)"},
                                           {"A9", "min(1, 1 / d^2)", "1 / d^2"},
                                           {"B3", "0.8 * h^20", "0.8 * c^20"},
                                           {"C7", "f = exp(-0.2 * d)", "f = exp(-0.2 * t)"},
                                           {"D8", "1.5 - 2 * x", "1.5 - x"},
                                           {"D12", "0.2 + 0.7 * S * c", "0.2 * S + 0.7 * S * c"}}) {
        std::string text = lecture_experiments()["experiments"][id].dump();
        const auto at    = text.find(right);
        ASSERT_NE(at, std::string::npos) << id;
        const auto curves =
            run(id, json::parse(text.replace(at, std::string_view(right).size(), wrong)), folder).curves;
        EXPECT_TRUE(std::ranges::any_of(curves, [](const ExperimentCurve& c) { return c.deviation > c.limit; })) << id;
    }
}

TEST(LectureExperiments, WhatIsNoNumberIsNotRight) {
    const TemporaryFolder folder;
    json experiment     = lecture_experiments()["experiments"]["A9"];
    experiment["value"] = "if(i > 100, 0 / 0, R)";
    EXPECT_GT(run("A9", experiment, folder).curves.at(0).deviation, 1e300);
    experiment["value"] = "R", experiment["formula"] = "0 / 0";
    for (json& variant : experiment["variants"]) variant.erase("formula");
    EXPECT_EQ(run("A9", experiment, folder).curves.at(0).deviation, std::nullopt) << "nothing is judged";
}

TEST(LectureExperiments, WithoutShadowsStandingAndFloatingAreOnePicture) {
    const TemporaryFolder folder;
    const auto pairs = run("D17", lecture_experiments()["experiments"]["D17"], folder).pairs;
    ASSERT_EQ(pairs.size(), 3u);
    EXPECT_LT(pairs[0].rmse, 1e-6);
    EXPECT_GT(pairs[1].rmse, 0.02);
    EXPECT_GT(pairs[2].rmse, 0.02);
}

TEST(LectureExperiments, AreShownWithTheirPlots) {
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "report", handed = folder.path() / "handed";
    fs::create_directories(out);
    EXPECT_TRUE(draw_experiments(out / "lectures", UMBRA_SCENES, "umbra report").empty()) << "one failed";
    write_report({out}, out);
    const auto page  = [](const fs::path& of) { return bytes_of(of / "lectures.html"); };
    const auto topic = [&](const std::string& html, const std::string& id) {
        const auto begin = html.find("id=\"" + id + "\"");
        return html.substr(begin, html.find("</article>", begin) - begin);
    };
    const std::string shown = topic(page(out), "A9");
    for (const char* part :
         {"lectures/A9-1.png", "href=\"lectures/A9-2.json\"", "<figcaption>1 / d²<", "<i>f_att = min(",
          "class=\"dots\"", "Largest difference from the formula: ", "(allowed 1.0·10⁻⁵)"})
        EXPECT_NE(shown.find(part), std::string::npos) << part << " in\n" << shown;
    EXPECT_NE(topic(page(out), "D6").find("N = 4: 0.2"), std::string::npos) << topic(page(out), "D6");
    EXPECT_NE(topic(page(out), "A5").find("stroke-dasharray"), std::string::npos);
    write_report({out}, handed, {.language = *language_named("de"), .with_exr = false});
    const std::string german = topic(page(handed), "A7");
    for (const char* part : {"<figcaption>Rechteck, w = 0,5<", "Größte Abweichung von der Formel", ">0,2</text>"})
        EXPECT_NE(german.find(part), std::string::npos) << part << " in\n" << german;
    EXPECT_TRUE(links_hold(handed / "lectures.html"));
    EXPECT_TRUE(draw_experiments(out / "lectures", UMBRA_SCENES, "umbra report").empty());  // replaces its own
    write_report({handed}, handed);
    EXPECT_TRUE(links_hold(handed / "lectures.html"));
}

TEST(Formula, IsReadAsPeopleReadIt) {
    const NamedNumbers names{{"x", 3}, {"S", 0.5}};
    for (const auto& [text, value] :
         std::initializer_list<std::pair<const char*, double>>{{"1 + 2 * 3", 7},
                                                               {"2 - 3 - 4", -5},
                                                               {"24 / 4 / 2", 3},
                                                               {"-x^2", -9},
                                                               {"2^3^2", 512},
                                                               {"2^-1", 0.5},
                                                               {"(1 + x) * S", 2},
                                                               {"if(x < 2, 1, 5)", 5},
                                                               {"x > 2", 1},
                                                               {"max(x, 4) - min(x, 4)", 1},
                                                               {"sin(30)", 0.5},
                                                               {"atan(1)", 45},
                                                               {"acos(0.5)", 60},
                                                               {"sqrt(16) + abs(-1) + floor(2.7)", 7},
                                                               {"exp(0) + 0 * pi", 1}})
        EXPECT_NEAR(formula_value(text, names), value, 1e-12) << text;
    for (const char* text : {"", "1 +", "(1", "1)", "y", "sin 30", "sin(1, 2)", "foo(1)", "1 2"})
        EXPECT_THROW(static_cast<void>(formula_value(text, names)), InputError) << text;
    NamedNumbers more = names;
    define(more, "y = 2 * x");
    EXPECT_EQ(more.at("y"), 6);
    EXPECT_THROW(define(more, "y 2"), InputError);
}

TEST(FormulaChart, DrawsEveryPointThatIsOffTheFormulaAndNoCurveOverAnother) {
    std::vector<double> x, right, off, unsaid;
    for (int k = 0; k <= 366; ++k) {  // a unit a point
        x.push_back(k), right.push_back(1);
        off.push_back(k == 123 || k == 124 ? 0.9 : 1);
        unsaid.push_back(k == 201 ? NAN : 1);
    }
    const json chart = formula_chart({{"a", x, right, right}, {"b", x, off, right}, {"c", x, right, unsaid}});
    const auto has   = [&](std::size_t series, int k) {
        const std::string dots = chart["lines"][series]["dots"];
        return dots.find(fmt::format("M{}.0 ", 64 + k)) != std::string::npos;
    };
    EXPECT_TRUE(has(1, 123) && has(1, 124));
    EXPECT_FALSE(has(2, 123) || has(1, 125) || has(0, 124));
    EXPECT_TRUE(has(2, 202 - 1));
    for (int k = 0; k <= 366; ++k) {
        if (k == 201 || k == 123 || k == 124) continue;
        EXPECT_LE(int(has(0, k)) + int(has(1, k)) + int(has(2, k)), 1) << k;
    }
}

TEST(FormulaChart, HasDotsLinesAndRoundTicks) {
    const json chart = formula_chart({{"a", {0, 1, 2}, {0, 0.5, 1}, {0, 0.5, 1}}, {"b", {0, 1, 2}, {}, {1, NAN, 0}}});
    EXPECT_EQ(chart["lines"][0]["path"], "M64.0 220.0L247.0 117.0L430.0 14.0");
    EXPECT_EQ(chart["lines"][0]["dots"], "M64.0 220.0h0M247.0 117.0h0M430.0 14.0h0");
    EXPECT_EQ(chart["lines"][1]["path"], "M64.0 14.0M430.0 220.0") << "the pen is lifted where nothing is said";
    EXPECT_EQ(chart["lines"][1]["dashed"], true);
    EXPECT_EQ(chart["lines"][0]["dashed"], false);
    std::string labels;
    for (const json& tick : chart["y_ticks"]) labels += tick["label"].get<std::string>() + " ";
    EXPECT_EQ(labels, "0 0.2 0.4 0.6 0.8 1 ");
}

TEST(LectureExperiments, PicturesHaveCaptionsOfTheirOwnWhereCurvesShareThem) {
    const TemporaryFolder folder;
    const ExperimentRecord record = run("A8", lecture_experiments()["experiments"]["A8"], folder);
    ASSERT_EQ(record.pictures.size(), 2u);
    EXPECT_EQ(record.pictures[0].name, "ambient term not attenuated");
    EXPECT_EQ(record.pictures[1].name, "ambient term attenuated");
    EXPECT_EQ(record.curves[0].name, "R: diffuse");
}

TEST(LectureNames, HaveTheNumbersAndListsOfTheirLanguage) {
    const Language german = *language_named("de"), greek = *language_named("el");
    EXPECT_EQ(lecture_name("x = 1.5, 2; y = f(1), ...", Language::english), "x = 1.5, 2; y = f(1), ...");
    EXPECT_EQ(lecture_name("x = 1.5, 2; y = f(1), ...", german), "x = 1,5; 2; y = f(1); ...");
    EXPECT_EQ(lecture_name("DE1, DE2; Harrison et al. 1988", greek), "DE1, DE2· Harrison et al. 1988");
}

TEST(LectureExperiments, AreOfTopics) {
    for (const std::string& id : ids_of_experiments())
        EXPECT_EQ(std::ranges::count(lecture_rows(), id, &LectureRow::id), 1) << id;
}

}  // namespace
}  // namespace umbra
