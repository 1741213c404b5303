// The hierarchy of a glTF file's nodes, checked: a forest. Internal to core.
#pragma once

#include <string>
#include <vector>

#include "umbra/core/io/gltf/data.h"
#include "umbra/core/io/json_text.h"

namespace umbra {

struct Node {
    const JsonValue* json = nullptr;
    dmat4 local{1};  ///< from the node's space to its parent's
    std::vector<std::size_t> children;
    std::vector<dmat4> instances{dmat4(1)};  ///< of its mesh, each from the mesh's space to the node's
};

/// All nodes of the file, those of no scene included. Refuses cycles and nodes with several parents.
[[nodiscard]] std::vector<Node> read_nodes(const JsonText& json);

/// From each node's space to the scene's, of all nodes. `scene_from_world` places the roots.
[[nodiscard]] std::vector<dmat4> place_nodes(const std::vector<Node>& nodes, const dmat4& scene_from_world);

/// The instances of EXT_mesh_gpu_instancing.
void read_instances(const JsonText& json, const GltfData& data, std::vector<Node>& nodes);

/// The roots of the scene that the file shows, or all nodes without parent where it has no scenes.
[[nodiscard]] std::vector<std::size_t> read_roots(const JsonText& json, const std::vector<Node>& nodes,
                                                  std::vector<std::string>& warnings);

}  // namespace umbra
