// Eight receivers at a time have the bits of one.
#include "umbra/shadows/maps/receive_eight.h"

#include <gtest/gtest.h>

#include <bit>
#include <random>

namespace umbra {
namespace {

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

TEST(ReceiveEight, HasTheBitsOfReceive) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> both(-1, 1), unit(0, 1);
    const auto vector   = [&] { return dvec3(both(random), both(random), both(random)); };
    std::size_t covered = 0, left_out = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const bool perspective = trial % 3 != 0;
        LightFrame frame       = looking_along(3.0 * vector(), vector(), perspective);
        frame.centre           = {0.3 * both(random), 0.3 * both(random)};
        frame.half             = {0.2 + unit(random), 0.2 + unit(random)};
        frame.near = perspective ? 0.1 + unit(random) : -5, frame.far = 6 + unit(random);
        frame.reach = 0.5 + unit(random);
        const MapView view{frame, DepthMap(40, 24, trial % 2 == 0 ? DepthFormat::float32 : DepthFormat::unorm16)};
        const Bias bias{static_cast<BiasMode>(trial % 3 == 0 ? trial / 3 % 3 : trial % 3), unit(random), unit(random),
                        trial % 5 == 0 ? unit(random) : 0};
        const Filter filter{trial % 4, false};
        FacetPoints8 points;
        std::vector<Facet> facets(8);
        for (int k = 0; k < 8; ++k) {
            facets[static_cast<std::size_t>(k)].normal =
                trial % 11 == 0 ? glm::cross(frame.z, frame.x) : glm::normalize(vector());
            points.set(k, 4.0 * vector(), facets[static_cast<std::size_t>(k)].normal);
        }
        const unsigned which   = random() & 0xff;
        const Receivers8 eight = receive_eight(view, points, which, bias, filter);
        for (int k = 0; k < 8; ++k) {
            const auto one = receive(view, facets[static_cast<std::size_t>(k)], points.point(k), bias, filter);
            ASSERT_EQ((eight.covered >> k & 1) != 0, one.has_value() && (which >> k & 1) != 0) << trial;
            if ((eight.covered >> k & 1) == 0) {
                ++left_out;
                continue;
            }
            ++covered;
            const Receiver r = eight.lane(k);
            for (const auto member : {&Receiver::x, &Receiver::y, &Receiver::r, &Receiver::r_x, &Receiver::r_y,
                                      &Receiver::bias, &Receiver::slack, &Receiver::most, &Receiver::snapping})
                ASSERT_EQ(bits(r.*member), bits((*one).*member)) << trial << " " << k;
            EXPECT_EQ(r.turn, one->turn);
        }
    }
    EXPECT_GT(covered, 1000u);
    EXPECT_GT(left_out, 1000u);
}

TEST(ReceiveEight, OneSampleBlocksTheLanesThatLitShareHasItBlock) {
    // A map with something in about half of its samples, and receivers in and around it.
    std::mt19937 random(9);
    std::uniform_real_distribution<double> both(-1, 1), unit(0, 1);
    std::size_t lit_count = 0, blocked_count = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        constexpr int width = 20, height = 12;
        MapView view{LightFrame{},
                     DepthMap(width, height, trial % 2 == 0 ? DepthFormat::float32 : DepthFormat::unorm24)};
        std::vector<vec3> positions;
        std::vector<uvec3> triangles;
        for (std::uint32_t i = 0; i < 30; ++i) {
            for (int k = 0; k < 3; ++k) positions.emplace_back(1.2 * both(random), 1.2 * both(random), unit(random));
            triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
        }
        const std::span<const uvec3> run(triangles);
        view.map.draw(dmat4(1), positions, std::span(&run, 1), Faces::all);
        Receivers8 receivers;
        receivers.covered = random() & 0xff;
        for (int k = 0; k < 8; ++k) {
            receivers.x[k] = (0.5 + 0.6 * both(random)) * width, receivers.y[k] = (0.5 + 0.6 * both(random)) * height;
            receivers.r[k]   = 1.2 * unit(random) - 0.1;
            receivers.r_x[k] = 0.3 * both(random), receivers.r_y[k] = 0.3 * both(random);
            receivers.bias[k]  = trial % 5 == 0 ? 0 : 0.02 * unit(random);
            receivers.slack[k] = 0.05 * unit(random), receivers.most[k] = 0.08 * unit(random);
            receivers.snapping[k] = 0;
        }
        for (const BiasMode mode : {BiasMode::automatic, BiasMode::receiver_plane, BiasMode::manual}) {
            const unsigned lit = lit_lanes(view, receivers, mode);
            for (int k = 0; k < 8; ++k) {
                const bool covered = (receivers.covered >> k & 1) != 0;
                const bool one     = covered && lit_share(view, receivers.lane(k), mode, {}) == 1;
                ASSERT_EQ((lit >> k & 1) != 0, one) << trial << ' ' << k;
                ++(one ? lit_count : blocked_count);
            }
        }
    }
    EXPECT_GT(lit_count, 10000u);
    EXPECT_GT(blocked_count, 10000u);
}

}  // namespace
}  // namespace umbra
