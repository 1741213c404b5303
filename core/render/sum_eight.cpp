// The sum at eight points at a time: the operations of PhongSum::at in their order, in loops over lanes that compilers
// make vector code of, so that the bits are the same. Exponentials alone are taken one by one.
#include <algorithm>
#include <cmath>
#include <limits>

#include "umbra/core/render/lobe_power.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/render/sum.h"

namespace umbra {
namespace {

constexpr int kLanes = 8;
using Lanes          = double[kLanes];

struct Lanes3 {
    Lanes x, y, z;
    void set(int k, dvec3 v) { x[k] = v.x, y[k] = v.y, z[k] = v.z; }
};

void dots(const Lanes3& a, const Lanes3& b, Lanes& to) {
    for (int k = 0; k < kLanes; ++k) to[k] = a.x[k] * b.x[k] + a.y[k] * b.y[k] + a.z[k] * b.z[k];
}

}  // namespace

/// Eight points, those without a surface among them with the numbers of another.
struct PhongSum::Eight {
    unsigned which = 0;  ///< bit k: the sum is asked for, and there is a surface
    Lanes3 p, n, v;
    std::uint32_t object[kLanes]{};
    Lanes3 diffuse, specular, sum;
    Lanes is_specular;
};

bool PhongSum::has_lanes(std::span<const VisibilityPlane> visibility) const {
    return scene_->fog.law == FogLaw::none && !scene_->fog.dims_lights && !attenuated_ambient_ &&
           std::ranges::all_of(scene_->materials, [](const Material& m) { return m.lobes.empty(); }) &&
           std::ranges::all_of(visibility, [](const VisibilityPlane& plane) { return plane.colour.empty(); });
}

/// Positions, normals, directions to the eye, and the terms of the objects.
void PhongSum::load_surfaces(const PointBatch& points, std::size_t first, Eight& e) const {
    Lanes3 face, corner[3];
    Lanes share[3];
    const bool smooth = !scene_->normals.empty();
    const int any     = std::countr_zero(e.which);
    for (int k = 0; k < kLanes; ++k) {
        const std::size_t i = first + static_cast<std::size_t>((e.which >> k & 1) != 0 ? k : any);
        e.p.set(k, dvec3(points.position(i)));
        face.set(k, dvec3(points.normal(i)));
        share[1][k] = points.u[i], share[2][k] = points.v[i];
        const TriangleId t = points.triangle[i];
        if (smooth)
            for (int c = 0; c < 3; ++c) corner[c].set(k, dvec3(scene_->normals[scene_->triangles[t][c]]));
        e.object[k]        = scene_->triangle_object[t];
        const Terms& terms = terms_[e.object[k]];
        e.diffuse.set(k, terms.diffuse), e.specular.set(k, terms.specular), e.sum.set(k, terms.unshadowed);
        e.is_specular[k] = terms.is_specular ? 1 : 0;
    }
    if (smooth) {  // see corner_normals
        Lanes agreement{}, one;
        for (const Lanes3& c : corner) {
            dots(c, face, one);
            for (int k = 0; k < kLanes; ++k) agreement[k] += one[k];
        }
        for (Lanes3& c : corner)
            for (int k = 0; k < kLanes; ++k) {
                const bool none = (c.x[k] == 0) & (c.y[k] == 0) & (c.z[k] == 0);
                const double x = agreement[k] < 0 ? -c.x[k] : c.x[k], y = agreement[k] < 0 ? -c.y[k] : c.y[k],
                             z = agreement[k] < 0 ? -c.z[k] : c.z[k];
                c.x[k] = none ? face.x[k] : x, c.y[k] = none ? face.y[k] : y, c.z[k] = none ? face.z[k] : z;
            }
    } else {
        for (Lanes3& c : corner) c = face;
    }
    for (int k = 0; k < kLanes; ++k) share[0][k] = 1 - share[1][k] - share[2][k];
    Lanes squares;
    for (int k = 0; k < kLanes; ++k) {
        e.n.x[k] = 0.0 + share[0][k] * corner[0].x[k] + share[1][k] * corner[1].x[k] + share[2][k] * corner[2].x[k];
        e.n.y[k] = 0.0 + share[0][k] * corner[0].y[k] + share[1][k] * corner[1].y[k] + share[2][k] * corner[2].y[k];
        e.n.z[k] = 0.0 + share[0][k] * corner[0].z[k] + share[1][k] * corner[1].z[k] + share[2][k] * corner[2].z[k];
    }
    dots(e.n, e.n, squares);
    for (int k = 0; k < kLanes; ++k) {
        const double length = std::sqrt(squares[k]);
        e.n.x[k]            = length > 0 ? e.n.x[k] / length : face.x[k];
        e.n.y[k]            = length > 0 ? e.n.y[k] / length : face.y[k];
        e.n.z[k]            = length > 0 ? e.n.z[k] / length : face.z[k];
    }
    const dvec3 eye(points.eye);
    for (int k = 0; k < kLanes; ++k) {
        e.v.x[k] = constant_v_ ? backward_.x : eye.x - e.p.x[k];
        e.v.y[k] = constant_v_ ? backward_.y : eye.y - e.p.y[k];
        e.v.z[k] = constant_v_ ? backward_.z : eye.z - e.p.z[k];
    }
    dots(e.v, e.v, squares);
    for (int k = 0; k < kLanes; ++k) {
        const double over = 1 / std::sqrt(squares[k]);
        e.v.x[k] *= over, e.v.y[k] *= over, e.v.z[k] *= over;
    }
}

/// S_j f_att,j I_j (k_d O_d (N.L) + k_s O_s (R.V)^n) of light j.
void PhongSum::add_light(std::size_t j, const PointBatch& points, std::size_t first, const VisibilityPlane& visibility,
                         Eight& e) const {
    const Light& light = scene_->lights[j];
    Lanes s;  // 0: nothing to add
    bool any = false;
    for (int k = 0; k < kLanes; ++k) {
        const std::size_t i = first + static_cast<std::size_t>(k);
        s[k]                = 0;
        if ((e.which >> k & 1) == 0 || points.facing[j][i] == Facing::away || !lights(j, e.object[k])) continue;
        s[k] = visibility.defined(i) ? visibility.s[i] : 1.0f;
        any |= s[k] > 0;
    }
    if (!any) return;

    // As to_light, whose answers are floats.
    Lanes3 l;
    Lanes distance, length, cosine, factor;
    if (light.kind == LightKind::directional) {
        const ToLight to = to_light(light, vec3(0));
        for (int k = 0; k < kLanes; ++k) l.set(k, dvec3(to.direction)), distance[k] = HUGE_VAL;
    } else {
        const dvec3 at(light.position);
        for (int k = 0; k < kLanes; ++k) l.x[k] = at.x - e.p.x[k], l.y[k] = at.y - e.p.y[k], l.z[k] = at.z - e.p.z[k];
        dots(l, l, distance);
        for (int k = 0; k < kLanes; ++k) {
            const double d = std::sqrt(distance[k]);
            l.x[k]         = static_cast<double>(static_cast<float>(d == 0 ? 0 : l.x[k] / d));
            l.y[k]         = static_cast<double>(static_cast<float>(d == 0 ? 0 : l.y[k] / d));
            l.z[k]         = static_cast<double>(static_cast<float>(d == 0 ? 0 : l.z[k] / d));
            distance[k]    = static_cast<double>(static_cast<float>(d));
        }
    }
    dots(l, l, length);
    for (int k = 0; k < kLanes; ++k) {
        length[k]         = std::sqrt(length[k]);
        const double safe = length[k] > 0 ? length[k] : 1;
        l.x[k] /= safe, l.y[k] /= safe, l.z[k] /= safe;
    }
    dots(e.n, l, cosine);
    for (int k = 0; k < kLanes; ++k) s[k] = ((length[k] > 0) & (cosine[k] > 0)) ? s[k] : 0;

    if (light.kind == LightKind::spot || light.photometry) {
        for (int k = 0; k < kLanes; ++k)
            factor[k] = s[k] > 0
                            ? static_cast<double>(falloff(light, points.position(first + static_cast<std::size_t>(k))))
                            : 0;
    } else {
        for (int k = 0; k < kLanes; ++k)
            factor[k] =
                s[k] > 0 && !(light.range > 0 && distance[k] > static_cast<double>(light.range))
                    ? static_cast<double>(attenuation_factor(light.attenuation, static_cast<float>(distance[k])))
                    : 0;
    }
    for (int k = 0; k < kLanes; ++k) s[k] = factor[k] > 0 ? s[k] : 0;

    Lanes lobe{};
    if (light.specular != vec3(0) && std::ranges::any_of(e.is_specular, [](double x) { return x != 0; })) {
        const auto material = [&](int k) -> const Material& {
            return scene_->materials[scene_->objects[e.object[k]].material];
        };
        Lanes3 r, h;
        Lanes phong, blinn, half;
        for (int k = 0; k < kLanes; ++k) {
            const double twice = 2 * cosine[k];
            r.x[k] = twice * e.n.x[k] - l.x[k], r.y[k] = twice * e.n.y[k] - l.y[k], r.z[k] = twice * e.n.z[k] - l.z[k];
            h.x[k] = l.x[k] + e.v.x[k], h.y[k] = l.y[k] + e.v.y[k], h.z[k] = l.z[k] + e.v.z[k];
        }
        dots(r, e.v, phong), dots(h, h, half), dots(e.n, h, blinn);
        const Material* first_of = nullptr;  // and of all, mostly
        bool is_one              = true;
        for (int k = 0; k < kLanes; ++k) {
            if (!(s[k] > 0) || e.is_specular[k] == 0) continue;
            const Material& m   = material(k);
            const double height = std::sqrt(half[k]);
            const double angle  = m.lobe == Lobe::phong ? phong[k] : height > 0 ? blinn[k] / height : 0;
            lobe[k]             = std::clamp(angle, 0.0, 1.0);
            if (first_of == nullptr) first_of = &m;
            is_one &= &m == first_of;
        }
        if (first_of != nullptr && is_one && is_whole_power(first_of->shininess)) {
            whole_power<kLanes>(std::data(lobe), first_of->shininess);
        } else {
            for (int k = 0; k < kLanes; ++k)
                if (s[k] > 0 && e.is_specular[k] != 0) lobe[k] = lobe_power(lobe[k], material(k).shininess);
        }
    }
    const auto add = [&](Lanes& sum, const Lanes& diffuse, const Lanes& specular, float i_diffuse, float i_specular) {
        const auto d = static_cast<double>(i_diffuse), g = static_cast<double>(i_specular);
        for (int k = 0; k < kLanes; ++k) {
            const double matte     = d * diffuse[k] * cosine[k];
            const double reflected = e.is_specular[k] != 0 ? matte + g * specular[k] * lobe[k] : matte;
            sum[k] += s[k] > 0 ? s[k] * (factor[k] * reflected) : 0;
        }
    };
    add(e.sum.x, e.diffuse.x, e.specular.x, light.diffuse.x, light.specular.x);
    add(e.sum.y, e.diffuse.y, e.specular.y, light.diffuse.y, light.specular.y);
    add(e.sum.z, e.diffuse.z, e.specular.z, light.diffuse.z, light.specular.z);
}

void PhongSum::at_eight(const PointBatch& points, std::size_t first, unsigned which,
                        std::span<const VisibilityPlane> visibility, float* rgb) const {
    constexpr double kLargest = std::numeric_limits<float>::max();
    const auto write          = [&](int k, dvec3 light) {
        for (int c = 0; c < 3; ++c)
            rgb[3 * (first + static_cast<std::size_t>(k)) + static_cast<std::size_t>(c)] =
                static_cast<float>(std::min(light[c], kLargest));
    };
    Eight e;
    e.which = 0;
    for (int k = 0; k < kLanes; ++k) {
        if ((which >> k & 1) == 0) continue;
        if (points.triangle[first + static_cast<std::size_t>(k)] != kNoTriangle)
            e.which |= 1u << k;
        else
            write(k, scene_->background);
    }
    if (e.which == 0) return;
    load_surfaces(points, first, e);
    for (std::size_t j = 0; j < scene_->lights.size(); ++j) add_light(j, points, first, visibility[j], e);
    for (int k = 0; k < kLanes; ++k)
        if ((e.which >> k & 1) != 0) write(k, {e.sum.x[k], e.sum.y[k], e.sum.z[k]});
}

}  // namespace umbra
