#include "umbra/bench/ladders/ladder_times.h"

#include <chrono>
#include <optional>

#include "umbra/bench/run/run.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/ray.h"

namespace umbra {
namespace {

using Clock = std::chrono::steady_clock;

/// One run of all phases; nothing where the method does not serve or throws.
std::optional<double> time_once(const MethodChoice& method, const Scene& scene, const SceneFacts& facts,
                                const PointBatch& points) {
    try {
        const MethodRun run = run_method(method, scene, facts, points, {.max_runs = 1, .budget_ms = 0});
        if (!run.service) return std::nullopt;
        return run.build.median + total(run.aim).median + total(run.visibility).median;
    } catch (...) {  // climbing the ladder reports it
        return std::nullopt;
    }
}

}  // namespace

std::vector<std::vector<double>> time_first_rung(const Ladder& ladder, std::span<const MethodChoice> methods,
                                                 const LadderTurns& turns) {
    const Scene scene       = ladder.scene(ladder.rungs.front());
    const SceneFacts facts  = find_facts(scene);
    const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, scene.width, scene.height);

    std::vector<std::vector<double>> times(methods.size());
    std::vector<bool> serves;
    for (const MethodChoice& method : methods) serves.push_back(time_once(method, scene, facts, points).has_value());
    const Clock::time_point begin = Clock::now();
    for (int round = 0; round < turns.rounds; ++round) {
        for (std::size_t k = 0; k < methods.size(); ++k) {
            const std::size_t m = round % 2 == 0 ? k : methods.size() - 1 - k;
            if (serves[m]) times[m].push_back(*time_once(methods[m], scene, facts, points));
        }
        if (std::chrono::duration<double, std::milli>(Clock::now() - begin).count() > turns.budget_ms) break;
    }
    return times;
}

}  // namespace umbra
