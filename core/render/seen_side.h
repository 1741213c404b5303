// Which side of a triangle a surface point shows, and when doubles can tell. Internal to core/render.
#pragma once

#include <cmath>

#include "umbra/core/base/rounding.h"

namespace umbra {

/// Whether the cross product of a triangle's sides, `length` long, has kept its direction: each component is off by a
/// few roundings of `sides`, the product of their magnitudes. Of a sliver it may be noise.
inline bool keeps_direction(double length, double sides) { return length > 1e-6 * sides; }

/// Whether the sign of the product of that vector with the way to the eye, `towards`, is beyond doubt: `reach` is the
/// sum of the magnitudes that the way was computed from. The product's error is less than 100 roundings of 2^-53.
inline bool keeps_sign(double towards, double sides, double reach) { return std::abs(towards) > 1e-13 * sides * reach; }

}  // namespace umbra
