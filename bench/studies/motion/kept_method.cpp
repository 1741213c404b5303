#include "umbra/bench/studies/motion/kept_method.h"

#include <utility>

namespace umbra {

FrameWork frame_work(Movement movement, std::size_t lights, LightId moved) {
    const bool all = movement == Movement::object;
    FrameWork work{all, std::vector<bool>(lights, all), movement != Movement::light};
    if (movement == Movement::light) work.aim[moved] = true;
    return work;
}

KeptMethod::KeptMethod(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts,
                       std::function<double()> clock, const Budget& most)
    : work_(choice, scene, facts), facts_(facts), clock_(std::move(clock)), most_(most), planes_(scene.lights.size()) {}

FrameWork KeptMethod::set(const MethodChoice& choice) {
    const Phase first = first_changed_phase(work_.choice().settings, choice.settings);
    if (work_.choice().text() != choice.text()) work_.set(choice);
    return {first == Phase::build, std::vector<bool>(planes_.size(), first <= Phase::aim), first <= Phase::look};
}

MethodRun KeptMethod::as_run() const {
    MethodRun run{.choice = choice(), .service = service()};
    run.planes      = planes_;
    run.is_coloured = facts_.has_coloured_filters;
    run.work        = std::make_shared<MethodAtWork>(work_);
    return run;
}

RunTimes KeptMethod::run(const FrameWork& work, const PointBatch& points) {
    const std::size_t lights = planes_.size();
    work_.limit(most_);
    RunTimes times{0, std::vector<double>(lights), 0, std::vector<double>(lights)};
    if (work.build) {
        work_.forget_build();
        work_.warm_up();
        times.build = timed_by(clock_, [&] { work_.build(); });
    }
    if (work.look) {
        work_.forget_look();
        times.look = timed_by(clock_, [&] { work_.look(points); });
    }
    // Light by light: where aims take more memory than is kept for them, only the last ones are there.
    for (LightId j = 0; j < lights; ++j) {
        if (work.aim[j]) work_.forget_aim(j);
        times.aim[j] = timed_by(clock_, [&] { work_.aimed(j); });
        if (planes_[j].size() == points.size() && planes_[j].colour.empty() != facts_.has_coloured_filters)
            planes_[j].clear();
        else
            planes_[j] = VisibilityPlane(points.size(), facts_.has_coloured_filters);
        times.visibility[j] = timed_by(clock_, [&] { work_.visibility(j, planes_[j].out()); });
        check_contract(choice().info->name, planes_[j], points, j);
    }
    return times;
}

}  // namespace umbra
