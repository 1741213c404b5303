// What the animations say: does the sum of the phases predict them, which method is fastest where, when a build pays.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "umbra/bench/motion/motion_run.h"
#include "umbra/bench/statistics/statistics.h"

namespace umbra {

/// Milliseconds of each frame of a movement, all phases and lights.
[[nodiscard]] std::vector<double> frame_times(const MethodMotion& method, Movement movement);

/// What frame_cost_ms says of the medians at rest for a scene in which this moves in every frame; of a light that moves
/// the aim of that light alone.
[[nodiscard]] double model_ms(const SceneMotion& motion, const MethodMotion& method, Movement movement);

/// Over the frames of a movement, both undefined where there are none.
struct ErrorSummary {
    std::optional<double> mean_rmse, worst_rmse;  ///< of the frames with an answer; nothing where there is none
    std::uint64_t undefined = 0, interior = 0;    ///< over all frames
};
[[nodiscard]] ErrorSummary summarise_errors(const std::vector<MotionFrame>& frames);

/// A mix of frames: the fraction of frames in which nothing but the camera moved, in which the light moved, and in
/// which an object moved. They add up to 1.
struct Mix {
    std::string_view name;
    std::array<double, kMovements.size()> share;  ///< [movement]
};
/// The corners, their mixes in equal parts, and 60 frames a second with one light that moves once.
[[nodiscard]] std::vector<Mix> canonical_mixes();
/// Whether the scene has every movement that the mix asks for.
[[nodiscard]] bool has(const SceneMotion& motion, const Mix& mix);

/// Milliseconds of a frame of the mix: the weighted sum of the medians of its movements' frames.
[[nodiscard]] double mix_ms(const MethodMotion& method, const Mix& mix);

/// Which methods compete: those that ran all frames and answered at every point; those of them whose RMSE stayed within
/// a bound in every frame of every movement.
[[nodiscard]] std::vector<std::size_t> complete(const SceneMotion& motion);
[[nodiscard]] std::vector<std::size_t> within(const SceneMotion& motion, double max_rmse);

/// The method with the least mix_ms.
struct Winner {
    std::size_t method = 0;
    double ms          = 0;
    std::vector<std::size_t> ties;         ///< others whose ratio to it does not say that they take longer
    std::optional<std::size_t> runner_up;  ///< the next fastest, if any
    Ratio behind;                          ///< its time over the winner's, of the mix, frame by frame
};
/// Nothing where nobody competes.
[[nodiscard]] std::optional<Winner> winner(const SceneMotion& motion, const std::vector<std::size_t>& competitors,
                                           const Mix& mix);

/// `slow` needs longer until its first frame and less time for each frame of a moving camera: from `frames` frames on,
/// it has paid off.
struct BreakEven {
    std::size_t slow = 0, fast = 0;
    double setup_ms = 0, saves_ms = 0;  ///< longer setup (build and all aims); shorter visibility of all lights
    double frames = 0;
    Interval interval;  ///< of `frames` and those of each round, least and largest; infinite where one saves nothing
};
/// For each pair of methods where neither is first in both, at rest, and both differences are beyond the noise.
[[nodiscard]] std::vector<BreakEven> break_evens(const SceneMotion& motion,
                                                 const std::vector<std::size_t>& competitors);

}  // namespace umbra
