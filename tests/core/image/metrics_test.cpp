#include "umbra/core/image/metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

const std::vector<std::string> kRgb{"R", "G", "B"};

Image constant(int width, int height, float value) {
    Image image(width, height, kRgb);
    std::fill(image.data.begin(), image.data.end(), value);
    return image;
}

/// Values in [0, 1] without any pattern.
Image noise(int width, int height, std::uint32_t seed, std::vector<std::string> channels = kRgb) {
    Image image(width, height, std::move(channels));
    for (float& x : image.data) {
        seed = seed * 1664525u + 1013904223u;
        x    = float(seed >> 8) / float(1u << 24);
    }
    return image;
}

TEST(ImageError, EqualsIdiffOnABox) {
    // Figures that OpenImageIO's idiff prints for 64x64x3 of 0.1 against the same with green 0.6 in 11x11 pixels from
    // (5, 17).
    const Image a = constant(64, 64, 0.1f);
    Image b       = a;
    for (std::size_t y = 17; y <= 27; ++y)
        for (std::size_t x = 5; x <= 15; ++x) b.at(y * 64 + x, 1) = 0.6f;
    const ImageError error = image_error(a, b);
    EXPECT_NEAR(error.mae, 0.0049235, 5e-8);
    EXPECT_NEAR(error.rmse, 0.049616, 5e-7);
    EXPECT_NEAR(error.psnr, 26.0876, 5e-5);
    EXPECT_NEAR(error.max, 0.5, 1e-7);
    EXPECT_EQ(error.differing, 121u);
    EXPECT_EQ(error.worst.x, 5);
    EXPECT_EQ(error.worst.y, 17);
    EXPECT_EQ(error.worst.channel, 1);
    EXPECT_NEAR(error.mean_a, 0.1, 1e-7);
    EXPECT_NEAR(error.mean_b, 0.1 + 0.0049235, 1e-7);
    EXPECT_EQ(error.values, 64u * 64 * 3);
}

TEST(ImageError, OfEqualImagesIsNothing) {
    const Image a          = noise(17, 9, 1);
    const ImageError error = image_error(a, a);
    EXPECT_EQ(error.max, 0);
    EXPECT_EQ(error.rmse, 0);
    EXPECT_EQ(error.differing, 0u);
    EXPECT_TRUE(std::isinf(error.psnr));
}

TEST(ImageError, CountsWhatIsNotFiniteApart) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    Image a         = constant(4, 1, 0.5f);
    Image b         = a;
    a.at(0, 0) = b.at(0, 0) = nan;        // alike
    a.at(1, 0) = b.at(1, 0) = kInfinity;  // alike
    a.at(2, 1)              = kInfinity;  // unlike
    b.at(2, 1)              = -kInfinity;
    b.at(3, 2)              = nan;  // unlike
    const ImageError error  = image_error(a, b);
    EXPECT_EQ(error.not_finite, 4u);
    EXPECT_EQ(error.unlike_not_finite, 2u);
    EXPECT_EQ(error.differing, 2u);
    EXPECT_EQ(error.values, 8u);
    EXPECT_EQ(error.max, 0);
    EXPECT_EQ(error.mean_a, 0.5);
}

TEST(ImageError, PairsChannelsByName) {
    const Image a = noise(6, 5, 2, {"R", "G", "B", "S.lamp"});
    Image b(6, 5, {"S.lamp", "Z", "G"});
    for (std::size_t i = 0; i < a.pixels(); ++i) {
        b.at(i, 0) = a.at(i, 3);
        b.at(i, 1) = 100;
        b.at(i, 2) = a.at(i, 1);
    }
    EXPECT_EQ(image_error(a, b).differing, 0u);
    b.at(13, 0) += 2;
    EXPECT_EQ(image_error(a, b).worst.x, 1);
    EXPECT_EQ(image_error(a, b).worst.y, 2);
    EXPECT_EQ(image_error(a, b).worst.channel, 3);
}

TEST(ImageError, SameBitsForAnyNumberOfThreads) {
    const Image a          = noise(333, 251, 3);
    const Image b          = noise(333, 251, 4);
    const double many      = image_error(a, b).rmse;
    const double ssim_many = ssim(a, b);
    const ThreadLimit one(1);
    EXPECT_EQ(many, image_error(a, b).rmse);
    EXPECT_EQ(ssim_many, ssim(a, b));
    EXPECT_NEAR(many, std::sqrt(1.0 / 6), 2e-3);  // of two independent uniform values
}

TEST(Ssim, OfConstantImagesIsTheLuminanceTerm) {
    // Variances vanish, and with them all but (2 a b + C1) / (a^2 + b^2 + C1).
    const double a = 0.25, b = 0.75;
    const double expected = (2 * a * b + 1e-4) / (a * a + b * b + 1e-4);
    EXPECT_NEAR(ssim(constant(40, 30, 0.25f), constant(40, 30, 0.75f)), expected, 1e-9);
    EXPECT_NEAR(ssim(constant(3, 2, 0.25f), constant(3, 2, 0.75f)), expected, 1e-9);
    EXPECT_NEAR(ssim(constant(20, 20, 0), constant(20, 20, 1)), 1e-4 / (1 + 1e-4), 1e-12);
}

TEST(Ssim, OfAnInvertedImageIsNegative) {
    // b = 1 - a: covariance = -variance. Whole image = one window, by hand for a 2x1 checker of 0 and 1.
    Image a(2, 1, {"Y"});
    a.data  = {0, 1};
    Image b = a;
    b.data  = {1, 0};
    EXPECT_NEAR(ssim(a, b), (2 * -0.25 + 9e-4) / (2 * 0.25 + 9e-4), 1e-12);
}

/// The definition, window by window, two passes, nothing separated.
double ssim_directly(const Image& a, const Image& b) {
    const auto y = [](const Image& m, int px, int py) {
        const std::size_t i = std::size_t(py * m.width + px);
        return 0.2126 * m.at(i, 0) + 0.7152 * m.at(i, 1) + 0.0722 * m.at(i, 2);
    };
    double total = 0;
    int windows  = 0;
    for (int cy = 5; cy < a.height - 5; ++cy) {
        for (int cx = 5; cx < a.width - 5; ++cx, ++windows) {
            double weight = 0, mean_a = 0, mean_b = 0, aa = 0, bb = 0, ab = 0;
            const auto each = [&](const auto& body) {
                for (int dy = -5; dy <= 5; ++dy)
                    for (int dx = -5; dx <= 5; ++dx)
                        body(std::exp(-(dx * dx + dy * dy) / 4.5), y(a, cx + dx, cy + dy), y(b, cx + dx, cy + dy));
            };
            each([&](double w, double va, double vb) { weight += w, mean_a += w * va, mean_b += w * vb; });
            mean_a /= weight;
            mean_b /= weight;
            each([&](double w, double va, double vb) {
                aa += w / weight * (va - mean_a) * (va - mean_a);
                bb += w / weight * (vb - mean_b) * (vb - mean_b);
                ab += w / weight * (va - mean_a) * (vb - mean_b);
            });
            total += (2 * mean_a * mean_b + 1e-4) / (mean_a * mean_a + mean_b * mean_b + 1e-4) * (2 * ab + 9e-4) /
                     (aa + bb + 9e-4);
        }
    }
    return total / windows;
}

TEST(Ssim, EqualsItsDefinition) {
    const Image a = noise(29, 23, 7);
    Image b       = noise(29, 23, 8);
    for (std::size_t k = 0; k < b.data.size(); ++k) b.data[k] = 0.7f * a.data[k] + 0.3f * b.data[k];
    EXPECT_NEAR(ssim(a, b), ssim_directly(a, b), 1e-10);
    EXPECT_GT(ssim(a, b), 0.8);
    EXPECT_DOUBLE_EQ(ssim(a, a), 1);
    EXPECT_DOUBLE_EQ(ssim(a, b), ssim(b, a));
    // Two pixels that differ, in a corner and in the middle: most windows are the same in both.
    Image few    = a;
    few.at(0, 1) = 1 - few.at(0, 1), few.at(14 * 29 + 15, 0) = 1 - few.at(14 * 29 + 15, 0);
    EXPECT_NEAR(ssim(a, few), ssim_directly(a, few), 1e-12);
    EXPECT_LT(ssim(a, few), 1 - 1e-6);
}

TEST(Metrics, RefuseImagesOfDifferentSize) {
    EXPECT_THROW(static_cast<void>(ssim(constant(4, 4, 0), constant(4, 5, 0))), std::logic_error);
    EXPECT_THROW(static_cast<void>(image_error(constant(4, 4, 0), constant(5, 4, 0))), std::logic_error);
    EXPECT_THROW(static_cast<void>(flip_ldr(constant(4, 4, 0), constant(5, 4, 0))), std::logic_error);
}

}  // namespace
}  // namespace umbra
