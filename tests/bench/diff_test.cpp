#include "umbra/bench/gate/diff.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <regex>

#include "umbra/bench/gate/diff_record.h"
#include "umbra/bench/gate/diff_set.h"
#include "umbra/bench/gate/diff_views.h"
#include "umbra/bench/gate/difference_map.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/written_parts.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

class Diff : public testing::Test {
protected:
    Diff() { fs::create_directories(folder); }
    ~Diff() override { fs::remove_all(folder); }
    fs::path folder = fs::temp_directory_path() /
                      ("diff." + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "." +
                       std::to_string(getpid()));

    /// 64x64 of 0.1, a box of 11x11 pixels from (5, 17) with another green.
    [[nodiscard]] fs::path box(const char* name, float green,
                               std::vector<std::string> channels = {"R", "G", "B"}) const {
        Image image(64, 64, std::move(channels));
        std::fill(image.data.begin(), image.data.end(), 0.1f);
        for (std::size_t y = 17; y <= 27; ++y)
            for (std::size_t x = 5; x <= 15; ++x) image.at(y * 64 + x, 1) = green;
        write_image(folder / name, image);
        return folder / name;
    }
    [[nodiscard]] fs::path written(const char* name, const Image& image) const {
        write_image(folder / name, image);
        return folder / name;
    }
};

Verdict verdict(const fs::path& a, const fs::path& b, const DiffOptions& options) {
    return diff(a, b, options).verdict;
}

TEST_F(Diff, EqualsIdiff) {
    const DiffResult result = diff(box("a.exr", 0.1f), box("b.exr", 0.6f), {.fail = 0.1});
    EXPECT_EQ(result.verdict, Verdict::differs);
    EXPECT_EQ(result.reasons, std::vector<std::string>{"largest difference 0.5 is above 0.1"});
    const nlohmann::json json = diff_json(result);
    EXPECT_NEAR(json["mae"].get<double>(), 0.0049235, 5e-8);
    EXPECT_NEAR(json["rmse"].get<double>(), 0.049616, 5e-7);
    EXPECT_NEAR(json["psnr"].get<double>(), 26.0876, 5e-5);
    EXPECT_NEAR(json["max"].get<double>(), 0.5, 1e-7);
    EXPECT_EQ(json["worst"], (nlohmann::json{{"x", 5}, {"y", 17}, {"channel", "G"}, {"a", 0.1f}, {"b", 0.6f}}));
    EXPECT_EQ(json["pixels_over"], 121);
    EXPECT_EQ(json["flip"]["kind"], "hdr");
    EXPECT_GT(json["flip"]["mean"].get<double>(), 0.005);
    EXPECT_LT(json["ssim"].get<double>(), 0.99);
    EXPECT_EQ(json["channels"][1]["name"], "G");
    EXPECT_EQ(json["channels"][0]["max"], 0.0);

    const std::string text = diff_text(result);
    EXPECT_NE(text.find("  MAE     0.0049235"), std::string::npos) << text;
    EXPECT_NE(text.find("\n  max     0.5\n  worst   (5, 17), channel G: A 0.1, B 0.6\n"), std::string::npos) << text;
    EXPECT_EQ(diff_line(result),
              "differs    a.exr: largest difference 0.5 is above 0.1; worst (5, 17), channel G: A 0.1, B 0.6");
    EXPECT_NE(text.find("  pixels  121 differ (2.95 %), 121 beyond the limit (2.95 %)\n"), std::string::npos) << text;
    const nlohmann::json& flip = json["flip"];
    EXPECT_LT(flip["first_quartile"], flip["third_quartile"]);
    EXPECT_LE(flip["first_quartile"], flip["weighted_median"]);
    EXPECT_LE(flip["weighted_median"], flip["third_quartile"]);
    EXPECT_LE(flip["third_quartile"], flip["max"]);
    EXPECT_NE(text.find("\ndiffers: largest difference 0.5 is above 0.1\n"), std::string::npos) << text;
}

TEST_F(Diff, ExitCodesFollowTheLimits) {
    const fs::path a = box("a.exr", 0.1f);
    const fs::path b = box("b.exr", 0.6f);
    EXPECT_EQ(verdict(a, a, {}), Verdict::same);
    EXPECT_EQ(verdict(a, b, {}), Verdict::differs);
    EXPECT_EQ(verdict(a, b, {.fail = 0.51}), Verdict::close);
    EXPECT_EQ(verdict(a, b, {.fail = 0.49}), Verdict::differs);
    EXPECT_EQ(verdict(a, b, {.warn = 0.51}), Verdict::same);
    EXPECT_EQ(verdict(a, box("c.exr", 0.1f + 5e-7f), {}), Verdict::close);  // rounding
    // 121 of 4096 pixels are 2.95 %
    EXPECT_EQ(verdict(a, b, {.fail = 0.1, .fail_percent = 3}), Verdict::close);
    EXPECT_EQ(verdict(a, b, {.fail = 0.1, .fail_percent = 2.9}), Verdict::differs);
    // A limit on something else alone leaves the largest difference free.
    EXPECT_EQ(verdict(a, b, {.fail_rmse = 0.05}), Verdict::close);
    EXPECT_EQ(verdict(a, b, {.fail_rmse = 0.049}), Verdict::differs);
    EXPECT_EQ(verdict(a, b, {.fail_psnr = 26}), Verdict::close);
    EXPECT_EQ(verdict(a, b, {.fail_psnr = 27}), Verdict::differs);
    const DiffResult measured = diff(a, b, {});
    EXPECT_EQ(verdict(a, b, {.fail_flip = measured.flip.mean + 1e-3}), Verdict::close);
    EXPECT_EQ(verdict(a, b, {.fail_flip = measured.flip.mean - 1e-3}), Verdict::differs);
    EXPECT_EQ(verdict(a, b, {.fail_ssim = measured.ssim - 1e-3}), Verdict::close);
    EXPECT_EQ(verdict(a, b, {.fail_ssim = measured.ssim + 1e-3}), Verdict::differs);
    // All limits must be met, and every one that is missed is named.
    EXPECT_EQ(diff(a, b, {.fail = 0.1, .fail_rmse = 0.04, .fail_psnr = 26}).reasons.size(), 2u);
}

TEST_F(Diff, EqualImagesHaveNoNumberForInfinity) {
    const nlohmann::json json = diff_json(diff(box("a.exr", 0.3f), box("b.exr", 0.3f), {}));
    EXPECT_EQ(json["verdict"], "same");
    EXPECT_EQ(json["exit_code"], 0);
    EXPECT_TRUE(json["psnr"].is_null());
    EXPECT_EQ(json["ssim"], 1.0);
    EXPECT_EQ(json["flip"]["mean"], 0.0);
    EXPECT_EQ(json["worst"]["channel"], "R");
}

TEST_F(Diff, ManyNamedChannelsInAnyOrder) {
    Image a(8, 8, {"R", "G", "B", "S.lamp", "S.sun"});
    Image b(8, 8, {"S.sun", "R", "G", "B", "S.lamp"});
    b.at(19, 0)             = 0.25f;
    const DiffResult result = diff(written("a.exr", a), written("b.exr", b), {});
    EXPECT_EQ(result.verdict, Verdict::differs);
    EXPECT_EQ(diff_json(result)["worst"],
              (nlohmann::json{{"x", 3}, {"y", 2}, {"channel", "S.sun"}, {"a", 0.0}, {"b", 0.25}}));
    EXPECT_EQ(result.flip.mean, 0);  // R, G, B are equal
    EXPECT_NE(diff_text(result).find("  S.sun: MAE 0.00390625, RMSE 0.03125, max 0.25 at (3, 2)"), std::string::npos)
        << diff_text(result);
}

TEST_F(Diff, OneTwoAndFourChannels) {
    for (const std::vector<std::string>& channels :
         {std::vector<std::string>{"S.lamp"}, {"U", "V"}, {"R", "G", "B", "A"}}) {
        Image a(12, 12, channels);
        Image b   = a;
        b.data[0] = 0.5f;
        EXPECT_EQ(verdict(written("a.exr", a), written("b.exr", b), {}), Verdict::differs);
        EXPECT_GT(diff(written("a.exr", a), written("b.exr", b), {}).flip.mean, 0);
    }
}

using other_writers::part;
using other_writers::write_parts;

TEST_F(Diff, EveryPartIsCompared) {
    write_parts(folder / "a.exr", {part("rgb", {"R", "G", "B"}, 0.25f), part("depth", {"Z"}, 7)});
    write_parts(folder / "b.exr", {part("rgb", {"R", "G", "B"}, 0.25f), part("depth", {"Z"}, 8)});
    write_parts(folder / "one.exr", {part("", {"R", "G", "B"}, 0.25f)});
    EXPECT_EQ(verdict(folder / "a.exr", folder / "a.exr", {}), Verdict::same);
    const DiffResult result = diff(folder / "a.exr", folder / "b.exr", {});
    EXPECT_EQ(result.verdict, Verdict::differs);
    EXPECT_EQ(worst_pixel(result), "(0, 0), channel depth.Z: A 7, B 8");
    EXPECT_EQ(verdict(folder / "a.exr", folder / "b.exr", {.channels = {"R", "G", "B"}}), Verdict::same);
    const DiffResult unlike = diff(folder / "a.exr", folder / "one.exr", {});
    EXPECT_EQ(unlike.verdict, Verdict::unlike);
    EXPECT_EQ(unlike.reasons[0].find("channels differ: only the first has [depth.Z], only the second []"), 0u)
        << unlike.reasons[0];

    for (const auto& [name, value] : {std::pair{"a.tif", 0.5f}, {"b.tif", 0.75f}})
        write_parts(folder / name, {part("", {"R", "G", "B"}, 0.25f), part("", {"R", "G", "B"}, value)});
    const DiffResult pages = diff(folder / "a.tif", folder / "b.tif", {.fail = 1, .fail_flip = 1e-3});
    EXPECT_EQ(pages.verdict, Verdict::differs);
    EXPECT_EQ(layer_of_flip(pages), "2, worst of 2 layers");
}

TEST_F(Diff, EveryLayerIsSeen) {
    Image a(32, 32, {"diffuse.R", "diffuse.G", "diffuse.B", "spec.R", "spec.G", "spec.B"});
    std::fill(a.data.begin(), a.data.end(), 0.25f);
    Image b = a;
    for (std::size_t i = 0; i < 300; ++i)
        for (std::size_t c = 3; c < 6; ++c) b.at(i, c) = 0.75f;
    const fs::path file_a = written("a.exr", a), file_b = written("b.exr", b);
    const DiffResult result = diff(file_a, file_b, {.fail = 1, .fail_flip = 0.001});
    EXPECT_EQ(result.verdict, Verdict::differs);
    EXPECT_EQ(verdict(file_a, file_b, {.fail = 1, .fail_ssim = 0.999}), Verdict::differs);
    const nlohmann::json json = diff_json(result);
    EXPECT_EQ(json["layers"][0]["name"], "diffuse");
    EXPECT_EQ(json["layers"][0]["flip"], 0.0);
    EXPECT_EQ(json["layers"][0]["ssim"], 1.0);
    EXPECT_EQ(json["layers"][1]["name"], "spec");
    EXPECT_EQ(json["layers"][1]["flip"], json["flip"]["mean"]);
    EXPECT_EQ(json["layers"][1]["ssim"], json["ssim"]);
    EXPECT_NE(diff_text(result).find("(mean, HDR; spec, worst of 2 layers)"), std::string::npos) << diff_text(result);
    // As of the layer alone.
    const DiffResult alone = diff(file_a, file_b, {.channels = {"spec.*"}});
    EXPECT_EQ(alone.flip.mean, result.flip.mean);
    EXPECT_EQ(alone.ssim, result.ssim);

    // The pictures and the map show the layer that differs.
    EXPECT_EQ(diff(file_a, file_b, {.map = folder / "map.exr", .pictures = folder / "shown"}).verdict,
              Verdict::differs);
    EXPECT_LT(read_image(folder / "shown.a.png").image.at(0, 0), read_image(folder / "shown.b.png").image.at(0, 0));
    const Image map = read_image(folder / "map.exr").image;
    EXPECT_NE(std::find(map.channels.begin(), map.channels.end(), "FLIP.spec"), map.channels.end());

    // Without R, G, B every channel is a grey picture; what is beside R, G, B is none, which is said.
    Image grey(32, 32, {"first", "second"}), other = grey;
    for (std::size_t i = 0; i < 300; ++i) other.at(i, 1) = 0.5f;
    EXPECT_EQ(verdict(written("a.exr", grey), written("b.exr", other), {.fail_flip = 0.001}), Verdict::differs);
    Image beside(32, 32, {"R", "G", "B", "Z"}), deeper = beside;
    for (std::size_t i = 0; i < 300; ++i) deeper.at(i, 3) = 0.5f;
    const DiffResult depth = diff(written("a.exr", beside), written("b.exr", deeper), {.fail_flip = 0.001});
    EXPECT_EQ(depth.verdict, Verdict::close);
    EXPECT_EQ(depth.notes,
              std::vector<std::string>{"SSIM and FLIP are of the layers of R, G, B; Z differ and are in neither"});
}

TEST_F(Diff, WholeNumbersAreComparedToTheLastDigit) {
    for (const bool alone : {false, true}) {
        Image a(6, 4, {"R", "G", "B"});
        a.integers["id.face"] = std::vector<std::uint32_t>(24, 4294967295u);
        Image b               = a;
        b.integers["id.face"][8] -= 1;  // one float with the other
        DiffOptions options{.fail = 1e9, .fail_percent = 100};
        if (alone) options.channels = {"id.*"};
        EXPECT_EQ(verdict(written("a.exr", a), written("a2.exr", a), options), Verdict::same);
        const DiffResult result = diff(folder / "a.exr", written("b.exr", b), options);
        EXPECT_EQ(result.verdict, Verdict::differs);
        EXPECT_EQ(result.reasons,
                  std::vector<std::string>{
                      "whole numbers id.face differ at 1 pixels, the first (2, 1): A 4294967295, B 4294967294"});
        EXPECT_EQ(worst_pixel(result), "(2, 1), channel id.face: A 4294967295, B 4294967294");
    }
    EXPECT_EQ(verdict(folder / "a.exr", folder / "b.exr", {.channels = {"R", "G", "B"}}), Verdict::same);
    EXPECT_EQ(verdict(folder / "a.exr", box("c.exr", 0.1f), {}), Verdict::unlike);
}

TEST_F(Diff, WhatFilesSayOfTheirColoursIsCompared) {
    const auto plain = part("", {"R", "G", "B"}, 0.5f);
    auto aces = plain, in_frame = plain;
    const float xy[8] = {0.7347f, 0.2653f, 0, 1, 0.0001f, -0.077f, 0.32168f, 0.33767f};
    aces.spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy);
    in_frame.spec.full_width = 40;
    for (const auto& [name, of] : {std::pair{"plain.exr", plain}, {"aces.exr", aces}, {"frame.exr", in_frame}})
        write_parts(folder / name, {of});
    EXPECT_EQ(verdict(folder / "aces.exr", folder / "aces.exr", {}), Verdict::same);
    const DiffResult colours = diff(folder / "plain.exr", folder / "aces.exr", {});
    EXPECT_EQ(colours.verdict, Verdict::unlike);
    EXPECT_EQ(colours.reasons,
              std::vector<std::string>{"colours differ: nothing said against chromaticities 0.7347 0.2653 0 1 0.0001 "
                                       "-0.077 0.3217 0.3377"});
    EXPECT_EQ(diff(folder / "frame.exr", folder / "plain.exr", {}).reasons,
              std::vector<std::string>{"display windows differ: 40x8 from (0, 0) against 12x8 from (0, 0)"});
}

TEST_F(Diff, WhatIsNotFiniteIsReportedAndNeverClose) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    Image a(6, 6, {"R", "G", "B", "Z"});
    a.at(7, 3) = kInfinity;  // no surface there, in both
    a.at(8, 0) = nan;
    Image b    = a;
    EXPECT_EQ(verdict(written("a.exr", a), written("b.exr", b), {}), Verdict::same);
    b.at(9, 0)              = nan;
    const DiffResult result = diff(written("a.exr", a), written("b.exr", b), {.fail = 1e9, .fail_percent = 100});
    EXPECT_EQ(result.verdict, Verdict::differs);
    const nlohmann::json json = nlohmann::json::parse(diff_json(result).dump());
    EXPECT_EQ(json["not_finite"], 3);
    EXPECT_EQ(json["unlike_not_finite"], 1);
    EXPECT_EQ(json["max"], 0.0);
    EXPECT_EQ(json["worst"]["x"], 3);
    EXPECT_EQ(json["worst"]["y"], 1);
    EXPECT_EQ(json["worst"]["a"], 0.0);
    EXPECT_TRUE(json["worst"]["b"].is_null());
    EXPECT_NE(diff_text(result).find("(3, 1), channel R: A 0, B nan"), std::string::npos) << diff_text(result);
    EXPECT_NE(diff_text(result).find("3 values are not finite, 1 of them unlike"), std::string::npos);
}

TEST_F(Diff, UnlikeImagesSayWhy) {
    const fs::path a       = box("a.exr", 0.1f);
    const DiffResult sizes = diff(a, written("b.exr", Image(64, 63, {"R", "G", "B"})), {});
    EXPECT_EQ(sizes.verdict, Verdict::unlike);
    EXPECT_EQ(sizes.reasons, std::vector<std::string>{"sizes differ: 64x64 against 64x63"});
    const DiffResult channels = diff(a, box("c.exr", 0.1f, {"R", "G", "B", "S.lamp"}), {});
    EXPECT_EQ(channels.verdict, Verdict::unlike);
    EXPECT_EQ(
        channels.reasons,
        std::vector<std::string>{"channels differ: only the first has [], only the second [S.lamp], both [R G B]; to "
                                 "compare those of both: --channels \"R,G,B\""});
    EXPECT_EQ(diff_json(channels)["exit_code"], 3);
    EXPECT_FALSE(diff_json(channels).contains("mae"));
    EXPECT_EQ(diff_text(channels), "unlike: " + channels.reasons[0] + "\n");
}

TEST_F(Diff, UnreadableFilesSayWhichAndWhy) {
    std::ofstream(folder / "text.exr") << "no image";
    const DiffResult result = diff(folder / "text.exr", folder / "none.png", {});
    EXPECT_EQ(result.verdict, Verdict::unreadable);
    ASSERT_EQ(result.reasons.size(), 2u);
    EXPECT_NE(result.reasons[0].find("text.exr: cannot read image: "), std::string::npos);
    EXPECT_NE(result.reasons[1].find("none.png: no such file"), std::string::npos);
    EXPECT_EQ(diff_json(result)["exit_code"], 4);
}

TEST_F(Diff, LinearAgainstEncodedComparesWhatIsShown) {
    Image linear(16, 16, {"R", "G", "B"});
    for (std::size_t k = 0; k < linear.data.size(); ++k) linear.data[k] = float(k) / 700;  // some above 1
    Image encoded = linear;
    for (float& x : encoded.data) x = srgb_from_linear(std::min(x, 1.0f));
    const DiffResult result = diff(written("a.exr", linear), written("b.png", encoded), {.fail = 0.5 / 255 + 1e-6});
    EXPECT_EQ(result.verdict, Verdict::close);
    EXPECT_FALSE(result.hdr);
    ASSERT_EQ(result.notes.size(), 1u);
    EXPECT_EQ(verdict(folder / "b.png", folder / "a.exr", {.fail = 0.5 / 255 + 1e-6}), Verdict::close);
}

TEST_F(Diff, ChannelsChooseWhatIsCompared) {
    const fs::path a = box("a.exr", 0.1f, {"R", "G", "B", "Z"});
    const fs::path b = box("b.exr", 0.6f, {"R", "G", "B", "S.lamp"});
    EXPECT_EQ(verdict(a, b, {}), Verdict::unlike);
    EXPECT_EQ(verdict(a, b, {.channels = {"R", "G", "B"}}), Verdict::differs);
    const DiffResult equal = diff(a, b, {.channels = {"B", "R"}});
    EXPECT_EQ(equal.verdict, Verdict::same);
    EXPECT_EQ(equal.channels, (std::vector<std::string>{"R", "B"}));
    EXPECT_EQ(verdict(a, b, {.channels = {"[RB]"}}), Verdict::same);

    const DiffResult only_one = diff(a, b, {.channels = {"R", "S.*"}});
    EXPECT_EQ(only_one.verdict, Verdict::unlike);
    EXPECT_EQ(only_one.reasons[0].find("channels differ: only the first has [], only the second [S.lamp], both [R]"),
              0u);
    const DiffResult none = diff(a, b, {.channels = {"R", "T.*"}});
    EXPECT_EQ(none.verdict, Verdict::unlike);
    EXPECT_EQ(none.reasons,
              std::vector<std::string>{"no channel is called T.*: the first has [R G B Z], the second [R G B S.lamp]"});
}

bool is_grey(const Image& picture, std::size_t x, std::size_t y) {
    const std::size_t i = y * std::size_t(picture.width) + x;
    return picture.at(i, 0) == picture.at(i, 1) && picture.at(i, 1) == picture.at(i, 2);
}

TEST_F(Diff, MapInColoursHasAScaleAndHidesNothing) {
    Image a(300, 200, {"R", "G", "B"});
    std::fill(a.data.begin(), a.data.end(), 0.5f);
    Image b                  = a;
    const auto pixel         = [](std::size_t x, std::size_t y) { return y * 300 + x; };
    b.at(pixel(40, 50), 1)   = 0.5f + 0.3f;
    b.at(pixel(200, 60), 2)  = 0.5f - 1e-6f;  // the smallest differences are found, too
    b.at(pixel(120, 150), 0) = std::numeric_limits<float>::quiet_NaN();
    const DifferenceMap map  = difference_map(a, b, true);
    const Image& p           = map.picture;
    EXPECT_DOUBLE_EQ(map.range, 0.5);
    EXPECT_GT(p.at(pixel(40, 50), 0), p.at(pixel(40, 50), 2) + 0.2f);    // red: B is larger
    EXPECT_GT(p.at(pixel(200, 60), 2), p.at(pixel(200, 60), 0) + 0.2f);  // blue: B is smaller
    EXPECT_LT(p.at(pixel(120, 150), 2), 0.1f);                           // yellow: not finite
    EXPECT_GT(p.at(pixel(120, 150), 1), 0.8f);
    EXPECT_TRUE(is_grey(p, 280, 180));
    EXPECT_GT(p.at(pixel(280, 180), 0), 0.85f);
    for (const auto& [x, y] : {std::pair{40, 50}, {200, 60}, {120, 150}})  // a black ring of 8 pixels around each
        EXPECT_EQ(p.at(pixel(std::size_t(x) + 8, std::size_t(y)), 0), 0) << x;

    for (std::size_t y = 100; y < 140; ++y)
        for (std::size_t x = 20; x < 60; ++x) b.at(pixel(x, y), 1) = 0.9f;  // too large for a ring
    const Image large = difference_map(a, b, true).picture;
    for (std::size_t x = 60; x < 100; ++x) EXPECT_GT(large.at(pixel(x, 120), 0), 0.85f) << x;
    EXPECT_EQ(difference_map(a, a, true).range, 0);
}

TEST_F(Diff, MapFiles) {
    const fs::path a        = box("a.exr", 0.1f);
    const fs::path b        = box("b.exr", 0.6f);
    const DiffResult result = diff(a, b, {.map = folder / "map.png"});
    EXPECT_NE(diff_text(result).find("blue -0.5 to red +0.5"), std::string::npos) << diff_text(result);
    EXPECT_EQ(diff(a, b, {.map = folder / "map.exr"}).verdict, Verdict::differs);
    const Image colours = read_image(folder / "map.png").image;
    const Image full    = read_image(folder / "map.exr").image;
    ASSERT_EQ(colours.channels.size(), 3u);
    const auto channel = [&](const char* name) {
        return std::size_t(std::find(full.channels.begin(), full.channels.end(), name) - full.channels.begin());
    };
    const std::size_t inside = 22 * 64 + 10;
    EXPECT_NEAR(full.at(inside, channel("difference.G")), 0.5, 1e-6);
    EXPECT_EQ(full.at(inside, channel("difference.R")), 0);
    EXPECT_EQ(full.at(inside, channel("FLIP")), result.flip.map[inside]);
    EXPECT_NEAR(colours.at(inside, 0), 0x67 / 255.0, 0.51 / 255);  // the end of the scale
    EXPECT_NEAR(colours.at(inside, 1), 0, 0.51 / 255);
    EXPECT_TRUE(is_grey(colours, 60, 60));
    EXPECT_THROW(static_cast<void>(diff(a, b, {.map = folder / "no" / "map.png"})), InputError);
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(Diff, FoldersAreComparedImageByImage) {
    const fs::path a = folder / "a", b = folder / "b";
    fs::create_directories(a / "deep");
    fs::create_directories(b / "deep");
    static_cast<void>(box("a/equal.png", 0.1f));
    static_cast<void>(box("b/equal.png", 0.1f));
    static_cast<void>(box("a/deep/other.exr", 0.1f));
    static_cast<void>(box("b/deep/other.exr", 0.6f));
    static_cast<void>(box("a/gone <&>.png", 0.1f));
    static_cast<void>(box("b/new.png", 0.1f));
    std::ofstream(a / "notes.txt") << "no image";
    // What a killed run left is no image of the folder's.
    fs::create_directories(a / ".deep.umbra-new");
    static_cast<void>(box("a/.umbra-part.equal.png", 0.1f));
    static_cast<void>(box("a/.deep.umbra-new/other.exr", 0.1f));

    std::vector<std::string> progress;
    const fs::path page = folder / "page.html";
    DiffSet set         = diff_set(a, b, {.map = folder / "maps", .pictures = diff_pictures_folder(page)},
                                   [&](const std::string& name) { progress.push_back(name); });
    std::vector<std::string> names;
    for (const DiffResult& image : set.images) names.push_back(image.name);
    EXPECT_EQ(names, (std::vector<std::string>{"deep/other.exr", "equal.png", "gone <&>.png", "new.png"}));
    EXPECT_EQ(progress, names);
    EXPECT_EQ(set.worst(), Verdict::differs);
    EXPECT_EQ(set.images[2].reasons, std::vector<std::string>{"missing in " + b.string()});
    EXPECT_EQ(set.images[3].reasons, std::vector<std::string>{"missing in " + a.string()});
    const std::string text = diff_set_text(set);
    EXPECT_NE(text.find("same       equal.png\n"), std::string::npos) << text;
    EXPECT_NE(text.find("\n4 images: 1 same, 3 differs\n"), std::string::npos) << text;
    EXPECT_EQ(diff_set_json(set)["counts"]["differs"], 3);
    EXPECT_EQ(diff_set_json(set)["exit_code"], 2);
    EXPECT_TRUE(fs::exists(folder / "maps/deep/other.exr.png"));
    EXPECT_FALSE(fs::exists(folder / "maps/equal.png.png"));

    const std::string junit = diff_set_junit(set);
    EXPECT_NE(junit.find("<testsuite name=\"umbra diff\" tests=\"4\" failures=\"3\" errors=\"0\">"), std::string::npos)
        << junit;
    EXPECT_NE(junit.find("<testcase classname=\"umbra.diff\" name=\"equal.png\"/>"), std::string::npos);
    EXPECT_NE(junit.find("name=\"gone &lt;&amp;&gt;.png\">\n<failure type=\"differs\""), std::string::npos);
    EXPECT_NE(junit.find("(5, 17), channel G: A 0.1, B 0.6"), std::string::npos);

    write_diff_page(page, set);
    const std::string html = text_of(page);
    EXPECT_NE(html.find("3 of 4 images differ"), std::string::npos) << html;
    EXPECT_EQ(html.find("gone <&>"), std::string::npos);
    std::size_t pictures = 0;  // every picture that the page shows exists
    const std::regex source("<img src=\"([^\"]*)\""), slash("&#x2F;");
    for (std::sregex_iterator found(html.begin(), html.end(), source), end; found != end; ++found, ++pictures) {
        const std::string path = std::regex_replace((*found)[1].str(), slash, std::string("/"));
        EXPECT_TRUE(fs::exists(folder / path)) << path;
    }
    EXPECT_EQ(pictures, 3u);

    // The worst exit code wins; equal folders are the same.
    std::ofstream(b / "equal.png") << "no image";
    set = diff_set(a, b, {}, {});
    EXPECT_EQ(set.worst(), Verdict::unreadable);
    EXPECT_NE(diff_set_junit(set).find("<error type=\"unreadable\""), std::string::npos);
    EXPECT_EQ(diff_set(a, a, {}, {}).worst(), Verdict::same);
    fs::create_directory(folder / "empty");
    EXPECT_THROW(static_cast<void>(diff_set(folder / "empty", folder / "empty", {}, {})), InputError);
    EXPECT_EQ(diff_set(a, folder / "empty", {}, {}).count(Verdict::differs), 3u);
    EXPECT_THROW(static_cast<void>(diff_set(a, page, {}, {})), UsageError);
}

/// One image the same, one within the limit, one beyond: 121 pixels of one channel in three differ by 0.5.
TEST_F(Diff, PageShowsFiguresAndPictures) {
    for (const char* side : {"a", "b"}) fs::create_directories(folder / side);
    for (const auto& [name, green] : {std::pair{"a/same.exr", 0.2f},
                                      {"b/same.exr", 0.2f},
                                      {"a/close.exr", 0.1f},
                                      {"b/close.exr", 0.15f},
                                      {"a/differs.exr", 0.1f},
                                      {"b/differs.exr", 0.6f}})
        static_cast<void>(box(name, green));
    DiffOptions options{.fail = 0.1};
    options.pictures = diff_pictures_folder(folder / "page.html");
    write_diff_page(folder / "page.html", diff_set(folder / "a", folder / "b", options, {}));
    std::ifstream in(folder / "page.html");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    const auto has = [&](const char* text) { return page.find(text) != std::string::npos; };
    EXPECT_TRUE(has("1 of 3 images differ"));
    // Largest difference, RMSE, MAE, ... pixels that differ, beyond the limit.
    EXPECT_TRUE(has("<td class=\"differs\">differs</td><td>0.500</td><td>0.0496</td><td>0.00492</td><td>26.09 dB</td>"))
        << page;
    EXPECT_TRUE(has("<td>121</td><td>121</td><td>largest difference 0.5 is above 0.1</td>"));
    EXPECT_TRUE(has("<td>121</td><td>0</td><td></td>")) << "close";
    EXPECT_TRUE(
        has("<a href=\"page.files/differs.exr.a.png\"><img src=\"page.files/differs.exr.a.png\" width=\"64\" "
            "height=\"64\" loading=\"lazy\" alt=\"A\">"));
    EXPECT_TRUE(
        has("<img src=\"page.files/differs.exr.b.png\" width=\"64\" height=\"64\" loading=\"lazy\" alt=\"B\">"));
    // A is dark where B has the bright box.
    EXPECT_LT(read_image(folder / "page.files/differs.exr.a.png").image.at(20 * 64 + 10, 1),
              read_image(folder / "page.files/differs.exr.b.png").image.at(20 * 64 + 10, 1));
}

/// What is within the limits passes; beyond them and other sizes are failures; what cannot be read is an error.
TEST_F(Diff, JunitCountsEachVerdict) {
    DiffSet set{"a", "b", true, {}};
    for (const Verdict v : {Verdict::same, Verdict::close, Verdict::close, Verdict::differs, Verdict::differs,
                            Verdict::unlike, Verdict::unreadable, Verdict::unreadable}) {
        set.images.emplace_back();
        set.images.back().verdict = v;
        set.images.back().name    = to_string(v);
    }
    const std::string text = diff_set_junit(set);
    EXPECT_NE(text.find("tests=\"8\" failures=\"3\" errors=\"2\""), std::string::npos) << text;
    EXPECT_NE(text.find("name=\"close\"/>"), std::string::npos) << text;
    EXPECT_EQ(text.find("<failure type=\"close\""), std::string::npos) << text;
    EXPECT_EQ(set.worst(), Verdict::unreadable);
}

TEST_F(Diff, JunitOfAPairAndNamesThatAreNoText) {
    const fs::path a    = box("a\x01\xff.exr", 0.1f);
    const DiffSet equal = diff_set(a, a, {}, {});
    EXPECT_NE(diff_set_junit(equal).find("tests=\"1\" failures=\"0\""), std::string::npos);
    EXPECT_NE(diff_set_junit(equal).find("name=\"a?\xef\xbf\xbd.exr\"/>"), std::string::npos) << diff_set_junit(equal);
    EXPECT_EQ(diff_set_text(equal), diff_text(equal.images[0]));
    const DiffSet differs = diff_set(a, box("b.exr", 0.6f), {}, {});
    EXPECT_NE(diff_set_junit(differs).find("failures=\"1\""), std::string::npos);
    write_diff_page(folder / "pair.html", differs);
    EXPECT_NE(text_of(folder / "pair.html").find("The images: differs"), std::string::npos);
}

}  // namespace
}  // namespace umbra
