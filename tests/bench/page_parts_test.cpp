// The parts of pages that can be tested without a page.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "umbra/bench/pages/error_rings.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

// Whether a view has no text there (json::empty() would call "" a value).
bool is_blank(const json& text) { return text.get<std::string>().empty(); }

double number(const json& view, const char* key) { return std::stod(view[key].get<std::string>()); }

TEST(ErrorTimeChart, PlacesZeroErrorsBelowTheAxisAndSurvivesOddNumbers) {
    const json chart =
        error_time_chart({{"exact", 1, 10, 0, 0}, {"coarse", 0, 0, 1e-300, 1}, {"slow", 1e12, 1e13, 1, 2}});
    EXPECT_GT(number(chart["marks"][0], "y"), number(chart["marks"][1], "y"));
    EXPECT_LE(chart["x_ticks"].size(), 8u);
    EXPECT_LE(chart["y_ticks"].size(), 8u);
    for (const json& mark : chart["marks"])
        for (const char* key : {"x", "camera_x", "y", "label_x", "label_y"}) {
            if (is_blank(mark[key])) continue;  // a label that has no position
            const double at = number(mark, key);
            EXPECT_TRUE(std::isfinite(at) && at >= 0 && at <= 440) << key << " " << at;
        }
}

TEST(ErrorTimeChart, SlowerIsRightAndWorseIsUp) {
    const json chart = error_time_chart({{"a", 1, 10, 0.001, 0}, {"b", 20, 200, 0.1, 1}});
    const json &a = chart["marks"][0], &b = chart["marks"][1];
    EXPECT_LT(number(a, "camera_x"), number(a, "x"));
    EXPECT_LT(number(a, "x"), number(b, "x"));
    EXPECT_GT(number(a, "y"), number(b, "y"));
}

TEST(ErrorTimeChart, TicksAreShortEnoughToLeaveTheTitleItsRoom) {
    const json chart = error_time_chart({{"a", 1, 10, 1e-9, 0}, {"b", 2e5, 2e6, 0.5, 1}});
    for (const char* axis : {"x_ticks", "y_ticks"})
        for (const json& tick : chart[axis]) {
            std::size_t characters = 0;
            for (const char c : tick["label"].get<std::string>()) characters += (c & 0xc0) != 0x80;
            EXPECT_LE(characters, 5u) << tick;
        }
}

// Labels and marks of a chart as boxes, by the sizes that the browser gives them: 12 pixel text, marks of 14 pixels.
struct Box {
    double x0, y0, x1, y1;
    [[nodiscard]] bool meets(const Box& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};
Box label_box(const json& mark) {
    const double x = number(mark, "label_x"), y = number(mark, "label_y");
    return {x, y - 9, x + 6 * double(mark["label"].get<std::string>().size()), y + 3};
}

TEST(ErrorTimeChart, LabelsCoverNoLabelNoMarkAndNoLineAndStandBesideTheirOwn) {
    std::vector<ChartPoint> points;
    for (std::size_t k = 0; k < 13; ++k)
        points.push_back({"method " + std::to_string(k), 1 + double(k % 4), 2 + 3 * double(k % 5),
                          k % 3 ? 0.001 * double(k) : 0, k});
    points.push_back({"a method with a long name", 1, 90, 0, 13});  // its label has room on the left only
    const json chart   = error_time_chart(points);
    std::size_t labels = 0;
    for (const json& mark : chart["marks"]) {
        if (is_blank(mark["label_x"])) continue;
        ++labels;
        const Box label = label_box(mark);
        for (const json& other : chart["marks"]) {
            const double x = number(other, "x"), camera = number(other, "camera_x"), y = number(other, "y");
            for (const Box& box : {Box{x - 7, y - 7, x + 7, y + 7}, Box{camera - 7, y - 7, camera + 7, y + 7},
                                   Box{camera, y - 1, x, y + 1}})
                EXPECT_FALSE(label.meets(box)) << mark << other;
            if (&other != &mark && !is_blank(other["label_x"])) {
                EXPECT_FALSE(label.meets(label_box(other))) << mark << other;
            }
        }
        for (const json& lane : chart["lanes"])
            EXPECT_FALSE(label.meets({64, number(lane, "at") - 1, number(lane, "end"), number(lane, "at") + 1}))
                << mark << lane;
        const double x = number(mark, "x"), camera = number(mark, "camera_x"), y = number(mark, "y");
        EXPECT_TRUE(label.meets({camera - 14, y - 14, x + 14, y + 14})) << "far from its mark: " << mark;
    }
    EXPECT_GE(labels, 6u);
}

TEST(ErrorTimeChart, MethodsWithoutErrorHaveALineEachAndEveryoneALabelWhereThereIsRoom) {
    const json chart = error_time_chart(
        {{"planar projection", 1, 2, 0, 0}, {"shadow volumes", 1, 2, 0, 1}, {"ray-traced", 1, 2, 0, 2}});
    std::set<std::string> heights;
    for (const json& mark : chart["marks"]) {
        heights.insert(mark["y"].get<std::string>());
        EXPECT_NE(mark["label_x"], "");
    }
    EXPECT_EQ(heights.size(), 3u);
}

TEST(MarkStyle, DiffersInColourOrShape) {
    std::set<std::pair<std::size_t, std::size_t>> seen;
    for (std::size_t k = 0; k < 36; ++k) {
        EXPECT_LT(mark_style(k).colour, 6u);
        EXPECT_LT(mark_style(k).shape, 6u);
        EXPECT_TRUE(seen.insert({mark_style(k).colour, mark_style(k).shape}).second) << k;
    }
}

/// 100 is all and 0 nothing; what lies between is rounded to the nearest, so that parts add up.
TEST(Percent, IsTheNearestTenth) {
    EXPECT_EQ(percent(1), "100");
    EXPECT_EQ(percent(0), "0");
    EXPECT_EQ(percent(0.96749), "96.7");
    EXPECT_EQ(percent(0.96751), "96.8");
    EXPECT_EQ(percent(0.5), "50");
    EXPECT_EQ(percent(6.92), "692");
    EXPECT_EQ(percent(0.99996), "> 99.9");
    EXPECT_EQ(percent(0.9994), "99.9");
    EXPECT_EQ(percent(0.00004), "< 0.1");
    EXPECT_EQ(percent({}), kNone);
    double sum = 0;
    for (const double part : {0.1999, 0.2999, 0.0998, 0.4004}) sum += std::stod(percent(part));
    EXPECT_NEAR(sum, 100, 0.05) << "20 + 30 + 10 + 40";
}

TEST(DecimalComma, IsInFiguresOfEveryForm) {
    EXPECT_EQ(with_decimal_comma(score(0.25)), "0,250");
    EXPECT_EQ(with_decimal_comma(score(1.2e-5)), "1,2·10⁻⁵");
    EXPECT_EQ(with_decimal_comma(percent(0.125)), "12,5");
    EXPECT_EQ(with_decimal_comma(count(1234)), "1\u202f234");
}

Image right_everywhere() {
    Image image(640, 360, {"R", "G", "B"});
    std::fill(image.data.begin(), image.data.end(), 0xf2 / 255.0f);
    return image;
}
void paint(Image& image, int x, int y, std::array<int, 3> rgb) {
    for (std::size_t c = 0; c < 3; ++c)
        image.at(std::size_t(y) * std::size_t(image.width) + std::size_t(x), c) = float(rgb[c]) / 255;
}
constexpr std::array<int, 3> kAcne = {0x0a, 0x2a, 0x9c}, kEdge = {0x7c, 0xc4, 0xee}, kTerminator = {0x00, 0x9e, 0x73};

TEST(ErrorRings, EncloseFewWrongPointsAndLeaveOutTheEdgeBand) {
    Image image                                  = right_everywhere();
    const std::vector<std::pair<int, int>> wrong = {{100, 100}, {103, 101}, {400, 50}, {639, 359}};
    for (const auto& [x, y] : wrong) paint(image, x, y, kAcne);
    for (int x = 200; x < 230; ++x) paint(image, x, 300, x % 2 ? kEdge : kTerminator);
    const ErrorRings found = error_rings(image);
    EXPECT_EQ(found.points, 4u);
    ASSERT_EQ(found.rings.size(), 3u);
    for (const auto& point : wrong) {
        const int x = point.first, y = point.second;
        const auto around = std::count_if(found.rings.begin(), found.rings.end(), [&](const Ring& r) {
            return r.x < x && x + 1 < r.x + r.width && r.y < y && y + 1 < r.y + r.height;
        });
        EXPECT_EQ(around, 1) << x << " " << y;
    }
}

TEST(ErrorRings, PointsOnBothSidesOfACellAreOneGroup) {
    Image image = right_everywhere();
    for (int x = 90; x < 102; ++x) paint(image, x, 95 + (x - 90) / 6, kAcne);  // over the corner (96, 96) of the grid
    ASSERT_EQ(error_rings(image).rings.size(), 1u);
}

TEST(ErrorRings, AreLeftOutWhereThePointsAreEasyToSeeOrThereAreNone) {
    Image image = right_everywhere();
    EXPECT_TRUE(error_rings(image).rings.empty());
    for (int y = 100; y < 120; ++y)
        for (int x = 100; x < 120; ++x) paint(image, x, y, kAcne);
    paint(image, 500, 300, kAcne);
    EXPECT_EQ(error_rings(image).points, 401u);
    EXPECT_TRUE(error_rings(image).rings.empty());
}

TEST(ErrorRings, AreAtMost24) {
    Image image = right_everywhere();
    for (int y = 20; y < 360; y += 80)
        for (int x = 20; x < 640; x += 80) paint(image, x, y, kAcne);
    EXPECT_EQ(error_rings(image).points, 40u);
    EXPECT_EQ(error_rings(image).rings.size(), 24u);
}

TEST(ClassesOn, AreThoseWithAPoint) {
    Image image = right_everywhere();
    EXPECT_TRUE(classes_on(image).empty());
    paint(image, 3, 4, kTerminator);
    paint(image, 5, 4, kAcne);
    const auto classes = classes_on(image);
    ASSERT_EQ(classes.size(), 2u);
    EXPECT_EQ(classes[0]->key, "acne");
    EXPECT_EQ(classes[1]->key, "terminator_wrong");
}

TEST(ReportText, CommandsNameNoFoldersOfTheMachine) {
    EXPECT_EQ(without_folders("umbra compare /home/ann/scenes/a.json -o /tmp/out/ --methods exact:x=1/2"),
              "umbra compare a.json -o out --methods exact:x=1/2");
    EXPECT_EQ(without_folders("umbra compare scenes/a.json -o results"), "umbra compare scenes/a.json -o results");
    EXPECT_EQ(without_folders(""), "");
}

TEST(ReportText, OneIsNotPlural) {
    EXPECT_EQ(counted(1, "scene"), "1 scene");
    EXPECT_EQ(counted(0, "scene"), "0 scenes");
    EXPECT_EQ(counted(1200, "point"), "1\u202f200 points");
}

}  // namespace
}  // namespace umbra
