// results.json of `umbra motion`: times and errors of the frames of three movements, and which method is fastest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/motion/motion_summary.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// Of paired times; `coverage` is 0, and the interval unknown, for fewer than six pairs.
struct RatioRecord {
    double median = kUnknown;
    std::vector<double> interval{kUnknown, kUnknown};
    std::uint64_t pairs = 0;
    double coverage     = 0;
};
template <class Fields>
void describe(Fields& of, Is<RatioRecord>) {
    of.name("ratio", "");
    of("median", &RatioRecord::median, "");
    of("interval", &RatioRecord::interval,
       "from the k-th least to the k-th largest of the frames' ratios; null: of fewer than six there is none",
       kTwoNumbers);
    of("pairs", &RatioRecord::pairs, "");
    of("coverage", &RatioRecord::coverage,
       "the probability with which the interval holds the median, by the binomial distribution; 0: there is none",
       kFraction);
}

struct MovementRecord {
    std::string movement{}, what{}, cannot{};
    double points_ms = kUnknown, facts_ms = kUnknown, truth_ms = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<MovementRecord>) {
    of("movement", &MovementRecord::movement, "", one_of({"camera", "light", "object"}));
    of.may("what", &MovementRecord::what, "moves, in words");
    of.may("cannot", &MovementRecord::cannot, "why the scene cannot have it; then there is nothing else");
    of.may("points_ms", &MovementRecord::points_ms, "new surface points, median of the frames; in no method's time",
           at_least(0));
    of.may("facts_ms", &MovementRecord::facts_ms, "", at_least(0));
    of.may("truth_ms", &MovementRecord::truth_ms, "", at_least(0));
}

struct FrameRecord {
    double build_ms = 0, look_ms = 0;
    std::vector<double> aim_ms{}, visibility_ms{};
    std::uint64_t points = 0, undefined = 0, wrong = 0;
    std::optional<std::uint64_t> interior{};
    double rmse = kUnknown, max = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<FrameRecord>) {
    of.name("frame", "");
    of("build_ms", &FrameRecord::build_ms, "0 where the movement does not repeat it", at_least(0));
    of("aim_ms", &FrameRecord::aim_ms, "one a light");
    of("look_ms", &FrameRecord::look_ms, "once for all lights; 0 where the movement does not repeat it", at_least(0));
    of("visibility_ms", &FrameRecord::visibility_ms, "one a light");
    of("points", &FrameRecord::points, "compared, all lights together");
    of("undefined", &FrameRecord::undefined, "");
    of("wrong", &FrameRecord::wrong, "beyond the tolerance of the kind of light, not at the terminator");
    of("interior", &FrameRecord::interior, "");
    of("rmse", &FrameRecord::rmse, "of the points that the method answers; null where it answers none", kFraction);
    of("max", &FrameRecord::max, "", kFraction);
}

/// The frames of a movement under one method.
struct MovedRecord {
    std::vector<FrameRecord> frames{};
    double sum_ms = kUnknown, mean_ms = kUnknown, median_ms = kUnknown, model_ms = kUnknown,
           measured_over_model = kUnknown;
    RatioRecord frame_over_model{};
    double mean_rmse = kUnknown, worst_rmse = kUnknown;
    std::uint64_t undefined = 0;
    std::optional<std::uint64_t> interior{};
    /// The fraction of the points of all frames that the method answers; nothing where it was asked for none.
    [[nodiscard]] std::optional<double> answered() const;
};
template <class Fields>
void describe(Fields& of, Is<MovedRecord>) {
    of.name("movement", "");
    of("frames", &MovedRecord::frames, "");
    of("sum_ms", &MovedRecord::sum_ms, "", at_least(0));
    of("mean_ms", &MovedRecord::mean_ms, "", at_least(0));
    of("median_ms", &MovedRecord::median_ms, "of the frames; what winners are found by", at_least(0));
    of("model_ms", &MovedRecord::model_ms, "frame_cost_ms of the medians at rest, times the frames", at_least(0));
    of("measured_over_model", &MovedRecord::measured_over_model,
       "of the sum of the frames to the model: one slow frame moves it");
    of("frame_over_model", &MovedRecord::frame_over_model, "of the median of the frames to the model");
    of("mean_rmse", &MovedRecord::mean_rmse, "of the frames with an answer", kFraction);
    of("worst_rmse", &MovedRecord::worst_rmse, "of the frames with an answer", kFraction);
    of("undefined", &MovedRecord::undefined, "");
    of("interior", &MovedRecord::interior,
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
template <class Fields>
void describe(Fields& of, Is<MovedMethodRecord>) {
    of("name", &MovedMethodRecord::name, "");
    of("title", &MovedMethodRecord::title, "");
    of("text", &MovedMethodRecord::text, "as typed");
    of("serves", &MovedMethodRecord::serves, "");
    of("incremental", &MovedMethodRecord::incremental,
       "whether a movement updates what was there; false: repeated phases start from nothing");
    of.may("failed", &MovedMethodRecord::failed, "the message of what it threw");
    of.may("memory_bytes", &MovedMethodRecord::memory_bytes, "");
    of.may("at_rest", &MovedMethodRecord::at_rest,
           "times of the phases on the scene before anything moves, as the model takes them");
    of.may("movements", &MovedMethodRecord::movements, "of camera, light, object");
}

struct WinnerRecord {
    std::string method{};
    double ms = kUnknown;
    std::vector<std::string> ties{};
    std::optional<std::string> runner_up{};
    std::optional<RatioRecord> runner_up_over_winner{};
};
template <class Fields>
void describe(Fields& of, Is<WinnerRecord>) {
    of.name("winner", "");
    of("method", &WinnerRecord::method, "");
    of("ms", &WinnerRecord::ms, "", at_least(0));
    of("ties", &WinnerRecord::ties, "methods whose times show no difference to it");
    of("runner_up", &WinnerRecord::runner_up, "");
    of("runner_up_over_winner", &WinnerRecord::runner_up_over_winner, "of the sums of medians by share");
}

struct MixRecord {
    std::string mix{};
    Members<double> share{};
    std::optional<WinnerRecord> complete{}, within{};
};
template <class Fields>
void describe(Fields& of, Is<MixRecord>) {
    of("mix", &MixRecord::mix, "");
    of("share", &MixRecord::share, "of the frames, by movement");
    of("complete", &MixRecord::complete, "of the methods that answer every point");
    of("within", &MixRecord::within, "of them, those within max_rmse");
}

struct BreakEvenRecord {
    std::string method{}, over{};
    double setup_ms = kUnknown, saves_ms = kUnknown, frames = kUnknown;
    std::vector<double> rounds{kUnknown, kUnknown};
};
template <class Fields>
void describe(Fields& of, Is<BreakEvenRecord>) {
    of("method", &BreakEvenRecord::method, "");
    of("over", &BreakEvenRecord::over, "");
    of("setup_ms", &BreakEvenRecord::setup_ms, "how much longer its build and aims take", at_least(0));
    of("saves_ms", &BreakEvenRecord::saves_ms, "how much less time its look and visibility take", at_least(0));
    of("frames", &BreakEvenRecord::frames, "frames of a moving camera after which it has paid off", at_least(1));
    of("rounds", &BreakEvenRecord::rounds, "least and largest over the rounds; null: never", kTwoNumbers);
}

struct MotionReferenceRecord {
    std::string method{};
    bool exact = false;
    std::string note{};
    bool sampled = false;
};
template <class Fields>
void describe(Fields& of, Is<MotionReferenceRecord>) {
    of("method", &MotionReferenceRecord::method, "");
    of("exact", &MotionReferenceRecord::exact, "");
    of("note", &MotionReferenceRecord::note, "");
    of("sampled", &MotionReferenceRecord::sampled, "lights with an area are compared at some of the points");
}

struct MovedLightRecord {
    std::string name{}, kind{};
};
template <class Fields>
void describe(Fields& of, Is<MovedLightRecord>) {
    of("name", &MovedLightRecord::name, "");
    of("kind", &MovedLightRecord::kind, "");
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
template <class Fields>
void describe(Fields& of, Is<SceneMotionRecord>) {
    of("scene", &SceneMotionRecord::scene, "");
    of("title", &SceneMotionRecord::title, "");
    of("triangles", &SceneMotionRecord::triangles, "");
    of("size", &SceneMotionRecord::size, "");
    of("lights", &SceneMotionRecord::lights, "");
    of("reference", &SceneMotionRecord::reference, "");
    of("noise_bar", &SceneMotionRecord::noise_bar,
       "how far from 1 the ratio of a method with itself may lie; null: unknown");
    of("movements", &SceneMotionRecord::movements, "", {.items = kMovements.size()});
    of("methods", &SceneMotionRecord::methods, "");
    of("winners", &SceneMotionRecord::winners, "");
    of("break_even", &SceneMotionRecord::break_even, "empty above a noise bar of 30 %");
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
template <class Fields>
void describe(Fields& of, Is<MotionRecord>) {
    of.all(&MotionRecord::head);
    of.may("budget", &MotionRecord::budget, "");
    of("machine", &MotionRecord::machine, "");
    of("load_average", &MotionRecord::load_average,
       "of the last minute, before the first time and after the last; null: unknown");
    of("frames", &MotionRecord::frames, "of each movement", at_least(1));
    of("arc_degrees", &MotionRecord::arc_degrees, "how far things turn over a movement");
    of("area_points", &MotionRecord::area_points,
       "about how many points of a frame are compared for lights with an area", at_least(1));
    of("max_rmse", &MotionRecord::max_rmse, "the bound of the winners `within`, in every frame of every movement",
       kFraction);
    of("motion", &MotionRecord::motion, "one entry a scene");
    of("failed", &MotionRecord::failed, "");
}

/// With the winners and break-even points of the scene.
[[nodiscard]] SceneMotionRecord scene_motion_record(const SceneMotion& motion, double max_rmse);
[[nodiscard]] Json motion_schema();  ///< JSON Schema, draft 4

}  // namespace umbra
