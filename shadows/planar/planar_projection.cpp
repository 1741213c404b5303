// Planar projection: throw every occluder from the light onto the receiver's plane, and ask which points lie in what it
// covers.
//
// This work is based on:
// James Blinn. Me and My (Fake) Shadow. 1988
// Paul Heckbert, Michael Herf. Simulating Soft Shadows with Graphics Hardware. 1997 (lights with an area)
//
// Blinn draws the projected polygons. Here they are not drawn: each surface point of the plane is held against the
// projected triangles themselves, so that there is no bitmap whose resolution could err. Only what lies between plane
// and light is projected; what is behind the light, or under the plane, would cast shadows that are not there.
//
//            light *            w = H - h > 0 between plane and light; a point at height h goes to
//                 / \           q = v + (v - light) h / (H - h), in the plane's coordinates
//          v ____/___\    H
//          h    /     \         Whether p lies in the triangle's shadow is decided without q: by the sides of p to the
//    _________q_________p___    three planes through the light and an edge, which need no division and stay sound where
//                               q runs off to infinity. q only bounds the shadow.
#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/render/sampling.h"
#include "umbra/core/scene/topology.h"
#include "umbra/shadows/method.h"

namespace umbra {
namespace {

struct Options {
    double plane_share = kPlanarShare;
    int light_samples  = 64;
};

const std::vector<Parameter> kParameters{
    parameter<&Options::plane_share>({.name  = "plane_share",
                                      .doc   = "Smallest share of the scene's area that makes a plane a receiver.",
                                      .phase = Phase::build,
                                      .min   = kPlanarShare,
                                      .max   = 1}),
    parameter<&Options::light_samples>({.name  = "light_samples",
                                        .doc   = "Points of an area light that occluders are projected from; other "
                                                 "lights have one.",
                                        .unit  = "points a light",
                                        .phase = Phase::aim,
                                        .min   = 1,
                                        .max   = 4096,
                                        .sweep = "4|16|64|256"}),
};

/// A receiver's plane with coordinates of its own: x and y in the plane, z the height over it, from a local origin, so
/// that neither a far nor a large scene costs digits.
struct Receiver {
    dvec3 origin, e1, e2, normal;
    dvec2 low{+kInfinity}, high{-kInfinity};  ///< bounds of its triangles
    double tolerance = 0;                     ///< greatest distance of their corners from the plane

    [[nodiscard]] dvec3 local(dvec3 world) const {
        const dvec3 r = world - origin;
        return {glm::dot(e1, r), glm::dot(e2, r), glm::dot(normal, r)};
    }
    [[nodiscard]] dvec3 local_direction(dvec3 d) const {
        return {glm::dot(e1, d), glm::dot(e2, d), glm::dot(normal, d)};
    }
};

Receiver make_receiver(const Scene& scene, const PlanarReceiver& plane) {
    Receiver r;
    r.normal           = plane.normal;
    const dvec3 helper = std::abs(r.normal.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    r.e1               = glm::normalize(glm::cross(helper, r.normal));
    r.e2               = glm::cross(r.normal, r.e1);
    const dvec3 corner(scene.vertex(plane.triangles[0], 0));
    r.origin = corner - r.normal * (glm::dot(r.normal, corner) - plane.offset);
    for (const TriangleId t : plane.triangles)
        for (int k = 0; k < 3; ++k) {
            const dvec3 x = r.local(dvec3(scene.vertex(t, k)));
            r.low         = glm::min(r.low, dvec2(x));
            r.high        = glm::max(r.high, dvec2(x));
            r.tolerance   = std::max(r.tolerance, std::abs(x.z));
        }
    return r;
}

/// One point to project from: a hard light, or one of an area light's samples.
struct Source {
    bool at_infinity = false;
    vec3 at{0};  ///< position; at infinity the direction towards the light
};

/// A source as one side of a receiver sees it: in its coordinates, the side turned up.
struct LocalSource {
    bool at_infinity;
    dvec3 at;

    /// The shadow of x on the plane; x lies below a source that is not at infinity.
    [[nodiscard]] dvec2 project(dvec3 x) const {
        if (at_infinity) return dvec2(x) - dvec2(at) * (x.z / at.z);
        return dvec2(x) + (dvec2(x) - dvec2(at)) * (x.z / (at.z - x.z));
    }
};

dvec3 turned(dvec3 x, int side) { return {x.x, side * x.y, side * x.z}; }  // about the x axis

LocalSource local_source(const Receiver& receiver, int side, const Source& source) {
    const dvec3 at(source.at);
    return {source.at_infinity, turned(source.at_infinity ? receiver.local_direction(at) : receiver.local(at), side)};
}

using Triangle = std::array<dvec3, 3>;

/// The order in which an edge's ends are taken, so that both triangles of an edge compute the same.
bool before(dvec3 a, dvec3 b) {
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
}

/// Side of a point (x, y) of the plane to the plane through the source and one edge: sign of x * a + y * b + c.
struct Side {
    double a, b, c;
    [[nodiscard]] double at(double x, double y) const { return a * x + b * y + c; }
};

/// det(from - source, to - from, p - from). Only differences of near points meet the large ones of a far source.
Side side_of_edge(const LocalSource& source, dvec3 from, dvec3 to, double sign) {
    if (before(to, from)) {
        std::swap(from, to);
        sign = -sign;
    }
    const dvec3 n = sign * glm::cross(source.at_infinity ? -source.at : from - source.at, to - from);
    return {n.x, n.y, -glm::dot(n, from)};
}

/// What a triangle's shadow is bounded by, in floats rounded outwards. A clipped triangle is several pieces.
struct Shadow {
    vec2 low{+kInfinity}, high{-kInfinity};
    std::uint32_t triangle = 0;  ///< index into the scene, or into Chunk::pieces
    bool piece             = false;
    bool turned            = false;  ///< the source sees the triangle from behind
};

/// The shadows of a run of triangles. Runs are of one length whatever the number of threads.
struct Chunk {
    std::vector<Shadow> shadows;
    std::vector<Triangle> pieces;
    std::vector<TriangleId> piece_of;  ///< one a piece: the triangle that it was cut from

    [[nodiscard]] TriangleId caster(const Shadow& s) const { return s.piece ? piece_of[s.triangle] : s.triangle; }
};
constexpr std::size_t kChunk = 4096;

float nearest_float(double x) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(x, -kLargest, kLargest));
}
float float_below(double x) { return std::nextafter(nearest_float(x), -kInfinity); }
float float_above(double x) { return std::nextafter(nearest_float(x), +kInfinity); }

/// Adds the shadow of a triangle over the plane, unless it misses the rectangle from `low_reach` to `high_reach`. What
/// of the triangle lies above the source is not cut away: rays from the source to it do not come down to the plane.
void add_shadow(Chunk& chunk, dvec2 low_reach, dvec2 high_reach, const LocalSource& source, const Triangle& triangle,
                Shadow shadow) {
    dvec2 low(+kInfinity), high(-kInfinity);
    for (const dvec3 x : triangle) {
        if (!source.at_infinity && x.z >= source.at.z) {  // the shadow runs off to infinity
            low  = dvec2(-kInfinity);
            high = dvec2(+kInfinity);
            break;
        }
        const dvec2 q = source.project(x);
        // Far above the rounding of q, which grows as the ray to it flattens.
        const double height = source.at_infinity ? source.at.z : source.at.z - x.z;
        const double length = glm::length(source.at_infinity ? source.at : source.at - x);
        const dvec2 e       = 1e-14 * (1 + length / height) * (glm::abs(dvec2(x)) + glm::abs(q));
        low                 = glm::min(low, q - e);
        high                = glm::max(high, q + e);
    }
    low  = glm::max(low, low_reach);
    high = glm::min(high, high_reach);
    if (low.x > high.x || low.y > high.y) return;
    shadow.low  = {float_below(low.x), float_below(low.y)};
    shadow.high = {float_above(high.x), float_above(high.y)};
    if (shadow.piece) {
        chunk.piece_of.push_back(shadow.triangle);
        shadow.triangle = static_cast<std::uint32_t>(chunk.pieces.size());
        chunk.pieces.push_back(triangle);
    }
    chunk.shadows.push_back(shadow);
}

/// What of a triangle lies on the plane's upper side.
/// [Ivan Sutherland, Gary Hodgman, Reentrant Polygon Clipping, 1974]
std::vector<dvec3> clip_at_plane(const Triangle& triangle) {
    std::vector<dvec3> kept;
    for (std::size_t k = 0; k < 3; ++k) {
        dvec3 a = triangle[k], b = triangle[(k + 1) % 3];
        if (a.z >= 0) kept.push_back(a);
        if ((a.z < 0 && b.z > 0) || (a.z > 0 && b.z < 0)) {
            if (before(b, a)) std::swap(a, b);
            const dvec3 cut = a + (b - a) * (a.z / (a.z - b.z));
            kept.emplace_back(cut.x, cut.y, 0);
        }
    }
    return kept;
}

/// Projects every triangle but the receiver's own.
std::vector<Chunk> project(const Scene& scene, const std::vector<TriangleId>& occluders,
                           const std::vector<std::uint32_t>& plane_of, std::uint32_t plane, const Receiver& receiver,
                           int side, const Source& from) {
    const LocalSource source = local_source(receiver, side, from);
    if (!(source.at.z > 0)) return {};  // the receiver's other side is lit

    // Points are off the plane by its tolerance, and are moved onto it along their rays.
    const dvec2 corner(turned({receiver.low, 0}, side)), opposite(turned({receiver.high, 0}, side));
    const double span  = source.at_infinity ? glm::length(source.at)
                                            : glm::length(source.at - dvec3(corner, 0)) + glm::length(opposite - corner);
    const double slope = span / std::max(source.at.z - (source.at_infinity ? 0 : receiver.tolerance), 1e-300);
    const dvec2 slack(receiver.tolerance * slope);
    const dvec2 low_reach = glm::min(corner, opposite) - slack, high_reach = glm::max(corner, opposite) + slack;

    std::vector<Chunk> chunks((occluders.size() + kChunk - 1) / kChunk);
    parallel_ranges(chunks.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t c = first; c < last; ++c)
            for (std::size_t i = c * kChunk; i < std::min(occluders.size(), (c + 1) * kChunk); ++i) {
                const TriangleId t = occluders[i];
                if (plane_of[t] == plane) continue;
                Triangle x;
                for (int k = 0; k < 3; ++k)
                    x[static_cast<std::size_t>(k)] = turned(receiver.local(dvec3(scene.vertex(t, k))), side);
                const double low = std::min({x[0].z, x[1].z, x[2].z}), high = std::max({x[0].z, x[1].z, x[2].z});
                if (high <= 0 || (!from.at_infinity && low >= source.at.z)) continue;

                // A triangle whose plane holds the source is seen edge-on: its shadow is a line, all boundary.
                const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), d = scene.vertex(t, 2);
                const int facing =
                    from.at_infinity ? side_of_direction(a, b, d, from.at) : side_of_plane(a, b, d, from.at);
                if (facing == 0) continue;

                Shadow shadow;
                shadow.triangle = t;
                shadow.turned   = facing < 0;
                if (low >= 0) {
                    add_shadow(chunks[c], low_reach, high_reach, source, x, shadow);
                    continue;
                }
                shadow.piece       = true;
                const auto polygon = clip_at_plane(x);
                for (std::size_t k = 2; k < polygon.size(); ++k)
                    add_shadow(chunks[c], low_reach, high_reach, source, {polygon[0], polygon[k - 1], polygon[k]},
                               shadow);
            }
    });
    return chunks;
}

/// The surface points on one side of one receiver, as a tree of boxes over their order along a Z-shaped curve: leaves
/// of 16 points, 8 branches a node. Points become dark, and stay so; a branch whose points are all dark is not entered
/// again. Which thread darkens a point makes no difference to the result.
/// [G. M. Morton, A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing, 1966]
class PointTree {
public:
    static constexpr std::size_t kLeaf = 16, kBranches = 8;

    /// `points` are places in the batch, `at` their coordinates in the plane.
    PointTree(std::vector<std::uint32_t> points, const std::vector<dvec2>& at) : points_(std::move(points)) {
        sort(at);
        build_boxes();
        brighten();
    }

    [[nodiscard]] std::span<const std::uint32_t> points() const { return points_; }
    [[nodiscard]] bool is_dark(std::size_t i) const { return dark_[i] != 0; }

    void brighten() {
        dark_.assign(points_.size(), 0);
        for (std::size_t level = 0; level < levels_.size(); ++level) {
            const std::size_t children = level == 0 ? leaf_count() : levels_[level - 1].size();
            for (std::size_t n = 0; n < levels_[level].size(); ++n) {
                const std::size_t present = std::min(kBranches, children - n * kBranches);
                levels_[level][n].dark    = static_cast<std::uint8_t>(0xffu << present);  // what is not there is dark
            }
        }
    }

    /// Darkens the points within the shadow; those on its boundary are within. May run from many threads.
    void darken(const Shadow& shadow, const std::array<Side, 3>& sides) {
        if (!levels_.empty()) darken(levels_.size() - 1, 0, shadow, sides);
    }

private:
    struct Node {
        float low_x[kBranches], low_y[kBranches], high_x[kBranches], high_y[kBranches];
        std::uint8_t dark = 0;  ///< a bit a branch
    };

    [[nodiscard]] std::size_t leaf_count() const { return (points_.size() + kLeaf - 1) / kLeaf; }

    static std::uint64_t spread(std::uint64_t x) {  // the bits of a 32-bit number, a zero before each
        x = (x | x << 16) & 0x0000ffff0000ffffu;
        x = (x | x << 8) & 0x00ff00ff00ff00ffu;
        x = (x | x << 4) & 0x0f0f0f0f0f0f0f0fu;
        x = (x | x << 2) & 0x3333333333333333u;
        return (x | x << 1) & 0x5555555555555555u;
    }

    void sort(const std::vector<dvec2>& at) {
        dvec2 low(+kInfinity), high(-kInfinity);
        for (const dvec2 p : at) {
            low  = glm::min(low, p);
            high = glm::max(high, p);
        }
        const double extent = std::max({high.x - low.x, high.y - low.y, 1e-300});
        struct Keyed {
            std::uint64_t key;
            std::uint32_t place;
        };
        std::vector<Keyed> order(at.size());
        parallel_ranges(at.size(), 65536, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const dvec2 p = (at[i] - low) / extent * 0x1p31;
                order[i]      = {spread(static_cast<std::uint64_t>(p.x)) | spread(static_cast<std::uint64_t>(p.y)) << 1,
                                 static_cast<std::uint32_t>(i)};
            }
        });
        tbb::parallel_sort(order.begin(), order.end(), [](const Keyed& l, const Keyed& r) {
            return l.key != r.key ? l.key < r.key : l.place < r.place;
        });
        const std::vector<std::uint32_t> unsorted = points_;
        x_.resize(leaf_count() * kLeaf, 0);  // filled up, so that leaves are tested whole
        y_.resize(leaf_count() * kLeaf, 0);
        parallel_ranges(at.size(), 65536, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                points_[i] = unsorted[order[i].place];
                x_[i]      = at[order[i].place].x;
                y_[i]      = at[order[i].place].y;
            }
        });
    }

    void build_boxes() {
        if (points_.empty()) return;
        std::size_t children = leaf_count();
        do {
            std::vector<Node> nodes((children + kBranches - 1) / kBranches);
            parallel_ranges(nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
                for (std::size_t n = begin; n < end; ++n)
                    for (std::size_t k = 0; k < kBranches; ++k) set_box(nodes[n], k, n * kBranches + k, children);
            });
            children = nodes.size();
            levels_.push_back(std::move(nodes));
        } while (children > 1);
    }

    /// The box of child `child` of the level that is being built; children of the lowest nodes are leaves.
    void set_box(Node& node, std::size_t k, std::size_t child, std::size_t children) const {
        vec2 low(+kInfinity), high(-kInfinity);
        if (child < children && levels_.empty()) {
            for (std::size_t i = child * kLeaf; i < std::min(points_.size(), (child + 1) * kLeaf); ++i) {
                low  = glm::min(low, vec2(float_below(x_[i]), float_below(y_[i])));
                high = glm::max(high, vec2(float_above(x_[i]), float_above(y_[i])));
            }
        } else if (child < children) {
            const Node& below = levels_.back()[child];
            for (std::size_t i = 0; i < kBranches; ++i) {
                low  = glm::min(low, vec2(below.low_x[i], below.low_y[i]));
                high = glm::max(high, vec2(below.high_x[i], below.high_y[i]));
            }
        }
        node.low_x[k]  = low.x;
        node.low_y[k]  = low.y;
        node.high_x[k] = high.x;
        node.high_y[k] = high.y;
    }

    enum class Cover : std::uint8_t { none, some, all };

    /// How the shadow covers a box, from the greatest and least value of each side over it. Rounding is far below the
    /// float steps that boxes were grown by, but where sides are that close the answer is `some`.
    static Cover cover(const std::array<Side, 3>& sides, const Node& node, std::size_t k) {
        const double x  = 0.5 * (static_cast<double>(node.low_x[k]) + static_cast<double>(node.high_x[k]));
        const double y  = 0.5 * (static_cast<double>(node.low_y[k]) + static_cast<double>(node.high_y[k]));
        const double rx = static_cast<double>(node.high_x[k]) - x, ry = static_cast<double>(node.high_y[k]) - y;
        bool all = true;
        for (const Side& s : sides) {
            const double middle = s.at(x, y);
            const double reach  = std::abs(s.a) * rx + std::abs(s.b) * ry;
            const double doubt  = 1e-14 * (std::abs(s.a * x) + std::abs(s.b * y) + std::abs(s.c));
            if (middle + reach < -doubt) return Cover::none;
            all = all && middle - reach > doubt;
        }
        return all ? Cover::all : Cover::some;
    }

    /// Returns whether the whole node is dark now.
    bool darken(std::size_t level, std::size_t n, const Shadow& shadow, const std::array<Side, 3>& sides) {
        Node& node = levels_[level][n];
        const std::atomic_ref<std::uint8_t> dark(node.dark);
        std::uint32_t hit = 0;
        for (std::uint32_t k = 0; k < kBranches; ++k)
            hit |= static_cast<std::uint32_t>((node.low_x[k] <= shadow.high.x) & (node.high_x[k] >= shadow.low.x) &
                                              (node.low_y[k] <= shadow.high.y) & (node.high_y[k] >= shadow.low.y))
                   << k;
        hit &= ~static_cast<std::uint32_t>(dark.load(std::memory_order_relaxed));
        const vec2 size = shadow.high - shadow.low;
        for (; hit != 0; hit &= hit - 1) {
            const auto k  = static_cast<std::size_t>(std::countr_zero(hit));
            Cover covered = Cover::some;
            if (node.high_x[k] - node.low_x[k] < size.x || node.high_y[k] - node.low_y[k] < size.y)
                covered = cover(sides, node, k);
            if (covered == Cover::none) continue;
            const std::size_t child = n * kBranches + k;
            bool all                = covered == Cover::all;
            if (all)
                fill(level, child);
            else
                all = level == 0 ? darken_leaf(child, sides) : darken(level - 1, child, shadow, sides);
            if (all) dark.fetch_or(static_cast<std::uint8_t>(1u << k), std::memory_order_relaxed);
        }
        return dark.load(std::memory_order_relaxed) == 0xff;
    }

    bool darken_leaf(std::size_t leaf, const std::array<Side, 3>& sides) {
        const double* const x = x_.data() + leaf * kLeaf;
        const double* const y = y_.data() + leaf * kLeaf;
        double least[kLeaf];
        for (std::size_t i = 0; i < kLeaf; ++i)
            least[i] = std::min({sides[0].at(x[i], y[i]), sides[1].at(x[i], y[i]), sides[2].at(x[i], y[i])});
        bool all = true;
        for (std::size_t i = 0; i < std::min(kLeaf, points_.size() - leaf * kLeaf); ++i) {
            const std::atomic_ref<std::uint8_t> dark(dark_[leaf * kLeaf + i]);
            if (least[i] >= 0)
                dark.store(1, std::memory_order_relaxed);
            else
                all = all && dark.load(std::memory_order_relaxed) != 0;
        }
        return all;
    }

    /// All points under child `child` of `level` become dark.
    void fill(std::size_t level, std::size_t child) {
        std::size_t width = kLeaf;
        for (std::size_t l = 0; l < level; ++l) width *= kBranches;
        for (std::size_t i = child * width; i < std::min(points_.size(), (child + 1) * width); ++i)
            std::atomic_ref<std::uint8_t>(dark_[i]).store(1, std::memory_order_relaxed);
    }

    std::vector<std::uint32_t> points_;
    std::vector<double> x_, y_;
    std::vector<std::uint8_t> dark_;
    std::vector<std::vector<Node>> levels_;  ///< lowest first
};

/// The three sides of a shadow, positive inside.
std::array<Side, 3> sides_of(const Scene& scene, const Receiver& receiver, int side, const LocalSource& source,
                             const Chunk& chunk, const Shadow& shadow) {
    Triangle x;
    if (shadow.piece)
        x = chunk.pieces[shadow.triangle];
    else
        for (int k = 0; k < 3; ++k)
            x[static_cast<std::size_t>(k)] = turned(receiver.local(dvec3(scene.vertex(shadow.triangle, k))), side);
    // Inside, det(a - source, b - a, p - a) has the sign of the triangle seen from behind.
    const double sign = shadow.turned ? 1 : -1;
    return {side_of_edge(source, x[0], x[1], sign), side_of_edge(source, x[1], x[2], sign),
            side_of_edge(source, x[2], x[0], sign)};
}

/// Holds all shadows against the points.
void darken(PointTree& tree, const Scene& scene, const Receiver& receiver, int side, const Source& from,
            const std::vector<Chunk>& chunks) {
    const LocalSource source = local_source(receiver, side, from);
    parallel_ranges(chunks.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t c = first; c < last; ++c)
            for (const Shadow& shadow : chunks[c].shadows)
                tree.darken(shadow, sides_of(scene, receiver, side, source, chunks[c], shadow));
    });
}

/// The first triangle whose shadow holds the place, kNoTriangle where none does.
TriangleId first_over(const Scene& scene, const Receiver& receiver, int side, const LocalSource& source,
                      const std::vector<Chunk>& chunks, dvec2 at) {
    const vec2 place(at);
    const auto in_box = [&](const Shadow& s) {
        return place.x >= s.low.x && place.x <= s.high.x && place.y >= s.low.y && place.y <= s.high.y;
    };
    for (const Chunk& chunk : chunks)
        for (const Shadow& shadow : chunk.shadows) {
            if (!in_box(shadow)) continue;
            const std::array<Side, 3> sides = sides_of(scene, receiver, side, source, chunk, shadow);
            if (std::ranges::all_of(sides, [&](const Side& e) { return e.at(at.x, at.y) >= 0; }))
                return chunk.caster(shadow);
        }
    return kNoTriangle;
}

/// Points of the light, of equal weight. A sphere is seen as a disk from everywhere: points of the ball with density
/// 1 / sqrt(1 - r^2) fill that disk evenly in every direction, and they are what points spread evenly over the unit
/// sphere of four dimensions are, less their fourth coordinate.
std::vector<Source> sources_of(const Light& light, int samples) {
    if (light.kind == LightKind::directional) return {{true, -light.direction}};
    if (!is_area(light.kind)) return {{false, light.position}};

    std::vector<Source> sources;
    const dvec3 n      = glm::normalize(dvec3(light.direction));
    const dvec3 helper = std::abs(n.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    const dvec3 e1 = glm::normalize(glm::cross(helper, n)), e2 = glm::cross(n, e1);
    const SampleSet set(Sampler::sobol, samples, 0);
    for (int first = 0; first < samples; first += 8) {
        Samples8 eight;
        set.eight(set.key(0), first, eight);
        if (light.kind == LightKind::disk) map_to_disk(eight);
        for (int i = 0; i < std::min(8, samples - first); ++i) {
            const double x = static_cast<double>(eight.x[i]), y = static_cast<double>(eight.y[i]);
            dvec3 offset{0};
            if (light.kind == LightKind::rectangle)
                offset = (x - 0.5) * dvec3(light.edge_u) + (y - 0.5) * dvec3(light.edge_v);
            else if (light.kind == LightKind::disk)
                offset = static_cast<double>(light.radius) * (x * e1 + y * e2);
            else {
                const double angle = 2 * kPi * ((first + i + 0.5) / samples), r = std::sqrt(x), q = std::sqrt(1 - x);
                offset = static_cast<double>(light.radius) *
                         dvec3(r * std::cos(2 * kPi * y), r * std::sin(2 * kPi * y), q * std::cos(angle));
            }
            sources.push_back({false, vec3(dvec3(light.position) + offset)});
        }
    }
    return sources;
}

class PlanarProjection final : public MethodWith<Options> {
public:
    Service serves(const SceneFacts& facts) const override {
        double area = 0, served = 0;
        std::size_t planes = 0;
        bool flat          = true;
        for (const ObjectFacts& object : facts.objects) area += object.area;
        for (const PlanarReceiver& plane : facts.planes)
            if (is_receiver(plane, area)) {
                ++planes;
                served += plane.area;
                flat = flat && is_flat(plane, facts.box);
            }
        if (planes == 0)
            return {How::not_at_all,
                    fmt::format("the scene has no planar receiver: no plane holds {:.3g} % of its area",
                                100 * options.plane_share)};
        const std::string where =
            fmt::format("on {} plane{}, which hold{} {:.3g} % of the scene's area; points elsewhere stay undefined",
                        planes, planes == 1 ? "" : "s", planes == 1 ? "s" : "", 100 * served / area);
        // Triangles that are a plane up to rounding may shade one another where the light grazes them, and are merged
        // with others that only look like it where rounding is coarse.
        if (facts.hard_lights_only && !flat)
            return {How::approximately,
                    fmt::format("some planes are flat up to the rounding of floats only; {}", where)};
        if (facts.hard_lights_only) return {How::to_rounding, where};
        return {How::approximately,
                fmt::format("lights with an area are taken at {} points; {}", options.light_samples, where)};
    }

    void build(const Scene& scene, const SceneFacts& facts) override {
        scene_ = &scene;
        receivers_.clear();
        chunks_.clear();
        plane_of_.assign(scene.triangles.size(), kNoPlane);
        double area = 0;
        for (const ObjectFacts& object : facts.objects) area += object.area;
        for (const PlanarReceiver& plane : facts.planes) {
            if (!is_receiver(plane, area)) continue;
            for (const TriangleId t : plane.triangles) plane_of_[t] = static_cast<std::uint32_t>(receivers_.size());
            receivers_.push_back(make_receiver(scene, plane));
        }
        occluders_.clear();
        for (TriangleId t = 0; t < scene.triangles.size(); ++t)
            if (!is_degenerate(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2))) occluders_.push_back(t);
    }

    void aim(LightId light) override {
        sources_ = sources_of(scene_->lights[light], options.light_samples);
        centre_  = scene_->lights[light].kind == LightKind::directional ? sources_[0]
                                                                        : Source{false, scene_->lights[light].position};
        chunks_.clear();
        if (sources_.size() > 1) return;  // an area light's shadows are many times what a scene holds: made when used
        for (std::uint32_t r = 0; r < receivers_.size(); ++r)
            for (const int side : {1, -1})
                chunks_.push_back(project(*scene_, occluders_, plane_of_, r, receivers_[r], side, sources_[0]));
    }

    void visibility(const PointBatch& points, LightId light, Visibility out) const override {
        for (std::size_t i = 0; i < points.size(); ++i)
            if (points.asks(light, i)) out.answer[i] = Answer::undefined;
        for_each_group(points, light, [&](std::uint32_t group, const std::vector<std::uint32_t>& members) {
            shade_group(points, group, members, out);
        });
    }

    void blame(const PointBatch& points, LightId light, std::span<TriangleId> who) const override {
        std::fill(who.begin(), who.end(), kNoTriangle);
        for_each_group(points, light, [&](std::uint32_t group, const std::vector<std::uint32_t>& members) {
            blame_group(points, group, members, who);
        });
    }

    std::size_t memory_bytes() const override {
        std::size_t bytes = receivers_.size() * sizeof(Receiver) + plane_of_.size() * sizeof(plane_of_[0]) +
                            occluders_.size() * sizeof(TriangleId) + sources_.size() * sizeof(Source);
        for (const std::vector<Chunk>& group : chunks_)
            for (const Chunk& chunk : group)
                bytes += sizeof(Chunk) + chunk.shadows.size() * sizeof(Shadow) +
                         chunk.pieces.size() * (sizeof(Triangle) + sizeof(TriangleId));
        return bytes;
    }

private:
    static constexpr std::uint32_t kNoPlane = 0xffffffffu;

    bool is_receiver(const PlanarReceiver& plane, double scene_area) const {
        return plane.area >= options.plane_share * scene_area;
    }

    /// All its corners lie in it but for the arithmetic that found it, in double.
    static bool is_flat(const PlanarReceiver& plane, const Box& box) {
        const vec3 reach = glm::max(glm::abs(box.min), glm::abs(box.max));
        return plane.tolerance <= 64 * 0x1p-53 * double(reach.x + reach.y + reach.z);
    }

    /// Calls body(group, points) for the points that face the light, by receiver and side.
    template <class Body>
    void for_each_group(const PointBatch& points, LightId light, const Body& body) const {
        std::vector<std::vector<std::uint32_t>> groups(2 * receivers_.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!points.asks(light, i)) continue;
            const std::uint32_t plane = plane_of_[points.triangle[i]];
            if (plane == kNoPlane) continue;
            const bool below = glm::dot(dvec3(points.normal(i)), receivers_[plane].normal) < 0;
            groups[2 * plane + below].push_back(static_cast<std::uint32_t>(i));
        }
        for (std::uint32_t g = 0; g < groups.size(); ++g)
            if (!groups[g].empty()) body(g, groups[g]);
    }

    /// Holds every shadow against every point, since few are asked for: the first that covers one is named.
    void blame_group(const PointBatch& points, std::uint32_t group, const std::vector<std::uint32_t>& members,
                     std::span<TriangleId> who) const {
        const std::uint32_t plane   = group / 2;
        const int side              = group % 2 == 0 ? 1 : -1;
        const Receiver& receiver    = receivers_[plane];
        const std::vector<dvec2> at = places(points, members, receiver, side);
        for (const Source& from : sources_) {
            const LocalSource source = local_source(receiver, side, from);
            if (!(source.at.z > 0)) continue;
            const std::vector<Chunk> chunks = project(*scene_, occluders_, plane_of_, plane, receiver, side, from);
            parallel_ranges(members.size(), 16, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    if (who[members[i]] == kNoTriangle)
                        who[members[i]] = first_over(*scene_, receiver, side, source, chunks, at[i]);
            });
        }
    }

    /// The points of one side of one receiver: as many passes as the light has sources.
    void shade_group(const PointBatch& points, std::uint32_t group, const std::vector<std::uint32_t>& members,
                     Visibility out) const {
        const std::uint32_t plane = group / 2;
        const int side            = group % 2 == 0 ? 1 : -1;
        const Receiver& receiver  = receivers_[plane];

        // A light that the point's own triangle faces, but that does not stand over the plane to which the triangle
        // belongs up to rounding, leaves nothing to project.
        if (std::none_of(sources_.begin(), sources_.end(),
                         [&](const Source& from) { return local_source(receiver, side, from).at.z > 0; }))
            return;

        PointTree tree(members, places(points, members, receiver, side));
        std::vector<std::uint32_t> lit(members.size(), 0);
        for (const Source& from : sources_) {
            if (!(local_source(receiver, side, from).at.z > 0)) continue;  // this part of the light is not seen
            if (sources_.size() > 1) {
                tree.brighten();
                darken(tree, *scene_, receiver, side, from,
                       project(*scene_, occluders_, plane_of_, plane, receiver, side, from));
            } else {
                darken(tree, *scene_, receiver, side, from, chunks_[group]);
            }
            for (std::size_t i = 0; i < lit.size(); ++i) lit[i] += !tree.is_dark(i);
        }
        for (std::size_t i = 0; i < lit.size(); ++i) {
            out.s[tree.points()[i]]      = static_cast<float>(lit[i]) / static_cast<float>(sources_.size());
            out.answer[tree.points()[i]] = Answer::given;
        }
    }

    /// Where the points lie in the plane. A point that is off it by its triangle's rounding is moved along its own ray
    /// to the light's centre, which leaves unchanged what that ray meets.
    std::vector<dvec2> places(const PointBatch& points, const std::vector<std::uint32_t>& members,
                              const Receiver& receiver, int side) const {
        const LocalSource source = local_source(receiver, side, centre_);
        std::vector<dvec2> at(members.size());
        parallel_ranges(members.size(), 16384, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t p = members[i];
                const TriangleId t    = points.triangle[p];
                const dvec3 a(scene_->vertex(t, 0)), b(scene_->vertex(t, 1)), c(scene_->vertex(t, 2));
                const dvec3 x      = turned(receiver.local(a + static_cast<double>(points.u[p]) * (b - a) +
                                                           static_cast<double>(points.v[p]) * (c - a)),
                                            side);
                const bool aligned = source.at_infinity || source.at.z > std::abs(x.z);
                at[i]              = aligned ? source.project(x) : dvec2(x);
            }
        });
        return at;
    }

    const Scene* scene_ = nullptr;
    std::vector<Receiver> receivers_;
    std::vector<std::uint32_t> plane_of_;  ///< of each triangle: its receiver, or kNoPlane
    std::vector<TriangleId> occluders_;    ///< triangles with an area
    std::vector<Source> sources_;
    Source centre_;
    std::vector<std::vector<Chunk>> chunks_;  ///< a hard light's shadows, by receiver and side
};

}  // namespace

extern const MethodInfo planar_projection;
const MethodInfo planar_projection{
    .name  = "planar_projection",
    .title = "Planar projection",
    .paper = "James Blinn, Me and My (Fake) Shadow, 1988",
    .summary =
        "Projects all occluders from the light onto each plane of the scene and tests the plane's points against "
        "their outlines. Exact on planes for lights without an area; says nothing about curved receivers. Limit: more "
        "than a million "
        "scene sizes from the origin float coordinates merge faces into planes that are none.",
    .parameters = kParameters,
    .presets    = {{"textbook", "light_samples=16", "Sixteen points of an area light."},
                   {"fast", "light_samples=16", "Sixteen points of an area light."},
                   {"best", "light_samples=1024", "1024 points of an area light."}},
    .create     = create<PlanarProjection>,
};

}  // namespace umbra
