#include "umbra/bench/studies/light/whitted.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/stopwatch.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/render/sum.h"

namespace umbra {
namespace {

std::uint64_t undefined_answers(const PointBatch& points, const std::vector<VisibilityPlane>& planes) {
    std::uint64_t undefined = 0;
    for (LightId j = 0; j < planes.size(); ++j)
        for (std::size_t i = 0; i < points.size(); ++i) undefined += points.asks(j, i) && !planes[j].defined(i) ? 1 : 0;
    return undefined;
}

/// What arrives at the start of a secondary ray of the light that leaves its end.
dvec3 through_fog(const Scene& scene, dvec3 light, vec3 from, vec3 to) {
    if (scene.fog.law == FogLaw::none) return light;
    const double f = fog_share(scene.fog, glm::length(dvec3(to) - dvec3(from)));
    return f * light + (1 - f) * dvec3(scene.fog.colour);
}

void check_planes(const std::vector<VisibilityPlane>& planes, const Scene& scene, const PointBatch& points) {
    bool fits = planes.size() == scene.lights.size();
    for (const VisibilityPlane& plane : planes)
        fits = fits && plane.s.size() == points.size() && plane.answer.size() == points.size();
    if (!fits) throw std::logic_error("light_of_rays: S_j of another number of points or lights than asked for");
}

}  // namespace

TreeLight light_of_rays(const Scene& scene, const RayTree& tree,
                        std::span<const std::vector<VisibilityPlane>> visibility) {
    if (visibility.size() != tree.levels.size())
        throw std::logic_error("light_of_rays: S_j of another number of levels than the tree has");
    const Stopwatch start;
    TreeLight light;
    const PhongSum sum(scene, *tree.levels[0].points.raster);
    for (std::size_t level = 0; level < tree.levels.size(); ++level) {
        const PointBatch& points                   = tree.levels[level].points;
        const std::vector<VisibilityPlane>& planes = visibility[level];
        check_planes(planes, scene, points);
        light.undefined += undefined_answers(points, planes);
        std::vector<dvec3>& local = light.local.emplace_back(points.size(), dvec3(scene.background));
        parallel_ranges(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (points.triangle[i] == kNoTriangle) continue;
                const dvec3 v = level == 0 ? sum.to_viewer(points, i) : -tree.levels[level].rays[i].direction;
                local[i]      = sum.leaving(points, i, shading_normal(scene, tree.levels[level], i), v, planes);
                if (!tree.levels[level].own.empty()) local[i] *= static_cast<double>(tree.levels[level].own[i]);
            }
        });
    }
    light.sum_ms = start.ms();
    return light;
}

TreeLight light_of_rays(const Scene& scene, const RayTree& tree, const AskVisibility& ask) {
    const Stopwatch start;
    std::vector<std::vector<VisibilityPlane>> visibility;
    for (const RayLevel& level : tree.levels) visibility.push_back(ask(level.points));
    const double asked = start.ms();
    TreeLight light    = light_of_rays(scene, tree, visibility);
    light.shadow_ms    = asked;
    return light;
}

Image gather(const Scene& scene, const RayTree& tree, const TreeLight& light, int depth) {
    std::vector<dvec3> arrives;  // of the level after, at the start of each ray
    for (std::size_t level = std::min(tree.levels.size(), static_cast<std::size_t>(depth)); level-- > 0;) {
        const PointBatch& points = tree.levels[level].points;
        std::vector<dvec3> here  = light.local[level];
        for (std::size_t k = 0; k < arrives.size(); ++k) {
            const SecondaryRay& ray = tree.levels[level + 1].rays[k];
            dvec3 passes(ray.factor);
            if (ray.kind == RayKind::refracted)
                passes *= dvec3(scene.material(points.triangle[ray.parent]).transmit_colour);
            here[ray.parent] += passes * arrives[k];
        }
        if (level > 0)
            for (std::size_t i = 0; i < points.size(); ++i)
                if (points.triangle[i] != kNoTriangle)
                    here[i] = through_fog(scene, here[i],
                                          tree.levels[level - 1].points.position(tree.levels[level].rays[i].parent),
                                          points.position(i));
        arrives = std::move(here);
    }
    const PointBatch& eye = tree.levels[0].points;
    const PhongSum sum(scene, *eye.raster);
    Image image(eye.raster->width, eye.raster->height, {"R", "G", "B"});
    for (std::size_t i = 0; i < eye.size(); ++i)
        write_light(image, i,
                    eye.triangle[i] == kNoTriangle ? arrives[i] : sum.at_the_eye(arrives[i], eye.position(i)));
    return image;
}

}  // namespace umbra
