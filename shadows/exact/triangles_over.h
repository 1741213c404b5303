// The triangles that may lie over one place of the light, for many points that lie together: looked for once in the
// tree, and for each point in a list, several at a time.
#pragma once

#include <array>
#include <vector>

#include "umbra/core/base/lanes.h"
#include "umbra/shadows/exact/occluders.h"
#include "umbra/shadows/geometry/exact_point.h"

namespace umbra::exact_visibility {

class TrianglesOver {
public:
    /// For points at most `around` from p in every coordinate, whose place is at most that far from the one that p sees
    /// at p + `to_place`; `x` and `y` are what the light calls it. `occluders` must outlive what follows.
    void gather(const Occluders& occluders, const ExactPoint& p, dvec3 to_place, double x, double y, double around);
    void clear() { known_ = false; }

    /// All triangles that may lie over the place, for a point that sees it at p + `to_place`, both with an error of at
    /// most `off` in every coordinate; null for a place that was not gathered. Valid until the next call.
    [[nodiscard]] const std::vector<TriangleId>* pick(const ExactPoint& p, dvec3 to_place, double off, double x,
                                                      double y);

private:
    [[nodiscard]] bool find_out(dvec3 moved, dvec3 to_place, double off, double beside);

    bool known_ = false;
    dvec3 origin_{0}, place_{0};  ///< the latter from the former
    double x_ = 0, y_ = 0, around_ = 0;
    std::vector<TriangleId> triangles_, picked_;
    std::array<std::array<std::vector<float>, 3>, 3> corners_;  ///< of each corner, of each coordinate: from the origin
    std::vector<std::int32_t> out_;
};

}  // namespace umbra::exact_visibility
