// Attenuation, range and spots between the places where they are 0 or 1, by hand.
#include "umbra/core/scene/lights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace umbra {
namespace {

Spot spot(SpotFalloff falloff, float exponent) {
    Spot s;
    s.falloff  = falloff;
    s.cutoff   = std::acos(0.5f);
    s.exponent = exponent;
    return s;
}

TEST(SpotFactor, CosineIsAPower) {
    EXPECT_NEAR(spot_factor(spot(SpotFalloff::cosine, 3), 0.8f), 0.512, 1e-6);
    EXPECT_EQ(spot_factor(spot(SpotFalloff::cosine, 3), 1), 1);
    EXPECT_EQ(spot_factor(spot(SpotFalloff::cosine, 3), 0.49f), 0);
}

/// (cos^n a - cos t) / (1 - cos t) with cos t = 1/2: for n = 2 at cos a = 0.8 it is (0.64 - 0.5) / 0.5; for n = 4 at
/// 0.6 it would be negative.
TEST(SpotFactor, ZachmannIsLinearInThePower) {
    EXPECT_NEAR(spot_factor(spot(SpotFalloff::zachmann, 2), 0.8f), 0.28, 1e-6);
    EXPECT_NEAR(spot_factor(spot(SpotFalloff::zachmann, 1), 0.75f), 0.5, 1e-6);
    EXPECT_EQ(spot_factor(spot(SpotFalloff::zachmann, 4), 1), 1);
    EXPECT_EQ(spot_factor(spot(SpotFalloff::zachmann, 4), 0.6f), 0);
}

/// Halfway between the cosines of inner and cutoff it is 1/2 squared.
TEST(SpotFactor, SmoothIsASquare) {
    Spot s  = spot(SpotFalloff::smooth, 1);
    s.inner = std::acos(0.9f);
    EXPECT_NEAR(spot_factor(s, 0.7f), 0.25, 1e-5);
    EXPECT_NEAR(spot_factor(s, 0.6f), 0.0625, 1e-5);
    EXPECT_EQ(spot_factor(s, 0.95f), 1);
    EXPECT_EQ(spot_factor(s, 0.4f), 0);
}

/// Full in the middle, whatever the angles; in a light, where the cosine is not rounded.
TEST(SpotFactor, NarrowConesAreFullInTheMiddle) {
    for (const auto& [outer, inner] : {std::pair{2.0, 1.0}, {1.0, 0.5}, {0.01, 0.005}, {0.001, 0.0}, {1.0, 1.0}}) {
        Light light;
        light.kind        = LightKind::spot;
        light.direction   = {0, -1, 0};
        light.attenuation = {1, 0, 0, true};
        light.spot        = {SpotFalloff::smooth, 1, float(glm::radians(outer)), float(glm::radians(inner))};
        const auto at     = [&](double degrees) {
            return falloff(light, {static_cast<float>(1e3 * std::tan(glm::radians(degrees))), -1e3f, 0});
        };
        EXPECT_EQ(at(0), 1) << outer;
        EXPECT_EQ(at(0.98 * inner), 1) << outer;
        EXPECT_EQ(at(1.02 * outer), 0) << outer;
        if (inner == outer) continue;
        const double a = (inner + outer) / 2, cos_outer = std::cos(glm::radians(outer));
        const double t = (std::cos(glm::radians(a)) - cos_outer) / (std::cos(glm::radians(inner)) - cos_outer);
        EXPECT_NEAR(at(a), t * t, 1e-4) << outer;
    }
}

TEST(Attenuation, IsOneOverTheQuadratic) {
    EXPECT_NEAR(attenuation_factor({.c1 = 1, .c2 = 2, .c3 = 3, .clamp = true}, 2), 1.0 / 17, 1e-7);
    EXPECT_EQ(attenuation_factor({.c1 = 0.5f, .c2 = 0, .c3 = 0, .clamp = true}, 2), 1);
    EXPECT_EQ(attenuation_factor({.c1 = 0.5f, .c2 = 0, .c3 = 0, .clamp = false}, 2), 2);
}

TEST(Falloff, EndsAtTheRange) {
    Light light;
    light.kind     = LightKind::point;
    light.position = {0, 2, 0};
    light.range    = 3;
    EXPECT_EQ(falloff(light, {0, 0, 0}), 1);
    EXPECT_EQ(falloff(light, {0, -1.5f, 0}), 0);
}

/// From (0, 2, 0) downwards: (1, 0.25, 0) is at the cosine 1.75 / sqrt(1 + 1.75^2) from its axis.
TEST(Falloff, SpotShinesAlongItsAxis) {
    Light light;
    light.kind      = LightKind::spot;
    light.position  = {0, 2, 0};
    light.direction = {0, -3, 0};
    light.spot      = spot(SpotFalloff::cosine, 2);
    EXPECT_NEAR(falloff(light, {0, 0, 0}), 1, 1e-7);
    EXPECT_NEAR(falloff(light, {1, 0.25f, 0}), 1.75 * 1.75 / (1 + 1.75 * 1.75), 1e-6);
    EXPECT_EQ(falloff(light, {0, 4, 0}), 0) << "behind it";
}

}  // namespace
}  // namespace umbra
