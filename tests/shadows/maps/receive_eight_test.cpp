// Receivers have the bits of their formulas, written down here point by point, one and eight at a time.
#include "umbra/shadows/maps/receive_eight.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

namespace umbra {
namespace {

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

/// One point at a time.
std::optional<Receiver> expected(const MapView& view, const Facet& facet, dvec3 p, const Bias& bias,
                                 const Filter& filter) {
    const LightFrame& f = view.frame;
    dvec3 v             = f.light_space(p);
    const dvec3 n{glm::dot(f.x, facet.normal), glm::dot(f.y, facet.normal), glm::dot(f.z, facet.normal)};
    const auto ndc = [&](dvec3 q) { return (dvec2(q) / (f.perspective ? q.z : 1.0) - f.centre) / f.half; };
    if (f.perspective && v.z <= 0) return {};
    if (const dvec2 at = glm::abs(ndc(v)); at.x > f.reach || at.y > f.reach) return {};

    const dvec2 sample = 2.0 * f.half / dvec2(view.map.width(), view.map.height());   // in window units
    const double width = std::max(sample.x, sample.y) * (f.perspective ? v.z : 1.0);  // in world units
    if (bias.normal_offset > 0) {
        // A plane seen head-on needs no offset, a grazing one all of it.
        const double cosine = f.perspective ? glm::dot(n, v) / glm::length(v) : n.z;
        v += bias.normal_offset * width * std::sqrt(std::max(0.0, 1 - cosine * cosine)) * n;
        if (f.perspective && v.z <= 0) return {};
    }

    Receiver receiver;
    // Beyond the window and the widest kernel nothing is looked up, wherever it is; coordinates become ints later.
    const dvec2 at = glm::clamp(ndc(v), -4.0, 4.0);
    receiver.x     = (at.x + 1) * 0.5 * view.map.width();
    receiver.y     = (at.y + 1) * 0.5 * view.map.height();
    receiver.r     = f.nearness(v.z);

    // dot(n, v) = d is, with s = x/z and t = y/z, 1/z = (n.x s + n.y t + n.z) / d, and nearness is affine in 1/z.
    // Orthographic: z = (d - n.x x - n.y y) / n.z.
    const double scale =
        f.perspective ? f.near * f.far / ((f.far - f.near) * glm::dot(n, v)) : 1 / ((f.far - f.near) * n.z);
    receiver.r_x = std::isfinite(scale) ? scale * n.x * sample.x : 0;
    receiver.r_y = std::isfinite(scale) ? scale * n.y * sample.y : 0;

    const double per_depth = f.perspective ? f.near * f.far / (v.z * v.z * (f.far - f.near)) : 1 / (f.far - f.near);
    const double per_width = width * per_depth;
    const double gradient  = std::max(std::abs(receiver.r_x), std::abs(receiver.r_y));
    const double snapping  = (std::abs(receiver.r_x) + std::abs(receiver.r_y)) / kSnapsPerSample;
    const double samples   = 2 * filter.radius + 1;
    receiver.bias          = bias.constant * per_width + bias.slope * gradient;
    if (bias.mode == BiasMode::manual) return receiver;
    const double largest = glm::length(p) + glm::length(f.origin) + std::abs(v.z);
    receiver.bias += view.map.quantum(receiver.r) + kPositionRounding * largest * per_depth;
    receiver.slack    = samples * (kAutoWidth * per_width + kAutoGradient * gradient) + snapping;
    receiver.most     = samples * kMostAutomatic * per_width;
    receiver.snapping = snapping;
    if (bias.mode == BiasMode::receiver_plane) receiver.bias += snapping;
    return receiver;
}

TEST(ReceiveEight, HasTheBitsOfItsFormulas) {
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
            const Facet& facet = facets[static_cast<std::size_t>(k)];
            const auto one     = expected(view, facet, points.point(k), bias, filter);
            const auto alone   = receive(view, facet, points.point(k), bias, filter);
            ASSERT_EQ(alone.has_value(), one.has_value()) << trial;
            ASSERT_EQ((eight.covered >> k & 1) != 0, one.has_value() && (which >> k & 1) != 0) << trial;
            if ((eight.covered >> k & 1) == 0) {
                ++left_out;
                continue;
            }
            ++covered;
            const Receiver r = eight.lane(k);
            for (const auto member : {&Receiver::x, &Receiver::y, &Receiver::r, &Receiver::r_x, &Receiver::r_y,
                                      &Receiver::bias, &Receiver::slack, &Receiver::most, &Receiver::snapping})
                ASSERT_EQ(std::pair(bits(r.*member), bits((*alone).*member)),
                          std::pair(bits((*one).*member), bits((*one).*member)))
                    << trial << " " << k;
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
