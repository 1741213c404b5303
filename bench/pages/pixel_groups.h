// Where in a picture pixels of one kind lie together.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace umbra {

/// Pixels that lie together, and the box around them, whose ends belong to it.
struct PixelGroup {
    std::size_t pixels = 0;
    int x0 = 0, y0 = 0, x1 = -1, y1 = -1;

    void add(int x, int y);
    void add(const PixelGroup& other);
};

/// Pixels of which `is_in` says that they count, by the cells of a grid, each `cell` pixels wide and high: those in cells
/// that touch, at a corner too, are one group. Asks for each pixel once, row by row; groups come in the order of their
/// first cells.
[[nodiscard]] std::vector<PixelGroup> pixel_groups(int width, int height, int cell,
                                                   const std::function<bool(std::size_t)>& is_in);

}  // namespace umbra
