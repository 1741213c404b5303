#include "umbra/bench/motion/motion_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <ranges>

#include "umbra/bench/time/workload.h"

namespace umbra {
namespace {

std::size_t index(Movement movement) { return static_cast<std::size_t>(movement); }

bool ran_all_frames(const SceneMotion& motion, const MethodMotion& method) {
    return method.ran() && std::ranges::all_of(kMovements, [&](Movement movement) {
               return !motion.of(movement).cannot.empty() || !method.of(movement).empty();
           });
}

std::vector<std::size_t> those(const SceneMotion& motion, const auto& condition) {
    std::vector<std::size_t> chosen;
    for (std::size_t m = 0; m < motion.methods.size(); ++m)
        if (ran_all_frames(motion, motion.methods[m]) &&
            std::ranges::all_of(motion.methods[m].frames, [&](const auto& frames) {
                return std::ranges::all_of(frames, [&](const MotionFrame& f) { return condition(f.errors); });
            }))
            chosen.push_back(m);
    return chosen;
}

/// The weighted sums of the frames of one index: all methods took turns in each of them.
std::vector<double> mixed_frames(const MethodMotion& method, const Mix& mix) {
    std::vector<double> sums;
    for (const Movement movement : kMovements) {
        const double share = mix.share[index(movement)];
        if (share == 0) continue;
        const std::vector<double> times = frame_times(method, movement);
        if (sums.empty()) sums.resize(times.size());
        sums.resize(std::min(sums.size(), times.size()));
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += share * times[i];
    }
    return sums;
}

}  // namespace

std::vector<double> frame_times(const MethodMotion& method, Movement movement) {
    std::vector<double> times;
    for (const MotionFrame& frame : method.of(movement)) times.push_back(frame.times.all());
    return times;
}

double model_ms(const SceneMotion& motion, const MethodMotion& method, Movement movement) {
    Workload workload{0, 0, 0};
    (movement == Movement::camera  ? workload.camera
     : movement == Movement::light ? workload.light
                                   : workload.object) = 1;
    const TurnTimes& still                            = method.still;
    const double aim = median(movement == Movement::light ? still.light_aim[motion.moved] : still.aim);
    return frame_cost_ms(workload, {median(still.build), aim, median(still.look), median(still.visibility)});
}

ErrorSummary summarise_errors(const std::vector<MotionFrame>& frames) {
    ErrorSummary summary;
    std::vector<double> rmse;
    for (const MotionFrame& frame : frames) {
        if (frame.errors.points > 0) rmse.push_back(frame.errors.rmse);
        summary.undefined += frame.errors.undefined;
        summary.interior += frame.errors.interior.value_or(0);
    }
    if (rmse.empty()) return summary;
    summary.mean_rmse  = std::accumulate(rmse.begin(), rmse.end(), 0.0) / static_cast<double>(rmse.size());
    summary.worst_rmse = std::ranges::max(rmse);
    return summary;
}

std::vector<Mix> canonical_mixes() {
    constexpr double third = 1.0 / 3, sixtieth = 1.0 / 60;
    return {{"camera", {1, 0, 0}},
            {"light", {0, 1, 0}},
            {"object", {0, 0, 1}},
            {"camera and light in turns", {0.5, 0.5, 0}},
            {"camera and object in turns", {0.5, 0, 0.5}},
            {"light and object in turns", {0, 0.5, 0.5}},
            {"all three in turns", {third, third, third}},
            {"light in one of 60 frames", {1 - sixtieth, sixtieth, 0}},
            {"object in one of 60 frames", {1 - sixtieth, 0, sixtieth}}};
}

bool has(const SceneMotion& motion, const Mix& mix) {
    return std::ranges::all_of(kMovements, [&](Movement movement) {
        return mix.share[index(movement)] == 0 || motion.of(movement).cannot.empty();
    });
}

double mix_ms(const MethodMotion& method, const Mix& mix) {
    double ms = 0;
    for (const Movement movement : kMovements)
        if (const double share = mix.share[index(movement)]; share > 0)
            ms += share * median(frame_times(method, movement));
    return ms;
}

std::vector<std::size_t> complete(const SceneMotion& motion) {
    return those(motion, [](const FrameErrors& e) { return e.undefined == 0; });
}

std::vector<std::size_t> within(const SceneMotion& motion, double max_rmse) {
    return those(motion, [&](const FrameErrors& e) { return e.undefined == 0 && !(e.rmse > max_rmse); });
}

std::optional<Winner> winner(const SceneMotion& motion, const std::vector<std::size_t>& competitors, const Mix& mix) {
    struct Entry {
        std::size_t method;
        double ms;
        std::vector<double> times;  // of each frame of the mix
    };
    std::vector<Entry> entries;
    for (const std::size_t m : competitors)
        entries.push_back({m, mix_ms(motion.methods[m], mix), mixed_frames(motion.methods[m], mix)});
    if (entries.empty()) return std::nullopt;
    std::ranges::stable_sort(entries, {}, &Entry::ms);
    Winner won{entries[0].method, entries[0].ms, {}, {}, {}};
    for (std::size_t k = 1; k < entries.size(); ++k) {
        const Ratio ratio = paired_ratio(entries[k].times, entries[0].times);
        if (k == 1) won.runner_up = entries[k].method, won.behind = ratio;
        if (ratio.median < 1 || !differs(ratio, motion.noise_bar)) won.ties.push_back(entries[k].method);
    }
    return won;
}

std::vector<BreakEven> break_evens(const SceneMotion& motion, const std::vector<std::size_t>& competitors) {
    constexpr double never = std::numeric_limits<double>::infinity();
    std::vector<BreakEven> pairs;
    if (is_too_noisy(motion.noise_bar)) return pairs;
    for (const std::size_t slow : competitors)
        for (const std::size_t fast : competitors) {
            const TurnTimes &a = motion.methods[slow].still, &b = motion.methods[fast].still;
            const auto start   = [](const TurnTimes& t) { return median(t.build) + median(t.aim); };
            const auto frame   = [](const TurnTimes& t) { return median(t.look) + median(t.visibility); };
            const double noise = 1 + motion.noise_bar;
            if (!(start(a) > start(b) * noise && frame(b) > frame(a) * noise)) continue;
            const double setup = start(a) - start(b), saves = frame(b) - frame(a);
            BreakEven pair{slow, fast, setup, saves, std::ceil(setup / saves), {}};
            pair.interval = {pair.frames, pair.frames};
            for (std::size_t r = 0; r < std::min(a.build.size(), b.build.size()); ++r) {
                const double longer  = a.build[r] + a.aim[r] - b.build[r] - b.aim[r];
                const double shorter = b.look[r] + b.visibility[r] - a.look[r] - a.visibility[r];
                const double frames  = shorter > 0 ? std::max(0.0, std::ceil(longer / shorter)) : never;
                pair.interval        = {std::min(pair.interval.low, frames), std::max(pair.interval.high, frames)};
            }
            pairs.push_back(pair);
        }
    return pairs;
}

}  // namespace umbra
