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
        MethodChoice seeded = choice;
        seeded.settings.set(seed, other_seed(choice.settings.value(seed), run));
        other.set(seeded);
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

}  // namespace umbra
