#include "umbra/bench/run/explain.h"

#include <fmt/format.h>

#include <stdexcept>

#include "umbra/core/base/error.h"
#include "umbra/core/errors/error_causes.h"

namespace umbra {
namespace {

/// The triangles that the method of a run blames for the shadow at these points.
std::vector<TriangleId> blamed(const MethodRun& run, const PointBatch& points, LightId light,
                               std::span<const std::uint32_t> which) {
    std::vector<TriangleId> who(which.size(), kNoTriangle);
    if (which.empty()) return who;
    try {
        run.work->blame(pick(points, which), light, who);
    } catch (...) {
        throw std::runtime_error(fmt::format("{}, asked for occluders: {}", run.choice.text(), current_message()));
    }
    return who;
}

}  // namespace

Explained explain(const Scene& scene, const PointBatch& points, LightId light, const MethodRun& run,
                  const MethodRun& reference, const NoiseMeter* meter) {
    const VisibilityPlane &s = run.planes[light], &truth = reference.planes[light];
    const float tolerance = visibility_tolerance(scene.lights[light].kind);

    Explained e;
    e.classes = error_classes(points, light, s, truth, tolerance, reference.judged_points(light));
    mark_terminator(e.classes, scene, points, light);
    mark_penumbra(e.classes, scene, light, truth);
    if (meter != nullptr) {
        meter->mark(e.classes, truth, tolerance);
        e.noise = meter->result(e.classes, truth);
    }
    const auto dark = points_of_class(e.classes, ErrorClass::false_shadow);
    mark_acne(e.classes, scene, points, dark, blamed(run, points, light, dark));
    const auto bright = points_of_class(e.classes, ErrorClass::false_light);
    mark_detachment(e.classes, scene, points, light, bright, blamed(reference, points, light, bright));
    e.error        = count_errors(points, e.classes, s, truth);
    e.displacement = edge_displacement(points, e.classes, s, truth);
    if (is_area(scene.lights[light].kind)) e.penumbra_width = penumbra_width(points, e.classes, s, truth);
    return e;
}

}  // namespace umbra
