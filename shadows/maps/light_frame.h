// The place that a map looks from: a window onto the scene in light space, and how deep it reaches.
#pragma once

#include "umbra/shadows/maps/casters.h"

namespace umbra {

/// Light space: x right, y down, z away from the light, right-handed, about `origin`. The window is in x/z and y/z
/// (perspective) or in x and y (orthographic).
struct LightFrame {
    bool perspective = true;
    dvec3 origin{0};
    dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    dvec2 centre{0}, half{1};
    double near = 0, far = 1;
    double reach = 1;  ///< points are looked up here where |X|, |Y| <= reach W

    [[nodiscard]] dvec3 light_space(dvec3 p) const {
        const dvec3 v = p - origin;
        return {glm::dot(x, v), glm::dot(y, v), glm::dot(z, v)};
    }
    [[nodiscard]] double nearness(double depth) const {
        return perspective ? near * (far - depth) / (depth * (far - near)) : (far - depth) / (far - near);
    }
    /// The depth of a nearness.
    [[nodiscard]] double depth(double nearness) const {
        return perspective ? near * far / (nearness * (far - near) + near) : far - nearness * (far - near);
    }
    /// The position in world space that a place in the window, of [-1, 1]^2, has at a depth.
    [[nodiscard]] dvec3 position(dvec2 place, double depth) const {
        const dvec2 at = (centre + place * half) * (perspective ? depth : 1.0);
        return origin + at.x * x + at.y * y + depth * z;
    }
    /// See DepthMap::draw; W is z / far, or 1.
    [[nodiscard]] dmat4 clip_from_world() const {
        dvec4 X, Y, R, W;
        if (perspective) {
            X = dvec4((x - centre.x * z) / half.x, 0) / far;
            Y = dvec4((y - centre.y * z) / half.y, 0) / far;
            R = dvec4(-near * z, near * far) / ((far - near) * far);
            W = dvec4(z, 0) / far;
        } else {
            X = dvec4(x, -centre.x) / half.x;
            Y = dvec4(y, -centre.y) / half.y;
            R = dvec4(-z, far) / (far - near);
            W = dvec4(0, 0, 0, 1);
        }
        for (dvec4* row : {&X, &Y, &R, &W}) row->w -= glm::dot(dvec3(*row), origin);
        return glm::transpose(dmat4(X, Y, R, W));
    }
};

/// Any right-handed frame that looks along `z`.
[[nodiscard]] LightFrame looking_along(dvec3 origin, dvec3 z, bool perspective);

/// Rolls the frame about its z and sets window, near and far so that it just holds the scene. False, with the frame as
/// it was, where a perspective window would reach further than `widest` from the middle or behind the light.
bool fit_to_scene(LightFrame& frame, const SelectedCasters& casters, double widest);

}  // namespace umbra
