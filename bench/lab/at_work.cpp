#include "umbra/bench/lab/at_work.h"

#include <stdexcept>

#include "umbra/core/render/ask_visibility.h"

namespace umbra {
namespace {

constexpr std::size_t kAimsBytes = std::size_t{1} << 29;  ///< that aims may hold together

}  // namespace

MethodAtWork::MethodAtWork(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts)
    : choice_(choice), scene_(&scene), facts_(&facts), method_(choice.make()) {}

template <class Phase>
void MethodAtWork::spend(const Phase& phase) const {
    run_within(spending_.get(), phase);
    if (spending_ && spending_->bounds_memory())
        spending_->check_bytes(memory_bytes() + points_bytes() + device_bytes());
}

void MethodAtWork::set(const MethodChoice& choice) {
    if (choice.info != choice_.info) throw std::logic_error("another setting expected, found another method");
    std::shared_ptr<const Method> method = choice.make();
    const Phase first                    = first_changed_phase(choice_.settings, choice.settings);
    if (first == Phase::build) forget_build();
    if (first <= Phase::aim) forget_aims();
    if (first <= Phase::look) forget_look();
    method_  = std::move(method);
    choice_  = choice;
    is_warm_ = false;
}

void MethodAtWork::forget_build() {
    forget_look();
    forget_aims();
    built_.reset();
    is_warm_ = false;
}

void MethodAtWork::warm_up() {
    if (!is_warm_) run_within(spending_.get(), [&] { method_->warm_up(*scene_, *facts_); });
    is_warm_ = true;
}

void MethodAtWork::build() {
    if (built_) forget_build();
    warm_up();
    spend([&] { built_ = method_->build(*scene_, *facts_); });
}

void MethodAtWork::aim(LightId light) {
    aimed_.erase(light);
    const Built& to_aim = built();
    spend([&] { aimed_[light] = method_->aim(to_aim, light), last_ = light; });
    drop_aims_over_budget();
}

void MethodAtWork::look(const PointBatch& points) {
    forget_look();
    const Built& to_look = built();
    spend([&] { looked_ = method_->look(to_look, points); });
}

const Built& MethodAtWork::built() {
    if (!built_) build();
    return *built_;
}

const Aimed& MethodAtWork::aimed(LightId light) {
    if (!aimed_.contains(light)) aim(light);
    return *aimed_.at(light);
}

void MethodAtWork::drop_aims_over_budget() {
    std::size_t bytes = 0;
    for (const auto& [light, aimed] : aimed_) bytes += aimed->memory_bytes() + aimed->device_bytes();
    for (auto at = aimed_.begin(); at != aimed_.end() && bytes > kAimsBytes;) {
        if (at->first == last_) {
            ++at;
            continue;
        }
        bytes -= at->second->memory_bytes() + at->second->device_bytes();
        at = aimed_.erase(at);
    }
}

void MethodAtWork::visibility(LightId light, const Visibility& out) {
    write_decided(*scene_, looked().points, light, out);
    const Aimed& aim = aimed(light);
    spend([&] { method_->visibility(aim, looked(), out); });
}

VisibilityPlane MethodAtWork::ask(const PointBatch& points, LightId light) {
    VisibilityPlane plane(points.size(), facts_->has_coloured_filters);
    write_decided(*scene_, points, light, plane.out());
    const Aimed& aim = aimed(light);
    spend([&] { method_->visibility(aim, *method_->look(*built_, points), plane.out()); });
    return plane;
}

void MethodAtWork::blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) {
    const Aimed& aim = aimed(light);
    spend([&] { method_->blame(aim, *method_->look(*built_, points), blockers); });
}

std::size_t MethodAtWork::memory_bytes() const {
    const auto last = aimed_.find(last_);
    return (built_ ? built_->memory_bytes() : 0) + (last != aimed_.end() ? last->second->memory_bytes() : 0);
}

std::size_t MethodAtWork::device_bytes() const {
    const auto last = aimed_.find(last_);
    return (built_ ? built_->device_bytes() : 0) + (last != aimed_.end() ? last->second->device_bytes() : 0) +
           (looked_ ? looked_->device_bytes() : 0);
}

}  // namespace umbra
