#include "umbra/shadows/exact/depth_doubt.h"

#include <cmath>

#include "umbra/core/base/math.h"

namespace umbra::exact_visibility {
namespace {

constexpr double kAround = 1.1;  ///< radii of a disk that holds the light with all rounding of its rim

/// With d = q - p of the plane's points q and n its normal, the plane is met in the direction of the light's point
/// (x, y) at 1/W(x, y) = n . (r + x u + y v) / n . d, where r leads to the light's centre. 1/W - 1 is f + x gx + y gy.
struct DepthOfPlane {
    double f = 0, slope = 0;
    double error = 0;  ///< of 1/W on the light
};

/// `d` leads to the first corner, `along` and `beside` from there to the two others.
std::optional<DepthOfPlane> depth_of(const Entries& d, dvec3 along, dvec3 beside, const Entries& r, dvec3 u, dvec3 v) {
    const dvec3 n      = glm::cross(along, beside);
    const double reach = std::max(largest(r.value), largest(d.value)) + largest(u) + largest(v);
    // A component of n, a difference of two products of rounded sides, is off by 8 roundings; a height, a sum of three
    // products with it, by 24 for that, by 6 times what d and r are off, and by 12 for its own roundings.
    const double error  = 36 * largest(along) * largest(beside) * (d.error + r.error + kUnit * reach);
    const double bottom = glm::dot(n, d.value);
    if (!(std::abs(bottom) > 4 * error)) return std::nullopt;
    return DepthOfPlane{glm::dot(n, r.value - d.value) / bottom,
                        std::hypot(glm::dot(n, u), glm::dot(n, v)) / std::abs(bottom), 4 * error / std::abs(bottom)};
}

/// The light's disk as p sees it.
struct Disk {
    explicit Disk(const Sight& sight) : p(sight.viewpoint.point()), to_centre(p.to(sight.plane.centre_from_corner)) {
        squared  = glm::dot(to_centre.value, to_centre.value);
        distance = std::sqrt(squared);
        doubt    = sight.plane.depth_error / distance + 128 * kUnit;
    }

    enum class Place : std::uint8_t { before, in_doubt, beyond };
    /// The place of a point at d from p.
    [[nodiscard]] Place place(const Entries& d) const {
        const double w   = glm::dot(d.value, to_centre.value) / squared;
        const double off = 2 * doubt + 4 * (d.error + (std::abs(w) + 1) * to_centre.error) / distance +
                           128 * kUnit * largest(d.value) / distance;
        return w < 1 - off ? Place::before : w > 1 + off ? Place::beyond : Place::in_doubt;
    }

    const ExactPoint& p;
    Entries to_centre;
    double squared = 0, distance = 0;
    double doubt = 0;  ///< of W, in which the plane is at 1
};

}  // namespace

bool surely_before_light(const Sight& sight, TriangleId t) {
    if (sight.plane.exact_axes) return true;  // the count has seen to it, with the plane itself
    const Disk disk(sight);
    for (int k = 0; k < 3; ++k)
        if (disk.place(disk.p.to(sight.occluders.scene.vertex(t, k))) != Disk::Place::before) return false;
    return true;
}

double area_in_doubt(const Sight& sight) {
    if (sight.plane.exact_axes) return 0;
    const Disk disk(sight);
    double area = 0;
    for (const TriangleId t : sight.light.across()) {
        if (t == sight.viewpoint.own()) continue;
        Entries d[3];
        dvec3 corner[3];
        bool all_before = true, all_beyond = true;
        for (int k = 0; k < 3; ++k) {
            const vec3 position     = sight.occluders.scene.vertex(t, k);
            corner[k]               = dvec3(position);
            d[k]                    = disk.p.to(position);
            const Disk::Place place = disk.place(d[k]);
            all_before              = all_before && place == Disk::Place::before;
            all_beyond              = all_beyond && place == Disk::Place::beyond;
        }
        if (all_before || all_beyond || sight.viewpoint.side_of(t) == 0) continue;
        constexpr double kWhole = kPi * kAround * kAround;
        const auto depth =
            depth_of(d[0], corner[1] - corner[0], corner[2] - corner[0], disk.to_centre, sight.plane.u, sight.plane.v);
        if (!depth || !(disk.doubt < 0.1)) return kWhole;
        const double half = 1.2 * disk.doubt + depth->error;  // |W - 1| <= doubt, in terms of 1/W
        if (std::abs(depth->f) - kAround * depth->slope > half) continue;
        const double strip = depth->slope > 0 ? 2 * kAround * 2 * half / depth->slope : kWhole;
        area += std::min(strip, kWhole);
    }
    return std::min(area, kPi * kAround * kAround);
}

}  // namespace umbra::exact_visibility
