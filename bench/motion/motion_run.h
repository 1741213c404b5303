// The three animations of one scene under several methods, run frame by frame.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/motion/frame_errors.h"
#include "umbra/bench/motion/kept_method.h"
#include "umbra/bench/run/prepare.h"
#include "umbra/bench/run/reference.h"
#include "umbra/bench/time/turns.h"

namespace umbra {

struct MotionOptions {
    int frames                = 16;    ///< of each movement; at least 1
    std::uint64_t area_points = 1024;  ///< at which lights with an area are compared; at least 1
    /// Of the scene that does not move, for the model; its clock times frames, too.
    TurnOptions still{.budget_ms = 20000};
    std::function<void(const std::string&)> progress{};  ///< may be empty
};

DESCRIBE(RunTimes) {
    of("build_ms", &R::build, "0 where the movement does not repeat it", at_least(0));
    of("aim_ms", &R::aim, "one a light");
    of("look_ms", &R::look, "once for all lights; 0 where the movement does not repeat it", at_least(0));
    of("visibility_ms", &R::visibility, "one a light");
}

struct MotionFrame {
    RunTimes times{};
    FrameErrors errors{};
};
DESCRIBE(MotionFrame) {
    of.name("frame");
    of.all(&R::times);
    of.all(&R::errors);
}

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

/// One movement of the scene. What all methods share is no part of their times: medians over the frames, milliseconds.
struct MovementRecord {
    std::string movement{}, what{}, cannot{};  ///< as of Animation; `what` is empty where the scene cannot
    double points_ms = kUnknown, facts_ms = kUnknown, truth_ms = kUnknown;
};
DESCRIBE(MovementRecord) {
    of(MEMBER(movement), "", one_of({"camera", "light", "object"}));
    of.may(MEMBER(what), "moves, in words");
    of.may(MEMBER(cannot), "why the scene cannot have it; then there is nothing else");
    of.may(MEMBER(points_ms), "new surface points, median of the frames; in no method's time", at_least(0));
    of.may(MEMBER(facts_ms), "", at_least(0));
    of.may(MEMBER(truth_ms), "", at_least(0));
}

struct SceneMotion {
    std::string name, title;
    std::size_t triangles = 0;
    int width = 0, height = 0;
    std::vector<Light> lights;
    LightId moved = 0;  ///< the light that moves
    std::optional<Reference> reference;
    bool sampled = false;  ///< whether errors are those at a sample of the points (MotionOptions::area_points)
    std::array<MovementRecord, kMovements.size()> movements;
    double noise_bar = 0;  ///< as of Turns
    std::vector<MethodMotion> methods;

    [[nodiscard]] const MovementRecord& of(Movement movement) const {
        return movements[static_cast<std::size_t>(movement)];
    }
};

/// The scene at rest is timed first, by time_in_turns. In each frame every method runs once, in a random order. A
/// method that throws ends there, the others go on. Throws UsageError where a method measures something else than
/// visible area, and what the reference throws.
[[nodiscard]] SceneMotion run_motion(PreparedScene prepared, const std::vector<MethodChoice>& choices,
                                     const MotionOptions& options);

}  // namespace umbra
