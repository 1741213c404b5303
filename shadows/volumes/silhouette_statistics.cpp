#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/base/random_bits.h"
#include "umbra/shadows/volumes/silhouettes.h"

namespace umbra {
namespace {

constexpr std::size_t kBlock = 64;  // directions that are taken at once, one a bit

double unit_real(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

/// Towards the i-th light: uniform over the sphere, then rounded to float; what follows is exact for the rounded one.
vec3 random_direction(std::uint64_t seed, std::uint64_t i) {
    const std::uint64_t key = mixed_bits(mixed_bits(seed) ^ i);
    const double z          = 2 * unit_real(key) - 1;
    const double phi        = 2 * kPi * unit_real(mixed_bits(key));
    const double r          = std::sqrt(std::max(0.0, 1 - z * z));
    return vec3(dvec3(r * std::cos(phi), r * std::sin(phi), z));
}

struct DirectionBlock {
    std::array<vec3, kBlock> towards;
    alignas(64) std::array<double, kBlock> x, y, z;
};

/// Bit k: the triangle faces direction k. Decided by the normal in double where that is certain: an entry of the normal
/// carries at most five roundings and the sum of products three more, relative to the same expression over magnitudes,
/// and no direction has an entry above 1; 16 u has room to spare. Exactly where it is not.
std::uint64_t facing_bits(vec3 a, vec3 b, vec3 c, const DirectionBlock& block) {
    const dvec3 p = dvec3(b) - dvec3(a), q = dvec3(c) - dvec3(a);
    const dvec3 n = glm::cross(p, q);
    const dvec3 P = glm::abs(p), Q = glm::abs(q);
    const double bound = 16 * 0x1p-53 * (P.y * Q.z + P.z * Q.y + P.z * Q.x + P.x * Q.z + P.x * Q.y + P.y * Q.x);
    alignas(64) std::array<double, kBlock> side;
    for (std::size_t k = 0; k < kBlock; ++k) side[k] = n.x * block.x[k] + n.y * block.y[k] + n.z * block.z[k];
    std::uint64_t facing = 0, certain = 0;
    for (std::size_t k = 0; k < kBlock; ++k) facing |= std::uint64_t(side[k] > bound) << k;
    for (std::size_t k = 0; k < kBlock; ++k) certain |= std::uint64_t(std::abs(side[k]) > bound) << k;
    for (std::uint64_t doubt = ~certain; doubt != 0; doubt &= doubt - 1) {
        const int k = std::countr_zero(doubt);
        if (side_of_direction(a, b, c, block.towards[k]) > 0) facing |= std::uint64_t(1) << k;
    }
    return facing;
}

/// Sixty-four counters, one a bit of the words that are added: binary digits lie across words until they are read.
class BitCounters {
public:
    void add(std::uint64_t word) {
        for (int digit = 0; word != 0; ++digit) {
            const std::uint64_t carry = digits_[digit] & word;
            digits_[digit] ^= word;
            word = carry;
        }
    }
    [[nodiscard]] std::uint64_t count(std::size_t bit) const {
        std::uint64_t n = 0;
        for (std::size_t digit = 0; digit < digits_.size(); ++digit) n |= (digits_[digit] >> bit & 1) << digit;
        return n;
    }

private:
    std::array<std::uint64_t, 40> digits_{};
};

/// Bit k: with every triangle turned to face direction k, those at the edge do not cancel.
std::uint64_t silhouette_bits(std::span<const PackedUse> uses, std::span<const std::uint64_t> facing) {
    const auto runs = [&](PackedUse use) { return use.forward != 0 ? facing[use.triangle] : ~facing[use.triangle]; };
    if (uses.size() % 2 == 1) return ~std::uint64_t(0);
    if (uses.size() == 2) return ~(runs(uses[0]) ^ runs(uses[1]));
    std::uint64_t silhouette = 0;
    for (std::size_t k = 0; k < kBlock; ++k) {
        const auto sign = [&](TriangleId t) { return (facing[t] >> k & 1) != 0 ? 1 : -1; };
        silhouette |= std::uint64_t(change_of(uses, sign) != 0) << k;
    }
    return silhouette;
}

}  // namespace

std::vector<SilhouetteStatistics> silhouette_statistics(const Scene& scene, std::uint64_t directions,
                                                        std::uint64_t seed) {
    const SilhouetteMeshes meshes(scene, find_object_facts(scene));
    const std::size_t objects = scene.objects.size();
    std::vector<std::vector<Neighbours>> closed_edges(objects);
    for (std::size_t o = 0; o < objects; ++o)
        if (meshes.objects()[o].closed()) closed_edges[o] = meshes.objects()[o].neighbours();

    std::vector<SilhouetteStatistics> statistics(objects);
    std::vector<double> squares(objects, 0);  // sum of squared deviations from the running mean

    constexpr std::uint64_t kRound = 16 * 1024;  // bounds the memory for any number of directions
    for (std::uint64_t first = 0; first < directions; first += kRound) {
        const std::uint64_t in_round = std::min(kRound, directions - first);
        const std::size_t blocks     = (in_round + kBlock - 1) / kBlock;
        std::vector<std::uint64_t> counts(objects * blocks * kBlock);
        parallel_ranges(blocks, 1, [&](std::size_t begin, std::size_t end) {
            std::vector<std::uint64_t> facing(scene.triangles.size());
            for (std::size_t b = begin; b < end; ++b) {
                DirectionBlock block;
                for (std::size_t k = 0; k < kBlock; ++k) {
                    block.towards[k] = random_direction(seed, first + b * kBlock + k);
                    block.x[k] = block.towards[k].x, block.y[k] = block.towards[k].y, block.z[k] = block.towards[k].z;
                }
                for (std::size_t t = 0; t < facing.size(); ++t) {
                    const auto id = static_cast<TriangleId>(t);
                    facing[t]     = facing_bits(scene.vertex(id, 0), scene.vertex(id, 1), scene.vertex(id, 2), block);
                }
                for (std::size_t o = 0; o < objects; ++o) {
                    const EdgeList& soup = meshes.objects()[o].soup();
                    BitCounters counters;
                    for (const Neighbours& e : closed_edges[o]) counters.add(facing[e.left] ^ facing[e.right]);
                    for (std::size_t e = 0; e < soup.size(); ++e) counters.add(silhouette_bits(soup.uses(e), facing));
                    for (std::size_t k = 0; k < kBlock; ++k) counts[(o * blocks + b) * kBlock + k] = counters.count(k);
                }
            }
        });
        for (std::size_t o = 0; o < objects; ++o) {
            SilhouetteStatistics& s = statistics[o];
            for (std::size_t k = 0; k < in_round; ++k) {
                const auto n       = static_cast<double>(counts[o * blocks * kBlock + k]);
                const double delta = n - s.mean;
                s.mean += delta / static_cast<double>(++s.directions);
                squares[o] += delta * (n - s.mean);
            }
        }
    }
    for (std::size_t o = 0; o < objects; ++o) {
        statistics[o].object = scene.objects[o].name;
        if (directions > 1)
            statistics[o].standard_error =
                std::sqrt(squares[o] / static_cast<double>(directions - 1) / static_cast<double>(directions));
    }
    return statistics;
}

}  // namespace umbra
