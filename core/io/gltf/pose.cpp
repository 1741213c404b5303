// This work is based on:
// Khronos Group. glTF 2.0 Specification, sections 3.7.2 (Morph Targets) and 3.7.3 (Skins). 2021
#include "umbra/core/io/gltf/pose.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/gltf/members.h"

namespace umbra {
namespace {

vec3 unit_or_zero(dvec3 v) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? vec3(v / length) : vec3(0);
}

Mesh morphed(const GltfData& data, const Primitive& primitive, const std::vector<double>& weights) {
    const Mesh& mesh = primitive.mesh;
    std::vector<dvec3> positions(mesh.positions.begin(), mesh.positions.end());
    std::vector<dvec3> normals(mesh.normals.begin(), mesh.normals.end());
    const auto displace = [&](std::vector<dvec3>& moved, const GltfAccessor* by, double weight) {
        if (!by || moved.empty()) return;
        const std::vector<vec3> displacements = data.vectors(*by);
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += weight * dvec3(displacements[primitive.vertices[i]]);
    };
    for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
        if (weights[t] == 0) continue;
        displace(positions, primitive.targets[t].positions, weights[t]);
        displace(normals, primitive.targets[t].normals, weights[t]);
    }
    Mesh out;
    out.positions.assign(positions.begin(), positions.end());
    for (const dvec3& n : normals) out.normals.push_back(unit_or_zero(n));
    out.triangles = mesh.triangles;
    return out;
}

/// The mean of the joints' transforms that move vertex i, by their weights. `sound` becomes false where a weight is
/// negative or their sum is 0.
dmat4 blend(const Primitive& primitive, const std::vector<dmat4>& joints, std::size_t i, bool& sound) {
    dmat4 sum(0);
    double total = 0;
    for (const std::vector<Influence>& set : primitive.influences)
        for (int k = 0; k < 4; ++k) {
            const auto weight = static_cast<double>(set[i].weights[k]);
            if (weight < 0) sound = false;
            if (!(weight > 0)) continue;
            sum += weight * joints[set[i].joints[k]];
            total += weight;
        }
    if (total > 0) return sum / total;
    sound                     = false;
    const std::uint32_t first = primitive.influences.front()[i].joints[0];
    return joints[first < joints.size() ? first : 0];
}

Mesh skinned(const Mesh& mesh, const Primitive& primitive, const std::vector<dmat4>& joints, GltfNotes& notes) {
    Mesh out;
    out.positions.reserve(mesh.positions.size());
    std::vector<double> determinants;
    determinants.reserve(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        bool sound    = true;
        const dmat4 m = blend(primitive, joints, i, sound);
        notes.skin_weights += sound ? 0 : 1;
        const dmat3 linear(m);
        const double det = glm::determinant(linear);
        determinants.push_back(det);
        out.positions.emplace_back(dvec3(m * dvec4(dvec3(mesh.positions[i]), 1)));
        if (mesh.normals.empty()) continue;
        const bool keeps = det != 0 && std::isfinite(det);
        out.normals.push_back(keeps ? unit_or_zero(glm::transpose(glm::inverse(linear)) * dvec3(mesh.normals[i]))
                                    : vec3(0));
    }
    out.triangles = mesh.triangles;
    for (uvec3& t : out.triangles)
        if (determinants[t.x] + determinants[t.y] + determinants[t.z] < 0) std::swap(t.y, t.z);
    return out;
}

void check_joints(const JsonText& json, const JsonValue& at, const Primitive& primitive, std::size_t joints) {
    for (const std::vector<Influence>& set : primitive.influences)
        for (std::size_t i = 0; i < set.size(); ++i)
            for (int k = 0; k < 4; ++k)
                if (set[i].weights[k] > 0 && set[i].joints[k] >= joints)
                    json.fail(at, fmt::format("vertex {} of {} follows joint {}, but the skin of this node has {} "
                                              "joints, counted from 0",
                                              primitive.vertices[i], primitive.name, set[i].joints[k], joints));
}

}  // namespace

std::vector<Skin> read_skins(const JsonText& json, const GltfData& data, std::size_t nodes) {
    std::vector<Skin> skins;
    const JsonArray& list = list_of(json, json.root(), "skins");
    for (std::size_t i = 0; i < list.size(); ++i) {
        const auto what = fmt::format("skins[{}]", i);
        (void)json.object(list[i], what);
        Skin skin;
        for (const JsonValue& j : list_of(json, list[i], "joints"))
            skin.joints.push_back(index_into(json, j, "joint", nodes));
        if (skin.joints.empty()) json.fail(list[i], what + " has no joints");
        if (const JsonValue* inverse = find_member(list[i], "inverseBindMatrices")) {
            const auto& accessors = data.accessors();
            const GltfAccessor& accessor =
                accessors[index_into(json, *inverse, "inverseBindMatrices", accessors.size())];
            if (accessor.components != 16 || accessor.component_type != 5126)
                json.fail(*inverse, "inverseBindMatrices is not an accessor of type MAT4 of floats");
            if (!accessor.not_finite.empty()) json.fail(*accessor.json, accessor.not_finite);
            if (accessor.count < skin.joints.size())
                json.fail(*inverse, fmt::format("{} has {} joints, but {} inverseBindMatrices", what,
                                                skin.joints.size(), accessor.count));
            const std::vector<mat4> matrices = data.matrices(accessor);
            skin.joint_from_mesh.assign(matrices.begin(), matrices.begin() + std::ptrdiff_t(skin.joints.size()));
        } else {
            skin.joint_from_mesh.assign(skin.joints.size(), dmat4(1));
        }
        skins.push_back(std::move(skin));
    }
    return skins;
}

std::vector<dmat4> place_joints(const Skin& skin, const std::vector<dmat4>& scene_from_node) {
    std::vector<dmat4> joints;
    for (std::size_t j = 0; j < skin.joints.size(); ++j)
        joints.push_back(scene_from_node[skin.joints[j]] * skin.joint_from_mesh[j]);
    return joints;
}

Mesh posed(const JsonText& json, const JsonValue& at, const GltfData& data, const Primitive& primitive,
           const Pose& pose, GltfNotes& notes) {
    const std::vector<double>& weights = pose.weights.empty() ? primitive.weights : pose.weights;
    const bool morphs                  = !primitive.targets.empty() &&
                        std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 0; });
    const Mesh changed = morphs ? morphed(data, primitive, weights) : Mesh{};
    const Mesh& mesh   = morphs ? changed : primitive.mesh;
    if (!pose.joints) return placed(mesh, pose.scene_from_mesh);
    if (primitive.influences.empty()) {
        ++notes.without_joints;
        return placed(mesh, pose.scene_from_mesh);
    }
    check_joints(json, at, primitive, pose.joints->size());
    return skinned(mesh, primitive, *pose.joints, notes);
}

}  // namespace umbra
