#include "umbra/core/render/sum.h"

#include <algorithm>
#include <cmath>

namespace umbra {
namespace {

/// (R.V)^n or (N.H)^n with unit N, L, V. In double, since in float a cosine near 1 is off by 6e-8, which a shininess
/// of 1e6 turns into 6 % of the highlight.
double specular_lobe(const Material& material, dvec3 n, dvec3 l, dvec3 v) {
    double cosine = 0;
    if (material.lobe == Lobe::phong) {
        cosine = glm::dot(2 * glm::dot(n, l) * n - l, v);
    } else {
        const dvec3 h       = l + v;
        const double length = glm::length(h);
        if (length > 0) cosine = glm::dot(n, h) / length;  // V = -L: no half vector, no highlight
    }
    return std::pow(std::clamp(cosine, 0.0, 1.0), double(material.shininess));
}

}  // namespace

PhongSum::PhongSum(const Scene& scene, const CameraFrame& camera)
    : scene_(&scene),
      eye_(camera.eye),
      backward_(-camera.forward),
      orthographic_(camera.projection == Projection::orthographic),
      constant_v_(!scene.local_viewer || orthographic_) {
    dvec3 ambient = scene.ambient;
    for (const Light& light : scene.lights) ambient += dvec3(light.ambient);
    for (const Material& m : scene.materials) {
        const dvec3 specular = dvec3(m.k_s) * dvec3(m.O_s);
        terms_.push_back({.unshadowed  = dvec3(m.emission) + ambient * dvec3(m.k_a) * dvec3(m.O_d),
                          .diffuse     = dvec3(m.k_d) * dvec3(m.O_d),
                          .specular    = specular,
                          .is_specular = specular != dvec3(0)});
    }
}

/// f_att I_j (k_d O_d (N.L) + k_s O_s lobe): what light j would give if nothing blocked it.
dvec3 PhongSum::unblocked(const Light& light, const Material& material, const Terms& terms, vec3 p, dvec3 n, dvec3 v) {
    const dvec3 towards = to_light(light, p).direction;
    const double length = glm::length(towards);
    if (!(length > 0)) return dvec3(0);  // the light is at p
    const dvec3 l       = towards / length;
    const double cosine = glm::dot(n, l);
    if (cosine <= 0) return dvec3(0);
    const double f_att = falloff(light, p);
    if (f_att <= 0) return dvec3(0);
    dvec3 reflected = dvec3(light.diffuse) * terms.diffuse * cosine;
    if (terms.is_specular && light.specular != vec3(0))
        reflected += dvec3(light.specular) * terms.specular * specular_lobe(material, n, l, v);
    return f_att * reflected;
}

dvec3 PhongSum::to_viewer(const PointBatch& points, std::size_t i) const {
    return glm::normalize(constant_v_ ? backward_ : dvec3(points.eye) - dvec3(points.position(i)));
}

dvec3 PhongSum::at(const PointBatch& points, std::size_t i, dvec3 n,
                   std::span<const VisibilityPlane> visibility) const {
    return at_the_eye(leaving(points, i, n, to_viewer(points, i), visibility), points.position(i));
}

dvec3 PhongSum::leaving(const PointBatch& points, std::size_t i, dvec3 n, dvec3 v,
                        std::span<const VisibilityPlane> visibility) const {
    const std::uint32_t id   = material(points.triangle[i]);
    const Material& material = scene_->materials[id];
    const vec3 p             = points.position(i);

    dvec3 sum = terms_[id].unshadowed;
    for (std::size_t j = 0; j < scene_->lights.size(); ++j) {
        if (points.facing[j][i] == Facing::away) continue;  // S_j = 0
        const double s_j = visibility[j].defined(i) ? visibility[j].s[i] : 1.0f;
        if (s_j > 0) sum += s_j * unblocked(scene_->lights[j], material, terms_[id], p, n, v);
    }
    return sum;
}

dvec3 PhongSum::at_the_eye(dvec3 light, vec3 p) const {
    if (scene_->fog.law == FogLaw::none) return light;
    const dvec3 way    = dvec3(p) - eye_;
    const double depth = glm::dot(way, -backward_);
    const bool radial  = scene_->fog.distance == FogDistance::radial && !orthographic_;
    const double f     = fog_share(scene_->fog, std::max(0.0, radial ? glm::length(way) : depth));
    return f * light + (1 - f) * dvec3(scene_->fog.colour);
}

dvec3 PhongSum::from_the_eye(TriangleId t, double cosine) const {
    const Terms& terms = terms_[material(t)];
    dvec3 sum          = terms.unshadowed;
    for (const Light& light : scene_->lights) sum += dvec3(light.diffuse) * terms.diffuse * std::max(cosine, 0.0);
    return sum;
}

}  // namespace umbra
