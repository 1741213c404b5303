#include "umbra/core/scene/camera.h"

#include <cmath>

namespace umbra {

CameraFrame frame(const Camera& camera, int width, int height) {
    CameraFrame f;
    f.projection = camera.projection;
    f.width      = width;
    f.height     = height;
    f.eye        = dvec3(camera.eye);
    f.forward    = glm::normalize(dvec3(camera.target) - dvec3(camera.eye));
    dvec3 side   = glm::cross(f.forward, dvec3(camera.up));
    if (glm::dot(side, side) < 1e-20 * glm::dot(dvec3(camera.up), dvec3(camera.up))) {  // looking along `up`
        side = glm::cross(f.forward, std::abs(f.forward.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0));
    }
    f.right       = glm::normalize(side);
    f.up          = glm::cross(f.right, f.forward);
    f.half_height = camera.projection == Projection::perspective
                        ? std::tan(static_cast<double>(camera.fov_y) * kPi / 360)
                        : 0.5 * static_cast<double>(camera.height);
    f.half_width  = f.half_height * width / height;
    return f;
}

namespace {

dvec3 window_point(const CameraFrame& f, double x, double y) {
    return f.half_width * (2 * x / f.width - 1) * f.right - f.half_height * (2 * y / f.height - 1) * f.up;
}

}  // namespace

dvec3 CameraFrame::ray_origin(double x, double y) const {
    return projection == Projection::perspective ? eye : eye + window_point(*this, x, y);
}

dvec3 CameraFrame::ray_direction(double x, double y) const {
    return projection == Projection::perspective ? forward + window_point(*this, x, y) : forward;
}

dvec3 CameraFrame::project(dvec3 p) const {
    const dvec3 v      = p - eye;
    const double depth = glm::dot(v, forward);
    const double scale = projection == Projection::perspective ? depth : 1;
    return {0.5 * width * (1 + glm::dot(v, right) / (half_width * scale)),
            0.5 * height * (1 - glm::dot(v, up) / (half_height * scale)), depth};
}

}  // namespace umbra
