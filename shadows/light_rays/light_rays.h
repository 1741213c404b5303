// Rays from surface points to one light: one to a light without an area, one to each sample of an area light.
//
// This work is based on:
// Robert Cook, Thomas Porter, Loren Carpenter. Distributed Ray Tracing. 1984
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "umbra/core/render/sampling.h"
#include "umbra/core/render/tiles.h"
#include "umbra/shadows/light_rays/sample_options.h"
#include "umbra/shadows/light_rays/starts.h"
#include "umbra/shadows/light_rays/target.h"

namespace umbra::rays {

/// Whether any of `count` points asks for S_j, by their facing.
[[nodiscard]] inline bool any_asks(const Facing* facing, std::size_t count) {
    return std::any_of(facing, facing + count, is_asked);
}

/// An area light as one point sees it, in Target::unit of ray space: the light's points are to_centre + x axis_u +
/// y axis_v from there, |x|, |y| <= 1 for a rectangle, x^2 + y^2 <= 1 for a disk and for the disk that the point sees
/// of a sphere.
struct SeenLight {
    vec3 to_centre{0}, axis_u{0}, axis_v{0};
};

/// Const members may be called from many threads.
class LightRays {
public:
    /// `scene` and `rays` must outlive this object.
    LightRays(const Scene& scene, const RayScene& rays, LightId light, const SampleOptions& options)
        : rays_(&rays),
          light_(light),
          target_(make_target(scene.lights[light], rays.space())),
          near_light_(scene, rays, light),
          samples_(samples_of(light, target_.kind, options)) {}

    [[nodiscard]] const Target& target() const { return target_; }
    [[nodiscard]] const SampleSet& samples() const { return samples_; }

    /// An area light from a point in ray space; nothing where the point lies within it.
    [[nodiscard]] std::optional<SeenLight> seen_from(vec3 o) const {
        SeenLight seen{target_.centre - o * target_.per_unit, target_.axis_u, target_.axis_v};
        if (target_.kind == LightKind::sphere) {
            TangentDisk disk;
            if (!tangent_disk(dvec3(o), target_.sphere, target_.radius, disk)) return std::nullopt;
            const double per_unit = 1 / target_.unit;
            seen.to_centre        = vec3((disk.centre - dvec3(o)) * per_unit);
            seen.axis_u           = vec3(disk.axis_u * per_unit);
            seen.axis_v           = vec3(disk.axis_v * per_unit);
        }
        return seen;
    }

    /// Samples first .. first + 7 of a point, `first` a multiple of 8, as (x, y) of SeenLight.
    void eight(PointKey key, int first, Samples8& samples) const {
        samples_.eight(key, first, samples);
        if (target_.kind == LightKind::rectangle)
            for (int k = 0; k < 8; ++k) samples.x[k] = 2 * samples.x[k] - 1, samples.y[k] = 2 * samples.y[k] - 1;
        else
            map_to_disk(samples);
    }

    /// A packet whose rays start at lane `lane`; directions are still to be set.
    [[nodiscard]] static ShadowPacket packet_from(const Starts& starts, int lane) {
        ShadowPacket packet;
        for (int k = 0; k < 8; ++k) {
            packet.org_x[k] = starts.x[lane], packet.org_y[k] = starts.y[lane], packet.org_z[k] = starts.z[lane];
            packet.id[k] = starts.id[lane];
        }
        return packet;
    }

    /// Points the packet's rays at eight samples. Lanes below `count` are valid whose sample lies in front of the
    /// point's plane.
    void direct(const SeenLight& seen, const Samples8& samples, const Starts& starts, int lane, int count,
                ShadowPacket& packet) const {
        const vec3 n(starts.nx[lane], starts.ny[lane], starts.nz[lane]);
        for (int k = 0; k < 8; ++k) {
            const float dx   = seen.to_centre.x + samples.x[k] * seen.axis_u.x + samples.y[k] * seen.axis_v.x;
            const float dy   = seen.to_centre.y + samples.x[k] * seen.axis_u.y + samples.y[k] * seen.axis_v.y;
            const float dz   = seen.to_centre.z + samples.x[k] * seen.axis_u.z + samples.y[k] * seen.axis_v.z;
            const float rise = n.x * dx + n.y * dy + n.z * dz;
            packet.dir_x[k] = dx, packet.dir_y[k] = dy, packet.dir_z[k] = dz;
            packet.tnear[k] = starts.height[lane] / std::max(rise, 1e-30f);
            packet.tfar[k]  = target_.reach;
            packet.valid[k] = rise > 0 && k < count ? -1 : 0;
        }
    }

    /// Calls body(packet) for each eight samples of an area light, with their rays ready, until it returns false. Lanes
    /// are valid where there is a sample and it lies in front of the point's plane. False where the point lies within
    /// the light.
    template <class Body>
    bool for_each_packet(const Starts& starts, int lane, PointKey key, const Body& body) const {
        const std::optional<SeenLight> seen = seen_from({starts.x[lane], starts.y[lane], starts.z[lane]});
        if (!seen) return false;
        ShadowPacket packet = packet_from(starts, lane);
        for (int first = 0; first < samples_.count(); first += 8) {
            Samples8 samples;
            eight(key, first, samples);
            direct(*seen, samples, starts, lane, samples_.count() - first, packet);
            if (!body(packet)) return true;
        }
        return true;
    }

    /// The fraction of an area light's samples that a point sees, 1 within the light. Samples behind the point's plane
    /// are not seen. Call under FlushDenormals.
    [[nodiscard]] float visible_fraction(const Starts& starts, int lane, PointKey key) const;

    /// Writes S_j of a light without an area for the points of a tile that ask for it: one ray each.
    void trace_hard_light(const StartPlaces& places, const PointBatch& points, const PointTile& tile,
                          std::span<float> s) const;

    /// The first triangle on the ray to the light; for an area light, on the first ray that meets one, in up to sixteen
    /// sets of samples. For Method::blame. Samples are keyed by PointBatch::number.
    void blame(const StartPlaces& places, const PointBatch& points, std::span<TriangleId> blockers) const;

    [[nodiscard]] std::size_t memory_bytes() const { return samples_.memory_bytes() + near_light_.memory_bytes(); }

private:
    std::size_t hard_light_rays(const Starts& starts, const Facing* facing, std::size_t count, ShadowRay* rays) const;
    [[nodiscard]] TriangleId first_blocker(const Starts& starts, int lane, Facing facing, std::size_t point) const;

    const RayScene* rays_;
    LightId light_;
    Target target_;
    NearLight near_light_;
    SampleSet samples_;
};

}  // namespace umbra::rays
