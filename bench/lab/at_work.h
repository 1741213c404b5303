// A method at work on one scene: the values that its phases made, each as it was last made.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>

#include "umbra/bench/lab/budget.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// One caller at a time. The scene and its facts must outlive it; where they change in place, the caller repeats the
/// phases that depend on what changed. A phase that throws leaves nothing behind, and the phases before it as they
/// were.
class MethodAtWork {
public:
    /// Makes the method; no phase has run. Throws UsageError where the settings contradict one another.
    MethodAtWork(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts);

    /// What all that follows may take, from now on; that of copies too. Phases throw CutShort where it is more.
    void limit(const Budget& budget) {
        spending_ = budget.is_set() ? std::make_shared<const Spending>(budget) : nullptr;
    }
    void lift_limit() { spending_.reset(); }

    /// Another setting of the same method. What the phases before the first changed one made stays.
    void set(const MethodChoice& choice);

    [[nodiscard]] const MethodChoice& choice() const { return choice_; }
    [[nodiscard]] const Method& method() const { return *method_; }
    [[nodiscard]] Service service() const { return verdict(*method_, *facts_); }

    /// The phases, again: what they made before is dropped first, and all that was made from it. `build` and `aim` are
    /// those of Method; `points` must outlive the next `look`.
    void build();
    void aim(LightId light);
    void look(const PointBatch& points);
    /// What need not be inside a clock: Method::warm_up, which `build` does otherwise, and dropping what `build`, what
    /// `aim` (of one light, of all), what `look` made.
    void warm_up();
    void forget_build();
    void forget_aim(LightId light) { aimed_.erase(light); }
    void forget_aims() { aimed_.clear(); }
    void forget_look() { looked_.reset(); }

    /// What a phase made; it runs first where it has not. Of aims the last ones are kept, up to half a gigabyte.
    const Built& built();
    const Aimed& aimed(LightId light);
    /// What `look` made; it has run.
    [[nodiscard]] const Looked& looked() const { return *looked_; }
    [[nodiscard]] bool is_built() const { return built_ != nullptr; }
    [[nodiscard]] bool is_aimed_at(LightId light) const { return aimed_.contains(light); }
    [[nodiscard]] bool looks_at(const PointBatch& points) const { return looked_ && &looked_->points == &points; }

    /// S_j at the points that it looks at, and what is decided without the method. `out` as Method::visibility wants
    /// it.
    void visibility(LightId light, const Visibility& out);
    /// S_j, and the blockers, at any other points, which it looks at for this call alone.
    [[nodiscard]] VisibilityPlane ask(const PointBatch& points, LightId light);
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers);

    /// Bytes of what `build` and the last `aim` made, and of what `look` made; on the host, and on a device.
    [[nodiscard]] std::size_t memory_bytes() const;
    [[nodiscard]] std::size_t points_bytes() const { return looked_ ? looked_->memory_bytes() : 0; }
    [[nodiscard]] std::size_t device_bytes() const;

private:
    void drop_aims_over_budget();
    /// `phase` within the limit.
    template <class Phase>
    void spend(const Phase& phase) const;

    MethodChoice choice_;
    const Scene* scene_;
    const SceneFacts* facts_;
    std::shared_ptr<const Method> method_;
    // Declared in this order: what was made from another value goes before it.
    std::shared_ptr<const Built> built_;
    std::map<LightId, std::shared_ptr<const Aimed>> aimed_;
    std::shared_ptr<const Looked> looked_;
    std::shared_ptr<const Spending> spending_;  ///< null: no limit
    bool is_warm_ = false;
    LightId last_ = 0;  ///< the light that was aimed at last
};

}  // namespace umbra
