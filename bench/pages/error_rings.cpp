#include "umbra/bench/pages/error_rings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

namespace umbra {
namespace {

constexpr std::size_t kMostRings = 24;

/// 0xrrggbb
unsigned number_of(const ErrorColour& entry) {
    unsigned rgb = 0;
    std::from_chars(entry.srgb.data() + 1, entry.srgb.data() + entry.srgb.size(), rgb, 16);
    return rgb;
}

unsigned colour_at(const Image& image, std::size_t pixel) {
    unsigned rgb = 0;
    for (std::size_t c = 0; c < 3; ++c)
        rgb = rgb << 8 | static_cast<unsigned>(std::floor(double(image.at(pixel, c)) * 255 + 0.5));
    return rgb;
}

/// A group while it grows: the box around its points.
struct Group {
    std::size_t points = 0;
    int x0 = 0, y0 = 0, x1 = -1, y1 = -1;

    void add(int x, int y) {
        if (points++ == 0) x0 = x1 = x, y0 = y1 = y;
        x0 = std::min(x0, x), y0 = std::min(y0, y), x1 = std::max(x1, x), y1 = std::max(y1, y);
    }
    void add(const Group& other) {
        if (other.points == 0) return;
        const std::size_t sum = points + other.points;
        add(other.x0, other.y0);
        add(other.x1, other.y1);
        points = sum;
    }
};

}  // namespace

ErrorRings error_rings(const Image& image) {
    ErrorRings found;
    if (image.pixels() == 0 || image.channels.size() < 3) return found;
    std::set<unsigned> colours;
    for (const ErrorColour& entry : kErrorPalette)
        if (entry.interior) colours.insert(number_of(entry));

    // Points by the cells of a grid; cells that touch, at a corner too, belong to one group.
    const int cell    = std::max(4, image.width / 40);
    const int columns = (image.width + cell - 1) / cell, rows = (image.height + cell - 1) / cell;
    std::vector<Group> cells(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    const auto cell_at = [&](int column, int row) -> Group& {
        return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(column)];
    };
    unsigned last    = 0;  // neighbours are mostly alike
    bool is_interior = colours.contains(last);
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        if (const unsigned colour = colour_at(image, i); colour != last)
            last = colour, is_interior = colours.contains(colour);
        if (!is_interior) continue;
        const auto width = static_cast<std::size_t>(image.width);
        const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
        cell_at(x / cell, y / cell).add(x, y);
        ++found.points;
    }
    std::vector<Group> groups;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            if (cell_at(column, row).points == 0) continue;
            Group group;
            std::vector<std::pair<int, int>> open = {{column, row}};
            while (!open.empty()) {
                const auto [c, r] = open.back();
                open.pop_back();
                if (c < 0 || r < 0 || c >= columns || r >= rows || cell_at(c, r).points == 0) continue;
                group.add(cell_at(c, r));
                cell_at(c, r) = {};
                for (int dr = -1; dr <= 1; ++dr)
                    for (int dc = -1; dc <= 1; ++dc) open.emplace_back(c + dc, r + dr);
            }
            groups.push_back(group);
        }

    std::size_t easy = 0;  // points
    std::erase_if(groups, [&](const Group& g) {
        const bool large = g.points * 2000 >= image.pixels();
        if (large) easy += g.points;
        return large;
    });
    if (2 * easy > found.points) return found;
    std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) { return a.points > b.points; });
    if (groups.size() > kMostRings) groups.resize(kMostRings);
    const double margin = image.width / 64.0;
    for (const Group& g : groups)
        found.rings.push_back(
            {g.x0 - margin, g.y0 - margin, g.x1 + 1 - g.x0 + 2 * margin, g.y1 + 1 - g.y0 + 2 * margin});
    return found;
}

std::vector<const ErrorColour*> classes_on(const Image& image) {
    std::set<unsigned> colours;
    if (image.channels.size() >= 3)
        for (std::size_t i = 0; i < image.pixels(); ++i)
            if (i == 0 || colour_at(image, i) != colour_at(image, i - 1)) colours.insert(colour_at(image, i));
    std::vector<const ErrorColour*> found;
    for (const ErrorColour& entry : kErrorPalette)
        if (colours.contains(number_of(entry))) found.push_back(&entry);
    return found;
}

}  // namespace umbra
