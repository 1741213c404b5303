// Fog between a surface and the eye: I' = f I + (1 - f) C. Where the scene says so, also between a light and a surface,
// where it takes light and adds none: the light arrives times f.
#pragma once

#include <cstdint>

#include "umbra/core/base/math.h"

namespace umbra {

enum class FogLaw : std::uint8_t {
    none,
    linear,              ///< f falls from near_share at `start` to far_share at `end`, and is constant beyond them
    exponential,         ///< f = e^(-density d)
    exponential_squared  ///< f = e^(-(density d)^2)
};
/// The meaning of d.
enum class FogDistance : std::uint8_t {
    radial,  ///< the distance from the eye (to the window of an orthographic camera)
    depth    ///< its part along the view direction, which rasterizers have at hand; a picture changes as the eye turns
};

struct Fog {
    FogLaw law           = FogLaw::none;
    FogDistance distance = FogDistance::radial;
    vec3 colour{0.5f};                    ///< C
    float density = 0;                    ///< >= 0, per world unit
    float start = 0, end = 1;             ///< world units; start < end
    float near_share = 1, far_share = 0;  ///< [0, 1]
    bool dims_lights = false;             ///< f of the distance from the light is part of f_att; lights at infinity,
                                          ///< which would be dark, are not dimmed
};

/// f at a distance >= 0: the fraction of a surface's light that arrives, [0, 1].
[[nodiscard]] double fog_share(const Fog& fog, double distance);

}  // namespace umbra
