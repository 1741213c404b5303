#include "umbra/bench/studies/light/fast_phong.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "umbra/core/render/brdf.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace {

/// Unit, or zero where there is no direction.
dvec3 unit(dvec3 d) {
    const double length = glm::length(d);
    return length > 0 ? d / length : dvec3(0);
}

/// A triangle as one of its sides is seen, with u and v as PointBatch has them.
class ShadedSide {
public:
    ShadedSide(const Scene& scene, const PointBatch& points, const PhongSum& sum, std::size_t pixel)
        : scene_(&scene),
          sum_(&sum),
          eye_(&points),
          material_(&scene.material(points.triangle[pixel])),
          normals_(corner_normals(scene, points.triangle[pixel], dvec3(points.normal(pixel)))) {
        for (int k = 0; k < 3; ++k)
            corners_[static_cast<std::size_t>(k)] = dvec3(scene.vertex(points.triangle[pixel], k));
    }

    [[nodiscard]] const Material& material() const { return *material_; }
    [[nodiscard]] dvec3 position(double u, double v) const { return blend(corners_, u, v); }
    /// Interpolated, of any length.
    [[nodiscard]] dvec3 normal(double u, double v) const { return blend(normals_, u, v); }
    [[nodiscard]] dvec3 to_light_at(LightId j, double u, double v) const {
        const Light& light = scene_->lights[j];  // in double, since differences of it are taken
        if (light.kind == LightKind::directional) return unit(-dvec3(light.direction));
        return unit(dvec3(light.position) - position(u, v));
    }
    [[nodiscard]] dvec3 to_viewer_at(double u, double v) const { return sum_->to_viewer_from(*eye_, position(u, v)); }
    [[nodiscard]] LightCosines cosines(LightId j, double u, double v) const {
        const dvec3 n = unit(normal(u, v)), l = to_light_at(j, u, v);
        return {glm::dot(n, l), lobe_cosine(*material_, n, l, to_viewer_at(u, v))};
    }

private:
    static dvec3 blend(const std::array<dvec3, 3>& of, double u, double v) {
        return (1 - u - v) * of[0] + u * of[1] + v * of[2];
    }

    const Scene* scene_;
    const PhongSum* sum_;
    const PointBatch* eye_;
    const Material* material_;
    std::array<dvec3, 3> normals_, corners_{};
};

constexpr double kMiddle                                   = 1.0 / 3;
constexpr std::array<std::pair<double, double>, 3> kCorner = {{{0, 0}, {1, 0}, {0, 1}}};

PictureCosines empty_cosines(const Scene& scene, const PointBatch& points) {
    return {std::vector(scene.lights.size(), std::vector<LightCosines>(points.size())), 0};
}

/// Calls visit(pixel, of) for every pixel with a surface, with what make(side) returns for the side that it shows.
template <class Make, class Visit>
std::size_t for_each_side(const Scene& scene, const PointBatch& points, const Make& make, const Visit& visit) {
    const PhongSum sum(scene, *points.raster);
    std::map<SideKey, decltype(make(std::declval<const ShadedSide&>()))> sides;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        auto found = sides.find(side_of(points, i));
        if (found == sides.end())
            found = sides.emplace(side_of(points, i), make(ShadedSide(scene, points, sum, i))).first;
        visit(i, found->second);
    }
    return sides.size();
}

/// A value that grows by a polynomial of second degree from pixel to pixel.
struct Quadratic {
    double value, step = 0, step_of_step = 0;
    void advance() { value += step, step += step_of_step; }
};
/// |a + k s|^2 for k = 0, 1, 2, ...
Quadratic squared_along(dvec3 a, dvec3 s) {
    const double ss = glm::dot(s, s);
    return {glm::dot(a, a), 2 * glm::dot(a, s) + ss, 2 * ss};
}

/// N.L and the lobe's cosine along a run of pixels, for constant directions.
class Run {
public:
    /// Normals of any length: `normal` at its first pixel, changing by `step` a pixel.
    Run(const Material& material, dvec3 normal, dvec3 step, dvec3 l, dvec3 v)
        : is_phong_(material.lobe == Lobe::phong),
          l_dot_v_(glm::dot(l, v)),
          squared_(squared_along(normal, step)),
          to_light_{glm::dot(normal, l), glm::dot(step, l)},
          to_other_{0} {
        const dvec3 other = is_phong_ ? v : unit(l + v);
        to_other_         = {glm::dot(normal, other), glm::dot(step, other)};
    }

    LightCosines next() {
        const double over = squared_.value > 0 ? 1 / std::sqrt(squared_.value) : 0;
        const double n_l = to_light_.value * over, n_other = to_other_.value * over;
        squared_.advance(), to_light_.advance(), to_other_.advance();
        return {n_l, is_phong_ ? 2 * n_l * n_other - l_dot_v_ : n_other};
    }

private:
    bool is_phong_;
    double l_dot_v_;
    Quadratic squared_, to_light_, to_other_;
};

/// A function over a triangle: its value and derivatives at the middle.
struct Polynomial {
    double value, u, v, uu, uv, vv;
    [[nodiscard]] double at(double x, double y) const {
        return value + u * x + v * y + 0.5 * (uu * x * x + vv * y * y) + uv * x * y;
    }
};
/// From the nine values f[1 + a][1 + b] at a and b steps of `h` from the middle.
Polynomial from_grid(const std::array<std::array<double, 3>, 3>& f, double h) {
    return {f[1][1],
            (f[2][1] - f[0][1]) / (2 * h),
            (f[1][2] - f[1][0]) / (2 * h),
            (f[2][1] - 2 * f[1][1] + f[0][1]) / (h * h),
            (f[2][2] - f[2][0] - f[0][2] + f[0][0]) / (4 * h * h),
            (f[1][2] - 2 * f[1][1] + f[1][0]) / (h * h)};
}

double angle_between(dvec3 a, dvec3 b) { return std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)); }

/// Whether the specular term of a light may reach `least` somewhere on a triangle.
bool may_shine(const ShadedSide& side, const Light& light, LightId j, double least) {
    const Material& m    = side.material();
    const dvec3 strength = dvec3(light.specular) * dvec3(m.k_s) * dvec3(glm::max(m.O_s, m.O_d));
    const double largest = std::max({strength.x, strength.y, strength.z});
    if (largest < least) return false;
    const dvec3 n = unit(side.normal(kMiddle, kMiddle)), l = side.to_light_at(j, kMiddle, kMiddle),
                v = side.to_viewer_at(kMiddle, kMiddle);
    double turn_n = 0, turn_l = 0, turn_v = 0;
    for (const auto& [x, y] : kCorner) {
        turn_n = std::max(turn_n, angle_between(n, unit(side.normal(x, y))));
        turn_l = std::max(turn_l, angle_between(l, side.to_light_at(j, x, y)));
        turn_v = std::max(turn_v, angle_between(v, side.to_viewer_at(x, y)));
    }
    // Directions over the triangle lie in these cones only where the cones are narrower than a right angle.
    if (std::max({turn_n, turn_l, turn_v}) > 1.5) return true;
    // R and V: H is the mirror of half that way, so that their angle is at most twice that of N and H.
    const double apart = angle_between(2 * glm::dot(n, l) * n - l, v) - 2 * turn_n - turn_l - turn_v;
    const double angle = std::max(0.0, m.lobe == Lobe::phong ? apart : apart / 2);
    if (angle >= kPi / 2) return false;
    return largest * std::pow(std::cos(angle), static_cast<double>(m.shininess)) >= least;
}

}  // namespace

PictureCosines cosines_by_differences(const Scene& scene, const PointBatch& points) {
    struct Directions {
        ShadedSide side;
        std::vector<dvec3> to_lights;
        dvec3 to_viewer;
    };
    PictureCosines cosines       = empty_cosines(scene, points);
    const auto width             = static_cast<std::size_t>(points.raster->width);
    const bool has_depth         = points.raster->projection == Projection::perspective;
    const auto normal_over_depth = [&](const ShadedSide& side, std::size_t i) {
        const dvec3 n = side.normal(static_cast<double>(points.u[i]), static_cast<double>(points.v[i]));
        if (!has_depth) return n;
        return n / glm::dot(exact_position(scene, points, i) - points.raster->eye, points.raster->forward);
    };
    std::size_t begun = 0;  // pixels before this one belong to a run that is done
    const auto make   = [&](const ShadedSide& side) {
        Directions directions{side, {}, side.to_viewer_at(kMiddle, kMiddle)};
        for (LightId j = 0; j < scene.lights.size(); ++j)
            directions.to_lights.push_back(side.to_light_at(j, kMiddle, kMiddle));
        return directions;
    };
    cosines.evaluations = for_each_side(scene, points, make, [&](std::size_t first, const Directions& of) {
        if (first < begun) return;
        std::size_t last = first;
        while ((last + 1) % width != 0 && side_of(points, last + 1) == side_of(points, first)) ++last;
        begun              = last + 1;
        const dvec3 normal = normal_over_depth(of.side, first);
        const dvec3 step =
            last > first ? (normal_over_depth(of.side, last) - normal) / static_cast<double>(last - first) : dvec3(0);
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            Run run(of.side.material(), normal, step, of.to_lights[j], of.to_viewer);
            for (std::size_t i = first; i <= last; ++i) cosines.at[j][i] = run.next();
        }
    });
    return cosines;
}

PictureCosines cosines_by_taylor(const Scene& scene, const PointBatch& points) {
    constexpr double kStep = 1e-3;  // the derivatives' error is of its square
    struct Polynomials {
        Polynomial diffuse, lobe;
    };
    PictureCosines cosines = empty_cosines(scene, points);
    const auto make        = [&](const ShadedSide& side) {
        std::vector<Polynomials> of;
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            std::array<std::array<double, 3>, 3> diffuse{}, lobe{};
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t b = 0; b < 3; ++b) {
                    const LightCosines c = side.cosines(j, kMiddle + kStep * (static_cast<double>(a) - 1),
                                                               kMiddle + kStep * (static_cast<double>(b) - 1));
                    diffuse[a][b] = c.diffuse, lobe[a][b] = c.lobe;
                }
            of.push_back({from_grid(diffuse, kStep), from_grid(lobe, kStep)});
        }
        return of;
    };
    cosines.evaluations = for_each_side(scene, points, make, [&](std::size_t i, const std::vector<Polynomials>& of) {
        const double x = static_cast<double>(points.u[i]) - kMiddle, y = static_cast<double>(points.v[i]) - kMiddle;
        for (LightId j = 0; j < of.size(); ++j) cosines.at[j][i] = {of[j].diffuse.at(x, y), of[j].lobe.at(x, y)};
    });
    return cosines;
}

PictureCosines cosines_by_highlight_test(const Scene& scene, const PointBatch& points, double least) {
    struct Corners {
        ShadedSide side;
        std::vector<std::array<double, 3>> diffuse;  // [light]
        std::vector<bool> shines;                    // [light]
    };
    PictureCosines cosines = empty_cosines(scene, points);
    const auto make        = [&](const ShadedSide& side) {
        Corners corners{side, {}, {}};
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            std::array<double, 3> diffuse{};
            for (std::size_t k = 0; k < 3; ++k)
                diffuse[k] = glm::dot(unit(side.normal(kCorner[k].first, kCorner[k].second)),
                                             side.to_light_at(j, kCorner[k].first, kCorner[k].second));
            corners.diffuse.push_back(diffuse);
            corners.shines.push_back(may_shine(side, scene.lights[j], j, least));
        }
        return corners;
    };
    std::size_t pixels = 0;
    const auto write   = [&](std::size_t i, const Corners& of) {
        const double u = points.u[i], v = points.v[i];
        bool any = false;
        for (LightId j = 0; j < of.diffuse.size(); ++j) {
            any = any || of.shines[j];
            cosines.at[j][i] =
                of.shines[j]
                      ? of.side.cosines(j, u, v)
                      : LightCosines{(1 - u - v) * of.diffuse[j][0] + u * of.diffuse[j][1] + v * of.diffuse[j][2], 0};
        }
        pixels += any ? 1 : 0;
    };
    const std::size_t sides = for_each_side(scene, points, make, write);
    cosines.evaluations     = 4 * sides + pixels;
    return cosines;
}

}  // namespace umbra
