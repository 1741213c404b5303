// The sweep over edges in the light's plane, and a light that it follows to its rim, on triangles at random places and
// in bad ones: corners on the rim and on one another, edges along it and through its corners, triangles that repeat.
#include <gtest/gtest.h>

#include <random>

#include "umbra/shadows/exact/horizon.h"

namespace umbra::exact_visibility {
namespace {

template <class T>
using Corners = std::vector<LightCorner<T>>;

using Triangle = std::array<dvec2, 3>;

double twice_area(const Triangle& t) {
    return (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
}

template <class T>
Covering<T> covering_of(const std::vector<Triangle>& triangles) {
    Covering<T> covering;
    covering.clear();
    for (const Triangle& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const dvec2 a = t[k], b = t[(k + 1) % 3];
            covering.add({T(a.x), T(a.y)}, {T(b.x), T(b.y)}, twice_area(t) > 0 ? 1 : -1, false, false);
        }
    return covering;
}

enum class Places : std::uint8_t { anywhere, grid, on_circle };

std::vector<Triangle> random_triangles(std::mt19937& random, Places places, int most = 12) {
    std::uniform_real_distribution<double> anywhere(-1.5, 1.5);
    std::uniform_int_distribution<int> step(-6, 6), count(1, most), ratio(0, 6), one_in_three(0, 2);
    // Points of the circle, in double on it or next to it.
    const auto on_circle = [&] {
        const double t = ratio(random) / 6.0 * (one_in_three(random) == 0 ? -1 : 1);
        const dvec2 p((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t));
        return one_in_three(random) == 0 ? -p : p;
    };
    const auto corner = [&]() -> dvec2 {
        if (places == Places::anywhere) return {anywhere(random), anywhere(random)};
        if (places == Places::grid || one_in_three(random) == 0) return dvec2(step(random), step(random)) / 4.0;
        return on_circle();
    };
    std::vector<Triangle> triangles(static_cast<std::size_t>(count(random)));
    for (Triangle& t : triangles)
        for (dvec2& p : t) p = corner();
    if (one_in_three(random) == 0) triangles.push_back(triangles.front());
    return triangles;
}

double area_over_polygon(const std::vector<Triangle>& triangles, int corners, double radius,
                         const std::optional<HalfPlane>& before = std::nullopt) {
    Corners<double> polygon;
    for (int k = 0; k < corners; ++k) {
        const double angle = 2 * kPi * k / corners;
        polygon.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    if (before) polygon = before_horizon(polygon, Horizon<double>{before->x, before->y, before->least});
    Covering<double> covering = covering_of<double>(triangles);
    return covering.uncovered(Covering<double>::Outline(std::move(polygon)), 0, {}, NoPieces{}).first;
}

TEST(Covering, ASquareIsSweptToItsRimAsInRationals) {
    const Covering<CGAL::Gmpq>::Outline square(Corners<CGAL::Gmpq>{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
    const Covering<double>::Outline in_doubles(Corners<double>{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
    std::mt19937 random(7);
    std::size_t partly = 0;
    for (int i = 0; i < 3000; ++i) {
        const auto triangles = random_triangles(random, i % 2 == 0 ? Places::anywhere : Places::grid);
        const double right   = covering_of<CGAL::Gmpq>(triangles).uncovered(square, 0, {}, NoPieces{}).first;
        EXPECT_NEAR(covering_of<double>(triangles).uncovered_of<WholeSquare>(0).first, right, 1e-12) << i;
        EXPECT_NEAR(covering_of<double>(triangles).uncovered(in_doubles, 0, {}, NoPieces{}).first, right, 1e-12) << i;
        partly += right > 0 && right < 4;
    }
    EXPECT_GT(partly, 1000u);
}

/// Enough of them to be sorted in drawers, spread over the light or all in a few.
TEST(Covering, ManyEdgesAreSweptAsInRationals) {
    const Covering<CGAL::Gmpq>::Outline square(Corners<CGAL::Gmpq>{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
    std::mt19937 random(9);
    std::size_t many = 0, partly = 0;
    for (int i = 0; i < 120; ++i) {
        auto triangles = random_triangles(random, i % 4 == 0 ? Places::grid : Places::anywhere, 80);
        for (Triangle& t : triangles)
            for (dvec2& p : t) p = dvec2(p.x, i % 3 == 0 ? p.y / 1024 : p.y) * (i % 2 == 0 ? 1.0 : 0.25);
        const double right = covering_of<CGAL::Gmpq>(triangles).uncovered(square, 0, {}, NoPieces{}).first;
        EXPECT_NEAR(covering_of<double>(triangles).uncovered_of<WholeSquare>(0).first, right, 1e-12) << i;
        many += triangles.size() > 30;
        partly += right > 0 && right < 4;
    }
    EXPECT_GT(many, 60u);
    EXPECT_GT(partly, 60u);
}

TEST(Covering, ADiskLiesBetweenItsPolygons) {
    constexpr int kCorners = 1024;
    std::mt19937 random(8);
    std::size_t partly = 0;
    for (int i = 0; i < 3000; ++i) {
        const auto triangles = random_triangles(
            random, std::array{Places::anywhere, Places::grid, Places::on_circle}[static_cast<std::size_t>(i % 3)]);
        const double visible = covering_of<double>(triangles).uncovered_of<WholeDisk>(0).first;
        EXPECT_GE(visible, area_over_polygon(triangles, kCorners, 1) - 1e-12) << i;
        EXPECT_LE(visible, area_over_polygon(triangles, kCorners, 1 / std::cos(kPi / kCorners)) + 1e-12) << i;
        partly += visible > 0 && visible < kPi;
    }
    EXPECT_GT(partly, 1000u);
}

/// Lines in all directions, along the axes and nearly so, through the light and past it.
TEST(Covering, BehindALineNothingIsVisible) {
    constexpr int kCorners = 1024;
    const Corners<CGAL::Gmpq> square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    std::mt19937 random(10);
    std::uniform_real_distribution<double> anywhere(-1, 1);
    std::size_t partly = 0;
    for (int i = 0; i < 2000; ++i) {
        const double tilt = std::array{0.0, 1e-17, -1e-9, 0.0625, anywhere(random)}[static_cast<std::size_t>(i % 5)];
        const double sign = i % 2 == 0 ? 1 : -1, least = (i % 3 == 0 ? 0.25 : 2.2) * anywhere(random);
        const HalfPlane before = i % 4 < 2 ? HalfPlane{sign, tilt, least} : HalfPlane{tilt, sign, least};
        const auto triangles   = random_triangles(random, i % 3 == 0 ? Places::on_circle : Places::anywhere, 4);
        const Horizon<CGAL::Gmpq> line{before.x, before.y, before.least};
        const double right =
            covering_of<CGAL::Gmpq>(triangles)
                .uncovered(Covering<CGAL::Gmpq>::Outline(before_horizon(square, line)), 0, {}, NoPieces{})
                .first;
        EXPECT_NEAR(covering_of<double>(triangles).uncovered_of<WholeSquare>(0, before).first, right, 1e-12)
            << i << ": " << before.x << " " << before.y << " " << before.least;
        const double of_disk = covering_of<double>(triangles).uncovered_of<WholeDisk>(0, before).first;
        EXPECT_GE(of_disk, area_over_polygon(triangles, kCorners, 1, before) - 1e-12) << i;
        EXPECT_LE(of_disk, area_over_polygon(triangles, kCorners, 1 / std::cos(kPi / kCorners), before) + 1e-12) << i;
        partly += right > 0 && right < 4;
    }
    EXPECT_GT(partly, 700u);
}

TEST(Covering, ASegmentOfADiskHasItsClosedForm) {
    for (const double x : {-0.8, -0.6, 0.0, 0.28, 0.6, 0.96}) {
        const double y = std::sqrt(1 - x * x);
        // A quadrangle covers all that is to the right of x; its edge there passes through the disk.
        const std::vector<Triangle> right_of_x{{dvec2(x, -1.5), dvec2(9, -1.5), dvec2(x, 1.5)},
                                               {dvec2(9, -1.5), dvec2(9, 1.5), dvec2(x, 1.5)}};
        EXPECT_NEAR(covering_of<double>(right_of_x).uncovered_of<WholeDisk>(0).first, kPi - (std::acos(x) - x * y),
                    1e-14);
        // Corners on the circle.
        const std::vector<Triangle> within{{dvec2(x, -y), dvec2(x, y), dvec2(-1, 0)}};
        EXPECT_NEAR(covering_of<double>(within).uncovered_of<WholeDisk>(0).first, kPi - y * (1 + x), 1e-14) << x;
    }
}

/// Layers at the far left come in with edges that were cut off there.
TEST(Covering, WhatWasCutOffAtTheLeftCounts) {
    for (const double y : {-0.5, 0.0, 0.25}) {
        Covering<double> above;
        above.clear();
        above.add({1.0625, y}, {-1.0625, y + 0.125}, -1, false, true);  // covered above
        const double part = (2.125 / 2 + 1) / 2.125, low = y + 0.125 * (1 - part), high = y + 0.125 * part;
        EXPECT_NEAR(above.uncovered_of<WholeSquare>(0).first, (low + high) / 2 * 2 + 2, 1e-14);
        Covering<double> below;
        below.clear();
        below.add({1.0625, y}, {-1.0625, y + 0.125}, 1, false, true);
        EXPECT_NEAR(below.uncovered_of<WholeSquare>(1).first, 4 - ((low + high) / 2 * 2 + 2), 1e-14);
    }
}

}  // namespace
}  // namespace umbra::exact_visibility
