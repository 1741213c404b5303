#include "umbra/shadows/cascades/receivers.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "umbra/core/base/parallel.h"
#include "umbra/shadows/geometry/clipped_polygon.h"

namespace umbra {

std::array<dvec4, 5> View::sides() const {
    const CameraFrame& f = frame_;
    const auto side      = [&](double half, dvec3 inwards) {
        return is_perspective() ? dvec4(half * f.forward + inwards, 0) : dvec4(inwards, half);
    };
    return {side(f.half_width, f.right), side(f.half_width, -f.right), side(f.half_height, f.up),
            side(f.half_height, -f.up), dvec4(f.forward, 0)};
}

std::array<dvec3, 8> View::corners(double from, double to) const {
    std::array<dvec3, 8> all;
    for (int i = 0; i < 8; ++i) {
        const double depth = i & 4 ? to : from;
        const dvec3 aside =
            (i & 1 ? 1 : -1) * frame_.half_width * frame_.right + (i & 2 ? 1 : -1) * frame_.half_height * frame_.up;
        all[i] = frame_.eye + depth * frame_.forward + (is_perspective() ? depth : 1) * aside;
    }
    return all;
}

View::Sphere View::sphere(double from, double to) const {
    const double wide = std::hypot(frame_.half_width, frame_.half_height);
    // As far from the nearer corners as from the farther ones; but where the view is wide, the farther ones alone bound
    // it, about their own centre.
    const double middle = is_perspective() ? std::min(to, 0.5 * (from + to) * (1 + wide * wide)) : 0.5 * (from + to);
    const double radius = std::hypot(to - middle, is_perspective() ? to * wide : wide);
    return {frame_.eye + middle * frame_.forward, radius};
}

namespace {

constexpr std::size_t kBlock = 4096;  // entries that are reduced by one task

/// add(i, partial) for all i below `count`, in parallel; merge(all, partial) in their order.
template <class T, class Add, class Merge>
T reduced(std::size_t count, const T& nothing, const Add& add, const Merge& merge) {
    const std::size_t blocks = (count + kBlock - 1) / kBlock;
    std::vector<T> partial(blocks, nothing);
    parallel_ranges(blocks, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block)
            for (std::size_t i = block * kBlock; i < std::min((block + 1) * kBlock, count); ++i) add(i, partial[block]);
    });
    T all = nothing;
    for (const T& p : partial) merge(all, p);
    return all;
}

void merge_extents(std::vector<LightExtents>& all, const std::vector<LightExtents>& more) {
    for (std::size_t s = 0; s < all.size(); ++s)
        for (std::size_t k = 0; k < all[s].size(); ++k) all[s][k].add(more[s][k]);
}

void add_point(LightExtents& to, const LightFrame& light, dvec3 p) {
    const dvec3 v = light.light_space(p);
    for (int k = 0; k < 3; ++k) to[k].add(v[k]);
}

double distance(const dvec4& plane, dvec3 v) { return glm::dot(dvec3(plane), v) + plane.w; }

/// A triangle cut by at most 11 planes: corners relative to the eye. Cuts do not depend on which corner comes first.
using ClippedTriangle = ClippedPolygon<dvec3, 16>;

void cut_by(ClippedTriangle& part, const dvec4& plane) {
    part.cut<CutFrom::inner>([&](dvec3 v) { return distance(plane, v); });
}

class SceneInView final : public Receivers {
public:
    SceneInView(const Scene& scene, const View& view, std::span<const dvec4> planes)
        : scene_(&scene), view_(view), corners_(scene.positions.size()) {
        const auto sides = view.sides();
        planes_.assign(sides.begin(), sides.end());
        planes_.insert(planes_.end(), planes.begin(), planes.end());
        forward_ = dvec3(sides.back());
        parallel_ranges(corners_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const dvec3 p(scene.positions[i]);
                corners_[i].depth = view_.depth(p);
                for (std::size_t k = 0; k < planes_.size(); ++k)
                    if (distance(planes_[k], p - view_.eye()) < 0) corners_[i].outside |= 1u << k;
            }
        });
    }

    [[nodiscard]] MinMax depths() const override {
        const auto merge = [](MinMax& all, const MinMax& more) { all.add(more); };
        MinMax all       = reduced(
                  corners_.size(), MinMax{},
                  [&](std::size_t i, MinMax& range) {
                if (corners_[i].outside == 0) range.add(corners_[i].depth);
            },
                  merge);
        all.add(reduced(
            scene_->triangles.size(), MinMax{},
            [&](std::size_t t, MinMax& range) {
                const Seen seen = see(t);
                if (seen.misses || seen.cut_by == 0) return;  // its corners are counted above
                const ClippedTriangle part = cut(t, seen);
                for (std::size_t i = 0; i < part.count; ++i) range.add(glm::dot(forward_, part.corners[i]));
            },
            merge));
        return all;
    }

    [[nodiscard]] std::vector<LightExtents> extents(std::span<const DepthSlice> slices,
                                                    const LightFrame& light) const override {
        const std::vector<LightExtents> nothing(slices.size());
        std::vector<LightExtents> all = reduced(
            corners_.size(), nothing,
            [&](std::size_t i, std::vector<LightExtents>& extents) {
                if (corners_[i].outside != 0) return;
                for (std::size_t s = 0; s < slices.size(); ++s)
                    if (corners_[i].depth >= slices[s].from && corners_[i].depth <= slices[s].to)
                        add_point(extents[s], light, dvec3(scene_->positions[i]));
            },
            merge_extents);
        merge_extents(all, reduced(
                               scene_->triangles.size(), nothing,
                               [&](std::size_t t, std::vector<LightExtents>& extents) {
                                   const Seen seen = see(t);
                                   if (seen.misses) return;
                                   for (std::size_t s = 0; s < slices.size(); ++s) {
                                       const auto [from, to] = slices[s];
                                       if (seen.depths.max < from || seen.depths.min > to) continue;
                                       if (seen.cut_by == 0 && seen.depths.min >= from && seen.depths.max <= to)
                                           continue;  // as above
                                       ClippedTriangle part = cut(t, seen);
                                       cut_by(part, {forward_, -from});
                                       cut_by(part, {-forward_, to});
                                       for (std::size_t i = 0; i < part.count; ++i)
                                           add_point(extents[s], light, view_.eye() + part.corners[i]);
                                   }
                               },
                               merge_extents));
        return all;
    }

private:
    struct Corner {
        double depth          = 0;
        std::uint32_t outside = 0;  ///< bit k: beyond planes_[k]
    };
    struct Seen {
        bool misses;           ///< all of it lies beyond one plane
        std::uint32_t cut_by;  ///< bit k: it crosses planes_[k]
        MinMax depths;
    };

    [[nodiscard]] Seen see(std::size_t t) const {
        Seen seen{true, 0, {}};
        std::uint32_t all = ~0u;
        for (int k = 0; k < 3; ++k) {
            const Corner& corner = corners_[scene_->triangles[t][k]];
            seen.cut_by |= corner.outside;
            all &= corner.outside;
            seen.depths.add(corner.depth);
        }
        seen.misses = all != 0;
        return seen;
    }

    [[nodiscard]] ClippedTriangle cut(std::size_t t, const Seen& seen) const {
        ClippedTriangle part;
        for (int k = 0; k < 3; ++k) part.add(dvec3(scene_->vertex(static_cast<TriangleId>(t), k)) - view_.eye());
        for (std::size_t k = 0; k < planes_.size(); ++k)
            if ((seen.cut_by >> k & 1) != 0) cut_by(part, planes_[k]);
        return part;
    }

    const Scene* scene_;
    View view_;
    std::vector<dvec4> planes_;
    dvec3 forward_{0};
    std::vector<Corner> corners_;  ///< [position]
};

class SeenPoints final : public Receivers {
public:
    SeenPoints(const Scene& scene, const PointBatch& points, LightId light, const View& view,
               std::span<const dvec4> planes)
        : scene_(&scene), points_(&points), view_(view), planes_(planes.begin(), planes.end()) {
        if (points.facing.empty()) {
            sides_.triangle = points.triangle;
            sides_.flipped  = points.flipped;
            face_light(sides_, scene, light);
        }
        facing_ = (points.facing.empty() ? sides_ : points).facing[light];
    }

    [[nodiscard]] MinMax depths() const override {
        return reduced(
            points_->size(), MinMax{},
            [&](std::size_t i, MinMax& range) {
                if (const auto p = at(i)) range.add(view_.depth(*p));
            },
            [](MinMax& all, const MinMax& more) { all.add(more); });
    }

    [[nodiscard]] std::vector<LightExtents> extents(std::span<const DepthSlice> slices,
                                                    const LightFrame& light) const override {
        return reduced(
            points_->size(), std::vector<LightExtents>(slices.size()),
            [&](std::size_t i, std::vector<LightExtents>& extents) {
                const auto p = at(i);
                if (!p) return;
                const double depth = view_.depth(*p);
                for (std::size_t s = 0; s < slices.size(); ++s)
                    if (depth >= slices[s].from && depth <= slices[s].to) add_point(extents[s], light, *p);
            },
            merge_extents);
    }

private:
    /// The point, where it counts.
    [[nodiscard]] std::optional<dvec3> at(std::size_t i) const {
        if (!is_asked(facing_[i])) return {};
        const dvec3 p = exact_position(*scene_, *points_, i);
        for (const dvec4& plane : planes_)
            if (distance(plane, p - view_.eye()) < 0) return {};
        return p;
    }

    const Scene* scene_;
    const PointBatch* points_;
    View view_;
    std::vector<dvec4> planes_;
    PointBatch sides_;  ///< what decides `facing` alone, where the batch has none
    std::span<const Facing> facing_;
};

}  // namespace

std::unique_ptr<Receivers> receivers_in_view(const Scene& scene, const View& view, std::span<const dvec4> planes) {
    return std::make_unique<SceneInView>(scene, view, planes);
}

std::unique_ptr<Receivers> receivers_of(const Scene& scene, const PointBatch& points, LightId light, const View& view,
                                        std::span<const dvec4> planes) {
    return std::make_unique<SeenPoints>(scene, points, light, view, planes);
}

}  // namespace umbra
