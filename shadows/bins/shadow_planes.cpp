#include "umbra/shadows/bins/shadow_planes.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "umbra/core/base/lanes.h"

namespace umbra::bins {
namespace {

double largest(double a, double b, double c) {
    const double ab = a > b ? a : b;
    return ab > c ? ab : c;
}

}  // namespace

ShadowPlanes::ShadowPlanes(const LightImage::Corners& corners, const LightImage::Corners& travel,
                           const double (&turn)[kLanes], dvec3 reach) {
    Vectors ab, ac, bc;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t i = 0; i < kLanes; ++i) {
            ab[axis][i] = corners[1][axis][i] - corners[0][axis][i];
            ac[axis][i] = corners[2][axis][i] - corners[0][axis][i];
            bc[axis][i] = corners[2][axis][i] - corners[1][axis][i];
        }
    double back[kLanes], ones[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i) back[i] = -turn[i], ones[i] = 1;
    set(0, ab, ac, corners[0], turn, reach);  // first: it rules out most
    set(1, travel[0], ab, corners[0], turn, reach);
    set(2, travel[1], bc, corners[1], turn, reach);
    set(3, travel[2], ac, corners[2], back, reach);
    if (std::ranges::count(turn, 0.0) == 0) return;
    ShadowPlanes edge_on(*this);
    for (std::size_t k = 0; k < 4; ++k)
        edge_on.set(k, k % 2 == 0 ? ab : ac, k % 2 == 0 ? ac : ab, corners[0], ones, reach);
    for (std::size_t i = 0; i < kLanes; ++i)
        for (std::size_t k = 0; turn[i] == 0 && k < 4; ++k) {
            x_[k][i] = edge_on.x_[k][i], y_[k][i] = edge_on.y_[k][i], z_[k][i] = edge_on.z_[k][i];
            offset_[k][i] = edge_on.offset_[k][i];
        }
}

/// turn * first x second . (p - through) > 0. In floats each product has a rounded factor from either side and is
/// rounded, as are the offset and three sums: less than 8 roundings of the sum of all magnitudes. The normal itself,
/// and the offset, come from products of sizes, with less than 32 roundings in double.
UMBRA_FOR_EACH_PROCESSOR void ShadowPlanes::set(std::size_t plane, const Vectors& first, const Vectors& second,
                                                const Vectors& through, const double (&turn)[kLanes], dvec3 reach) {
    const double farthest = largest(reach.x, reach.y, reach.z);
    for (std::size_t i = 0; i < kLanes; ++i) {
        const double nx = turn[i] * (first[1][i] * second[2][i] - first[2][i] * second[1][i]),
                     ny = turn[i] * (first[2][i] * second[0][i] - first[0][i] * second[2][i]),
                     nz = turn[i] * (first[0][i] * second[1][i] - first[1][i] * second[0][i]);
        const double px = through[0][i], py = through[1][i], pz = through[2][i];
        const double constant = -(nx * px + ny * py + nz * pz), offset = std::abs(constant);
        const double ax = std::abs(px), ay = std::abs(py), az = std::abs(pz);
        const double wx = std::abs(nx), wy = std::abs(ny), wz = std::abs(nz);
        const double spread  = wx * (reach.x + ax) + wy * (reach.y + ay) + wz * (reach.z + az);
        const double product = largest(std::abs(first[0][i]), std::abs(first[1][i]), std::abs(first[2][i])) *
                               largest(std::abs(second[0][i]), std::abs(second[1][i]), std::abs(second[2][i]));
        const double bound =
            8 * 0x1p-24 * (spread + offset) + 32 * 0x1p-53 * product * 3 * (farthest + largest(ax, ay, az));
        // A bound that underflows is none, and a plane that overflows is none: then every lane is unsure.
        const double size = largest(wx, wy, wz), most = size > offset ? size : offset;
        const bool is_bound = (bound > 1e-290) & (most < 1e36 * bound);
        const double over   = is_bound ? 1 / bound : 0.0;
        x_[plane][i]        = static_cast<float>(over * nx);
        y_[plane][i]        = static_cast<float>(over * ny);
        z_[plane][i]        = static_cast<float>(over * nz);
        offset_[plane][i]   = static_cast<float>(over * constant);
    }
}

/// Which lanes are in the shadow of triangle t, and eight bits above these, which are outside.
unsigned ShadowPlanes::lanes_of(std::size_t t, const Block& block) const {
    float x[4], y[4], z[4], offset[4];
    for (std::size_t k = 0; k < 4; ++k) x[k] = x_[k][t], y[k] = y_[k][t], z[k] = z_[k][t], offset[k] = offset_[k][t];
    float least[kLanes];
#pragma GCC unroll 1
    for (std::size_t i = 0; i < kLanes; ++i) {
        const float a  = x[0] * block.x[i] + y[0] * block.y[i] + z[0] * block.z[i] + offset[0],
                    b  = x[1] * block.x[i] + y[1] * block.y[i] + z[1] * block.z[i] + offset[1],
                    c  = x[2] * block.x[i] + y[2] * block.y[i] + z[2] * block.z[i] + offset[2],
                    d  = x[3] * block.x[i] + y[3] * block.y[i] + z[3] * block.z[i] + offset[3];
        const float ab = a < b ? a : b, cd = c < d ? c : d;
        least[i] = ab < cd ? ab : cd;
    }
    unsigned bits = 0;
#pragma GCC unroll 1
    for (std::size_t i = 0; i < kLanes; ++i)
        bits |= (static_cast<unsigned>(least[i] > 1) << i) | (static_cast<unsigned>(least[i] < -1) << (kLanes + i));
    return bits;
}

UMBRA_FOR_EACH_PROCESSOR unsigned ShadowPlanes::test(unsigned which, const Block& block,
                                                     InShadow (&lanes)[kLanes]) const {
    unsigned some = 0;
    for (unsigned rest = which; rest != 0; rest &= rest - 1) {
        const auto t        = static_cast<std::size_t>(std::countr_zero(rest));
        const unsigned bits = lanes_of(t, block), inside = bits & 0xffu, unsure = ~(bits | bits >> kLanes) & 0xffu;
        lanes[t] = {static_cast<std::uint8_t>(inside), static_cast<std::uint8_t>(unsure)};
        some |= static_cast<unsigned>((inside | unsure) != 0) << t;
    }
    return some;
}

}  // namespace umbra::bins
