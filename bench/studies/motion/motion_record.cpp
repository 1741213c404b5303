#include "umbra/bench/studies/motion/motion_record.h"

#include <algorithm>
#include <numeric>

#include "umbra/bench/studies/motion/motion_summary.h"

namespace umbra {
namespace {

MovedRecord moved_record(const SceneMotion& motion, const MethodMotion& method, Movement movement) {
    const std::vector<double> times = frame_times(method, movement);
    const double model              = model_ms(motion, method, movement);
    const auto n                    = static_cast<double>(times.size());
    const double sum                = std::accumulate(times.begin(), times.end(), 0.0);
    MovedRecord record{.frames              = method.of(movement),
                       .sum_ms              = sum,
                       .mean_ms             = sum / n,
                       .median_ms           = median(times),
                       .model_ms            = model * n,
                       .measured_over_model = sum / (model * n),
                       .frame_over_model = ratio_record(paired_ratio(times, std::vector<double>(times.size(), model)))};
    std::vector<double> rmse;
    if (!motion.record.reference.sampled) record.interior = 0;
    for (const MotionFrame& frame : record.frames) {
        if (frame.errors.points > 0) rmse.push_back(frame.errors.rmse);
        record.undefined += frame.errors.undefined;
        if (record.interior) *record.interior += frame.errors.interior.value_or(0);
    }
    if (rmse.empty()) return record;
    record.mean_rmse  = std::accumulate(rmse.begin(), rmse.end(), 0.0) / static_cast<double>(rmse.size());
    record.worst_rmse = std::ranges::max(rmse);
    return record;
}

MovedMethodRecord method_record(const SceneMotion& motion, const MethodMotion& method) {
    const TurnTimes& still = method.still;
    MovedMethodRecord record{.name        = std::string(still.choice.info->name),
                             .title       = std::string(still.choice.info->title),
                             .text        = still.choice.text(),
                             .serves      = service_record(still.service),
                             .incremental = false,  // no method has an update that is less than its phase
                             .failed      = method.failed.value_or("")};
    if (!still.service || still.build.empty()) return record;
    record.memory_bytes = still.memory_bytes;
    record.at_rest      = turn_times_record(still);
    for (const Movement movement : kMovements)
        if (!method.of(movement).empty())
            record.movements(to_string(movement)) = moved_record(motion, method, movement);
    return record;
}

}  // namespace

RatioRecord ratio_record(const Ratio& ratio) {
    RatioRecord record{.median = ratio.median, .pairs = static_cast<std::uint64_t>(ratio.pairs)};
    if (ratio.has_interval()) record.interval = ends(ratio.interval), record.coverage = ratio.coverage;
    return record;
}

std::optional<double> MovedRecord::answered() const {
    double answered = 0, asked = 0;
    for (const MotionFrame& frame : frames) {
        answered += static_cast<double>(frame.errors.points);
        asked += static_cast<double>(frame.errors.points + frame.errors.undefined);
    }
    return asked > 0 ? std::optional(answered / asked) : std::nullopt;
}

SceneMotionRecord scene_motion_record(const SceneMotion& motion, double max_rmse) {
    SceneMotionRecord record = motion.record;
    for (const MethodMotion& method : motion.methods) record.methods.push_back(method_record(motion, method));
    const std::vector<std::size_t> all = complete(motion), good = within(motion, max_rmse);
    for (const Mix& mix : canonical_mixes()) {
        if (!has(motion, mix)) continue;
        MixRecord row{.mix = std::string(mix.name)};
        for (const Movement movement : kMovements)
            row.share(to_string(movement)) = mix.share[static_cast<std::size_t>(movement)];
        row.complete = winner(motion, all, mix);
        row.within   = winner(motion, good, mix);
        record.winners.push_back(std::move(row));
    }
    record.break_even = break_evens(motion, all);
    return record;
}

}  // namespace umbra
