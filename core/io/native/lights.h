// The lights of a native scene file. Internal to core.
#pragma once

#include <filesystem>
#include <vector>

#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// Adds the lights of a list that are switched on; those that are off are checked and left out. Photometric files are
/// looked for from `folder`. Positions become relative to `origin`, but for a light that is fixed to the camera: it has
/// its camera_pose alone.
/// Each sentence is added to `warnings` once.
void read_native_lights(const JsonText& json, const JsonValue& v, const std::filesystem::path& folder,
                        const dvec3& origin, std::vector<Light>& lights, std::vector<std::string>& warnings);

/// Refuses names under "except" that no object has. Called after the objects of the same file are read.
void check_exceptions(const JsonText& json, const JsonValue& lights, const std::vector<Object>& objects);

}  // namespace umbra
