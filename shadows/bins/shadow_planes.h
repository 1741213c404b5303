// The shadows of eight triangles as four planes each, in floats with a bound on their rounding: a point is in a shadow,
// is outside, or the bound cannot tell.
#pragma once

#include <cstdint>

#include "umbra/shadows/bins/point_bins.h"

namespace umbra::bins {

/// The half spaces whose intersection is a shadow, each scaled so that rounding moves a value by less than 1: a value
/// above 1 is inside, below -1 outside.
class ShadowPlanes {
public:
    /// `corners`: of the triangles, less the bins' centre. `turn`: +1 where a triangle's winding faces away from
    /// the light, -1 where it faces the light; 0 where its plane holds the light, so that it hides nothing and may be
    /// touched: a lane outside is away from that plane, and none is inside. `travel`: how light travels to the corners,
    /// any length. `reach`: the largest magnitude of each coordinate of the points that are asked.
    ShadowPlanes(const LightImage::Corners& corners, const LightImage::Corners& travel, const double (&turn)[kLanes],
                 dvec3 reach);

    /// Which lanes of a block are in a shadow, and of which that is not known.
    struct InShadow {
        std::uint8_t inside, unsure;
    };
    /// Tests the triangles whose bits are set in `which`; of those to which any lane is inside or unsure writes the
    /// lanes, and returns their bits.
    unsigned test(unsigned which, const Block& block, InShadow (&lanes)[kLanes]) const;

private:
    using Vectors = LaneArray<double>[3];

    [[nodiscard]] unsigned lanes_of(std::size_t t, const Block& block) const;
    void set(std::size_t plane, const Vectors& first, const Vectors& second, const Vectors& through,
             const double (&turn)[kLanes], dvec3 reach);

    float x_[4][kLanes], y_[4][kLanes], z_[4][kLanes], offset_[4][kLanes];
};

}  // namespace umbra::bins
