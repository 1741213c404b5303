// The camera: a pinhole (or an orthographic window) in world space.
#pragma once

#include "umbra/core/base/math.h"

namespace umbra {

enum class Projection : std::uint8_t { perspective, orthographic };

struct Camera {
    Projection projection = Projection::perspective;
    vec3 eye{0, 1, 5};
    vec3 target{0, 0, 0};
    vec3 up{0, 1, 0};
    float fov_y  = 45;  ///< degrees, full vertical angle, in (0, 180); perspective only
    float height = 2;   ///< world units, full height of the window; orthographic only
};

/// The camera made ready for one raster. Pixel (x, y) counts from the top left corner, its centre is (x + 0.5, y +
/// 0.5). Double, so that far cameras and narrow angles do not shake; the eye ray of a pixel is
///     perspective:  origin = eye,               direction = forward + sx right + sy up
///     orthographic: origin = eye + sx right + sy up, direction = forward
/// with sx = half_width (2 (x + 0.5) / width - 1), sy = -half_height (2 (y + 0.5) / height - 1).
struct CameraFrame {
    Projection projection = Projection::perspective;
    int width             = 0;
    int height            = 0;
    dvec3 eye{0};
    dvec3 forward{0, 0, -1};
    dvec3 right{1, 0, 0};
    dvec3 up{0, 1, 0};
    double half_width  = 1;
    double half_height = 1;

    [[nodiscard]] dvec3 ray_origin(double x, double y) const;     ///< x, y in pixels, centres at +0.5
    [[nodiscard]] dvec3 ray_direction(double x, double y) const;  ///< not normalised
    /// Pixel coordinates (x, y) and depth along `forward` of a world point. Depth <= 0: behind a perspective eye.
    [[nodiscard]] dvec3 project(dvec3 p) const;
};
[[nodiscard]] CameraFrame frame(const Camera& camera, int width, int height);

}  // namespace umbra
