// The meshes of a glTF file. Internal to core.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/core/io/gltf/data.h"
#include "umbra/core/io/gltf/notes.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {

struct Primitive {
    std::string name;
    Mesh mesh;  ///< in its own space, with the positions that its triangles use
    std::optional<std::size_t> material;
};

/// The primitives of triangles, mesh by mesh. `materials` is the number of materials in the file.
[[nodiscard]] std::vector<std::vector<Primitive>> read_meshes(const JsonText& json, const GltfData& data,
                                                              std::size_t materials, GltfNotes& notes,
                                                              std::vector<std::string>& warnings);

/// The mesh in world space. Computed in double, so that a deep hierarchy does not blur positions. A transform that
/// flattens leaves no normals; one that mirrors turns the windings.
[[nodiscard]] Mesh placed(const Mesh& mesh, const dmat4& world_from_mesh);

}  // namespace umbra
