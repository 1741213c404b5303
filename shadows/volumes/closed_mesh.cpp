#include "umbra/shadows/volumes/closed_mesh.h"

#include <CGAL/Surface_mesh.h>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"

namespace umbra {

using SurfaceMesh = CGAL::Surface_mesh<vec3>;
using Halfedge    = SurfaceMesh::Halfedge_index;
using Vertex      = SurfaceMesh::Vertex_index;
using Face        = SurfaceMesh::Face_index;

/// Halfedge 2 e runs edge e of the topology from a to b, halfedge 2 e + 1 back; face t is the object's triangle t.
struct ClosedMesh::Mesh : SurfaceMesh {};

// The topology knows the two triangles of every edge, so that halfedges are linked at once; CGAL's add_face would look
// for them again and needs several times as long.
ClosedMesh::ClosedMesh(const Scene& scene, const Topology& topology, std::uint32_t first_vertex)
    : mesh_(std::make_unique<Mesh>()), first_vertex_(first_vertex), first_triangle_(topology.first_triangle) {
    Mesh& mesh           = *mesh_;
    const auto triangles = static_cast<std::uint32_t>(topology.triangles.size());
    mesh.reserve(static_cast<std::uint32_t>(topology.position.size()),
                 static_cast<std::uint32_t>(topology.edges.size()), triangles);
    for (const std::uint32_t p : topology.position) mesh.add_vertex(scene.positions[p]);

    std::vector<Halfedge> side(3 * std::size_t(triangles));
    for (const Edge& e : topology.edges) {
        const Halfedge forward = mesh.add_edge(Vertex(e.a), Vertex(e.b));
        for (std::uint32_t k = e.first; k < e.first + e.count; ++k) {
            const EdgeUse& use                             = topology.uses[k];
            side[3 * std::size_t(use.triangle) + use.side] = use.forward ? forward : mesh.opposite(forward);
        }
    }
    for (std::uint32_t t = 0; t < triangles; ++t) {
        const Face face     = mesh.add_face();
        const Halfedge* run = &side[3 * std::size_t(t)];
        mesh.set_halfedge(face, run[0]);
        for (unsigned k = 0; k < 3; ++k) {
            mesh.set_face(run[k], face);
            mesh.set_next(run[k], run[(k + 1) % 3]);
            mesh.set_halfedge(mesh.target(run[k]), run[k]);
        }
    }
}

ClosedMesh::~ClosedMesh()                                = default;
ClosedMesh::ClosedMesh(ClosedMesh&&) noexcept            = default;
ClosedMesh& ClosedMesh::operator=(ClosedMesh&&) noexcept = default;

void ClosedMesh::find_facing(const Light& light, std::span<std::int8_t> facing) const {
    const Mesh& mesh = *mesh_;
    parallel_ranges(mesh.number_of_faces(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Halfedge side         = mesh.halfedge(Face(static_cast<std::uint32_t>(t)));
            facing[first_triangle_ + t] = static_cast<std::int8_t>(
                side_of_light(light, mesh.point(mesh.source(side)), mesh.point(mesh.target(side)),
                              mesh.point(mesh.target(mesh.next(side)))));
        }
    });
}

void ClosedMesh::append_silhouette(std::span<const std::int8_t> orientation,
                                   std::vector<SilhouetteEdge>& silhouette) const {
    const Mesh& mesh = *mesh_;
    for (const auto edge : mesh.edges()) {
        const Halfedge forward = mesh.halfedge(edge);
        const int left         = orientation[first_triangle_ + mesh.face(forward)];
        const int right        = orientation[first_triangle_ + mesh.face(mesh.opposite(forward))];
        if (left != right)
            silhouette.push_back(
                {first_vertex_ + mesh.source(forward), first_vertex_ + mesh.target(forward), left - right});
    }
}

std::vector<Neighbours> ClosedMesh::neighbours() const {
    std::vector<Neighbours> neighbours;
    neighbours.reserve(mesh_->number_of_edges());
    for (const auto edge : mesh_->edges()) {
        const Halfedge forward = mesh_->halfedge(edge);
        neighbours.push_back(
            {first_triangle_ + mesh_->face(forward), first_triangle_ + mesh_->face(mesh_->opposite(forward))});
    }
    return neighbours;
}

std::size_t ClosedMesh::memory_bytes() const {
    // Connectivity, positions, and CGAL's mark of removal, one byte an element.
    return mesh_->number_of_vertices() * (sizeof(Vertex) + sizeof(vec3) + 1) +
           mesh_->number_of_edges() * (2 * 4 * sizeof(Halfedge) + 1) +
           mesh_->number_of_faces() * (sizeof(Halfedge) + 1);
}

}  // namespace umbra
