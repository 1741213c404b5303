// Views of a scene: its own camera and lights, and others jittered around them.
#pragma once

#include "umbra/core/render/ray.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// How far a jittered view lies from the scene's own. Angles and shares are the largest; each is drawn evenly.
inline constexpr double kJitterYaw   = 12;    ///< degrees, of the eye about the camera's target, about its up vector
inline constexpr double kJitterPitch = 6;     ///< degrees, up and down
inline constexpr double kJitterLight = 0.06;  ///< of the distance from the middle of the scene to the light
inline constexpr double kJitterSun   = 5;     ///< degrees, of directional lights and axes of spot lights

/// View 0 is the scene itself. View v > 0 has the camera and every light moved at random, always the same for the same
/// v. Nothing passes through a triangle on the way from its place in view 0, so that no eye and no light of a room
/// leaves it; what cannot move so far moves less far. `rays`: of the scene, where they are there already.
[[nodiscard]] Scene view_of(const Scene& scene, int view, const RayScene* rays = nullptr);

}  // namespace umbra
