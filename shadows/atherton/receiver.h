// A triangle as a receiver: positions between it and one light, projected from the light onto its plane. Nothing is
// rounded: numbers are rationals. Lazy ones would have to compute most of these all the same, since an interval does not
// tell that two outlines meet in one point.
#pragma once

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <array>
#include <optional>
#include <utility>

#include "umbra/core/scene/scene.h"
#include "umbra/shadows/geometry/box_tree.h"

namespace umbra::atherton {

using Exact  = CGAL::Exact_predicates_exact_constructions_kernel::Exact_kernel::FT;
using Exact3 = std::array<Exact, 3>;

/// A position projected from the light onto the receiver's plane, in homogeneous coordinates: u / w and v / w are its
/// barycentric coordinates in the receiver. `height` is positive on the light's side of the plane.
/// A position is between the receiver and the light where u, v, w - u - v and height are >= 0; then w > 0, except in
/// the light itself.
struct Projected {
    Exact u, v, w, height;
};

/// A receiver and a hard light that does not lie in its plane. For one thread at a time.
class Receiver {
public:
    Receiver(const Scene& scene, TriangleId t, const Light& light);

    /// The light is on the side that the triangle's winding does not face: it sees the receiver mirrored.
    [[nodiscard]] bool mirrored() const { return mirrored_; }

    /// +1 above the receiver's plane, where the light is; 0 in it; -1 below. Exact.
    [[nodiscard]] int side(vec3 q) const;

    [[nodiscard]] Projected project(vec3 q) const;

    /// False only if no position on the segment from a to b is between the receiver and the light. In double.
    [[nodiscard]] bool may_cover(vec3 a, vec3 b) const;

    /// False only if the triangle of these corners meets no inner position of the receiver. corner[k]: which corner of
    /// the receiver the k-th one is, -1 where it is none. In double.
    [[nodiscard]] bool may_meet(const std::array<vec3, 3>& position, const std::array<int, 3>& corner) const;

    /// Where an edge passes the receiver's plane.
    struct Passage {
        vec3 above{0}, below{0};
        bool below_in_plane = false;  ///< `below` is where it passes
        int corner          = -1;     ///< which corner of the receiver that is, -1 if none
    };
    /// False only if no inner position of the receiver is between two passages. In double.
    [[nodiscard]] bool may_cut(const Passage& a, const Passage& b) const;

    /// The space between the receiver and the light, and the receiver itself.
    [[nodiscard]] BoxTree::Region towards_light() const;
    [[nodiscard]] BoxTree::Region itself() const;

private:
    /// dot(normal, q - from_) + offset, in double.
    struct Form {
        dvec3 normal{0};
        double offset = 0;
        double error  = 0;  ///< of each component of the normal
        double slip   = 0;  ///< of the offset
        /// At q - from_ = d, and how far off that may be.
        [[nodiscard]] std::pair<double, double> at(dvec3 d) const;
        /// At most this.
        [[nodiscard]] double most(dvec3 d) const {
            const auto [value, off] = at(d);
            return value + off;
        }
        [[nodiscard]] BoxTree::Region::Plane plane(double& tilt) const;
    };
    [[nodiscard]] BoxTree::Region region(const Form& last) const;
    [[nodiscard]] double most(const Form& border, int opposite, const Passage& passage) const;

    /// What u, v and w are computed from; once for a receiver, and not at all for the many that nothing is projected onto.
    struct ExactForms {
        Exact3 from, u, v, normal;
        Exact light_height;  ///< w where the light is a direction
    };
    [[nodiscard]] const ExactForms& exact_forms() const;

    vec3 a_, b_, c_, light_{0}, from_{0};  ///< light: a position or, where it is at infinity, the direction to it
    bool mirrored_ = false, infinite_ = false;
    Form u_, v_, rest_, height_;  ///< rest: w - u - v
    mutable std::optional<ExactForms> exact_{};
};

/// The part of the segment from a to b that is between the receiver and the light, without pieces that are on the
/// border of that space; none where it is empty or a point. With `in_plane`, both have height 0.
[[nodiscard]] std::optional<std::pair<Projected, Projected>> clip(const Projected& a, const Projected& b,
                                                                  bool in_plane);
/// a + t (b - a).
[[nodiscard]] Projected between(const Projected& a, const Projected& b, const Exact& t);

}  // namespace umbra::atherton
