#include "umbra/core/io/gltf/scene_builder.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/gltf/extras.h"
#include "umbra/core/io/gltf/materials.h"
#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/vector_text.h"

namespace umbra {

void GltfSceneBuilder::check_references(const std::vector<Node>& nodes) const {
    std::uint64_t triangles = 0;
    for (const Node& n : nodes) {
        if (const JsonValue* v = find_member(*n.json, "mesh")) {
            for (const Primitive& p : parts_.meshes[index_into(json_, *v, "mesh", parts_.meshes.size())])
                triangles += p.mesh.triangles.size() * n.instances.size();
            if (triangles > kMaxTriangles)
                json_.fail(*v, fmt::format("more than {} triangles with this node", kMaxTriangles));
        }
        if (const JsonValue* v = find_member(*n.json, "camera"))
            (void)index_into(json_, *v, "camera", parts_.lenses.size());
        if (const JsonValue* v = light_of(n)) (void)index_into(json_, *v, "light", parts_.lights.size());
    }
}

void GltfSceneBuilder::place_trees(const std::vector<Node>& nodes, const std::vector<std::size_t>& roots) {
    struct Visit {
        std::size_t node;
        dmat4 world_from_parent;
    };
    std::vector<Visit> open;  // own stack: a hierarchy may be as deep as the file is long
    for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, dmat4(1)});
    while (!open.empty()) {
        const Visit visit = open.back();
        open.pop_back();
        const Node& node            = nodes[visit.node];
        const dmat4 world_from_node = visit.world_from_parent * node.local;
        place_node(node, world_from_node);
        for (auto c = node.children.rbegin(); c != node.children.rend(); ++c) open.push_back({*c, world_from_node});
    }
}

void GltfSceneBuilder::place_all_meshes() {
    if (parts_.meshes.empty()) return;
    scene_.warnings.emplace_back("The file has no nodes: all its meshes are shown, without a transform.");
    for (const auto& mesh : parts_.meshes) add_mesh(json_.root(), "", mesh, dmat4(1));
}

void GltfSceneBuilder::finish() {
    if (!parts_.lights.empty() && !placed_light_)
        scene_.warnings.emplace_back("No node of the scene places one of the file's lights: they are left out.");
    if (!parts_.lenses.empty() && !lens_)
        scene_.warnings.emplace_back("No node of the scene places one of the file's cameras: they are left out.");
    aim_camera();
}

void GltfSceneBuilder::place_node(const Node& node, const dmat4& m) {
    const JsonValue& v     = *node.json;
    const std::string name = name_or(json_, v, "");
    if (const JsonValue* mesh = find_member(v, "mesh"))
        for (const dmat4& instance : node.instances)
            add_mesh(v, name, parts_.meshes[index_into(json_, *mesh, "mesh", parts_.meshes.size())], m * instance);
    if (find_member(v, "skin")) notes_.skins = true;
    if (const JsonValue* camera = find_member(v, "camera"))
        place_camera(index_into(json_, *camera, "camera", parts_.lenses.size()), m);
    if (const JsonValue* light = light_of(node))
        place_light(node, index_into(json_, *light, "light", parts_.lights.size()), name, m);
    if (const JsonValue* extras = find_umbra(v))
        if (auto light = read_area_light(json_, *extras, m)) {
            if (light->name.empty()) light->name = name;
            add_light(v, std::move(*light));
        }
}

void GltfSceneBuilder::place_camera(std::size_t camera, const dmat4& m) {
    if (!lens_) {
        lens_             = parts_.lenses[camera];
        camera_transform_ = m;
    } else if (!warned_of_cameras_) {
        warned_of_cameras_ = true;
        scene_.warnings.emplace_back("The scene has several cameras: the first is used.");
    }
}

void GltfSceneBuilder::place_light(const Node& node, std::size_t light, const std::string& node_name, const dmat4& m) {
    placed_light_ = true;
    if (!parts_.lights[light]) return;
    Light placed = *parts_.lights[light];
    if (placed.name.empty()) placed.name = node_name;
    placed.position = vec3(dvec3(m[3]));
    if (placed.kind != LightKind::point) placed.direction = vec3(direction(m, 2, -1, "light"));
    add_light(*node.json, std::move(placed));
}

void GltfSceneBuilder::add_mesh(const JsonValue& at, const std::string& name, const std::vector<Primitive>& primitives,
                                const dmat4& m) {
    for (const Primitive& p : primitives) {
        if (p.mesh.triangles.empty()) continue;
        const Mesh mesh = placed(p.mesh, m);
        for (const vec3 q : mesh.positions)
            if (!(kAnyNumber.holds(q.x) && kAnyNumber.holds(q.y) && kAnyNumber.holds(q.z)))
                json_.fail(at, fmt::format("this node places a vertex at {}, expected numbers from "
                                           "{:g} to {:g}",
                                           vector_text(q), kAnyNumber.min, kAnyNumber.max));
        add_object(scene_, name.empty() ? p.name : name, mesh.positions, mesh.normals, mesh.triangles, material_of(p));
    }
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
    const dvec3 forward = direction(camera_transform_, 2, -1, "camera");
    const Box box       = bounds(scene_);
    const double middle = box.empty() ? 0 : glm::dot(dvec3(box.centre()) - eye, forward);
    camera.eye          = vec3(eye);
    camera.target       = vec3(eye + forward * std::max({middle, 1e-3 * glm::length(eye), middle > 0 ? 0.0 : 1.0}));
    camera.up           = vec3(direction(camera_transform_, 1, 1, "camera"));
    scene_.camera       = camera;
    read_.has_camera    = true;
    set_picture_size(scene_, lens_->aspect);
}

const JsonValue* GltfSceneBuilder::light_of(const Node& node) const {
    const JsonValue* e = extension(json_, *node.json, "KHR_lights_punctual");
    if (!e) return nullptr;
    const JsonValue* v = find_member(*e, "light");
    if (!v) json_.fail(*e, "KHR_lights_punctual of a node has no light");
    return v;
}

dvec3 GltfSceneBuilder::direction(const dmat4& m, int axis, double sign, std::string_view whose) const {
    const dvec3 d  = dvec3(m[axis]) * sign;
    const double l = glm::length(d);
    if (!(l > 0) || !std::isfinite(l))
        throw InputError(fmt::format("{}: the transform of a {}'s node flattens, which leaves no direction",
                                     json_.source().file, whose));
    return d / l;
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
