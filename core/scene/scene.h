// The scene: world-space triangles with objects and materials, lights, one camera. Made once, read by all.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/base/math.h"
#include "umbra/core/scene/camera.h"
#include "umbra/core/scene/fog.h"
#include "umbra/core/scene/lights.h"
#include "umbra/core/scene/materials.h"

namespace umbra {

using TriangleId                        = std::uint32_t;
inline constexpr TriangleId kNoTriangle = 0xffffffffu;
inline constexpr double kMaxCoordinate  = 1e18;  ///< larger magnitudes are refused where scenes are read

/// Switches: how an object takes part in the picture and in shadows.
struct ObjectSwitches {
    bool casts_shadows    = true;  ///< false: it blocks and filters no light
    bool receives_shadows = true;  ///< false: S_j is 1 where some of the light is in front (Facing::unshadowed)
    bool seen_by_camera   = true;  ///< false: eye rays pass through it; mirrored and refracted rays do not
    [[nodiscard]] bool operator==(const ObjectSwitches&) const = default;
};

/// A switch, and its name in files.
struct ObjectSwitch {
    std::string_view key;
    bool ObjectSwitches::*is_on;
};
inline constexpr std::array kObjectSwitches{ObjectSwitch{"casts_shadows", &ObjectSwitches::casts_shadows},
                                            ObjectSwitch{"receives_shadows", &ObjectSwitches::receives_shadows},
                                            ObjectSwitch{"seen_by_camera", &ObjectSwitches::seen_by_camera}};

/// A run of consecutive triangles that moves together and has one material.
struct Object {
    std::string name;
    std::uint32_t first_triangle = 0;
    std::uint32_t triangle_count = 0;
    std::uint32_t material       = 0;
    ObjectSwitches switches{};
};

enum class ToneMap : std::uint8_t {
    clamp,   ///< min(I, 1)
    divide,  ///< I / max(I over the image), where that is above 1
    hue      ///< compresses the largest channel, scales the others with it: keeps hue and saturation
};

/// Variants of the sum that the lectures print. The first of each is the default.
enum class LightAmbient : std::uint8_t {
    constant,   ///< a light's own ambient term is the same at all points
    attenuated  ///< it is multiplied by the light's f_att, as OpenGL has it
};
enum class SpecularColour : std::uint8_t { O_s, O_d };      ///< the specular term is k_s O_s (...) or k_s O_d (...)
enum class AmbientCoefficient : std::uint8_t { k_a, k_d };  ///< the ambient term is I_a k_a O_d or I_a k_d O_d

/// The effect on S_j of a triangle whose material lets light through (see transmittance).
enum class TransparentOccluders : std::uint8_t {
    ignore,    ///< nothing: light is lost where an opaque triangle lies between, and nowhere else
    block,     ///< it blocks light as an opaque one does
    multiply,  ///< it lets its material's coloured_transmittance through, and triangles one behind the other the
               ///< product
};

/// Which axis of a mesh file points up. Scenes have y.
enum class UpAxis : std::uint8_t { y, z, minus_y };

/// Pixels along a side of a picture, in a scene file and on the command line.
inline constexpr int kMaxPictureSide = 16384;

struct Scene {
    std::string name;    ///< file name without folder and ending; names output folders
    std::string title;   ///< for people; defaults to `name`
    std::string shows;   ///< one sentence: what this scene shows
    std::string source;  ///< the file it came from; empty if made in memory

    dvec3 origin{0};  ///< where (0, 0, 0) is in the file's numbers: all positions here, lights and camera included, are
                      ///< relative to it. Not 0 only for a scene far from the file's own origin

    std::vector<vec3> positions;                 ///< finite
    std::vector<vec3> normals;                   ///< one a position, unit; zero where the face normal is meant
    std::vector<uvec3> triangles;                ///< indices into positions, anticlockwise seen from outside
    std::vector<std::uint32_t> triangle_object;  ///< one a triangle
    std::vector<Object> objects;                 ///< in order of first_triangle, covering all triangles
    std::vector<Material> materials;
    std::vector<Light> lights;

    Camera camera;
    int width  = 640;  ///< the picture's size where the command names none
    int height = 360;
    vec3 ambient{1};     ///< I_a, global
    vec3 background{0};  ///< where the eye ray meets nothing
    ToneMap tone   = ToneMap::clamp;
    float exposure = 1;  ///< factor before the tone map
    Fog fog;
    bool local_viewer                      = true;  ///< false: V is constant, against the view direction
    LightAmbient light_ambient             = LightAmbient::constant;
    SpecularColour specular_colour         = SpecularColour::O_s;
    AmbientCoefficient ambient_coefficient = AmbientCoefficient::k_a;
    TransparentOccluders transparent       = TransparentOccluders::ignore;

    int frames = 0;  ///< of the file's animation; 0: nothing moves
    int frame  = 0;  ///< the one that this scene is, [0, frames)

    std::vector<std::string> warnings;  ///< assumptions of loading, a sentence each

    [[nodiscard]] vec3 vertex(TriangleId t, int k) const { return positions[triangles[t][k]]; }
    [[nodiscard]] const Material& material(TriangleId t) const {
        return materials[objects[triangle_object[t]].material];
    }
    [[nodiscard]] const ObjectSwitches& switches(TriangleId t) const { return objects[triangle_object[t]].switches; }
    /// Whether triangle t takes all light that meets it.
    [[nodiscard]] bool blocks(TriangleId t) const {
        return switches(t).casts_shadows &&
               (transparent == TransparentOccluders::block || coloured_transmittance(material(t)) == vec3(0));
    }
    /// The fraction of light that triangle t lets through, per channel: 0 where it blocks.
    [[nodiscard]] vec3 lets_through(TriangleId t) const {
        if (blocks(t)) return vec3(0);
        const bool filters = transparent == TransparentOccluders::multiply && switches(t).casts_shadows;
        return filters ? coloured_transmittance(material(t)) : vec3(1);
    }
};

/// Whether some triangle lets a part of the light through, of some channel more than of another (lets_through).
[[nodiscard]] bool has_coloured_filters(const Scene& scene);

/// Gives every light that is fixed to the camera its pose in world space. Whoever moves the camera calls it.
void place_fixed_lights(Scene& scene);

/// Bounds of all triangles' vertices (unused positions do not count).
[[nodiscard]] Box bounds(const Scene& scene);

/// cross(b - a, c - a) in double; not normalised; its length is twice the area.
[[nodiscard]] dvec3 area_normal(const Scene& scene, TriangleId t);

/// Adds an object: positions, normals (may be empty: face normals) and triangles in world space.
/// Returns its index. Everything is copied; the caller keeps its own. Throws std::invalid_argument
/// where a triangle names a position that is not there.
std::uint32_t add_object(Scene& scene, std::string name, const std::vector<vec3>& positions,
                         const std::vector<vec3>& normals, const std::vector<uvec3>& triangles, std::uint32_t material);

}  // namespace umbra
