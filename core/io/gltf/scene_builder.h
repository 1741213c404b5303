// Places the meshes, lights and cameras of a glTF file in one scene. Internal to core.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/io/gltf/cameras.h"
#include "umbra/core/io/gltf/cutout.h"
#include "umbra/core/io/gltf/materials.h"
#include "umbra/core/io/gltf/meshes.h"
#include "umbra/core/io/gltf/nodes.h"
#include "umbra/core/io/gltf/notes.h"
#include "umbra/core/io/gltf/pose.h"
#include "umbra/core/io/scene_readers.h"

namespace umbra {

/// The things that nodes refer to by index, as the file lists them.
struct GltfParts {
    std::vector<AlphaMask> masks;                ///< of the file's materials
    std::vector<std::optional<Cutout>> cutouts;  ///< of the same; nothing: none, or it cannot be read
    std::vector<std::vector<Primitive>> meshes;
    std::vector<std::optional<Light>> lights;       ///< of KHR_lights_punctual; nothing: of an unknown type
    std::vector<std::optional<Light>> area_lights;  ///< the same of EXT_lights_area
    std::vector<Lens> lenses;
    std::vector<Skin> skins;
};

class GltfSceneBuilder {
public:
    /// All arguments must outlive this object. It places things relative to `origin`, in world space.
    GltfSceneBuilder(const JsonText& json, const GltfData& data, const GltfParts& parts, const dvec3& origin,
                     SceneFile& read, GltfNotes& notes);

    /// Checks every node's references, those of nodes outside the scene included, and how many triangles they place:
    /// many nodes may share one large mesh.
    void check_references(const std::vector<Node>& nodes) const;
    /// Places the meshes, lights and cameras of the trees below `roots`.
    void place_trees(const std::vector<Node>& nodes, const std::vector<std::size_t>& roots);
    /// A file without nodes is a library of meshes: they are shown where they are.
    void place_all_meshes();
    /// Warns of lights and cameras that no node placed, and points the camera at the scene.
    void finish();

private:
    void place_node(const Node& node, const dmat4& m);
    void place_camera(std::size_t camera, const std::string& node_name, const dmat4& m);
    void place_light(const Node& node, std::optional<Light> light, const std::string& node_name, const dmat4& m);
    void add_mesh(const JsonValue& at, const std::string& name, const std::vector<Primitive>& primitives,
                  const Pose& pose);
    /// The mesh as its material's mask leaves it, or as it is and its material a `cutout`.
    [[nodiscard]] Mesh masked(const Primitive& primitive, Mesh mesh);
    void add_light(const JsonValue& node, Light light);
    void aim_camera();
    /// The light of the node by an extension; null where it has none.
    [[nodiscard]] const std::optional<Light>* light_of(const Node& node, std::string_view extension_name,
                                                       const std::vector<std::optional<Light>>& lights) const;
    /// An axis of the node, of length 1; none, and a warning, where the node is scaled to 0.
    [[nodiscard]] std::optional<dvec3> direction(const dmat4& m, int axis, std::string_view whose,
                                                 const std::string& node_name);
    [[nodiscard]] std::uint32_t material_of(const Primitive& primitive);

    const JsonText& json_;
    const GltfData& data_;
    const GltfParts& parts_;
    SceneFile& read_;
    Scene& scene_;
    GltfNotes& notes_;
    dmat4 scene_from_world_{1};
    std::vector<std::vector<dmat4>> joints_;  ///< one list a skin, from the mesh's space to the scene's
    std::optional<Lens> lens_;
    dmat4 camera_transform_{1};
    std::size_t cut_triangles_ = 0;
    bool warned_of_cameras_    = false;
    bool placed_light_         = false;
    std::optional<std::uint32_t> default_material_;
};

}  // namespace umbra
