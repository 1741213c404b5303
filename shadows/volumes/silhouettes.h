// Silhouettes: the edges at which a mesh turns away from a light.
//
// A closed object is a halfedge mesh of CGAL, and its silhouettes are read off that mesh. A halfedge mesh holds
// 2-manifolds only: where an edge has one triangle, three, or two that run it in the same direction, or where a vertex
// has two fans, CGAL refuses the triangle. Other objects are lists of edges, each with any number of triangles. Which
// object is such a manifold (ObjectFacts::manifold) is decided by core/scene/topology.h, which counts the faults of the
// others, and which way a triangle faces by CGAL's exact predicates.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "umbra/core/scene/facts.h"
#include "umbra/shadows/geometry/edges.h"

namespace umbra {

/// The two triangles at an edge a-b of a closed mesh, a < b: `left` runs it from a to b, `right` from b to a.
struct Neighbours {
    TriangleId left = 0, right = 0;
};

/// One object. All vertices and triangles are counted over the scene.
class SilhouetteMesh {
public:
    /// `first_vertex`: the number that the object's first welded vertex has in the scene.
    SilhouetteMesh(const Scene& scene, const Topology& topology, std::uint32_t first_vertex, bool closed);

    [[nodiscard]] bool closed() const { return halfedges_ != nullptr; }
    /// One for each edge of a closed object, sorted by a, then b.
    [[nodiscard]] std::vector<Neighbours> neighbours() const;
    /// The edges of any other.
    [[nodiscard]] const EdgeList& soup() const { return soup_; }

    /// SilhouetteMeshes::edges of this object, after `others`.
    [[nodiscard]] std::vector<ChangeEdge> edges(std::span<const std::int8_t> orientation,
                                                std::vector<ChangeEdge> others) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    struct Halfedges;                             // a mesh of CGAL
    std::shared_ptr<const Halfedges> halfedges_;  // null where the object is not closed
    EdgeList soup_;
};

/// The meshes of a scene's objects, ready to be asked for their silhouettes. Vertices are welded object by object.
class SilhouetteMeshes {
public:
    /// `facts`: those of the scene's objects (find_object_facts).
    SilhouetteMeshes(const Scene& scene, std::span<const ObjectFacts> facts);

    [[nodiscard]] const std::vector<uvec3>& triangles() const { return triangles_; }  ///< welded, in scene order
    [[nodiscard]] const std::vector<vec3>& vertices() const { return vertices_; }     ///< of the welded vertices
    [[nodiscard]] const std::vector<SilhouetteMesh>& objects() const { return objects_; }

    /// The edges where the chosen triangles do not cancel, object by object, sorted by a, then b. orientation[t] is +1
    /// where triangle t is taken as wound, -1 where it is taken turned over, 0 where it is left out. Of a closed mesh
    /// and its triangles that face the light these are the silhouette edges, each of change +1 or -1; with every
    /// triangle turned to face the light they have change 2, and any soup of triangles has a right answer.
    [[nodiscard]] std::vector<ChangeEdge> edges(std::span<const std::int8_t> orientation) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    std::vector<uvec3> triangles_;
    std::vector<vec3> vertices_;
    std::vector<SilhouetteMesh> objects_;
};

/// The number of silhouette edges of one object over random lights at infinity: those between a triangle that faces the
/// light and one that does not (in a plane with the light: does not), and every edge of a soup whose triangles, turned
/// to face the light, do not cancel; so the border of an open mesh counts always.
struct SilhouetteStatistics {
    std::string object;
    double mean              = 0;
    double standard_error    = 0;  ///< of the mean; 0 for one direction
    std::uint64_t directions = 0;
};

/// One entry an object. Directions are uniform over the sphere, the same for the same seed and any number of threads.
/// For a closed mesh the expected mean is the sum of its dihedral angles, between normals, over pi.
/// [Morgan McGuire, Observations on Silhouette Sizes, 2004]
[[nodiscard]] std::vector<SilhouetteStatistics> silhouette_statistics(const Scene& scene, std::uint64_t directions,
                                                                      std::uint64_t seed);

}  // namespace umbra
