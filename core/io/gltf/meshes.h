// The meshes of a glTF file. Internal to core.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "umbra/core/io/gltf/data.h"
#include "umbra/core/io/gltf/notes.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {

/// Displacements of all vertices that the file has for the primitive; null: none.
struct MorphTarget {
    const GltfAccessor* positions = nullptr;
    const GltfAccessor* normals   = nullptr;
};

/// Four joints of a skin that move a vertex, with their weights.
struct Influence {
    glm::uvec4 joints{0};
    vec4 weights{0};
};

struct Primitive {
    std::string name;
    Mesh mesh;  ///< in its own space, with the positions that its triangles use
    std::optional<std::size_t> material;
    std::vector<std::uint32_t> vertices;  ///< the mesh's in the order of the file's accessors, one a position
    std::map<std::uint64_t, const GltfAccessor*> texture_coordinates;  ///< of TEXCOORD_n, by n
    std::vector<MorphTarget> targets;
    std::vector<double> weights;                     ///< of the targets where a node says nothing else; may be empty
    std::vector<std::vector<Influence>> influences;  ///< sets of one a position: JOINTS_0 and WEIGHTS_0, ...
};

/// The primitives of triangles, mesh by mesh. `materials` is the number of materials in the file.
[[nodiscard]] std::vector<std::vector<Primitive>> read_meshes(const JsonText& json, const GltfData& data,
                                                              std::size_t materials, GltfNotes& notes,
                                                              std::vector<std::string>& warnings);

/// The "weights" of a mesh or a node, one for each morph target of these primitives; empty where it has none.
[[nodiscard]] std::vector<double> read_morph_weights(const JsonText& json, const JsonValue& v,
                                                     const std::vector<Primitive>& primitives);

/// The mesh in world space. Computed in double, so that a deep hierarchy does not blur positions. A transform that
/// flattens leaves no normals; one that mirrors turns the windings.
[[nodiscard]] Mesh placed(const Mesh& mesh, const dmat4& world_from_mesh);

}  // namespace umbra
