#include "umbra/core/scene/fog.h"

#include <algorithm>
#include <cmath>

namespace umbra {

double fog_share(const Fog& fog, double distance) {
    const double reach = static_cast<double>(fog.density) * distance;
    switch (fog.law) {
        case FogLaw::none: return 1;
        case FogLaw::linear: {
            const double start = fog.start, end = fog.end, t = std::clamp((distance - start) / (end - start), 0.0, 1.0);
            return (1 - t) * static_cast<double>(fog.near_share) + t * static_cast<double>(fog.far_share);
        }
        case FogLaw::exponential: return std::exp(-reach);
        case FogLaw::exponential_squared: return std::exp(-reach * reach);
    }
    return 1;
}

}  // namespace umbra
