#include "umbra/bench/run/noise_runs.h"

#include <algorithm>
#include <string>

namespace umbra {
namespace {

/// Spread, since methods may take their seed as an offset into one sequence.
double other_seed(double own, int run) {
    return static_cast<double>((static_cast<std::int64_t>(own) + 1000003LL * (run + 1)) % 2147483647LL);
}

}  // namespace

std::vector<std::optional<NoiseMeter>> noise_runs(const MethodChoice& choice, const Scene& scene,
                                                  const SceneFacts& facts, const PointBatch& points, int runs) {
    std::vector<std::optional<NoiseMeter>> meters(scene.lights.size());
    const std::string_view seed = choice.info->seed;
    if (seed.empty()) return meters;
    for (LightId j = 0; j < scene.lights.size(); ++j)
        if (is_area(scene.lights[j].kind)) meters[j].emplace(points.size());
    if (std::ranges::none_of(meters, [](const auto& meter) { return meter.has_value(); })) return meters;

    std::unique_ptr<Method> method;
    for (int run = 0; run < runs; ++run) {
        Settings settings = choice.settings;
        settings.set(seed, other_seed(choice.settings.value(seed), run));
        if (method == nullptr || first_changed_phase(choice.settings, settings) == Phase::build) {
            method = choice.info->make(settings);
            method->build(scene, facts);
        } else {
            method->configure(settings);
        }
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            if (!meters[j]) continue;
            VisibilityPlane plane(points.size());
            method->aim(j);
            method->visibility(points, j, plane.out());
            meters[j]->add(plane.s);
        }
    }
    return meters;
}

}  // namespace umbra
