#include "umbra/core/errors/visibility_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace umbra {
namespace {

constexpr int kWidth = 40, kHeight = 30;

/// A raster whose every pixel has a surface point in front of one light; the reference is lit on the left half, umbra
/// from column 20 on.
struct Half {
    PointBatch points;
    VisibilityPlane reference, s;
    Half() {
        points.raster         = CameraFrame{};
        points.raster->width  = kWidth;
        points.raster->height = kHeight;
        points.resize(kWidth * kHeight);
        points.facing = {std::vector<Facing>(points.size(), Facing::front)};
        reference     = VisibilityPlane(points.size());
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) reference.s[at(x, y)] = x < 20 ? 1.0f : 0.0f;
        s = reference;
    }
    static std::size_t at(int x, int y) { return static_cast<std::size_t>(y * kWidth + x); }
    [[nodiscard]] VisibilityError error(float tolerance = kHardTolerance) const {
        return visibility_error(points, 0, s, reference, tolerance);
    }
};

/// The counts, so that a test can say which of them a defect raises: all others must be 0.
std::vector<std::uint64_t> wrong(const VisibilityError& e) {
    return {e.false_shadow.interior, e.false_shadow.edge, e.false_light.interior, e.false_light.edge};
}
using Counts = std::vector<std::uint64_t>;

TEST(VisibilityError, EqualPlanesHaveNone) {
    const VisibilityError e = Half().error();
    EXPECT_EQ(wrong(e), (Counts{0, 0, 0, 0}));
    EXPECT_EQ(e.points, 1200u);
    EXPECT_EQ(e.lit, 600u);
    EXPECT_EQ(e.umbra, 600u);
    EXPECT_EQ(e.penumbra, 0u);
    EXPECT_EQ(e.mae + e.rmse + e.max + e.bias, 0);
}

/// The reference's own doubt, 0.25, adds to the tolerance: 0.5 + 0.25 is allowed, more is not.
TEST(VisibilityError, TheReferencesHalfWidthIsAllowed) {
    Half half;
    half.reference.half_width[Half::at(3, 3)] = half.reference.half_width[Half::at(4, 3)] = 0.25f;
    half.s.s[Half::at(3, 3)]                                                              = 0.3f;
    EXPECT_EQ(wrong(half.error()), (Counts{0, 0, 0, 0}));
    half.s.s[Half::at(4, 3)] = 0.2f;
    EXPECT_EQ(wrong(half.error()), (Counts{1, 0, 0, 0}));
    EXPECT_EQ(half.error().max_half_width, 0.25);
}

TEST(VisibilityError, BandIsTwoPixelsOnEitherSideOfAStraightBoundary) {
    const Half half;
    const auto band = edge_band(half.points, 0, half.reference, kHardTolerance);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) EXPECT_EQ(band[Half::at(x, y)], x >= 18 && x < 22) << x << ' ' << y;
}

TEST(VisibilityError, BandIsRoundAtACorner) {
    Half half;
    std::fill(half.reference.s.begin(), half.reference.s.end(), 1.0f);
    half.reference.s[Half::at(10, 10)] = 0;
    const auto band                    = edge_band(half.points, 0, half.reference, kHardTolerance);
    EXPECT_EQ(std::count(band.begin(), band.end(), 1), 13);  // 3 x 3, and one more each way along the axes
    EXPECT_EQ(band[Half::at(12, 10)], 1);
    EXPECT_EQ(band[Half::at(11, 11)], 1);
    EXPECT_EQ(band[Half::at(12, 11)], 0);
}

TEST(VisibilityError, EachDefectRaisesItsOwnCount) {
    Half half;
    half.s.s[Half::at(5, 5)] = 0;
    EXPECT_EQ(wrong(half.error()), (Counts{1, 0, 0, 0})) << "false shadow far from the boundary";
    half.s.s[Half::at(19, 7)] = 0;
    EXPECT_EQ(wrong(half.error()), (Counts{1, 1, 0, 0})) << "false shadow beside it";
    half.s.s[Half::at(30, 9)] = 1;
    EXPECT_EQ(wrong(half.error()), (Counts{1, 1, 1, 0})) << "false light far from it";
    half.s.s[Half::at(21, 9)] = 1;
    EXPECT_EQ(wrong(half.error()), (Counts{1, 1, 1, 1})) << "false light beside it";
    half.s.s[Half::at(2, 2)] = 0.5f;
    EXPECT_EQ(wrong(half.error()), (Counts{1, 1, 1, 1})) << "a filtered value that is not on the wrong side";
    half.s.s[Half::at(2, 2)] = 0.49f;
    EXPECT_EQ(wrong(half.error()), (Counts{2, 1, 1, 1}));
}

TEST(VisibilityError, AShadowOnePixelOffIsEdgeOnly) {
    Half half;
    for (int y = 0; y < kHeight; ++y) half.s.s[Half::at(20, y)] = 1;
    EXPECT_EQ(wrong(half.error()), (Counts{0, 0, 0, 30}));
    for (int y = 0; y < kHeight; ++y)
        for (int x = 20; x < 23; ++x) half.s.s[Half::at(x, y)] = 1;
    EXPECT_EQ(wrong(half.error()), (Counts{0, 0, 30, 60})) << "three pixels off: one beyond the band";
}

TEST(VisibilityError, MeansHaveTheirFormulas) {
    Half half;
    half.s.s[Half::at(5, 5)]  = 0;      // -1
    half.s.s[Half::at(30, 9)] = 0.5f;   // +0.5
    half.s.s[Half::at(31, 9)] = 0.25f;  // +0.25
    const VisibilityError e   = half.error();
    EXPECT_DOUBLE_EQ(e.mae, 1.75 / 1200);
    EXPECT_DOUBLE_EQ(e.rmse, std::sqrt(1.3125 / 1200));
    EXPECT_DOUBLE_EQ(e.bias, -0.25 / 1200);
    EXPECT_EQ(e.max, 1);
}

TEST(VisibilityError, AwayNoneAndUndefinedPointsAreCountedApart) {
    Half half;
    half.s.s.assign(half.s.s.size(), 0.0f);
    const auto set = [&](int y, Facing f) {
        for (int x = 0; x < kWidth; ++x) half.points.facing[0][Half::at(x, y)] = f;
    };
    set(0, Facing::none);
    set(1, Facing::away);
    set(2, Facing::partly);
    for (int x = 0; x < kWidth; ++x) half.s.answer[Half::at(x, 3)] = Answer::undefined;
    for (int x = 0; x < 7; ++x) half.reference.answer[Half::at(x, 4)] = Answer::undefined;
    for (int x = 0; x < 5; ++x) half.reference.answer[Half::at(x, 5)] = Answer::on_boundary;
    const VisibilityError e = half.error();
    EXPECT_EQ(e.away, 40u);
    EXPECT_EQ(e.undefined, 47u);
    EXPECT_EQ(e.on_boundary, 5u);
    EXPECT_EQ(e.points, 1200u - 40 - 40 - 47 - 5);
    EXPECT_EQ(e.lit + e.umbra + e.penumbra, e.points);
    EXPECT_EQ(e.false_shadow.interior, 18u * 27 - 7 - 5);
    EXPECT_EQ(e.false_shadow.edge, 2u * 27);
}

TEST(VisibilityError, PointsThatReceiveNoShadowsAreCountedApart) {
    Half half;
    half.s.s.assign(half.s.s.size(), 0.0f);
    for (int x = 0; x < kWidth; ++x) half.points.facing[0][Half::at(x, 1)] = Facing::unshadowed;
    const VisibilityError e = half.error();
    EXPECT_EQ(e.unshadowed, 40u);
    EXPECT_EQ(e.away, 0u);
    EXPECT_EQ(e.points, 1200u - 40);
    EXPECT_EQ(e.false_shadow.interior + e.false_shadow.edge, 29u * 20);
}

TEST(VisibilityError, WhereTheLightTurnsAwayThereIsNoBoundary) {
    Half half;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 20; x < kWidth; ++x) half.points.facing[0][Half::at(x, y)] = Facing::away;
    half.s.s[Half::at(19, 7)] = 0;
    EXPECT_EQ(wrong(half.error()), (Counts{1, 0, 0, 0})) << "acne beside the terminator is no edge error";
}

TEST(VisibilityError, WidePenumbraHasNoBandAndASteepOneHas) {
    Half half;
    const auto ramp = [&](float slope) {
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                half.reference.s[Half::at(x, y)] = std::clamp(0.5f - slope * (static_cast<float>(x) - 19.5f), 0.f, 1.f);
        half.s = half.reference;
    };
    ramp(0.03f);
    auto band = edge_band(half.points, 0, half.reference, kAreaTolerance);
    EXPECT_EQ(std::count(band.begin(), band.end(), 1), 0);
    half.s.s[Half::at(20, 3)] += 0.2f;
    half.s.s[Half::at(20, 4)] += 0.09f;
    EXPECT_EQ(wrong(half.error(kAreaTolerance)), (Counts{0, 0, 1, 0}));
    EXPECT_EQ(half.error(kAreaTolerance).penumbra, 34u * 30);

    // 0.09 a pixel: 1.5 pixels off make 0.135, beyond the tolerance.
    ramp(0.09f);
    half.s.s[Half::at(20, 3)] += 0.13f;
    EXPECT_EQ(wrong(half.error(kAreaTolerance)), (Counts{0, 0, 0, 1}));
}

TEST(VisibilityError, RefusesWhatIsNoRaster) {
    Half half;
    half.s.s.pop_back();
    EXPECT_THROW((void)half.error(), std::logic_error);
    Half bare;
    bare.points.raster.reset();
    EXPECT_THROW((void)bare.error(), std::logic_error);
}

}  // namespace
}  // namespace umbra
