// How a file's numbers become a scene's: which axis points up, and the origin of positions. Internal to core.
#pragma once

#include <string>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// The origin that a scene with these bounds wants: 0, but where the middle of the bounds is farther away along an axis
/// than 64 times their diagonal. There it is the middle, rounded to a multiple of the smallest power of ten that is at
/// least the diagonal (below 1, of two): a number with a short name, and a scene around it within a few times its size.
/// The other axes keep their 0.
[[nodiscard]] dvec3 local_origin(dvec3 low, dvec3 high);
[[nodiscard]] dvec3 local_origin(const Box& box);  ///< 0 for an empty one

/// Readers take positions in double and round them once, by position().
struct Reading {
    UpAxis up = UpAxis::y;
    dvec3 origin{0};                    ///< of the scene, in the file's space once it stands upright
    int frame               = 0;        ///< of the file's animation, counted from 0
    const std::string* text = nullptr;  ///< of a native scene, in place of that of its file

    /// Exact: components trade places and signs.
    [[nodiscard]] dvec3 upright(dvec3 v) const {
        switch (up) {
            case UpAxis::y: break;
            case UpAxis::z: return {v.x, v.z, 0.0 - v.y};
            case UpAxis::minus_y: return {v.x, 0.0 - v.y, 0.0 - v.z};
        }
        return v;
    }
    [[nodiscard]] vec3 position(dvec3 p) const { return vec3(upright(p) - origin); }
    [[nodiscard]] vec3 normal(vec3 n) const { return vec3(upright(dvec3(n))); }
};

}  // namespace umbra
