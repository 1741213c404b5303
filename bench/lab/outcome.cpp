#include "umbra/bench/lab/outcome.h"

#include <fmt/format.h>

#include <algorithm>
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
    } catch (const CutShort&) {
        throw;
    } catch (...) {
        throw std::runtime_error(fmt::format("{}, asked for occluders: {}", run.choice.text(), current_message()));
    }
    return who;
}

}  // namespace

Explained explain(const Scene& scene, const PointBatch& points, LightId light, const MethodRun& run,
                  const MethodRun& reference, const NoiseMeter* meter, bool named) {
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
    if (!named) {
        e.error = count_errors(points, e.classes, s, truth);
        return e;
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

MethodChoice with_seed(MethodChoice choice, std::int64_t step) {
    const std::string_view seed = choice.info->seed;
    const auto& parameters      = choice.info->parameters;
    const auto of               = std::ranges::find(parameters, seed, &Parameter::name);
    const auto least = static_cast<std::int64_t>(of->min), count = static_cast<std::int64_t>(of->max) - least + 1;
    std::int64_t value = (static_cast<std::int64_t>(choice.settings.value(seed)) + step) % 2147483647LL;
    if (value < least || value - least >= count) value = least + ((value - least) % count + count) % count;
    choice.settings.set(seed, static_cast<double>(value));
    return choice;
}

std::vector<std::optional<NoiseMeter>> noise_runs(const MethodAtWork& work, const Scene& scene,
                                                  const PointBatch& points, int runs) {
    std::vector<std::optional<NoiseMeter>> meters(scene.lights.size());
    const MethodChoice& choice  = work.choice();
    const std::string_view seed = choice.info->seed;
    if (seed.empty()) return meters;
    for (LightId j = 0; j < scene.lights.size(); ++j)
        if (is_area(scene.lights[j].kind)) meters[j].emplace(points.size());
    if (std::ranges::none_of(meters, [](const auto& meter) { return meter.has_value(); })) return meters;

    MethodAtWork other = work;
    for (int run = 0; run < runs; ++run) {
        // Spread, since methods may take their seed as an offset into one sequence.
        other.set(with_seed(choice, 1000003LL * (run + 1)));
        if (!other.looks_at(points)) other.look(points);
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            if (!meters[j]) continue;
            VisibilityPlane plane(points.size());
            other.forget_aims();
            other.visibility(j, plane.out());
            meters[j]->add(plane.s);
        }
    }
    return meters;
}

Outcome outcome(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts, const PointBatch& points,
                const Trial& trial) {
    Outcome found{MethodRun{choice}};
    std::optional<LightId> at;
    try {
        found.run = trial.run ? trial.run(at) : run_method(choice, scene, facts, points, &at, trial.budget);
        if (!found.run.service) return found;
        const MethodRun& truth = trial.truth(found.run);
        found.run.work->limit(trial.budget);  // a truth that is found meanwhile is not the method's work
        std::vector<std::optional<NoiseMeter>> noise(scene.lights.size());
        if (trial.noise_runs > 0) noise = noise_runs(*found.run.work, scene, points, trial.noise_runs);
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            at = j;
            found.explained.push_back(
                explain(scene, points, j, found.run, truth, noise[j] ? &*noise[j] : nullptr, trial.named));
        }
        at.reset();
        if (trial.then) trial.then(found);
    } catch (const InputError&) {
        throw;
    } catch (...) {
        found.explained.clear();
        found.failed = failure(choice, at);
    }
    if (found.run.work) found.run.work->lift_limit();
    return found;
}

}  // namespace umbra
