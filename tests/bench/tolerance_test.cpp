#include "umbra/bench/gate/tolerance.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/shell.h"
#include "umbra/bench/gate/diff.h"
#include "umbra/bench/gate/diff_record.h"
#include "umbra/bench/gate/diff_set.h"
#include "umbra/bench/gate/diff_views.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 32, kHeight = 16;  // 512 pixels: one is 0.1953125 %

std::size_t pixel(int x, int y) { return std::size_t(y) * kWidth + std::size_t(x); }

class ToleranceFile : public testing::Test {
protected:
    ToleranceFile() : a(kWidth, kHeight, {"R", "G", "B"}) {
        std::fill(a.data.begin(), a.data.end(), 0.5f);
        b = a;
    }
    static void set(Image& image, int x, int y, float value) {
        for (std::size_t c = 0; c < 3; ++c) image.at(pixel(x, y), c) = value;
    }
    /// The pair under a rule, a JSON text.
    [[nodiscard]] DiffResult under(const std::string& rule) const {
        return under_file(R"({"images": [{"name": "*.exr", "passes": )" + rule + "}]}");
    }
    [[nodiscard]] DiffResult under_file(const std::string& text) const {
        write_image(folder.path() / "a.exr", a);
        write_image(folder.path() / "b.exr", b);
        DiffOptions options;
        options.tolerance = std::make_shared<Tolerance>(read_tolerance(folder.write("tolerance.json", text)));
        return diff(folder.path() / "a.exr", folder.path() / "b.exr", options);
    }
    [[nodiscard]] Verdict verdict(const std::string& rule) const { return under(rule).verdict; }
    [[nodiscard]] std::string refusal(const std::string& text) const {
        try {
            static_cast<void>(read_tolerance(folder.write("tolerance.json", text)));
        } catch (const InputError& error) {
            return std::string(error.what()).substr((folder.path() / "").string().size());
        }
        return "accepted";
    }

    TemporaryFolder folder;
    Image a, b;
};

TEST_F(ToleranceFile, LimitOfEachPixel) {
    set(b, 3, 4, 0.625f);
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.125}})"), Verdict::close);
    const DiffResult result = under(R"({"pixels": {"limit": 0.12}})");
    EXPECT_EQ(result.verdict, Verdict::differs);
    EXPECT_EQ(result.reasons, std::vector<std::string>{"1 pixels (0.1953 %) differ by more than 0.12 (allowed: 0 %)"});
    EXPECT_EQ(result.error.over, 1u);  // the page's column has the rule's limit
    b = a;
    EXPECT_EQ(under(R"({"pixels": {"limit": 0}})").verdict, Verdict::same);
}

TEST_F(ToleranceFile, FractionOfPixels) {
    for (int x = 0; x < 5; ++x) set(b, 6 * x, 2, 0.75f);  // 0.977 %
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1, "percent": 0.98}})"), Verdict::close);
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1, "percent": 0.97}})"), Verdict::differs);
}

/// A bright column that moves by one pixel passes in both columns; what comes or goes does not.
TEST_F(ToleranceFile, ShiftLooksBothWays) {
    for (int y = 0; y < kHeight; ++y) set(a, 10, y, 1), set(b, 11, y, 1);
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1}})"), Verdict::differs);
    DiffResult result = under(R"({"pixels": {"limit": 0.1, "shift": 1}})");
    EXPECT_EQ(result.verdict, Verdict::close);
    ASSERT_TRUE(result.rules.at(0).conceded);
    EXPECT_EQ(result.rules[0].conceded->shift, 32u);
    EXPECT_EQ(result.rules[0].conceded->sum(), 32u);
    EXPECT_EQ(diff_line(result).find("close      a.exr; 32 pixels pass only by the shift; worst (10, 0)"), 0u)
        << diff_line(result);
    b = a;
    for (int y = 0; y < kHeight; ++y) set(b, 10, y, 0.5f), set(b, 12, y, 1);
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1, "shift": 1}})"), Verdict::differs);
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1, "shift": 2}})"), Verdict::close);

    std::fill(a.data.begin(), a.data.end(), 0.5f);
    b = a;
    set(b, 5, 5, 1);
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1, "shift": 1}})"), Verdict::differs) << "comes";
    std::swap(a, b);
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1, "shift": 1}})"), Verdict::differs) << "goes";
}

/// S steps between x = 15 and 16: pixels whose centre is within 1.5 of 15.5 are 14 to 17.
TEST_F(ToleranceFile, EdgeBandIsNearShadowBoundaries) {
    Image plane(kWidth, kHeight, {"S.sun", "S.lamp"});
    for (int y = 0; y < kHeight; ++y)
        for (int x = 16; x < kWidth; ++x) plane.at(pixel(x, y), 0) = 0.5f;
    write_image(folder.path() / "plane.exr", plane);
    const std::string rule = R"({"pixels": {"limit": 0.1, "edge_band": {"plane": "plane.exr")";
    for (const auto& [x, verdict_there] :
         {std::pair{13, Verdict::differs}, {14, Verdict::close}, {17, Verdict::close}, {18, Verdict::differs}}) {
        b = a;
        set(b, x, 8, 0.9f);
        EXPECT_EQ(verdict(rule + "}}}"), verdict_there) << x;
    }
    EXPECT_EQ(verdict(rule + R"(, "width": 2.5}}})"), Verdict::close);
    EXPECT_EQ(verdict(rule + R"(, "width": 2.5, "channel": "S.lamp"}}})"), Verdict::differs);
    EXPECT_EQ(verdict(rule + R"(, "width": 2.5, "step": 0.6}}})"), Verdict::differs);
    const DiffResult result = under(rule + R"(, "width": 2.5, "channel": "S.sun"}}})");
    EXPECT_EQ(result.rules.at(0).conceded->edge_band, 1u);
    EXPECT_EQ(concessions(*result.rules[0].conceded), "1 pixel passes only by the edge band");

    const DiffResult none = under(rule + R"(, "channel": "S.moon"}}})");
    EXPECT_EQ(none.verdict, Verdict::unreadable);
    EXPECT_EQ(none.reasons,
              std::vector<std::string>{
                  "plane.exr: found channels S.lamp S.sun, expected one that matches S.moon, for the edge "
                  "band"});
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1, "edge_band": {}}})"), Verdict::unreadable) << "A has no S";
    for (Image* image : {&a, &b}) {  // A itself has the plane
        Image with(kWidth, kHeight, {"R", "G", "B", "S.sun"});
        for (std::size_t i = 0; i < with.pixels(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) with.at(i, c) = image->at(i, c);
            with.at(i, 3) = plane.at(i, plane.channels[0] == "S.sun" ? 0 : 1);
        }
        *image = with;
    }
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1, "edge_band": {"width": 2.5}}})"), Verdict::close);
    EXPECT_EQ(verdict(R"({"pixels": {"limit": 0.1, "edge_band": {}}})"), Verdict::differs);
}

TEST_F(ToleranceFile, MaskCountsWhatPassesOnlyThroughIt) {
    Image mask(kWidth, kHeight, {"R", "G", "B"});
    for (int x = 0; x < 8; ++x) mask.at(pixel(x, 8), 1) = 1;
    write_image(folder.path() / "mask-a.png", mask);
    for (int x = 5; x < 8; ++x) set(b, x, 8, 0.9f);
    const std::string rule = R"({"pixels": {"limit": 0.1, "mask": "mask-{}.png"}})";
    DiffResult result      = under(rule);
    EXPECT_EQ(result.verdict, Verdict::close);
    EXPECT_EQ(result.rules.at(0).conceded->mask, 3u);
    set(b, 8, 8, 0.9f);
    result = under(rule);
    EXPECT_EQ(result.verdict, Verdict::differs);
    EXPECT_EQ(result.reasons, std::vector<std::string>{"1 pixels (0.1953 %) differ by more than 0.1 (allowed: 0 %); 3 "
                                                       "pixels pass only by the mask"});
    // The masked pixels (5, 8) to (7, 8) have no neighbour like them in A, but (8, 8) of B, unmasked, has not either.
    for (int x = 5; x < 9; ++x) set(a, x, 9, 0.9f), set(b, x, 9, 0.9f);
    result = under(R"({"pixels": {"limit": 0.1, "shift": 1, "mask": "mask-a.png"}})");
    EXPECT_EQ(result.rules.at(0).conceded->several, 3u) << concessions(*result.rules[0].conceded);
    EXPECT_EQ(result.rules[0].conceded->shift, 1u);
    EXPECT_EQ(result.rules[0].conceded->mask, 0u);

    write_image(folder.path() / "mask-a.png", Image(8, 8, {"R", "G", "B"}));
    result = under(rule);
    EXPECT_EQ(result.verdict, Verdict::unreadable);
    EXPECT_NE(result.reasons.at(0).find("mask-a.png: found 8x8 pixels, expected 32x16 as "), std::string::npos);
}

/// Each figure against limits on both of its sides; PSNR and SSIM are limits from below.
TEST_F(ToleranceFile, FiguresOfTheWholePicture) {
    for (int y = 4; y < 12; ++y)
        for (int x = 8; x < 20; ++x) set(b, x, y, 0.75f);
    const DiffResult of = under(R"({"rmse": 1})");
    EXPECT_NEAR(of.error.rmse, 0.25 * std::sqrt(96.0 / 512), 1e-9);
    for (const auto& [name, figure, is_least] : {std::tuple{"rmse", of.error.rmse, false},
                                                 {"flip", of.flip.mean, false},
                                                 {"psnr", of.error.psnr, true},
                                                 {"ssim", of.ssim, true}}) {
        ASSERT_GT(figure, 0.01) << name;
        const auto rule = [&, key = name](double limit) { return fmt::format(R"({{"{}": {}}})", key, limit); };
        EXPECT_EQ(verdict(rule(figure * 1.01)), is_least ? Verdict::differs : Verdict::close) << name;
        EXPECT_EQ(verdict(rule(figure * 0.99)), is_least ? Verdict::close : Verdict::differs) << name;
    }
    EXPECT_EQ(under(R"({"psnr": 30})").reasons,
              std::vector<std::string>{fmt::format("PSNR {:.4g} (allowed: at least 30)", of.error.psnr)});
}

/// 8 pixels by 0.25, of them 2 by 0.5: 1.5625 % and 0.390625 %.
TEST_F(ToleranceFile, HistogramBoundsEachStep) {
    for (int x = 0; x < 8; ++x) set(b, 4 * x, 2, x < 2 ? 1.0f : 0.75f);
    EXPECT_EQ(verdict(R"({"histogram": [[0.2, 1.6], [0.4, 0.4]]})"), Verdict::close);
    EXPECT_EQ(verdict(R"({"histogram": [[0.2, 1.5], [0.4, 0.4]]})"), Verdict::differs);
    const DiffResult result = under(R"({"histogram": [[0.2, 1.6], [0.4, 0.3], [0.5, 0]]})");
    EXPECT_EQ(result.reasons, std::vector<std::string>{"2 pixels (0.3906 %) differ by more than 0.4 (allowed: 0.3 %)"});
    ASSERT_EQ(result.rules.size(), 4u);
    EXPECT_EQ(result.rules[0].says, "2 of 3 steps hold");
    EXPECT_EQ(result.rules[2].at, "/images/0/passes/histogram/1");
    EXPECT_EQ(result.rules[2].figure, 0.390625);
    EXPECT_EQ(result.rules[2].limit, 0.3);
}

TEST_F(ToleranceFile, AllAndAny) {
    set(b, 3, 4, 0.75f);
    const std::string holds = R"({"pixels": {"limit": 0.3}})", fails = R"({"pixels": {"limit": 0.2}})";
    EXPECT_EQ(verdict(R"({"all": [)" + holds + ", " + holds + "]}"), Verdict::close);
    EXPECT_EQ(verdict(R"({"all": [)" + holds + ", " + fails + "]}"), Verdict::differs);
    EXPECT_EQ(verdict(R"({"any": [)" + fails + ", " + holds + "]}"), Verdict::close);
    EXPECT_EQ(verdict(R"({"any": [)" + fails + ", " + fails + "]}"), Verdict::differs);
    const DiffResult result = under(R"({"all": [{"any": [)" + fails + ", " + holds + R"(]}, {"rmse": 0.001}]})");
    ASSERT_EQ(result.rules.size(), 5u);
    ASSERT_EQ(result.reasons.size(), 1u);  // what an `any` that holds consists of is no reason
    EXPECT_EQ(result.reasons[0].find("RMSE 0.0"), 0u) << result.reasons[0];
    EXPECT_EQ(result.rules[3].at, "/images/0/passes/all/0/any/1/pixels");
    const std::string text = diff_text(result);
    EXPECT_NE(
        text.find("  rules for *.exr:\n    all: does not hold, 1 of 2 hold\n      any: holds, 1 of 2 hold\n"
                  "        pixels: does not hold, 1 pixels (0.1953 %) differ by more than 0.2 (allowed: 0 %)\n"
                  "        pixels: holds, 0 pixels (0 %) differ by more than 0.3 (allowed: 0 %)\n      rmse: does"),
        std::string::npos)
        << text;
    const nlohmann::json json = diff_json(result);
    EXPECT_EQ(json["rules"]["name"], "*.exr");
    EXPECT_EQ(json["rules"]["outcomes"][3],
              (nlohmann::json{{"at", "/images/0/passes/all/0/any/1/pixels"},
                              {"rule", "pixels"},
                              {"holds", true},
                              {"figure", 0.0},
                              {"limit", 0.0},
                              {"conceded", {{"shift", 0}, {"edge_band", 0}, {"mask", 0}, {"several", 0}}},
                              {"says", "0 pixels (0 %) differ by more than 0.3 (allowed: 0 %)"}}));
}

/// A line names what an image needed to pass, and not what it would have needed elsewhere.
TEST_F(ToleranceFile, ConcessionsAreThoseThatWereNeeded) {
    for (int y = 0; y < 4; ++y) set(a, 10, y, 1), set(b, 11, y, 1);
    Image mask(kWidth, kHeight, {"R", "G", "B"});
    std::fill(mask.data.begin(), mask.data.end(), 1.0f);
    write_image(folder.path() / "mask.png", mask);
    const std::string by_mask  = R"({"pixels": {"limit": 0.1, "mask": "mask.png"}})";
    const std::string by_shift = R"({"pixels": {"limit": 0.1, "shift": 1}})", fails = R"({"pixels": {"limit": 0.1}})";
    const auto needed = [&](const std::string& rule) { return needed_concessions(under(rule).rules); };
    EXPECT_EQ(needed(by_mask), "8 pixels pass only by the mask");
    EXPECT_EQ(needed(R"({"all": [)" + by_mask + ", " + by_shift + "]}"),
              "8 pixels pass only by the mask; 8 pixels pass only by the shift");
    EXPECT_EQ(needed(R"({"any": [)" + by_mask + R"(, {"flip": 1}]})"), "");
    EXPECT_EQ(needed(R"({"any": [)" + fails + ", " + by_shift + ", " + by_mask + "]}"),
              "8 pixels pass only by the shift");
    EXPECT_EQ(needed(R"({"all": [)" + fails + ", " + by_shift + "]}"), "");
}

TEST_F(ToleranceFile, FirstNameThatMatchesCounts) {
    set(b, 3, 4, 0.75f);
    const std::string loose = R"({"pixels": {"limit": 1}})", tight = R"({"pixels": {"limit": 0}})";
    const auto file = [](const std::string& first, const std::string& rule, const std::string& second,
                         const std::string& other) {
        return R"({"images": [{"name": ")" + first + R"(", "passes": )" + rule + R"(}, {"name": ")" + second +
               R"(", "passes": )" + other + "}]}";
    };
    EXPECT_EQ(under_file(file("a.*", loose, "*", tight)).verdict, Verdict::close);
    EXPECT_EQ(under_file(file("*", tight, "a.*", loose)).verdict, Verdict::differs);
    EXPECT_EQ(under_file(file("b.*", tight, "*.exr", loose)).verdict, Verdict::close);
    const DiffResult unmatched = under_file(file("b.*", loose, "*.png", loose));
    EXPECT_EQ(unmatched.verdict, Verdict::differs);
    EXPECT_EQ(unmatched.notes.size(), 1u);

    // In folders the name is the path.
    for (const char* side : {"old", "new"}) fs::create_directories(folder.path() / side / "deep");
    write_image(folder.path() / "old/deep/x.exr", a);
    write_image(folder.path() / "new/deep/x.exr", b);
    DiffOptions options;
    const auto verdict_by = [&](const std::string& first) {
        options.tolerance =
            std::make_shared<Tolerance>(read_tolerance(folder.write("tolerance.json", file(first, loose, "*", tight))));
        return diff_set(folder.path() / "old", folder.path() / "new", options, {}).worst();
    };
    EXPECT_EQ(verdict_by("deep/*"), Verdict::close);
    EXPECT_EQ(verdict_by("x.exr"), Verdict::differs);
}

/// No percentage covers a value that is finite in one image alone, nor a whole number; a mask does.
TEST_F(ToleranceFile, UnlikeValuesPassOnlyByPlace) {
    Image mask(kWidth, kHeight, {"R", "G", "B"});
    set(mask, 3, 4, 1);
    write_image(folder.path() / "mask.png", mask);
    for (const bool whole : {false, true}) {
        a.integers.clear();
        b = a;
        if (whole) {
            a.integers["id.face"] = std::vector<std::uint32_t>(a.pixels(), 7);
            b.integers            = a.integers;
            b.integers["id.face"][pixel(3, 4)] += 1;
        } else {
            set(b, 3, 4, std::numeric_limits<float>::quiet_NaN());
        }
        const DiffResult result = under(R"({"pixels": {"limit": 1, "percent": 50}})");
        EXPECT_EQ(result.verdict, Verdict::differs) << whole;
        EXPECT_NE(result.reasons.at(0).find("which no percentage covers"), std::string::npos) << result.reasons[0];
        EXPECT_EQ(verdict(R"({"histogram": [[1, 50]]})"), Verdict::differs) << whole;
        EXPECT_EQ(verdict(R"({"rmse": 1})"), Verdict::differs) << whole;
        EXPECT_EQ(verdict(R"({"pixels": {"limit": 1, "mask": "mask.png"}})"), Verdict::close) << whole;
    }
}

TEST_F(ToleranceFile, MistakesAreNamedWithTheirPlace) {
    const auto rule = [&](const std::string& text) {
        return refusal(R"({"images": [{"name": "*", "passes": )" + text + "}]}");
    };
    EXPECT_EQ(rule(R"({"pixels": {"limit": 1}})"), "accepted");
    EXPECT_EQ(rule(R"({"pixles": {"limit": 1}})"),
              "tolerance.json:/images/0/passes/pixles: found an object, expected no member of this name but all, any, "
              "pixels, flip, rmse, psnr, ssim, histogram; did you mean pixels?");
    EXPECT_EQ(
        rule(R"({"all": [{"flip": 1}, {"pixels": {"limit": 1, "edge_band": {"with": 2}}}]})")
            .find(
                "tolerance.json:/images/0/passes/all/1/pixels/edge_band/with: found 2, expected no member of this name "
                "but plane, channel, width, step"),
        0u);
    EXPECT_EQ(rule(R"({"pixels": {"percent": 1}})").find("tolerance.json:/images/0/passes/pixels/limit: found nothing"),
              0u);
    EXPECT_EQ(rule(R"({"flip": 1.5})"), "tolerance.json:/images/0/passes/flip: found 1.5, expected at most 1");
    EXPECT_EQ(rule(R"({"pixels": {"limit": 1, "shift": 0.5}})"),
              "tolerance.json:/images/0/passes/pixels/shift: found 0.5, expected a whole number, 0 or more");
    for (const char* text : {R"({})", R"({"any": []})", R"({"flip": 1, "rmse": 1})", R"({"flip": null})"})
        EXPECT_NE(rule(text).find("expected an object with exactly one of all, any"), std::string::npos) << rule(text);
    EXPECT_EQ(rule(R"({"any": [{"flip": 1}, {}]})").find("tolerance.json:/images/0/passes/any/1: found an object"), 0u);
    for (const char* text : {R"([[0.1]])", R"([[0.1, 101]])", R"([[-1, 1]])", R"([[0.1, 1, 1]])"})
        EXPECT_NE(rule(std::string(R"({"histogram": )") + text + "}").find("/histogram/0: found an array, expected"),
                  std::string::npos)
            << text;
    EXPECT_NE(refusal(R"({"images": []})").find("expected a list of rules"), std::string::npos);
    EXPECT_NE(refusal(R"({"images": [{"name": "*"}]})").find("/images/0/passes: found nothing"), std::string::npos);
    EXPECT_NE(refusal(R"({"images": [{"passes": {"flip": 1}}]})").find("/images/0/name: found nothing"),
              std::string::npos);
    EXPECT_NE(refusal("{\n  \"images\": [").find("tolerance.json:2:"), std::string::npos);
    std::string deep = R"({"flip": 1})";
    for (int i = 0; i < 10000; ++i) deep = R"({"all": [)" + deep + "]}";
    EXPECT_NE(rule(deep).find("expected at most 32 rules inside one another"), std::string::npos);
}

// What to do about a change, and where it is reported.

TEST(ShellWord, IsReadBackByAShell) {
    const TemporaryFolder folder;
    for (const std::string word : {"plain", "two words", "it's", "$HOME `x` \"y\" \\", "-n", "a\nb", "\xff'\\", "é"}) {
        const fs::path out  = folder.path() / "out";
        const std::string c = "bash -c " + shell_quoted("printf %s " + shell_quoted(word) + " > " + out.string());
        ASSERT_EQ(std::system(c.c_str()), 0) << c;
        EXPECT_EQ(bytes_of(out), word);
    }
}

class AcceptedChange : public ToleranceFile {
protected:
    AcceptedChange() {
        set(b, 3, 4, 0.75f);
        fs::create_directories(old);
        fs::create_directories(changed / "deep");
        write_image(old / "same.png", a);
        write_image(changed / "same.png", a);
        write_image(old / "it's.exr", a);
        write_image(changed / "it's.exr", b);
        write_image(old / "gone | `x`.png", a);
        write_image(changed / "deep/new.png", a);
        write_image(old / "size.png", a);
        write_image(changed / "size.png", Image(4, 4, {"R", "G", "B"}));
        folder.write("old/cut.png", "no image");
        write_image(changed / "cut.png", a);
    }
    fs::path old = folder.path() / "old", changed = folder.path() / "new";
};

TEST_F(AcceptedChange, CommandsMakeAWhatBIs) {
    DiffSet set = diff_set(old, changed, {}, {});
    EXPECT_EQ(set.count(Verdict::same), 1u);
    std::string commands;
    for (const DiffResult& image : set.images) {
        EXPECT_EQ(image.accept.empty(), image.verdict == Verdict::same) << image.name;
        if (!image.accept.empty()) commands += image.accept + "\n";
    }
    EXPECT_NE(diff_set_text(set).find("\nto accept:\n" + commands), std::string::npos) << diff_set_text(set);
    EXPECT_NE(commands.find("rm -- '" + (old / "gone | `x`.png").string() + "'\n"), std::string::npos) << commands;
    EXPECT_NE(commands.find("mkdir -p -- '"), std::string::npos) << commands;
    ASSERT_EQ(std::system(("bash -e " + folder.write("accept.sh", commands).string()).c_str()), 0) << commands;
    set = diff_set(old, changed, {}, {});
    EXPECT_EQ(set.worst(), Verdict::same) << diff_set_text(set);
    EXPECT_EQ(diff_set_text(set).find("to accept"), std::string::npos);
}

TEST_F(AcceptedChange, NothingIsAcceptedThatIsCloseOrCannotBe) {
    DiffOptions options;
    options.fail = 1;
    EXPECT_EQ(diff(old / "it's.exr", changed / "it's.exr", options).accept, "");
    EXPECT_EQ(diff(changed / "it's.exr", folder.write("no.exr", "no image"), {}).accept, "");
    options.channels = {"T.*"};
    EXPECT_EQ(diff(old / "it's.exr", changed / "it's.exr", options).accept, "");
}

TEST_F(AcceptedChange, MarkdownHasATableAndTheCommands) {
    const DiffSet set      = diff_set(old, changed, {}, {});
    const std::string text = diff_set_markdown(set);
    EXPECT_EQ(text.find("### 5 of 6 images differ\n\n| image | verdict |"), 0u) << text;
    EXPECT_NE(text.find("\n| it's.exr | **differs** | 0.250 | 0.0110 | "), std::string::npos) << text;
    EXPECT_NE(text.find(" | 1 | (3, 4), channel R: A 0.5, B 0.75 | largest difference 0.25 is above 1e-06 |\n"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("| gone &#124; &#96;x&#96;.png |"), std::string::npos) << text;
    EXPECT_LT(text.find("cut.png"), text.find("size.png"));  // the worst first
    EXPECT_LT(text.find("size.png"), text.find("it's.exr"));
    EXPECT_EQ(text.find("same.png"), std::string::npos);
    EXPECT_NE(text.find("\n1 the same.\n"), std::string::npos);
    EXPECT_NE(text.find("To accept the changes:\n\n```sh\n"), std::string::npos) << text;
    for (const DiffResult& image : set.images) EXPECT_NE(text.find(image.accept), std::string::npos) << image.accept;
    EXPECT_TRUE(text.ends_with("```\n"));

    DiffSet equal{"a", "b", true, {set.images.back()}};
    equal.images[0].verdict = Verdict::same;
    equal.images[0].accept.clear();
    EXPECT_EQ(diff_set_markdown(equal), "### No image of 1 differs\n\n1 the same.\n\n");
}

/// However many and however long: within the limit, a table and a fence that end, and counts of what is left out.
TEST_F(AcceptedChange, MarkdownIsBounded) {
    const DiffSet few = diff_set(old, changed, {}, {});
    DiffSet many{"a", "b", true, {}};
    for (int i = 0; i < 2000; ++i) {
        many.images.push_back(few.images[std::size_t(i) % few.images.size()]);
        many.images.back().name += std::string(std::size_t(i % 50), '|') + "```";
        many.images.back().accept += std::string(std::size_t(i % 7), '`');
    }
    for (const std::size_t longest : {kLongestComment, std::size_t{8000}, std::size_t{2000}}) {
        const std::string text = diff_set_markdown(many, longest);
        EXPECT_LE(text.size(), longest);
        EXPECT_GT(text.size(), longest * 7 / 10);
        EXPECT_NE(text.find(" more images are not shown here.\n"), std::string::npos) << text;
        EXPECT_NE(text.find(" more commands: `umbra diff` prints all of them.\n"), std::string::npos) << text;
        EXPECT_NE(text.find("\n```````sh\n"), std::string::npos) << text;
        EXPECT_NE(text.find("\n```````\n"), std::string::npos) << text;
    }
}

TEST_F(AcceptedChange, PageSaysRulesAndCommands) {
    DiffOptions options;
    options.tolerance = std::make_shared<Tolerance>(read_tolerance(folder.write(
        "tolerance.json",
        R"({"images": [{"name": "it's.exr", "passes": {"any": [{"pixels": {"limit": 0.1}}, {"rmse": 0.1}]}}]})")));
    options.pictures  = diff_pictures_folder(folder.path() / "page.html");
    const DiffSet set = diff_set(old, changed, options, {});
    write_diff_page(folder.path() / "page.html", set);
    const std::string page = bytes_of(folder.path() / "page.html");
    EXPECT_NE(
        page.find("<li style=\"padding-left: calc(1.5rem * 1)\"><code>pixels</code>: <span class=\"differs\">does "
                  "not hold</span>, 1 pixels (0.1953 %) differ by more than 0.1 (allowed: 0 %)</li>"),
        std::string::npos)
        << page;
    EXPECT_NE(page.find("<code>any</code>: holds, 1 of 2 hold</li>"), std::string::npos) << page;
    EXPECT_NE(page.find("<h2>To accept the changes</h2>\n<pre><code>"), std::string::npos);
}

}  // namespace
}  // namespace umbra
