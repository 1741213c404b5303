#include "umbra/core/io/gltf/scene_builder.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/gltf/extras.h"
#include "umbra/core/io/gltf/lights.h"
#include "umbra/core/io/gltf/materials.h"
#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/vector_text.h"

namespace umbra {

GltfSceneBuilder::GltfSceneBuilder(const JsonText& json, const GltfData& data, const GltfParts& parts,
                                   const dvec3& origin, SceneFile& read, GltfNotes& notes)
    : json_(json), data_(data), parts_(parts), read_(read), scene_(read.scene), notes_(notes) {
    scene_from_world_[3] -= dvec4(origin, 0);
}

void GltfSceneBuilder::check_references(const std::vector<Node>& nodes) const {
    std::uint64_t triangles = 0;
    for (const Node& n : nodes) {
        if (const JsonValue* v = find_member(*n.json, "mesh")) {
            const auto& primitives = parts_.meshes[index_into(json_, *v, "mesh", parts_.meshes.size())];
            for (const Primitive& p : primitives) triangles += p.mesh.triangles.size() * n.instances.size();
            (void)read_morph_weights(json_, *n.json, primitives);
            if (triangles > kMaxTriangles)
                json_.fail(*v, fmt::format("more than {} triangles with this node", kMaxTriangles));
        }
        if (const JsonValue* v = find_member(*n.json, "camera"))
            (void)index_into(json_, *v, "camera", parts_.lenses.size());
        if (const JsonValue* v = find_member(*n.json, "skin")) (void)index_into(json_, *v, "skin", parts_.skins.size());
        (void)light_of(n, kPunctualLights, parts_.lights);
        (void)light_of(n, kAreaLights, parts_.area_lights);
    }
}

void GltfSceneBuilder::place_trees(const std::vector<Node>& nodes, const std::vector<std::size_t>& roots) {
    const std::vector<dmat4> scene_from_node = place_nodes(nodes, scene_from_world_);
    joints_.clear();
    for (const Skin& skin : parts_.skins) joints_.push_back(place_joints(skin, scene_from_node));
    std::vector<std::size_t> open(roots.rbegin(), roots.rend());
    while (!open.empty()) {
        const std::size_t i = open.back();
        open.pop_back();
        const JsonValue* seen = extension(json_, *nodes[i].json, "KHR_node_visibility");
        if (const JsonValue* v = seen ? find_member(*seen, "visible") : nullptr; v && !json_.boolean(*v, "visible"))
            continue;
        place_node(nodes[i], scene_from_node[i]);
        open.insert(open.end(), nodes[i].children.rbegin(), nodes[i].children.rend());
    }
}

void GltfSceneBuilder::place_all_meshes() {
    if (parts_.meshes.empty()) return;
    scene_.warnings.emplace_back("The file has no nodes: all its meshes are shown, without a transform.");
    for (const auto& mesh : parts_.meshes) add_mesh(json_.root(), "", mesh, {scene_from_world_, nullptr, {}});
}

void GltfSceneBuilder::finish() {
    if (!(parts_.lights.empty() && parts_.area_lights.empty()) && !placed_light_)
        scene_.warnings.emplace_back("No node of the scene places one of the file's lights: they are left out.");
    if (!parts_.lenses.empty() && !lens_)
        scene_.warnings.emplace_back("No node of the scene places one of the file's cameras: they are left out.");
    aim_camera();
}

void GltfSceneBuilder::place_node(const Node& node, const dmat4& m) {
    const JsonValue& v     = *node.json;
    const std::string name = name_or(json_, v, "");
    const JsonValue* mesh  = find_member(v, "mesh");
    NodeExtras extras;
    if (const JsonValue* umbra = find_umbra(v)) extras = read_node_extras(json_, *umbra, m, mesh != nullptr);
    if (mesh) {
        const std::size_t first = scene_.objects.size();
        const auto& primitives  = parts_.meshes[index_into(json_, *mesh, "mesh", parts_.meshes.size())];
        const JsonValue* skin   = find_member(v, "skin");
        Pose pose;
        pose.weights = read_morph_weights(json_, v, primitives);
        if (skin) pose.joints = &joints_[index_into(json_, *skin, "skin", joints_.size())];
        for (const dmat4& instance : node.instances) {
            pose.scene_from_mesh = m * instance;
            add_mesh(v, name, primitives, pose);
            if (skin) break;  // its joints place it, wherever the instances are
        }
        for (std::size_t o = first; o < scene_.objects.size(); ++o) scene_.objects[o].switches = extras.switches;
    }
    if (const JsonValue* camera = find_member(v, "camera"))
        place_camera(index_into(json_, *camera, "camera", parts_.lenses.size()), name, m);
    if (const auto* light = light_of(node, kPunctualLights, parts_.lights)) place_light(node, *light, name, m);
    if (const auto* light = light_of(node, kAreaLights, parts_.area_lights)) place_light(node, *light, name, m);
    if (extras.light) {
        if (extras.light->name.empty()) extras.light->name = name;
        add_light(v, std::move(*extras.light));
    }
}

void GltfSceneBuilder::place_camera(std::size_t camera, const std::string& node_name, const dmat4& m) {
    if (!direction(m, 2, "camera", node_name) || !direction(m, 1, "camera", node_name)) return;
    if (!lens_) {
        lens_             = parts_.lenses[camera];
        camera_transform_ = m;
    } else if (!warned_of_cameras_) {
        warned_of_cameras_ = true;
        scene_.warnings.emplace_back("The scene has several cameras: the first is used.");
    }
}

void GltfSceneBuilder::place_light(const Node& node, std::optional<Light> light, const std::string& node_name,
                                   const dmat4& m) {
    placed_light_ = true;
    if (!light) return;
    if (light->name.empty()) light->name = node_name;
    light->position = vec3(dvec3(m[3]));
    if (light->kind != LightKind::point) {
        const auto back = direction(m, 2, "light", node_name);
        if (!back) return;
        light->direction = vec3(-*back);
    }
    if (is_area(light->kind)) {
        const auto along = direction(m, 0, "light", node_name);
        if (!along) return;
        scale_area_light(m, *along, *light);
    }
    add_light(*node.json, std::move(*light));
}

void GltfSceneBuilder::add_mesh(const JsonValue& at, const std::string& name, const std::vector<Primitive>& primitives,
                                const Pose& pose) {
    for (const Primitive& p : primitives) {
        if (p.mesh.triangles.empty()) continue;
        if (p.material && parts_.masks[*p.material].nothing) {
            ++notes_.cut_away;
            continue;
        }
        const Mesh mesh = masked(p, posed(json_, at, data_, p, pose, notes_));
        if (mesh.triangles.empty()) continue;
        for (const vec3 q : mesh.positions)
            if (!(kAnyNumber.holds(q.x) && kAnyNumber.holds(q.y) && kAnyNumber.holds(q.z)))
                json_.fail(at, fmt::format("this node places a vertex at {}, expected numbers from "
                                           "{:g} to {:g}",
                                           vector_text(q), kAnyNumber.min, kAnyNumber.max));
        add_object(scene_, name.empty() ? p.name : name, mesh.positions, mesh.normals, mesh.triangles, material_of(p));
    }
}

Mesh GltfSceneBuilder::masked(const Primitive& primitive, Mesh mesh) {
    if (!primitive.material || !parts_.masks[*primitive.material].texture) return mesh;
    Material& material = scene_.materials[*primitive.material];
    if (const auto& cutout = parts_.cutouts[*primitive.material]; cutout && !material.cutout) {
        std::vector<dvec2> at(mesh.positions.size());
        const auto given = primitive.texture_coordinates.find(cutout->set);
        if (given != primitive.texture_coordinates.end()) {
            const std::vector<vec3> all = data_.vectors(*given->second);
            for (std::size_t i = 0; i < at.size(); ++i) at[i] = dvec2(dvec3(all[primitive.vertices[i]]));
        }
        if (auto left = cut_out(mesh, at, *cutout, kMaxCutTriangles - cut_triangles_)) {
            cut_triangles_ += left->triangles.size();
            return std::move(*left);
        }
    }
    material.cutout = true;
    return mesh;
}

void GltfSceneBuilder::add_light(const JsonValue& node, Light light) {
    if (scene_.lights.size() >= kMaxLights) json_.fail(node, fmt::format("more than {} lights", kMaxLights));
    scene_.lights.push_back(std::move(light));
}

// The camera looks along its node's -z. The target is the point on that axis nearest to the middle of the scene, or
// somewhere in front of the eye where the middle is behind it.
void GltfSceneBuilder::aim_camera() {
    if (!lens_) return;
    Camera camera       = lens_->camera;
    const dvec3 eye     = dvec3(camera_transform_[3]);
    const dvec3 forward = -*direction(camera_transform_, 2, "camera", "");
    const Box box       = bounds(scene_);
    const double middle = box.empty() ? 0 : glm::dot(dvec3(box.centre()) - eye, forward);
    camera.eye          = vec3(eye);
    camera.target       = vec3(eye + forward * std::max({middle, 1e-3 * glm::length(eye), middle > 0 ? 0.0 : 1.0}));
    camera.up           = vec3(*direction(camera_transform_, 1, "camera", ""));
    scene_.camera       = camera;
    read_.has_camera    = true;
    set_picture_size(scene_, lens_->aspect);
}

const std::optional<Light>* GltfSceneBuilder::light_of(const Node& node, std::string_view extension_name,
                                                       const std::vector<std::optional<Light>>& lights) const {
    const JsonValue* e = extension(json_, *node.json, extension_name);
    if (!e) return nullptr;
    const JsonValue* v = find_member(*e, "light");
    if (!v) json_.fail(*e, fmt::format("{} of a node has no light", extension_name));
    return &lights[index_into(json_, *v, "light", lights.size())];
}

std::optional<dvec3> GltfSceneBuilder::direction(const dmat4& m, int axis, std::string_view whose,
                                                 const std::string& node_name) {
    const dvec3 d(m[axis]);
    const double l = glm::length(d);
    if (l > 0 && std::isfinite(l)) return d / l;
    scene_.warnings.push_back(fmt::format(
        "The {} of node \"{}\" has no direction, since the node is scaled to 0: it is left out.", whose, node_name));
    return std::nullopt;
}

std::uint32_t GltfSceneBuilder::material_of(const Primitive& primitive) {
    if (primitive.material) return static_cast<std::uint32_t>(*primitive.material);
    if (!default_material_) {
        default_material_ = static_cast<std::uint32_t>(scene_.materials.size());
        scene_.materials.push_back(default_gltf_material());
    }
    return *default_material_;
}

}  // namespace umbra
