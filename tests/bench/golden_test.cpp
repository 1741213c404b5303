// The goldens: every method on every teaching scene is as it was accepted. And the gate itself: planted defects.
#include "umbra/bench/gate/golden.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "umbra/bench/gate/golden_planes.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

std::string described(const GoldenChange& change) {
    return fmt::format(
        "{}: {}\n    {}\n{}", change.name, to_string(change.kind), fmt::join(change.lines, "\n    "),
        change.pictures.empty() ? "" : fmt::format("reference, result and difference: {}\n", change.pictures.string()));
}

// ---- the gate -------------------------------------------------------------------------------------------------------

class EveryScene : public testing::TestWithParam<fs::path> {};

/// Whether no scene has a golden of the method: one that is new to the list, and has not been recorded yet.
bool is_unrecorded(const std::string& method) {
    for (const auto& entry : fs::recursive_directory_iterator(UMBRA_GOLDEN))
        if (entry.path().stem() == method ||
            (entry.path().filename() == "figures.json" &&
             text_of(entry.path()).find(fmt::format("\"{}\":", method)) != std::string::npos))
            return false;
    return true;
}

TEST_P(EveryScene, IsAsAccepted) {
    GoldenOptions options{.folder = UMBRA_GOLDEN, .pictures = UMBRA_FAILED};
    if (const char* only = std::getenv("UMBRA_METHOD")) options.names = {only};  // ./umbra test --method NAME
    std::string rounding, unrecorded;
    for (const GoldenChange& change : golden_changes(GetParam(), options)) {
        const std::string method = change.name.substr(change.name.rfind('/') + 1);
        if (change.rounding)
            rounding += described(change);
        else if (change.kind == GoldenChange::Kind::added && is_unrecorded(method))
            unrecorded += fmt::format("{} has no goldens; look at its pictures, then record them: ./umbra accept {}\n",
                                      method, method);
        else
            ADD_FAILURE() << described(change) << "If this is meant: look at what changed, run `./umbra accept "
                          << change.name << "`, and commit what that renews with the change that explains it.";
    }
    if (!rounding.empty())
        GTEST_SKIP() << "Points at edges differ, as they may: the goldens were made on another kind of machine; this "
                        "one is "
                     << rounding_machine() << ".\n"
                     << rounding;
    if (!unrecorded.empty()) GTEST_SKIP() << unrecorded;
}

INSTANTIATE_TEST_SUITE_P(Golden, EveryScene, testing::ValuesIn(teaching_scenes(UMBRA_SCENES)),
                         [](const auto& scene) { return scene.param.stem().string(); });

TEST(Golden, NoneIsLeftOver) {
    for (const GoldenChange& change : golden_leftovers(teaching_scenes(UMBRA_SCENES), {.folder = UMBRA_GOLDEN}))
        ADD_FAILURE() << described(change) << "Run `./umbra accept`.";
}

TEST(Golden, AllTogetherAreSmall) {
    std::uintmax_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(UMBRA_GOLDEN))
        if (entry.is_regular_file()) bytes += entry.file_size();
    EXPECT_LT(bytes, 2'000'000u);
}

// ---- the gate can fail ----------------------------------------------------------------------------------------------

constexpr std::string_view kLampOverBox = R"({
    "shows": "A box under a lamp.",
    "camera": {"eye": [0, 3, 6], "target": [0, 0.5, 0]},
    "lights": [{"name": "lamp", "type": "point", "position": [2, 4, 1]},
               {"name": "panel", "type": "rectangle", "position": [-2, 4, 1], "size": [1, 1]}],
    "objects": [{"name": "floor", "type": "plane", "size": [8, 8]},
                {"name": "ball", "type": "sphere", "radius": 0.6, "transform": [{"translate": [0, 1, 0]}]}]
})";

class Accepted : public testing::Test {
protected:
    void SetUp() override {
        scene_          = folder_.write("ball.json", kLampOverBox);
        options_.folder = folder_.path() / "golden";
        options_.names  = {"planar_projection", "shadow_volumes", "shadow_zbuffer"};  // ranges of many seeds take long
        accept();
    }
    /// Methods with goldens of this scene, without the three of SetUp.
    std::size_t others() const {
        const SceneFacts facts = prepare_scene(scene_, {96, 54}).facts;
        const auto has_golden  = [&](const MethodInfo* info) {
            return info->by_default && bool(info->make()->serves(facts));
        };
        return static_cast<std::size_t>(std::ranges::count_if(methods(), has_golden)) - 3;
    }
    std::vector<GoldenChange> changes() const { return golden_changes(scene_, options_); }
    std::vector<GoldenChange> accept() const {
        GoldenOptions renewing = options_;
        renewing.renew         = true;
        return golden_changes(scene_, renewing);
    }
    fs::path golden(const std::string& file) const { return options_.folder / "ball" / file; }

    /// Changes one value of a kept plane.
    template <class Change>
    void plant(const std::string& method, const std::string& channel, int x, int y, const Change& change) const {
        Image image   = read_image(golden(method + ".exr")).image;
        const auto at = std::find(image.channels.begin(), image.channels.end(), channel);
        ASSERT_NE(at, image.channels.end());
        float& value = image.at(static_cast<std::size_t>(y * image.width + x),
                                static_cast<std::size_t>(at - image.channels.begin()));
        value        = change(value);
        write_image(golden(method + ".exr"), image);
    }
    /// Replaces one accepted figure of a light.
    void plant_figure(const std::string& method, const std::string& light, const std::string& figure,
                      const Json& value) const {
        Json record = Json::parse(text_of(golden("figures.json")));
        ASSERT_TRUE(record["methods"][method][light].contains(figure)) << record.dump(1);
        record["methods"][method][light][figure] = value;
        std::ofstream(golden("figures.json")) << record.dump();
    }

    TemporaryFolder folder_;
    fs::path scene_;
    GoldenOptions options_;
};

TEST_F(Accepted, IsTheSameAgain) {
    options_.names = {};
    EXPECT_EQ(accept().size(), others()) << "all methods except the three are new";
    EXPECT_TRUE(changes().empty());
    EXPECT_TRUE(fs::exists(golden("shadow_volumes.exr")));
    EXPECT_TRUE(fs::exists(golden("figures.json")));
    const auto planes = read_image(golden("ray_traced.exr")).image.channels;
    EXPECT_EQ(planes, std::vector<std::string>{"S.lamp"}) << "the panel is sampled";
}

TEST_F(Accepted, NothingIsWrittenWhereNothingChanged) {
    const auto before = fs::last_write_time(golden("figures.json"));
    const auto planes = fs::last_write_time(golden("shadow_zbuffer.exr"));
    EXPECT_TRUE(accept().empty());
    EXPECT_EQ(fs::last_write_time(golden("figures.json")), before);
    EXPECT_EQ(fs::last_write_time(golden("shadow_zbuffer.exr")), planes);
}

TEST_F(Accepted, OneFlippedPointFailsAndLeavesPictures) {
    plant("shadow_volumes", "S.lamp", 40, 45, [](float s) { return 1 - s; });
    options_.pictures = folder_.path() / "failed";
    const auto found  = changes();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].name, "ball/shadow_volumes");
    EXPECT_EQ(found[0].kind, GoldenChange::Kind::changed);
    ASSERT_EQ(found[0].lines.size(), 1u) << described(found[0]);
    EXPECT_NE(found[0].lines[0].find("1 of 5184 points changed"), std::string::npos) << found[0].lines[0];
    EXPECT_NE(found[0].lines[0].find("pixel 40, 45; largest change 1"), std::string::npos) << found[0].lines[0];

    EXPECT_EQ(found[0].pictures, options_.pictures / "ball.shadow_volumes");
    const auto picture    = [&](const char* name) { return read_image(found[0].pictures / name).image; };
    const Image reference = picture("reference.S.lamp.png"), result = picture("result.S.lamp.png"),
                difference = picture("difference.S.lamp.png");
    std::size_t differing = 0, coloured = 0;
    for (std::size_t i = 0; i < reference.pixels(); ++i) {
        differing += reference.at(i, 0) != result.at(i, 0);
        coloured += std::abs(difference.at(i, 0) - difference.at(i, 2)) > 0.25f;
    }
    EXPECT_EQ(differing, 16u) << "one point, four by four pixels";
    EXPECT_EQ(coloured, 16u) << "dark red or blue";
    EXPECT_TRUE(fs::exists(found[0].pictures / "reference.exr"));
    EXPECT_TRUE(fs::exists(found[0].pictures / "result.exr"));
}

TEST_F(Accepted, TheSmallestChangeIsSeen) {
    plant("planar_projection", "S.panel", 40, 45, [](float s) { return std::nextafter(s, 0.5f); });
    EXPECT_EQ(changes().size(), 1u);
}

TEST_F(Accepted, LostCoverageIsSeen) {
    plant("shadow_zbuffer", "S.lamp", 2, 50, [](float) { return std::nanf(""); });
    const auto found = changes();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].lines[0].find("1 of 5184"), std::string::npos) << found[0].lines[0];
}

TEST_F(Accepted, RenewingMendsAndSaysWhatChanged) {
    plant("shadow_volumes", "S.lamp", 40, 45, [](float s) { return 1 - s; });
    plant("shadow_zbuffer", "S.lamp", 41, 45, [](float s) { return 1 - s; });
    const auto planar  = fs::last_write_time(golden("planar_projection.exr"));
    const auto renewed = accept();
    ASSERT_EQ(renewed.size(), 2u);
    EXPECT_EQ(renewed[0].name, "ball/shadow_volumes");
    EXPECT_EQ(renewed[1].name, "ball/shadow_zbuffer");
    EXPECT_TRUE(changes().empty());
    EXPECT_EQ(fs::last_write_time(golden("planar_projection.exr")), planar) << "unchanged, so not written";
}

TEST_F(Accepted, NamesLimitWhatIsAskedAndRenewed) {
    plant("shadow_volumes", "S.lamp", 40, 45, [](float s) { return 1 - s; });
    plant("shadow_zbuffer", "S.lamp", 41, 45, [](float s) { return 1 - s; });
    options_.names = {"ball/shadow_zbuffer"};
    EXPECT_EQ(accept().size(), 1u);
    options_.names = {"another_scene"};
    EXPECT_TRUE(changes().empty());
    options_.names = {"shadow_volumes"};
    EXPECT_EQ(changes().size(), 1u);
    options_.names = {"ball"};
    EXPECT_EQ(changes().size(), 1 + others()) << "and all methods except the three are new";

    EXPECT_NO_THROW(check_golden_names({scene_}, options_));
    options_.names = {"ball", "bell"};
    EXPECT_THROW(check_golden_names({scene_}, options_), UsageError);
}

TEST_F(Accepted, WhatIsNewOrLeftOverFails) {
    options_.names = {};
    accept();
    fs::remove(golden("shadow_volumes.exr"));
    fs::copy(golden("shadow_zbuffer.exr"), golden("crayon.exr"));
    auto found = changes();
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].name, "ball/crayon");
    EXPECT_EQ(found[0].kind, GoldenChange::Kind::removed);
    EXPECT_EQ(found[1].name, "ball/shadow_volumes");
    EXPECT_EQ(accept().size(), 2u);
    EXPECT_FALSE(fs::exists(golden("crayon.exr")));
    EXPECT_TRUE(changes().empty());

    fs::copy(options_.folder / "ball", options_.folder / "bell");
    found = golden_leftovers({scene_}, options_);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].name, "bell");
    options_.renew = true;
    EXPECT_EQ(golden_leftovers({scene_}, options_).size(), 1u);
    EXPECT_TRUE(golden_leftovers({scene_}, options_).empty());
    EXPECT_TRUE(fs::exists(golden("shadow_zbuffer.exr")));
}

TEST_F(Accepted, AChangedSceneChangesAll) {
    folder_.write("ball.json", std::string(kLampOverBox).replace(kLampOverBox.find("[2, 4, 1]"), 9, "[2, 4, 2]"));
    EXPECT_EQ(changes().size(), 3u);
}

TEST_F(Accepted, WhatIsNoFiguresIsRefused) {
    for (const char* text : {"<<<<<<< HEAD\n", "{}", R"({"machine": "x", "methods": {"exact": {"lamp": 3}}})",
                             R"({"machine": "x", "methods": {"exact": {"lamp": {"mae": [1, "b"]}}}})"}) {
        std::ofstream(golden("figures.json")) << text;
        EXPECT_THROW(static_cast<void>(changes()), InputError) << text;
    }
}

// Figures: better than accepted is as suspicious as worse. The scene here has hard lights alone, so that `exact`
// serves.
class AcceptedFigures : public Accepted {
protected:
    void SetUp() override {
        const std::string text(kLampOverBox);
        const std::size_t begin = text.find("{\"name\": \"panel\""), end = text.find("}]", begin);
        std::string hard = text.substr(0, begin) + text.substr(end + 1);
        hard.erase(hard.rfind(',', begin), 1);
        scene_          = folder_.write("ball.json", hard);
        options_.folder = folder_.path() / "golden";
        options_.names  = {"shadow_volumes", "shadow_zbuffer"};
        accept();
        mae_ = Json::parse(text_of(golden("figures.json")))["methods"]["shadow_zbuffer"]["lamp"]["mae"];
        ASSERT_GT(mae_, 0);
    }
    double mae_ = 0;
};

TEST_F(AcceptedFigures, PinnedOnesFailWhereTheyAreWorseAndWhereTheyAreBetter) {
    for (const double off : {-1e-9, 1e-9}) {
        plant_figure("shadow_zbuffer", "lamp", "mae", mae_ * (1 + off));
        const auto found = changes();
        ASSERT_EQ(found.size(), 1u);
        ASSERT_EQ(found[0].lines.size(), 1u) << described(found[0]);
        EXPECT_NE(found[0].lines[0].find(" -> "), std::string::npos);
    }
    plant_figure("shadow_zbuffer", "lamp", "mae", mae_);
    EXPECT_TRUE(changes().empty());
}

TEST_F(AcceptedFigures, RangesHaveALowerEndToo) {
    plant_figure("shadow_zbuffer", "lamp", "mae", {0.5 * mae_, 2 * mae_});
    EXPECT_TRUE(changes().empty());
    plant_figure("shadow_zbuffer", "lamp", "mae", {1.5 * mae_, 2 * mae_});
    auto found = changes();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].lines[0].find("below its range"), std::string::npos) << found[0].lines[0];
    plant_figure("shadow_zbuffer", "lamp", "mae", {0.5 * mae_, 0.9 * mae_});
    found = changes();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].lines[0].find("above its range"), std::string::npos) << found[0].lines[0];
    accept();
    EXPECT_EQ(Json::parse(text_of(golden("figures.json")))["methods"]["shadow_zbuffer"]["lamp"]["mae"], mae_);
}

TEST_F(AcceptedFigures, OnAnotherMachineEdgesMayDifferAndNothingElse) {
    const auto from_elsewhere = [&] {
        Json record       = Json::parse(text_of(golden("figures.json")));
        record["machine"] = "an abacus";
        std::ofstream(golden("figures.json")) << record.dump();
    };
    const PreparedScene prepared = prepare_scene(scene_, {96, 54});
    const MethodRun run = run_method(parse_method("shadow_volumes"), prepared.scene, prepared.facts, prepared.points);
    const auto band     = edge_band(prepared.points, 0, run.planes[0], kHardTolerance);
    const auto edge     = static_cast<int>(std::find(band.begin(), band.end(), 1) - band.begin());
    const auto invert   = [](float s) { return 1 - s; };
    plant("shadow_volumes", "S.lamp", edge % 96, edge / 96, invert);
    EXPECT_FALSE(changes().at(0).rounding);
    from_elsewhere();
    EXPECT_TRUE(changes().at(0).rounding);
    plant("shadow_volumes", "S.lamp", 2, 50, invert);
    EXPECT_FALSE(changes().at(0).rounding);
}

}  // namespace
}  // namespace umbra
