// glTF's lights are given in lux and candela: their exposure in the picture. Internal to core.
#pragma once

#include "umbra/core/scene/scene.h"

namespace umbra {

/// Sets the exposure to 1 / E where the median E over the triangles of the light that arrives lies outside [0.1, 2].
void set_exposure(Scene& scene);

/// Warns where the point and spot lights outshine the directional ones by far, as they do in files that Blender exports
/// with its default units.
void warn_of_units(Scene& scene);

}  // namespace umbra
