#include "umbra/core/io/gltf/nodes.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"

namespace umbra {
namespace {

dmat4 transform_of(dvec3 translation, glm::dquat rotation, dvec3 scale) {
    dmat4 m(glm::mat3_cast(rotation));
    for (int k = 0; k < 3; ++k) m[k] *= scale[k];
    m[3] = dvec4(translation, 1);
    return m;
}

/// The rotation at unit length; `rounding` is how far from that the file may be.
glm::dquat unit_rotation(const JsonText& json, const JsonValue& at, const std::string& what, glm::dquat q,
                         double rounding) {
    if (const double length = glm::length(q); !(std::abs(length - 1) <= rounding))
        json.fail(at, fmt::format("{} has length {:g}, expected a unit quaternion", what, length));
    return glm::normalize(q);
}

dmat4 local_transform(const JsonText& json, const JsonValue& v, const std::string& what) {
    const JsonValue* matrix = find_member(v, "matrix");
    if (!matrix) {
        const dvec3 t = vector_or(json, &v, "translation", kAnyNumber, dvec3(0));
        const dvec3 s = vector_or(json, &v, "scale", kAnyNumber, dvec3(1));
        glm::dquat q(1, 0, 0, 0);
        if (const JsonValue* r = find_member(v, "rotation")) {
            const auto x = numbers(json, *r, "rotation", 4, kAnyNumber);
            q            = unit_rotation(json, *r, "rotation", {x[3], x[0], x[1], x[2]}, 0.01);
        }
        return transform_of(t, q, s);
    }
    for (const auto key : {"translation", "rotation", "scale"})
        if (find_member(v, key))
            json.fail(v, fmt::format("{} has both matrix and {}, expected one of them", what, key));
    const auto x = numbers(json, *matrix, "matrix", 16, kAnyNumber);
    dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = x[std::size_t(i)];
    constexpr double kRounding = 1e-5;  // of a product of matrices in float
    for (int k = 0; k < 4; ++k) {
        if (!(std::abs(m[k][3] - (k == 3 ? 1 : 0)) <= kRounding))
            json.fail(*matrix, fmt::format("the last row of matrix is ({}, {}, {}, {}), expected (0, 0, 0, 1)", m[0][3],
                                           m[1][3], m[2][3], m[3][3]));
        m[k][3] = k == 3 ? 1 : 0;
    }
    return m;
}

/// The accessor of an instance's attribute, or null.
const GltfAccessor* find_attribute(const JsonText& json, const GltfData& data, const JsonValue& attributes,
                                   std::string_view name, int components) {
    const JsonValue* v = find_member(attributes, name);
    if (v == nullptr) return nullptr;
    const GltfAccessor& accessor = data.accessors()[index_into(json, *v, name, data.accessors().size())];
    if (accessor.components != components)
        json.fail(*v,
                  fmt::format("{} has {} components an instance, expected {}", name, accessor.components, components));
    return &accessor;
}

std::vector<dmat4> instances_of(const JsonText& json, const GltfData& data, const JsonValue& attributes) {
    (void)json.object(attributes, "attributes");
    const GltfAccessor* translation = find_attribute(json, data, attributes, "TRANSLATION", 3);
    const GltfAccessor* rotation    = find_attribute(json, data, attributes, "ROTATION", 4);
    const GltfAccessor* scale       = find_attribute(json, data, attributes, "SCALE", 3);
    std::optional<std::uint64_t> count;
    for (const GltfAccessor* a : {translation, rotation, scale}) {
        if (a == nullptr) continue;
        if (count && *count != a->count)
            json.fail(attributes, fmt::format("attributes of {} and of {} instances, expected one number of them",
                                              *count, a->count));
        count = a->count;
    }
    if (!count) return {dmat4(1)};  // attributes of other meanings
    const std::vector<vec3> t = translation ? data.vectors(*translation) : std::vector<vec3>();
    const std::vector<vec4> r = rotation ? data.quadruples(*rotation) : std::vector<vec4>();
    const std::vector<vec3> s = scale ? data.vectors(*scale) : std::vector<vec3>();
    std::vector<dmat4> instances;
    for (std::size_t i = 0; i < *count; ++i) {
        glm::dquat q(1, 0, 0, 0);
        if (rotation)
            q = unit_rotation(json, attributes, fmt::format("ROTATION of instance {}", i),
                              {double(r[i].w), double(r[i].x), double(r[i].y), double(r[i].z)},
                              0.02);  // of 8 bits, too
        instances.push_back(transform_of(translation ? dvec3(t[i]) : dvec3(0), q, scale ? dvec3(s[i]) : dvec3(1)));
    }
    return instances;
}

}  // namespace

void read_instances(const JsonText& json, const GltfData& data, std::vector<Node>& nodes) {
    for (Node& node : nodes)
        if (const JsonValue* instancing = extension(json, *node.json, "EXT_mesh_gpu_instancing"))
            if (const JsonValue* attributes = find_member(*instancing, "attributes"))
                node.instances = instances_of(json, data, *attributes);
}

std::vector<Node> read_nodes(const JsonText& json) {
    const JsonArray& list = list_of(json, json.root(), "nodes");
    std::vector<Node> nodes(list.size());
    constexpr auto kRoot = std::size_t(-1);
    std::vector<std::size_t> parent(list.size(), kRoot);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const auto what = fmt::format("nodes[{}]", i);
        (void)json.object(list[i], what);
        nodes[i].json  = &list[i];
        nodes[i].local = local_transform(json, list[i], what);
        for (const JsonValue& c : list_of(json, list[i], "children")) {
            const std::size_t child = index_into(json, c, "node", list.size());
            if (parent[child] != kRoot)
                json.fail(
                    c, fmt::format("node {} is a child of node {} already, expected one parent", child, parent[child]));
            parent[child] = i;
            nodes[i].children.push_back(child);
        }
    }
    // Each node has at most one parent, so a path upwards of more steps than there are nodes is a cycle. Nodes whose
    // path is known to end at a root are not followed again.
    std::vector<bool> ends(list.size(), false);
    for (std::size_t i = 0; i < list.size(); ++i) {
        std::vector<std::size_t> path;
        for (std::size_t n = i; n != kRoot && !ends[n]; n = parent[n]) {
            if (path.size() > list.size())
                json.fail(list[i], fmt::format("nodes[{}] is its own ancestor, expected a tree", i));
            path.push_back(n);
        }
        for (const std::size_t n : path) ends[n] = true;
    }
    return nodes;
}

namespace {

std::vector<bool> find_children(const std::vector<Node>& nodes) {
    std::vector<bool> is_child(nodes.size(), false);
    for (const Node& n : nodes)
        for (const std::size_t c : n.children) is_child[c] = true;
    return is_child;
}

}  // namespace

std::vector<dmat4> place_nodes(const std::vector<Node>& nodes, const dmat4& scene_from_world) {
    std::vector<dmat4> placed(nodes.size());
    std::vector<std::size_t> open;  // own stack: a hierarchy may be as deep as the file is long
    const std::vector<bool> is_child = find_children(nodes);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (is_child[i]) continue;
        placed[i] = scene_from_world * nodes[i].local;
        open.push_back(i);
    }
    while (!open.empty()) {
        const std::size_t parent = open.back();
        open.pop_back();
        for (const std::size_t c : nodes[parent].children) {
            placed[c] = placed[parent] * nodes[c].local;
            open.push_back(c);
        }
    }
    return placed;
}

std::vector<std::size_t> read_roots(const JsonText& json, const std::vector<Node>& nodes,
                                    std::vector<std::string>& warnings) {
    const JsonArray& scenes          = list_of(json, json.root(), "scenes");
    const std::vector<bool> is_child = find_children(nodes);
    std::vector<std::size_t> roots;
    if (scenes.empty()) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (!is_child[i]) roots.push_back(i);
        if (!nodes.empty()) warnings.emplace_back("The file has no scenes: all its nodes are shown.");
        return roots;
    }
    if (scenes.size() > 1 && !find_member(json.root(), "scene"))
        warnings.push_back(
            fmt::format("The file names none of its {} scenes as the one to show: the first is shown.", scenes.size()));
    const JsonValue& s = *shown_scene(json);
    (void)json.object(s, "scene");
    std::vector<bool> taken(nodes.size(), false);
    for (const JsonValue& v : list_of(json, s, "nodes")) {
        const std::size_t n = index_into(json, v, "node", nodes.size());
        if (taken[n] || is_child[n])
            json.fail(v, fmt::format("node {} is {} (a scene's nodes are roots, each once)", n,
                                     taken[n] ? "named twice" : "the child of another"));
        taken[n] = true;
        roots.push_back(n);
    }
    return roots;
}

}  // namespace umbra
