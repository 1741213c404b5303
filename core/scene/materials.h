// Phong materials, per channel.
#pragma once

#include <string>

#include "umbra/core/base/math.h"

namespace umbra {

enum class Lobe : std::uint8_t {
    phong,       ///< (R.V)^n   [Bui Tuong Phong, Illumination for Computer Generated Pictures, 1975]
    blinn_phong  ///< (N.H)^n   [James Blinn, Models of Light Reflection for Computer Synthesized Pictures, 1977]
};

/// I = I_e + I_a k_a O_d + sum_j S_j f_att,j I_j ( k_d O_d (N.L_j) + k_s O_s (R_j.V)^n )
struct Material {
    std::string name;
    vec3 k_a{0.1f};
    vec3 k_d{0.8f};
    vec3 k_s{0};
    vec3 O_d{1};                    ///< diffuse colour
    vec3 O_s{1};                    ///< specular colour
    vec3 emission{0};               ///< I_e
    float shininess           = 1;  ///< n, >= 0
    Lobe lobe                 = Lobe::phong;
    bool two_sided            = true;  ///< the side that faces the eye is lit; otherwise the side of the winding only
    float opacity             = 1;     ///< 1 opaque; every triangle is opaque to S_j as yet (see uncomputed.h)
    float reflect             = 0;     ///< Whitted's mirror share; not computed
    float transmit            = 0;     ///< Whitted's transmitted share; not computed
    float index_of_refraction = 1;
};

}  // namespace umbra
