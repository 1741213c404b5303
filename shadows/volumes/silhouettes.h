// Silhouettes: the edges at which a mesh turns away from a light. The one place that talks CGAL meshes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "umbra/core/scene/scene.h"
#include "umbra/core/scene/topology.h"

namespace umbra {

/// How each triangle of the scene stands to the light (area lights by their centre): +1 where its winding's side faces
/// the light, -1 where the other does, 0 where its plane contains the light or it has no area. Exact.
[[nodiscard]] std::vector<std::int8_t> facing_triangles(const Scene& scene, const Light& light);

/// An edge that a shadow volume extrudes away from the light. `weight` counts the chosen triangles beside it, as the
/// light sees them: those that run it anticlockwise from a to b less those that run it from b to a.
struct SilhouetteEdge {
    std::uint32_t a = 0, b = 0;  ///< welded vertices, a < b
    std::int32_t weight = 0;     ///< never 0
};

/// The meshes of a scene's objects, ready to be asked for their silhouettes. Vertices are welded object by object.
class SilhouetteMeshes {
public:
    explicit SilhouetteMeshes(const Scene& scene);

    [[nodiscard]] const std::vector<uvec3>& triangles() const { return triangles_; }  ///< welded, in scene order
    [[nodiscard]] const std::vector<vec3>& vertices() const { return vertices_; }     ///< of the welded vertices
    /// True where the object is a closed 2-manifold, consistently oriented: then CGAL's mesh holds all its triangles.
    [[nodiscard]] bool closed(std::size_t object) const { return meshes_[object].closed; }
    /// True where it is closed and each of its connected parts is wound outwards.
    [[nodiscard]] bool solid(std::size_t object) const { return meshes_[object].solid; }

    /// The edges where the chosen triangles do not cancel. turn[t] is +1 where triangle t is taken as wound, -1 where
    /// it is taken turned over, 0 where it is left out. Of a closed mesh and its triangles that face the light these
    /// are the silhouette edges, each of weight +1 or -1; with every triangle turned to face the light they have weight
    /// 2, and any soup of triangles has a right answer. [Philippe Bergeron, A General Version of Crow's Shadow Volumes,
    /// 1986; Byungmoon Kim, Kihwan Kim, Greg Turk, A Shadow-Volume Algorithm for Opaque and Transparent Nonmanifold
    /// Casters, 2008]
    [[nodiscard]] std::vector<SilhouetteEdge> edges(std::span<const std::int8_t> turn) const;

    [[nodiscard]] std::size_t memory_bytes() const;

    /// An edge with two triangles, as a halfedge mesh knows it: `left` runs it from a to b, `right` from b to a.
    struct ClosedEdge {
        std::uint32_t a = 0, b = 0;
        TriangleId left = 0, right = 0;
    };
    /// One object: either closed, with edges from CGAL, or a soup, with edges that any number of triangles share.
    struct ObjectMesh {
        bool closed = false;
        bool solid  = false;
        std::vector<ClosedEdge> closed_edges;
        std::vector<Edge> soup_edges;    ///< vertices counted over the scene
        std::vector<EdgeUse> soup_uses;  ///< triangles counted over the scene
    };
    [[nodiscard]] const std::vector<ObjectMesh>& meshes() const { return meshes_; }

private:
    std::vector<uvec3> triangles_;
    std::vector<vec3> vertices_;
    std::vector<ObjectMesh> meshes_;
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
