// Exact visibility of hard lights: the segment from the exact surface point to the light against triangles.
#pragma once

#include "umbra/core/scene/lights.h"
#include "umbra/shadows/exact/exact_point.h"
#include "umbra/shadows/shared/box_tree.h"

namespace umbra::exact_detail {

/// The segment from a named surface point to a hard light. The end is a position, or a direction at infinity.
class Segment {
public:
    Segment(const ExactPoint& start, const Light& light);

    [[nodiscard]] BoxTree::Piece piece() const;

    enum class Meeting : std::uint8_t { none, touches, crosses };
    /// With a triangle that has an area.
    [[nodiscard]] Meeting meeting(vec3 x, vec3 y, vec3 z) const;

private:
    [[nodiscard]] int end_side(vec3 x, vec3 y, vec3 z) const;
    [[nodiscard]] Filtered<int> quick_edge_side(vec3 x, vec3 y) const;
    [[nodiscard]] int edge_side(vec3 x, vec3 y) const;
    [[nodiscard]] Meeting meeting_in_plane(vec3 x, vec3 y, vec3 z) const;

    const ExactPoint& start_;
    bool infinite_;
    vec3 end_;
    Entries to_;
};

}  // namespace umbra::exact_detail
