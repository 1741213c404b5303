#include "umbra/bench/run/noise_runs.h"

#include <algorithm>
#include <string>

namespace umbra {
namespace {

/// Spread, since methods may take their seed as an offset into one sequence.
std::string other_seed(int own, int run) { return std::to_string((own + 1000003LL * (run + 1)) % 2147483647LL); }

}  // namespace

std::vector<std::optional<NoiseMeter>> noise_runs(const MethodChoice& choice, const Scene& scene,
                                                  const SceneFacts& facts, const PointBatch& points) {
    std::vector<std::optional<NoiseMeter>> meters(scene.lights.size());
    const auto parameters = choice.settings.parameters();
    if (std::ranges::find(parameters, "seed", &Parameter::name) == parameters.end()) return meters;
    for (LightId j = 0; j < scene.lights.size(); ++j)
        if (is_area(scene.lights[j].kind)) meters[j].emplace(points.size());
    if (std::ranges::none_of(meters, [](const auto& meter) { return meter.has_value(); })) return meters;

    for (int run = 0; run < kNoiseRuns; ++run) {
        Settings settings = choice.settings;
        settings.set("seed", other_seed(choice.settings.integer("seed"), run));
        const std::unique_ptr<Method> method = choice.info->make(settings);
        method->build(scene, facts);
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            if (!meters[j]) continue;
            std::vector<float> s(points.size(), 0);
            std::vector<std::uint8_t> defined(points.size(), kDefined);
            method->aim(j);
            method->visibility(points, j, s, defined);
            meters[j]->add(s);
        }
    }
    return meters;
}

}  // namespace umbra
