#include "umbra/bench/motion/motion_record.h"

namespace umbra {
namespace {

RatioRecord ratio_record(const Ratio& ratio) {
    RatioRecord record{.median = ratio.median, .pairs = static_cast<std::uint64_t>(ratio.pairs)};
    if (ratio.has_interval()) record.interval = ends(ratio.interval), record.coverage = ratio.coverage;
    return record;
}

MovedRecord moved_record(const SceneMotion& motion, const MethodMotion& method, Movement movement) {
    const std::vector<double> times = frame_times(method, movement);
    const double model              = model_ms(motion, method, movement);
    const ErrorSummary errors       = summarise_errors(method.of(movement));
    const auto n                    = static_cast<double>(times.size());
    double sum                      = 0;
    for (const double ms : times) sum += ms;
    MovedRecord record{.frames              = method.of(movement),
                       .sum_ms              = sum,
                       .mean_ms             = sum / n,
                       .median_ms           = median(times),
                       .model_ms            = model * n,
                       .measured_over_model = sum / (model * n),
                       .frame_over_model = ratio_record(paired_ratio(times, std::vector<double>(times.size(), model))),
                       .mean_rmse        = errors.mean_rmse.value_or(kUnknown),
                       .worst_rmse       = errors.worst_rmse.value_or(kUnknown),
                       .undefined        = errors.undefined};
    if (!motion.sampled) record.interior = errors.interior;
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

std::string text(const SceneMotion& motion, std::size_t method) { return motion.methods[method].still.choice.text(); }

std::optional<WinnerRecord> winner_record(const SceneMotion& motion, const std::optional<Winner>& won) {
    if (!won) return std::nullopt;
    WinnerRecord record{.method = text(motion, won->method), .ms = won->ms};
    for (const std::size_t m : won->ties) record.ties.push_back(text(motion, m));
    if (won->runner_up)
        record.runner_up = text(motion, *won->runner_up), record.runner_up_over_winner = ratio_record(won->behind);
    return record;
}

}  // namespace

std::optional<double> MovedRecord::answered() const {
    double answered = 0, asked = 0;
    for (const MotionFrame& frame : frames) {
        answered += static_cast<double>(frame.errors.points);
        asked += static_cast<double>(frame.errors.points + frame.errors.undefined);
    }
    return asked > 0 ? std::optional(answered / asked) : std::nullopt;
}

SceneMotionRecord scene_motion_record(const SceneMotion& motion, double max_rmse) {
    SceneMotionRecord record{
        .scene     = motion.name,
        .title     = motion.title,
        .triangles = motion.triangles,
        .size      = {static_cast<std::uint64_t>(motion.width), static_cast<std::uint64_t>(motion.height)},
        .reference = {.method  = motion.reference->choice.text(),
                      .exact   = motion.reference->exact,
                      .note    = motion.reference->note,
                      .sampled = motion.sampled},
        .noise_bar = motion.noise_bar,
        .movements = {motion.movements.begin(), motion.movements.end()}};
    for (const Light& light : motion.lights)
        record.lights.push_back({.name = light.name, .kind = std::string(to_string(light.kind))});
    for (const MethodMotion& method : motion.methods) record.methods.push_back(method_record(motion, method));
    const std::vector<std::size_t> all = complete(motion), good = within(motion, max_rmse);
    for (const Mix& mix : canonical_mixes()) {
        if (!has(motion, mix)) continue;
        MixRecord row{.mix = std::string(mix.name)};
        for (const Movement movement : kMovements)
            row.share(to_string(movement)) = mix.share[static_cast<std::size_t>(movement)];
        row.complete = winner_record(motion, winner(motion, all, mix));
        row.within   = winner_record(motion, winner(motion, good, mix));
        record.winners.push_back(std::move(row));
    }
    for (const BreakEven& pair : break_evens(motion, all))
        record.break_even.push_back({.method   = text(motion, pair.slow),
                                     .over     = text(motion, pair.fast),
                                     .setup_ms = pair.setup_ms,
                                     .saves_ms = pair.saves_ms,
                                     .frames   = pair.frames,
                                     .rounds   = ends(pair.interval)});
    return record;
}

Json motion_schema() { return schema_of<MotionRecord>("results.json of umbra motion"); }

}  // namespace umbra
