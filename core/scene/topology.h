// Topology: which triangles share which vertices and edges, once positions that are bit-equal are one vertex. It holds
// any triangles; a halfedge mesh, as CGAL's, holds only those that form a 2-manifold.
#pragma once

#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// One triangle's side of an edge.
struct EdgeUse {
    std::uint32_t triangle = 0;     ///< counted from Topology::first_triangle
    std::uint8_t side      = 0;     ///< runs from the triangle's corner `side` to corner (side + 1) % 3
    bool forward           = true;  ///< runs the edge from a to b; otherwise from b to a
};

/// An edge between two welded vertices, a < b, and its run of triangles in Topology::uses, in order of triangle.
struct Edge {
    std::uint32_t a = 0, b = 0;
    std::uint32_t first = 0, count = 0;
};

/// A run of triangles, its positions welded where they are bit-equal (0 and -0 are equal).
struct Topology {
    TriangleId first_triangle = 0;
    std::vector<uvec3> triangles;          ///< welded vertices of each triangle, in the order of its corners
    std::vector<std::uint32_t> position;   ///< of each welded vertex: an index into Scene::positions
    std::vector<Edge> edges;               ///< sorted by a, then b; triangles that repeat a corner have none
    std::vector<EdgeUse> uses;             ///< every side of the triangles that have edges, edge by edge
    std::vector<std::uint8_t> degenerate;  ///< one a triangle: 1 where its area is exactly zero

    [[nodiscard]] bool repeats_a_corner(std::uint32_t t) const {
        const uvec3 v = triangles[t];
        return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
    }
};

/// The topology of triangles [first, first + count): one object's, or the whole scene's. Vertices are numbered as they
/// are first used.
[[nodiscard]] Topology find_topology(const Scene& scene, TriangleId first, std::uint32_t count);

/// True where the three corners lie on one line, or in one point. Exact.
[[nodiscard]] bool is_degenerate(vec3 a, vec3 b, vec3 c);

}  // namespace umbra
