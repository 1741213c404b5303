// Exact visibility of hard lights: the segment from the exact surface point to the light against triangles.
#pragma once

#include "umbra/core/scene/lights.h"
#include "umbra/shadows/geometry/box_tree.h"
#include "umbra/shadows/geometry/exact_point.h"

namespace umbra::exact_visibility {

/// The segment from a named surface point to a hard light. The end is a position, or a direction at infinity.
class Segment {
public:
    Segment(const ExactPoint& start, const Light& light);

    [[nodiscard]] BoxTree::Piece piece() const;
    [[nodiscard]] const ExactPoint& start() const { return start_; }
    /// From the start to the end; of a direction at infinity any length of it.
    [[nodiscard]] Rational3 direction() const { return infinite_ ? rational(end_) : rational(end_) - start_.exact(); }

    /// `crosses`: passes through the inside of the triangle, from one of its sides to the other. `touches`: meets an
    /// edge or a corner, lies in the triangle's plane, or begins on the triangle; whether the touched triangles block
    /// together is for Contacts to say. Triangles in or behind the plane of the surface point's own, and those that are
    /// met in the light alone, do not count: no movement of the point in that plane makes the segment cross them.
    enum class Meeting : std::uint8_t { none, touches, crosses };
    /// With a triangle that has an area. The light is in front of the surface point.
    [[nodiscard]] Meeting meeting(vec3 x, vec3 y, vec3 z) const;
    [[nodiscard]] Meeting meeting(const Scene& scene, TriangleId t) const {
        return meeting(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
    }

private:
    [[nodiscard]] int end_side(vec3 x, vec3 y, vec3 z) const;
    [[nodiscard]] Filtered<int> quick_edge_side(vec3 x, vec3 y) const;
    [[nodiscard]] int edge_side(vec3 x, vec3 y) const;
    [[nodiscard]] bool rises(vec3 x, vec3 y, vec3 z) const;
    [[nodiscard]] Meeting meeting_from_plane(vec3 x, vec3 y, vec3 z, bool ends_in_plane) const;

    const ExactPoint& start_;
    bool infinite_;
    vec3 end_;
    Entries to_;
};

/// Calls visit(t, meeting) for the scene's triangles with takes(t) that the segment crosses or touches, until it
/// returns false. `tree`: of the boxes of all triangles.
template <class Takes, class Visit>
void visit_met(const BoxTree& tree, const Scene& scene, const Segment& segment, const Takes& takes,
               const Visit& visit) {
    tree.visit(segment.piece(), [&](TriangleId t) {
        if (!takes(t)) return true;
        const Segment::Meeting met = segment.meeting(scene, t);
        return met == Segment::Meeting::none || visit(t, met);
    });
}

}  // namespace umbra::exact_visibility
