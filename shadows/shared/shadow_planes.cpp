#include "umbra/shadows/shared/shadow_planes.h"

namespace umbra::binned_shadows_detail {

// Compiled so that the loop over lanes becomes vector code: shadows/CMakeLists.txt.
ShadowPlanes::Lanes ShadowPlanes::test(const Block& block) const {
    float least[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i) {
        const float a  = x[0] * block.x[i] + y[0] * block.y[i] + z[0] * block.z[i] + offset[0],
                    b  = x[1] * block.x[i] + y[1] * block.y[i] + z[1] * block.z[i] + offset[1],
                    c  = x[2] * block.x[i] + y[2] * block.y[i] + z[2] * block.z[i] + offset[2],
                    d  = x[3] * block.x[i] + y[3] * block.y[i] + z[3] * block.z[i] + offset[3];
        const float ab = a < b ? a : b, cd = c < d ? c : d;
        least[i] = ab < cd ? ab : cd;
    }
    unsigned inside = 0, outside = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
        inside |= static_cast<unsigned>(least[i] > 1) << i;
        outside |= static_cast<unsigned>(least[i] < -1) << i;
    }
    return {static_cast<std::uint8_t>(inside), static_cast<std::uint8_t>(~(inside | outside))};
}

}  // namespace umbra::binned_shadows_detail
