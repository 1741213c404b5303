#include "umbra/shadows/cascades/view.h"

#include <algorithm>
#include <cmath>

namespace umbra {

std::array<dvec4, 5> View::sides() const {
    const CameraFrame& f = frame_;
    const auto side      = [&](double half, dvec3 inwards) {
        return is_perspective() ? dvec4(half * f.forward + inwards, 0) : dvec4(inwards, half);
    };
    return {side(f.half_width, f.right), side(f.half_width, -f.right), side(f.half_height, f.up),
            side(f.half_height, -f.up), dvec4(f.forward, 0)};
}

std::array<dvec3, 8> View::corners(double from, double to) const {
    std::array<dvec3, 8> all;
    for (int i = 0; i < 8; ++i) {
        const double depth = i & 4 ? to : from;
        const dvec3 aside =
            (i & 1 ? 1 : -1) * frame_.half_width * frame_.right + (i & 2 ? 1 : -1) * frame_.half_height * frame_.up;
        all[i] = frame_.eye + depth * frame_.forward + (is_perspective() ? depth : 1) * aside;
    }
    return all;
}

View::Sphere View::sphere(double from, double to) const {
    const double wide = std::hypot(frame_.half_width, frame_.half_height);
    // As far from the nearer corners as from the farther ones; but where the view is wide, the farther ones alone bound
    // it, about their own centre.
    const double middle = is_perspective() ? std::min(to, 0.5 * (from + to) * (1 + wide * wide)) : 0.5 * (from + to);
    const double radius = std::hypot(to - middle, is_perspective() ? to * wide : wide);
    return {frame_.eye + middle * frame_.forward, radius};
}

}  // namespace umbra
