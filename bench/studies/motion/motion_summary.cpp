#include "umbra/bench/studies/motion/motion_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

#include "umbra/bench/lab/workload.h"

namespace umbra {
namespace {

std::size_t index(Movement movement) { return static_cast<std::size_t>(movement); }

/// Milliseconds of a frame of the mix: the weighted sum of the medians of its movements' frames.
double mix_ms(const MethodMotion& method, const Mix& mix) {
    double ms = 0;
    for (const Movement movement : kMovements)
        if (const double share = mix.share[index(movement)]; share > 0)
            ms += share * median(frame_times(method, movement));
    return ms;
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

std::vector<std::size_t> within(const SceneMotion& motion, double max_rmse) {
    const auto is_good = [&](const MotionFrame& f) { return f.errors.undefined == 0 && !(f.errors.rmse > max_rmse); };
    std::vector<std::size_t> chosen;
    for (std::size_t m = 0; m < motion.methods.size(); ++m) {
        const MethodMotion& method = motion.methods[m];
        if (method.ran() && std::ranges::all_of(kMovements, [&](Movement movement) {
                const std::vector<MotionFrame>& frames = method.of(movement);
                return frames.empty() ? !motion.of(movement).cannot.empty() : std::ranges::all_of(frames, is_good);
            }))
            chosen.push_back(m);
    }
    return chosen;
}

std::optional<WinnerRecord> winner(const SceneMotion& motion, const std::vector<std::size_t>& competitors,
                                   const Mix& mix) {
    struct Entry {
        std::string method;
        double ms;
        std::vector<double> times;  // of each frame of the mix
    };
    std::vector<Entry> entries;
    for (const std::size_t m : competitors) {
        const MethodMotion& method = motion.methods[m];
        entries.push_back({method.still.choice.text(), mix_ms(method, mix), mixed_frames(method, mix)});
    }
    if (entries.empty()) return std::nullopt;
    std::ranges::stable_sort(entries, {}, &Entry::ms);
    WinnerRecord won{.method = entries[0].method, .ms = entries[0].ms};
    for (std::size_t k = 1; k < entries.size(); ++k) {
        const Ratio ratio = paired_ratio(entries[k].times, entries[0].times);
        if (k == 1) won.runner_up = entries[k].method, won.runner_up_over_winner = ratio_record(ratio);
        if (ratio.median < 1 || !differs(ratio, motion.record.noise_bar)) won.ties.push_back(entries[k].method);
    }
    return won;
}

std::vector<BreakEvenRecord> break_evens(const SceneMotion& motion, const std::vector<std::size_t>& competitors) {
    constexpr double never = std::numeric_limits<double>::infinity();
    std::vector<BreakEvenRecord> pairs;
    if (is_too_noisy(motion.record.noise_bar)) return pairs;
    for (const std::size_t slow : competitors)
        for (const std::size_t fast : competitors) {
            const TurnTimes &a = motion.methods[slow].still, &b = motion.methods[fast].still;
            const auto start   = [](const TurnTimes& t) { return median(t.build) + median(t.aim); };
            const auto frame   = [](const TurnTimes& t) { return median(t.look) + median(t.visibility); };
            const double noise = 1 + motion.record.noise_bar;
            if (!(start(a) > start(b) * noise && frame(b) > frame(a) * noise)) continue;
            const double setup = start(a) - start(b), saves = frame(b) - frame(a);
            const double frames = std::ceil(setup / saves);
            BreakEvenRecord pair{a.choice.text(), b.choice.text(), setup, saves, frames, {frames, frames}};
            for (std::size_t r = 0; r < std::min(a.build.size(), b.build.size()); ++r) {
                const double longer  = a.build[r] + a.aim[r] - b.build[r] - b.aim[r];
                const double shorter = b.look[r] + b.visibility[r] - a.look[r] - a.visibility[r];
                const double needed  = shorter > 0 ? std::max(0.0, std::ceil(longer / shorter)) : never;
                pair.rounds          = {std::min(pair.rounds[0], needed), std::max(pair.rounds[1], needed)};
            }
            pairs.push_back(pair);
        }
    return pairs;
}

}  // namespace umbra
