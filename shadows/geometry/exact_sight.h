// Whether surface points see a hard light, decided exactly one by one: for the few that floating point leaves open.
#pragma once

#include <mutex>
#include <optional>

#include "umbra/core/render/points.h"
#include "umbra/shadows/geometry/triangle_tree.h"

namespace umbra {

class ExactSight {
public:
    /// `scene` must outlive this object. Nothing is computed before the first question.
    explicit ExactSight(const Scene& scene) : scene_(scene) {}

    /// Whether no triangle but its own lies between point i, as it is named, and the light, which is taken as one point
    /// where it has an area. On the boundary of a shadow: whether lights close to this one are seen. False where the
    /// light is not in front of the point's plane. From any number of threads at once.
    [[nodiscard]] bool is_lit(const PointBatch& points, std::size_t i, const Light& light) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    const TriangleTree& tree() const;

    const Scene& scene_;
    mutable std::mutex mutex_;
    mutable std::optional<const TriangleTree> tree_;
};

}  // namespace umbra
