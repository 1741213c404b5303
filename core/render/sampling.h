// Sample points on area lights: well spread pairs in the unit square, and maps from there that keep area.
//
// Everything here is a pure function of (sampler, count, seed, point, sample): no state, any thread, any order.
// Eight samples are made at a time, in loops that compilers turn into vector code.
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "umbra/core/base/math.h"

namespace umbra {

/// How the variance of an estimate falls with the number N of samples, across a shadow's edge and where the light is
/// wholly seen or smoothly hidden [Don Mitchell, Consequences of Stratified Sampling in Graphics, 1996].
enum class Sampler : std::uint8_t {
    random,      ///< independent: N^-1 everywhere
    stratified,  ///< one jittered in each of N cells of equal area: N^-1.5 across an edge, N^-2 smooth
    regular,     ///< the same cells, all jittered alike: a grid, shifted from point to point; its errors are bands
    r2,          ///< an additive recurrence, shifted from point to point
                 ///< [Martin Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018]
    sobol        ///< Owen-scrambled: N^-1.5 across an edge, N^-3 smooth
                 ///< [Art Owen, Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences, 1995]
};
inline constexpr std::string_view kSamplers = "random|stratified|regular|r2|sobol";

/// Eight points of the unit square, [0, 1) each way.
struct Samples8 {
    float x[8], y[8];
};

/// Two independent random words of a surface point.
struct PointKey {
    std::uint32_t x = 0, y = 0;
};

/// The samples of every surface point, for one light.
class SampleSet {
public:
    SampleSet(Sampler sampler, int count, std::uint32_t seed);

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] PointKey key(std::uint64_t point) const;

    /// Samples first .. first + 7 of that point, `first` a multiple of 8. Those from `count` on mean nothing.
    void eight(PointKey key, int first, Samples8& out) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct Cell {
        float x[8], y[8], width[8], height[8];  ///< corner and size
    };
    struct Word {
        std::uint32_t x[8], y[8];
    };
    Sampler sampler_;
    int count_;
    std::uint32_t seed_;
    std::vector<Cell> cells_;  ///< stratified, regular: eight cells each
    std::vector<Word> words_;  ///< sobol: unscrambled, bits reversed; r2: fractions of 2^32
};

/// The concentric map of the unit square to the unit disk, area to area, in place
/// [Peter Shirley, Kenneth Chiu, A Low Distortion Map Between Disk and Square, 1997].
void map_to_disk(Samples8& points);

/// The circle in which the cone from p touches a sphere: the disk that p sees of a sphere light.
/// Not there where p lies in the sphere.
struct TangentDisk {
    dvec3 centre;
    dvec3 axis_u, axis_v;  ///< perpendicular, as long as the disk's radius
};
[[nodiscard]] bool tangent_disk(dvec3 p, dvec3 centre, double radius, TangentDisk& disk);

}  // namespace umbra
