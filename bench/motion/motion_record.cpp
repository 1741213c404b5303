#include "umbra/bench/motion/motion.h"
#include "umbra/bench/motion/motion_summary.h"

namespace umbra {
namespace {

Json if_known(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

Json interval_json(const Interval& interval) { return {number(interval.low), number(interval.high)}; }

Json ratio_json(const Ratio& ratio) {
    return {{"median", number(ratio.median)},
            {"interval", ratio.has_interval() ? interval_json(ratio.interval) : Json{nullptr, nullptr}},
            {"pairs", ratio.pairs},
            {"coverage", ratio.coverage}};
}

Json frame_json(const MotionFrame& frame) {
    const FrameErrors& e = frame.errors;
    return {{"build_ms", number(frame.times.build)},
            {"aim_ms", frame.times.aim},
            {"look_ms", number(frame.times.look)},
            {"visibility_ms", frame.times.visibility},
            {"points", e.points},
            {"undefined", e.undefined},
            {"wrong", e.wrong},
            {"interior", e.interior ? Json(*e.interior) : Json(nullptr)},
            {"rmse", e.points > 0 ? number(e.rmse) : Json(nullptr)},
            {"max", e.points > 0 ? number(e.max) : Json(nullptr)}};
}

Json method_movement_json(const SceneMotion& motion, const MethodMotion& method, Movement movement) {
    const std::vector<MotionFrame>& frames = method.of(movement);
    const std::vector<double> times        = frame_times(method, movement);
    const double model                     = model_ms(motion, method, movement);
    const ErrorSummary errors              = summarise_errors(frames);
    double sum                             = 0;
    for (const double ms : times) sum += ms;
    Json j = {{"frames", Json::array()},
              {"sum_ms", number(sum)},
              {"mean_ms", number(sum / static_cast<double>(times.size()))},
              {"median_ms", number(median(times))},
              {"model_ms", number(model * static_cast<double>(times.size()))},
              {"measured_over_model", number(sum / (model * static_cast<double>(times.size())))},
              {"frame_over_model", ratio_json(paired_ratio(times, std::vector<double>(times.size(), model)))},
              {"mean_rmse", if_known(errors.mean_rmse)},
              {"worst_rmse", if_known(errors.worst_rmse)},
              {"undefined", errors.undefined},
              {"interior", motion.sampled ? Json(nullptr) : Json(errors.interior)}};
    for (const MotionFrame& frame : frames) j["frames"].push_back(frame_json(frame));
    return j;
}

Json method_motion_json(const SceneMotion& motion, const MethodMotion& method) {
    const TurnTimes& still = method.still;
    Json j                 = {{"name", still.choice.info->name},
                              {"title", still.choice.info->title},
                              {"text", still.choice.text()},
                              {"serves", to_record(service_record(still.service))},
                              {"incremental", false}};  // no method has an update that is less than its phase
    if (method.failed) j["failed"] = *method.failed;
    if (!still.service || still.build.empty()) return j;
    j["memory_bytes"] = still.memory_bytes;
    j["at_rest"]      = to_record(turn_times_record(still));
    for (const Movement movement : kMovements)
        if (!method.of(movement).empty())
            j["movements"][std::string(to_string(movement))] = method_movement_json(motion, method, movement);
    return j;
}

std::string text(const SceneMotion& motion, std::size_t method) { return motion.methods[method].still.choice.text(); }

Json winner_json(const SceneMotion& motion, const std::optional<Winner>& won) {
    if (!won) return nullptr;
    Json ties = Json::array();
    for (const std::size_t m : won->ties) ties.push_back(text(motion, m));
    return {{"method", text(motion, won->method)},
            {"ms", number(won->ms)},
            {"ties", std::move(ties)},
            {"runner_up", won->runner_up ? Json(text(motion, *won->runner_up)) : Json(nullptr)},
            {"runner_up_over_winner", won->runner_up ? ratio_json(won->behind) : Json(nullptr)}};
}

}  // namespace

Json scene_motion_json(const SceneMotion& motion, double max_rmse) {
    Json j = {{"scene", motion.name},
              {"title", motion.title},
              {"triangles", motion.triangles},
              {"size", {{"width", motion.width}, {"height", motion.height}}},
              {"lights", Json::array()},
              {"reference",
               {{"method", motion.reference->choice.text()},
                {"exact", motion.reference->exact},
                {"note", motion.reference->note},
                {"sampled", motion.sampled}}},
              {"noise_bar", number(motion.noise_bar)},
              {"movements", Json::array()},
              {"methods", Json::array()},
              {"winners", Json::array()},
              {"break_even", Json::array()}};
    for (const Light& light : motion.lights)
        j["lights"].push_back({{"name", light.name}, {"kind", to_string(light.kind)}});
    for (const Movement movement : kMovements) {
        const MovementRun& run = motion.of(movement);
        Json entry             = {{"movement", to_string(movement)}};
        if (run.cannot.empty()) {
            entry["what"]      = run.what;
            entry["points_ms"] = number(run.points_ms);
            entry["facts_ms"]  = number(run.facts_ms);
            entry["truth_ms"]  = number(run.truth_ms);
        } else {
            entry["cannot"] = run.cannot;
        }
        j["movements"].push_back(std::move(entry));
    }
    for (const MethodMotion& method : motion.methods) j["methods"].push_back(method_motion_json(motion, method));
    const std::vector<std::size_t> all = complete(motion), good = within(motion, max_rmse);
    for (const Mix& mix : canonical_mixes()) {
        if (!has(motion, mix)) continue;
        Json entry = {{"mix", mix.name}, {"share", Json::object()}};
        for (const Movement movement : kMovements)
            entry["share"][std::string(to_string(movement))] = mix.share[static_cast<std::size_t>(movement)];
        entry["complete"] = winner_json(motion, winner(motion, all, mix));
        entry["within"]   = winner_json(motion, winner(motion, good, mix));
        j["winners"].push_back(std::move(entry));
    }
    for (const BreakEven& pair : break_evens(motion, all))
        j["break_even"].push_back({{"method", text(motion, pair.slow)},
                                   {"over", text(motion, pair.fast)},
                                   {"setup_ms", number(pair.setup_ms)},
                                   {"saves_ms", number(pair.saves_ms)},
                                   {"frames", number(pair.frames)},
                                   {"rounds", interval_json(pair.interval)}});
    return j;
}

}  // namespace umbra
