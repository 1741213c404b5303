#include "umbra/core/render/sum.h"

#include <algorithm>
#include <cmath>

#include "umbra/core/render/brdf.h"
#include "umbra/core/render/lobe_power.h"

namespace umbra {
namespace {

/// One an object and light; empty where every light lights every object.
std::vector<bool> find_left_out(const Scene& scene) {
    std::vector<bool> left_out;
    const auto leaves_out = [](const Light& light) { return !light.except.empty(); };
    if (!std::any_of(scene.lights.begin(), scene.lights.end(), leaves_out)) return left_out;
    for (const Object& object : scene.objects)
        for (const Light& light : scene.lights) left_out.push_back(!lights_object(light, object.name));
    return left_out;
}

bool has_attenuated_ambient(const Scene& scene) {
    return scene.light_ambient == LightAmbient::attenuated &&
           std::any_of(scene.lights.begin(), scene.lights.end(),
                       [](const Light& light) { return light.ambient != vec3(0); });
}

}  // namespace

PhongSum::PhongSum(const Scene& scene, const CameraFrame& camera)
    : scene_(&scene),
      left_out_(find_left_out(scene)),
      eye_(camera.eye),
      backward_(-camera.forward),
      orthographic_(camera.projection == Projection::orthographic),
      attenuated_ambient_(has_attenuated_ambient(scene)),
      constant_v_(!scene.local_viewer || orthographic_) {
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
        dvec3 ambient = scene.ambient;
        for (std::size_t j = 0; j < scene.lights.size() && !attenuated_ambient_; ++j)
            if (lights(j, o)) ambient += dvec3(scene.lights[j].ambient);
        const Material& m    = scene.materials[scene.objects[o].material];
        const dvec3 k_a      = scene.ambient_coefficient == AmbientCoefficient::k_d ? m.k_d : m.k_a;
        const dvec3 specular = dvec3(m.k_s) * dvec3(scene.specular_colour == SpecularColour::O_d ? m.O_d : m.O_s);
        terms_.push_back({.unshadowed  = dvec3(m.emission) + ambient * k_a * dvec3(m.O_d),
                          .ambient     = k_a * dvec3(m.O_d),
                          .diffuse     = dvec3(m.k_d) * dvec3(m.O_d),
                          .specular    = specular,
                          .is_specular = specular != dvec3(0)});
    }
}

double arriving_share(const Scene& scene, const Light& light, vec3 p) {
    const double f_att = falloff(light, p);
    if (!scene.fog.dims_lights || light.kind == LightKind::directional || f_att <= 0) return f_att;
    return f_att * fog_share(scene.fog, static_cast<double>(to_light(light, p).distance));
}

/// f_att I_j (k_d O_d (N.L) + ...): the contribution of light j if nothing blocked it, with the angle's cosine.
/// `add_specular` adds the rest in the brackets. Says count(term) of each term of SumCounts that it evaluates.
template <class AddSpecular, class Count>
dvec3 PhongSum::unblocked(const Light& light, const Terms& terms, vec3 p, double cosine,
                          const AddSpecular& add_specular, const Count& count) const {
    if (cosine <= 0) return dvec3(0);
    const double f_att = arriving_share(*scene_, light, p);
    if (f_att <= 0) return dvec3(0);
    count(&SumCounts::diffuse);
    dvec3 reflected = dvec3(light.diffuse) * terms.diffuse * cosine;
    add_specular(reflected);
    return f_att * reflected;
}

/// The same from directions.
template <class Count>
dvec3 PhongSum::unblocked(const Light& light, const Material& material, const Terms& terms, vec3 p, dvec3 n, dvec3 v,
                          const Count& count) const {
    const dvec3 towards = to_light(light, p).direction;
    const double length = glm::length(towards);
    if (!(length > 0)) return dvec3(0);  // the light is at p
    const dvec3 l           = towards / length;
    const auto add_specular = [&](dvec3& reflected) {
        if (terms.is_specular && light.specular != vec3(0)) {
            count(&SumCounts::specular);
            reflected += dvec3(light.specular) * terms.specular * specular_lobe(material, n, l, v);
        }
        if (!material.lobes.empty()) {
            count(&SumCounts::lobes);
            reflected += dvec3(light.specular) * lafortune_lobes(material, n, l, v);
        }
    };
    return unblocked(light, terms, p, glm::dot(n, l), add_specular, count);
}

dvec3 PhongSum::to_viewer_from(const PointBatch& points, dvec3 p) const {
    return glm::normalize(constant_v_ ? backward_ : dvec3(points.eye) - p);
}

dvec3 PhongSum::at(const PointBatch& points, std::size_t i, dvec3 n,
                   std::span<const VisibilityPlane> visibility) const {
    return at_the_eye(leaving(points, i, n, to_viewer(points, i), visibility), points.position(i));
}

dvec3 PhongSum::leaving(const PointBatch& points, std::size_t i, dvec3 n, dvec3 v,
                        std::span<const VisibilityPlane> visibility) const {
    return add_up(points, i, n, v, visibility, [](auto) {});
}

void PhongSum::count(const PointBatch& points, std::size_t i, dvec3 n, std::span<const VisibilityPlane> visibility,
                     SumCounts& counts) const {
    ++counts.sums;
    counts.fog += scene_->fog.law != FogLaw::none ? 1 : 0;
    add_up(points, i, n, to_viewer(points, i), visibility, [&](auto term) { ++(counts.*term); });
}

dvec3 PhongSum::with_cosines(const PointBatch& points, std::size_t i, std::span<const LightCosines> cosines,
                             std::span<const VisibilityPlane> visibility) const {
    const std::uint32_t object = scene_->triangle_object[points.triangle[i]];
    const Material& material   = scene_->materials[scene_->objects[object].material];
    const Terms& terms         = terms_[object];
    const vec3 p               = points.position(i);
    const auto count           = [](auto) {};
    const auto unblocked_by    = [&](std::size_t j) {
        const Light& light      = scene_->lights[j];
        const auto add_specular = [&](dvec3& reflected) {
            if (terms.is_specular && light.specular != vec3(0) && cosines[j].lobe > 0)
                reflected += dvec3(light.specular) * terms.specular *
                             lobe_power(std::min(cosines[j].lobe, 1.0), material.shininess);
        };
        return unblocked(light, terms, p, cosines[j].diffuse, add_specular, count);
    };
    return at_the_eye(add_up(points, i, visibility, unblocked_by, count), p);
}

template <class Count>
dvec3 PhongSum::add_up(const PointBatch& points, std::size_t i, dvec3 n, dvec3 v,
                       std::span<const VisibilityPlane> visibility, const Count& count) const {
    const std::uint32_t object = scene_->triangle_object[points.triangle[i]];
    const Material& material   = scene_->materials[scene_->objects[object].material];
    const auto unblocked_by    = [&](std::size_t j) {
        return unblocked(scene_->lights[j], material, terms_[object], points.position(i), n, v, count);
    };
    return add_up(points, i, visibility, unblocked_by, count);
}

template <class Unblocked, class Count>
dvec3 PhongSum::add_up(const PointBatch& points, std::size_t i, std::span<const VisibilityPlane> visibility,
                       const Unblocked& unblocked_by, const Count& count) const {
    const std::uint32_t object = scene_->triangle_object[points.triangle[i]];
    const Terms& terms         = terms_[object];

    dvec3 sum = terms.unshadowed;
    for (std::size_t j = 0; j < scene_->lights.size(); ++j) {
        if (!lights(j, object)) continue;
        const Light& light = scene_->lights[j];
        if (attenuated_ambient_ && light.ambient != vec3(0)) {
            count(&SumCounts::ambient);
            sum += arriving_share(*scene_, light, points.position(i)) * dvec3(light.ambient) * terms.ambient;
        }
        if (points.facing[j][i] == Facing::away) continue;  // S_j = 0
        const double s_j = visibility[j].defined(i) ? visibility[j].s[i] : 1.0f;
        if (!(s_j > 0)) continue;
        if (visibility[j].colour.empty() || !visibility[j].defined(i))
            sum += s_j * unblocked_by(j);
        else
            sum += dvec3(visibility[j].colour[i]) * unblocked_by(j);
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
    const std::uint32_t object = scene_->triangle_object[t];
    const Terms& terms         = terms_[object];
    dvec3 sum                  = terms.unshadowed;
    for (std::size_t j = 0; j < scene_->lights.size(); ++j) {
        if (!lights(j, object)) continue;
        const Light& light = scene_->lights[j];
        if (attenuated_ambient_) sum += dvec3(light.ambient) * terms.ambient;
        sum += dvec3(light.diffuse) * terms.diffuse * std::max(cosine, 0.0);
    }
    return sum;
}

}  // namespace umbra
