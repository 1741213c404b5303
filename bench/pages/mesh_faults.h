// Words for the faults of a mesh, as facts of an object in results.json count them.
#pragma once

#include <array>
#include <string_view>

#include "umbra/bench/lab/describe.h"

namespace umbra {

struct MeshFault {
    std::uint64_t ObjectRecord::*count;
    std::string_view one, many;  ///< for people
};

inline constexpr std::array kMeshFaults = {
    MeshFault{&ObjectRecord::boundary_edges, "boundary edge", "boundary edges"},
    MeshFault{&ObjectRecord::nonmanifold_edges, "non-manifold edge", "non-manifold edges"},
    MeshFault{&ObjectRecord::misoriented_edges, "inconsistently oriented edge", "inconsistently oriented edges"},
    MeshFault{&ObjectRecord::nonmanifold_vertices, "non-manifold vertex", "non-manifold vertices"},
    MeshFault{&ObjectRecord::degenerate_triangles, "degenerate triangle", "degenerate triangles"},
    MeshFault{&ObjectRecord::duplicate_triangles, "duplicate triangle", "duplicate triangles"},
};

}  // namespace umbra
