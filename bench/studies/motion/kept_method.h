// A method as a program keeps it from frame to frame: aimed at every light, with only the needed phases repeated.
#pragma once

#include <functional>
#include <vector>

#include "umbra/bench/lab/at_work.h"
#include "umbra/bench/lab/run.h"
#include "umbra/bench/lab/turns.h"
#include "umbra/bench/studies/motion/animation.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// Which phases a frame repeats. `visibility` is for all lights in every frame: whatever moved, the picture is new.
struct FrameWork {
    bool build = false;
    std::vector<bool> aim;  ///< [light]
    bool look = false;
};
/// camera: look. light: the aim of that light. object: all.
[[nodiscard]] FrameWork frame_work(Movement movement, std::size_t lights, LightId moved);

/// No method has an incremental update, so that a repeated phase starts from nothing.
class KeptMethod {
public:
    /// `scene` and `facts` must outlive this, and move under it. Nothing is built yet. `clock`: milliseconds.
    /// `most`: of each run.
    KeptMethod(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts, std::function<double()> clock,
               const Budget& most = {});

    [[nodiscard]] const MethodChoice& choice() const { return work_.choice(); }
    [[nodiscard]] Service service() const { return work_.service(); }

    /// Another setting of the same method. Returns what is to be repeated because of it.
    FrameWork set(const MethodChoice& choice);

    /// Runs what `work` says on the scene as it is now; the points that it last looked at must still be there. Throws
    /// what the method throws, and std::logic_error where it breaks its contract. Milliseconds; 0 for what was not
    /// repeated.
    RunTimes run(const FrameWork& work, const PointBatch& points);

    /// Of the last frame: [light].
    [[nodiscard]] const std::vector<VisibilityPlane>& planes() const { return planes_; }
    /// The last frame as a run, which can be asked further.
    [[nodiscard]] MethodRun as_run() const;
    /// The method with what its phases made, for one who asks it further.
    [[nodiscard]] const MethodAtWork& at_work() const { return work_; }
    [[nodiscard]] std::size_t memory_bytes() const { return work_.memory_bytes() + work_.points_bytes(); }

private:
    MethodAtWork work_;
    const SceneFacts& facts_;
    std::function<double()> clock_;
    Budget most_;
    std::vector<VisibilityPlane> planes_;
};

}  // namespace umbra
