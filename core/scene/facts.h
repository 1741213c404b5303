// Scene facts: what a scene requires, found once, so that what it does not require is not computed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/scene/planes.h"
#include "umbra/core/scene/scene.h"
#include "umbra/core/scene/uncomputed.h"

namespace umbra {

/// Topology of one object, over positions welded where they are bit-equal.
struct ObjectFacts {
    std::string name;
    std::uint32_t triangles = 0, vertices = 0;  ///< vertices after welding, used ones only
    std::uint32_t boundary_edges       = 0;     ///< one face
    std::uint32_t nonmanifold_edges    = 0;     ///< three or more faces
    std::uint32_t misoriented_edges    = 0;     ///< two faces that run it in the same direction
    std::uint32_t nonmanifold_vertices = 0;     ///< more than one fan of faces
    std::uint32_t degenerate_triangles = 0;     ///< exact zero area (two equal welded corners included)
    std::uint32_t duplicate_triangles  = 0;     ///< same three welded corners as an earlier one, in any order
    std::uint32_t components           = 0;     ///< connected over shared welded vertices
    bool manifold = false;  ///< closed 2-manifold, zero area allowed: two triangles an edge, in opposite directions,
                            ///< one fan a vertex, no corner repeated; a halfedge mesh can hold it without a border
    bool closed  = false;   ///< manifold, and none of the faults above, duplicates included
    bool outward = false;   ///< closed and of positive volume
    bool solid   = false;   ///< manifold, and each of its connected parts is of positive volume
    bool planar  = false;   ///< all its triangles lie in one plane
    double area = 0, volume = 0;  ///< volume by the divergence theorem; where the object is not closed,
                                  ///< that of the cones from the world's origin to its triangles
    Box box;
    ObjectSwitches switches;
};

/// The position of a light relative to the eye, the lecture's four cases.
enum class LightPlace : std::uint8_t { at_infinity, outside_view, inside_view, at_eye };
[[nodiscard]] std::string_view to_string(LightPlace place);

struct LightFacts {
    std::string name;
    LightKind kind   = LightKind::point;
    LightPlace place = LightPlace::at_infinity;
    bool hard() const { return !is_area(kind); }  ///< S_j is 0 or 1
};

struct SceneFacts {
    std::uint64_t triangles = 0;
    Box box;
    std::vector<ObjectFacts> objects;
    std::vector<LightFacts> lights;
    std::vector<PlanarReceiver> planes;  ///< those with at least `planar_share` of the scene's area each, largest first
    double planar_area_share     = 0;    ///< share of the scene's area that lies in `planes`, [0, 1]
    std::uint32_t closed_objects = 0, open_objects = 0, nonmanifold_objects = 0, misoriented_objects = 0;
    std::uint64_t degenerate_triangles = 0, duplicate_triangles = 0;
    bool has_specular = false, has_emission = false, has_transparency = false, has_mirrors = false, has_ambient = false,
         has_attenuation = false, has_one_sided = false, has_fog = false, has_goniometric = false,
         has_fixed_light = false, has_exceptions = false, has_lobes = false, has_attenuated_ambient = false;
    bool has_coloured_filters = false;       ///< and of some channel more than of another
    bool has_filters          = false;       ///< some triangle lets a part of the light through (Scene::lets_through)
    bool has_cutouts          = false;       ///< some triangle has an outline that is not computed (Material::cutout)
    std::vector<UncomputedTerm> uncomputed;  ///< asked for by materials, missing in pictures of the sum
    bool hard_lights_only         = true;
    bool eye_inside_closed_object = false;
};

/// A plane counts as a receiver from this fraction of the scene's area on.
inline constexpr double kPlanarShare = 0.005;

[[nodiscard]] std::vector<ObjectFacts> find_object_facts(const Scene& scene);  ///< one entry an object, in order
[[nodiscard]] SceneFacts find_facts(const Scene& scene);

/// The things that the scene asks a renderer for, and those it does not: a phrase each, for people.
[[nodiscard]] std::vector<std::string> requires_list(const SceneFacts& facts);
[[nodiscard]] std::vector<std::string> not_required_list(const SceneFacts& facts);

}  // namespace umbra
