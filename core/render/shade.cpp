// The sum: I = I_e + I_a k_a O_d + sum_j S_j f_att,j I_j ( k_d O_d (N.L_j) + k_s O_s (R_j.V)^n ), and its display.
//
// This work is based on:
// Bui Tuong Phong. Illumination for Computer Generated Pictures. 1975
// James Blinn. Models of Light Reflection for Computer Synthesized Pictures. 1977
#include "umbra/core/render/shade.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

/// What of a material is the same at all its points.
struct Prepared {
    dvec3 unshadowed;  // I_e + I_a k_a O_d: no light can be blocked from it
    dvec3 diffuse;     // k_d O_d
    dvec3 specular;    // k_s O_s
    bool is_specular;
};

std::vector<Prepared> prepare(const Scene& scene) {
    dvec3 ambient = scene.ambient;
    for (const Light& light : scene.lights) ambient += dvec3(light.ambient);
    std::vector<Prepared> prepared;
    for (const Material& m : scene.materials) {
        const dvec3 specular = dvec3(m.k_s) * dvec3(m.O_s);
        prepared.push_back({.unshadowed  = dvec3(m.emission) + ambient * dvec3(m.k_a) * dvec3(m.O_d),
                            .diffuse     = dvec3(m.k_d) * dvec3(m.O_d),
                            .specular    = specular,
                            .is_specular = specular != dvec3(0)});
    }
    return prepared;
}

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

/// f_att I_j (k_d O_d (N.L) + k_s O_s lobe): what light j would give if nothing blocked it.
dvec3 unblocked(const Light& light, const Material& material, const Prepared& prepared, vec3 p, dvec3 n, dvec3 v) {
    const dvec3 towards = to_light(light, p).direction;
    const double length = glm::length(towards);
    if (!(length > 0)) return dvec3(0);  // the light is at p
    const dvec3 l       = towards / length;
    const double cosine = glm::dot(n, l);
    if (cosine <= 0) return dvec3(0);
    const double f_att = falloff(light, p);
    if (f_att <= 0) return dvec3(0);
    dvec3 reflected = dvec3(light.diffuse) * prepared.diffuse * cosine;
    if (prepared.is_specular && light.specular != vec3(0))
        reflected += dvec3(light.specular) * prepared.specular * specular_lobe(material, n, l, v);
    return f_att * reflected;
}

float to_float(double x) { return float(std::min(x, double(std::numeric_limits<float>::max()))); }

/// Identity up to the knee, then a hyperbola that leaves it with slope 1 and nears 1. A function of the value alone
/// and not of the image, so that equal light looks equal in two pictures.
float compressed(float x) {
    constexpr float kKnee = 0.8f;
    if (x <= kKnee) return x;
    if (std::isinf(x)) return 1;
    const float t = (x - kKnee) / (1 - kKnee);
    return kKnee + (1 - kKnee) * (t / (1 + t));
}

}  // namespace

dvec3 shading_normal(const Scene& scene, const PointBatch& points, std::size_t i) {
    const dvec3 face = points.normal(i);
    if (scene.normals.empty()) return face;
    const uvec3 corners  = scene.triangles[points.triangle[i]];
    const double u       = points.u[i];
    const double v       = points.v[i];
    const double share[] = {1 - u - v, u, v};
    // The side is chosen for the triangle as a whole: one corner of a sharp tip may well point away from a face.
    double agreement = 0;
    for (int k = 0; k < 3; ++k) agreement += glm::dot(dvec3(scene.normals[corners[k]]), face);
    dvec3 sum(0);
    for (int k = 0; k < 3; ++k) {
        const dvec3 n = scene.normals[corners[k]];
        sum += share[k] * (n == dvec3(0) ? face : agreement < 0 ? -n : n);
    }
    const double length = glm::length(sum);
    return length > 0 ? sum / length : face;
}

Image shade(const Scene& scene, const PointBatch& points, std::span<const VisibilityPlane> visibility) {
    if (!points.raster) throw std::logic_error("shade: the batch has no raster");
    if (visibility.size() != scene.lights.size() || points.facing.size() != scene.lights.size())
        throw std::logic_error("shade: one plane of S_j and one of facings are needed for each light");
    for (const VisibilityPlane& plane : visibility)
        if (plane.s.size() != points.size() || plane.answer.size() != points.size())
            throw std::logic_error("shade: a plane of S_j has another size than the batch");

    const std::vector<Prepared> prepared = prepare(scene);
    const CameraFrame& camera            = *points.raster;
    // An eye at infinity sees every point from the same side.
    const bool constant_v = !scene.local_viewer || camera.projection == Projection::orthographic;

    Image image(camera.width, camera.height, {"R", "G", "B"});
    parallel_ranges(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            dvec3 sum = scene.background;
            if (points.triangle[i] != kNoTriangle) {
                const Object& object     = scene.objects[scene.triangle_object[points.triangle[i]]];
                const Material& material = scene.materials[object.material];
                const Prepared& terms    = prepared[object.material];
                const vec3 p             = points.position(i);
                const dvec3 n            = shading_normal(scene, points, i);
                const dvec3 v            = glm::normalize(constant_v ? -camera.forward : dvec3(points.eye) - dvec3(p));

                sum = terms.unshadowed;
                for (std::size_t j = 0; j < scene.lights.size(); ++j) {
                    if (points.facing[j][i] == Facing::away) continue;  // S_j = 0
                    const double s_j = visibility[j].defined(i) ? visibility[j].s[i] : 1.0f;
                    if (s_j > 0) sum += s_j * unblocked(scene.lights[j], material, terms, p, n, v);
                }
            }
            for (int c = 0; c < 3; ++c) image.at(i, std::size_t(c)) = to_float(sum[c]);
        }
    });
    return image;
}

Image displayed(const Image& linear, ToneMap tone, float exposure) {
    if (linear.channels.size() < 3) throw std::logic_error("displayed: the image has no R, G, B");
    Image display(linear.width, linear.height, {"R", "G", "B"});
    display.metadata = linear.metadata;

    float largest = 1;
    for (std::size_t i = 0; i < linear.pixels(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float x    = exposure * linear.at(i, c);
            display.at(i, c) = x > 0 ? x : 0;  // NaN too
            if (std::isfinite(x)) largest = std::max(largest, x);
        }
    }
    parallel_ranges(display.pixels(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            float* const rgb = &display.data[3 * i];
            const float peak = std::max({rgb[0], rgb[1], rgb[2]});
            for (std::size_t c = 0; c < 3; ++c) {
                float x = rgb[c];
                if (tone == ToneMap::divide) x /= largest;
                if (tone == ToneMap::hue && peak > 0 && std::isfinite(peak)) x *= compressed(peak) / peak;
                rgb[c] = srgb_from_linear(std::min(x, 1.0f));
            }
        }
    });
    return display;
}

}  // namespace umbra
