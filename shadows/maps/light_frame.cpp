#include "umbra/shadows/maps/light_frame.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "umbra/core/base/lanes.h"

namespace umbra {

constexpr int kRolls = 16;  // orientations of the map tried about the light's direction

LightFrame looking_along(dvec3 origin, dvec3 z, bool perspective) {
    LightFrame frame;
    frame.perspective = perspective;
    frame.origin      = origin;
    frame.z           = glm::normalize(z);
    const dvec3 a     = glm::abs(frame.z);
    const dvec3 aside = a.x <= a.y && a.x <= a.z ? dvec3(1, 0, 0) : a.y <= a.z ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
    frame.x           = glm::normalize(glm::cross(aside, frame.z));
    frame.y           = glm::cross(frame.z, frame.x);
    return frame;
}

bool fit_to_scene(LightFrame& frame, const SelectedCasters& casters, double widest) {
    // The scene's own axes make good edges of the window (floors, walls); the other rolls are spread evenly.
    std::array<double, kRolls> angles;
    for (int i = 0; i < 3; ++i) angles[i] = std::atan2(frame.y[i], frame.x[i]);
    for (int i = 3; i < kRolls; ++i) angles[i] = (i - 3) * (kPi / 2) / (kRolls - 3);
    std::array<double, kRolls> cosines, sines;
    for (int i = 0; i < kRolls; ++i) cosines[i] = std::cos(angles[i]), sines[i] = std::sin(angles[i]);

    // The window's first axis in every roll, its second one, and depth.
    const auto ranges  = casters.ranges<2 * kRolls + 1>([&](dvec3 p) {
        std::array<double, 2 * kRolls + 1> values;
        dvec3 v            = frame.light_space(p);
        values[2 * kRolls] = v.z;
        if (frame.perspective) v /= v.z;
        for (int i = 0; i < kRolls; ++i) values[i] = cosines[i] * v.x + sines[i] * v.y;
        for (int i = 0; i < kRolls; ++i) values[kRolls + i] = cosines[i] * v.y - sines[i] * v.x;
        return values;
    });
    const MinMax depth = ranges.back();
    int best           = 0;
    const auto area    = [&](int i) { return ranges[i].half() * ranges[kRolls + i].half(); };
    for (int i = 1; i < kRolls; ++i)
        if (area(i) < area(best)) best = i;
    const MinMax across = ranges[best], down = ranges[kRolls + best];
    if (frame.perspective) {
        if (!(depth.min > 0)) return false;
        for (const MinMax& r : {across, down})
            if (std::max(-r.min, r.max) > widest) return false;
    }

    const dvec3 x = frame.x;
    frame.x       = cosines[best] * x + sines[best] * frame.y;
    frame.y       = cosines[best] * frame.y - sines[best] * x;
    frame.centre  = {across.centre(), down.centre()};
    frame.half    = {across.half(), down.half()};
    frame.near    = depth.min;
    frame.far     = depth.max;
    frame.reach   = kInfinity;
    // Scenes that the light sees edge-on have no area, those that it sees flat no depth, and a point casts nothing.
    if (frame.half == dvec2(0)) frame.half = dvec2(1);
    frame.half = glm::max(frame.half, dvec2(1e-6 * std::max(frame.half.x, frame.half.y)));
    return true;
}

}  // namespace umbra
