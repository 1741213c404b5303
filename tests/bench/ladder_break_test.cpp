// A rung and a break that can be worked out by hand: what is counted, what the pictures show, and which is which on the
// page.
#include "umbra/bench/ladders/ladder_break.h"

#include <gtest/gtest.h>

#include "umbra/bench/ladders/ladder_page.h"
#include "umbra/bench/ladders/ladder_record.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

// Seen straight down by an orthographic view, 40 x 20 pixels of 0.1: pixel (x, y) has its centre at X = -1.95 + 0.1 x,
// Z = -0.95 + 0.1 y. The floor ends at Z = 0.8: rows 18 and 19 see nothing. "top" shines straight down on all of it.
// The wall ends at X = -3, 3 high, and the sun travels along (0.8, -0.6, 0): its shadow ends at X = -3 + 3 * 0.8 / 0.6
// = 1, between columns 29 (0.95) and 30 (1.05).
constexpr const char* kWall = R"({
    "size": [40, 20],
    "camera": {"eye": [0, 10, 0], "target": [0, 0, 0], "up": [0, 0, -1], "height": 2},
    "lights": [{"name": "top", "type": "directional", "direction": [0, -1, 0]},
               {"name": "sun", "type": "directional", "direction": [0.8, -0.6, 0]}],
    "objects": [{"name": "floor", "type": "plane", "size": [20, 10.8], "transform": [{"translate": [0, 0, -4.6]}]},
                {"name": "wall", "type": "box", "size": [1, 3, 20], "transform": [{"translate": [-3.5, 1.5, 0]}]}]
})";
constexpr LightId kTop = 0, kSun = 1;
constexpr std::size_t kWidth = 40, kRows = 18, kLit = 30;  ///< kLit: the first column that the sun reaches

Scene wall(double) {
    const TemporaryFolder folder;
    return load_scene(folder.write("wall.json", kWall));
}
const Ladder kLadder{.name = "wall", .title = "A wall", .about = "None.", .unit = "m", .rungs = {1, 2}, .scene = wall};

/// Wrong under the sun at 25 points that it calls lit, under "top" at 5 that it calls dark.
bool is_wrong(LightId light, std::size_t x, std::size_t y) {
    return light == kSun ? x >= 7 && x <= 11 && y <= 4 : x <= 4 && y == 5;
}
float truth(LightId light, std::size_t x) { return light == kTop || x >= kLit ? 1.0f : 0.0f; }

/// Right in any smaller scene: so nothing can be dropped from this one.
class WrongInTheWhole final : public Method {
public:
    explicit WrongInTheWhole(const Settings&) {}
    [[nodiscard]] Service serves(const SceneFacts&) const override { return {How::approximately, "planted"}; }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const bool is_whole = aimed.scene().lights.size() == 2 && aimed.scene().triangles.size() == 14;
        const LightId light = aimed.light;
        for (std::size_t i = 0; i < looked.points.size(); ++i) {
            if (!looked.points.asks(light, i)) continue;
            const std::size_t x = i % kWidth, y = i / kWidth;
            out.s[i] = is_whole && is_wrong(light, x, y) ? 1 - truth(light, x) : truth(light, x);
        }
    }
};
const MethodInfo kPlanted{
    .name = "planted", .title = "Planted", .paper = "", .summary = "", .create = create<WrongInTheWhole>};

TEST(LadderClimb, CountsThePointsOfARung) {
    const LadderRun run = climb_ladder(kLadder, {});
    ASSERT_EQ(run.rungs.size(), 2u);
    const Rung& rung = run.rungs[0];
    EXPECT_EQ(rung.surface_points, kRows * kWidth);
    EXPECT_EQ(rung.lit, kRows * (kWidth + (kWidth - kLit)));  // "top", the sun
    EXPECT_EQ(rung.umbra, kRows * kLit);
    EXPECT_EQ(rung.penumbra, 0u);
    EXPECT_EQ(rung.on_boundary, 0u);
    // The edge band is 1.5 pixels around the boundary at column 29.5: columns 28 to 31.
    EXPECT_EQ(rung.can_show.lit, kRows * (kWidth + (kWidth - kLit - 2)));
    EXPECT_EQ(rung.can_show.shadow, kRows * (kLit - 2));
}

class LadderBreak : public testing::Test {
protected:
    LadderBreak() {
        fs::create_directory(folder_.path() / "breaks");
        written_ = write_break(folder_.path() / "breaks", "wall.planted", kLadder, 1, MethodChoice(kPlanted));
    }

    /// The colour at each pixel, R G B from 0 to 255.
    [[nodiscard]] std::vector<std::array<int, 3>> picture(const std::string& file) const {
        const Image image = read_image(folder_.path() / "breaks" / file).image;
        EXPECT_EQ(image.pixels(), 20 * kWidth);
        std::vector<std::array<int, 3>> pixels;
        for (std::size_t i = 0; i < image.pixels(); ++i)
            pixels.push_back({static_cast<int>(std::lround(255 * image.at(i, 0))),
                              static_cast<int>(std::lround(255 * image.at(i, 1))),
                              static_cast<int>(std::lround(255 * image.at(i, 2)))});
        return pixels;
    }
    TemporaryFolder folder_;
    BreakRecord written_;
};

TEST_F(LadderBreak, ShowsTheLightWithTheMostWrongPoints) {
    EXPECT_EQ(written_.light, "sun");
    EXPECT_EQ(written_.points, 2 * kRows * kWidth);
    EXPECT_EQ(written_.interior, 30u);
    EXPECT_EQ(written_.triangles, 14u);
    EXPECT_EQ(written_.triangles_before, 14u);
}

TEST_F(LadderBreak, PicturesShowTheMethodTheTruthAndTheClasses) {
    const auto method = picture(written_.visibility), reference = picture(written_.truth),
               classes = picture(written_.classes);
    const auto grey    = [](float s) { return s > 0.5f ? std::array{255, 255, 255} : std::array{0, 0, 0}; };
    for (std::size_t y = 0; y < kRows; ++y)
        for (std::size_t x = 0; x < kWidth; ++x) {
            const std::size_t i = kWidth * y + x;
            const float s       = truth(kSun, x);
            ASSERT_EQ(reference[i], grey(s)) << x << " " << y;
            ASSERT_EQ(method[i], grey(is_wrong(kSun, x, y) ? 1 - s : s)) << x << " " << y;
            const bool is_grey = std::abs(classes[i][0] - classes[i][2]) <= 4;  // #6e6e72, #f2f2f2
            ASSERT_EQ(is_grey, !is_wrong(kSun, x, y)) << x << " " << y;
        }
}

TEST_F(LadderBreak, PageCallsEachPictureWhatItIs) {
    LadderRecord ladder          = ladder_record(climb_ladder(kLadder, {MethodChoice(kPlanted)}));
    ladder.methods.front().shown = written_;
    (void)folder_.write("results.json", to_record(LaddersRecord{.breaking_share = 0.005, .ladders = {ladder}}).dump());
    write_ladder_page(folder_.path());
    std::ifstream in(folder_.path() / "index.html");
    const std::string page(std::istreambuf_iterator<char>(in), {});
    for (const auto& [file, alt, caption] :
         {std::array{"truth.png", "S of sun, computed by the reference", "reference"},
          {"S.png", "S of sun, computed by Planted", "method"},
          {"classes.png", "Classes of the wrong points", "errors"}}) {
        const std::size_t at = page.find(std::string("alt=\"") + alt + "\"");
        ASSERT_NE(at, std::string::npos) << alt;
        const std::string figure =
            page.substr(page.rfind("<figure>", at), page.find("</figure>", at) - page.rfind("<figure>", at));
        EXPECT_NE(figure.find(std::string("<a href=\"breaks/wall.planted.") + file + "\">"), std::string::npos)
            << figure;
        EXPECT_NE(figure.find(std::string("src=\"breaks/wall.planted.") + file + "\""), std::string::npos) << figure;
        EXPECT_NE(figure.find(std::string("<span>") + caption + "</span>"), std::string::npos) << figure;
    }
}

}  // namespace
}  // namespace umbra
