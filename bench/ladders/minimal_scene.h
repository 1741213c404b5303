// Reducing a scene to what a defect needs.
#pragma once

#include <functional>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// A part of the scene for which `still` holds as it does for the whole: lights, objects and triangles without which it
/// holds, too, are dropped, until none can go or `trials` scenes have been asked.
/// [Andreas Zeller, Ralf Hildebrandt, Simplifying and Isolating Failure-Inducing Input, 2002]
[[nodiscard]] Scene minimal_scene(Scene scene, const std::function<bool(const Scene&)>& still, int trials);

}  // namespace umbra
