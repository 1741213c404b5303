// Silhouettes: the edges at which a mesh turns away from a light.
//
// A closed object is a halfedge mesh of CGAL (closed_mesh.h), and its silhouettes are read off that mesh. A halfedge
// mesh holds 2-manifolds only: where an edge has one triangle, three, or two that run it in the same direction, or
// where a vertex has two fans, CGAL refuses the triangle. Scenes have such objects, and shadow volumes serve them; they
// stay in the project's own core/scene/topology.h, where an edge has any number of triangles. That is also what says
// whether an object is such a manifold (ObjectFacts::manifold), since it has to count the faults of those that are not.
// Which way a triangle faces is decided by CGAL's exact predicates for both kinds.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "umbra/core/scene/facts.h"
#include "umbra/shadows/volumes/closed_mesh.h"

namespace umbra {

/// An object with edges that any number of triangles share.
struct Soup {
    std::vector<Edge> edges;    ///< vertices counted over the scene
    std::vector<EdgeUse> uses;  ///< triangles counted over the scene
};

/// One object: a mesh where it is closed, otherwise a soup.
struct ObjectMesh {
    TriangleId first_triangle    = 0;
    std::uint32_t triangle_count = 0;
    std::optional<ClosedMesh> closed;
    Soup soup;
};

/// The meshes of a scene's objects, ready to be asked for their silhouettes. Vertices are welded object by object.
class SilhouetteMeshes {
public:
    /// `facts`: those of the scene's objects (find_object_facts).
    SilhouetteMeshes(const Scene& scene, std::span<const ObjectFacts> facts);

    [[nodiscard]] const std::vector<uvec3>& triangles() const { return triangles_; }  ///< welded, in scene order
    [[nodiscard]] const std::vector<vec3>& vertices() const { return vertices_; }     ///< of the welded vertices
    [[nodiscard]] const std::vector<ObjectMesh>& objects() const { return objects_; }

    /// facing_of each triangle of the scene.
    [[nodiscard]] std::vector<std::int8_t> facing(const Light& light) const;

    /// The edges where the chosen triangles do not cancel. orientation[t] is +1 where triangle t is taken as wound, -1
    /// where it is taken turned over, 0 where it is left out. Of a closed mesh and its triangles that face the light
    /// these are the silhouette edges, each of weight +1 or -1; with every triangle turned to face the light they have
    /// weight 2, and any soup of triangles has a right answer. [Philippe Bergeron, A General Version of Crow's Shadow
    /// Volumes, 1986; Byungmoon Kim, Kihwan Kim, Greg Turk, A Shadow-Volume Algorithm for Opaque and Transparent
    /// Nonmanifold Casters, 2008]
    [[nodiscard]] std::vector<SilhouetteEdge> edges(std::span<const std::int8_t> orientation) const;

    [[nodiscard]] std::size_t memory_bytes() const;

private:
    std::vector<uvec3> triangles_;
    std::vector<vec3> vertices_;
    std::vector<ObjectMesh> objects_;
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
