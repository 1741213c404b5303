#include "umbra/core/io/gltf/meshes.h"

#include <cmath>
#include <map>

#include <fmt/format.h>

#include "umbra/core/base/number_from.h"
#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"

namespace umbra {
namespace {

std::vector<uvec3> as_triangles(const std::vector<std::uint32_t>& v, int mode) {
    std::vector<uvec3> out;
    if (mode == 4)
        for (std::size_t i = 0; i + 2 < v.size(); i += 3) out.emplace_back(v[i], v[i + 1], v[i + 2]);
    if (mode == 5)
        for (std::size_t i = 0; i + 2 < v.size(); ++i) out.emplace_back(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]);
    if (mode == 6)
        for (std::size_t i = 0; i + 2 < v.size(); ++i) out.emplace_back(v[i + 1], v[i + 2], v[0]);
    return out;
}

/// The n of TEXCOORD_n.
std::optional<std::uint64_t> texture_coordinate_set(std::string_view key) {
    constexpr std::string_view kBegins = "TEXCOORD_";
    return key.starts_with(kBegins) ? number_from<std::uint64_t>(key.substr(kBegins.size())) : std::nullopt;
}

/// Accessors of the attributes JOINTS_n and WEIGHTS_n.
struct InfluenceSet {
    const GltfAccessor* joints  = nullptr;
    const GltfAccessor* weights = nullptr;
};

/// Adds the attribute to that of `sets` with its number, where it is one of a skin's.
void read_influence(const JsonText& json, const JsonMember& attribute, const GltfAccessor& accessor,
                    std::map<std::string, InfluenceSet>& sets) {
    const bool joints = attribute.key.starts_with("JOINTS_");
    if (!joints && !attribute.key.starts_with("WEIGHTS_")) return;
    const int type = accessor.component_type;
    const bool fit = type == 5121 || type == 5123 || type == (joints ? 5125 : 5126);
    if (accessor.components != 4 || !fit)
        json.fail(attribute.value, fmt::format("{} is not an accessor of type VEC4 of {}", attribute.key,
                                               joints ? "unsigned integers" : "floats or unsigned integers"));
    InfluenceSet& set                   = sets[attribute.key.substr(attribute.key.find('_'))];
    (joints ? set.joints : set.weights) = &accessor;
}

std::vector<MorphTarget> read_targets(const JsonText& json, const GltfData& data, const JsonValue& v,
                                      const std::string& what, std::uint64_t vertices) {
    std::vector<MorphTarget> targets;
    const JsonArray& list = list_of(json, v, "targets");
    const auto& accessors = data.accessors();
    for (std::size_t i = 0; i < list.size(); ++i) {
        MorphTarget target;
        for (const JsonMember& a : json.object(list[i], "a morph target")) {
            const GltfAccessor& accessor = accessors[index_into(json, a.value, a.key, accessors.size())];
            if (accessor.count != vertices)
                json.fail(a.value, fmt::format("{} of {}.targets[{}] has {} elements, expected {}, as many as the "
                                               "primitive has positions",
                                               a.key, what, i, accessor.count, vertices));
            if (a.key != "POSITION" && a.key != "NORMAL") continue;
            if (accessor.components != 3 || accessor.component_type == 5125)
                json.fail(a.value, fmt::format("{} of {}.targets[{}] is not an accessor of type VEC3 of floats", a.key,
                                               what, i));
            if (!accessor.not_finite.empty()) json.fail(*accessor.json, accessor.not_finite);
            (a.key == "POSITION" ? target.positions : target.normals) = &accessor;
        }
        targets.push_back(target);
    }
    return targets;
}

std::vector<Influence> read_influences(const GltfData& data, const InfluenceSet& set,
                                       const std::vector<std::uint32_t>& vertices) {
    const std::vector<vec4> joints = data.quadruples(*set.joints), weights = data.quadruples(*set.weights);
    std::vector<Influence> influences;
    influences.reserve(vertices.size());
    for (const std::uint32_t v : vertices) influences.push_back({glm::uvec4(joints[v]), weights[v]});
    return influences;
}

std::optional<Primitive> read_primitive(const JsonText& json, const GltfData& data, const JsonValue& v,
                                        const std::string& what, std::size_t materials, GltfNotes& notes,
                                        std::vector<std::string>& warnings) {
    (void)json.object(v, what);
    Primitive primitive;
    if (const JsonValue* m = find_member(v, "material"))
        primitive.material = index_into(json, *m, "material", materials);
    const JsonValue* mode_value = find_member(v, "mode");
    const int mode              = mode_value ? int(whole(json, *mode_value, "mode", 0, 6)) : 4;
    const JsonValue* attributes = find_member(v, "attributes");
    if (!attributes) json.fail(v, what + " has no attributes");

    const auto& accessors        = data.accessors();
    const GltfAccessor* position = nullptr;
    const GltfAccessor* normal   = nullptr;
    const GltfAccessor* first    = nullptr;
    std::map<std::string, InfluenceSet> influences;
    for (const JsonMember& a : json.object(*attributes, "attributes")) {
        const GltfAccessor& accessor = accessors[index_into(json, a.value, a.key, accessors.size())];
        if (first && accessor.count != first->count)
            json.fail(a.value, fmt::format("{} has {} elements, another attribute {}, expected the same number", a.key,
                                           accessor.count, first->count));
        first = &accessor;
        if (a.key != "NORMAL" && !accessor.not_finite.empty()) json.fail(*accessor.json, accessor.not_finite);
        if (a.key == "POSITION" || a.key == "NORMAL") {
            if (accessor.components != 3 || accessor.component_type == 5125)
                json.fail(a.value, fmt::format("{} is not an accessor of type VEC3 of floats", a.key));
            (a.key == "POSITION" ? position : normal) = &accessor;
        }
        if (a.key == "COLOR_0") notes.vertex_colours = true;
        read_influence(json, a, accessor, influences);
        if (const auto set = texture_coordinate_set(a.key); set && accessor.components == 2)
            primitive.texture_coordinates[*set] = &accessor;
    }
    for (const auto& [number, set] : influences)
        if (!set.joints || !set.weights)
            json.fail(*attributes,
                      fmt::format("{} has {} without {}", what, set.joints ? "JOINTS" + number : "WEIGHTS" + number,
                                  set.joints ? "WEIGHTS" + number : "JOINTS" + number));
    const GltfAccessor* index = nullptr;
    if (const JsonValue* i = find_member(v, "indices")) {
        index = &accessors[index_into(json, *i, "indices", accessors.size())];
        if (index->components != 1 ||
            (index->component_type != 5121 && index->component_type != 5123 && index->component_type != 5125))
            json.fail(*i, "indices are not an accessor of type SCALAR of 5121, 5123 or 5125");
    }
    const auto is_away = [](const GltfAccessor* accessor) { return accessor && accessor->bytes.empty(); };
    if (extension(json, v, "KHR_draco_mesh_compression") && (is_away(position) || is_away(index)))
        json.fail(v, what + " is compressed by KHR_draco_mesh_compression, expected an export without it");
    if (!position) {
        notes.no_position = true;
        return std::nullopt;
    }
    if (mode < 4) {
        ++notes.points_and_lines;
        return std::nullopt;
    }

    std::vector<std::uint32_t> corners;
    if (index) {
        corners = data.indices(*index);
        for (std::size_t i = 0; i < corners.size(); ++i)
            if (corners[i] >= position->count)
                json.fail(*index->json, fmt::format("index {} of {} is {}, but there are {} positions, counted from 0",
                                                    i, what, corners[i], position->count));
    } else {
        if (position->count > kMaxTriangles * 3) json.fail(*position->json, "too many positions");
        for (std::uint32_t i = 0; i < position->count; ++i) corners.push_back(i);
    }
    if (corners.size() < 3 || (mode == 4 && corners.size() % 3 != 0))
        warnings.push_back(fmt::format(
            "{} has {} corners, which {}.", what, corners.size(),
            corners.size() < 3 ? "make no triangle" : "do not divide into triangles: the rest is left out"));
    primitive.mesh.triangles = as_triangles(corners, mode);
    primitive.targets        = read_targets(json, data, v, what, position->count);

    // Only vertices that triangles use are kept: many primitives may share one long list of positions.
    const std::vector<vec3> positions = data.vectors(*position);
    const std::vector<vec3> normals   = normal ? data.vectors(*normal) : std::vector<vec3>{};
    std::vector<std::uint32_t> local(positions.size(), 0xffffffffu);
    for (uvec3& t : primitive.mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            std::uint32_t& l = local[t[k]];
            if (l == 0xffffffffu) {
                l = std::uint32_t(primitive.mesh.positions.size());
                primitive.mesh.positions.push_back(positions[t[k]]);
                primitive.vertices.push_back(t[k]);
                if (normal) primitive.mesh.normals.push_back(notes.normals.usable(normals[t[k]]));
            }
            t[k] = l;
        }
    for (const auto& [number, set] : influences)
        primitive.influences.push_back(read_influences(data, set, primitive.vertices));
    return primitive;
}

}  // namespace

std::vector<std::vector<Primitive>> read_meshes(const JsonText& json, const GltfData& data, std::size_t materials,
                                                GltfNotes& notes, std::vector<std::string>& warnings) {
    std::vector<std::vector<Primitive>> meshes;
    const JsonArray& list   = list_of(json, json.root(), "meshes");
    std::uint64_t triangles = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
        (void)json.object(list[i], fmt::format("meshes[{}]", i));
        const std::string name      = name_or(json, list[i], fmt::format("mesh_{}", i));
        const JsonArray& primitives = list_of(json, list[i], "primitives");
        std::vector<Primitive> mesh;
        for (std::size_t p = 0; p < primitives.size(); ++p) {
            const auto what = fmt::format("meshes[{}].primitives[{}]", i, p);
            auto primitive  = read_primitive(json, data, primitives[p], what, materials, notes, warnings);
            if (!primitive) continue;
            primitive->name = primitives.size() > 1 ? fmt::format("{}.{}", name, p) : name;
            triangles += primitive->mesh.triangles.size();
            if (triangles > kMaxTriangles)
                json.fail(primitives[p], fmt::format("more than {} triangles with this one", kMaxTriangles));
            mesh.push_back(std::move(*primitive));
        }
        const std::vector<double> weights = read_morph_weights(json, list[i], mesh);
        for (Primitive& p : mesh) p.weights = weights;
        meshes.push_back(std::move(mesh));
    }
    return meshes;
}

std::vector<double> read_morph_weights(const JsonText& json, const JsonValue& v,
                                       const std::vector<Primitive>& primitives) {
    const JsonValue* list = find_member(v, "weights");
    if (!list) return {};
    std::vector<double> weights;
    for (const JsonValue& w : json.array(*list, "weights", "a list of numbers"))
        weights.push_back(json.number(w, "a weight", kAnyNumber));
    for (const Primitive& p : primitives)
        if (!weights.empty() && !p.targets.empty() && p.targets.size() != weights.size())
            json.fail(*list, fmt::format("{} weights, expected {}, as many as {} has morph targets", weights.size(),
                                         p.targets.size(), p.name));
    return weights;
}

Mesh placed(const Mesh& mesh, const dmat4& world_from_mesh) {
    const dmat4& m = world_from_mesh;
    const dmat3 linear(m);
    const double det = glm::determinant(linear);
    Mesh out;
    out.positions.reserve(mesh.positions.size());
    for (const vec3 p : mesh.positions) out.positions.emplace_back(dvec3(m * dvec4(dvec3(p), 1)));
    if (!mesh.normals.empty() && det != 0 && std::isfinite(det)) {
        const dmat3 for_normals = glm::transpose(glm::inverse(linear));
        for (const vec3 n : mesh.normals) {
            const dvec3 turned  = for_normals * dvec3(n);
            const double length = glm::length(turned);
            out.normals.emplace_back(length > 0 && std::isfinite(length) ? turned / length : dvec3(0));
        }
    }
    out.triangles = mesh.triangles;
    if (det < 0)
        for (uvec3& t : out.triangles) std::swap(t.y, t.z);
    return out;
}

}  // namespace umbra
