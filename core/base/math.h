// Vector types of the whole project: aliases over GLM, and the few things that GLM lacks.
#pragma once

#include <cstdint>
#include <limits>

#include <glm/glm.hpp>

namespace umbra {

using glm::dmat3;
using glm::dmat4;
using glm::dvec2;
using glm::dvec3;
using glm::dvec4;
using glm::ivec2;
using glm::mat3;
using glm::mat4;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr double kPi      = 3.14159265358979323846;

/// Axis-aligned box. The default one is empty, and extending it by p gives {p, p}.
struct Box {
    vec3 min{+kInfinity};
    vec3 max{-kInfinity};

    [[nodiscard]] bool empty() const { return min.x > max.x; }
    [[nodiscard]] vec3 centre() const { return 0.5f * min + 0.5f * max; }
    [[nodiscard]] vec3 size() const { return max - min; }
    [[nodiscard]] float diagonal() const { return empty() ? 0.0f : glm::length(max - min); }
};
inline Box extend(const Box& b, vec3 p) { return {glm::min(b.min, p), glm::max(b.max, p)}; }
inline Box extend(const Box& a, const Box& b) { return {glm::min(a.min, b.min), glm::max(a.max, b.max)}; }

}  // namespace umbra
