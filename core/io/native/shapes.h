// The shapes that objects of a native scene file name, mesh files apart. Internal to core.
#pragma once

#include <string_view>
#include <vector>

#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {

struct Shape {
    std::string_view type;               ///< "box"
    std::vector<std::string_view> keys;  ///< its own, beside those of every object
    /// In its own space, relative to NativePart::origin: that of the scene on entry, of the mesh on return.
    Mesh (*read)(const JsonText& json, const JsonFields&, dvec3& origin);
};

/// In the order in which messages list them.
[[nodiscard]] const std::vector<Shape>& shapes();

}  // namespace umbra
