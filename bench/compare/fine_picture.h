// Pictures with several surface points a pixel, for people to look at.
#pragma once

#include <string>
#include <vector>

#include "umbra/bench/compare/image_figures.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/run.h"

namespace umbra {

/// S_j and the sum at the subpixels of a picture.
struct FinePicture {
    std::string of;  ///< the method and its settings; empty: there is none
    std::vector<VisibilityPlane> planes;
    Image linear;
};

/// Of a method that has answered the picture; empty where there may be one point a pixel only: no others are prepared,
/// or the method judged a part of the picture. Aims the method at each light.
[[nodiscard]] FinePicture fine_picture(const PreparedScene& prepared, const MethodRun& run);

/// What people look at: `rendered` with several points a pixel where there may be. The sum is evaluated only where S_j
/// is not that of `known`.
[[nodiscard]] Image picture_of(const PreparedScene& prepared, const MethodRun& run, const Rendered& rendered,
                               const FinePicture& known);

}  // namespace umbra
