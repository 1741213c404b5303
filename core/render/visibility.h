// One light's answers: methods write them, and errors are found in them.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "umbra/core/base/math.h"
#include "umbra/core/scene/lights.h"

namespace umbra {

/// The kind of a method's answer at one point.
enum class Answer : std::uint8_t {
    undefined,   ///< the method cannot tell; s means nothing
    given,       ///< s is the method's answer
    on_boundary  ///< lights as close to this one as one likes disagree, or the point lies on a second triangle: no
                 ///< method is wrong there. Only exact methods say so
};

/// One light's answers as a method writes them, one entry a point of the batch. The memory is the caller's.
struct Visibility {
    std::span<float> s;           ///< S_j, [0, 1]: 1 lit, 0 umbra
    std::span<Answer> answer;     ///< `given` before the call
    std::span<float> half_width;  ///< 0 before the call: |s - truth| is at most this, where a method proves a bracket
    std::span<vec3> colour;       ///< empty, or 0 before the call: S_j per channel, where occluders let a part of the
                                  ///< light through that has another colour (SceneFacts::has_coloured_filters). `s` is
                                  ///< the mean of its channels
    std::atomic<std::uint64_t>* steps = nullptr;  ///< where not null, a method that counts its work adds the number of
                                                  ///< its steps, of about 100 ns each: the same on every machine
};

/// S_j of three channels as one number: their mean, and their own value where they are equal.
[[nodiscard]] inline float mean_of(vec3 s) { return s.r == s.g && s.g == s.b ? s.r : (s.r + s.g + s.b) / 3; }

/// Which fraction of a light S_j measures. For lights without an area both are the same.
enum class Measure : std::uint8_t {
    area,       ///< visible area over the light's area: the default
    irradiance  ///< irradiance that arrives over irradiance without occluders: the cosines at both ends and the squared
                ///< distance are inside the integral. Radiosity and most renderers answer this one
};
[[nodiscard]] constexpr std::string_view to_string(Measure m) { return m == Measure::area ? "area" : "irradiance"; }

/// One light's answers, owned.
struct VisibilityPlane {
    std::vector<float> s;
    std::vector<Answer> answer;
    std::vector<float> half_width;
    std::vector<vec3> colour;  ///< empty where S_j is the same in all channels

    VisibilityPlane() = default;
    /// As a method wants it before the call: s and half_width 0, every answer `given`.
    explicit VisibilityPlane(std::size_t points, bool is_coloured = false)
        : s(points, 0.0f),
          answer(points, Answer::given),
          half_width(points, 0.0f),
          colour(is_coloured ? points : 0, vec3(0)) {}

    /// As after construction, in the memory that is there.
    void clear() {
        s.assign(s.size(), 0.0f);
        answer.assign(answer.size(), Answer::given);
        half_width.assign(half_width.size(), 0.0f);
        colour.assign(colour.size(), vec3(0));
    }
    [[nodiscard]] Visibility out() { return {s, answer, half_width, colour, nullptr}; }
    [[nodiscard]] std::size_t size() const { return s.size(); }
    [[nodiscard]] bool defined(std::size_t i) const { return answer[i] != Answer::undefined; }
};

/// The difference that counts as a wrong S_j: for lights whose S_j is 0 or 1, the other one; for area lights, a
/// difference that shows in a penumbra and that the noise of a sampled reference does not reach.
inline constexpr float kHardTolerance = 0.5f;
inline constexpr float kAreaTolerance = 0.1f;
[[nodiscard]] constexpr float visibility_tolerance(LightKind kind) {
    return is_area(kind) ? kAreaTolerance : kHardTolerance;
}

}  // namespace umbra
