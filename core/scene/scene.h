// The scene: world-space triangles with objects and materials, lights, one camera. Made once, read by all.
#pragma once

#include <string>
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

/// A run of consecutive triangles that moves together and has one material.
struct Object {
    std::string name;
    std::uint32_t first_triangle = 0;
    std::uint32_t triangle_count = 0;
    std::uint32_t material       = 0;
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

/// What a triangle whose material lets light through (see transmittance) does to S_j.
enum class TransparentOccluders : std::uint8_t {
    ignore,    ///< nothing: light is lost where an opaque triangle lies between, and nowhere else
    block,     ///< it blocks light as an opaque one does
    multiply,  ///< it lets its material's coloured_transmittance through, and triangles one behind the other the
               ///< product
};

/// Pixels along a side of a picture, in a scene file and on the command line.
inline constexpr int kMaxPictureSide = 16384;

struct Scene {
    std::string name;    ///< file name without folder and ending; names output folders
    std::string title;   ///< for people; defaults to `name`
    std::string shows;   ///< one sentence: what this scene shows
    std::string source;  ///< the file it came from; empty if made in memory

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

    std::vector<std::string> warnings;  ///< what loading assumed, a sentence each

    [[nodiscard]] vec3 vertex(TriangleId t, int k) const { return positions[triangles[t][k]]; }
    [[nodiscard]] const Material& material(TriangleId t) const {
        return materials[objects[triangle_object[t]].material];
    }
    /// Whether triangle t takes all light that meets it.
    [[nodiscard]] bool blocks(TriangleId t) const {
        return transparent == TransparentOccluders::block || coloured_transmittance(material(t)) == vec3(0);
    }
    /// What triangle t leaves of light that passes through it, per channel: 0 where it blocks.
    [[nodiscard]] vec3 lets_through(TriangleId t) const {
        if (blocks(t)) return vec3(0);
        return transparent == TransparentOccluders::multiply ? coloured_transmittance(material(t)) : vec3(1);
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
/// Returns its index. The caller owns what it passed; everything is copied. Throws std::invalid_argument
/// where a triangle names a position that is not there.
std::uint32_t add_object(Scene& scene, std::string name, const std::vector<vec3>& positions,
                         const std::vector<vec3>& normals, const std::vector<uvec3>& triangles, std::uint32_t material);

}  // namespace umbra
