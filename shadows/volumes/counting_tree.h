// Surface points seen from one position, sorted into a tree so that all points within a cone of half-spaces can be
// counted at once: what a stencil buffer does for pixels, for points anywhere between them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/raw_vector.h"
#include "umbra/core/render/points.h"

namespace umbra {

/// Where points are looked at from: an origin and an orthonormal, right-handed frame, x right, y down, z forward.
struct ViewFrame {
    dvec3 origin{0};
    dvec3 right{1, 0, 0}, down{0, 1, 0}, forward{0, 0, 1};

    [[nodiscard]] dvec3 turned(dvec3 v) const { return {glm::dot(right, v), glm::dot(down, v), glm::dot(forward, v)}; }
    [[nodiscard]] dvec3 seen(dvec3 p) const { return turned(p - origin); }
};

/// f(x, y, w) = (nx x + ny y) + (nz + nw w) + tie, for a point at (X, Y, Z) seen from the view: x = X/Z, y = Y/Z, w =
/// 1/Z. So (n, nw) is the plane n.(X, Y, Z) + nw = 0, and f has the sign of its side. The point is within where f > 0.
/// `tie` decides for points that give exactly 0, in the same way for all that share the plane, either way round.
struct HalfSpace {
    double nx = 0, ny = 0, nz = 0, nw = 0, tie = 0;

    /// The side of the plane where `sense` is +1, or the other where it is -1; together they hold every point once.
    static HalfSpace side(dvec3 n, double nw, int sense) {
        const double s = sense;
        return {s * n.x, s * n.y, s * n.z, s * nw, s * std::numeric_limits<double>::min()};
    }
};

/// A part of space: what lies within all its half-spaces. They may be culled by the box in (x, y, w), which must hold
/// all of the part.
struct Region {
    static constexpr int kMaxFaces = 5;
    std::array<HalfSpace, kMaxFaces> faces;
    int count = 0;
    dvec3 box_min{-std::numeric_limits<double>::infinity()};
    dvec3 box_max{+std::numeric_limits<double>::infinity()};

    void add(const HalfSpace& h) { faces[static_cast<std::size_t>(count++)] = h; }
};

/// The points of a batch that need an answer for one light, in a tree over (x, y, w).
class CountingTree {
public:
    /// Takes the points whose facing to the light is `front` or `partly`. All lie in front of the view.
    CountingTree(const Scene& scene, const PointBatch& points, LightId light);

    [[nodiscard]] const ViewFrame& view() const { return view_; }
    [[nodiscard]] std::size_t size() const { return index_.size(); }

    /// Adds `weight` to every point within the region. From any number of threads at once; sums of integers are the
    /// same in any order.
    void add(const Region& region, std::int32_t weight);

    /// Calls visit(point of the batch, sum of the weights of the regions that it lies in), in parallel. Once, at the
    /// end.
    template <class Visit>
    void for_each(const Visit& visit);

private:
    static constexpr std::size_t kLeaf   = 16;  // points in a leaf
    static constexpr std::size_t kFanOut = 4;   // children of a node
    /// Four nodes that have one parent; each at its place in every array. Nodes beyond `size` hold nothing.
    struct alignas(32) Siblings {
        double min[3][kFanOut], max[3][kFanOut];  // boxes of (x, y, w)
        std::int32_t count[kFanOut];
        std::uint32_t size = 0;
    };
    using Level = std::vector<Siblings>;

    void project(const Scene& scene, const PointBatch& points);
    void build_nodes();
    void descend(const Region& region, std::int32_t weight, std::size_t level, std::size_t parent, unsigned open);
    void add_to_leaf(const Region& region, std::int32_t weight, std::size_t leaf, unsigned open);
    void push_down();
    static unsigned within(const Siblings& nodes, const Region& region);
    static bool are_large(const Siblings& nodes, const Region& region, unsigned which);
    static unsigned cover(const HalfSpace& f, const Siblings& nodes);
    static unsigned cover(const HalfSpace& f, const double* low_x, const double* high_x, const double* low_y,
                          const double* high_y, const double* low_w, const double* high_w);

    ViewFrame view_;
    RawVector<std::uint32_t> index_;   // point of the batch
    RawVector<double> x_, y_, w_;      // padded to whole leaves
    std::vector<std::int32_t> count_;  // padded to whole leaves
    std::vector<Level> levels_;        // leaves first; the children of node i are those at i, one level below
};

/// The point as it is named, less `origin`, in double: but where it is closer to its triangle's border than 2^-44 of
/// the triangle's distance from `origin`, so much within (and no further than 2^-26 of the triangle). That is far above
/// the rounding of doubles there and far below that of floats; it keeps a point from lying on the planes through the
/// edges of its own triangle, where every triangle around would claim it.
[[nodiscard]] dvec3 named_point(const Scene& scene, const PointBatch& points, std::size_t i, dvec3 origin);

template <class Visit>
void CountingTree::for_each(const Visit& visit) {
    push_down();
    parallel_ranges(size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
            visit(index_[k], count_[k] + levels_[0][k / kLeaf / kFanOut].count[k / kLeaf % kFanOut]);
    });
}

}  // namespace umbra
