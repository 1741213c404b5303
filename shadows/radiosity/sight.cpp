#include "umbra/shadows/radiosity/sight.h"

#include <algorithm>
#include <array>

#include "umbra/core/render/light_points.h"

namespace umbra::patches {

namespace {

/// Until a ray has risen so far over its own plane, in the scene's size, it meets nothing: neighbours in that plane,
/// and rounded positions.
constexpr float kRise = 1e-6f;

constexpr float kBeforeTheLight = 1 - 0x1p-16f;

/// A ray of unit direction in ray space: Embree takes neither directions nor distances of any length.
struct Way {
    vec3 direction{0};
    float rise = 0, tnear = 0, tfar = 0;  ///< rise: of the direction over the point's plane; not above 0: no ray
};
Way way_to(const SurfacePoint& from, dvec3 to, bool infinite, float reach, const RaySpace& space) {
    const double length = glm::length(to);
    Way way;
    way.direction = vec3(to / length);
    way.rise      = glm::dot(vec3(from.normal), way.direction);
    way.tnear     = kRise / std::max(way.rise, 1e-20f);
    way.tfar      = infinite ? kInfinity
                             : static_cast<float>(
                              std::min(static_cast<double>(reach) * length * static_cast<double>(space.scale), 1e18));
    return way;
}

/// Targets on a light, up to eight at a time, with the irradiance that each one sends if it is seen.
template <class Visit>
void visit_targets(const SurfacePoint& from, const Light& light, int samples, const Visit& visit) {
    std::array<dvec3, 8> to{};
    std::array<double, 8> weight{};
    if (!is_area(light.kind)) {
        const bool infinite = light.kind == LightKind::directional;
        to[0]               = infinite ? -dvec3(light.direction) : dvec3(light.position) - from.position;
        weight[0]           = glm::dot(from.normal, to[0]) > 0 ? 1 : 0;
        visit(std::span<const dvec3>(to.data(), 1), weight, infinite);
        return;
    }
    for (int first = 0; first < samples; first += 8) {
        const auto count = static_cast<std::size_t>(std::min(8, samples - first));
        for (std::size_t k = 0; k < count; ++k) {
            to[k] = light_point(light, from.position, first + static_cast<int>(k)) - from.position;
            // The cosine at a flat light is the same height over the distance for all of its points; the disk that the
            // point sees of a sphere subtends what the sphere does.
            const double rise = glm::dot(from.normal, to[k]), square = glm::dot(to[k], to[k]);
            weight[k] = rise > 0 ? rise / (square * square) : 0;
        }
        if (!visit(std::span<const dvec3>(to.data(), count), weight, false)) return;
    }
}

}  // namespace

unsigned Sight::seen(const SurfacePoint& from, std::span<const dvec3> to, bool infinite, float reach) const {
    const FlushDenormals flush;
    const vec3 start = rays_.space().point(from.position);
    ShadowPacket packet;
    for (std::size_t k = 0; k < to.size(); ++k) {
        const Way way   = way_to(from, to[k], infinite, reach, rays_.space());
        packet.org_x[k] = start.x, packet.org_y[k] = start.y, packet.org_z[k] = start.z;
        packet.dir_x[k] = way.direction.x, packet.dir_y[k] = way.direction.y, packet.dir_z[k] = way.direction.z;
        packet.tnear[k] = way.tnear, packet.tfar[k] = way.tfar;
        packet.id[k]    = from.triangle;
        packet.valid[k] = way.rise > 0 ? -1 : 0;
    }
    rays_.occluded(packet);
    unsigned seen = 0;
    for (std::size_t k = 0; k < to.size(); ++k)
        if (packet.valid[k] != 0 && packet.tfar[k] >= 0) seen |= 1u << k;
    return seen;
}

TriangleId Sight::first_hit(const SurfacePoint& from, dvec3 to, bool infinite, float reach) const {
    const FlushDenormals flush;
    const vec3 start = rays_.space().point(from.position);
    const Way way    = way_to(from, to, infinite, reach, rays_.space());
    if (!(way.rise > 0)) return kNoTriangle;
    return rays_.first_hit({start.x, start.y, start.z, way.tnear, way.direction.x, way.direction.y, way.direction.z, 0,
                            way.tfar, ~0u, from.triangle, 0});
}

float light_share(const Sight& sight, const SurfacePoint& from, const Light& light, int samples) {
    double arrives = 0, all = 0;
    visit_targets(from, light, samples,
                  [&](std::span<const dvec3> to, const std::array<double, 8>& weight, bool infinite) {
                      const unsigned seen = sight.seen(from, to, infinite, kBeforeTheLight);
                      for (std::size_t k = 0; k < to.size(); ++k) {
                          all += weight[k];
                          if ((seen >> k & 1) != 0) arrives += weight[k];
                      }
                      return true;
                  });
    return all > 0 ? static_cast<float>(arrives / all) : 0;
}

TriangleId light_blocker(const Sight& sight, const SurfacePoint& from, const Light& light, int samples) {
    TriangleId blocker = kNoTriangle;
    visit_targets(from, light, samples, [&](std::span<const dvec3> to, const std::array<double, 8>&, bool infinite) {
        for (const dvec3 target : to)
            if (blocker == kNoTriangle) blocker = sight.first_hit(from, target, infinite, kBeforeTheLight);
        return blocker == kNoTriangle;
    });
    return blocker;
}

}  // namespace umbra::patches
