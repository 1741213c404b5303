#include "umbra/bench/studies/shading/stages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "umbra/bench/lab/antialias.h"
#include "umbra/bench/studies/light/shading_models.h"
#include "umbra/bench/studies/light/whitted.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/scene/topology.h"

namespace umbra {
namespace {

constexpr int kFine       = 2;     ///< samples along each side of a pixel of a drawing
constexpr double kFlat    = 1e-6;  ///< 1 - cosine of the angle between two faces below which they are one plane
constexpr double kNear    = 1e-4;  ///< where a segment that passes the eye is cut, of its length
constexpr double kInFront = 1e-3;  ///< how much farther than a surface an edge may be and still be seen, relative

/// Distance along the view of the surface at each point, infinite where there is none.
std::vector<double> depths_of(const PointBatch& points) {
    const CameraFrame& raster = *points.raster;
    std::vector<double> depths(points.size(), double(kInfinity));
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.triangle[i] != kNoTriangle)
            depths[i] = glm::dot(dvec3(points.position(i)) - raster.eye, raster.forward);
    return depths;
}

class Drawing {
public:
    Drawing(const CameraFrame& raster, std::vector<double> depths)
        : raster_(raster), depths_(std::move(depths)), image_(raster.width, raster.height, {"R", "G", "B"}) {
        std::ranges::fill(image_.data, 1.0f);
    }

    void segment(dvec3 a, dvec3 b) {
        const auto depth  = [&](dvec3 p) { return glm::dot(p - raster_.eye, raster_.forward); };
        const double at_a = depth(a), at_b = depth(b);
        if (raster_.projection == Projection::perspective) {
            const double near = kNear * glm::length(b - a);
            if (at_a <= near && at_b <= near) return;
            if (at_a < near) a += (near - at_a) / (at_b - at_a) * (b - a);
            if (at_b < near) b += (near - at_b) / (at_a - at_b) * (a - b);
        }
        const dvec3 from = raster_.project(a), to = raster_.project(b);
        const double longest = std::max(std::abs(to.x - from.x), std::abs(to.y - from.y));
        const auto steps     = static_cast<int>(std::ceil(std::clamp(longest, 1.0, 1e5)));
        for (int k = 0; k <= steps; ++k) {
            const double t = static_cast<double>(k) / steps;
            dot(from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), depth_between(from.z, to.z, t));
        }
    }

    [[nodiscard]] const Image& image() const { return image_; }

private:
    /// What is linear in the picture is the depth of a parallel view, and 1 / depth of a perspective one.
    [[nodiscard]] double depth_between(double a, double b, double t) const {
        if (raster_.projection == Projection::orthographic) return a + t * (b - a);
        return 1 / (1 / a + t * (1 / b - 1 / a));
    }

    /// The farthest surface around a pixel.
    [[nodiscard]] double surface_around(int x, int y) const {
        double farthest = 0;
        for (int v = std::max(0, y - 1); v <= std::min(raster_.height - 1, y + 1); ++v)
            for (int u = std::max(0, x - 1); u <= std::min(raster_.width - 1, x + 1); ++u)
                farthest = std::max(farthest, depths_[index(u, v)]);
        return farthest;
    }

    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(raster_.width) + static_cast<std::size_t>(x);
    }

    void dot(double x, double y, double depth) {
        if (!(x >= 0 && y >= 0 && x < raster_.width && y < raster_.height)) return;
        const int column = static_cast<int>(x), row = static_cast<int>(y);
        if (!depths_.empty() && depth > surface_around(column, row) * (1 + kInFront)) return;
        for (std::size_t c = 0; c < 3; ++c) image_.at(index(column, row), c) = 0;
    }

    CameraFrame raster_;
    std::vector<double> depths_;  ///< empty: nothing hides
    Image image_;
};

bool is_crease(const Scene& scene, const Topology& topology, const Edge& edge) {
    if (edge.count != 2) return true;
    const dvec3 a = area_normal(scene, topology.uses[edge.first].triangle),
                b = area_normal(scene, topology.uses[edge.first + 1].triangle);
    return !(glm::dot(a, b) > (1 - kFlat) * glm::length(a) * glm::length(b));
}

bool is_of_seen_object(const Scene& scene, const Topology& topology, const Edge& edge) {
    for (std::uint32_t k = edge.first; k < edge.first + edge.count; ++k)
        if (scene.switches(topology.uses[k].triangle).seen_by_camera) return true;
    return false;
}

/// Without lights: the ambient term and emission are left, those of lights included.
Scene without_light(const Scene& scene) {
    Scene dim = scene;
    for (Light& light : dim.lights) light.diffuse = light.specular = vec3(0);
    return dim;
}

Scene without_highlights(const Scene& scene) {
    Scene matt = scene;
    for (Material& m : matt.materials) m.k_s = vec3(0), m.lobes.clear();
    return matt;
}

}  // namespace

Image draw_lines(const RayScene& rays, const Scene& scene, int width, int height, Lines lines) {
    const PointBatch fine   = subpixel_points(rays, scene, width, height, kFine);
    const Topology topology = find_topology(scene, 0, static_cast<std::uint32_t>(scene.triangles.size()));
    Drawing drawing(*fine.raster, lines == Lines::seen ? depths_of(fine) : std::vector<double>{});
    for (const Edge& edge : topology.edges)
        if (is_of_seen_object(scene, topology, edge) && is_crease(scene, topology, edge))
            drawing.segment(dvec3(scene.positions[topology.position[edge.a]]),
                            dvec3(scene.positions[topology.position[edge.b]]));
    return box_filtered(drawing.image(), kFine);
}

std::vector<Stage> draw_stages(const PreparedScene& prepared, const AskVisibility& ask) {
    const Scene& scene       = prepared.scene;
    const PointBatch& points = prepared.points;
    const RayScene rays(scene);
    const int width = points.raster->width, height = points.raster->height;
    const auto shown = [&](const Image& linear) { return displayed(linear, scene.tone, scene.exposure); };
    const auto lit   = [&](const Scene& of, ShadingModel model) {
        return shown(
              shade_by(model, of, points, [&](const PointBatch& asked) { return lit_everywhere(of, asked); }).linear);
    };
    const RayTree tree = trace_rays(rays, scene, points, {});
    std::vector<Stage> stages;
    const auto add = [&](std::string_view name, std::string_view about, Image picture) {
        stages.push_back({name, about, std::move(picture)});
    };
    add("wireframe", "All edges, projected.", draw_lines(rays, scene, width, height, Lines::all));
    add("hidden_lines", "Only what no surface hides from the eye.",
        draw_lines(rays, scene, width, height, Lines::seen));
    add("ambient", "The ambient term: one value an object, no form.", lit(without_light(scene), ShadingModel::phong));
    add("flat", "The sum once a face.", lit(scene, ShadingModel::flat));
    add("gouraud_diffuse", "The diffuse term at vertices, interpolated.",
        lit(without_highlights(scene), ShadingModel::gouraud));
    add("gouraud", "The specular term, too: highlights are as coarse as the mesh.", lit(scene, ShadingModel::gouraud));
    add("phong", "Normals interpolated, the sum at each pixel.", lit(scene, ShadingModel::phong));
    add("shadows", "The same with S_j.", shown(shade_by(ShadingModel::phong, scene, points, ask).linear));
    add("whitted", "Recursive rays: mirrors, glass, and what is seen through.",
        shown(gather(scene, tree, light_of_rays(scene, tree, ask), TreeOptions{}.depth)));
    return stages;
}

}  // namespace umbra
