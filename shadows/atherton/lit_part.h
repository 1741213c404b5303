// The part of one receiver that one light sees: polygons in the receiver's barycentric coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "umbra/shadows/atherton/receiver.h"

namespace umbra::atherton {

/// A piece of the projected outlines, from one point of the receiver to another in barycentric coordinates. `change`:
/// by how many more triangles lie over the points to its left than over those to its right, in these coordinates.
struct OutlinePiece {
    std::array<Exact, 2> from, to;
    int change = 0;
};

/// Cut once, then asked by any number of threads.
class LitPart {
public:
    /// `covers`: triangles over the receiver's point (u, v), which lies on no piece. Throws std::logic_error where the
    /// changes contradict one another.
    LitPart(const std::vector<OutlinePiece>& pieces, float u, float v, int covers);

    /// `boundary`: on an edge between lit and umbra.
    enum class At : std::uint8_t { lit, umbra, boundary };
    [[nodiscard]] At at(float u, float v) const;

    /// The lit polygons' outlines, rounded: outer ones counterclockwise, holes clockwise.
    [[nodiscard]] const std::vector<std::vector<dvec2>>& loops() const { return loops_; }
    /// The lit polygons cut into triangles, corners rounded, counterclockwise. Made at each call.
    [[nodiscard]] std::vector<std::array<dvec2, 3>> triangles() const;
    /// Whether there is an edge between lit and umbra; otherwise all of the receiver is as any of its points.
    [[nodiscard]] bool divides() const { return divides_; }
    /// About: rationals are counted with the length that they usually have.
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    /// An edge of a lit polygon, with its ends rounded.
    struct LitEdge {
        dvec2 a{0}, b{0};
        bool border = false;  ///< on the receiver's own border
    };
    struct Ends {
        std::array<Exact, 2> a, b;
    };

    void add_edge(const std::array<Exact, 2>& a, const std::array<Exact, 2>& b);
    void sort_into_rows();
    [[nodiscard]] std::size_t row(double v) const;

    std::vector<LitEdge> edges_;
    std::vector<Ends> ends_;  ///< the same, exact
    std::vector<std::uint32_t>
        row_first_;  ///< edges that meet row r of v: row_edges_[row_first_[r] ... row_first_[r+1])
    std::vector<std::uint32_t> row_edges_;
    std::vector<std::vector<dvec2>> loops_;
    bool divides_ = false;
};

}  // namespace umbra::atherton
