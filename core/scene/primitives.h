// Meshes of simple bodies, as teaching scenes want them. All closed ones are closed 2-manifolds, oriented outwards.
#pragma once

#include <vector>

#include "umbra/core/base/math.h"

namespace umbra {

/// One object's mesh: in its own space until transformed.
struct Mesh {
    std::vector<vec3> positions;
    std::vector<vec3> normals;  ///< one a position, or empty: face normals
    std::vector<uvec3> triangles;
};

[[nodiscard]] Mesh make_plane(float size_x, float size_z, int divisions = 1);   ///< in y = 0, facing +y, centred
[[nodiscard]] Mesh make_box(vec3 size);                                         ///< centred; 8 positions, flat
[[nodiscard]] Mesh make_sphere(float radius, int longitudes, int latitudes);    ///< smooth
[[nodiscard]] Mesh make_cylinder(float radius, float height, int segments);     ///< along y, centred, capped
[[nodiscard]] Mesh make_cone(float radius, float height, int segments);         ///< base at -height/2, capped
[[nodiscard]] Mesh make_torus(float major, float minor, int around, int tube);  ///< axis y, smooth
[[nodiscard]] Mesh make_disk(float radius, int segments);                       ///< in y = 0, facing +y, open

/// Positions by `m`, normals by its inverse transpose, windings turned where `m` mirrors.
[[nodiscard]] Mesh transformed(Mesh mesh, const mat4& m);

/// The weight of a face's normal at a vertex. Only with `angle` does it not matter how faces are cut into triangles.
enum class NormalWeights : std::uint8_t {
    angle,  ///< its angle there [Grit Thuermer, Charles Wuethrich, Computing Vertex Normals from Polygonal Facets,
            ///< 1998]
    area,   ///< its area
    equal   ///< 1 a triangle [Henri Gouraud, Continuous Shading of Curved Surfaces, 1971]
};

/// Vertex normals averaged from the faces around each position, across bit-equal positions; faces that meet at more
/// than `crease` degrees keep their own (positions are split there).
[[nodiscard]] Mesh with_averaged_normals(const Mesh& mesh, float crease_degrees = 180,
                                         NormalWeights weights = NormalWeights::angle);

}  // namespace umbra
