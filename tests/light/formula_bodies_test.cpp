// Bodies by formula: intervals worked out by hand, the lecture's rule where it fails, and triangles beside them.
#include "umbra/bench/studies/light/formula_bodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "umbra/bench/studies/light/optics.h"
#include "umbra/bench/studies/light/ray_tree.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

/// The rule as the lecture gives it: the smaller root, which must be above 0.
std::optional<double> smaller_root(const std::optional<Passage>& passage) {
    if (!passage || passage->enter <= 0) return std::nullopt;
    return passage->enter;
}

TEST(FormulaBodies, SphereIsEnteredAndLeftWhereTheEquationSays) {
    const auto through = through_sphere({-5, 0, 0}, {1, 0, 0}, {0, 0, 0}, 2);
    ASSERT_TRUE(through);
    EXPECT_DOUBLE_EQ(through->enter, 3);
    EXPECT_DOUBLE_EQ(through->leave, 7);
    const auto scaled = through_sphere({-5, 0, 0}, {4, 0, 0}, {0, 0, 0}, 2);
    EXPECT_DOUBLE_EQ(scaled->enter, 0.75) << "t is in lengths of the direction";
    const auto chord = through_sphere({-5, 1, 0}, {1, 0, 0}, {0, 0, 0}, 2);
    EXPECT_DOUBLE_EQ(chord->enter, 5 - std::sqrt(3.0));
    EXPECT_DOUBLE_EQ(chord->leave, 5 + std::sqrt(3.0));
    EXPECT_FALSE(through_sphere({-5, 2.1, 0}, {1, 0, 0}, {0, 0, 0}, 2));
    const auto behind = through_sphere({5, 0, 0}, {1, 0, 0}, {0, 0, 0}, 2);
    EXPECT_DOUBLE_EQ(behind->enter, -7);
    EXPECT_FALSE(first_meeting(behind));
}

/// Close to the surface the smaller root is a difference of almost equal numbers.
TEST(FormulaBodies, RootsKeepTheirDigitsCloseToTheSphere) {
    const double gap   = 1e-9;
    const auto through = through_sphere({-1 - gap, 0, 0}, {1, 0, 0}, {0, 0, 0}, 1);
    EXPECT_NEAR(through->enter, gap, 1e-15);
    EXPECT_NEAR(through->leave, 2 + gap, 1e-15);
}

TEST(FormulaBodies, BoxIsTheOverlapOfThreeIntervals) {
    const dvec3 low(-1, -2, -3), high(1, 2, 3);
    const auto straight = through_box({-4, 0, 0}, {1, 0, 0}, low, high);
    EXPECT_EQ(straight->enter, 3);
    EXPECT_EQ(straight->leave, 5);
    const auto oblique = through_box({-2, -2.5, 0}, {1, 1, 0}, low, high);  // x: 1 to 3, y: 0.5 to 4.5
    EXPECT_EQ(oblique->enter, 1);
    EXPECT_EQ(oblique->leave, 3);
    EXPECT_FALSE(through_box({-4, 0, 0}, {1, 1, 0}, low, high)) << "x: 3 to 5, y: -2 to 2";
    EXPECT_FALSE(through_box({-4, 2.5, 0}, {1, 0, 0}, low, high));
    EXPECT_TRUE(through_box({-4, 2, 0}, {1, 0, 0}, low, high)) << "in a face's plane";
    const auto inside = through_box({0, 0, 0}, {0, 0, -1}, low, high);
    EXPECT_EQ(inside->enter, -3);
    EXPECT_EQ(first_meeting(inside), 3);
}

/// A ray that was refracted into a sphere starts on it, and meets it again at the larger root. With the lecture's rule
/// it never leaves.
TEST(FormulaBodies, SmallerRootAboveZeroFailsFromInsideASphere) {
    const dvec3 origin(-3, 0.5, 0), d(1, 0, 0);
    const auto entry = through_sphere(origin, d, dvec3(0), 1);
    ASSERT_TRUE(smaller_root(entry));
    const dvec3 p = origin + *smaller_root(entry) * d;
    EXPECT_NEAR(glm::length(p), 1, 1e-15);

    const auto inside = refracted(d, p, 1 / 1.5);  // p is the normal of the unit sphere
    ASSERT_TRUE(inside);
    const auto exit = through_sphere(p, *inside, dvec3(0), 1);
    EXPECT_FALSE(smaller_root(exit) && *smaller_root(exit) > 1e-9) << "the lecture's rule finds no exit";
    const auto leaves = first_meeting(exit, 1e-9);
    ASSERT_TRUE(leaves);
    const dvec3 q = p + *leaves * *inside;
    EXPECT_NEAR(glm::length(q), 1, 1e-12);

    // Both refractions turn the ray by the same angle: in all 2 (in - out), sin(in) = 1/2.
    const auto outside = refracted(*inside, -q, 1.5);
    ASSERT_TRUE(outside);
    const double in = std::asin(0.5), out = std::asin(0.5 / 1.5);
    EXPECT_NEAR(std::acos(glm::dot(*outside, d)), 2 * (in - out), 1e-12);

    // From the middle the smaller root is behind the origin.
    const auto middle = through_sphere({0, 0, 0}, d, dvec3(0), 1);
    EXPECT_FALSE(smaller_root(middle));
    EXPECT_DOUBLE_EQ(*first_meeting(middle), 1);
}

/// Bodies may interpenetrate: the nearest meeting counts, without their intersection.
TEST(FormulaBodies, InterpenetratingBodiesNeedNoIntersection) {
    const auto nearest = [](double y) {
        const dvec3 origin(-5, y, 0), d(1, 0, 0);
        const auto sphere = first_meeting(through_sphere(origin, d, dvec3(0), 1)),
                   box    = first_meeting(through_box(origin, d, dvec3(-0.9, -2, -2), dvec3(2, 2, 2)));
        return std::pair(sphere && (!box || *sphere < *box) ? 's' : 'b', sphere ? std::min(*sphere, *box) : *box);
    };
    EXPECT_EQ(nearest(0), std::pair('s', 4.0));
    EXPECT_EQ(nearest(0.8), std::pair('b', 4.1));  // the sphere is at 4.4
    EXPECT_EQ(nearest(1.5), std::pair('b', 4.1));
}

TEST(FormulaBodies, CylinderAndConeEndAtTheirCaps) {
    const auto at = [](const std::optional<Passage>& p) {
        return p ? std::pair(p->enter, p->leave) : std::pair(9.0, 9.0);
    };
    // Across, along, and past a cylinder of radius 1 and half height 2.
    EXPECT_EQ(at(through_cylinder({-3, 0, 0}, {1, 0, 0}, 1, 2)), std::pair(2.0, 4.0));
    EXPECT_EQ(at(through_cylinder({0.5, 0, 5}, {0, 0, -1}, 1, 2)), std::pair(3.0, 7.0));
    EXPECT_FALSE(through_cylinder({-3, 0, 2.5}, {1, 0, 0}, 1, 2));
    EXPECT_FALSE(through_cylinder({1.5, 0, 5}, {0, 0, -1}, 1, 2));
    // A cone whose base, of radius 1, is at z = -1: half as wide at z = 0. Down its axis, across, and beside its mirror image.
    EXPECT_EQ(at(through_cone({0, 0, 3}, {0, 0, -1}, 1, 1)), std::pair(2.0, 4.0));
    EXPECT_EQ(at(through_cone({-3, 0, 0}, {1, 0, 0}, 1, 1)), std::pair(2.5, 3.5));
    EXPECT_EQ(at(through_cone({0.25, 0, 3}, {0, 0, -1}, 1, 1)), std::pair(2.5, 4.0));
    EXPECT_FALSE(through_cone({-3, 0, 1.5}, {1, 0, 0}, 1, 1));
    EXPECT_EQ(at(through_cone({-3, 0, -1}, {2, 0, 0}, 1, 1)), std::pair(1.0, 2.0)) << "any length of the direction";
}

TEST(FormulaBodies, ATorusIsEnteredTwice) {
    const auto check = [](dvec3 o, dvec3 d, const std::vector<double>& expected) {
        const Passages found = through_torus(o, d, 2, 0.5);
        ASSERT_EQ(2 * static_cast<std::size_t>(found.count), expected.size());
        for (std::size_t k = 0; k < expected.size(); ++k)
            EXPECT_NEAR(k % 2 == 0 ? found.list[k / 2].enter : found.list[k / 2].leave, expected[k], 1e-12);
    };
    check({-5, 0, 0}, {1, 0, 0}, {2.5, 3.5, 6.5, 7.5});
    check({-5, 0, 0}, {0.5, 0, 0}, {5, 7, 13, 15});
    check({0, 0, 5}, {0, 0, -1}, {});                      // through its hole
    check({2, 0, 5}, {0, 0, -1}, {4.5, 5.5});              // through its tube
    check({-5, 0, 0.3}, {1, 0, 0}, {2.6, 3.4, 6.6, 7.4});  // sqrt(0.25 - 0.09) = 0.4 around each circle
    check({-5, 0, 0.6}, {1, 0, 0}, {});
    check({2.4, -9, 0}, {0, 1, 0}, {9 - std::sqrt(0.49), 9 + std::sqrt(0.49)});  // x^2 + y^2 = 6.25 outside
}

TEST(FormulaBodies, AgreeWithFineTriangles) {
    Scene scene;
    scene.materials.resize(1);
    const Mesh ball = make_sphere(1, 512, 256), box = make_box({1, 2, 3});
    add_object(scene, "ball", ball.positions, ball.normals, ball.triangles, 0);
    std::vector<vec3> moved = box.positions;
    for (vec3& p : moved) p.x += 4;
    add_object(scene, "box", moved, {}, box.triangles, 0);
    const RayScene rays(scene);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    int met = 0, misses = 0;
    for (int k = 0; k < 2000; ++k) {
        const dvec3 origin(2 + 6 * any(random), 6 * any(random), 6 * any(random));
        const dvec3 d = glm::normalize(dvec3(2, 0, 0) + 2.0 * dvec3(any(random), any(random), any(random)) - origin);
        const auto ball_at = first_meeting(through_sphere(origin, d, dvec3(0), 1)),
                   box_at  = first_meeting(through_box(origin, d, dvec3(3.5, -1, -1.5), dvec3(4.5, 1, 1.5)));
        const TriangleId t = first_by_tree(rays, {origin, d, kNoTriangle, dvec3(0)});
        const int expected = ball_at && (!box_at || *ball_at < *box_at) ? 0 : box_at ? 1 : -1;
        const int found    = t == kNoTriangle ? -1 : static_cast<int>(scene.triangle_object[t]);
        met += expected >= 0 ? 1 : 0;
        misses += expected != found ? 1 : 0;  // between the sphere and its facets
    }
    EXPECT_GT(met, 300);
    EXPECT_LE(misses, 1);
}

}  // namespace
}  // namespace umbra
