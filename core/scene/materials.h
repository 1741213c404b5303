// Phong materials, per channel.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "umbra/core/base/math.h"

namespace umbra {

enum class Lobe : std::uint8_t {
    phong,       ///< (R.V)^n   [Bui Tuong Phong, Illumination for Computer Generated Pictures, 1975]
    blinn_phong  ///< (N.H)^n   [James Blinn, Models of Light Reflection for Computer Synthesized Pictures, 1977]
};

/// One lobe k_s (e . C l)^n with e to the eye and l to the light, in a local frame: z is the normal, x the part of the
/// material's tangent that is perpendicular to it. C = diag(-1, -1, 1) is Phong's (R.V)^n.
/// [Eric Lafortune, Sing-Choong Foo, Kenneth Torrance, Donald Greenberg, Non-Linear Approximation of Reflectance
/// Functions, 1997]
struct LafortuneLobe {
    std::array<vec3, 3> rows{vec3(-1, 0, 0), vec3(0, -1, 0), vec3(0, 0, 1)};  ///< of C
    vec3 k_s{0};
    float shininess = 1;  ///< n, >= 0
};

/// I = I_e + I_a k_a O_d + sum_j S_j f_att,j I_j ( k_d O_d (N.L_j) + k_s O_s (R_j.V)^n )
struct Material {
    std::string name;
    vec3 k_a{0.1f};
    vec3 k_d{0.8f};
    vec3 k_s{0};
    vec3 O_d{1};          ///< diffuse colour
    vec3 O_s{1};          ///< specular colour
    vec3 emission{0};     ///< I_e
    float shininess = 1;  ///< n, >= 0
    Lobe lobe       = Lobe::phong;
    bool two_sided  = true;   ///< the side that faces the eye is lit; otherwise the side of the winding only
    bool cutout     = false;  ///< a texture's alpha cuts its outline, which is not computed: it is whole
    float opacity   = 1;      ///< 1 opaque
    float reflect   = 0;      ///< k_r, Whitted's mirrored share; in ray_tree.h alone
    float transmit  = 0;      ///< k_t, Whitted's transmitted share
    vec3 transmit_colour{1};  ///< [0, 1], of light that passes through: a factor of k_t and of 1 - opacity
    float index_of_refraction = 1;
    std::vector<LafortuneLobe> lobes{};  ///< added to the specular term
    vec3 tangent{1, 0, 0};               ///< of `lobes`, world space, any length > 0
};

/// The fraction of light that a surface of this material lets through, [0, 1]: 1 - opacity or k_t, whichever is more.
[[nodiscard]] inline float transmittance(const Material& m) { return std::max(1 - m.opacity, m.transmit); }
/// The same per channel.
[[nodiscard]] inline vec3 coloured_transmittance(const Material& m) { return transmittance(m) * m.transmit_colour; }

}  // namespace umbra
