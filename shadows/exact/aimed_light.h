// An area light among the occluders: what holds for every point that looks at it.
#pragma once

#include <vector>

#include "umbra/shadows/exact/light_plane.h"
#include "umbra/shadows/exact/occluders.h"

namespace umbra::exact_visibility {

class AimedLight {
public:
    AimedLight(const Light& light, const Occluders& occluders);

    [[nodiscard]] bool round() const { return light_.kind != LightKind::rectangle; }

    /// The light's plane as p sees it. Nothing where p is within a sphere light.
    [[nodiscard]] std::optional<LightPlane> plane_from(const ExactPoint& p) const;

    /// Sign of det(u, v, q - centre) for the welded vertex q, exact, with the axes in the light's own plane. Nothing
    /// for a sphere, whose plane moves.
    [[nodiscard]] std::optional<int> side_of_vertex(std::uint32_t vertex) const {
        if (side_.empty()) return std::nullopt;
        return side_[vertex];
    }

    /// The region between p and all that points about p see of the light, and of the square about it scaled by `reach`:
    /// points that may be off from p are seen to by its user. Nothing where p is too close for that.
    [[nodiscard]] std::optional<BoxTree::Region> region_from(const ExactPoint& p, double reach) const;

    /// The triangles that may pass through the light.
    [[nodiscard]] const std::vector<TriangleId>& across() const { return across_; }
    [[nodiscard]] std::size_t memory_bytes() const { return side_.size() + across_.size() * sizeof(TriangleId); }

private:
    [[nodiscard]] bool is_sphere() const { return light_.kind == LightKind::sphere; }
    [[nodiscard]] std::vector<std::int8_t> sides(const Occluders& occluders) const;
    [[nodiscard]] std::vector<TriangleId> those_across(const Occluders& occluders) const;
    [[nodiscard]] dvec3 reach() const;

    Light light_;
    DiskAxes half_;
    ExactAxes exact_half_;           ///< a sphere has none
    std::vector<std::int8_t> side_;  ///< one a welded vertex; a sphere has none
    std::vector<TriangleId> across_;
};

}  // namespace umbra::exact_visibility
