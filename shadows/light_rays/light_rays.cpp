#include "umbra/shadows/light_rays/light_rays.h"

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/parallel.h"

namespace umbra::rays {

/// Writes one ray for each of the `count` points that faces the light, from `rays` on. Returns how many.
std::size_t LightRays::hard_light_rays(const Starts& starts, const Facing* facing, std::size_t count,
                                       ShadowRay* rays) const {
    const bool parallel  = target_.kind == LightKind::directional;
    const float per_unit = parallel ? 0 : target_.per_unit;
    float dx[8], dy[8], dz[8], tnear[8];
    for (int k = 0; k < 8; ++k) {
        dx[k]            = target_.centre.x - per_unit * starts.x[k];
        dy[k]            = target_.centre.y - per_unit * starts.y[k];
        dz[k]            = target_.centre.z - per_unit * starts.z[k];
        const float rise = starts.nx[k] * dx[k] + starts.ny[k] * dy[k] + starts.nz[k] * dz[k];
        tnear[k]         = starts.height[k] / std::max(rise, 1e-30f);
    }
    const float tfar    = parallel ? kInfinity : target_.reach;
    std::size_t written = 0;
    for (std::size_t k = 0; k < count; ++k) {
        if (!is_asked(facing[k])) continue;
        rays[written++] = {starts.x[k], starts.y[k], starts.z[k], tnear[k], dx[k],        dy[k],
                           dz[k],       0,           tfar,        ~0u,      starts.id[k], 0};
    }
    return written;
}

// All rays of a tile are one list, since neighbours meet the same triangles.
UMBRA_FOR_EACH_PROCESSOR void LightRays::trace_hard_light(const StartPlaces& places, const PointBatch& points,
                                                          const PointTile& tile, std::span<float> s) const {
    const FlushDenormals flush;
    const Facing* facing = points.facing[light_].data();
    Starts starts;
    ShadowRay rays[PointTile::kPoints];
    std::size_t traced = 0;
    tile.load_next(points.triangle, points.px, points.py, points.pz, points.nx, points.ny, points.nz,
                   points.facing[light_]);
    tile.load_for_writing(s);
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        if (!any_asks(facing + first, count)) return;
        places.load(points, first, count, starts);
        traced += hard_light_rays(starts, facing + first, count, rays + traced);
    });
    if (traced == 0) return;
    rays_->occluded(std::span(rays, traced));
    std::size_t next    = 0;
    const bool has_near = !near_light_.empty();
    tile.for_each_run([&](std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i) {
            if (!points.asks(light_, i)) continue;
            const bool blocked = rays[next++].tfar < 0 || (has_near && near_light_.blocker(points, i) != kNoTriangle);
            s[i]               = blocked ? 0.0f : 1.0f;
        }
    });
}

UMBRA_FOR_EACH_PROCESSOR float LightRays::visible_fraction(const Starts& starts, int lane, PointKey key) const {
    int seen           = 0;
    const bool outside = for_each_packet(starts, lane, key, [&](ShadowPacket& packet) {
        rays_->occluded(packet);
        for (int k = 0; k < 8; ++k) seen += packet.valid[k] != 0 && packet.tfar[k] >= 0;
        return true;
    });
    return outside ? static_cast<float>(seen) / static_cast<float>(samples_.count()) : 1;
}

TriangleId LightRays::first_blocker(const Starts& starts, int lane, Facing facing, std::size_t point) const {
    if (!is_area(target_.kind)) {
        ShadowRay ray;
        hard_light_rays(lane_alone(starts, lane), &facing, 1, &ray);
        return rays_->first_hit(ray);
    }
    // Where little of the light is hidden one set of samples may miss it: sixteen are tried.
    TriangleId blocker = kNoTriangle;
    for (std::uint64_t attempt = 0; attempt < 16 && blocker == kNoTriangle; ++attempt)
        for_each_packet(starts, lane, samples_.key(16 * point + attempt), [&](const ShadowPacket& packet) {
            for (int k = 0; k < 8 && blocker == kNoTriangle; ++k)
                if (packet.valid[k] != 0)
                    blocker = rays_->first_hit({packet.org_x[k], packet.org_y[k], packet.org_z[k], packet.tnear[k],
                                                packet.dir_x[k], packet.dir_y[k], packet.dir_z[k], 0, packet.tfar[k],
                                                ~0u, packet.id[k], 0});
            return blocker == kNoTriangle;
        });
    return blocker;
}

void LightRays::blame(const StartPlaces& places, const PointBatch& points, std::span<TriangleId> blockers) const {
    const std::vector<Facing>& facing = points.facing[light_];
    parallel_ranges((points.size() + 7) / 8, 8, [&](std::size_t begin, std::size_t end) {
        const FlushDenormals flush;
        Starts starts;
        for (std::size_t first = 8 * begin; first < std::min(8 * end, points.size()); first += 8) {
            const std::size_t count = std::min<std::size_t>(8, points.size() - first);
            places.load(points, first, count, starts);
            for (std::size_t k = 0; k < count; ++k) {
                TriangleId& blocker = blockers[first + k];
                blocker             = kNoTriangle;
                if (!is_asked(facing[first + k])) continue;
                blocker = first_blocker(starts, static_cast<int>(k), facing[first + k], points.number(first + k));
                if (blocker == kNoTriangle) blocker = near_light_.blocker(points, first + k);
            }
        }
    });
}

}  // namespace umbra::rays
