#include "umbra/shadows/planar/outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/base/rounding.h"

namespace umbra::planar {
namespace {

/// The greatest height of an occluder in an outline, as a fraction of the source's.
constexpr double kHighest = 1 - 0x1p-10;

/// A vertex, its shadow, and how far rounding may have moved that.
struct ShadowCorner {
    dvec3 at{0};
    dvec2 shadow{0};
    double slack = 0;

    ShadowCorner(const LocalSource& source, dvec3 x) : at(x), shadow(source.project(x)) {
        const double height = source.at_infinity ? source.at.z : source.at.z - x.z;
        const double length = sum_of_magnitudes(source.at_infinity ? source.at : source.at - x);
        slack =
            1e-14 * (1 + length / height) * (std::abs(x.x) + std::abs(x.y) + std::abs(shadow.x) + std::abs(shadow.y));
    }
};

/// Whether the edge may pass through the bounds.
bool may_meet(const OutlineEdge& e, const Reach& bounds) {
    const dvec2 low = glm::min(e.from, e.to) - e.slack, high = glm::max(e.from, e.to) + e.slack;
    if (low.x > bounds.high.x || low.y > bounds.high.y || high.x < bounds.low.x || high.y < bounds.low.y) return false;
    const dvec2 middle = 0.5 * (bounds.low + bounds.high), half = bounds.high - middle;
    const double reach = std::abs(e.side.a) * half.x + std::abs(e.side.b) * half.y;
    return !(std::abs(e.side.at(middle.x, middle.y)) > reach + e.doubt);
}

/// The counts at the places, edge by edge: along x from infinity, where nothing is dark.
struct Counts {
    std::array<dvec2, kPlaces.size()> at{};
    std::array<double, kPlaces.size()> count{}, doubt{};

    explicit Counts(const Reach& reach) {
        for (std::size_t k = 0; k < at.size(); ++k)
            at[k] = reach.low + dvec2(kPlaces[k][0], kPlaces[k][1]) * (reach.high - reach.low);
    }
    void add(const OutlineEdge& e) {
        for (std::size_t k = 0; k < at.size(); ++k) {
            const double y = at[k].y, side = e.side.at(at[k].x, y);
            const bool rises = e.from.y <= y, ends_above = !(e.to.y <= y);
            if (rises == ends_above) count[k] += e.change * ((side > 0) - !rises);
            if (std::abs(side) <= e.doubt && y >= std::min(e.from.y, e.to.y) - e.slack &&
                y <= std::max(e.from.y, e.to.y) + e.slack)
                doubt[k] += std::abs(e.change);
        }
    }
    void add(const Counts& other) {
        for (std::size_t k = 0; k < at.size(); ++k) count[k] += other.count[k], doubt[k] += other.doubt[k];
    }
};

/// Empty where the source is not above the receiver. `facing`: of each triangle, +1 where its winding faces the source.
Outline find_outline(const Occluders& occluders, const OccluderMesh& mesh, const Receiver& receiver, const Source& from,
                     std::span<const std::int8_t> facing) {
    const LocalSource source(receiver, from);
    Outline result;
    if (!source.is_above()) return result;
    result.reach = reach_of(receiver, source);
    // Boxes of points are floats, rounded outwards.
    const dvec2 rounding = 0x1p-20 * (glm::abs(result.reach.low) + glm::abs(result.reach.high));
    result.reach         = {result.reach.low - rounding, result.reach.high + rounding};
    const Reach reach    = result.reach;
    const double far     = farthest(reach);
    if (!(far < 1e100)) {
        result.rest = project(occluders, occluders.triangles, receiver, from);
        return result;
    }

    std::vector<dvec3> at(mesh.positions.size());
    parallel_ranges(at.size(), 8192, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) at[v] = receiver.local(mesh.position(static_cast<std::uint32_t>(v)));
    });
    // +1, -1: in the outline, to the left of its edges as wound or to their right. 0: no shadow, or one of the rest.
    std::vector<std::int8_t> turn(mesh.corners.size(), 0);
    std::vector<std::uint8_t> left_out(mesh.corners.size(), 0);
    const std::vector<TriangleId>& all = occluders.triangles;
    parallel_ranges(all.size(), 8192, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const TriangleId t = all[i];
            if (facing[t] == 0 || occluders.plane_of[t] == receiver.plane) continue;
            const uvec3 c      = mesh.corners[t];
            const double low   = std::min({at[c.x].z, at[c.y].z, at[c.z].z}),
                         high  = std::max({at[c.x].z, at[c.y].z, at[c.z].z});
            const double doubt = receiver.doubt_of_height(
                std::max({sum_of_magnitudes(at[c.x]), sum_of_magnitudes(at[c.y]), sum_of_magnitudes(at[c.z])}));
            if (high + doubt <= 0 || (!source.at_infinity && low - doubt >= source.at.z)) continue;
            if (low - doubt >= 0 && (source.at_infinity || high <= kHighest * source.at.z))
                turn[t] = facing[t];
            else
                left_out[t] = 1;
        }
    });

    // Ranges of edges, whose results are put together in their order, whatever threads they ran on.
    constexpr std::size_t run = 32768;
    struct Found {
        std::vector<OutlineEdge> edges;
        Counts counts;
    };
    const std::size_t count = mesh.edges.size();
    std::vector<Found> found((count + run - 1) / run, Found{{}, Counts(reach)});
    parallel_ranges(found.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t r = first; r < last; ++r)
            for (std::size_t e = r * run; e < std::min(count, (r + 1) * run); ++e) {
                const int change = mesh.edges.change(e, [&](TriangleId t) { return turn[t]; });
                if (change == 0) continue;
                const ShadowCorner a(source, at[mesh.edges[e].a]), b(source, at[mesh.edges[e].b]);
                const OutlineEdge edge{a.shadow,
                                       b.shadow,
                                       std::max(a.slack, b.slack),
                                       side_of_edge(source, a.at, b.at, -1),
                                       doubt_of_side(source, a.at, b.at, far),
                                       static_cast<double>(change)};
                found[r].counts.add(edge);
                if (may_meet(edge, reach)) found[r].edges.push_back(edge);
            }
    });
    Counts counts(reach);
    std::size_t size = 0;
    for (const Found& f : found) counts.add(f.counts), size += f.edges.size();
    const auto sure = std::ranges::find(counts.doubt, 0.0) - counts.doubt.begin();
    if (static_cast<std::size_t>(sure) == counts.doubt.size()) {
        result.rest = project(occluders, all, receiver, from);
        return result;
    }
    result.reference = counts.at[static_cast<std::size_t>(sure)];
    result.count     = counts.count[static_cast<std::size_t>(sure)];
    result.edges.reserve(size);
    for (const Found& f : found) result.edges.insert(result.edges.end(), f.edges.begin(), f.edges.end());
    std::vector<TriangleId> rest;
    for (const TriangleId t : all)
        if (left_out[t] != 0) rest.push_back(t);
    result.rest = project(occluders, rest, receiver, from);
    return result;
}

std::vector<Outline> find_outlines(const Occluders& occluders, const OccluderMesh& mesh,
                                   std::span<const Receiver> receivers, const Source& source) {
    std::vector<std::int8_t> facing(mesh.corners.size(), 0);
    const std::vector<TriangleId>& all = occluders.triangles;
    parallel_ranges(all.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Scene& scene = *occluders.scene;
            const vec3 a = scene.vertex(all[i], 0), b = scene.vertex(all[i], 1), c = scene.vertex(all[i], 2);
            facing[all[i]] = static_cast<std::int8_t>(source.at_infinity ? side_of_direction(a, b, c, source.at)
                                                                         : side_of_plane(a, b, c, source.at));
        }
    });
    std::vector<Outline> outlines;
    for (const Receiver& receiver : receivers)
        outlines.push_back(find_outline(occluders, mesh, receiver, source, facing));
    return outlines;
}

}  // namespace

std::size_t Outline::memory_bytes() const {
    std::size_t bytes = sizeof(Outline) + edges.capacity() * sizeof(OutlineEdge);
    for (const Shadows& run : rest) bytes += run.memory_bytes();
    return bytes;
}

std::size_t memory_bytes(const LightOutlines& outlines) {
    std::size_t bytes = 0;
    for (const auto& receivers : outlines)
        for (const Outline& outline : receivers) bytes += outline.memory_bytes();
    return bytes;
}

LightOutlines project(const Occluders& occluders, const OccluderMesh* mesh, std::span<const Receiver> receivers,
                      std::span<const Source> sources, double memory_limit) {
    LightOutlines all;
    double bytes = 0;
    for (const Source& source : sources) {
        if (mesh != nullptr) {
            all.push_back(find_outlines(occluders, *mesh, receivers, source));
        } else {
            all.emplace_back(receivers.size());
            for (std::size_t r = 0; r < receivers.size(); ++r)
                all.back()[r].rest = project(occluders, occluders.triangles, receivers[r], source);
        }
        for (const Outline& outline : all.back()) bytes += static_cast<double>(outline.memory_bytes());
        if (sources.size() == 1 || bytes <= memory_limit) continue;
        const double a_source = bytes / static_cast<double>(all.size());
        throw UsageError(
            fmt::format("planar_projection: the shadows of light_samples={} take about {:.3g} MB, expected at most "
                        "{:.3g} MB, a quarter of this machine's memory; light_samples={} would fit",
                        sources.size(), a_source * static_cast<double>(sources.size()) / 1e6, memory_limit / 1e6,
                        std::max(1.0, std::floor(memory_limit / a_source))));
    }
    return all;
}

}  // namespace umbra::planar
