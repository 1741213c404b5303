// A scene and its surface points as files that programs in other languages read (docs/contenders.md).
#pragma once

#include <filesystem>

#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// Names below the folder that the files are written to.
struct SceneExport {
    static constexpr const char* json      = "scene.json";     ///< the native scene, whole
    static constexpr const char* glb       = "scene.glb";      ///< the same triangles, camera and lights as glTF binary
    static constexpr const char* triangles = "triangles.npy";  ///< float32, triangles x 3 x 3: corners in world space
    static constexpr const char* object    = "objects.npy";    ///< uint32 a triangle: index into "objects" of the JSON
    static constexpr const char* blocks    = "blocks.npy";     ///< uint8 a triangle: 1 where it takes all light, else 0
};

/// Throws InputError where a file cannot be written.
void write_scene_files(const std::filesystem::path& folder, const Scene& scene);

/// One record a point: position (float64, rounded from the exact point once more), normal, triangle (2^32 - 1 where there
/// is none), u, v, column and row of the pixel (-1 in a batch without a raster).
void write_points(const std::filesystem::path& file, const Scene& scene, const PointBatch& points);

/// uint8 a point: 1 where S_j of the light is asked for.
void write_asked(const std::filesystem::path& file, const PointBatch& points, LightId light);

}  // namespace umbra
