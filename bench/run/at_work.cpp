#include "umbra/bench/run/at_work.h"

#include <stdexcept>

#include "umbra/core/render/ask_visibility.h"

namespace umbra {
namespace {

constexpr std::size_t kAimsBytes = std::size_t{1} << 29;  ///< that aims may hold together

}  // namespace

MethodAtWork::MethodAtWork(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts)
    : choice_(choice), scene_(&scene), facts_(&facts), method_(choice.make()) {}

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

MethodAtWork MethodAtWork::sibling(const MethodChoice& choice) const {
    MethodAtWork other = *this;
    other.set(choice);
    return other;
}

void MethodAtWork::forget_build() {
    forget_look();
    forget_aims();
    built_.reset();
    is_warm_ = false;
}

void MethodAtWork::warm_up() {
    if (!is_warm_) method_->warm_up(*scene_, *facts_);
    is_warm_ = true;
}

void MethodAtWork::build() {
    if (built_) forget_build();
    warm_up();
    built_ = method_->build(*scene_, *facts_);
}

void MethodAtWork::aim(LightId light) {
    aimed_.erase(light);
    aimed_[light] = method_->aim(built(), light);
    last_         = light;
    drop_aims_over_budget();
}

void MethodAtWork::look(const PointBatch& points) {
    forget_look();
    looked_ = method_->look(built(), points);
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
    method_->visibility(aimed(light), looked(), out);
}

VisibilityPlane MethodAtWork::ask(const PointBatch& points, LightId light) {
    const auto looked = method_->look(built(), points);
    VisibilityPlane plane(points.size(), facts_->has_coloured_filters);
    write_decided(*scene_, points, light, plane.out());
    method_->visibility(aimed(light), *looked, plane.out());
    return plane;
}

void MethodAtWork::blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) {
    const auto looked = method_->look(built(), points);
    method_->blame(aimed(light), *looked, blockers);
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
