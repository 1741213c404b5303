// All that happens to a scene after it was read, on a tiny picture.
#pragma once

#include <filesystem>

namespace umbra {

/// Loads the scene, finds its facts and surface points, runs every method with several settings on every light, shades
/// and compares with the reference. Scenes too large for a quick run are read only. Throws InputError and UsageError
/// where the scene is refused, std::logic_error where a method breaks its contract or a picture holds what is no
/// number, and what the methods throw.
void run_pipeline(const std::filesystem::path& scene);

}  // namespace umbra
