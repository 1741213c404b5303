// `umbra polygons`: the lit polygons of hard lights as a mesh in space, and as drawings in the scene's large planes.
#pragma once

#include <filesystem>
#include <string>

#include "umbra/bench/run/describe.h"

namespace umbra {

/// Writes into `folder`, of each light: LIGHT.obj, its lit polygons in world space, cut into triangles, an object of
/// the file for each of the scene's; and LIGHT_plane_K.svg for each of facts.planes, from 1, largest first: lit
/// polygons bright, umbra dark, in units of the world. Every light is hard. Returns {schema, version, scene, lights:
/// [{name, mesh, area, lit_area, planes: [{drawing, normal, area, lit_area}]}]}; areas are of the triangles that the
/// light does not see edge-on. Throws InputError where a file cannot be written.
[[nodiscard]] Json write_lit_polygons(const Scene& scene, const SceneFacts& facts, const std::filesystem::path& folder);

/// The areas as a table for people.
[[nodiscard]] std::string lit_polygons_text(const Json& record);

}  // namespace umbra
