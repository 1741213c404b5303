#include "umbra/shadows/radiosity/exchange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "umbra/core/base/parallel.h"
#include "umbra/shadows/geometry/clipped_polygon.h"

namespace umbra {

using namespace patches;

namespace {

constexpr float kBeforeThePatch = 0.999f;

double mean(dvec3 colour) { return (colour.x + colour.y + colour.z) / 3; }

}  // namespace

double patches::form_factor(dvec3 p, dvec3 n, std::span<const dvec3> polygon) {
    // The part behind p's plane does not count; a convex polygon gains one corner there.
    ClippedPolygon<dvec3, 16> part;
    for (const dvec3 corner : polygon) part.add(corner - p);
    part.cut<CutFrom::first>([&](dvec3 corner) { return glm::dot(n, corner); });
    double sum = 0;
    for (std::size_t k = 0; k < part.count; ++k) {
        const dvec3 a = part.corners[k], b = part.corners[(k + 1) % part.count], across = glm::cross(a, b);
        const double length = glm::length(across);
        if (length > 0) sum += glm::dot(n, across) / length * std::atan2(length, glm::dot(a, b));
    }
    return std::clamp(std::abs(sum) / (2 * kPi), 0.0, 1.0);
}

Exchange::Exchange(const Scene& scene, const Options& options)
    : scene_(&scene),
      options_(options),
      sight_(scene),
      patches_(scene, options.size * static_cast<double>(bounds(scene).diagonal())),
      sides_(2 * patches_.size()) {
    parallel_ranges(patches_.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) place(static_cast<PatchId>(k));
    });
    for (const PatchSide& side : sides_) first_ += side.area * mean(side.unshot);
}

std::array<dvec3, 3> Exchange::polygon(PatchId patch) const {
    const TriangleId t = patches_.triangle(patch);
    const dvec3 a(scene_->vertex(t, 0)), ab = dvec3(scene_->vertex(t, 1)) - a, ac = dvec3(scene_->vertex(t, 2)) - a;
    std::array<dvec3, 3> corners{};
    const auto at = patches_.corners(patch);
    for (std::size_t k = 0; k < 3; ++k) corners[k] = a + at[k].x * ab + at[k].y * ac;
    return corners;
}

void Exchange::place(PatchId patch) {
    const auto [a, b, c]     = polygon(patch);
    const dvec3 across       = glm::cross(b - a, c - a);
    const double twice       = glm::length(across);
    const TriangleId t       = patches_.triangle(patch);
    const Material& material = scene_->material(t);
    if (!(twice > 0)) return;
    for (std::uint32_t flipped = 0; flipped < (material.two_sided ? 2u : 1u); ++flipped) {
        PatchSide& side = sides_[2 * patch + flipped];
        side.centre     = {(a + b + c) / 3.0, (flipped != 0 ? -1.0 : 1.0) * across / twice, t};
        side.area       = twice / 2;
        side.reflects   = dvec3(material.k_d) * dvec3(material.O_d);
        side.direct     = find_direct(side, material);
        side.unshot     = side.direct;
    }
}

dvec3 Exchange::find_direct(const PatchSide& side, const Material& material) const {
    const std::string& object = scene_->objects[scene_->triangle_object[side.centre.triangle]].name;
    dvec3 light_sum{0};
    for (const Light& light : scene_->lights) {
        if (!lights_object(light, object)) continue;
        const vec3 position    = vec3(side.centre.position);
        const double cosine    = glm::dot(side.centre.normal, dvec3(to_light(light, position).direction));
        const double intensity = static_cast<double>(falloff(light, position));
        if (!(cosine > 0) || !(intensity > 0)) continue;
        const bool shadowed = scene_->switches(side.centre.triangle).receives_shadows;
        const double seen =
            shadowed ? static_cast<double>(light_share(sight_, side.centre, light, options_.light_samples)) : 1;
        light_sum += seen * intensity * cosine * dvec3(light.diffuse);
    }
    return dvec3(material.emission) + side.reflects * light_sum;
}

double Exchange::unshot() const {
    double left = 0;
    for (const PatchSide& side : sides_) left += side.area * mean(side.unshot);
    return first_ > 0 ? left / first_ : 0;
}

/// From `from` to a patch with these corners, of which `to` is a side.
double Exchange::form_factor(const PatchSide& from, const std::array<dvec3, 3>& polygon, const PatchSide& to) const {
    if (from.area == 0 || to.area == 0) return 0;
    const dvec3 p = from.centre.position;
    if (!(glm::dot(to.centre.normal, p - to.centre.position) > 0)) return 0;
    const double whole = patches::form_factor(p, from.centre.normal, polygon);
    if (!(whole > 0)) return 0;
    const auto& [a, b, c] = polygon;
    const dvec3 m         = to.centre.position;
    const std::array<dvec3, 4> targets{m - p, 0.5 * (a + m) - p, 0.5 * (b + m) - p, 0.5 * (c + m) - p};
    const unsigned seen = sight_.seen(from.centre, targets, false, kBeforeThePatch);
    int hits = 0, in_front = 0;
    for (unsigned k = 0; k < targets.size(); ++k) {
        in_front += glm::dot(from.centre.normal, targets[k]) > 0 ? 1 : 0;
        hits += static_cast<int>(seen >> k & 1);
    }
    return in_front > 0 ? whole * hits / in_front : 0;
}

double Exchange::form_factor(SideId from, SideId to) const {
    return from == to ? 0 : form_factor(sides_[from], polygon(to / 2), sides_[to]);
}

Exchange::SideId Exchange::shoot() {
    const auto power = [](const PatchSide& side) { return side.area * mean(side.unshot); };
    const auto best  = std::ranges::max_element(sides_, {}, power);
    const auto from  = static_cast<SideId>(best - sides_.begin());
    const dvec3 sent = best->unshot;
    sent_ += power(*best);
    best->unshot    = dvec3(0);
    const auto part = polygon(from / 2);
    std::vector<double> arrived(sides_.size(), 0);
    parallel_ranges(sides_.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            PatchSide& side     = sides_[k];
            const double factor = k == from ? 0 : form_factor(side, part, sides_[from]);
            arrived[k]          = factor * side.area * mean(sent);
            side.indirect += factor * side.reflects * sent;
            side.unshot += factor * side.reflects * sent;
        }
    });
    for (const double power_here : arrived) arrived_ += power_here;
    return from;
}

Exchange::SideId Exchange::side_at(const PointBatch& points, std::size_t i) const {
    return 2 * patches_.find(points.triangle[i], points.u[i], points.v[i]).patch + points.flipped[i];
}

std::vector<vec3> Exchange::indirect_at(const PointBatch& points) const {
    // Corners are the same where position and normal agree to a millionth.
    using Key         = std::array<std::int64_t, 6>;
    const double unit = std::max(1e-6 * static_cast<double>(bounds(*scene_).diagonal()), 1e-300);
    const auto key_of = [&](dvec3 p, dvec3 n) {
        return Key{std::llround(p.x / unit), std::llround(p.y / unit), std::llround(p.z / unit),
                   std::llround(n.x * 1e4),  std::llround(n.y * 1e4),  std::llround(n.z * 1e4)};
    };
    struct Sum {
        dvec3 light{0};
        double area = 0;
    };
    std::map<Key, Sum> sums;
    const auto visit = [&](SideId id, const auto& use) {
        const auto corners = polygon(id / 2);
        for (std::size_t k = 0; k < 3; ++k) use(sums[key_of(corners[k], sides_[id].centre.normal)], k);
    };
    for (SideId id = 0; id < sides_.size(); ++id)
        if (const PatchSide& side = sides_[id]; side.area > 0)
            visit(id, [&](Sum& sum, std::size_t) { sum.light += side.area * side.indirect, sum.area += side.area; });
    std::vector<std::array<dvec3, 3>> at_corners(sides_.size());
    for (SideId id = 0; id < sides_.size(); ++id)
        if (sides_[id].area > 0)
            visit(id, [&](const Sum& sum, std::size_t k) { at_corners[id][k] = sum.light / sum.area; });
    std::vector<vec3> light(points.size(), vec3(0));
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        const InPatch at      = patches_.find(points.triangle[i], points.u[i], points.v[i]);
        const auto& [a, b, c] = at_corners[2 * at.patch + points.flipped[i]];
        light[i]              = vec3((1 - at.u - at.v) * a + at.u * b + at.v * c);
    }
    return light;
}

}  // namespace umbra
