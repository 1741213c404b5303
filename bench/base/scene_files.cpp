#include "umbra/bench/base/scene_files.h"

#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <vector>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/npy.h"
#include "umbra/core/io/scene_writer.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

#pragma pack(push, 1)
struct PointRow {
    dvec3 position;
    vec3 normal;
    std::uint32_t triangle;
    float u, v;
    std::int32_t column, row;
};
#pragma pack(pop)
static_assert(sizeof(PointRow) == 56);
constexpr std::string_view kPointRow =
    "[('position', '<f8', (3,)), ('normal', '<f4', (3,)), ('triangle', '<u4'), ('u', '<f4'), ('v', '<f4'), "
    "('column', '<i4'), ('row', '<i4')]";

/// Numbers as JSON prints them, those that a reader makes the same float of.
Json list(vec3 v) { return {v.x, v.y, v.z}; }

/// The buffer of a glTF file, and what points into it.
class Buffer {
public:
    explicit Buffer(Json& root) : root_(root) {}

    template <class T>
    std::size_t accessor(const std::vector<T>& items, int component, const char* type,
                         const Json& bounds = Json::object()) {
        const std::size_t begin = bytes_.size();
        bytes_.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T));
        root_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes_.size() - begin}});
        root_["accessors"].push_back({{"bufferView", root_["bufferViews"].size() - 1},
                                      {"componentType", component},
                                      {"count", items.size()},
                                      {"type", type}});
        root_["accessors"].back().update(bounds);
        return root_["accessors"].size() - 1;
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    Json& root_;
    std::string bytes_;
};

constexpr int kFloat = 5126, kUnsigned = 5125;

Json mesh_of(const Scene& scene, const Object& object, Buffer& buffer) {
    std::map<std::uint32_t, std::uint32_t> index;
    std::vector<vec3> positions;
    std::vector<std::uint32_t> corners;
    vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
        for (int k = 0; k < 3; ++k) {
            const auto [at, is_new] =
                index.try_emplace(scene.triangles[t][k], static_cast<std::uint32_t>(positions.size()));
            if (is_new) {
                positions.push_back(scene.vertex(t, k));
                low = min(low, positions.back()), high = max(high, positions.back());
            }
            corners.push_back(at->second);
        }
    const std::size_t at = buffer.accessor(positions, kFloat, "VEC3", {{"min", list(low)}, {"max", list(high)}});
    const std::size_t by = buffer.accessor(corners, kUnsigned, "SCALAR");
    return {{"name", object.name},
            {"primitives", {{{"attributes", {{"POSITION", at}}}, {"indices", by}, {"material", object.material}}}}};
}

/// The turn that takes -z to `direction`, as glTF's lights and cameras look.
Json turn_to(dvec3 direction, dvec3 up) {
    const dvec3 back   = -glm::normalize(direction);
    const dvec3 aside  = glm::cross(up, back);
    const dvec3 x      = glm::length(aside) > 1e-9
                             ? glm::normalize(aside)
                             : glm::normalize(glm::cross(std::abs(back.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 0, 1), back));
    const glm::dquat q = glm::quat_cast(glm::dmat3(x, glm::cross(back, x), back));
    return {q.x, q.y, q.z, q.w};
}

Json light_of(const Light& light) {
    Json json = {{"name", light.name},
                 {"type", light.kind == LightKind::spot    ? "spot"
                          : light.kind == LightKind::point ? "point"
                                                           : "directional"},
                 {"color", list(light.diffuse / std::max({light.diffuse.x, light.diffuse.y, light.diffuse.z, 1e-30f}))},
                 {"intensity", std::max({light.diffuse.x, light.diffuse.y, light.diffuse.z})}};
    if (light.kind == LightKind::spot)
        json["spot"] = {{"innerConeAngle", std::min(light.spot.inner, light.spot.cutoff)},
                        {"outerConeAngle", light.spot.cutoff}};
    return json;
}

void pad(std::string& text, char with) { text.append((4 - text.size() % 4) % 4, with); }

void append_chunk(std::string& all, std::uint32_t kind, const std::string& data) {
    const auto length = static_cast<std::uint32_t>(data.size());
    all.append(reinterpret_cast<const char*>(&length), 4);
    all.append(reinterpret_cast<const char*>(&kind), 4);
    all += data;
}

/// Triangles, camera and lights (points, suns and spots; others are nodes without a light) as glTF binary.
std::string glb_text(const Scene& scene) {
    Json root{{"asset", {{"version", "2.0"}, {"generator", "umbra"}}}, {"scene", 0}};
    Buffer buffer(root);
    Json nodes = Json::array(), lights = Json::array();
    for (const Material& m : scene.materials)
        root["materials"].push_back(
            {{"name", m.name},
             {"doubleSided", m.two_sided},
             {"pbrMetallicRoughness", {{"baseColorFactor", {m.O_d.x, m.O_d.y, m.O_d.z, 1}}, {"metallicFactor", 0}}}});
    for (const Object& object : scene.objects) {
        if (object.triangle_count == 0) continue;
        Json mesh = mesh_of(scene, object, buffer);  // which adds members to the root
        root["meshes"].push_back(std::move(mesh));
        nodes.push_back({{"name", object.name}, {"mesh", root["meshes"].size() - 1}});
    }
    for (const Light& light : scene.lights) {
        Json node{{"name", light.name}, {"translation", list(light.position)}};
        if (light.kind == LightKind::directional || light.kind == LightKind::spot)
            node["rotation"] = turn_to(light.direction, {0, 1, 0});
        if (!is_area(light.kind)) {
            node["extensions"]["KHR_lights_punctual"]["light"] = lights.size();
            lights.push_back(light_of(light));
        }
        nodes.push_back(node);
    }
    if (!lights.empty()) {
        root["extensionsUsed"]                              = {"KHR_lights_punctual"};
        root["extensions"]["KHR_lights_punctual"]["lights"] = lights;
    }
    const Camera& camera = scene.camera;
    const double far = 1e6, near = 1e-3;
    root["cameras"] =
        camera.projection == Projection::perspective
            ? Json{{{"type", "perspective"},
                    {"perspective",
                     {{"yfov", static_cast<double>(camera.fov_y) * std::numbers::pi / 180},
                      {"aspectRatio", static_cast<double>(scene.width) / scene.height},
                      {"znear", near}}}}}
            : Json{{{"type", "orthographic"},
                    {"orthographic",
                     {{"ymag", camera.height / 2},
                      {"xmag", camera.height / 2 * static_cast<float>(scene.width) / static_cast<float>(scene.height)},
                      {"znear", near},
                      {"zfar", far}}}}};
    nodes.push_back({{"name", "camera"},
                     {"camera", 0},
                     {"translation", list(camera.eye)},
                     {"rotation", turn_to(dvec3(camera.target) - dvec3(camera.eye), camera.up)}});
    std::vector<std::size_t> all(nodes.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    root["scenes"]  = {{{"nodes", all}}};
    root["nodes"]   = nodes;
    root["buffers"] = {{{"byteLength", buffer.bytes().size()}}};
    if (buffer.bytes().empty()) root.erase("buffers");

    std::string json = root.dump(-1, ' ', false, Json::error_handler_t::replace), binary = buffer.bytes();
    pad(json, ' '), pad(binary, '\0');
    std::string chunks;
    append_chunk(chunks, 0x4E4F534A, json);
    if (!binary.empty()) append_chunk(chunks, 0x004E4942, binary);
    const std::uint32_t header[]{0x46546C67, 2, static_cast<std::uint32_t>(12 + chunks.size())};
    return std::string(reinterpret_cast<const char*>(header), sizeof header) + chunks;
}

}  // namespace

void write_scene_files(const fs::path& folder, const Scene& scene) {
    write_text(folder / SceneExport::json, native_text(scene));
    write_text(folder / SceneExport::glb, glb_text(scene));
    const std::size_t n = scene.triangles.size();
    std::vector<float> corners;
    std::vector<std::uint8_t> blocks;
    corners.reserve(9 * n);
    for (TriangleId t = 0; t < n; ++t) {
        for (int k = 0; k < 3; ++k) {
            const vec3 x = scene.vertex(t, k);
            corners.insert(corners.end(), {x.x, x.y, x.z});
        }
        blocks.push_back(scene.blocks(t) ? 1 : 0);
    }
    write_npy(folder / SceneExport::triangles, corners, {n, 3, 3});
    write_npy(folder / SceneExport::object, scene.triangle_object, {n});
    write_npy(folder / SceneExport::blocks, blocks, {n});
}

void write_points(const fs::path& file, const Scene& scene, const PointBatch& points) {
    std::vector<PointRow> rows(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const bool there  = points.triangle[i] != kNoTriangle;
        const bool raster = points.raster.has_value();
        const auto at     = static_cast<std::int32_t>(i);
        rows[i]           = {there ? exact_position(scene, points, i) : dvec3(0),
                   points.normal(i),
                   points.triangle[i],
                   points.u[i],
                   points.v[i],
                   raster ? at % points.raster->width : -1,
                   raster ? at / points.raster->width : -1};
    }
    write_npy(file, kPointRow, {rows.size()}, std::as_bytes(std::span(rows)));
}

void write_asked(const fs::path& file, const PointBatch& points, LightId light) {
    std::vector<std::uint8_t> asked(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) asked[i] = points.asks(light, i) ? 1 : 0;
    write_npy(file, asked, {asked.size()});
}

}  // namespace umbra
