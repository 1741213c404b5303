// Three animations of a scene: the camera moves, a light moves, an object moves.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

enum class Movement : std::uint8_t { camera, light, object };
inline constexpr std::array kMovements{Movement::camera, Movement::light, Movement::object};
[[nodiscard]] std::string_view to_string(Movement movement);

/// One movement of one scene. All of it is rigid, so that the scene stays the same problem seen otherwise:
/// camera: the eye goes round the target, about the scene's vertical axis. light: the first light goes round the
/// camera's target likewise; a light at infinity turns its direction; a light above the target, which such a turn would
/// leave where it is, turns about the view's horizontal axis. object: one object moves sideways by a quarter of its
/// diagonal and turns about its own vertical axis, so that its heights keep their bits.
class Animation {
public:
    /// Of the scene as it stands, which is not needed afterwards.
    Animation(const Scene& start, const SceneFacts& facts, Movement movement);

    [[nodiscard]] Movement movement() const { return movement_; }
    /// Why the scene cannot have it; empty where it can.
    [[nodiscard]] const std::string& cannot() const { return cannot_; }
    /// What moves and how far, a sentence; of a movement that the scene can have.
    [[nodiscard]] const std::string& what() const { return what_; }
    [[nodiscard]] LightId light() const { return 0; }  ///< the one that moves, where a light does

    /// Writes what moves as it is at `time`, [0, 1]; 0 is the start, bit for bit. `scene` is the scene that it was made
    /// of, at any time of this animation.
    void pose(Scene& scene, double time) const;

private:
    void choose_object(const Scene& start, const SceneFacts& facts);

    Movement movement_;
    std::string cannot_, what_;
    Camera camera_;
    Light light_;
    dvec3 pivot_{0}, axis_{0, 1, 0}, slide_{0};
    int vertical_ = 1;                     ///< the coordinate that heights are measured along
    std::vector<std::uint32_t> vertices_;  ///< of the object that moves
    std::vector<vec3> positions_, normals_;
};

/// Along x, y or z, whichever the camera's up direction is nearest to: heights are measured along it.
[[nodiscard]] dvec3 vertical_axis(const Scene& scene);

/// The object that each position belongs to alone, or one of these.
inline constexpr std::uint32_t kUnusedPosition = ~0u, kSharedPosition = ~0u - 1;
[[nodiscard]] std::vector<std::uint32_t> owners(const Scene& scene);

/// How far things turn over an animation, degrees.
inline constexpr double kArc = 45;

}  // namespace umbra
