// Parts of FLIP by the functions of the standard library; all of it is compared with the reference implementation in
// image_io_test.
#include "umbra/core/image/flip_tile.h"

#include <gtest/gtest.h>

#include <cmath>

#include "umbra/core/image/image.h"

namespace umbra::flip {
namespace {

TEST(FlipTile, DecodesAsTheStandardDoes) {
    std::vector<float> values;
    for (int i = 0; i <= 100000; ++i) values.push_back(float(i) / 100000);
    const std::vector<float> encoded = values;
    decode_srgb(values);
    for (std::size_t i = 0; i < values.size(); ++i)
        ASSERT_NEAR(values[i], linear_from_srgb(encoded[i]), 6e-8f * encoded[i]) << encoded[i];
    EXPECT_EQ(values.front(), 0);
    EXPECT_EQ(values.back(), 1);
}

/// All rows of a part have one colour each, from black to white, and Lab of a flat colour is known.
TEST(FlipTile, SeesFlatColoursAsTheyAre) {
    const Filters filters(67.0206451);
    for (int i = 0; i <= 1000; ++i) {
        const float grey = float(i) / 1000;
        Part part;
        part.resize(40, 3, filters.reach);
        for (auto& plane : part.rgb) plane.assign(plane.size(), grey);
        Workspace workspace;
        Seen seen;
        see(filters, part, workspace, seen);
        const double lightness = grey > 216.0 / 24389 ? 116 * std::cbrt(double(grey)) - 16 : double(grey) * 24389 / 27;
        for (const std::size_t at : {std::size_t{0}, std::size_t{39}, 2 * seen.stride + 39}) {
            ASSERT_NEAR(seen.lightness[at], lightness, 1e-4) << grey;
            ASSERT_NEAR(seen.a[at], 0, 2e-4) << grey;
            ASSERT_NEAR(seen.b[at], 0, 2e-4) << grey;
            ASSERT_NEAR(seen.edges[at], 0, 1e-6) << grey;
            ASSERT_NEAR(seen.points[at], 0, 1e-6) << grey;
        }
    }
}

Seen row_of(const std::vector<float>& lightness, const std::vector<float>& edges) {
    const std::vector<float> none(lightness.size());
    return {.stride = lightness.size(), .lightness = lightness, .a = none, .b = none, .edges = edges, .points = none};
}

TEST(FlipTile, ErrorsAreThePowersOfThePaper) {
    std::vector<float> lightness, edges;
    for (int i = 0; i <= 100; ++i)
        for (int k = 0; k <= 10; ++k) lightness.push_back(float(i)), edges.push_back(float(k) / 10);
    std::vector<float> errors(lightness.size());
    const std::vector<float> none(lightness.size());
    row_errors(row_of(none, none), row_of(lightness, edges), 0, errors);

    // Green against blue, after Hunt: see flip_test.
    const double largest = std::pow(std::abs(87.735 - 32.301) + std::hypot(0.87735 * -86.183 - 0.32301 * 79.195,
                                                                           0.87735 * 83.180 - 0.32301 * -107.855),
                                    0.7);
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const double d = std::pow(double(lightness[i]), 0.7), knee = 0.4 * largest;
        const double colour  = d < knee ? 0.95 / knee * d : 0.95 + (d - knee) / (largest - knee) * 0.05;
        const double feature = std::sqrt(double(edges[i]) / std::sqrt(2.0));
        ASSERT_NEAR(errors[i], colour > 0 ? std::pow(colour, 1 - feature) : 0, 1e-5) << lightness[i] << ' ' << edges[i];
    }
    EXPECT_EQ(errors[0], 0);
    row_errors(row_of(lightness, edges), row_of(lightness, edges), 0, errors);
    for (const float error : errors) ASSERT_EQ(error, 0);
}

TEST(FlipTile, TonesByTheCurveAndFindsItsInverse) {
    const std::vector<float> values{0, 0.1f, 0.5f, 1, 4, 1e15f};
    std::vector<float> toned(values.size());
    tone(values, 2, toned);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double s = 0.6 * 2 * double(values[i]);
        const double y = s * (2.51 * s + 0.03) / (s * (2.43 * s + 0.59) + 0.14);
        EXPECT_NEAR(toned[i], std::min(y, 1.0), 2e-7) << values[i];
        if (y > 0 && y < 1) {
            EXPECT_NEAR(untoned(y), 2 * double(values[i]), 1e-6);
        }
    }
}

}  // namespace
}  // namespace umbra::flip
