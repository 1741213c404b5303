// results.json of `umbra motion`: times and errors of the frames of three movements, and which method is fastest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/bench/studies/motion/animation.h"
#include "umbra/bench/studies/motion/frame_errors.h"

namespace umbra {

DESCRIBE(RunTimes) {
    of("build_ms", &R::build, "0 where the movement does not repeat it", at_least(0));
    of("aim_ms", &R::aim, "one a light");
    of("look_ms", &R::look, "once for all lights; 0 where the movement does not repeat it", at_least(0));
    of("visibility_ms", &R::visibility, "one a light");
}

struct MotionFrame {
    RunTimes times{};
    FrameErrors errors{};
};
DESCRIBE(MotionFrame) {
    of.name("frame");
    of.all(&R::times);
    of.all(&R::errors);
}

/// Of paired times; `coverage` is 0, and the interval unknown, for fewer than six pairs.
struct RatioRecord {
    double median = kUnknown;
    std::vector<double> interval{kUnknown, kUnknown};
    std::uint64_t pairs = 0;
    double coverage     = 0;
};
DESCRIBE(RatioRecord) {
    of.name("ratio");
    MEMBERS(median);
    of(MEMBER(interval),
       "from the k-th least to the k-th largest of the frames' ratios; null: of fewer than six there is none",
       kTwoNumbers);
    MEMBERS(pairs);
    of(MEMBER(coverage),
       "the probability with which the interval holds the median, by the binomial distribution; 0: there is none",
       kFraction);
}

/// The frames of a movement under one method.
struct MovedRecord {
    std::vector<MotionFrame> frames{};
    double sum_ms = kUnknown, mean_ms = kUnknown, median_ms = kUnknown, model_ms = kUnknown,
           measured_over_model = kUnknown;
    RatioRecord frame_over_model{};
    double mean_rmse = kUnknown, worst_rmse = kUnknown;
    std::uint64_t undefined = 0;
    std::optional<std::uint64_t> interior{};
    /// The fraction of the points of all frames that the method answers; nothing where it was asked for none.
    [[nodiscard]] std::optional<double> answered() const;
};
DESCRIBE(MovedRecord) {
    of.name("movement");
    MEMBERS(frames);
    of(MEMBER(sum_ms), "", at_least(0));
    of(MEMBER(mean_ms), "", at_least(0));
    of(MEMBER(median_ms), "of the frames; what winners are found by", at_least(0));
    of(MEMBER(model_ms), "frame_cost_ms of the medians at rest, times the frames", at_least(0));
    of(MEMBER(measured_over_model), "of the sum of the frames to the model: one slow frame moves it");
    of(MEMBER(frame_over_model), "of the median of the frames to the model");
    of(MEMBER(mean_rmse), "of the frames with an answer", kFraction);
    of(MEMBER(worst_rmse), "of the frames with an answer", kFraction);
    MEMBERS(undefined);
    of(MEMBER(interior),
       "wrong points outside the edge band, over all frames; null where lights are compared at a sample");
}

struct MovedMethodRecord {
    std::string name{}, title{}, text{};
    ServiceRecord serves{};
    bool incremental = false;
    std::string failed{};
    std::optional<std::uint64_t> memory_bytes{};
    std::optional<TurnTimesRecord> at_rest{};
    Members<MovedRecord> movements{};
};
DESCRIBE(MovedMethodRecord) {
    MEMBERS(name, title);
    of(MEMBER(text), "as typed");
    MEMBERS(serves);
    of(MEMBER(incremental), "whether a movement updates what was there; false: repeated phases start from nothing");
    of.may(MEMBER(failed), "the message of what it threw");
    of.may(MEMBER(memory_bytes));
    of.may(MEMBER(at_rest), "times of the phases on the scene before anything moves, as the model takes them");
    of.may(MEMBER(movements), "of camera, light, object");
}

struct WinnerRecord {
    std::string method{};
    double ms = kUnknown;
    std::vector<std::string> ties{};
    std::optional<std::string> runner_up{};
    std::optional<RatioRecord> runner_up_over_winner{};
};
DESCRIBE(WinnerRecord) {
    of.name("winner");
    MEMBERS(method);
    of(MEMBER(ms), "", at_least(0));
    of(MEMBER(ties), "methods whose times show no difference to it");
    MEMBERS(runner_up);
    of(MEMBER(runner_up_over_winner), "of the sums of medians by share");
}

struct MixRecord {
    std::string mix{};
    Members<double> share{};
    std::optional<WinnerRecord> complete{}, within{};
};
DESCRIBE(MixRecord) {
    MEMBERS(mix);
    of(MEMBER(share), "of the frames, by movement");
    of(MEMBER(complete), "of the methods that answer every point");
    of(MEMBER(within), "of them, those within max_rmse");
}

struct BreakEvenRecord {
    std::string method{}, over{};
    double setup_ms = kUnknown, saves_ms = kUnknown, frames = kUnknown;
    std::vector<double> rounds{kUnknown, kUnknown};
};
DESCRIBE(BreakEvenRecord) {
    MEMBERS(method, over);
    of(MEMBER(setup_ms), "how much longer its build and aims take", at_least(0));
    of(MEMBER(saves_ms), "how much less time its look and visibility take", at_least(0));
    of(MEMBER(frames), "frames of a moving camera after which it has paid off", at_least(1));
    of(MEMBER(rounds), "least and largest over the rounds; null: never", kTwoNumbers);
}

struct MotionReferenceRecord {
    std::string method{};
    bool exact = false;
    std::string note{};
    bool sampled = false;
};
DESCRIBE(MotionReferenceRecord) {
    MEMBERS(method, exact, note);
    of(MEMBER(sampled), "lights with an area are compared at some of the points");
}

struct MovedLightRecord {
    std::string name{}, kind{};
};
DESCRIBE(MovedLightRecord) { MEMBERS(name, kind); }

/// One movement of the scene. What all methods share is no part of their times: medians over the frames, milliseconds.
struct MovementRecord {
    std::string movement{}, what{}, cannot{};  ///< as of Animation; `what` is empty where the scene cannot
    double points_ms = kUnknown, facts_ms = kUnknown, truth_ms = kUnknown;
};
DESCRIBE(MovementRecord) {
    of(MEMBER(movement), "", one_of({"camera", "light", "object"}));
    of.may(MEMBER(what), "moves, in words");
    of.may(MEMBER(cannot), "why the scene cannot have it; then there is nothing else");
    of.may(MEMBER(points_ms), "new surface points, median of the frames; in no method's time", at_least(0));
    of.may(MEMBER(facts_ms), "", at_least(0));
    of.may(MEMBER(truth_ms), "", at_least(0));
}

struct SceneMotionRecord {
    std::string scene{}, title{};
    std::uint64_t triangles = 0;
    SizeRecord size{};
    std::vector<MovedLightRecord> lights{};
    MotionReferenceRecord reference{};
    double noise_bar = kUnknown;
    std::vector<MovementRecord> movements{};
    std::vector<MovedMethodRecord> methods{};
    std::vector<MixRecord> winners{};
    std::vector<BreakEvenRecord> break_even{};
};
DESCRIBE(SceneMotionRecord) {
    MEMBERS(scene, title, triangles, size, lights, reference);
    of(MEMBER(noise_bar), "how far from 1 the ratio of a method with itself may lie; null: unknown");
    of(MEMBER(movements), "", {.items = kMovements.size()});
    MEMBERS(methods, winners);
    of(MEMBER(break_even), "empty above a noise bar of 30 %");
}

struct MotionRecord {
    HeadRecord head{};
    std::optional<BudgetRecord> budget{};
    MachineRecord machine{};
    LoadRecord load_average{};
    std::uint64_t frames      = 0;
    double arc_degrees        = kUnknown;
    std::uint64_t area_points = 0;
    double max_rmse           = kUnknown;
    std::vector<SceneMotionRecord> motion{};
    std::vector<ListedFailureRecord> failed{};
};
DESCRIBE(MotionRecord) {
    of.all(&R::head);
    of.may(MEMBER(budget));
    MEMBERS(machine);
    of(MEMBER(load_average), "of the last minute, before the first time and after the last; null: unknown");
    of(MEMBER(frames), "of each movement", at_least(1));
    of(MEMBER(arc_degrees), "how far things turn over a movement");
    of(MEMBER(area_points), "about how many points of a frame are compared for lights with an area", at_least(1));
    of(MEMBER(max_rmse), "the bound of the winners `within`, in every frame of every movement", kFraction);
    of(MEMBER(motion), "one entry a scene");
    MEMBERS(failed);
}

struct SceneMotion;
[[nodiscard]] RatioRecord ratio_record(const Ratio& ratio);
/// With the winners and break-even points of the scene.
[[nodiscard]] SceneMotionRecord scene_motion_record(const SceneMotion& motion, double max_rmse);

}  // namespace umbra
