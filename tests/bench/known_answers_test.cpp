// What reaches the user is what can be worked out by hand: scenes whose S_j, colours, counts, errors, widths and times
// follow from a few lines of arithmetic, a planted method that is wrong in a known way, and the files that `compare`,
// `render`, `report` and `diff` write, read by readers that share nothing with the writers.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "umbra/bench/compare/compare.h"
#include "umbra/bench/compare/record.h"
#include "umbra/bench/gate/diff.h"
#include "umbra/bench/gate/diff_record.h"
#include "umbra/bench/report/report.h"
#include "umbra/core/image/metrics.h"
#include "umbra/tests/support/html_table.h"
#include "umbra/tests/support/image_reader.h"
#include "umbra/tests/support/planted_method.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using other_readers::Exr;
using other_readers::HtmlTable;
using other_readers::read_exr;
using other_readers::read_png;
using other_readers::read_text;
using other_readers::Rgb;

// ---- colours, as docs/terms.md, the legends and IEC 61966-2-1 state them ------------------------------------------

int shown(double linear) {
    const double v = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    return static_cast<int>(std::floor(255 * v + 0.5));
}
double shown_exactly(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

constexpr Rgb kNoSurface{24, 24, 32}, kAway{0x30, 0x30, 0x34};
constexpr Rgb kRightUmbra{0x6e, 0x6e, 0x72}, kRightLit{0xf2, 0xf2, 0xf2};
constexpr Rgb kAcne{0x0a, 0x2a, 0x9c}, kFalseShadow{0x00, 0x72, 0xb2}, kFalseShadowEdge{0x7c, 0xc4, 0xee};
constexpr Rgb kDetachment{0xe6, 0x9f, 0x00}, kLeak{0xc4, 0x00, 0x00}, kFalseLightEdge{0xff, 0xc8, 0x61};
constexpr Rgb kPenumbra{0x88, 0x22, 0x55}, kNoise{0x99, 0x99, 0x33};
constexpr Rgb kMinusOne{0x05, 0x30, 0x61}, kEqual{0xf7, 0xf7, 0xf7}, kPlusOne{0x67, 0x00, 0x1f};
constexpr Rgb kMinusQuarter{157, 197, 221};  // halfway from #4393c3, at -0.5, to #f7f7f7, at 0

/// Diagonal stripes four pixels wide.
Rgb hatched(std::size_t x, std::size_t y) {
    return (x + y) / 4 % 2 == 1 ? Rgb{107, 115, 140} : Rgb{77, 84, 107};  // (0.42, 0.45, 0.55), (0.30, 0.33, 0.42)
}

/// At least the time that a sleep takes: a test that waits may find more, never less.
void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

class KnownAnswers : public testing::Test {
protected:
    void SetUp() override { planted_behaviour = {}; }

    /// Compares the planted method on the scene; the record as it is in the file.
    json compare(const std::string& scene, const std::string& name, const MethodInfo& info, Repeats repeats = {1, 0}) {
        CompareOptions options;
        options.choices.emplace_back(info);
        options.size          = {40, 20};
        options.out           = out();
        options.command       = "umbra compare";
        options.repeats       = repeats;
        const ScenesDone done = compare_scenes({folder_.write(name + ".json", scene)}, options);
        EXPECT_TRUE(done.failed.empty() && done.stopped.empty());
        return json::parse(read_text(out() / name / "results.json"));
    }
    /// The scene's page.
    [[nodiscard]] std::string page(const std::string& name) const {
        write_report({out()}, out());
        return read_text(out() / name / "index.html");
    }
    [[nodiscard]] fs::path out() const { return folder_.path() / "out"; }

    TemporaryFolder folder_;
};

// ---- a wall, hard lights ------------------------------------------------------------------------------------------

// Seen straight down by an orthographic view, 40 x 20 pixels of 0.1: pixel (x, y) has its centre at X = -1.95 + 0.1 x,
// Z = -0.95 + 0.1 y. The floor Y = 0 ends at Z = 0.8: rows 18 and 19 see nothing, 18 rows of 40 points the floor.
//
// The wall ends at X = -3, 3 high. The sun travels along (0.8, -0.6, 0): the wall's shadow ends at
// X = -3 + 3 * 0.8 / 0.6 = 1, between columns 29 (0.95) and 30 (1.05). So S_sun is 0 in columns 0 to 29, 1 in 30 to 39.
// "top" shines straight down, on all of the floor; "below" straight up: the floor faces away from it.
//
// N.L is 0.6 for the sun and 1 for "top", k_a = k_d = 1, so that per channel
//     ambient 0.1 O_d = (0.05, 0.08, 0.1), sun 0.6 I O_d = (0.3, 0.24, 0.15), top I O_d = (0.125, 0.2, 0.5).
constexpr const char* kWall = R"({
    "camera": {"eye": [0, 10, 0], "target": [0, 0, 0], "up": [0, 0, -1], "height": 2},
    "ambient": 0.1, "background": [0.2, 0.1, 0.4],
    "materials": {"floor": {"k_a": 1, "k_d": 1, "O_d": [0.5, 0.8, 1]}},
    "lights": [{"name": "sun", "type": "directional", "direction": [0.8, -0.6, 0], "colour": [1, 0.5, 0.25]},
               {"name": "top", "type": "directional", "direction": [0, -1, 0], "colour": [0.25, 0.25, 0.5]},
               {"name": "below", "type": "directional", "direction": [0, 1, 0]}],
    "objects": [{"name": "floor", "type": "plane", "size": [20, 10.8], "material": "floor",
                 "transform": [{"translate": [0, 0, -4.6]}]},
                {"name": "wall", "type": "box", "size": [1, 3, 20], "transform": [{"translate": [-3.5, 1.5, 0]}]}]
})";
constexpr std::size_t kSun = 0, kTop = 1, kBelow = 2;

/// The planted method on the wall. For the sun:
///   columns 38 and 39: undefined;
///   columns 7 to 11 of rows 0 to 4: 1 instead of 0;
///   column 29, and column 28 of rows 16 and 17: 1 instead of 0, beside the shadow's edge;
///   columns 34 to 36 of rows 0 to 2: 0 instead of 1; in row 0 it blames the point's own triangle;
///   column 30 of rows 10 to 12: 0 instead of 1, beside the edge.
/// For "top" 0.75 in row 5. Nothing else is wrong.
PlantedAnswer wrong_at_the_wall(LightId light, std::size_t x, std::size_t y) {
    if (light == kTop) return {y == 5 ? 0.75f : 1.0f};
    if (x >= 38) return {0, false};
    const bool lit = x >= 7 && x <= 11 && y <= 4     ? true
                     : x >= 34 && x <= 36 && y <= 2  ? false
                     : x == 30 && y >= 10 && y <= 12 ? false
                                                     : x >= 29 || (x == 28 && y >= 16);
    return {lit ? 1.0f : 0.0f};
}
double true_at_the_wall(std::size_t light, std::size_t x) {
    return light == kSun ? (x >= 30 ? 1 : 0) : light == kTop ? 1 : 0;
}

/// The class of each point of the sun, in words of the legend. The segment to the sun meets the wall's face, X = -3, at
/// the height 0.75 (X + 3). False light is a detachment up to half of the wall's height, 1.5: where X is at most -1, in
/// columns 0 to 9. The edge band is 1.5 pixels around the boundary at column 29.5: columns 28 to 31.
Rgb class_of_sun(std::size_t x, std::size_t y) {
    if (y >= 18) return kNoSurface;
    if (x >= 38) return hatched(x, y);
    const double s = wrong_at_the_wall(kSun, x, y).s, truth = true_at_the_wall(kSun, x);
    if (s > truth) return x >= 28 ? kFalseLightEdge : x <= 9 ? kDetachment : kLeak;
    if (s < truth) return x == 30 ? kFalseShadowEdge : y == 0 ? kAcne : kFalseShadow;
    return truth == 1 ? kRightLit : kRightUmbra;
}

std::array<double, 3> colour_at_the_wall(double s_sun, double s_top, bool surface) {
    if (!surface) return {0.2, 0.1, 0.4};
    return {0.05 + 0.3 * s_sun + 0.125 * s_top, 0.08 + 0.24 * s_sun + 0.2 * s_top, 0.1 + 0.15 * s_sun + 0.5 * s_top};
}
/// Where a light's S_j is undefined the picture shows it unblocked.
std::array<double, 3> planted_colour(std::size_t x, std::size_t y) {
    const PlantedAnswer sun = wrong_at_the_wall(kSun, x, y);
    return colour_at_the_wall(sun.defined ? double(sun.s) : 1, double(wrong_at_the_wall(kTop, x, y).s), y < 18);
}
std::array<double, 3> true_colour(std::size_t x, std::size_t y) {
    return colour_at_the_wall(true_at_the_wall(kSun, x), 1, y < 18);
}

class Wall : public KnownAnswers {
protected:
    void SetUp() override {
        KnownAnswers::SetUp();
        planted_behaviour.answer = [](LightId light, std::size_t x, std::size_t y, int) {
            return wrong_at_the_wall(light, x, y);
        };
        planted_behaviour.blames_own   = [](vec3 p) { return p.z < -0.9f; };  // row 0
        planted_behaviour.blamed       = 13;  // of the wall: triangles 0 and 1 are the floor's
        planted_behaviour.memory_bytes = 3 << 20;
    }
    json compare_wall() { return compare(kWall, "wall", info_); }
    [[nodiscard]] fs::path file(const std::string& name) const { return out() / "wall" / name; }

    MethodInfo info_ = planted_method();
};

template <class Body>
void for_each_pixel(const Body& body) {
    for (std::size_t y = 0; y < 20; ++y)
        for (std::size_t x = 0; x < 40; ++x) body(x, y, 40 * y + x);
}

TEST_F(Wall, ExrHoldsTheSumAndTheAnswers) {
    (void)compare_wall();
    const Exr planted = read_exr(file("planted.exr")), reference = read_exr(file("reference.exr"));
    ASSERT_EQ(planted.width, 40);
    ASSERT_EQ(planted.height, 20);
    const std::array channel = {"R", "G", "B"};
    for_each_pixel([&](std::size_t x, std::size_t y, std::size_t i) {
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_NEAR(planted.floats.at(channel[c])[i], planted_colour(x, y)[c], 1e-6) << x << " " << y << " " << c;
            ASSERT_NEAR(reference.floats.at(channel[c])[i], true_colour(x, y)[c], 1e-6) << x << " " << y << " " << c;
        }
        const bool surface    = y < 18;
        const std::array name = {"sun", "top", "below"};
        for (std::size_t light : {kSun, kTop, kBelow}) {
            const std::string s = std::string("S.") + name[light];
            const float truth   = surface ? static_cast<float>(true_at_the_wall(light, x)) : 0;
            ASSERT_EQ(reference.floats.at(s)[i], truth) << s << x << " " << y;
            if (!surface || light == kBelow) {
                ASSERT_EQ(planted.floats.at(s)[i], 0);
                continue;
            }
            const PlantedAnswer answer = wrong_at_the_wall(static_cast<LightId>(light), x, y);
            ASSERT_EQ(std::isnan(planted.floats.at(s)[i]), !answer.defined);
            ASSERT_EQ(planted.integers.at(std::string("answer.") + name[light])[i], answer.defined ? 1u : 0u);
            if (answer.defined) {
                ASSERT_EQ(planted.floats.at(s)[i], answer.s) << s << x << " " << y;
            }
        }
        ASSERT_EQ(reference.integers.at("judged.sun")[i], 1u);
        ASSERT_EQ(reference.floats.at("half_width.sun")[i], 0);
        // The codes of docs/exr.md.
        const Rgb colour                 = class_of_sun(x, y);
        const std::map<Rgb, unsigned> of = {{kNoSurface, 0},       {kRightLit, 6},     {kRightUmbra, 6},
                                            {kFalseShadowEdge, 9}, {kFalseShadow, 10}, {kAcne, 11},
                                            {kFalseLightEdge, 12}, {kDetachment, 14},  {kLeak, 15}};
        ASSERT_EQ(planted.integers.at("class.sun")[i], surface && x >= 38 ? 4u : of.at(colour)) << x << " " << y;
        ASSERT_EQ(planted.integers.at("class.top")[i], surface ? 6u : 0u);
        ASSERT_EQ(planted.integers.at("class.below")[i], surface ? 1u : 0u);
    });
}

TEST_F(Wall, PicturesHaveTheColoursOfTheLegends) {
    const json record = compare_wall();
    const json& files = record["methods"][0]["files"];
    const auto png    = [&](const json& name) { return read_png(file(name)); };
    const auto &sun = files["lights"]["sun"], &top = files["lights"]["top"], &below = files["lights"]["below"];
    const auto picture = png(files["png"]), truth = png(record["reference"]["files"]["png"]);
    const auto s_sun = png(sun["visibility"]), s_top = png(top["visibility"]), s_below = png(below["visibility"]),
               s_reference    = png(record["reference"]["files"]["lights"]["sun"]["visibility"]);
    const auto difference_sun = png(sun["difference"]), difference_top = png(top["difference"]),
               difference_below = png(below["difference"]);
    const auto classes_sun = png(sun["classes"]), classes_top = png(top["classes"]),
               classes_below = png(below["classes"]);
    const auto grey          = [](int level) { return Rgb{level, level, level}; };
    for_each_pixel([&](std::size_t x, std::size_t y, std::size_t i) {
        const bool surface = y < 18, undefined = surface && x >= 38;
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(picture[i][c], shown(planted_colour(x, y)[c])) << x << " " << y << " " << c;
            ASSERT_EQ(truth[i][c], shown(true_colour(x, y)[c])) << x << " " << y << " " << c;
        }
        const double s = wrong_at_the_wall(kSun, x, y).s, t = true_at_the_wall(kSun, x);
        ASSERT_EQ(s_sun[i], !surface    ? kNoSurface
                            : undefined ? hatched(x, y)
                                        : grey(s == 1 ? 255 : 0))
            << x << " " << y;
        ASSERT_EQ(s_reference[i], !surface ? kNoSurface : grey(t == 1 ? 255 : 0));
        ASSERT_EQ(s_top[i], !surface ? kNoSurface : grey(y == 5 ? 191 : 255));  // 0.75 * 255 = 191.25
        ASSERT_EQ(s_below[i], !surface ? kNoSurface : grey(0));
        ASSERT_EQ(difference_sun[i], !surface    ? kNoSurface
                                     : undefined ? hatched(x, y)
                                     : s > t     ? kPlusOne
                                     : s < t     ? kMinusOne
                                                 : kEqual)
            << x << " " << y;
        ASSERT_EQ(difference_top[i], !surface ? kNoSurface : y == 5 ? kMinusQuarter : kEqual);
        ASSERT_EQ(difference_below[i], !surface ? kNoSurface : kEqual);
        ASSERT_EQ(classes_sun[i], class_of_sun(x, y)) << x << " " << y;
        ASSERT_EQ(classes_top[i], !surface ? kNoSurface : kRightLit);
        ASSERT_EQ(classes_below[i], !surface ? kNoSurface : kAway);
    });
    // FLIP's map is black where the pictures agree, brighter where they do not; #000005 begins its scale.
    const auto flip = png(files["flip"]);
    EXPECT_EQ(flip[40 * 15 + 15], (Rgb{0, 0, 5}));
    EXPECT_GT(flip[40 * 2 + 9][0], 40);
    // Where the sun has no answer it says nothing.
    for_each_pixel([&](std::size_t x, std::size_t y, std::size_t i) {
        ASSERT_EQ(flip[i] == hatched(x, y), y < 18 && x >= 38) << x << " " << y;
    });
}

/// The sums of the sun. False light: 25 in the block, of them columns 7 to 9 at the contact (15), 10 and 11 not (10);
/// 18 + 2 beside the edge. False shadow: 9 in the block, its first row (3) blamed on the point itself; 3 beside the
/// edge. Points: 18 rows of 38 columns, 8 of them lit; 57 are wrong by 1.
///
/// Edge displacement: each of 18 rows has its edge at 29.5. The method's is at 28.5, 1 pixel away. In rows 16 and 17 it
/// is at 27.5: from row 16 the nearest is row 15's, sqrt(1 + 1) away, from row 17 its own, 2 away. The dark pixels of
/// column 30 end between rows 9 and 10 and between rows 12 and 13: those four rows have an edge half a pixel to the
/// right and half a pixel above or below, sqrt(1/2) away. Of 18 values in order the 95th percentile is number
/// floor(17 * 0.95) = 16 counted from 0: sqrt 2.
TEST_F(Wall, RecordHoldsTheCountsAndErrors) {
    const json record = compare_wall(), &method = record["methods"][0], &sun = method["errors"][0],
               &top = method["errors"][1], &below = method["errors"][2];
    EXPECT_EQ(sun["light"], "sun");
    EXPECT_EQ(sun["points"], 684);
    EXPECT_EQ(sun["undefined"], 36);
    EXPECT_EQ(sun["away"], 0);
    EXPECT_EQ(sun["on_boundary"], 0);
    EXPECT_EQ(sun["not_judged"], 0);
    EXPECT_EQ(sun["lit"], 18 * 8);
    EXPECT_EQ(sun["umbra"], 18 * 30);
    EXPECT_EQ(sun["penumbra"], 0);
    EXPECT_EQ(sun["false_shadow"], (json{{"interior", 9}, {"edge", 3}, {"acne", 3}}));
    EXPECT_EQ(sun["false_light"], (json{{"interior", 25}, {"edge", 20}, {"detachment", 15}, {"leak", 10}}));
    EXPECT_EQ(sun["interior"], (json{{"lit", 9}, {"umbra", 25}, {"penumbra", 0}}));
    EXPECT_EQ(sun["penumbra_error"], (json{{"false_shadow", 0}, {"false_light", 0}}));
    EXPECT_EQ(sun["terminator"], (json{{"facet_away", 0}, {"normal_away", 0}, {"wrong", 0}}));
    EXPECT_NEAR(sun["mae"], 57.0 / 684, 1e-12);
    EXPECT_NEAR(sun["rmse"], std::sqrt(57.0 / 684), 1e-12);
    EXPECT_NEAR(sun["bias"], (45.0 - 12) / 684, 1e-12);
    EXPECT_EQ(sun["max"], 1);
    const double root = std::sqrt(2.0), half_root = std::sqrt(0.5);
    EXPECT_EQ(sun["edge_displacement_px"]["pieces"], 18);
    EXPECT_EQ(sun["edge_displacement_px"]["unmatched"], 0);
    EXPECT_NEAR(sun["edge_displacement_px"]["mean"], (12 + 4 * half_root + root + 2) / 18, 1e-12);
    EXPECT_NEAR(sun["edge_displacement_px"]["p95"], root, 1e-12);
    EXPECT_NEAR(sun["edge_displacement_px"]["max"], 2, 1e-12);
    EXPECT_TRUE(sun["penumbra_width_px"].is_null() && sun["noise"].is_null() && sun["bracket"].is_null());

    EXPECT_EQ(top["points"], 720);
    EXPECT_EQ(top["lit"], 720);
    EXPECT_EQ(top["false_shadow"]["interior"], 0) << "less than half is wrong of a hard light";
    EXPECT_NEAR(top["mae"], 40 * 0.25 / 720, 1e-12);
    EXPECT_NEAR(top["rmse"], std::sqrt(40 * 0.0625 / 720), 1e-12);
    EXPECT_NEAR(top["bias"], -40 * 0.25 / 720, 1e-12);
    EXPECT_EQ(top["max"], 0.25);
    EXPECT_EQ(below["away"], 720);
    EXPECT_EQ(below["points"], 0);

    EXPECT_NEAR(method["coverage"], (2 * 720.0 - 36) / (2 * 720), 1e-12);
    EXPECT_EQ(method["memory_bytes"], 3 << 20);
    EXPECT_EQ(method["compared_with"], "exact");
    EXPECT_EQ(method["measures"], "area");
    EXPECT_EQ(record["reference"]["name"], "exact");
    EXPECT_EQ(record["reference"]["exact"], true);
    EXPECT_EQ(record["size"], (json{{"width", 40}, {"height", 20}}));

    const json &floor = record["facts"]["objects"][0], &wall = record["facts"]["objects"][1];
    EXPECT_EQ(floor["triangles"], 2);
    EXPECT_EQ(floor["vertices"], 4);
    EXPECT_EQ(floor["boundary_edges"], 4);
    EXPECT_EQ(floor["nonmanifold_edges"], 0);
    EXPECT_NEAR(floor["area"], 20 * 10.8, 1e-4);
    EXPECT_EQ(wall["vertices"], 8);
    EXPECT_NEAR(wall["area"], 2 * (1 * 3 + 3 * 20 + 1 * 20), 1e-4);
    EXPECT_NEAR(wall["volume"], 60, 1e-4);
    EXPECT_NEAR(record["facts"]["extent"]["min"][0], -10, 1e-5);
    EXPECT_NEAR(record["facts"]["extent"]["max"][1], 3, 1e-5);
    EXPECT_EQ(record["lights"][0]["place"], "at_infinity");
}

/// Scores of the picture, over all 800 pixels, where undefined ones show the reference's.
TEST_F(Wall, RecordHoldsTheScoresOfThePicture) {
    const json scores = compare_wall()["methods"][0]["image"];
    double linear = 0, displayed = 0;
    const Image black(40, 20, {"R", "G", "B"});
    Image of_planted = black, of_truth = black, shown_planted = black, shown_truth = black;
    for_each_pixel([&](std::size_t x, std::size_t y, std::size_t i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double b = true_colour(x, y)[c], a = x < 38 ? planted_colour(x, y)[c] : b;
            of_planted.at(i, c) = static_cast<float>(a), shown_planted.at(i, c) = static_cast<float>(shown_exactly(a));
            of_truth.at(i, c) = static_cast<float>(b), shown_truth.at(i, c) = static_cast<float>(shown_exactly(b));
            linear += (a - b) * (a - b);
            displayed += std::pow(shown_exactly(a) - shown_exactly(b), 2);
        }
    });
    EXPECT_NEAR(scores["rmse"], std::sqrt(linear / 2400), 1e-7);
    EXPECT_NEAR(scores["psnr"], -10 * std::log10(displayed / 2400), 1e-4);
    EXPECT_LT(scores["ssim"], 0.95);
    EXPECT_GT(scores["ssim"], 0.1);
    EXPECT_NEAR(scores["flip"], flip_ldr(shown_truth, shown_planted).mean, 1e-5);
    EXPECT_NEAR(scores["flip_hdr"], flip_hdr(of_truth, of_planted).mean, 1e-5);
    EXPECT_GT(scores["flip"], 0.005);
    EXPECT_GT(std::abs(scores["flip"].get<double>() - scores["flip_hdr"].get<double>()), 1e-3);
    EXPECT_GT(std::abs(scores["flip"].get<double>() - scores["rmse"].get<double>()), 1e-3);
}

/// Every figure of an `errors` entry from its own place: figures that no scene has, all different.
TEST_F(Wall, RecordTellsItsFiguresApart) {
    const PreparedScene prepared = prepare_scene(folder_.write("wall.json", kWall), {40, 20});
    const MethodRun run          = run_method(MethodChoice(info_), prepared.scene, prepared.facts, prepared.points);
    Explained one;
    VisibilityError& e = one.error;
    e.points = 1, e.undefined = 2, e.away = 3, e.on_boundary = 4, e.not_judged = 5, e.lit = 6, e.umbra = 7;
    e.penumbra = 8, e.false_shadow = {9, 10}, e.false_light = {11, 12}, e.interior = {13, 14, 15};
    e.penumbra_error = {16, 17}, e.noise_error = {18, 19}, e.acne = 20, e.detachment = 21, e.leak = 22;
    e.terminator = {23, 24, 25}, e.max_half_width = 26, e.mae = 27, e.rmse = 28, e.max = 29, e.bias = 30;
    one.displacement   = EdgeDisplacement{.mean = 31, .p95 = 32, .max = 33, .pieces = 35, .unmatched = 34};
    one.penumbra_width = PenumbraWidth{.method = 36, .reference = 37};
    one.noise          = Noise{.runs = 38, .rms = 39, .bias = 40};
    const Outcome outcome{run, std::vector<Explained>(3, one)};
    const json found = json::parse(to_record(served_record("planted", prepared, outcome, "truth")).dump())["errors"][1];
    const json expected = json::parse(R"({"light": "top", "points": 1, "undefined": 2, "away": 3, "on_boundary": 4,
        "not_judged": 5, "lit": 6, "umbra": 7, "penumbra": 8, "false_shadow": {"interior": 9, "edge": 10, "acne": 20},
        "false_light": {"interior": 11, "edge": 12, "detachment": 21, "leak": 22},
        "interior": {"lit": 13, "umbra": 14, "penumbra": 15},
        "penumbra_error": {"false_shadow": 16, "false_light": 17}, "noise_error": {"false_shadow": 18, "false_light": 19},
        "terminator": {"facet_away": 23, "normal_away": 24, "wrong": 25}, "bracket": {"max_half_width": 26.0},
        "mae": 27.0, "rmse": 28.0, "max": 29.0, "bias": 30.0,
        "noise": {"runs": 38, "noise_rmse": 39.0, "bias_rmse": 40.0},
        "edge_displacement_px": {"mean": 31.0, "p95": 32.0, "max": 33.0, "pieces": 35, "unmatched": 34, "reach": 8.0},
        "penumbra_width_px": {"method": 36.0, "reference": 37.0}})");
    EXPECT_EQ(found, expected) << found.dump(1);
}

TEST_F(Wall, ImagesSayWhatMadeThem) {
    MethodChoice choice(info_);
    choice.settings.set("seed", 7.0);
    CompareOptions options;
    options.choices = {choice};
    options.size    = {40, 20};
    options.out     = out();
    (void)compare_scenes({folder_.write("wall.json", kWall)}, options);
    const auto input = other_readers::opened(file("planted.exr"));
    EXPECT_EQ(input->spec().get_string_attribute("umbra:parameters"), "planted:seed=7");
    EXPECT_EQ(input->spec().get_string_attribute("umbra:method"), "planted");
}

TEST_F(Wall, PageShowsTheRecord) {
    (void)compare_wall();
    const std::string html = page("wall");
    const HtmlTable errors(html, "errors-caption"), causes(html, "causes-caption"), regions(html, "regions-caption"),
        times(html, "times-caption");
    const std::string row = "sun / Planted";
    EXPECT_EQ(errors.at(row, "False shadow / Interior"), "9");
    EXPECT_EQ(errors.at(row, "False shadow / Edge band"), "3");
    EXPECT_EQ(errors.at(row, "False shadow / Acne"), "3");
    EXPECT_EQ(errors.at(row, "False light / Interior"), "25");
    EXPECT_EQ(errors.at(row, "False light / Edge band"), "20");
    EXPECT_EQ(errors.at(row, "False light / Detachment"), "15");
    EXPECT_EQ(errors.at(row, "False light / Leak"), "10");
    EXPECT_EQ(errors.at(row, "MAE"), "0.0833");
    EXPECT_EQ(errors.at(row, "RMSE"), "0.289");
    EXPECT_EQ(errors.at(row, "Max"), "1.00");
    EXPECT_EQ(errors.at(row, "Bias"), "0.0482");
    EXPECT_EQ(errors.at(row, "Coverage of all lights, %"), "97.5");
    EXPECT_EQ(HtmlTable(html, "image-caption").at("Planted", "Coverage, %"), "97.5");
    EXPECT_EQ(errors.at(row, "Points"), "684");
    EXPECT_EQ(errors.at("top / Planted", "Bias"), "−0.0139");
    EXPECT_EQ(causes.at(row, "Wrong in the interior, points / Lit"), "9");
    EXPECT_EQ(causes.at(row, "Wrong in the interior, points / Umbra"), "25");
    EXPECT_EQ(causes.at(row, "Edge displacement, pixels / Mean"), "1.01");
    EXPECT_EQ(causes.at(row, "Edge displacement, pixels / 95 %"), "1.41");
    EXPECT_EQ(causes.at(row, "Edge displacement, pixels / Max"), "2.00");
    EXPECT_EQ(regions.at(row, "Lit"), "144");
    EXPECT_EQ(regions.at(row, "Umbra"), "540");
    EXPECT_EQ(regions.at(row, "Undefined"), "36");
    EXPECT_EQ(regions.at("below / Planted", "Facing away"), "720");
    EXPECT_EQ(times.at("Planted", "Memory, MiB"), "3.00");
    EXPECT_NE(html.find("Planted: 34 wrong interior points of 1\u202f404 compared with the exact reference (3 acne, "
                        "6 other false shadow, 15 detachment, 10 leak)"),
              std::string::npos);
    // Every colour of the class pictures is in the legend, beside its name.
    for (const char* entry : {"fill=\"#0a2a9c\" stroke=\"currentColor\"/></svg> false shadow: acne",
                              "fill=\"#0072b2\" stroke=\"currentColor\"/></svg> false shadow: other",
                              "fill=\"#7cc4ee\" stroke=\"currentColor\"/></svg> false shadow: edge band",
                              "fill=\"#e69f00\" stroke=\"currentColor\"/></svg> false light: detachment",
                              "fill=\"#c40000\" stroke=\"currentColor\"/></svg> false light: leak",
                              "fill=\"#ffc861\" stroke=\"currentColor\"/></svg> false light: edge band"})
        EXPECT_NE(html.find(entry), std::string::npos) << entry;
}

/// The planted S of "top" is 0.75 in the 40 pixels of row 5, which are 1 in the reference; 0 elsewhere without surface.
TEST_F(Wall, DiffFindsTheSameDifference) {
    (void)compare_wall();
    DiffOptions options;
    options.channels = {"S.top"};
    options.fail     = 0.3;
    const json close = diff_json(diff(file("planted.exr"), file("reference.exr"), options));
    EXPECT_EQ(close["verdict"], "close");
    EXPECT_EQ(close["pixels_over"], 0);
    EXPECT_EQ(close["differing_pixels"], 40);
    EXPECT_NEAR(close["mae"], 40 * 0.25 / 800, 1e-12);
    EXPECT_NEAR(close["rmse"], std::sqrt(40 * 0.0625 / 800), 1e-12);
    EXPECT_NEAR(close["psnr"], -10 * std::log10(40 * 0.0625 / 800), 1e-9);
    EXPECT_EQ(close["max"], 0.25);
    EXPECT_EQ(close["worst"], (json{{"x", 0}, {"y", 5}, {"channel", "S.top"}, {"a", 0.75}, {"b", 1.0}}));

    options.channels   = {"S.*"};
    options.fail       = 0.25;
    const json differs = diff_json(diff(file("planted.exr"), file("reference.exr"), options));
    EXPECT_EQ(differs["verdict"], "differs");
    EXPECT_EQ(differs["exit_code"], 2);
    EXPECT_EQ(differs["unlike_not_finite"], 36);
    EXPECT_EQ(differs["differing_pixels"], 57 + 36 + 40 - 3) << "row 5 meets columns 29, 38 and 39";
    EXPECT_EQ(differs["pixels_over"], 57 + 36) << "0.25 is not beyond 0.25";
    std::map<std::string, json> channel;
    for (const json& c : differs["channels"]) channel[c["name"]] = c;
    EXPECT_NEAR(channel["S.sun"]["mae"], 57.0 / (800 - 36), 1e-12);
    EXPECT_NEAR(channel["S.top"]["mae"], 40 * 0.25 / 800, 1e-12);
    EXPECT_EQ(channel["S.below"]["max"], 0);
}

// ---- times --------------------------------------------------------------------------------------------------------

/// Each phase sleeps: build 150 ms, aim 50 at the sun, look 30, visibility 50 at "top". No time is less than its sleep,
/// and the sum over lights is the sum.
TEST_F(Wall, RecordTellsThePhasesApart) {
    planted_behaviour.work = [](Phase phase, LightId light) {
        if (phase == Phase::build) sleep_ms(150);
        if (phase == Phase::aim && light == kSun) sleep_ms(50);
        if (phase == Phase::look) sleep_ms(30);
        if (phase == Phase::visibility && light == kTop) sleep_ms(50);
    };
    const json method = compare_wall()["methods"][0];
    const json &times = method["times"], &of = method["light_times"];
    EXPECT_GE(times["build_ms"]["median"], 150.0);
    EXPECT_GE(times["look_ms"]["median"], 30.0);
    EXPECT_GE(of[0]["aim_ms"]["median"], 50.0);
    EXPECT_GE(of[1]["visibility_ms"]["median"], 50.0);
    for (const char* phase : {"aim_ms", "visibility_ms"}) {
        double sum = 0;
        for (const json& light : of) sum += light[phase]["median"].get<double>();
        EXPECT_DOUBLE_EQ(times[phase]["median"], sum) << phase;
    }
    EXPECT_EQ(times["build_ms"]["runs"], 1);
}

/// Repetitions are for the clock: the first run answers, whatever those after it write. Two rounds, in each of which
/// the only method is also its own control.
TEST_F(Wall, RepetitionsLeaveNothingBehind) {
    int run                  = 0;
    planted_behaviour.work   = [&](Phase phase, LightId light) { run += phase == Phase::visibility && light == kSun; };
    planted_behaviour.answer = [&](LightId, std::size_t x, std::size_t, int) {
        return run == 1 ? PlantedAnswer{0} : PlantedAnswer{1, x < 20};
    };
    const json record           = compare(kWall, "wall", info_, {2, 1e9});
    const std::size_t explained = record["methods"][0]["errors"][kSun]["explained"].size();
    EXPECT_EQ(static_cast<std::size_t>(run), 1 + 2 * 2 + explained) << "points that are explained are asked again";
    EXPECT_EQ(record["methods"][0]["times"]["build_ms"]["runs"], 2);
    EXPECT_EQ(record["turns"]["control"]["text"], "planted");
    EXPECT_EQ(record["turns"]["calibration_ms"].size(), 2u);
    const Exr planted = read_exr(file("planted.exr"));
    for (const float s : planted.floats.at("S.sun")) ASSERT_EQ(s, 0);
}

/// A method that answers once and throws when its times are taken: it has failed, and the files of its answers are
/// gone.
TEST_F(Wall, WhatThrowsWhenItRunsAgainHasFailed) {
    int builds             = 0;
    planted_behaviour.work = [&](Phase phase, LightId) {
        if (phase == Phase::build && ++builds > 1) throw std::runtime_error("only once");
    };
    CompareOptions options;
    options.choices.emplace_back(info_);
    options.size          = {40, 20};
    options.out           = out();
    options.repeats       = {2, 1e9};
    const ScenesDone done = compare_scenes({folder_.write("wall.json", kWall)}, options);
    EXPECT_EQ(done.stopped, (std::vector<std::string>{"wall: planted: It failed: only once"}));
    const json method = json::parse(read_text(out() / "wall/results.json"))["methods"][0];
    EXPECT_EQ(method["failed"]["message"], "only once");
    EXPECT_EQ(method["serves"]["how"], "not");
    EXPECT_FALSE(method.contains("times"));
    EXPECT_TRUE(fs::exists(file("reference.exr")));
    for (const auto& entry : fs::directory_iterator(out() / "wall"))
        EXPECT_FALSE(entry.path().filename().string().starts_with("planted")) << entry.path();
}

/// The median is the second of them, far from their mean.
TEST(Times, MedianLeastAndLargest) {
    const Json text = to_record(timing_record(std::vector<double>{600, 0, 10}));
    EXPECT_EQ(text, (Json{{"median", 10.0}, {"min", 0.0}, {"max", 600.0}, {"runs", 3}}));
}

// ---- a penumbra ---------------------------------------------------------------------------------------------------

// The same view, all of it floor. A board at Y = 1 covers X <= -2.5; a rectangle light at Y = 2 spans X from -6 to -4.
// The segment from (X, 0) to (L, 2) passes Y = 1 at (X + L) / 2, so that the board blocks it where L <= -5 - X: of the
// light is seen S = (X + 1) / 2, from 0 at X = -1 to 1 at X = 1. Column x has X = -1.95 + 0.1 x: S = (x - 9.5) / 20
// from column 10 to 29, 0 before, 1 after.
constexpr const char* kBoard = R"({
    "camera": {"eye": [0, 10, 0], "target": [0, 0, 0], "up": [0, 0, -1], "height": 2},
    "lights": [{"name": "panel", "type": "rectangle", "position": [-5, 2, 0], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2]}],
    "objects": [{"name": "floor", "type": "plane", "size": 20},
                {"name": "board", "type": "plane", "size": [50, 100], "transform": [{"translate": [-27.5, 1, 0]}]}]
})";
//
// The barycentrics of eye rays are off by a few 2^-24, a point by that of the 20 units of the floor, S by half as much:
// 4 * 2^-24 * 10 < 3e-6. The line S = 1/2 is off by that over a slope of 0.05 a pixel.
constexpr double kRounding = 3e-6, kRoundingOfEdge = kRounding / 0.05;
double true_at_the_board(std::size_t x) { return std::clamp((static_cast<double>(x) - 9.5) / 20, 0.0, 1.0); }

class Board : public KnownAnswers {
protected:
    [[nodiscard]] fs::path file(const std::string& name) const { return out() / "board" / name; }
};

/// The planted method has no penumbra: dark up to column 17, lit from 18 on. An error above 0.1 is wrong: columns 12 to
/// 17 (S = 0.125 to 0.375, 6 columns) are false shadow, 18 to 27 (S = 0.425 to 0.875, 10 columns) false light, all of
/// them inside the penumbra: neighbours differ by 0.05, less than an edge's 0.1 / 1.5.
///
/// The width of a penumbra is 6 / l times the sum of S (1 - S), l the length of the line S = 1/2. For a ramp of w = 20
/// columns the sum is w/6 + 1/(12 w) a row; there are 20 rows, and l = 19 from the first centre to the last:
/// (20 / 19) (20 + 1/40). Without a penumbra it is 0. The line S = 1/2 is at 19.5, the method's at 17.5: 2 pixels off.
TEST_F(Board, AHardShadowInsteadOfAPenumbra) {
    planted_behaviour.answer = [](LightId, std::size_t x, std::size_t, int) {
        return PlantedAnswer{x >= 18 ? 1.0f : 0.0f};
    };
    const json record = compare(kBoard, "board", planted_method()), e = record["methods"][0]["errors"][0];
    EXPECT_EQ(e["points"], 800);
    EXPECT_EQ(e["lit"], 200);
    EXPECT_EQ(e["umbra"], 200);
    EXPECT_EQ(e["penumbra"], 400);
    EXPECT_EQ(e["false_shadow"], (json{{"interior", 120}, {"edge", 0}, {"acne", 0}}));
    EXPECT_EQ(e["false_light"], (json{{"interior", 200}, {"edge", 0}, {"detachment", 0}, {"leak", 0}}));
    EXPECT_EQ(e["penumbra_error"], (json{{"false_shadow", 120}, {"false_light", 200}}));
    EXPECT_EQ(e["interior"], (json{{"lit", 0}, {"umbra", 0}, {"penumbra", 320}}));
    double absolute = 0, squared = 0, bias = 0, most = 0;
    for (std::size_t x = 0; x < 40; ++x) {
        const double d = (x >= 18 ? 1 : 0) - true_at_the_board(x);
        absolute += std::abs(d) / 40, squared += d * d / 40, bias += d / 40, most = std::max(most, std::abs(d));
    }
    EXPECT_NEAR(e["mae"], absolute, kRounding);
    EXPECT_NEAR(e["rmse"], std::sqrt(squared), kRounding);
    EXPECT_NEAR(e["bias"], bias, kRounding);
    EXPECT_NEAR(e["max"], most, kRounding);
    EXPECT_NEAR(e["penumbra_width_px"]["reference"], 20.0 / 19 * (20 + 1.0 / 40), kRoundingOfEdge);
    EXPECT_EQ(e["penumbra_width_px"]["method"], 0.0);
    EXPECT_NEAR(e["edge_displacement_px"]["mean"], 2, kRoundingOfEdge);
    EXPECT_EQ(record["lights"][0]["place"], "outside_view");

    const Exr reference = read_exr(file("reference.exr"));
    const auto s = read_png(file("reference.S.panel.png")), classes = read_png(file("planted.classes.panel.png"));
    for_each_pixel([&](std::size_t x, std::size_t, std::size_t i) {
        const double truth = true_at_the_board(x);
        ASSERT_NEAR(reference.floats.at("S.panel")[i], truth, kRounding);
        ASSERT_EQ(s[i][0], static_cast<int>(std::floor(255 * truth + 0.5)));
        const int d = static_cast<int>(x >= 12 && x <= 27);
        if (d == 1) {
            ASSERT_EQ(classes[i], kPenumbra);
        } else {
            const auto level = [&](std::size_t c) {
                return static_cast<int>(std::floor(kRightUmbra[c] + truth * (kRightLit[c] - kRightUmbra[c]) + 0.5));
            };
            ASSERT_EQ(classes[i], (Rgb{level(0), level(1), level(2)})) << x;
        }
    });
    const std::string html = page("board");
    const HtmlTable causes(html, "causes-caption"), regions(html, "regions-caption");
    EXPECT_EQ(causes.at("panel / Planted", "Penumbra width, pixels / Method"), "0");
    EXPECT_EQ(causes.at("panel / Planted", "Penumbra width, pixels / Reference"), "21.1");
    EXPECT_EQ(causes.at("panel / Planted", "Wrong in the interior, points / Penumbra"), "320");
    EXPECT_EQ(regions.at("panel / Planted", "Penumbra"), "400");
}

/// In columns 12 to 25 (S from 0.125 to 0.775) the planted method is too bright by 0.08, and by 0.06 more or less as
/// its seed is even or odd. Its own seed is even: 0.14 off, more than 0.1; the mean over seeds is 0.08 off, which is
/// right: 14 columns of noise. The eight other seeds are four even and four odd, so that the variance over runs is 8/7
/// 0.06^2 at 14 of 40 columns. Less what of it is left in the mean of eight, the square of the bias is 0.08^2 - 0.06^2
/// / 7 there.
TEST_F(Board, NoiseIsToldFromBias) {
    planted_behaviour.answer = [](LightId, std::size_t x, std::size_t, int seed) {
        const double off = x >= 12 && x <= 25 ? 0.08 + (seed % 2 == 0 ? 0.06 : -0.06) : 0;
        return PlantedAnswer{static_cast<float>(true_at_the_board(x) + off)};
    };
    const json e = compare(kBoard, "board", planted_method("seed"))["methods"][0]["errors"][0];
    EXPECT_EQ(e["noise"]["runs"], 8);
    EXPECT_NEAR(e["noise"]["noise_rmse"], std::sqrt(14.0 / 40 * 8 / 7 * 0.0036), 1e-6);
    EXPECT_NEAR(e["noise"]["bias_rmse"], std::sqrt(14.0 / 40 * (0.0064 - 0.0036 / 7)), 1e-6);
    EXPECT_EQ(e["noise_error"], (json{{"false_shadow", 0}, {"false_light", 280}}));
    EXPECT_EQ(e["penumbra_error"], (json{{"false_shadow", 0}, {"false_light", 0}}));
    EXPECT_NEAR(e["bias"], 14.0 / 40 * 0.14, 1e-6);
    const auto classes = read_png(file("planted.classes.panel.png"));
    for_each_pixel(
        [&](std::size_t x, std::size_t, std::size_t i) { ASSERT_EQ(classes[i] == kNoise, x >= 12 && x <= 25) << x; });
    const HtmlTable causes(page("board"), "causes-caption");
    EXPECT_EQ(causes.at("panel / Planted", "Sampling, RMSE of S / Noise"), "0.0379");
    EXPECT_EQ(causes.at("panel / Planted", "Sampling, RMSE of S / Bias"), "0.0454");
}

/// A disk in the place of the rectangle: exact visibility states a half width, the largest of which is the record's.
TEST_F(KnownAnswers, TheBracketOfARoundLightIsTheSameEverywhere) {
    std::string scene(kBoard);
    const std::string edges = R"("rectangle", "position": [-5, 2, 0], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2])";
    scene.replace(scene.find(edges), edges.size(), R"("disk", "position": [-5, 2, 0], "radius": 1)");
    planted_behaviour.answer = [](LightId, std::size_t, std::size_t, int) { return PlantedAnswer{1}; };
    const json e             = compare(scene, "disk", planted_method())["methods"][0]["errors"][0];
    const auto half_widths   = read_exr(out() / "disk/reference.exr").floats.at("half_width.panel");
    const float largest      = *std::ranges::max_element(half_widths);
    EXPECT_GT(largest, 0);
    EXPECT_EQ(e["bracket"]["max_half_width"], static_cast<double>(largest));
}

// ---- a lamp before a screen ---------------------------------------------------------------------------------------

/// A screen fills the plane Z = -1 before an eye at the origin with a field of view of 90 degrees: pixel (x, y) of 40
/// by 20 sees (X, Y) = (0.1 x - 1.95, 0.95 - 0.1 y). A lamp at (0.5, 0.25, 0) has the distance d with d^2 = (X - 0.5)^2
/// + (Y - 0.25)^2 + 1; N.L = 1 / d and f_att = 1 / d^2, at most 1: k_d O_d / d^3.
TEST_F(KnownAnswers, RenderWritesWhatALampGivesAScreen) {
    const fs::path scene = folder_.write("screen.json", R"({
        "camera": {"eye": [0, 0, 0], "target": [0, 0, -1], "fov": 90}, "ambient": 0,
        "materials": {"screen": {"k_a": 1, "k_d": 1, "O_d": [0.9, 0.5, 0.2]}},
        "lights": [{"name": "lamp", "type": "point", "position": [0.5, 0.25, 0], "attenuation": [0, 0, 1]}],
        "objects": [{"name": "screen", "type": "triangles", "material": "screen",
                     "positions": [[-9, -9, -1], [9, -9, -1], [9, 9, -1], [-9, 9, -1]],
                     "triangles": [[0, 1, 2], [0, 2, 3]]}]
    })");
    RenderOptions options;
    options.size = {40, 20};
    for (const char* name : {"screen.exr", "screen.png"}) {
        options.out = folder_.path() / name;
        ASSERT_TRUE(render_scene(scene, options));
    }
    const Exr exr  = read_exr(folder_.path() / "screen.exr");
    const auto png = read_png(folder_.path() / "screen.png");
    const std::array<double, 3> colour{0.9, 0.5, 0.2};
    const std::array channel = {"R", "G", "B"};
    for_each_pixel([&](std::size_t x, std::size_t y, std::size_t i) {
        const double dx = 0.1 * double(x) - 1.95 - 0.5, dy = 0.95 - 0.1 * double(y) - 0.25;
        const double light = std::pow(dx * dx + dy * dy + 1, -1.5);
        ASSERT_EQ(exr.floats.at("S.lamp")[i], 1);
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_NEAR(exr.floats.at(channel[c])[i], colour[c] * light, 1e-5) << x << " " << y << " " << c;
            ASSERT_NEAR(png[i][c], 255 * shown_exactly(colour[c] * light), 0.51) << x << " " << y << " " << c;
        }
    });
}

}  // namespace
}  // namespace umbra
