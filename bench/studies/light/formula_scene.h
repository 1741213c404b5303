// Recursive ray tracing of a scene whose spheres and boxes are met by formula, and all other triangles as triangles.
//
// This work is based on:
// Turner Whitted. An Improved Illumination Model for Shaded Display. 1980
// Timothy Kay, James Kajiya. Ray Tracing Complex Scenes. 1986
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "umbra/bench/studies/light/bodies.h"
#include "umbra/bench/studies/light/body_tree.h"
#include "umbra/bench/studies/light/ray_tree.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// Rays from a point to an area light that its S_j is the mean of.
inline constexpr int kFormulaLightSamples = 16;

/// Rays of trace_rays, with bodies in place of the triangles that stand for them. Numbers of triangles are those of the
/// scene; on a body, the point's triangle is the body's `holder`, its position and normal are in RayLevel::on_body, and
/// `u` and `v` mean nothing. Bodies may interpenetrate: what is nearest is met. All queries are const and may run from
/// many threads at once.
class FormulaScene {
public:
    /// The scene must outlive this object. `bodies`: find_bodies of it, or some of these. Throws std::runtime_error
    /// where Embree fails.
    FormulaScene(const Scene& scene, const Bodies& bodies);

    /// The tree over the eye rays of a raster, by the rules of trace_rays. Parallel; the same bits for any number of
    /// threads. Throws InputError where a depth has too many rays.
    [[nodiscard]] RayTree trace(const CameraFrame& raster, const TreeOptions& options) const;

    /// S_j at the points of a level of such a tree, one plane a light, by rays in the measure of areas: one to a light
    /// without area, kFormulaLightSamples to another, at places that depend on the point's number alone. Surfaces that
    /// let light through do to it what the scene says. Parallel; the same bits for any number of threads.
    [[nodiscard]] std::vector<VisibilityPlane> visibility(const RayTree& tree, std::size_t level) const;

private:
    struct Start;
    void meet(RayLevel& level, std::size_t count, const std::function<Start(std::size_t)>& start_of) const;
    void set_point_on_body(RayLevel& level, std::size_t i, BodyMeeting met, const Ray& ray) const;
    [[nodiscard]] TriangleId first_triangle(const RayScene& rays, Ray ray) const;
    [[nodiscard]] dvec3 passes(const Start& to_light) const;

    const Scene* scene_;
    std::vector<TriangleId> in_scene_;  ///< of the triangles that no body replaces: their number in the scene
    std::vector<TriangleId> in_rest_;   ///< of the scene's triangles: their number among these, or kNoTriangle
    RayScene rest_, shadow_rest_;       ///< the latter has what takes light
    BodyTree bodies_;
};

}  // namespace umbra
