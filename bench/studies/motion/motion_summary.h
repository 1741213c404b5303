// What the animations say: does the sum of the phases predict them, which method is fastest where, when a build pays.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "umbra/bench/studies/motion/motion_run.h"

namespace umbra {

/// Milliseconds of each frame of a movement, all phases and lights.
[[nodiscard]] std::vector<double> frame_times(const MethodMotion& method, Movement movement);

/// What frame_cost_ms says of the medians at rest for a scene in which this moves in every frame; of a light that moves
/// the aim of that light alone.
[[nodiscard]] double model_ms(const SceneMotion& motion, const MethodMotion& method, Movement movement);

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

/// Which methods compete: those that ran all frames and answered at every point, with an RMSE of at most `max_rmse` in
/// every frame of every movement.
[[nodiscard]] std::vector<std::size_t> within(const SceneMotion& motion, double max_rmse);
/// The same of any RMSE.
[[nodiscard]] inline std::vector<std::size_t> complete(const SceneMotion& motion) {
    return within(motion, std::numeric_limits<double>::infinity());
}

/// The method with the least weighted sum of the medians of its movements' frames, and the next fastest with the ratio
/// of its time to the winner's, frame by frame. Ties are the others whose ratio does not say that they take longer.
/// Nothing where nobody competes.
[[nodiscard]] std::optional<WinnerRecord> winner(const SceneMotion& motion, const std::vector<std::size_t>& competitors,
                                                 const Mix& mix);

/// For each pair of methods where neither is first in both, at rest, and both differences are beyond the noise.
[[nodiscard]] std::vector<BreakEvenRecord> break_evens(const SceneMotion& motion,
                                                       const std::vector<std::size_t>& competitors);

}  // namespace umbra
