// What a person looks at where a plane changed: reference, result and difference.
#pragma once

#include <filesystem>
#include <vector>

#include "umbra/bench/golden/golden_planes.h"

namespace umbra {

/// Replaces `folder`: reference.S.<light>.png, result.S.<light>.png and difference.S.<light>.png of each changed plane,
/// four pixels a point, and both images as EXR. Throws InputError.
void leave_pictures(const std::filesystem::path& folder, const PreparedScene& prepared, const Image& before,
                    const Image& now, const std::vector<ChangedPlane>& changed);

}  // namespace umbra
