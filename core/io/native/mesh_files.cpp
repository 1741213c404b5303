#include "umbra/core/io/native/mesh_files.h"

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/paths.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

/// One object's triangles with the positions that they use. `index` has one entry a position of the scene, all of them
/// kNoTriangle before and after.
Mesh mesh_of(const Scene& scene, const Object& object, std::vector<std::uint32_t>& index) {
    Mesh mesh;
    std::vector<std::uint32_t> used;
    for (std::uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t p = scene.triangles[t][k];
            if (index[p] != kNoTriangle) continue;
            index[p] = static_cast<std::uint32_t>(used.size());
            used.push_back(p);
        }
        const uvec3 corners = scene.triangles[t];
        mesh.triangles.emplace_back(index[corners.x], index[corners.y], index[corners.z]);
    }
    for (const std::uint32_t p : used) {
        mesh.positions.push_back(scene.positions[p]);
        mesh.normals.push_back(scene.normals[p]);
        index[p] = kNoTriangle;
    }
    return mesh;
}

}  // namespace

std::vector<NativePart> MeshFiles::read(const JsonFields& f, const std::string& name, bool own_material) {
    const Scene& mesh_scene   = file(f).scene;
    const auto first_material = static_cast<std::uint32_t>(scene_.materials.size());
    if (!own_material)
        scene_.materials.insert(scene_.materials.end(), mesh_scene.materials.begin(), mesh_scene.materials.end());
    std::vector<NativePart> parts;
    std::vector<std::uint32_t> index(mesh_scene.positions.size(), kNoTriangle);
    for (const Object& o : mesh_scene.objects)
        parts.push_back({mesh_scene.objects.size() == 1 ? name : fmt::format("{}/{}", name, o.name),
                         mesh_of(mesh_scene, o, index), first_material + o.material, mesh_scene.origin, o.switches});
    return parts;
}

const SceneFile& MeshFiles::file(const JsonFields& f) {
    const JsonValue& v         = f.require("file");
    const std::string& written = json_.string(v, "file");
    Reading reading;
    if (const JsonValue* up = f.find("up")) {
        reading.up = json_.choice<UpAxis>(*up, "up");
        if (reading.up != UpAxis::y && !is_mesh_file(written))
            json_.fail(*up, fmt::format("up is for files that do not say it themselves ({})", mesh_endings()));
    }
    const std::pair key(written, reading.up);
    if (const auto found = files_.find(key); found != files_.end()) return found->second;
    SceneFile read;
    try {
        read = read_by_ending(folder_ / written, {".obj", ".ply", ".off", ".stl", ".gltf", ".glb"}, reading);
    } catch (const InputError& e) {
        try {
            json_.fail(v, fmt::format("the mesh cannot be read: {}", e.what()));
        } catch (const InputError& with_place) {
            if (!is_there(folder_ / written)) throw MissingMesh(with_place.what());
            throw;
        }
    }
    if (read.scene.triangles.empty()) json_.fail(v, fmt::format("the mesh \"{}\" has no triangles", written));
    for (const std::string& w : read.scene.warnings) scene_.warnings.push_back(fmt::format("{}: {}", written, w));
    return files_.emplace(key, std::move(read)).first->second;
}

}  // namespace umbra
