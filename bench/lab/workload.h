// What moves in a program, and what a frame then costs with a method.
#pragma once

#include <string>

namespace umbra {

/// Events a second. A camera event needs new surface points, which is a new frame; a light or an object that moves is
/// seen in the next frame.
struct Workload {
    double camera = 60, light = 1, object = 0;
};

/// "camera=60,light=1,object=0" in any order; what is not named is 0. Throws UsageError: what was found, what is
/// expected; also where nothing moves.
[[nodiscard]] Workload parse_workload(const std::string& text);

/// As `parse_workload` reads it.
[[nodiscard]] std::string to_text(const Workload& workload);

/// Milliseconds of the phases of a frame that repeats them, all lights together.
struct PhaseTimes {
    double build = 0, aim = 0, look = 0, visibility = 0;
};

/// Expected milliseconds a frame: p_build build + p_aim aim + p_look look + visibility. There is a frame for each event
/// of the most frequent kind; p is the fraction of the frames, (0, 1], in which the phase is repeated. A moving object
/// repeats all phases, a moving light its aim, and a moving camera the look at the points: aim is repeated at the
/// larger of the rates of lights and objects, look at that of cameras and objects, visibility in every frame. Infinite
/// or NaN times give an infinite or NaN cost, unless their phase is never repeated.
[[nodiscard]] double frame_cost_ms(const Workload& workload, const PhaseTimes& times);

}  // namespace umbra
