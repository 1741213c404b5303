// The vertex normals of one file, as a reader meets them. Internal to core.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "umbra/core/base/math.h"

namespace umbra {

/// Normals that are not finite or have no length are replaced by zero, which means the normal of the face, and
/// counted. Exporters write them for triangles without area; positions beside them are usually sound.
class FileNormals {
public:
    /// The normal as given, or zero.
    [[nodiscard]] vec3 usable(vec3 normal) {
        ++given_;
        const bool finite = std::isfinite(normal.x) && std::isfinite(normal.y) && std::isfinite(normal.z);
        if (finite && normal != vec3(0)) return normal;
        ++replaced_;
        return vec3(0);
    }
    /// One sentence where any was replaced.
    void warn(std::vector<std::string>& warnings) const {
        if (replaced_ > 0)
            warnings.push_back(fmt::format(
                "{} of {} vertex normals are not finite or have no length: the normals of the faces are used instead.",
                replaced_, given_));
    }

private:
    std::size_t given_ = 0, replaced_ = 0;
};

}  // namespace umbra
