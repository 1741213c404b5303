#include "umbra/core/render/shade.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/sum.h"

namespace umbra {
namespace {

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

std::array<dvec3, 3> corner_normals(const Scene& scene, TriangleId t, dvec3 face) {
    if (scene.normals.empty()) return {face, face, face};
    const uvec3 corners = scene.triangles[t];
    // The side is chosen for the triangle as a whole: one corner of a sharp tip may well point away from a face.
    double agreement = 0;
    for (int k = 0; k < 3; ++k) agreement += glm::dot(dvec3(scene.normals[corners[k]]), face);
    std::array<dvec3, 3> normals{};
    for (int k = 0; k < 3; ++k) {
        const dvec3 n                        = scene.normals[corners[k]];
        normals[static_cast<std::size_t>(k)] = n == dvec3(0) ? face : agreement < 0 ? -n : n;
    }
    return normals;
}

dvec3 shading_normal(const Scene& scene, const PointBatch& points, std::size_t i) {
    const dvec3 face   = points.normal(i);
    const auto corners = corner_normals(scene, points.triangle[i], face);
    const double u = points.u[i], v = points.v[i];
    const double share[] = {1 - u - v, u, v};
    dvec3 sum(0);
    for (std::size_t k = 0; k < 3; ++k) sum += share[k] * corners[k];
    const double length = glm::length(sum);
    return length > 0 ? sum / length : face;
}

namespace {

void check_planes(const Scene& scene, const PointBatch& points, std::span<const VisibilityPlane> visibility) {
    if (!points.raster) throw std::logic_error("shade: the batch has no raster");
    if (visibility.size() != scene.lights.size() || points.facing.size() != scene.lights.size())
        throw std::logic_error("shade: one plane of S_j and one of facings are needed for each light");
    for (const VisibilityPlane& plane : visibility)
        if (plane.s.size() != points.size() || plane.answer.size() != points.size())
            throw std::logic_error("shade: a plane of S_j has another size than the batch");
}

bool same_at(const VisibilityPlane& a, const VisibilityPlane& b, std::size_t i) {
    return a.answer[i] == b.answer[i] && a.s[i] == b.s[i] && a.colour.empty() == b.colour.empty() &&
           (a.colour.empty() || a.colour[i] == b.colour[i]);
}

/// The sum at each point for which `wanted` holds.
template <class Wanted>
void shade_some(const Scene& scene, const PointBatch& points, std::span<const VisibilityPlane> visibility, Image& image,
                const Wanted& wanted) {
    const PhongSum sum(scene, *points.raster);
    const bool lanes = sum.has_lanes(visibility);
    parallel_ranges((points.size() + 7) / 8, 128, [&](std::size_t begin, std::size_t end) {
        for (std::size_t eight = begin; eight < end; ++eight) {
            unsigned which = 0;
            for (std::size_t k = 0; k < std::min<std::size_t>(8, points.size() - 8 * eight); ++k)
                which |= wanted(8 * eight + k) ? 1u << k : 0;
            if (lanes) {
                if (which != 0) sum.at_eight(points, 8 * eight, which, visibility, image.data.data());
                continue;
            }
            for (std::size_t i = 8 * eight; which != 0; ++i, which >>= 1) {
                if ((which & 1) == 0) continue;
                dvec3 light = scene.background;
                if (points.triangle[i] != kNoTriangle)
                    light = sum.at(points, i, shading_normal(scene, points, i), visibility);
                write_light(image, i, light);
            }
        }
    });
}

}  // namespace

Image shade(const Scene& scene, const PointBatch& points, std::span<const VisibilityPlane> visibility) {
    check_planes(scene, points, visibility);
    Image image(points.raster->width, points.raster->height, {"R", "G", "B"});
    shade_some(scene, points, visibility, image, [](std::size_t) { return true; });
    return image;
}

Image shade(const Scene& scene, const PointBatch& points, std::span<const VisibilityPlane> visibility,
            std::span<const VisibilityPlane> known_visibility, const Image& known) {
    check_planes(scene, points, visibility);
    check_planes(scene, points, known_visibility);
    if (known.pixels() != points.size() || known.channels.size() != 3)
        throw std::logic_error("shade: the known picture has another size than the batch");
    Image image = known;
    shade_some(scene, points, visibility, image, [&](std::size_t i) {
        for (std::size_t j = 0; j < visibility.size(); ++j)
            if (!same_at(visibility[j], known_visibility[j], i)) return true;
        return false;
    });
    return image;
}

void write_light(Image& image, std::size_t pixel, dvec3 light) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    for (int c = 0; c < 3; ++c)
        image.at(pixel, static_cast<std::size_t>(c)) = static_cast<float>(std::min(light[c], kLargest));
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
