// Places the meshes, lights and cameras of a glTF file in one scene. Internal to core.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/core/io/gltf/cameras.h"
#include "umbra/core/io/gltf/meshes.h"
#include "umbra/core/io/gltf/nodes.h"
#include "umbra/core/io/gltf/notes.h"
#include "umbra/core/io/scene_readers.h"

namespace umbra {

/// What nodes refer to by index, as the file lists it.
struct GltfParts {
    std::vector<std::vector<Primitive>> meshes;
    std::vector<std::optional<Light>> lights;  ///< nothing: of an unknown type
    std::vector<Lens> lenses;
};

class GltfSceneBuilder {
public:
    /// All arguments must outlive this object.
    GltfSceneBuilder(const JsonText& json, const GltfParts& parts, SceneFile& read, GltfNotes& notes)
        : json_(json), parts_(parts), read_(read), scene_(read.scene), notes_(notes) {}

    /// Checks every node's references, those of nodes outside the scene included, and how many triangles they place:
    /// many nodes may share one large mesh.
    void check_references(const std::vector<Node>& nodes) const;
    /// Places what the trees below `roots` refer to.
    void place_trees(const std::vector<Node>& nodes, const std::vector<std::size_t>& roots);
    /// A file without nodes is a library of meshes: they are shown where they are.
    void place_all_meshes();
    /// Warns of lights and cameras that no node placed, and points the camera at the scene.
    void finish();

private:
    void place_node(const Node& node, const dmat4& m);
    void place_camera(std::size_t camera, const dmat4& m);
    void place_light(const Node& node, std::size_t light, const std::string& node_name, const dmat4& m);
    void add_mesh(const JsonValue& at, const std::string& name, const std::vector<Primitive>& primitives,
                  const dmat4& m);
    void add_light(const JsonValue& node, Light light);
    void aim_camera();
    [[nodiscard]] const JsonValue* light_of(const Node& node) const;
    [[nodiscard]] dvec3 direction(const dmat4& m, int axis, double sign, std::string_view whose) const;
    [[nodiscard]] std::uint32_t material_of(const Primitive& primitive);

    const JsonText& json_;
    const GltfParts& parts_;
    SceneFile& read_;
    Scene& scene_;
    GltfNotes& notes_;
    std::optional<Lens> lens_;
    dmat4 camera_transform_{1};
    bool warned_of_cameras_ = false;
    bool placed_light_      = false;
    std::optional<std::uint32_t> default_material_;
};

}  // namespace umbra
