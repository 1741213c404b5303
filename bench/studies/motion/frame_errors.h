// Errors of one frame against the truth of that frame, which is computed from nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/core/errors/error_classes.h"

namespace umbra {

/// Over all lights. `points` are those compared; of the others that were asked for, `undefined` are left open by the
/// method and `on_boundary` are no error anywhere.
struct FrameErrors {
    std::uint64_t points = 0, undefined = 0;
    std::uint64_t wrong = 0;                 ///< |s - truth| above the tolerance of the kind of light, and not at the
                                             ///< terminator, as in umbra compare
    std::optional<std::uint64_t> interior;   ///< of them, outside the edge band; none where a light is sampled
    double rmse = kUnknown, max = kUnknown;  ///< NaN where no point is compared
};
DESCRIBE(FrameErrors) {
    of(MEMBER(points), "compared, all lights together");
    MEMBERS(undefined);
    of(MEMBER(wrong), "beyond the tolerance of the kind of light, not at the terminator");
    MEMBERS(interior);
    of(MEMBER(rmse), "of the points that the method answers; null where it answers none", kFraction);
    of(MEMBER(max), "", kFraction);
}

/// What a frame is compared with.
class FrameTruth {
public:
    /// The reference's answers for the scene as it is now, by an object that has seen no other frame. Lights without an
    /// area are answered at all points, those with an area at `area_points` stratified ones. Throws what the reference
    /// throws.
    FrameTruth(const Reference& reference, const Scene& scene, const SceneFacts& facts, const PointBatch& points,
               std::uint64_t area_points);

    /// `planes`: [light], of the same points.
    [[nodiscard]] FrameErrors errors(const std::vector<VisibilityPlane>& planes) const;

private:
    const Scene* scene_;
    const PointBatch* points_;
    bool sampled_ = false;                 ///< some light has an area
    std::vector<std::uint32_t> sample_;    ///< where lights with an area are compared
    std::vector<VisibilityPlane> planes_;  ///< [light]; of lights with an area one entry a sampled point
    std::vector<ClassPlane> terminator_;   ///< [light]: other than `right` at the terminator
};

}  // namespace umbra
