// The shafts from eight neighbouring points to a light, asked side by side whether they meet a box or an edge.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "umbra/core/base/lanes.h"
#include "umbra/core/base/math.h"

namespace umbra::soft {

/// Which of eight points see a plane from which side, as far as floats can tell: bit k is for lane k.
struct Sides {
    std::uint32_t front = 0, back = 0;  ///< where neither is set floats cannot tell
};

/// Convex regions in ray space, one a lane: where all planes are positive. Lanes that were not set are empty.
class Shafts {
public:
    static constexpr std::size_t kPlanes = 5;

    Shafts() {
        for (float& x : offset_[0]) x = -kInfinity;
    }

    /// The point that a lane's shaft comes from.
    void set_point(std::size_t lane, vec3 o) { o_x_[lane] = o.x, o_y_[lane] = o.y, o_z_[lane] = o.z; }

    /// On which side of the plane through `on` each point is. `normal`: rounded from a unit vector, or zero, on neither
    /// side of which any point is.
    [[nodiscard]] Sides sides_of(vec3 normal, vec3 on) const {
        // Coordinates differ by 4 at most: of the normal each is off by 2^-22, and products and sums by as much.
        constexpr float sure = 0x1p-17f;
        std::int32_t front[kLanes], back[kLanes];
        for (std::size_t k = 0; k < kLanes; ++k) {
            const float above = normal.x * (o_x_[k] - on.x) + normal.y * (o_y_[k] - on.y) + normal.z * (o_z_[k] - on.z);
            front[k] = above > sure ? 1 : 0, back[k] = above < -sure ? 1 : 0;
        }
        return {bits(front), bits(back)};
    }

    /// Plane `plane` of a lane: dot(normal, q - from) + offset >= 0.
    void set(std::size_t lane, std::size_t plane, dvec3 normal, dvec3 from, double offset) {
        // Coordinates are within 2 each way. A normal's component is rounded, and so are its product, and three sums.
        const double size  = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
        const double slack = 0x1p-19 * (4 * size + std::abs(offset));
        x_[plane][lane] = static_cast<float>(normal.x), y_[plane][lane] = static_cast<float>(normal.y),
        z_[plane][lane]      = static_cast<float>(normal.z);
        offset_[plane][lane] = static_cast<float>(offset - glm::dot(normal, from) + slack);
    }

    /// The lanes whose region may meet it.
    [[nodiscard]] std::uint32_t meeting(const Box& box) const {
        const vec3 c = 0.5f * (box.min + box.max), h = box.max - c;
        std::int32_t inside[kLanes];
        for (std::size_t k = 0; k < kLanes; ++k) inside[k] = 1;
        for (std::size_t p = 0; p < kPlanes; ++p)
            for (std::size_t k = 0; k < kLanes; ++k) {
                const float middle = x_[p][k] * c.x + y_[p][k] * c.y + z_[p][k] * c.z + offset_[p][k];
                const float reach  = std::abs(x_[p][k]) * h.x + std::abs(y_[p][k]) * h.y + std::abs(z_[p][k]) * h.z;
                inside[k] &= middle + reach >= 0 ? 1 : 0;
            }
        return bits(inside);
    }
    [[nodiscard]] std::uint32_t meeting(vec3 a, vec3 b) const {
        std::int32_t inside[kLanes];
        for (std::size_t k = 0; k < kLanes; ++k) inside[k] = 1;
        for (std::size_t p = 0; p < kPlanes; ++p)
            for (std::size_t k = 0; k < kLanes; ++k) {
                const float at_a = x_[p][k] * a.x + y_[p][k] * a.y + z_[p][k] * a.z + offset_[p][k];
                const float at_b = x_[p][k] * b.x + y_[p][k] * b.y + z_[p][k] * b.z + offset_[p][k];
                inside[k] &= ((at_a >= 0) | (at_b >= 0)) ? 1 : 0;
            }
        return bits(inside);
    }

private:
    static std::uint32_t bits(const std::int32_t (&inside)[kLanes]) {
        std::uint32_t found = 0;
        for (std::size_t k = 0; k < kLanes; ++k) found |= static_cast<std::uint32_t>(inside[k]) << k;
        return found;
    }

    float o_x_[kLanes]{}, o_y_[kLanes]{}, o_z_[kLanes]{};
    float x_[kPlanes][kLanes]{}, y_[kPlanes][kLanes]{}, z_[kPlanes][kLanes]{}, offset_[kPlanes][kLanes]{};
};

}  // namespace umbra::soft
