// Words for the faults of a mesh, as facts of an object in results.json count them.
#pragma once

#include <array>
#include <string_view>

namespace umbra {

struct MeshFault {
    std::string_view key;        ///< the member of an object's facts
    std::string_view one, many;  ///< for people
};

inline constexpr std::array kMeshFaults = {
    MeshFault{"boundary_edges", "boundary edge", "boundary edges"},
    MeshFault{"nonmanifold_edges", "non-manifold edge", "non-manifold edges"},
    MeshFault{"misoriented_edges", "inconsistently oriented edge", "inconsistently oriented edges"},
    MeshFault{"nonmanifold_vertices", "non-manifold vertex", "non-manifold vertices"},
    MeshFault{"degenerate_triangles", "degenerate triangle", "degenerate triangles"},
    MeshFault{"duplicate_triangles", "duplicate triangle", "duplicate triangles"},
};

}  // namespace umbra
