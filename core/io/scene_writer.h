// Scenes as native files (scenes/README.md): a scene that was made in memory is written so that it can be looked at
// again.
#pragma once

#include <string>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// The scene as one native JSON file, its triangles inline: load_scene gives the same floats, bit for bit. Lights whose
/// direction has not gone through load_scene keep that direction, scaled. Positions that no triangle uses are left out.
/// The reader takes files of up to 32 MB, which is some 300,000 triangles.
[[nodiscard]] std::string native_text(const Scene& scene);

/// One of its lights as an entry of `lights` there.
[[nodiscard]] std::string native_light_text(const Scene& scene, const Light& light);

}  // namespace umbra
