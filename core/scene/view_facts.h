// Facts that change where the camera or a light moves.
#pragma once

#include "umbra/core/scene/facts.h"

namespace umbra {

/// Updates the facts that depend on the camera and on positions of lights, for `facts` of the same scene before the
/// camera or a light moved: the places of the lights, and whether the eye is inside a closed object.
void update_view_facts(const Scene& scene, SceneFacts& facts);

}  // namespace umbra
