#include "umbra/shadows/maps/casters.h"

#include <bit>
#include <mutex>

#include "umbra/core/base/geometry.h"

namespace umbra {
namespace {

constexpr double kCornerRounding = 0x1p-22;  // of a corner that was computed in float, relative
constexpr double kGrazing        = 1e-6;     // sine: flatter light may as well lie in the plane

/// Beyond which sides of a view p lies, a bit each.
std::uint8_t sides_beyond(const dmat4& clip_from_world, dvec3 p) {
    const dvec4 c = clip_from_world * dvec4(p, 1);
    return static_cast<std::uint8_t>(int{c.w <= 0} | int{c.x > c.w} << 1 | int{c.x < -c.w} << 2 | int{c.y > c.w} << 3 |
                                     int{c.y < -c.w} << 4);
}

}  // namespace

Casters::Casters(const Scene& scene, const SceneFacts& facts, bool leave_out)
    : scene_(scene), planes_of_position_(scene.positions.size(), 0) {
    std::vector<std::uint8_t> plane_of_triangle(scene.triangles.size(), kMaxPlanes);
    if (leave_out) find_planes(facts, plane_of_triangle);
    for (std::size_t t = 0; t < scene.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            planes_of_position_[scene.triangles[t][k]] |= std::uint64_t{1} << plane_of_triangle[t];
    for (const Object& object : scene.objects)
        for (std::uint32_t i = 0; i < object.triangle_count; ++i) {
            const TriangleId t = object.first_triangle + i;
            if (!scene.blocks(t)) break;  // no triangle of the object does
            if (i == 0 || plane_of_triangle[t] != parts_.back().plane)
                parts_.push_back({t, 0, plane_of_triangle[t], {}});
            parts_.back().count += 1;
            for (int k = 0; k < 3; ++k) parts_.back().box = extend(parts_.back().box, scene.vertex(t, k));
        }
    find_sides();
}

void Casters::find_planes(const SceneFacts& facts, std::vector<std::uint8_t>& plane_of_triangle) {
    const vec3 corner    = glm::max(glm::abs(facts.box.min), glm::abs(facts.box.max));
    const double largest = std::max({corner.x, corner.y, corner.z});
    for (const PlanarReceiver& plane : facts.planes) {
        if (planes_.size() == kMaxPlanes) break;
        for (TriangleId t : plane.triangles) plane_of_triangle[t] = static_cast<std::uint8_t>(planes_.size());
        planes_.push_back({plane.normal, plane.offset, plane.tolerance + kCornerRounding * largest, {}, {}});
    }
}

void Casters::find_sides() {
    const std::size_t n = planes_.size();
    parallel_ranges(n, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            CasterPlane& plane = planes_[i];
            plane.others.resize(n);
            for (std::size_t p = 0; p < planes_of_position_.size(); ++p) {
                const std::uint64_t in = planes_of_position_[p];
                if (in == 0) continue;
                const double distance = glm::dot(plane.normal, dvec3(scene_.positions[p])) - plane.offset;
                plane.scene.add(distance);
                for (std::uint64_t rest = in & ~(std::uint64_t{1} << kMaxPlanes); rest != 0; rest &= rest - 1)
                    plane.others[std::countr_zero(rest)].add(distance);
            }
        }
    });
}

SelectedCasters::SelectedCasters(const Casters& casters, const Light& light) : casters_(casters) {
    const bool infinite = light.kind == LightKind::directional;
    const auto& planes  = casters.planes_;
    std::vector<std::size_t> set;
    std::vector<int> side(planes.size());
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const auto& plane     = planes[i];
        const double distance = infinite ? -glm::dot(plane.normal, glm::normalize(dvec3(light.direction)))
                                         : glm::dot(plane.normal, dvec3(light.position)) - plane.offset;
        const double least    = infinite ? kGrazing : plane.tolerance;
        side[i]               = distance > least ? 1 : distance < -least ? -1 : 0;
        if (side[i] == 0) continue;
        if (plane.has_on_side(plane.scene, side[i])) drawn_ &= ~(std::uint64_t{1} << i);
        if (std::ranges::all_of(set, [&](std::size_t j) {
                return plane.has_on_side(plane.others[j], side[i]) &&
                       planes[j].has_on_side(planes[j].others[i], side[j]);
            })) {
            set.push_back(i);
            fitted_ &= ~(std::uint64_t{1} << i);
        }
    }
    for (const auto& part : casters.parts_)
        if (part.is_in(fitted_)) box_ = extend(box_, part.box);
}

double SelectedCasters::distance(dvec3 p) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& part : casters_.parts_) {
        if (!part.is_in(fitted_)) continue;
        const dvec3 to_box = glm::max(glm::max(dvec3(part.box.min) - p, p - dvec3(part.box.max)), 0.0);
        if (glm::length(to_box) >= nearest) continue;
        const auto range = reduce<1>(part.count, [&](std::size_t i, std::array<double, 1>& v) {
            const auto t = static_cast<TriangleId>(part.first + i);
            v[0]         = distance_to_triangle(p, dvec3(scene().vertex(t, 0)), dvec3(scene().vertex(t, 1)),
                                                dvec3(scene().vertex(t, 2)));
            return true;
        });
        nearest          = std::min(nearest, range[0].min);
    }
    return nearest;
}

std::vector<std::span<const uvec3>> SelectedCasters::seen_by(const dmat4& clip_from_world, bool all) const {
    std::vector<std::span<const uvec3>> runs;
    for (const auto& part : casters_.parts_) {
        if (!all && !part.is_in(drawn_)) continue;
        std::uint8_t beyond = 0xff;
        for (int corner = 0; corner < 8; ++corner)
            beyond &= sides_beyond(clip_from_world, {corner & 1 ? part.box.max.x : part.box.min.x,
                                                     corner & 2 ? part.box.max.y : part.box.min.y,
                                                     corner & 4 ? part.box.max.z : part.box.min.z});
        if (beyond == 0) runs.push_back(std::span(scene().triangles).subspan(part.first, part.count));
    }
    return runs;
}

std::vector<std::span<const uvec3>> SelectedCasters::reaching(const dmat4& clip_from_world) const {
    const std::vector<vec3>& positions = scene().positions;
    std::vector<std::uint8_t> beyond(positions.size());
    parallel_ranges(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) beyond[i] = sides_beyond(clip_from_world, dvec3(positions[i]));
    });
    std::vector<std::span<const uvec3>> runs;
    std::mutex adding;
    for (const std::span<const uvec3> part : seen_by(clip_from_world))
        parallel_ranges(part.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            std::vector<std::span<const uvec3>> mine;
            for (std::size_t i = begin; i < end; ++i)
                if ((beyond[part[i].x] & beyond[part[i].y] & beyond[part[i].z]) == 0)
                    mine.push_back(part.subspan(i, 1));
            const std::lock_guard lock(adding);
            runs.insert(runs.end(), mine.begin(), mine.end());
        });
    return runs;
}

}  // namespace umbra
