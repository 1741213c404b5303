#include "umbra/shadows/radiosity/sight.h"

#include <algorithm>
#include <array>

#include "umbra/shadows/shared/light_points.h"

namespace umbra::radiosity_detail {

namespace {

/// Until a ray has risen so far over its own plane, in the scene's size, it meets nothing: neighbours in that plane,
/// and rounded positions.
constexpr float kRise = 1e-6f;

constexpr float kBeforeTheLight = 1 - 0x1p-16f;

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
    const RaySpace& space = rays_.space();
    const vec3 start      = space.point(from.position);
    ShadowPacket packet;
    for (std::size_t k = 0; k < to.size(); ++k) {
        const vec3 d     = infinite ? vec3(glm::normalize(to[k])) : space.vector(to[k]);
        const float rise = glm::dot(vec3(from.normal), d);
        packet.org_x[k] = start.x, packet.org_y[k] = start.y, packet.org_z[k] = start.z;
        packet.dir_x[k] = d.x, packet.dir_y[k] = d.y, packet.dir_z[k] = d.z;
        packet.tnear[k] = kRise / std::max(rise, 1e-30f);
        packet.tfar[k]  = infinite ? kInfinity : reach;
        packet.id[k]    = from.triangle;
        packet.valid[k] = rise > 0 ? -1 : 0;
    }
    rays_.occluded(packet);
    unsigned seen = 0;
    for (std::size_t k = 0; k < to.size(); ++k)
        if (packet.valid[k] != 0 && packet.tfar[k] >= 0) seen |= 1u << k;
    return seen;
}

TriangleId Sight::first_hit(const SurfacePoint& from, dvec3 to, bool infinite, float reach) const {
    const FlushDenormals flush;
    const RaySpace& space = rays_.space();
    const vec3 start = space.point(from.position), d = infinite ? vec3(glm::normalize(to)) : space.vector(to);
    const float rise = glm::dot(vec3(from.normal), d);
    if (!(rise > 0)) return kNoTriangle;
    return rays_.first_hit({start.x, start.y, start.z, kRise / std::max(rise, 1e-30f), d.x, d.y, d.z, 0,
                            infinite ? kInfinity : reach, ~0u, from.triangle, 0});
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

}  // namespace umbra::radiosity_detail
