#include "umbra/bench/studies/motion/motion_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/lab/pinned_threads.h"
#include "umbra/bench/studies/motion/kept_method.h"
#include "umbra/core/base/error.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/view_facts.h"

namespace umbra {
namespace {

Turns still_times(const PreparedScene& prepared, const std::vector<MethodChoice>& choices,
                  const MotionOptions& options) {
    if (!prepared.facts.hard_lights_only)
        for (const MethodChoice& choice : choices)
            if (choice.make()->measures() != Measure::area)
                throw UsageError(fmt::format("{}: measures irradiance, expected a method that measures visible area",
                                             choice.text()));
    TurnOptions still = options.still;
    still.progress    = [&](const std::string& what) {
        if (options.progress) options.progress(fmt::format("{}, at rest: {}", prepared.scene.name, what));
    };
    return time_in_turns(prepared, choices, still);
}

class MotionRun {
public:
    MotionRun(PreparedScene prepared, const std::vector<MethodChoice>& choices, const MotionOptions& options)
        : options_(options),
          turns_(still_times(prepared, choices, options)),
          scene_(std::move(prepared.scene)),
          facts_(std::move(prepared.facts)),
          points_(std::move(prepared.points)),
          reference_(default_reference(facts_)),
          dice_(options.still.seed) {
        const bool sampled = std::ranges::any_of(scene_.lights, [](const Light& l) { return is_area(l.kind); });
        result_.record     = {.scene     = scene_.name,
                              .title     = scene_.title,
                              .triangles = scene_.triangles.size(),
                              .size      = size_record({points_.raster->width, points_.raster->height}),
                              .reference = {.method  = reference_.choice.text(),
                                            .exact   = reference_.exact,
                                            .note    = reference_.note,
                                            .sampled = sampled},
                              .noise_bar = turns_.noise_bar,
                              .movements = std::vector<MovementRecord>(kMovements.size())};
        for (const Light& light : scene_.lights)
            result_.record.lights.push_back({.name = light.name, .kind = std::string(to_string(light.kind))});
        for (TurnTimes& still : turns_.settings) {
            order_.push_back(order_.size());
            const bool runs = still.service && still.failed.empty();
            kept_.push_back(runs ? std::make_unique<KeptMethod>(still.choice, scene_, facts_, options.still.clock,
                                                                options.still.most)
                                 : nullptr);
            result_.methods.push_back({.still = std::move(still)});
            MethodMotion& method = result_.methods.back();
            if (!method.still.failed.empty()) method.failed = "at rest: " + method.still.failed;
        }
    }

    SceneMotion run() {
        const PinnedThreads pinned;
        for (const Movement movement : kMovements) run_movement(movement);
        return std::move(result_);
    }

private:
    /// Calls `work(m)` for each method that still runs, in a random order; one that throws runs no more.
    template <class Work>
    void in_turns(const std::string& where, const Work& work) {
        dice_.shuffle(order_);
        for (const std::size_t m : order_) {
            if (!kept_[m]) continue;
            try {
                work(m);
            } catch (...) {
                result_.methods[m].failed = fmt::format("{}: {}", where, current_message());
                kept_[m].reset();
            }
        }
    }

    void run_movement(Movement movement) {
        const Animation animation(scene_, facts_, movement);
        MovementRecord& shared = result_.record.movements[static_cast<std::size_t>(movement)];
        shared.movement        = to_string(movement);
        shared.cannot          = animation.cannot();
        if (!shared.cannot.empty()) return;
        shared.what = animation.what();
        if (movement == Movement::light) result_.moved = animation.light();

        const SceneFacts facts_at_start  = facts_;
        const PointBatch points_at_start = points_;
        rays_.emplace(scene_);
        const FrameWork everything = frame_work(Movement::object, scene_.lights.size(), 0);
        in_turns(fmt::format("before the first frame of {}", to_string(movement)),
                 [&](std::size_t m) { (void)kept_[m]->run(everything, points_); });
        const FrameWork work = frame_work(movement, scene_.lights.size(), animation.light());
        std::vector<double> points_ms, facts_ms, truth_ms;
        for (int frame = 1; frame <= options_.frames; ++frame) {
            const std::string where = fmt::format("{}, frame {}", to_string(movement), frame);
            if (options_.progress) options_.progress(fmt::format("{}: {} of {}", scene_.name, where, options_.frames));
            animation.pose(scene_, static_cast<double>(frame) / options_.frames);
            facts_ms.push_back(timed_ms([&] { update_facts(movement); }));
            points_ms.push_back(timed_ms([&] { update_points(animation); }));
            std::optional<FrameTruth> truth;
            truth_ms.push_back(
                timed_ms([&] { truth.emplace(reference_, scene_, facts_, points_, options_.area_points); }));
            in_turns(where, [&](std::size_t m) {
                if (const Service service = kept_[m]->service(); !service)
                    throw MethodError("it does not serve the scene as it is here: " + service.why);
                const RunTimes times = kept_[m]->run(work, points_);
                result_.methods[m].frames[static_cast<std::size_t>(movement)].push_back(
                    {times, truth->errors(kept_[m]->planes())});
            });
        }
        shared.points_ms = median(points_ms);
        shared.facts_ms  = median(facts_ms);
        shared.truth_ms  = median(truth_ms);
        animation.pose(scene_, 0);
        facts_  = facts_at_start;
        points_ = points_at_start;
    }

    /// In place: methods that are not built again hold pointers to the facts.
    void update_facts(Movement movement) {
        if (movement == Movement::object)
            facts_ = find_facts(scene_);
        else
            update_view_facts(scene_, facts_);
    }

    void update_points(const Animation& animation) {
        if (animation.movement() == Movement::light) {
            face_light(points_, scene_, animation.light());
            return;
        }
        if (animation.movement() == Movement::object) rays_.emplace(scene_);
        primary_points(*rays_, scene_, scene_.camera, points_.raster->width, points_.raster->height, points_);
    }

    const MotionOptions& options_;
    Turns turns_;
    Scene scene_;
    SceneFacts facts_;
    PointBatch points_;
    Reference reference_;
    std::optional<RayScene> rays_;
    Shuffler dice_;
    std::vector<std::size_t> order_;                 ///< of methods, as of the last turns
    std::vector<std::unique_ptr<KeptMethod>> kept_;  ///< null where it does not serve or has failed
    SceneMotion result_;
};

}  // namespace

SceneMotion run_motion(PreparedScene prepared, const std::vector<MethodChoice>& choices, const MotionOptions& options) {
    return MotionRun(std::move(prepared), choices, options).run();
}

}  // namespace umbra
