// Lights: their kinds and the light that they give, but not the triangles that block it (that is S_j, see
// shadows/method.h).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/base/math.h"
#include "umbra/core/scene/photometry.h"

namespace umbra {

using LightId = std::uint32_t;  ///< index into Scene::lights

enum class LightKind : std::uint8_t { directional, point, spot, rectangle, disk, sphere };
[[nodiscard]] std::string_view to_string(LightKind kind);
[[nodiscard]] constexpr bool is_area(LightKind k) { return k >= LightKind::rectangle; }

/// f_att = 1 / (c1 + c2 d + c3 d^2), limited to at most 1 where `clamp` is set.
/// All three zero is refused where scenes are read.
struct Attenuation {
    float c1   = 1;
    float c2   = 0;
    float c3   = 0;
    bool clamp = true;
};

/// How a spot light falls off with the angle a from its axis; 0 outside the cone, always.
enum class SpotFalloff : std::uint8_t {
    cosine,    ///< cos^n(a), OpenGL's
    zachmann,  ///< max(0, (cos^n(a) - cos(t)) / (1 - cos(t))), t the cut-off angle
    smooth     ///< 1 inside `inner`, 0 outside `cutoff`, the square of a line in cos(a) between; one step where the two
               ///< are equal
};
struct Spot {
    SpotFalloff falloff = SpotFalloff::cosine;
    float exponent      = 1;
    float cutoff        = 0.7853982f;  ///< half angle of the cone, radians, in (0, pi/2]
    float inner         = 0;           ///< radians, in [0, cutoff]; `smooth` only
};

/// Where a light is and how it is turned, in some space; members as in Light.
struct LightPose {
    vec3 position{0};
    vec3 direction{0, -1, 0};
    vec3 edge_u{1, 0, 0};
    vec3 edge_v{0, 0, 1};
    vec3 along{1, 0, 0};
};

/// One light j. Which members mean something depends on `kind`; the others keep their defaults. World space.
struct Light {
    std::string name;  ///< unique in its scene, no spaces or dots; the channel S.<name> in images
    LightKind kind = LightKind::point;
    vec3 position{0};          ///< all but directional; for area lights the centre
    vec3 direction{0, -1, 0};  ///< directional: where the light travels to (any length > 0). spot: its axis.
                               ///< disk: its normal. rectangle: cross(edge_u, edge_v). Unit except directional.
                               ///< point with `photometry`: that of the vertical angle 0, any length > 0.
    vec3 edge_u{1, 0, 0};      ///< rectangle: full edges; corners are position +- edge_u/2 +- edge_v/2
    vec3 edge_v{0, 0, 1};      ///< rectangle
    float radius = 0;          ///< disk, sphere; > 0
    float range  = 0;          ///< beyond this distance it gives nothing; 0: no limit
    vec3 ambient{0};           ///< adds to the scene's global ambient; never shadowed, attenuated if the scene says so
    vec3 diffuse{1};           ///< I_j for the diffuse term
    vec3 specular{1};          ///< I_j for the specular term
    Attenuation attenuation;
    Spot spot;
    std::shared_ptr<const Photometry> photometry;  ///< point: intensities by direction, which I_j is multiplied by;
                                                   ///< null: 1 in all directions. Without a fault, and never changed
    vec3 along{1, 0, 0};  ///< with `photometry`: turns the table about `direction`, to which it is not parallel
    std::vector<std::string> except;       ///< names of objects that it does not light; S_j stays as it is
    std::optional<LightPose> camera_pose;  ///< fixed to the camera, with this pose in the space of the camera: x right,
                                           ///< y up, -z forward, the eye at 0. The pose above follows from it, see
                                           ///< place_fixed_lights
};

/// Whether the light lights objects of this name: false if `except` has it, or has NAME of an object NAME/PART.
[[nodiscard]] bool lights_object(const Light& light, std::string_view object);

[[nodiscard]] LightPose pose_of(const Light& light);  ///< in world space
void set_pose(Light& light, const LightPose& pose);   ///< in world space

/// Unit vector from `p` to the light (to the centre of an area light), and the distance (infinite for directional).
struct ToLight {
    vec3 direction;
    float distance;
};
[[nodiscard]] ToLight to_light(const Light& light, vec3 p);

/// Attenuation times spot falloff times range cut-off at `p`, times the intensity that `photometry` has in its
/// direction: the f_att,j of the sum. Finite for every p.
[[nodiscard]] float falloff(const Light& light, vec3 p);

/// The spot factor alone for the cosine of the angle from the axis, in [0, 1].
[[nodiscard]] float spot_factor(const Spot& spot, float cos_angle);
[[nodiscard]] float attenuation_factor(const Attenuation& a, float distance);

}  // namespace umbra
