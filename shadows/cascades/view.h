// What a camera sees between two depths: its corners, and the sphere around it.
#pragma once

#include <array>

#include "umbra/core/scene/camera.h"

namespace umbra {

/// Depths are along the camera's forward axis, from its eye, or from the window of an orthographic one; >= 0.
class View {
public:
    explicit View(const CameraFrame& frame) : frame_(frame) {}

    [[nodiscard]] dvec3 eye() const { return frame_.eye; }
    [[nodiscard]] double depth(dvec3 p) const { return glm::dot(frame_.forward, p - frame_.eye); }

    /// The view's sides, and that nothing is behind the eye: p lies within where, with v = p - eye, dot((v, 1), side)
    /// is nowhere negative.
    [[nodiscard]] std::array<dvec4, 5> sides() const;

    /// Of the part from one depth to another, world space.
    [[nodiscard]] std::array<dvec3, 8> corners(double from, double to) const;

    struct Sphere {
        dvec3 centre;
        double radius;
    };
    /// The smallest one about all corners of that part with its centre on the view's axis. Its radius does not depend
    /// on where the camera is and looks. [Michal Valient, Stable Rendering of Cascaded Shadow Maps, 2008]
    [[nodiscard]] Sphere sphere(double from, double to) const;

private:
    [[nodiscard]] bool is_perspective() const { return frame_.projection == Projection::perspective; }
    CameraFrame frame_;
};

}  // namespace umbra
