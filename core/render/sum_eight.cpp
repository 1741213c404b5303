// The sum at eight points at a time: the operations of PhongSum::at in their order, in loops over lanes that compilers
// make vector code of, so that the bits are the same. Exponentials alone are taken one by one.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "umbra/core/base/lanes.h"
#include "umbra/core/render/lobe_power.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/render/sum.h"
#include "umbra/core/scene/attenuation.h"

namespace umbra {
namespace {

constexpr unsigned kAll   = (1u << kLanes) - 1;
constexpr double kLargest = std::numeric_limits<float>::max();
using Doubles             = LaneArray<double>;

void fill(Doubles& to, double x) {
#pragma GCC unroll 1
    for (int k = 0; k < kLanes; ++k) to[k] = x;
}

void widen(const std::vector<float>& from, std::size_t first, Doubles& to) {
    const float* const x = from.data() + first;
#pragma GCC unroll 1
    for (int k = 0; k < kLanes; ++k) to[k] = static_cast<double>(x[k]);
}

void narrow(const Doubles& from, float (&to)[kLanes]) {
#pragma GCC unroll 1
    for (int k = 0; k < kLanes; ++k) to[k] = static_cast<float>(std::min(from[k], kLargest));
}

struct Lanes3 {
    Doubles x, y, z;
    void set(int k, dvec3 v) { x[k] = v.x, y[k] = v.y, z[k] = v.z; }
    void fill(dvec3 v) { umbra::fill(x, v.x), umbra::fill(y, v.y), umbra::fill(z, v.z); }
};

void dots(const Lanes3& a, const Lanes3& b, Doubles& to) {
#pragma GCC unroll 1
    for (int k = 0; k < kLanes; ++k) to[k] = a.x[k] * b.x[k] + a.y[k] * b.y[k] + a.z[k] * b.z[k];
}

/// Has the processor load the data of triangles that the points after the eight from `first` on need; they may be
/// anywhere in a large mesh. Changes no result.
void load_ahead(const Scene& scene, const PointBatch& points, std::size_t first) {
    if (first + 3 * kLanes > points.size()) return;
    const TriangleId* const next = points.triangle.data() + first + kLanes;
    for (int k = 0; k < kLanes; ++k) {
        if (const TriangleId t = next[kLanes + k]; t != kNoTriangle) {
            __builtin_prefetch(&scene.triangles[t]);
            __builtin_prefetch(&scene.triangle_object[t]);
        }
        if (const TriangleId t = next[k]; t != kNoTriangle && !scene.normals.empty())
            for (int c = 0; c < 3; ++c) __builtin_prefetch(&scene.normals[scene.triangles[t][c]]);
    }
    asm volatile("");  // g++ drops calls of functions that only prefetch
}

}  // namespace

/// Eight points, those without a surface among them with the numbers of another.
struct PhongSum::Eight {
    unsigned which = 0;  ///< bit k: the sum is asked for, and there is a surface
    Lanes3 p, n, v;
    std::uint32_t object[kLanes]{};
    Lanes3 diffuse, specular, sum;
    Doubles is_specular;

    /// k, or where that is none of them, the first that is one.
    [[nodiscard]] std::size_t lane(int k) const {
        return static_cast<std::size_t>((which >> k & 1) != 0 ? k : std::countr_zero(which));
    }
};

bool PhongSum::has_lanes(std::span<const VisibilityPlane> visibility) const {
    return scene_->fog.law == FogLaw::none && !scene_->fog.dims_lights && !attenuated_ambient_ &&
           std::ranges::all_of(scene_->materials, [](const Material& m) { return m.lobes.empty(); }) &&
           std::ranges::all_of(visibility, [](const VisibilityPlane& plane) { return plane.colour.empty(); });
}

// The next and add_light are compiled apart: in one function, g++ makes no vector code of half of their loops.
/// Positions, normals, directions to the eye, and the terms of the objects.
UMBRA_FOR_EACH_PROCESSOR void PhongSum::load_surfaces(const PointBatch& points, std::size_t first, Eight& e) const {
    Lanes3 face, corner[3];
    Doubles share[3];
    if (e.which == kAll) {
        widen(points.px, first, e.p.x), widen(points.py, first, e.p.y), widen(points.pz, first, e.p.z);
        widen(points.nx, first, face.x), widen(points.ny, first, face.y), widen(points.nz, first, face.z);
        widen(points.u, first, share[1]), widen(points.v, first, share[2]);
    } else {
        for (int k = 0; k < kLanes; ++k) {
            const std::size_t i = first + e.lane(k);
            e.p.set(k, dvec3(points.position(i)));
            face.set(k, dvec3(points.normal(i)));
            share[1][k] = points.u[i], share[2][k] = points.v[i];
        }
    }

    const bool smooth       = !scene_->normals.empty();
    const TriangleId common = points.triangle[first + e.lane(0)];
    bool same               = true;
    for (int k = 0; k < kLanes; ++k) same &= points.triangle[first + e.lane(k)] == common;
    if (same) {  // as mostly
        const std::uint32_t object = scene_->triangle_object[common];
        const Terms& terms         = terms_[object];
        std::fill_n(e.object, kLanes, object);
        e.diffuse.fill(terms.diffuse), e.specular.fill(terms.specular), e.sum.fill(terms.unshadowed);
        fill(e.is_specular, terms.is_specular ? 1 : 0);
        if (smooth)
            for (int c = 0; c < 3; ++c) corner[c].fill(dvec3(scene_->normals[scene_->triangles[common][c]]));
    } else {
        load_ahead(*scene_, points, first);
        for (int k = 0; k < kLanes; ++k) {
            const TriangleId t = points.triangle[first + e.lane(k)];
            if (smooth)
                for (int c = 0; c < 3; ++c) corner[c].set(k, dvec3(scene_->normals[scene_->triangles[t][c]]));
            e.object[k]        = scene_->triangle_object[t];
            const Terms& terms = terms_[e.object[k]];
            e.diffuse.set(k, terms.diffuse), e.specular.set(k, terms.specular), e.sum.set(k, terms.unshadowed);
            e.is_specular[k] = terms.is_specular ? 1 : 0;
        }
    }
    if (smooth) {  // see corner_normals
        Doubles agreement{}, one;
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
#pragma GCC unroll 1
    for (int k = 0; k < kLanes; ++k) share[0][k] = 1 - share[1][k] - share[2][k];
    Doubles squares;
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

/// S_j of light j, 0 where it has nothing to add; false where that is so of all eight.
bool PhongSum::load_visibility(std::size_t j, const PointBatch& points, std::size_t first,
                               const VisibilityPlane& visibility, const Eight& e, Doubles& s) const {
    const Facing* const facing = points.facing[j].data() + first;
    const Answer* const answer = visibility.answer.data() + first;
    const auto all             = [](const auto* bytes, auto value) {
        return std::all_of(bytes, bytes + kLanes, [value](auto byte) { return byte == value; });
    };
    bool any = false;
    if (e.which == kAll && left_out_.empty()) {  // as mostly
        if (all(facing, Facing::away)) return false;
        if (all(facing, Facing::front) && all(answer, Answer::given)) {
            widen(visibility.s, first, s);
            for (const double x : s) any |= x > 0;
            return any;
        }
    }
    for (int k = 0; k < kLanes; ++k) {
        const std::size_t i = first + static_cast<std::size_t>(k);
        s[k]                = 0;
        if ((e.which >> k & 1) == 0 || points.facing[j][i] == Facing::away || !lights(j, e.object[k])) continue;
        s[k] = visibility.defined(i) ? visibility.s[i] : 1.0f;
        any |= s[k] > 0;
    }
    return any;
}

/// S_j f_att,j I_j (k_d O_d (N.L) + k_s O_s (R.V)^n) of light j.
UMBRA_FOR_EACH_PROCESSOR void PhongSum::add_light(std::size_t j, const PointBatch& points, std::size_t first,
                                                  const VisibilityPlane& visibility, Eight& e) const {
    const Light& light = scene_->lights[j];
    Doubles s;  // 0: nothing to add
    if (!load_visibility(j, points, first, visibility, e, s)) return;

    // As to_light, whose answers are floats.
    Lanes3 l;
    Doubles distance, length, cosine, factor;
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
#pragma GCC unroll 1
    for (int k = 0; k < kLanes; ++k) s[k] = ((length[k] > 0) & (cosine[k] > 0)) ? s[k] : 0;

    if (light.kind == LightKind::spot || light.photometry) {
        for (int k = 0; k < kLanes; ++k)
            factor[k] = s[k] > 0
                            ? static_cast<double>(falloff(light, points.position(first + static_cast<std::size_t>(k))))
                            : 0;
    } else {
        const double range = light.range > 0 ? static_cast<double>(light.range) : HUGE_VAL;
#pragma GCC unroll 1
        for (int k = 0; k < kLanes; ++k) {
            const double here = attenuation_at(light.attenuation, distance[k]);
            factor[k]         = distance[k] <= range ? here : 0;
        }
    }
#pragma GCC unroll 1
    for (int k = 0; k < kLanes; ++k) s[k] = factor[k] > 0 ? s[k] : 0;

    Doubles lobe{};
    if (light.specular != vec3(0) && std::ranges::any_of(e.is_specular, [](double x) { return x != 0; })) {
        const auto material = [&](int k) -> const Material& {
            return scene_->materials[scene_->objects[e.object[k]].material];
        };
        Lanes3 r, h;
        Doubles phong, blinn, half;
        for (int k = 0; k < kLanes; ++k) {
            const double twice = 2 * cosine[k];
            r.x[k] = twice * e.n.x[k] - l.x[k], r.y[k] = twice * e.n.y[k] - l.y[k], r.z[k] = twice * e.n.z[k] - l.z[k];
            h.x[k] = l.x[k] + e.v.x[k], h.y[k] = l.y[k] + e.v.y[k], h.z[k] = l.z[k] + e.v.z[k];
        }
        dots(r, e.v, phong), dots(h, h, half), dots(e.n, h, blinn);
        const bool is_one = std::ranges::all_of(e.object, [&](std::uint32_t o) { return o == e.object[0]; });
        if (const Material& m = material(0); is_one && is_whole_power(m.shininess)) {  // as mostly
            if (m.lobe == Lobe::phong) {
                for (int k = 0; k < kLanes; ++k) lobe[k] = std::min(std::max(phong[k], 0.0), 1.0);
            } else {
#pragma GCC unroll 1
                for (int k = 0; k < kLanes; ++k) {
                    const double angle = half[k] > 0 ? blinn[k] / std::sqrt(half[k]) : 0;
                    lobe[k]            = std::min(std::max(angle, 0.0), 1.0);
                }
            }
            whole_power<kLanes>(std::data(lobe), m.shininess);
        } else {
            for (int k = 0; k < kLanes; ++k) {
                if (!(s[k] > 0) || e.is_specular[k] == 0) continue;
                const Material& own = material(k);
                const double height = std::sqrt(half[k]);
                const double angle  = own.lobe == Lobe::phong ? phong[k] : height > 0 ? blinn[k] / height : 0;
                lobe[k]             = lobe_power(std::clamp(angle, 0.0, 1.0), own.shininess);
            }
        }
    }
    const auto add = [&](Doubles& sum, const Doubles& diffuse, const Doubles& specular, float i_diffuse,
                         float i_specular) {
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
    const auto write = [&](int k, float r, float g, float b) {
        float* const to = rgb + 3 * (first + static_cast<std::size_t>(k));
        to[0] = r, to[1] = g, to[2] = b;
    };
    const vec3 behind = glm::min(scene_->background, vec3(std::numeric_limits<float>::max()));
    Eight e;
    e.which = 0;
    for (int k = 0; k < kLanes; ++k) {
        if ((which >> k & 1) == 0) continue;
        if (points.triangle[first + static_cast<std::size_t>(k)] != kNoTriangle)
            e.which |= 1u << k;
        else
            write(k, behind.r, behind.g, behind.b);
    }
    if (e.which == 0) return;
    load_surfaces(points, first, e);
    for (std::size_t j = 0; j < scene_->lights.size(); ++j) add_light(j, points, first, visibility[j], e);
    float r[kLanes], g[kLanes], b[kLanes];
    narrow(e.sum.x, r), narrow(e.sum.y, g), narrow(e.sum.z, b);
    for (int k = 0; k < kLanes; ++k)
        if ((e.which >> k & 1) != 0) write(k, r[k], g[k], b[k]);
}

}  // namespace umbra
