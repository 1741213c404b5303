// Whether a camera can see. Internal to core.
#pragma once

#include <filesystem>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// Throws InputError where the scene's camera or picture size is out of range, or where its directions are degenerate.
void check_camera(const Scene& scene, const std::filesystem::path& file);

}  // namespace umbra
