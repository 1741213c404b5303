// Parts of a glTF file that are not read or not allowed: one warning per kind, however often it occurs. Internal to
// core.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "umbra/core/io/file_normals.h"

namespace umbra {

struct GltfNotes {
    bool textures = false, vertex_colours = false, no_position = false;
    bool emissive_above_one      = false;
    bool no_share                = false;        ///< a factor that is not from 0 to 1
    std::size_t points_and_lines = 0;            ///< primitives
    std::size_t cut_away         = 0;            ///< primitives of which alphaMode MASK leaves nothing
    std::size_t without_joints   = 0;            ///< primitives
    std::size_t skin_weights     = 0;            ///< vertices whose weights are negative or add up to 0
    std::size_t hard_spots = 0, wide_spots = 0;  ///< lights whose angles are out of the extension's limits
    FileNormals normals;                         ///< of the vertices that triangles use

    void warn(std::vector<std::string>& warnings) const;
};

}  // namespace umbra
