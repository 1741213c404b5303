#include "umbra/bench/diff/diff.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "umbra/core/base/error.h"

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
    EXPECT_EQ(json["worst"], (nlohmann::json{{"x", 5}, {"y", 17}, {"channel", "G"}}));
    EXPECT_EQ(json["pixels_over"], 121);
    EXPECT_EQ(json["flip"]["kind"], "hdr");
    EXPECT_GT(json["flip"]["mean"].get<double>(), 0.005);
    EXPECT_LT(json["ssim"].get<double>(), 0.99);
    EXPECT_EQ(json["channels"][1]["name"], "G");
    EXPECT_EQ(json["channels"][0]["max"], 0.0);

    const std::string text = diff_text(result);
    EXPECT_NE(text.find("  MAE     0.0049235"), std::string::npos) << text;
    EXPECT_NE(text.find("max     0.5 at (5, 17), channel G"), std::string::npos) << text;
    EXPECT_NE(text.find("121 beyond the limit"), std::string::npos) << text;
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
    EXPECT_EQ(diff_json(result)["worst"], (nlohmann::json{{"x", 3}, {"y", 2}, {"channel", "S.sun"}}));
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
    EXPECT_NE(diff_text(result).find("3 values are not finite, 1 of them unlike"), std::string::npos);
}

TEST_F(Diff, UnlikeImagesSayWhy) {
    const fs::path a       = box("a.exr", 0.1f);
    const DiffResult sizes = diff(a, written("b.exr", Image(64, 63, {"R", "G", "B"})), {});
    EXPECT_EQ(sizes.verdict, Verdict::unlike);
    EXPECT_EQ(sizes.reasons, std::vector<std::string>{"sizes differ: 64x64 against 64x63"});
    const DiffResult channels = diff(a, box("c.exr", 0.1f, {"R", "G", "B", "S.lamp"}), {});
    EXPECT_EQ(channels.verdict, Verdict::unlike);
    EXPECT_EQ(channels.reasons, std::vector<std::string>{
                                    "channels differ: only the first has [], only the second [S.lamp], both [R G B]"});
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

TEST_F(Diff, MapShowsWhere) {
    const fs::path a        = box("a.exr", 0.1f);
    const fs::path b        = box("b.exr", 0.6f);
    const DiffResult result = diff(a, b, {.map = folder / "map.png"});
    EXPECT_EQ(diff(a, b, {.map = folder / "map.exr"}).verdict, Verdict::differs);
    const Image grey = read_image(folder / "map.png").image;
    const Image full = read_image(folder / "map.exr").image;
    ASSERT_EQ(grey.channels.size(), 1u);
    const auto channel = [&](const char* name) {
        return std::size_t(std::find(full.channels.begin(), full.channels.end(), name) - full.channels.begin());
    };
    const std::size_t inside = 22 * 64 + 10;
    const std::size_t corner = 60 * 64 + 60;
    EXPECT_NEAR(full.at(inside, channel("difference.G")), 0.5, 1e-6);
    EXPECT_EQ(full.at(inside, channel("difference.R")), 0);
    EXPECT_EQ(full.at(inside, channel("FLIP")), result.flip.map[inside]);
    EXPECT_NEAR(grey.at(inside, 0), result.flip.map[inside], 0.51 / 255);
    EXPECT_GT(grey.at(inside, 0), 0.3f);
    EXPECT_EQ(grey.at(corner, 0), 0);
    EXPECT_THROW(static_cast<void>(diff(a, b, {.map = folder / "no" / "map.png"})), InputError);
}

}  // namespace
}  // namespace umbra
