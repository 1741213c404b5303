// What a class picture shows: the classes on it, and rings around wrong points that are too few to be seen where it is
// shown small. Points are found by their colours (error_palette.h). Pictures are as written to PNG: R, G, B in [0, 1].
#pragma once

#include <vector>

#include "umbra/bench/pages/error_palette.h"
#include "umbra/core/image/image.h"

namespace umbra {

/// A box around one group of points, in pixels of the picture.
struct Ring {
    double x = 0, y = 0, width = 0, height = 0;
};

struct ErrorRings {
    std::size_t points = 0;   ///< wrong interior points of the picture
    std::vector<Ring> rings;  ///< around the groups of them that are hard to see; empty where most are easy to see
};

/// Finds wrong interior points. Points nearer to one another than a 40th of the picture's width form a group. A group
/// is easy to see from 1/2000 of the picture's pixels on; of the others at most 24 get a ring, the largest first.
[[nodiscard]] ErrorRings error_rings(const Image& class_picture);

/// The classes that at least one point of the picture has, in the order of the table; they live as long as the program.
[[nodiscard]] std::vector<const ErrorColour*> classes_on(const Image& class_picture);

}  // namespace umbra
