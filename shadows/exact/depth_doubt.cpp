#include "umbra/shadows/exact/depth_doubt.h"

#include <cmath>

#include "umbra/core/base/math.h"

namespace umbra::exact_detail {
namespace {

constexpr double kAround = 1.1;  ///< radii of a disk that holds the light with all rounding of its rim

/// With d = q - p of the plane's points q and n its normal, the plane is met in the direction of the light's point
/// (x, y) at 1/W(x, y) = n . (r + x u + y v) / n . d, where r leads to the light's centre. 1/W - 1 is f + x gx + y gy.
struct DepthOfPlane {
    double f = 0, slope = 0;
    double error = 0;  ///< of 1/W on the light
};

std::optional<DepthOfPlane> depth_of(const Entries (&d)[3], const Entries& r, dvec3 u, dvec3 v) {
    const dvec3 along = d[1].value - d[0].value, beside = d[2].value - d[0].value, n = glm::cross(along, beside);
    const double off   = std::max({d[0].error, d[1].error, d[2].error, r.error});
    const double reach = std::max(largest(r.value), largest(d[0].value)) + largest(u) + largest(v);
    const double P = largest(along), Q = largest(beside);
    // n is off by what its factors are, and by their products' roundings; the heights are sums of three products.
    const double error  = 100 * ((P + Q) * (off + kUnit * (P + Q)) * reach + P * Q * (off + kUnit * reach));
    const double bottom = glm::dot(n, d[0].value);
    if (!(std::abs(bottom) > 4 * error)) return std::nullopt;
    return DepthOfPlane{glm::dot(n, r.value - d[0].value) / bottom,
                        std::hypot(glm::dot(n, u), glm::dot(n, v)) / std::abs(bottom), 4 * error / std::abs(bottom)};
}

/// The light's disk as p sees it.
struct Disk {
    explicit Disk(const Sight& sight) : p(sight.viewpoint.point()), to_centre(p.to(sight.plane.centre_from_corner)) {
        squared  = glm::dot(to_centre.value, to_centre.value);
        distance = std::sqrt(squared);
        doubt    = 2 * sight.plane.rounding * glm::length(sight.plane.u) / distance + 16 * kUnit;
    }

    enum class Place : std::uint8_t { before, in_doubt, beyond };
    /// Of a point at d from p.
    [[nodiscard]] Place place(const Entries& d) const {
        const double w   = glm::dot(d.value, to_centre.value) / squared;
        const double off = 2 * doubt + 4 * (d.error + (std::abs(w) + 1) * to_centre.error) / distance +
                           16 * kUnit * largest(d.value) / distance;
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
        if (disk.place(disk.p.to(sight.occluders.scene->vertex(t, k))) != Disk::Place::before) return false;
    return true;
}

double area_in_doubt(const Sight& sight) {
    if (sight.plane.exact_axes) return 0;
    const Disk disk(sight);
    double area = 0;
    for (const TriangleId t : sight.light.across()) {
        if (t == sight.viewpoint.own()) continue;
        Entries d[3];
        bool all_before = true, all_beyond = true;
        for (int k = 0; k < 3; ++k) {
            d[k]                    = disk.p.to(sight.occluders.scene->vertex(t, k));
            const Disk::Place place = disk.place(d[k]);
            all_before              = all_before && place == Disk::Place::before;
            all_beyond              = all_beyond && place == Disk::Place::beyond;
        }
        if (all_before || all_beyond || sight.viewpoint.side_of(t) == 0) continue;
        constexpr double kWhole = kPi * kAround * kAround;
        const auto depth        = depth_of(d, disk.to_centre, sight.plane.u, sight.plane.v);
        if (!depth || !(disk.doubt < 0.1)) return kWhole;
        const double half = 1.2 * disk.doubt + depth->error;  // |W - 1| <= doubt, in terms of 1/W
        if (std::abs(depth->f) - kAround * depth->slope > half) continue;
        const double strip = depth->slope > 0 ? 2 * kAround * 2 * half / depth->slope : kWhole;
        area += std::min(strip, kWhole);
    }
    return std::min(area, kPi * kAround * kAround);
}

}  // namespace umbra::exact_detail
