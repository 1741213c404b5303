#include "umbra/shadows/exact/aimed_light.h"

#include "umbra/core/base/parallel.h"
#include "umbra/shadows/exact/light_space.h"

namespace umbra::exact_visibility {
namespace {

/// How far a point that lies within the reach of edges (kCutReach, 1.0625) may be from the light's centre along an
/// axis: of a flat light, in half axes, that much; of a sphere sqrt(2) times that, 1.503 radii, since the tangent disk
/// with its rim lies within the sphere. Rounded up.
constexpr double kFlatReach = 1.2, kSphereReach = 1.6;

constexpr double kBoxRounding = 1e-12;  ///< relative: more than the rounding of a comparison in double

}  // namespace

AimedLight::AimedLight(const Light& light, const Occluders& occluders)
    : light_(light),
      half_(half_axes(light)),
      exact_half_(is_sphere() ? ExactAxes{} : exact_axes(light, half_)),
      side_(is_sphere() ? std::vector<std::int8_t>{} : sides(occluders)),
      across_(those_across(occluders)) {}

std::optional<LightPlane> AimedLight::plane_from(const ExactPoint& p) const {
    return is_sphere() ? sphere_light_plane(light_, p) : flat_light_plane(light_, half_, exact_half_, p);
}

std::optional<BoxTree::Region> AimedLight::region_from(const ExactPoint& p, double reach) const {
    if (is_sphere()) {
        // The tangent disk with its rim lies within the sphere, and the square about it in sqrt(2) times that.
        const dvec3 centre = dvec3(light_.position) - dvec3(p.corner());
        const Entries to   = p.to(Entries{centre, kUnit * largest(centre)});
        return shaft_to_ball(p, to, 1.5 * reach * static_cast<double>(light_.radius));
    }
    const std::optional<LightPlane> plane = plane_from(p);
    const FloatSpace space(p, *plane);
    if (!space.orientation()) return std::nullopt;
    return shaft(p, space, reach);
}

/// Exact.
std::vector<std::int8_t> AimedLight::sides(const Occluders& occluders) const {
    std::vector<std::int8_t> side(occluders.positions.size());
    const dvec3 centre(light_.position);
    const Entries u{half_.u, axis_error(light_)}, v{half_.v, axis_error(light_)};
    parallel_ranges(side.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const vec3 q          = occluders.position(static_cast<std::uint32_t>(k));
            const dvec3 d         = dvec3(q) - centre;
            const Filtered<int> s = sign_of_determinant(u, v, Entries{d, kUnit * largest(d)});
            side[k]               = static_cast<std::int8_t>(
                s ? *s : sign_of_determinant(exact_half_.u, exact_half_.v, rational(q) - rational(light_.position)));
        }
    });
    return side;
}

dvec3 AimedLight::reach() const {
    if (is_sphere()) return dvec3(kSphereReach * static_cast<double>(light_.radius));
    return kFlatReach * (glm::abs(half_.u) + glm::abs(half_.v));
}

std::vector<TriangleId> AimedLight::those_across(const Occluders& occluders) const {
    std::vector<TriangleId> across;
    const dvec3 centre(light_.position), wide = reach();
    for (TriangleId t = 0; t < occluders.corners.size(); ++t) {
        const uvec3 v = occluders.corners[t];
        if (!occluders.blocks(t)) continue;
        if (!side_.empty() && side_[v[0]] == side_[v[1]] && side_[v[1]] == side_[v[2]]) continue;
        const vec3 a = occluders.position(v[0]), b = occluders.position(v[1]), c = occluders.position(v[2]);
        bool apart = false;
        for (int k = 0; k < 3; ++k) {
            const auto [lo, hi] = std::minmax({a[k], b[k], c[k]});
            const double around = wide[k] + kBoxRounding * (std::abs(centre[k]) + wide[k]);
            apart               = apart || hi < centre[k] - around || lo > centre[k] + around;
        }
        if (!apart) across.push_back(t);
    }
    return across;
}

}  // namespace umbra::exact_visibility
