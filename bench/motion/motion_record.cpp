#include "umbra/bench/motion/motion_record.h"

namespace umbra {
namespace {

RatioRecord ratio_record(const Ratio& ratio) {
    RatioRecord record{.median = ratio.median, .pairs = static_cast<std::uint64_t>(ratio.pairs)};
    if (ratio.has_interval()) record.interval = ends(ratio.interval), record.coverage = ratio.coverage;
    return record;
}

FrameRecord frame_record(const MotionFrame& frame) {
    const FrameErrors& e = frame.errors;
    FrameRecord record{.build_ms      = frame.times.build,
                       .look_ms       = frame.times.look,
                       .aim_ms        = frame.times.aim,
                       .visibility_ms = frame.times.visibility,
                       .points        = e.points,
                       .undefined     = e.undefined,
                       .wrong         = e.wrong,
                       .interior      = e.interior};
    if (e.points > 0) record.rmse = e.rmse, record.max = e.max;
    return record;
}

MovedRecord moved_record(const SceneMotion& motion, const MethodMotion& method, Movement movement) {
    const std::vector<double> times = frame_times(method, movement);
    const double model              = model_ms(motion, method, movement);
    const ErrorSummary errors       = summarise_errors(method.of(movement));
    const auto n                    = static_cast<double>(times.size());
    double sum                      = 0;
    for (const double ms : times) sum += ms;
    MovedRecord record{.sum_ms              = sum,
                       .mean_ms             = sum / n,
                       .median_ms           = median(times),
                       .model_ms            = model * n,
                       .measured_over_model = sum / (model * n),
                       .frame_over_model = ratio_record(paired_ratio(times, std::vector<double>(times.size(), model))),
                       .mean_rmse        = errors.mean_rmse.value_or(kUnknown),
                       .worst_rmse       = errors.worst_rmse.value_or(kUnknown),
                       .undefined        = errors.undefined};
    if (!motion.sampled) record.interior = errors.interior;
    for (const MotionFrame& frame : method.of(movement)) record.frames.push_back(frame_record(frame));
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

MovementRecord movement_record(const MovementRun& run, Movement movement) {
    MovementRecord record{.movement = std::string(to_string(movement)), .cannot = run.cannot};
    if (!run.cannot.empty()) return record;
    record.what      = run.what;
    record.points_ms = run.points_ms, record.facts_ms = run.facts_ms, record.truth_ms = run.truth_ms;
    return record;
}

}  // namespace

std::optional<double> MovedRecord::answered() const {
    double answered = 0, asked = 0;
    for (const FrameRecord& frame : frames) {
        answered += static_cast<double>(frame.points);
        asked += static_cast<double>(frame.points + frame.undefined);
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
        .noise_bar = motion.noise_bar};
    for (const Light& light : motion.lights)
        record.lights.push_back({.name = light.name, .kind = std::string(to_string(light.kind))});
    for (const Movement movement : kMovements)
        record.movements.push_back(movement_record(motion.of(movement), movement));
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
