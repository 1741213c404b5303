#include "umbra/shadows/maps/light_frame.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace umbra {

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

Rolls rolls_of(const LightFrame& frame) {
    // The scene's own axes make good edges of the window (floors, walls); the other rolls are spread evenly.
    std::array<double, kRolls> angles;
    for (int i = 0; i < 3; ++i) angles[i] = std::atan2(frame.y[i], frame.x[i]);
    for (int i = 3; i < kRolls; ++i) angles[i] = (i - 3) * (kPi / 2) / (kRolls - 3);
    Rolls rolls;
    for (int i = 0; i < kRolls; ++i) rolls[i] = {std::cos(angles[i]), std::sin(angles[i])};
    return rolls;
}

LightFrame rolled(LightFrame frame, dvec2 roll) {
    const dvec3 x = frame.x;
    frame.x       = roll.x * x + roll.y * frame.y;
    frame.y       = roll.x * frame.y - roll.y * x;
    return frame;
}

dvec2 with_area(dvec2 half) {
    if (half == dvec2(0)) half = dvec2(1);
    return glm::max(half, dvec2(1e-6 * std::max(half.x, half.y)));
}

bool fit_to_scene(LightFrame& frame, const Casters& casters, double widest) {
    const Rolls rolls  = rolls_of(frame);
    const auto ranges  = casters.ranges<2 * kRolls + 1>([&](dvec3 p) {
        std::array<double, 2 * kRolls + 1> values;
        dvec3 v            = frame.light_space(p);
        values[2 * kRolls] = v.z;
        if (frame.perspective) v /= v.z;
        for (int i = 0; i < kRolls; ++i) {
            values[2 * i]     = rolls[i].x * v.x + rolls[i].y * v.y;
            values[2 * i + 1] = rolls[i].x * v.y - rolls[i].y * v.x;
        }
        return values;
    });
    const Extent depth = ranges.back();
    int best           = 0;
    const auto area    = [&](int i) { return ranges[2 * i].half() * ranges[2 * i + 1].half(); };
    for (int i = 1; i < kRolls; ++i)
        if (area(i) < area(best)) best = i;
    if (frame.perspective) {
        if (!(depth.min > 0)) return false;
        for (const Extent& r : {ranges[2 * best], ranges[2 * best + 1]})
            if (std::max(-r.min, r.max) > widest) return false;
    }

    frame        = rolled(frame, rolls[best]);
    frame.centre = {ranges[2 * best].centre(), ranges[2 * best + 1].centre()};
    frame.half   = with_area({ranges[2 * best].half(), ranges[2 * best + 1].half()});
    frame.near   = depth.min;
    frame.far    = depth.max;
    frame.reach  = kInfinity;
    return true;
}

}  // namespace umbra
