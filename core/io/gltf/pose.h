// Meshes as a node shows them: displaced by morph targets, then placed by the joints of a skin or by the node itself.
// Animations apart, this is the pose of the file. Internal to core.
#pragma once

#include <vector>

#include "umbra/core/io/gltf/data.h"
#include "umbra/core/io/gltf/meshes.h"
#include "umbra/core/io/gltf/notes.h"

namespace umbra {

struct Skin {
    std::vector<std::size_t> joints;     ///< nodes, not empty
    std::vector<dmat4> joint_from_mesh;  ///< one a joint: the inverse bind matrices
};

/// `nodes` is the number of nodes in the file.
[[nodiscard]] std::vector<Skin> read_skins(const JsonText& json, const GltfData& data, std::size_t nodes);

/// From the mesh's space to the scene's, one a joint.
[[nodiscard]] std::vector<dmat4> place_joints(const Skin& skin, const std::vector<dmat4>& scene_from_node);

/// The effect of a node on its mesh.
struct Pose {
    dmat4 scene_from_mesh{1};
    const std::vector<dmat4>* joints = nullptr;  ///< of its skin, which replaces scene_from_mesh; null: it has none
    std::vector<double> weights;                 ///< of morph targets; empty: those of the mesh
};

/// The mesh in the scene's space. `at` is the node that asks for it, for messages.
[[nodiscard]] Mesh posed(const JsonText& json, const JsonValue& at, const GltfData& data, const Primitive& primitive,
                         const Pose& pose, GltfNotes& notes);

}  // namespace umbra
