// The shadow of one triangle as four planes, in floats with a bound on what rounding does: a point is in the shadow, is
// outside, or the bound cannot tell.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "umbra/shadows/shared/point_bins.h"

namespace umbra::binned_shadows_detail {

/// The half spaces whose intersection is the shadow, each scaled so that rounding moves a value by less than 1: a value
/// above 1 is inside, below -1 outside.
struct ShadowPlanes {
    std::array<float, 4> x{}, y{}, z{}, offset{};

    /// Of a triangle with these corners, less the bins' centre. `turn`: +1 where its winding faces away from the light,
    /// -1 where it faces the light. `travel`: how light travels to the first corner, any length. `reach`: the largest
    /// magnitude of each coordinate of the points that are asked.
    ShadowPlanes(const std::array<dvec3, 3>& corners, const std::array<dvec3, 3>& travel, double turn, dvec3 reach) {
        const dvec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], bc = corners[2] - corners[1];
        set(0, turn * glm::cross(ab, ac), corners[0], size(ab) * size(ac), reach);  // first: it rules out most
        set(1, turn * glm::cross(travel[0], ab), corners[0], size(travel[0]) * size(ab), reach);
        set(2, turn * glm::cross(travel[1], bc), corners[1], size(travel[1]) * size(bc), reach);
        set(3, -turn * glm::cross(travel[2], ac), corners[2], size(travel[2]) * size(ac), reach);
    }

    /// Of a triangle whose plane holds the light, which hides nothing and may be touched: a lane outside is away from
    /// that plane, and none is inside.
    [[nodiscard]] static ShadowPlanes of_edge_on(const std::array<dvec3, 3>& corners, dvec3 reach) {
        ShadowPlanes planes;
        const dvec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], normal = glm::cross(ab, ac);
        for (std::size_t k = 0; k < 4; ++k)
            planes.set(k, k % 2 == 0 ? normal : -normal, corners[0], size(ab) * size(ac), reach);
        return planes;
    }

    /// Which lanes of a block are in the shadow, and of which that is not known.
    struct Lanes {
        std::uint8_t inside, unsure;
    };
    [[nodiscard]] Lanes test(const Block& block) const;

private:
    ShadowPlanes() = default;

    static double size(dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

    /// normal . (p - through) > 0. In floats each product has a rounded factor from either side and is rounded, as are
    /// the offset and three sums: less than 8 roundings of the sum of all magnitudes. The normal itself, and the
    /// offset, come from products of sizes `product`, with less than 32 roundings in double.
    void set(std::size_t k, dvec3 normal, dvec3 through, double product, dvec3 reach) {
        const double constant = -glm::dot(normal, through);
        const double spread   = glm::dot(glm::abs(normal), reach + glm::abs(through));
        const double bound =
            8 * 0x1p-24 * (spread + std::abs(constant)) + 32 * 0x1p-53 * product * 3 * (size(reach) + size(through));
        // A bound that underflows is none, and a plane that overflows is none: then every lane is unsure.
        const double most = std::max(size(normal), std::abs(constant));
        const double over = bound > 1e-290 && most < 1e36 * bound ? 1 / bound : 0;
        x[k]              = static_cast<float>(over * normal.x);
        y[k]              = static_cast<float>(over * normal.y);
        z[k]              = static_cast<float>(over * normal.z);
        offset[k]         = static_cast<float>(over * constant);
    }
};

}  // namespace umbra::binned_shadows_detail
