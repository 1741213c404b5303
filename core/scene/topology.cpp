#include "umbra/core/scene/topology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"

namespace umbra {
namespace {

constexpr std::uint32_t kFree = 0xffffffffu;

/// The bits of a position, such that equal positions have equal bits: adding 0 turns -0 into 0.
std::array<std::uint32_t, 3> bits(vec3 p) {
    return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
            std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

std::uint64_t hash(const std::array<std::uint32_t, 3>& key) {
    std::uint64_t h = 0;
    for (const std::uint32_t k : key) {
        h = (h ^ k) * 0x9e3779b97f4a7c15u;
        h ^= h >> 32;
    }
    return h;
}

/// Numbers vertices through a hash table with open addressing: one entry a position that a triangle uses.
void weld(const Scene& scene, Topology& topology) {
    std::uint32_t low = kFree, high = 0;
    for (const uvec3 t : topology.triangles) {
        low  = std::min({low, t.x, t.y, t.z});
        high = std::max({high, t.x, t.y, t.z});
    }
    if (topology.triangles.empty()) return;

    const std::size_t size = std::bit_ceil(2 * (std::size_t(high) - low + 1));
    std::vector<std::uint32_t> table(size, kFree);                          // welded vertex
    std::vector<std::uint32_t> welded(std::size_t(high) - low + 1, kFree);  // of each position
    for (uvec3& t : topology.triangles) {
        for (int k = 0; k < 3; ++k) {
            std::uint32_t& w = welded[t[k] - low];
            if (w == kFree) {
                const auto key   = bits(scene.positions[t[k]]);
                std::size_t slot = hash(key) & (size - 1);
                while (table[slot] != kFree && bits(scene.positions[topology.position[table[slot]]]) != key)
                    slot = (slot + 1) & (size - 1);
                if (table[slot] == kFree) {
                    table[slot] = static_cast<std::uint32_t>(topology.position.size());
                    topology.position.push_back(t[k]);
                }
                w = table[slot];
            }
            t[k] = w;
        }
    }
}

/// Sides are put into one bucket a vertex, that of their lower end; buckets are short, and each is sorted alone.
void find_edges(Topology& topology) {
    struct Side {
        std::uint32_t a, b;
        EdgeUse use;
    };
    const auto side_of = [&](std::uint32_t t, std::uint8_t k) {
        const std::uint32_t from = topology.triangles[t][k], to = topology.triangles[t][(k + 1) % 3];
        return Side{std::min(from, to), std::max(from, to), {t, k, from < to}};
    };

    const auto triangle_count = static_cast<std::uint32_t>(topology.triangles.size());
    std::vector<std::uint32_t> begin(topology.position.size() + 1, 0);
    for (std::uint32_t t = 0; t < triangle_count; ++t)
        for (std::uint8_t k = 0; k < 3 && !topology.repeats_a_corner(t); ++k) ++begin[side_of(t, k).a + 1];
    for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];

    std::vector<Side> sides(begin.back());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t t = 0; t < triangle_count; ++t)
        for (std::uint8_t k = 0; k < 3 && !topology.repeats_a_corner(t); ++k) {
            const Side s       = side_of(t, k);
            sides[next[s.a]++] = s;
        }

    parallel_ranges(next.size(), 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t v = first; v < last; ++v)
            std::sort(sides.begin() + begin[v], sides.begin() + begin[v + 1], [](const Side& l, const Side& r) {
                if (l.b != r.b) return l.b < r.b;
                if (l.use.triangle != r.use.triangle) return l.use.triangle < r.use.triangle;
                return l.use.side < r.use.side;
            });
    });

    topology.uses.reserve(sides.size());
    topology.edges.reserve(sides.size() / 2);
    for (const Side& s : sides) {
        if (topology.edges.empty() || topology.edges.back().a != s.a || topology.edges.back().b != s.b)
            topology.edges.push_back({s.a, s.b, static_cast<std::uint32_t>(topology.uses.size()), 0});
        ++topology.edges.back().count;
        topology.uses.push_back(s.use);
    }
}

}  // namespace

bool is_degenerate(vec3 a, vec3 b, vec3 c) {
    // The area is zero where each component of the normal is. The largest one, as far as double tells, is asked first:
    // it settles the matter for all but true slivers.
    const dvec3 normal = glm::cross(dvec3(b) - dvec3(a), dvec3(c) - dvec3(a));
    std::array<int, 3> axes{0, 1, 2};
    std::sort(axes.begin(), axes.end(), [&](int i, int j) { return std::abs(normal[i]) > std::abs(normal[j]); });
    return std::all_of(axes.begin(), axes.end(), [&](int i) {
        vec3 axis{0};
        axis[i] = 1;
        return side_of_direction(a, b, c, axis) == 0;
    });
}

Topology find_topology(const Scene& scene, TriangleId first, std::uint32_t count) {
    Topology topology;
    topology.first_triangle = first;
    topology.triangles.assign(scene.triangles.begin() + first, scene.triangles.begin() + first + count);
    weld(scene, topology);
    find_edges(topology);

    topology.degenerate.resize(count);
    parallel_ranges(count, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const auto triangle = static_cast<TriangleId>(first + t);
            topology.degenerate[t] =
                is_degenerate(scene.vertex(triangle, 0), scene.vertex(triangle, 1), scene.vertex(triangle, 2));
        }
    });
    return topology;
}

}  // namespace umbra
