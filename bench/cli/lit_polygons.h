// `umbra polygons`: the lit polygons of hard lights as a mesh in space, and as drawings in the scene's large planes.
#pragma once

#include <filesystem>
#include <string>

#include "umbra/bench/lab/describe.h"

namespace umbra {

struct LitAreaRecord {
    double area = kUnknown, lit_area = kUnknown;
};
DESCRIBE(LitAreaRecord) {
    of(MEMBER(area), "of the triangles that the light does not see edge-on");
    MEMBERS(lit_area);
}

struct LitPlaneRecord {
    std::string drawing{};
    std::vector<double> normal{};
    LitAreaRecord lit{};
};
DESCRIBE(LitPlaneRecord) {
    of(MEMBER(drawing), "its file");
    MEMBERS(normal);
    of.all(&R::lit);
}

struct LitLightRecord {
    std::string name{}, mesh{};
    LitAreaRecord lit{};
    std::vector<LitPlaneRecord> planes{};
};
DESCRIBE(LitLightRecord) {
    MEMBERS(name);
    of(MEMBER(mesh), "its file");
    of.all(&R::lit);
    of(MEMBER(planes), "the scene's large planes, largest first");
}

struct LitPolygonsRecord {
    int schema = kResultsSchema;
    std::string version{};
    SceneRecord scene{};
    std::vector<LitLightRecord> lights{};
};
DESCRIBE(LitPolygonsRecord) { MEMBERS(schema, version, scene, lights); }

/// Writes into `folder`, of each light: LIGHT.obj, its lit polygons in world space, cut into triangles, an object of
/// the file for each of the scene's; and LIGHT_plane_K.svg for each of facts.planes, from 1, largest first: lit
/// polygons bright, umbra dark, in units of the world. Every light is hard. Throws InputError where a file cannot be
/// written.
[[nodiscard]] LitPolygonsRecord write_lit_polygons(const Scene& scene, const SceneFacts& facts,
                                                   const std::filesystem::path& folder);

/// The areas as a table for people.
[[nodiscard]] std::string lit_polygons_text(const LitPolygonsRecord& record);

}  // namespace umbra
