// An area light seen from one surface point, and the edges before it in the light's own plane.
//
// A point q is q - o = X u + Y v + W c: o the start of the point's rays, c from there to the light's centre, u, v its
// half axes. From o, q lies over the point (X/W, Y/W) of the light; the light is within |x|, |y| <= 1, and points
// before it have 0 < W < 1.
#pragma once

#include <optional>

#include "umbra/shadows/light_rays/light_rays.h"
#include "umbra/shadows/soft/occluder_edges.h"

namespace umbra::soft {

/// An edge over the light, cut off around it, its ends rounded to float: ends of edges that meet stay together.
struct FlatEdge {
    vec2 low{0}, high{0};   ///< low.y <= high.y
    int step      = 0;      ///< layers right of it less layers left of it, for a change of 1
    float doubt   = 0;      ///< a sample farther than this from the edge is on one side of it for sure
    bool is_there = false;  ///< false: no sample is right of any of it
    int entry     = 0;      ///< the same where it comes in from the left, above less below; 0: it does not
    float entry_y = 0;

    /// Whether some sample of such a light may be on another side of it than the others, or in doubt.
    [[nodiscard]] bool cuts(LightKind kind) const;
};

/// The light that a point sees, before any edge. For one thread.
class LightView {
public:
    /// `starts`, `lane`: the point, for which `seen` was made.
    LightView(const rays::Starts& starts, int lane, const rays::SeenLight& seen, const rays::Target& light);

    /// False where the point is so close to the light's plane that projection means nothing.
    [[nodiscard]] bool is_usable() const { return usable_; }
    /// Whether every sample is in front of the point's plane, so high that its ray starts before all that `flatten`
    /// accepts.
    [[nodiscard]] bool all_in_front() const { return all_in_front_; }
    /// Rays with a larger tnear start too far from the point for that.
    [[nodiscard]] float latest_start() const { return latest_start_; }

    /// Rays may start as far from the point as this, in ray space; nearer to it `flatten` accepts nothing.
    [[nodiscard]] double start_reach() const { return start_reach_; }

    /// Makes lane `lane` the shaft from the point to the square about the light at which edges are cut.
    void set_shaft(Shafts& shafts, std::size_t lane) const;

    /// Projects the edge and cuts it. Nothing where that must not be relied on: it comes too close to the point, or it
    /// is cut off before the light by the end of rays.
    [[nodiscard]] std::optional<FlatEdge> flatten(const LightEdge& edge) const;

    /// Whether rays to the light may end within the triangle.
    [[nodiscard]] bool may_end_within(vec3 a, vec3 b, vec3 c) const;

private:
    [[nodiscard]] dvec3 place(vec3 q) const {
        const dvec3 d = dvec3(q) - o_;
        return {glm::dot(gx_, d), glm::dot(gy_, d), glm::dot(gw_, d)};
    }

    dvec3 o_, u_, v_;
    dvec3 gx_{0}, gy_{0}, gw_{0};
    double start_       = 0;  ///< W that no ray starts before
    double nearest_     = 0;  ///< W below which rays may not have started
    double start_reach_ = 0;
    double span_        = 0;  ///< the longest ray
    double stretch_     = 0;  ///< of directions over the light's coordinates
    int orientation_    = 1;  ///< +1 where what turns left as o sees it does so in (x, y)
    float latest_start_ = 0;
    bool usable_ = false, all_in_front_ = false;
};

}  // namespace umbra::soft
