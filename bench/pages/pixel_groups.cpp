#include "umbra/bench/pages/pixel_groups.h"

#include <algorithm>
#include <utility>

namespace umbra {

void PixelGroup::add(int x, int y) {
    if (pixels++ == 0) x0 = x1 = x, y0 = y1 = y;
    x0 = std::min(x0, x), y0 = std::min(y0, y), x1 = std::max(x1, x), y1 = std::max(y1, y);
}

void PixelGroup::add(const PixelGroup& other) {
    if (other.pixels == 0) return;
    const std::size_t sum = pixels + other.pixels;
    add(other.x0, other.y0);
    add(other.x1, other.y1);
    pixels = sum;
}

std::vector<PixelGroup> pixel_groups(int width, int height, int cell, const std::function<bool(std::size_t)>& is_in) {
    const int columns = (width + cell - 1) / cell, rows = (height + cell - 1) / cell;
    std::vector<PixelGroup> cells(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    const auto cell_at = [&](int column, int row) -> PixelGroup& {
        return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(column)];
    };
    std::size_t pixel = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (is_in(pixel++)) cell_at(x / cell, y / cell).add(x, y);
    std::vector<PixelGroup> groups;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            if (cell_at(column, row).pixels == 0) continue;
            PixelGroup group;
            std::vector<std::pair<int, int>> open = {{column, row}};
            while (!open.empty()) {
                const auto [c, r] = open.back();
                open.pop_back();
                if (c < 0 || r < 0 || c >= columns || r >= rows || cell_at(c, r).pixels == 0) continue;
                group.add(std::exchange(cell_at(c, r), {}));
                for (int dr = -1; dr <= 1; ++dr)
                    for (int dc = -1; dc <= 1; ++dc) open.emplace_back(c + dc, r + dr);
            }
            groups.push_back(group);
        }
    return groups;
}

}  // namespace umbra
