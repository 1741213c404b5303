// A method as a program keeps it from frame to frame: aimed at every light, with only the needed phases repeated.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "umbra/bench/motion/animation.h"
#include "umbra/bench/time/turns.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// Which phases a frame repeats. `visibility` is for all lights in every frame: whatever moved, the picture is new.
struct FrameWork {
    bool build = false;
    std::vector<bool> aim;  ///< [light]
};
/// camera: no more than visibility. light: the aim of that light. object: the build and every aim.
[[nodiscard]] FrameWork frame_work(Movement movement, std::size_t lights, LightId moved);

/// One object of the method a light, since a Method is aimed at one light at a time. A program would share the build
/// among them: that of the first is timed, those of the others are not. No method has an incremental update, so that a
/// repeated phase starts from nothing.
class KeptMethod {
public:
    /// `scene` and `facts` must outlive this, and move under it. Nothing is built yet. `clock`: milliseconds.
    KeptMethod(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts, std::function<double()> clock);

    [[nodiscard]] const MethodChoice& choice() const { return choice_; }
    [[nodiscard]] Service service() const { return verdict(*methods_.front(), *facts_); }

    /// Runs what `work` says on the scene as it is now. Throws what the method throws, and std::logic_error where it
    /// breaks its contract. Milliseconds; 0 for what was not repeated.
    RunTimes run(const FrameWork& work, const PointBatch& points);

    /// Of the last frame: [light].
    [[nodiscard]] const std::vector<VisibilityPlane>& planes() const { return planes_; }

private:
    [[nodiscard]] double timed(const std::function<void()>& work) const;

    MethodChoice choice_;
    const Scene* scene_;
    const SceneFacts* facts_;
    std::function<double()> clock_;
    std::vector<std::unique_ptr<Method>> methods_;  ///< [light]
    std::vector<VisibilityPlane> planes_;
};

}  // namespace umbra
