// Lights: what they are and what they give, but not what blocks them (that is S_j, see shadows/method.h).
#pragma once

#include <string>
#include <string_view>

#include "umbra/core/base/math.h"

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
    smooth     ///< 1 inside `inner`, 0 outside `cutoff`, glTF's KHR_lights_punctual interpolation squared between
};
struct Spot {
    SpotFalloff falloff = SpotFalloff::cosine;
    float exponent      = 1;
    float cutoff        = 0.7853982f;  ///< half angle of the cone, radians, in (0, pi/2]
    float inner         = 0;           ///< radians, in [0, cutoff); `smooth` only
};

/// One light j. Which members mean something depends on `kind`; the others keep their defaults. World space.
struct Light {
    std::string name;  ///< unique in its scene, no spaces or dots; the channel S.<name> in images
    LightKind kind = LightKind::point;
    vec3 position{0};          ///< all but directional; for area lights the centre
    vec3 direction{0, -1, 0};  ///< directional: where the light travels to (any length > 0). spot: its axis.
                               ///< disk: its normal. rectangle: cross(edge_u, edge_v). Unit except directional.
    vec3 edge_u{1, 0, 0};      ///< rectangle: full edges; corners are position +- edge_u/2 +- edge_v/2
    vec3 edge_v{0, 0, 1};      ///< rectangle
    float radius = 0;          ///< disk, sphere; > 0
    float range  = 0;          ///< beyond this distance it gives nothing; 0: no limit
    vec3 ambient{0};           ///< adds to the scene's global ambient; never shadowed, never attenuated
    vec3 diffuse{1};           ///< I_j for the diffuse term
    vec3 specular{1};          ///< I_j for the specular term
    Attenuation attenuation;
    Spot spot;
};

/// Unit vector from `p` to the light (to the centre of an area light), and the distance (infinite for directional).
struct ToLight {
    vec3 direction;
    float distance;
};
[[nodiscard]] ToLight to_light(const Light& light, vec3 p);

/// Attenuation times spot falloff times range cut-off at `p`: the f_att,j of the sum. Finite for every p.
[[nodiscard]] float falloff(const Light& light, vec3 p);

/// The spot factor alone for the cosine of the angle from the axis, in [0, 1].
[[nodiscard]] float spot_factor(const Spot& spot, float cos_angle);
[[nodiscard]] float attenuation_factor(const Attenuation& a, float distance);

}  // namespace umbra
