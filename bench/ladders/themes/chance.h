// Numbers that look random and are the same on every machine: the standard fixes mt19937, but no distribution.
#pragma once

#include <random>

#include "umbra/core/base/math.h"

namespace umbra {

class Chance {
public:
    /// In [low, high).
    double between(double low, double high) { return low + (high - low) * (static_cast<double>(random_()) * 0x1p-32); }
    dvec3 in_box(dvec3 half) {  // drawn in order: arguments of a call are not
        const double x = between(-half.x, half.x), y = between(-half.y, half.y), z = between(-half.z, half.z);
        return {x, y, z};
    }
    unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }

private:
    std::mt19937 random_{1};
};

}  // namespace umbra
