// The three animations of one scene under several methods, run frame by frame.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/turns.h"
#include "umbra/bench/studies/motion/motion_record.h"

namespace umbra {

struct MotionOptions {
    int frames                = 16;    ///< of each movement; at least 1
    std::uint64_t area_points = 1024;  ///< at which lights with an area are compared; at least 1
    /// Of the scene that does not move, for the model; its clock times frames, too.
    TurnOptions still{.budget_ms = 20000};
    std::function<void(const std::string&)> progress{};  ///< may be empty
};

/// One method. Frames end where it failed.
struct MethodMotion {
    TurnTimes still;                                                   ///< all phases of the scene at its start
    std::array<std::vector<MotionFrame>, kMovements.size()> frames{};  ///< [movement], none where the scene cannot
    std::optional<std::string> failed{};                               ///< what it threw, and in which frame

    [[nodiscard]] bool ran() const { return still.service && !failed; }
    [[nodiscard]] const std::vector<MotionFrame>& of(Movement movement) const {
        return frames[static_cast<std::size_t>(movement)];
    }
};

struct SceneMotion {
    SceneMotionRecord record{};  ///< without its methods, winners and break-even points: scene_motion_record adds them
    LightId moved = 0;           ///< the light that moves
    std::vector<MethodMotion> methods{};

    [[nodiscard]] const MovementRecord& of(Movement movement) const {
        return record.movements[static_cast<std::size_t>(movement)];
    }
};

/// The scene at rest is timed first, by time_in_turns. In each frame every method runs once, in a random order. A
/// method that throws ends there, the others go on. Throws UsageError where a method measures something else than
/// visible area, and what the reference throws.
[[nodiscard]] SceneMotion run_motion(PreparedScene prepared, const std::vector<MethodChoice>& choices,
                                     const MotionOptions& options);

}  // namespace umbra
