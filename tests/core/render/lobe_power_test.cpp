#include "umbra/core/render/lobe_power.h"

#include <gtest/gtest.h>

namespace umbra {
namespace {

TEST(LobePower, IsThePower) {
    for (const float n : {0.0f, 1.0f, 2.0f, 3.0f, 5.0f, 33.0f, 40.0f, 127.0f, 1000.0f, 4096.0f, 0.5f, 33.5f, 5000.0f})
        for (const double x : {0.0, 1e-3, 0.1, 0.5, 0.7071, 0.9, 0.999, 1.0}) {
            const double expected = std::pow(x, static_cast<double>(n));
            EXPECT_NEAR(lobe_power(x, n), expected, expected * 2 * static_cast<double>(n + 1) * 0x1p-53)
                << x << '^' << n;
        }
    EXPECT_EQ(lobe_power(0.5, 10), 0x1p-10);
    EXPECT_EQ(lobe_power(0.0, 0), 1);
}

TEST(LobePower, IsTheSameInLanes) {
    for (const float n : {0.0f, 1.0f, 6.0f, 33.0f, 255.0f}) {
        double lanes[8];
        for (int k = 0; k < 8; ++k) lanes[k] = 0.13 * k + 0.05;
        whole_power<8>(lanes, n);
        for (int k = 0; k < 8; ++k) EXPECT_EQ(lanes[k], lobe_power(0.13 * k + 0.05, n));
    }
}

TEST(LobePower, WholePowersAreSmallWholeNumbers) {
    EXPECT_TRUE(is_whole_power(0) && is_whole_power(1) && is_whole_power(4096));
    EXPECT_FALSE(is_whole_power(0.5f) || is_whole_power(4097) || is_whole_power(-1) || is_whole_power(NAN));
}

}  // namespace
}  // namespace umbra
