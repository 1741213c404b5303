// glTF's cameras, apart from where their nodes place them. Internal to core.
#pragma once

#include <string>
#include <vector>

#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

struct Lens {
    Camera camera;      ///< eye, target and up are not set
    double aspect = 0;  ///< width / height of the picture; 0: the file leaves it open
};

/// cameras[index].
[[nodiscard]] Lens read_lens(const JsonText& json, const JsonValue& v, std::size_t index,
                             std::vector<std::string>& warnings);

/// The size of a picture with this aspect; its longer side is 640 pixels. An aspect of 0 changes nothing.
void set_picture_size(Scene& scene, double aspect);

}  // namespace umbra
