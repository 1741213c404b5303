#include "umbra/bench/motion/kept_method.h"

#include <utility>

#include "umbra/bench/run/contract.h"

namespace umbra {

FrameWork frame_work(Movement movement, std::size_t lights, LightId moved) {
    FrameWork work{movement == Movement::object, std::vector<bool>(lights, movement == Movement::object)};
    if (movement == Movement::light) work.aim[moved] = true;
    return work;
}

KeptMethod::KeptMethod(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts,
                       std::function<double()> clock)
    : choice_(choice), scene_(&scene), facts_(&facts), clock_(std::move(clock)), planes_(scene.lights.size()) {
    for (std::size_t j = 0; j < scene.lights.size(); ++j) methods_.push_back(choice.make());
}

double KeptMethod::timed(const std::function<void()>& work) const {
    const double start = clock_();
    work();
    return clock_() - start;
}

RunTimes KeptMethod::run(const FrameWork& work, const PointBatch& points) {
    const std::size_t lights = methods_.size();
    RunTimes times{0, std::vector<double>(lights), std::vector<double>(lights)};
    if (work.build) {
        times.build = timed([&] { methods_.front()->build(*scene_, *facts_); });
        for (std::size_t j = 1; j < lights; ++j) methods_[j]->build(*scene_, *facts_);
    }
    for (LightId j = 0; j < lights; ++j)
        if (work.aim[j]) times.aim[j] = timed([&] { methods_[j]->aim(j); });
    for (LightId j = 0; j < lights; ++j) {
        if (planes_[j].size() == points.size())
            planes_[j].clear();
        else
            planes_[j] = VisibilityPlane(points.size());
        times.visibility[j] = timed([&] { methods_[j]->visibility(points, j, planes_[j].out()); });
        check_contract(choice_.info->name, planes_[j], points, j);
    }
    return times;
}

}  // namespace umbra
