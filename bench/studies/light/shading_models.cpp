#include "umbra/bench/studies/light/shading_models.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "umbra/bench/studies/light/fast_phong.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/render/sum.h"

namespace umbra {
namespace {

/// Points at which the sum is asked, with their normals, and where each of them belongs.
struct Evaluations {
    PointBatch points;
    std::vector<dvec3> normals;

    explicit Evaluations(const PointBatch& picture) { points.eye = vec3(picture.raster->eye); }

    std::size_t add(const PointBatch& picture, std::size_t pixel) {
        const std::size_t at = next();
        points.triangle[at] = picture.triangle[pixel], points.flipped[at] = picture.flipped[pixel];
        points.u[at] = picture.u[pixel], points.v[at] = picture.v[pixel];
        points.px[at] = picture.px[pixel], points.py[at] = picture.py[pixel], points.pz[at] = picture.pz[pixel];
        points.nx[at] = picture.nx[pixel], points.ny[at] = picture.ny[pixel], points.nz[at] = picture.nz[pixel];
        return at;
    }
    /// A point of the triangle that a pixel shows, seen from the same side.
    std::size_t add(const Scene& scene, const PointBatch& picture, std::size_t pixel, float u, float v) {
        const std::size_t at = next();
        const TriangleId t   = picture.triangle[pixel];
        set_point(points, at, scene, t, u, v);
        points.flipped[at] = picture.flipped[pixel];
        points.nx[at] = picture.nx[pixel], points.ny[at] = picture.ny[pixel], points.nz[at] = picture.nz[pixel];
        normals.emplace_back(picture.normal(pixel));
        return at;
    }

    /// The sum at each of them.
    [[nodiscard]] std::vector<dvec3> sums(const Scene& scene, const CameraFrame& camera, const AskVisibility& ask) {
        points.resize(used_);
        face_lights(points, scene);
        const std::vector<VisibilityPlane> visibility = ask(points);
        const PhongSum sum(scene, camera);
        std::vector<dvec3> light(used_);
        for (std::size_t i = 0; i < used_; ++i) light[i] = sum.at(points, i, normals[i], visibility);
        return light;
    }
    [[nodiscard]] std::size_t size() const { return used_; }

private:
    std::size_t next() {
        if (used_ == points.size()) points.resize(std::max<std::size_t>(1024, 2 * used_));
        return used_++;
    }
    std::size_t used_ = 0;
};

/// R G B: `light_at(i)` at each pixel with a surface, the scene's background elsewhere.
template <class LightAt>
Image painted(const Scene& scene, const PointBatch& points, const LightAt& light_at) {
    Image linear(points.raster->width, points.raster->height, {"R", "G", "B"});
    for (std::size_t i = 0; i < points.size(); ++i)
        write_light(linear, i, points.triangle[i] == kNoTriangle ? dvec3(scene.background) : light_at(i));
    return linear;
}

ShadedPicture constant(const Scene& scene, const PointBatch& points) {
    const PhongSum sum(scene, *points.raster);
    std::map<SideKey, dvec3> values;
    Image linear = painted(scene, points, [&](std::size_t i) {
        const auto [entry, is_new] = values.try_emplace(side_of(points, i));
        if (is_new)
            entry->second =
                sum.from_the_eye(points.triangle[i], -glm::dot(dvec3(points.normal(i)), dvec3(points.raster->forward)));
        return entry->second;
    });
    return {std::move(linear), values.size()};
}

ShadedPicture flat(const Scene& scene, const PointBatch& points, const AskVisibility& ask) {
    Evaluations evaluations(points);
    std::map<SideKey, std::size_t> centres;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        const auto [entry, is_new] = centres.try_emplace(side_of(points, i));
        if (is_new) entry->second = evaluations.add(scene, points, i, 1.0f / 3, 1.0f / 3);
    }
    const std::vector<dvec3> light = evaluations.sums(scene, *points.raster, ask);
    return {painted(scene, points, [&](std::size_t i) { return light[centres.at(side_of(points, i))]; }),
            evaluations.size()};
}

/// Weights of a triangle's corners that are linear in the picture, from those that are linear in space.
std::array<double, 3> in_the_picture(const Scene& scene, const PointBatch& points, std::size_t i,
                                     std::array<double, 3> weights) {
    if (points.raster->projection == Projection::orthographic) return weights;
    std::array<double, 3> in_picture{};
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const dvec3 corner(scene.vertex(points.triangle[i], static_cast<int>(k)));
        const double depth = glm::dot(corner - points.raster->eye, points.raster->forward);
        if (!(depth > 0)) return weights;  // behind the eye there is no picture to be linear in
        in_picture[k] = weights[k] * depth;
        sum += in_picture[k];
    }
    for (double& weight : in_picture) weight /= sum;
    return in_picture;
}

ShadedPicture gouraud(const Scene& scene, const PointBatch& points, bool screen, const AskVisibility& ask) {
    Evaluations evaluations(points);
    // Triangles that share a vertex and its normal share the value there; a vertex without a normal has one a face.
    std::map<SideKey, std::array<std::size_t, 3>> corners;
    std::map<std::pair<std::uint32_t, std::uint8_t>, std::size_t> vertices;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const TriangleId t = points.triangle[i];
        if (t == kNoTriangle) continue;
        const auto [entry, is_new] = corners.try_emplace(side_of(points, i));
        if (!is_new) continue;
        const auto normals = corner_normals(scene, t, dvec3(points.normal(i)));
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = scene.triangles[t][static_cast<int>(k)];
            const bool shared          = !scene.normals.empty() && scene.normals[vertex] != vec3(0);
            const bool turned          = shared && glm::dot(normals[k], dvec3(scene.normals[vertex])) < 0;
            const auto found           = vertices.find({vertex, turned ? 1 : 0});
            if (shared && found != vertices.end()) {
                entry->second[k] = found->second;
                continue;
            }
            entry->second[k]           = evaluations.add(scene, points, i, k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f);
            evaluations.normals.back() = normals[k];
            if (shared) vertices[{vertex, turned ? 1 : 0}] = entry->second[k];
        }
    }
    const std::vector<dvec3> light = evaluations.sums(scene, *points.raster, ask);
    Image linear                   = painted(scene, points, [&](std::size_t i) {
        const double u = points.u[i], v = points.v[i];
        std::array<double, 3> weights{1 - u - v, u, v};
        if (screen) weights = in_the_picture(scene, points, i, weights);
        const auto& at = corners.at(side_of(points, i));
        return weights[0] * light[at[0]] + weights[1] * light[at[1]] + weights[2] * light[at[2]];
    });
    return {std::move(linear), evaluations.size()};
}

/// `normal(i)` of each pixel; `evaluates(i)`: whether the sum is evaluated there, or the mean of its neighbours.
template <class Normal, class Evaluates>
ShadedPicture by_pixel(const Scene& scene, const PointBatch& points, const AskVisibility& ask, const Normal& normal,
                       const Evaluates& evaluates) {
    Evaluations evaluations(points);
    std::vector<std::size_t> at(points.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle || !evaluates(i)) continue;
        at[i] = evaluations.add(points, i);
        evaluations.normals.push_back(normal(i));
    }
    const std::vector<dvec3> light = evaluations.sums(scene, *points.raster, ask);
    Image linear                   = painted(scene, points, [&](std::size_t i) {
        return evaluates(i) ? light[at[i]] : 0.5 * (light[at[i - 1]] + light[at[i + 1]]);
    });
    return {std::move(linear), evaluations.size()};
}

/// Angles from elsewhere, S_j and the sum at each pixel. Lafortune's lobes need directions, and have the sum itself.
ShadedPicture fast(const Scene& scene, const PointBatch& points, const PictureCosines& cosines,
                   const AskVisibility& ask) {
    const std::vector<VisibilityPlane> visibility = ask(points);
    const PhongSum sum(scene, *points.raster);
    std::vector<LightCosines> here(scene.lights.size());
    Image linear = painted(scene, points, [&](std::size_t i) {
        if (!scene.material(points.triangle[i]).lobes.empty())
            return sum.at(points, i, shading_normal(scene, points, i), visibility);
        for (LightId j = 0; j < here.size(); ++j) here[j] = cosines.at[j][i];
        return sum.with_cosines(points, i, here, visibility);
    });
    return {std::move(linear), cosines.evaluations};
}

}  // namespace

dvec3 quadratic_normal(const std::array<dvec3, 3>& corners, const std::array<dvec3, 3>& normals, double u, double v) {
    const auto middle = [&](std::size_t i, std::size_t j) {
        const dvec3 d = corners[j] - corners[i], sum = normals[i] + normals[j];
        const double squared = glm::dot(d, d);
        const dvec3 b        = squared > 0 ? 3 * glm::dot(sum, d) / squared * d : dvec3(0);
        return 0.5 * sum - 0.25 * b;  // n0 + a / 2 + b / 4
    };
    const double w = 1 - u - v;
    const dvec3 n  = w * (2 * w - 1) * normals[0] + u * (2 * u - 1) * normals[1] + v * (2 * v - 1) * normals[2] +
                    4 * w * u * middle(0, 1) + 4 * u * v * middle(1, 2) + 4 * v * w * middle(2, 0);
    const double length = glm::length(n);
    return length > 0 ? n / length : normals[0];
}

ShadedPicture shade_by(ShadingModel model, const Scene& scene, const PointBatch& points, const AskVisibility& ask) {
    const auto width    = static_cast<std::size_t>(points.raster->width);
    const auto object   = [&](std::size_t i) { return scene.triangle_object[points.triangle[i]]; };
    const auto all      = [](std::size_t) { return true; };
    const auto linearly = [&](std::size_t i) { return shading_normal(scene, points, i); };
    switch (model) {
        case ShadingModel::constant: return constant(scene, points);
        case ShadingModel::flat: return flat(scene, points, ask);
        case ShadingModel::gouraud: return gouraud(scene, points, false, ask);
        case ShadingModel::gouraud_screen: return gouraud(scene, points, true, ask);
        case ShadingModel::highlight_test: return fast(scene, points, cosines_by_highlight_test(scene, points), ask);
        case ShadingModel::taylor: return fast(scene, points, cosines_by_taylor(scene, points), ask);
        case ShadingModel::differences: return fast(scene, points, cosines_by_differences(scene, points), ask);
        case ShadingModel::phong: return by_pixel(scene, points, ask, linearly, all);
        case ShadingModel::every_second:
            return by_pixel(scene, points, ask, linearly, [&](std::size_t i) {
                const std::size_t x = i % width;
                if (x % 2 == 0 || x + 1 == width) return true;
                return points.triangle[i - 1] == kNoTriangle || points.triangle[i + 1] == kNoTriangle ||
                       object(i - 1) != object(i) || object(i + 1) != object(i);
            });
        case ShadingModel::quadratic:
            return by_pixel(
                scene, points, ask,
                [&](std::size_t i) {
                    const TriangleId t = points.triangle[i];
                    const std::array<dvec3, 3> corners{dvec3(scene.vertex(t, 0)), dvec3(scene.vertex(t, 1)),
                                                       dvec3(scene.vertex(t, 2))};
                    return quadratic_normal(corners, corner_normals(scene, t, dvec3(points.normal(i))),
                                            double(points.u[i]), double(points.v[i]));
                },
                all);
    }
    return {};
}

}  // namespace umbra
