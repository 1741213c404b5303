#include "umbra/core/scene/topology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/base/raw_vector.h"

namespace umbra {
namespace {

constexpr std::uint32_t kFree = 0xffffffffu;
constexpr std::size_t kAhead  = 16;  ///< triangles whose corners are on their way from memory

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

/// Work on memory that is written all over is split into as many parts: each thread reads everything and writes its
/// own.
std::size_t parts_of(std::size_t items) {
    return items < 16384 ? 1 : std::clamp<std::size_t>(static_cast<std::size_t>(thread_count()), 1, 8);
}

/// For each of the `count` positions from `low` on: the first one that is equal, counted from `low`. Through hash
/// tables with open addressing.
std::vector<std::uint32_t> first_equal(const Scene& scene, std::size_t low, std::size_t count) {
    const auto bits_of = [&](std::size_t i) { return bits(scene.positions[low + i]); };
    std::vector<std::uint64_t> hashes(count);
    parallel_ranges(count, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) hashes[i] = hash(bits_of(i));
    });
    std::vector<std::uint32_t> equal(count);
    const std::size_t parts = parts_of(count);
    parallel_ranges(parts, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t part = first; part < last; ++part) {
            const auto is_own = [&](std::size_t i) { return (hashes[i] >> 48) % parts == part; };
            std::size_t own   = 0;
            for (std::size_t i = 0; i < count; ++i) own += is_own(i) ? 1u : 0u;
            const std::size_t size = std::bit_ceil(2 * own + 1);
            std::vector<std::uint32_t> table(size, kFree);
            for (std::size_t i = 0; i < count; ++i) {
                if (i + kAhead < count) __builtin_prefetch(&table[hashes[i + kAhead] & (size - 1)], 1);
                if (!is_own(i)) continue;
                std::size_t slot = hashes[i] & (size - 1);
                while (table[slot] != kFree && bits_of(table[slot]) != bits_of(i)) slot = (slot + 1) & (size - 1);
                if (table[slot] == kFree) table[slot] = static_cast<std::uint32_t>(i);
                equal[i] = table[slot];
            }
        }
    });
    return equal;
}

/// Numbers vertices as they are first used.
void weld(const Scene& scene, Topology& topology) {
    std::uint32_t low = kFree, high = 0;
    for (const uvec3 t : topology.triangles) {
        low  = std::min({low, t.x, t.y, t.z});
        high = std::max({high, t.x, t.y, t.z});
    }
    if (topology.triangles.empty()) return;

    const std::size_t count                = std::size_t{high} - low + 1;
    const std::vector<std::uint32_t> equal = first_equal(scene, low, count);
    std::vector<std::uint32_t> welded(count, kFree);  // of each position that comes first
    for (std::size_t n = 0; n < topology.triangles.size(); ++n) {
        if (n + kAhead < topology.triangles.size())
            for (int k = 0; k < 3; ++k) {
                __builtin_prefetch(&equal[topology.triangles[n + kAhead][k] - low]);
                __builtin_prefetch(&welded[topology.triangles[n + kAhead][k] - low]);
            }
        uvec3& t = topology.triangles[n];
        for (int k = 0; k < 3; ++k) {
            std::uint32_t& w = welded[equal[t[k] - low]];
            if (w == kFree) {
                w = static_cast<std::uint32_t>(topology.position.size());
                topology.position.push_back(t[k]);
            }
            t[k] = w;
        }
    }
}

/// A triangle's side between two welded vertices, a < b.
struct Side {
    std::uint32_t a, b;
    EdgeUse use;
};

/// Calls body(side) for the sides of all triangles that have edges whose lower end is one of the vertices [first,
/// last), triangle by triangle.
template <class Body>
void for_each_side(const Topology& topology, std::size_t first, std::size_t last, const Body& body) {
    const auto count = static_cast<std::uint32_t>(topology.triangles.size());
    for (std::uint32_t t = 0; t < count; ++t) {
        if (topology.repeats_a_corner(t)) continue;
        const uvec3 v = topology.triangles[t];
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t from = v[k], to = v[(k + 1) % 3], a = std::min(from, to);
            if (a - first < last - first)
                body(Side{a, std::max(from, to), {t, static_cast<std::uint8_t>(k), from < to}});
        }
    }
}

/// Sides are put into one bucket a vertex, that of their lower end; buckets are short, and each is sorted alone.
/// Writing to buckets all over the memory takes the time: each thread reads all triangles and fills the buckets of its
/// vertices.
void find_edges(Topology& topology) {
    const std::size_t vertices = topology.position.size();
    const std::size_t parts    = parts_of(topology.triangles.size());
    const auto for_parts       = [&](const auto& body) {
        parallel_ranges(parts, 1, [&](std::size_t from, std::size_t to) {
            for (std::size_t p = from; p < to; ++p) body(vertices * p / parts, vertices * (p + 1) / parts);
        });
    };
    // The sides and the edges of each vertex: how many, then where they begin.
    std::vector<std::uint32_t> begin(vertices + 1, 0), first_edge(vertices + 1, 0);
    const auto add_up = [](std::vector<std::uint32_t>& counts) {
        for (std::size_t v = 1; v < counts.size(); ++v) counts[v] += counts[v - 1];
    };
    for_parts([&](std::size_t first, std::size_t last) {
        for_each_side(topology, first, last, [&](const Side& s) { ++begin[s.a + 1]; });
    });
    add_up(begin);

    RawVector<Side> sides(begin.back());
    for_parts([&](std::size_t first, std::size_t last) {
        std::vector<std::uint32_t> next(begin.begin() + static_cast<std::ptrdiff_t>(first),
                                        begin.begin() + static_cast<std::ptrdiff_t>(last));
        for_each_side(topology, first, last, [&](const Side& s) { sides[next[s.a - first]++] = s; });
        for (std::size_t v = first; v < last; ++v) {
            const std::span own = std::span(sides).subspan(begin[v], begin[v + 1] - begin[v]);
            std::sort(own.begin(), own.end(), [](const Side& l, const Side& r) {
                if (l.b != r.b) return l.b < r.b;
                if (l.use.triangle != r.use.triangle) return l.use.triangle < r.use.triangle;
                return l.use.side < r.use.side;
            });
            for (std::size_t k = 0; k < own.size(); ++k)
                first_edge[v + 1] += k == 0 || own[k].b != own[k - 1].b ? 1u : 0u;
        }
    });
    add_up(first_edge);

    topology.uses.resize(sides.size());
    topology.edges.resize(first_edge.back());
    parallel_ranges(vertices, 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t v = first; v < last; ++v) {
            Edge* edge = topology.edges.data() + first_edge[v];
            for (std::uint32_t k = begin[v]; k < begin[v + 1]; ++k) {
                if (k == begin[v] || sides[k].b != sides[k - 1].b) *edge++ = {sides[k].a, sides[k].b, k, 0};
                ++edge[-1].count;
                topology.uses[k] = sides[k].use;
            }
        }
    });
}

}  // namespace

bool is_degenerate(vec3 a, vec3 b, vec3 c) {
    // The area is zero where each component of the normal is. In double one is a difference of two products of rounded
    // differences: off by at most 8 roundings of `size`. That settles the matter for all but true slivers.
    const dvec3 ab = dvec3(b) - dvec3(a), ac = dvec3(c) - dvec3(a), normal = glm::cross(ab, ac);
    const auto largest = [](dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
    if (const double size = largest(ab) * largest(ac); largest(normal) > 16 * 0x1p-53 * size) return false;
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
