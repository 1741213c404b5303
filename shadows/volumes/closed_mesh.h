// A closed object as a halfedge mesh of CGAL.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "umbra/core/scene/scene.h"
#include "umbra/core/scene/topology.h"

namespace umbra {

/// An edge that a shadow volume extrudes away from the light. `weight` counts the chosen triangles beside it, as the
/// light sees them: those that run it anticlockwise from a to b less those that run it from b to a.
struct SilhouetteEdge {
    std::uint32_t a = 0, b = 0;  ///< welded vertices, a < b
    std::int32_t weight = 0;     ///< never 0
};

/// The two triangles at an edge a-b of a closed mesh, a < b: `left` runs it from a to b, `right` from b to a.
struct Neighbours {
    TriangleId left = 0, right = 0;
};

/// The mesh of one object that is a closed 2-manifold (ObjectFacts::manifold). All vertices and triangles that go in or
/// come out are counted over the scene.
class ClosedMesh {
public:
    /// `first_vertex`: the number that the object's first welded vertex has in the scene.
    ClosedMesh(const Scene& scene, const Topology& topology, std::uint32_t first_vertex);
    ~ClosedMesh();
    ClosedMesh(ClosedMesh&&) noexcept;
    ClosedMesh& operator=(ClosedMesh&&) noexcept;

    /// Writes side_of_light of each of the object's triangles. Parallel.
    void find_facing(const Light& light, std::span<std::int8_t> facing) const;

    /// Appends the edges whose two triangles are taken differently, sorted by a, then b; SilhouetteMeshes::edges says
    /// what `orientation` is.
    void append_silhouette(std::span<const std::int8_t> orientation, std::vector<SilhouetteEdge>& silhouette) const;

    /// Of each edge, sorted by a, then b.
    [[nodiscard]] std::vector<Neighbours> neighbours() const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct Mesh;
    std::unique_ptr<Mesh> mesh_;
    std::uint32_t first_vertex_;
    TriangleId first_triangle_;
};

}  // namespace umbra
