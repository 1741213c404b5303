#include "umbra/core/errors/shadow_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace umbra {
namespace {

constexpr int kWidth = 120, kHeight = 80;

/// A raster in one plane across the view, all of it in front of one light.
PointBatch wall() {
    PointBatch points;
    points.raster             = CameraFrame{.projection = Projection::orthographic, .width = kWidth, .height = kHeight};
    points.raster->half_width = kWidth / 2.0;
    points.raster->half_height = kHeight / 2.0;
    points.resize(kWidth * kHeight);
    points.triangle.assign(points.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t x = i % kWidth, y = i / kWidth;
        points.px[i] = static_cast<float>(x);
        points.py[i] = -static_cast<float>(y);
        points.nz[i] = 1;
    }
    points.facing = {std::vector<Facing>(points.size(), Facing::front)};
    return points;
}

template <class S>
VisibilityPlane plane(const S& s) {
    VisibilityPlane p(kWidth * kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            p.s[static_cast<std::size_t>(y * kWidth + x)] = static_cast<float>(std::clamp(s(x, y), 0.0, 1.0));
    return p;
}

/// A straight boundary at distance `off` from the middle, its normal turned by `angle`, with a penumbra of `width`.
VisibilityPlane ramp(double width, double off = 0, double angle = 0) {
    return plane([=](double x, double y) {
        const double d = (x - 60) * std::cos(angle) + (y - 40) * std::sin(angle) - off;
        return width > 0 ? 0.5 + d / width : d < 0 ? 0.0 : 1.0;
    });
}

ClassPlane classes(const PointBatch& points, const VisibilityPlane& s, const VisibilityPlane& reference) {
    return error_classes(points, 0, s, reference, 0.1f);
}

TEST(ShadowEdges, DisplacementOfAPenumbraIsReadToAFractionOfAPixel) {
    const PointBatch points = wall();
    for (const double angle : {0.0, 0.3, 0.7853981634, 1.2})
        for (const double off : {0.0, 0.2, 0.5, 1.7, 4.3}) {
            const VisibilityPlane truth = ramp(10, 0, angle), s = ramp(10, off, angle);
            const auto e = edge_displacement(points, classes(points, s, truth), s, truth);
            ASSERT_TRUE(e);
            // A slanted line is sampled where it crosses the grid, so that the nearest crossing may lie aside.
            EXPECT_GE(e->mean, off - 1e-4) << angle;
            EXPECT_LE(e->mean, off + (angle == 0 ? 1e-4 : 0.25)) << angle << ' ' << off;
        }
}

TEST(ShadowEdges, DisplacementOfAHardEdgeIsReadToHalfAPixel) {
    const PointBatch points = wall();
    for (const double angle : {0.0, 0.3, 0.7853981634, 1.2})
        for (const double off : {0.0, 1.0, 3.0, 5.0}) {
            const VisibilityPlane truth = ramp(0, 0.25, angle), s = ramp(0, 0.25 + off, angle);
            const auto e = edge_displacement(points, classes(points, s, truth), s, truth);
            ASSERT_TRUE(e);
            EXPECT_NEAR(e->mean, off, 0.5) << angle;
            EXPECT_NEAR(e->p95, off, 1.0) << angle;  // beyond, the boundary leaves the picture
        }
}

TEST(ShadowEdges, DisplacementOfAnObliqueHardEdgeIsAtMostATenthLow) {
    const PointBatch points = wall();
    for (const double angle : {0.1, 0.3, 0.5, 0.7853981634, 1.0, 1.2})
        for (const double off : {2.0, 3.0, 4.0, 5.0, 6.0, 7.0}) {
            const VisibilityPlane truth = ramp(0, 0.25, angle), s = ramp(0, 0.25 + off, angle);
            const auto e = edge_displacement(points, classes(points, s, truth), s, truth);
            ASSERT_TRUE(e);
            EXPECT_GE(e->mean, 0.9 * off) << angle << ' ' << off;
            EXPECT_LE(e->mean, off + 0.5) << angle << ' ' << off << ": each boundary is known to half a pixel";
        }
}

TEST(ShadowEdges, WhatIsBeyondReachIsUnmatched) {
    const PointBatch points = wall();
    for (const double angle : {0.0, 0.3, 0.7853981634}) {
        const VisibilityPlane truth = ramp(0, 0.25, angle), s = ramp(0, 0.25 + kFarthest + 1.5, angle);
        const auto e = edge_displacement(points, classes(points, s, truth), s, truth);
        ASSERT_TRUE(e);
        EXPECT_GT(e->pieces, 70u);
        EXPECT_EQ(e->unmatched, e->pieces) << angle;
        EXPECT_EQ(e->mean, 0);
    }
}

TEST(ShadowEdges, ABoundaryThatIsLitOnTheOtherSideIsAnother) {
    const PointBatch points = wall();
    // A dark strip 5 wide; the method's lies 4 to the left. Its right edge is 1 from the truth's left one.
    const auto strip = [](double from) {
        return plane([=](double x, double) { return x >= from && x < from + 5 ? 0.0 : 1.0; });
    };
    const VisibilityPlane truth = strip(60), s = strip(56);
    const auto e = edge_displacement(points, classes(points, s, truth), s, truth);
    ASSERT_TRUE(e);
    EXPECT_NEAR(e->mean, 4, 1e-9);
}

TEST(ShadowEdges, WithoutABoundaryThereIsNothing) {
    const PointBatch points     = wall();
    const VisibilityPlane lit   = plane([](double, double) { return 1.0; });
    const VisibilityPlane truth = ramp(0);
    EXPECT_FALSE(edge_displacement(points, classes(points, truth, lit), truth, lit));
    const auto lost = edge_displacement(points, classes(points, lit, truth), lit, truth);
    ASSERT_TRUE(lost);
    EXPECT_EQ(lost->unmatched, lost->pieces);
    EXPECT_FALSE(penumbra_width(points, classes(points, truth, lit), truth, lit));
}

TEST(ShadowEdges, TheOutlineOfAnObjectIsNoBoundary) {
    PointBatch points = wall();
    // The left half is 30 pixels in front of the right one, whose left end lies in shadow.
    for (std::size_t i = 0; i < points.size(); ++i)
        if (i % kWidth < 60) points.pz[i] = 30;
    const VisibilityPlane truth = plane([](double x, double) { return x >= 60 && x < 80 ? 0.0 : 1.0; });
    const auto e                = edge_displacement(points, classes(points, truth, truth), truth, truth);
    ASSERT_TRUE(e);
    EXPECT_EQ(e->pieces, static_cast<std::uint64_t>(kHeight));
    EXPECT_FALSE(one_surface(points, 59, 60));
    EXPECT_TRUE(one_surface(points, 60, 61));
}

TEST(ShadowEdges, PointsThatOnePlaneLeavesOpenHaveNoBoundary) {
    const PointBatch points     = wall();
    const VisibilityPlane truth = ramp(0);
    VisibilityPlane s           = truth;
    for (std::size_t i = 0; i < points.size() / 4; ++i) s.answer[i] = Answer::undefined;
    const auto e = edge_displacement(points, classes(points, s, truth), s, truth);
    ASSERT_TRUE(e);
    EXPECT_EQ(e->pieces, 60u);
    EXPECT_EQ(e->unmatched, 0u);
}

TEST(ShadowEdges, WidthOfAnEvenPenumbraIsItsOwn) {
    const PointBatch points = wall();
    for (const double angle : {0.0, 0.3, 0.7853981634})
        for (const double width : {4.0, 10.0, 30.0}) {
            const VisibilityPlane truth = ramp(width, 0, angle), twice = ramp(2 * width, 0, angle),
                                  hard = ramp(0, 0, angle);
            auto w                     = penumbra_width(points, classes(points, twice, truth), twice, truth);
            ASSERT_TRUE(w);
            // Where a slanted boundary leaves the picture, a little of its penumbra is there without its middle; and
            // few pixels across a penumbra sum S (1 - S) to within 1 / width.
            EXPECT_NEAR(w->reference, width, 0.03 * width + 1 / width) << angle;
            EXPECT_NEAR(w->method, 2 * width, 0.06 * width + 1 / width) << angle;
            w = penumbra_width(points, classes(points, hard, truth), hard, truth);
            EXPECT_EQ(w->method, 0);
        }
}

TEST(ShadowEdges, BlurWidensAPenumbraAndMovesNoBoundary) {
    const PointBatch points     = wall();
    const VisibilityPlane truth = ramp(0), blurred = ramp(9);
    const ClassPlane all = classes(points, blurred, truth);
    const auto w         = penumbra_width(points, all, blurred, truth);
    ASSERT_TRUE(w);
    EXPECT_EQ(w->reference, 0);
    EXPECT_NEAR(w->method, 9, 0.3);
    const auto e = edge_displacement(points, all, blurred, truth);
    ASSERT_TRUE(e);
    EXPECT_LE(e->max, 0.5);
}

}  // namespace
}  // namespace umbra
