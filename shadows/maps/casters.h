// The triangles of a scene that can block a light, and where they lie.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// An interval of numbers, empty at first.
struct MinMax {
    double min = +std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();
    void add(double v) { min = std::min(min, v), max = std::max(max, v); }
    void add(const MinMax& r) { min = std::min(min, r.min), max = std::max(max, r.max); }
    [[nodiscard]] double centre() const { return 0.5 * (min + max); }
    [[nodiscard]] double half() const { return 0.5 * (max - min); }
};

/// The triangles that can cast a shadow, and where they lie: serves all lights. `scene` must outlive it.
///
/// Many scenes have floors and walls that reach far beyond all else, and a map fitted to those wastes its samples. Such
/// planes, seen from a light:
///   - Where the whole scene lies on the light's side of a plane, it blocks nothing: no segment between two points of a
///     closed half-space crosses its border. It is not drawn.
///   - A set of planes, each with the others on the light's side, blocks nothing of these planes. All else that they
///     or other triangles block lies where other triangles lie, or behind those: the map's window need only hold
///     triangles outside the set. Points outside of the window are lit.
class Casters {
public:
    /// Nothing is left out for any light, unless `leave_out`.
    Casters(const Scene& scene, const SceneFacts& facts, bool leave_out);

    [[nodiscard]] std::size_t memory_bytes() const {
        return planes_of_position_.size() * sizeof(std::uint64_t) + parts_.size() * sizeof(CasterRun);
    }

private:
    friend class SelectedCasters;
    static constexpr std::uint8_t kMaxPlanes = 63;  ///< as many may be left out; also says "in none of them"

    struct CasterPlane {
        dvec3 normal;
        double offset;
        double tolerance;            ///< how far corners that mean to lie in it, or to touch it, may miss it
        MinMax scene;                ///< distances of the whole scene
        std::vector<MinMax> others;  ///< distances of the other planes' triangles

        [[nodiscard]] bool has_on_side(const MinMax& distances, int side) const {
            return side > 0 ? distances.min >= -tolerance : distances.max <= tolerance;
        }
    };
    /// Consecutive triangles of one object that lie in one of planes_ together, or in none.
    struct CasterRun {
        TriangleId first;
        std::uint32_t count;
        std::uint8_t plane;
        Box box;

        [[nodiscard]] bool is_in(std::uint64_t planes) const { return (planes >> plane & 1) != 0; }
    };

    void find_planes(const SceneFacts& facts, std::vector<std::uint8_t>& plane_of_triangle);

    /// Where each plane has the others, and the scene.
    void find_sides();

    const Scene& scene_;
    std::vector<CasterPlane> planes_;
    std::vector<std::uint64_t> planes_of_position_;  ///< bit i: corner of a triangle in planes_[i]; kMaxPlanes: in none
    std::vector<CasterRun> parts_;
};

/// The casters as one light sees them, without what need not be drawn, or not be fitted to. `casters` must outlive it.
class SelectedCasters {
public:
    SelectedCasters(const Casters& casters, const Light& light);

    [[nodiscard]] const Scene& scene() const { return casters_.scene_; }
    [[nodiscard]] const Box& box() const { return box_; }  ///< of the fitted ones

    /// The interval of each of the n values that `values` gives for a position, over all fitted casters.
    template <std::size_t n, class Values>
    [[nodiscard]] std::array<MinMax, n> ranges(const Values& values) const {
        return ranges<n>(fitted_, values);
    }

    /// The least positive of the values that `value` gives for a position, over all that is drawn; infinite without
    /// one.
    template <class Value>
    [[nodiscard]] double least_drawn(const Value& value) const {
        return ranges<1>(drawn_,
                         [&](dvec3 p) {
                             const double v = value(p);
                             return std::array{v > 0 ? v : std::numeric_limits<double>::infinity()};
                         })[0]
            .min;
    }

    /// From p to the nearest point of a fitted caster.
    [[nodiscard]] double distance(dvec3 p) const;

    /// The triangles that are drawn, or `all` of the scene, without parts whose boxes lie wholly beyond one side of the
    /// view.
    [[nodiscard]] std::vector<std::span<const uvec3>> seen_by(const dmat4& clip_from_world, bool all = false) const;
    /// The drawn triangles that do not lie wholly beyond one side of the view, in any order: for a view of a few
    /// samples.
    [[nodiscard]] std::vector<std::span<const uvec3>> reaching(const dmat4& clip_from_world) const;

private:
    static constexpr std::size_t kGrain = 4096;

    /// Over the positions of `planes`, bits as in planes_of_position_.
    template <std::size_t n, class Values>
    [[nodiscard]] std::array<MinMax, n> ranges(std::uint64_t planes, const Values& values) const {
        const std::vector<vec3>& positions          = scene().positions;
        const std::vector<std::uint64_t>& planes_of = casters_.planes_of_position_;
        return reduce<n>(planes_of.size(), [&](std::size_t i, std::array<double, n>& v) {
            if ((planes_of[i] & planes) == 0) return false;
            v = values(dvec3(positions[i]));
            return true;
        });
    }

    /// Extents of the n values of i = begin .. end - 1 for which value_of(i, values) is true.
    template <std::size_t n, class ValueOf>
    UMBRA_FOR_EACH_PROCESSOR [[nodiscard]] static std::array<MinMax, n> reduce_some(std::size_t begin, std::size_t end,
                                                                                    const ValueOf& value_of) {
        // Limits apart, so that they become vector code.
        std::array<double, n> v, min, max;
        min.fill(MinMax().min);
        max.fill(MinMax().max);
        for (std::size_t i = begin; i < end; ++i) {
            if (!value_of(i, v)) continue;
            for (std::size_t k = 0; k < n; ++k) min[k] = std::min(min[k], v[k]);
            for (std::size_t k = 0; k < n; ++k) max[k] = std::max(max[k], v[k]);
        }
        std::array<MinMax, n> extents;
        for (std::size_t k = 0; k < n; ++k) extents[k] = {min[k], max[k]};
        return extents;
    }

    /// Extents of the n values of all i below `count` for which value_of(i, values) is true. Parallel.
    template <std::size_t n, class ValueOf>
    [[nodiscard]] static std::array<MinMax, n> reduce(std::size_t count, const ValueOf& value_of) {
        std::vector<std::array<MinMax, n>> partial((count + kGrain - 1) / kGrain);
        parallel_ranges(partial.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t block = begin; block < end; ++block)
                partial[block] = reduce_some<n>(block * kGrain, std::min((block + 1) * kGrain, count), value_of);
        });
        std::array<MinMax, n> all;
        for (const auto& p : partial)
            for (std::size_t k = 0; k < n; ++k) all[k].add(p[k]);
        return all;
    }

    const Casters& casters_;
    std::uint64_t drawn_ = ~std::uint64_t{0}, fitted_ = ~std::uint64_t{0};  ///< bits as in planes_of_position_
    Box box_;
};

}  // namespace umbra
