#include "umbra/core/io/mesh_parts.h"

#include <fmt/format.h>

#include "umbra/core/base/error.h"

namespace umbra {

SceneFile scene_of(const std::vector<MeshPart>& parts, const std::filesystem::path& file,
                   const std::vector<std::string>& warnings) {
    SceneFile read;
    Scene& scene              = read.scene;
    std::size_t self_crossing = 0, too_few = 0;
    scene.materials.push_back({.name = "default"});
    for (const MeshPart& part : parts) {
        too_few += part.too_few;
        if (part.mesh.triangles.empty()) continue;
        self_crossing += part.self_crossing;
        add_object(scene, part.name.empty() ? file.stem().string() : part.name, part.mesh.positions, part.mesh.normals,
                   part.mesh.triangles, 0);
        part.normals.warn(scene.warnings);
    }
    if (scene.triangles.empty())
        throw InputError(fmt::format("{}: holds no faces, expected at least one", file.string()));
    for (const std::string& warning : warnings) scene.warnings.push_back(fmt::format("{}: {}", file.string(), warning));
    if (too_few > 0)
        scene.warnings.push_back(
            fmt::format("{}: {} faces have fewer than 3 corners: they are left out.", file.string(), too_few));
    if (self_crossing > 0)
        scene.warnings.push_back(
            fmt::format("{} polygons cross themselves: they were triangulated as fans.", self_crossing));
    return read;
}

}  // namespace umbra
