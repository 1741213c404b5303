// Properties of FLIP; its values on image files are compared with the reference implementation's in image_io_test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/base/parallel.h"
#include "umbra/core/image/metrics.h"

namespace umbra {
namespace {

Image constant(int width, int height, vec3 value) {
    Image image(width, height, {"R", "G", "B"});
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (int c = 0; c < 3; ++c) image.at(i, std::size_t(c)) = value[c];
    return image;
}

/// A smooth picture with a bright square.
Image scene(int width, int height, float brightness) {
    Image image(width, height, {"R", "G", "B"});
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const std::size_t i = std::size_t(y * width + x);
            const bool inside   = x > width / 4 && x < width / 2 && y > height / 4 && y < height / 2;
            image.at(i, 0)      = brightness * (0.2f + 0.5f * float(x) / float(width));
            image.at(i, 1)      = brightness * (inside ? 0.9f : 0.3f);
            image.at(i, 2)      = brightness * (0.1f + 0.4f * float(y) / float(height));
        }
    }
    return image;
}

TEST(Flip, OfEqualImagesIsZero) {
    const Image a = scene(64, 48, 1);
    EXPECT_EQ(flip_ldr(a, a).max, 0);
    EXPECT_EQ(flip_hdr(a, a).max, 0);
    EXPECT_EQ(flip_ldr(a, a).weighted_median, 0);
}

TEST(Flip, OfGreenAgainstBlueIsOne) {
    // The largest colour difference there is; without features dF = 0 and FLIP = dC.
    const Flip flip = flip_ldr(constant(16, 12, {0, 1, 0}), constant(16, 12, {0, 0, 1}));
    EXPECT_NEAR(flip.mean, 1, 1e-5);
    EXPECT_NEAR(flip.min, 1, 1e-5);
}

TEST(Flip, OfBlackAgainstWhiteByHand) {
    // HyAB = 100, to the power of 0.7, against that of green and blue, above the knee. L*a*b* of sRGB's green is
    // (87.735, -86.183, 83.180), of blue (32.301, 79.195, -107.855), a* and b* times 0.01 L* after Hunt.
    const double largest  = std::pow(std::abs(87.735 - 32.301) + std::hypot(0.87735 * -86.183 - 0.32301 * 79.195,
                                                                            0.87735 * 83.180 - 0.32301 * -107.855),
                                     0.7);
    const double knee     = 0.4 * largest;
    const double expected = 0.95 + (std::pow(100, 0.7) - knee) / (largest - knee) * 0.05;
    EXPECT_NEAR(flip_ldr(constant(8, 8, vec3(0)), constant(8, 8, vec3(1))).mean, expected, 1e-5);
}

/// Tiles that are computed apart, and those that are not since nothing differs there, leave no seams: a part of a
/// picture has the errors that it has as a part, away from its border.
TEST(Flip, OfAPartIsPartOfTheWhole) {
    constexpr int kWidth = 330, kHeight = 215, kLeft = 41, kTop = 37, kReach = 10;
    const auto part = [](const Image& whole) {
        Image image(kWidth - kLeft, kHeight - kTop, {"R", "G", "B"});
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                for (std::size_t c = 0; c < 3; ++c)
                    image.at(std::size_t(y * image.width + x), c) =
                        whole.at(std::size_t((y + kTop) * kWidth + x + kLeft), c);
        return image;
    };
    for (const std::size_t step : {1u, 5003u}) {  // differences in every pixel, in a few
        const Image a = scene(kWidth, kHeight, 0.7f);
        Image b       = a;
        for (std::size_t i = 0; i < b.pixels(); i += step) b.at(i, i % 3) = float(i * 7919 % 1000) / 1000;
        const Flip whole = flip_ldr(a, b), cut = flip_ldr(part(a), part(b));
        std::size_t errors = 0, right = 0;
        for (int y = kReach; y < kHeight - kTop; ++y)
            for (int x = kReach; x < kWidth - kLeft; ++x) {
                const float there = whole.map[std::size_t((y + kTop) * kWidth + x + kLeft)];
                ASSERT_EQ(there, cut.map[std::size_t(y * (kWidth - kLeft) + x)]) << x << ", " << y;
                ++(there > 0 ? errors : right);
            }
        EXPECT_GT(errors, 1000u);
        if (step > 1) {
            EXPECT_GT(right, 1000u);
        }
        EXPECT_GT(flip_hdr(a, b).mean, 0);
    }
}

TEST(Flip, IsSymmetricForLdr) {
    const Image a = scene(50, 40, 1);
    const Image b = scene(50, 40, 0.8f);
    EXPECT_NEAR(flip_ldr(a, b).mean, flip_ldr(b, a).mean, 1e-9);
    EXPECT_GT(flip_ldr(a, b).mean, 0.02);
}

TEST(Flip, OnePixelSpreadsByTheFiltersRadiusAndNoFurther) {
    const Image a        = constant(61, 61, vec3(0.5f));
    Image b              = a;
    const std::size_t at = 30 * 61 + 30;
    for (std::size_t c = 0; c < 3; ++c) b.at(at, c) = 1;
    const Flip flip = flip_ldr(a, b);
    EXPECT_GT(flip.map[at], 0.05f);
    EXPECT_GT(flip.map[at], flip.map[at + 3]);
    EXPECT_EQ(flip.map[at], *std::max_element(flip.map.begin(), flip.map.end()));
    EXPECT_LT(flip.map[at + 11], 1e-3f);  // contrast sensitivity reaches 10 pixels at 67 pixels per degree
    EXPECT_NEAR(flip.map[at + 4], flip.map[at - 4], 1e-6f);
    EXPECT_NEAR(flip.map[at + 4], flip.map[at + std::size_t(4) * 61], 1e-6f);
    // From further away the same pixel is less seen.
    EXPECT_LT(flip_ldr(a, b, 134).max, flip.max);
}

/// Also where the two pictures differ in this pixel alone.
TEST(Flip, OnePixelSpreadsAlikeToBothSidesWhereverItLies) {
    const Image a = constant(200, 41, vec3(0.5f));
    for (std::size_t x = 60; x < 140; ++x) {
        Image b              = a;
        const std::size_t at = 20 * 200 + x;
        for (std::size_t c = 0; c < 3; ++c) b.at(at, c) = 1;
        const Flip flip = flip_ldr(a, b);
        for (std::size_t d = 1; d < 5; ++d) {
            ASSERT_GT(flip.map[at + d], 1e-3f) << x << ' ' << d;
            ASSERT_NEAR(flip.map[at + d], flip.map[at - d], 1e-6f) << x << ' ' << d;
        }
    }
}

TEST(Flip, HdrFindsTheSameErrorsAtAnyScale) {
    const double one = flip_hdr(scene(64, 48, 1), scene(64, 48, 1.3f)).mean;
    EXPECT_NEAR(flip_hdr(scene(64, 48, 1000), scene(64, 48, 1300)).mean, one, 1e-4);
    EXPECT_GT(one, 0.01);
}

TEST(Flip, HdrExposuresSpanBrightestToMedian) {
    // Three quarters of the picture at 1, the rest at 12: log2(12) stops apart, one more exposure than whole stops.
    Image a = constant(32, 32, vec3(1));
    for (std::size_t i = 0; i < 256; ++i)
        for (std::size_t c = 0; c < 3; ++c) a.at(i, c) = 12;
    const Flip flip = flip_hdr(a, a);
    EXPECT_NEAR(flip.stop_exposure - flip.start_exposure, std::log2(12.0), 1e-5);
    EXPECT_EQ(flip.exposures, 4);
    // The curve of Narkowicz, exposed at the brightest pixel, gives 0.85.
    const double s = 0.6 * 12 * std::exp2(flip.start_exposure);
    EXPECT_NEAR(s * (2.51 * s + 0.03) / (s * (2.43 * s + 0.59) + 0.14), 0.85, 1e-6);
}

TEST(Flip, StaysFiniteOnBlackAndOnWhatIsNotANumber) {
    const float nan   = std::numeric_limits<float>::quiet_NaN();
    const Image black = constant(16, 16, vec3(0));
    for (Image strange : {black, constant(16, 16, vec3(1))}) {
        strange.data[0] = nan;
        strange.data[4] = kInfinity;
        strange.data[8] = -kInfinity;
        strange.data[9] = 3e38f;
        for (const Flip& flip : {flip_ldr(black, strange), flip_hdr(black, strange), flip_hdr(strange, black)}) {
            EXPECT_GT(flip.mean, 0);
            EXPECT_TRUE(std::all_of(flip.map.begin(), flip.map.end(), [](float x) { return x >= 0 && x <= 1; }));
        }
    }
    EXPECT_EQ(flip_hdr(black, black).max, 0);
}

TEST(Flip, GreyOfOneChannelIsGreyOfThree) {
    const Image three = scene(40, 30, 1);
    Image one(40, 30, {"S.lamp"});
    Image grey(40, 30, {"R", "G", "B"});
    for (std::size_t i = 0; i < one.pixels(); ++i) {
        one.at(i, 0) = three.at(i, 1);
        for (std::size_t c = 0; c < 3; ++c) grey.at(i, c) = three.at(i, 1);
    }
    Image darker = one, darker_grey = grey;
    for (float& x : darker.data) x *= 0.5f;
    for (float& x : darker_grey.data) x *= 0.5f;
    EXPECT_EQ(flip_ldr(one, darker).map, flip_ldr(grey, darker_grey).map);
}

TEST(Flip, SameBitsForAnyNumberOfThreads) {
    const Image a   = scene(150, 90, 1);
    const Image b   = scene(150, 90, 0.9f);
    const Flip many = flip_hdr(a, b);
    const ThreadLimit one(1);
    EXPECT_EQ(many.map, flip_hdr(a, b).map);
}

}  // namespace
}  // namespace umbra
