// Meshes of PLY, OFF and STL files, without material, camera and light. Internal to core.
//
// These formats are read here and not by a library: those at hand take memory for as many vertices as the header claims
// before they look for them, and do not say where a fault is. Nothing is reserved by a number in the file, so the
// memory in use is never larger than the file by more than a constant factor.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "umbra/core/io/file_normals.h"
#include "umbra/core/io/polygon.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/io/source_text.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {

/// One mesh of a file, which becomes one object.
struct MeshPart {
    std::string name;  ///< empty: the file's name
    Mesh mesh;
    FileNormals normals;
    std::size_t self_crossing = 0;  ///< polygons that cross themselves
    std::size_t too_few       = 0;  ///< polygons of fewer than 3 corners, left out

    void add_polygon(std::span<const std::uint32_t> polygon) {
        if (polygon.size() < 3)
            ++too_few;
        else if (!triangulate(mesh.positions, polygon, mesh.triangles))
            ++self_crossing;
    }
};

/// The parts as a scene with the default material, warned of as `warnings` say, a sentence each without the file's
/// name. Throws InputError where they have no triangle.
[[nodiscard]] SceneFile scene_of(const std::vector<MeshPart>& parts, const std::filesystem::path& file,
                                 const std::vector<std::string>& warnings);

}  // namespace umbra
