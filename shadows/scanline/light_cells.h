// A subdivision of space as the light sees it: the sphere of directions around a position, in six faces of a cube, or
// the plane across a direction, in square cells. A triangle between a point and the light is in the point's cell.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "umbra/core/base/geometry.h"
#include "umbra/core/scene/scene.h"

namespace umbra::scanline {

class LightCells {
public:
    /// For a hard light. `scene` must outlive this object.
    LightCells(const Scene& scene, const Light& light);

    /// Calls visit(triangles) for every cell that the segment from a to b may pass through, as the light sees it. A
    /// triangle may be in several of them.
    template <class Visit>
    void visit(dvec3 a, dvec3 b, const Visit& visit) const {
        const std::array<dvec3, 2> ends{seen(a), seen(b)};
        for (int face = 0; face < faces_; ++face) {
            const std::optional<Coverage> part = outline(face, ends);
            if (!part) continue;
            const int low = column(part->low.y), high = column(part->high.y);
            for (int row = low; row <= high; ++row) {
                const auto [from, to] = across(*part, row);
                for (int x = column(from); x <= column(to); ++x) {
                    const std::size_t c = cell(face, x, row);
                    if (first_[c] < first_[c + 1])
                        visit(std::span(triangles_).subspan(first_[c], first_[c + 1] - first_[c]));
                }
            }
        }
    }

    [[nodiscard]] std::size_t memory_bytes() const {
        return first_.size() * sizeof(std::uint32_t) + triangles_.size() * sizeof(TriangleId);
    }

private:
    /// The part of a face that a segment or triangle covers, in [-1, 1] x [-1, 1]: extent, first and last corner.
    struct Coverage {
        dvec2 low{1}, high{-1}, from{0}, to{0};
    };

    /// From the light; of a directional light across its direction, in units of the scene.
    [[nodiscard]] dvec3 seen(dvec3 p) const;
    template <std::size_t N>
    [[nodiscard]] std::optional<Coverage> outline(int face, const std::array<dvec3, N>& corners) const;
    [[nodiscard]] int column(double x) const;
    [[nodiscard]] std::pair<double, double> across(const Coverage& segment, int row) const;
    [[nodiscard]] std::size_t cell(int face, int x, int y) const {
        return (static_cast<std::size_t>(face) * side_ + static_cast<std::size_t>(y)) * side_ +
               static_cast<std::size_t>(x);
    }

    bool infinite_ = false;
    int faces_     = 6;
    std::size_t side_;                  ///< cells along a face
    dvec3 from_{0}, across_[3]{};       ///< of a directional light: the scene's centre and axes over its size
    std::vector<std::uint32_t> first_;  ///< of each cell, into triangles_; one more at the end
    std::vector<TriangleId> triangles_;
};

}  // namespace umbra::scanline
