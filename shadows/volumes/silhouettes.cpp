#include "umbra/shadows/volumes/silhouettes.h"

#include <CGAL/Surface_mesh.h>

namespace umbra {

using SurfaceMesh = CGAL::Surface_mesh<vec3>;
using Halfedge    = SurfaceMesh::Halfedge_index;
using Vertex      = SurfaceMesh::Vertex_index;
using Face        = SurfaceMesh::Face_index;

/// Halfedge 2 e runs edge e of the topology from a to b, halfedge 2 e + 1 back; face t is the object's triangle t.
struct SilhouetteMesh::Halfedges : SurfaceMesh {
    // The topology knows the two triangles of every edge, so that halfedges are linked at once; CGAL's add_face would
    // look for them again and needs several times as long.
    Halfedges(const Scene& scene, const Topology& topology, std::uint32_t vertex)
        : first_vertex(vertex), first_triangle(topology.first_triangle) {
        const auto triangles = static_cast<std::uint32_t>(topology.triangles.size());
        reserve(static_cast<std::uint32_t>(topology.position.size()), static_cast<std::uint32_t>(topology.edges.size()),
                triangles);
        for (const std::uint32_t p : topology.position) add_vertex(scene.positions[p]);

        std::vector<Halfedge> side(3 * std::size_t(triangles));
        for (const Edge& e : topology.edges) {
            const Halfedge forward = add_edge(Vertex(e.a), Vertex(e.b));
            for (std::uint32_t k = e.first; k < e.first + e.count; ++k) {
                const EdgeUse& use                             = topology.uses[k];
                side[3 * std::size_t(use.triangle) + use.side] = use.forward ? forward : opposite(forward);
            }
        }
        for (std::uint32_t t = 0; t < triangles; ++t) {
            const Face face     = add_face();
            const Halfedge* run = &side[3 * std::size_t(t)];
            set_halfedge(face, run[0]);
            for (unsigned k = 0; k < 3; ++k) {
                set_face(run[k], face);
                set_next(run[k], run[(k + 1) % 3]);
                set_halfedge(target(run[k]), run[k]);
            }
        }
    }

    /// Calls body(halfedge from a to b, its triangle, that of the opposite halfedge) for every edge.
    template <class Body>
    void for_each_edge(const Body& body) const {
        for (const auto edge : edges()) {
            const Halfedge forward = halfedge(edge);
            body(forward, first_triangle + face(forward), first_triangle + face(opposite(forward)));
        }
    }

    std::uint32_t first_vertex;
    TriangleId first_triangle;
};

SilhouetteMesh::SilhouetteMesh(const Scene& scene, const Topology& topology, std::uint32_t first_vertex, bool closed) {
    if (closed)
        halfedges_ = std::make_shared<const Halfedges>(scene, topology, first_vertex);
    else
        soup_ = EdgeList(topology, first_vertex);
}

std::vector<Neighbours> SilhouetteMesh::neighbours() const {
    std::vector<Neighbours> neighbours;
    neighbours.reserve(halfedges_->number_of_edges());
    halfedges_->for_each_edge([&](Halfedge, TriangleId left, TriangleId right) {
        neighbours.push_back({left, right});
    });
    return neighbours;
}

std::vector<ChangeEdge> SilhouetteMesh::edges(std::span<const std::int8_t> orientation,
                                              std::vector<ChangeEdge> others) const {
    if (!halfedges_) return soup_.changes(orientation, std::move(others));
    const Halfedges& mesh = *halfedges_;
    mesh.for_each_edge([&](Halfedge forward, TriangleId left, TriangleId right) {
        if (orientation[left] != orientation[right])
            others.push_back({mesh.first_vertex + mesh.source(forward), mesh.first_vertex + mesh.target(forward),
                              orientation[left] - orientation[right]});
    });
    return others;
}

std::size_t SilhouetteMesh::memory_bytes() const {
    if (!halfedges_) return soup_.memory_bytes();
    // Connectivity, positions, and CGAL's mark of removal, one byte an element.
    return halfedges_->number_of_vertices() * (sizeof(Vertex) + sizeof(vec3) + 1) +
           halfedges_->number_of_edges() * (2 * 4 * sizeof(Halfedge) + 1) +
           halfedges_->number_of_faces() * (sizeof(Halfedge) + 1);
}

SilhouetteMeshes::SilhouetteMeshes(const Scene& scene, std::span<const ObjectFacts> facts) {
    triangles_.reserve(scene.triangles.size());
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        const Topology topology =
            find_topology(scene, scene.objects[o].first_triangle, scene.objects[o].triangle_count);
        const auto first_vertex = static_cast<std::uint32_t>(vertices_.size());
        for (const std::uint32_t p : topology.position) vertices_.push_back(scene.positions[p]);
        for (const uvec3 t : topology.triangles) triangles_.push_back(t + first_vertex);
        objects_.emplace_back(scene, topology, first_vertex, facts[o].manifold);
    }
}

std::vector<ChangeEdge> SilhouetteMeshes::edges(std::span<const std::int8_t> orientation) const {
    std::vector<ChangeEdge> found;
    for (const SilhouetteMesh& mesh : objects_) found = mesh.edges(orientation, std::move(found));
    return found;
}

std::size_t SilhouetteMeshes::memory_bytes() const {
    std::size_t bytes = triangles_.capacity() * sizeof(uvec3) + vertices_.capacity() * sizeof(vec3);
    for (const SilhouetteMesh& mesh : objects_) bytes += mesh.memory_bytes();
    return bytes;
}

}  // namespace umbra
