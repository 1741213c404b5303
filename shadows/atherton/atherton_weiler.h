// The lit polygons of one light, which atherton_weiler makes; atherton_weiler.cpp has the recipe.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "umbra/shadows/geometry/box_tree.h"
#include "umbra/shadows/geometry/edges.h"
#include "umbra/shadows/method.h"

namespace umbra {

namespace atherton {  // complete in atherton_weiler.cpp alone, which has CGAL
class LitPart;
class Receiver;
struct OutlinePiece;
struct WeldedTriangles;
}  // namespace atherton

/// The result of atherton_weiler's `aim`.
class LitPolygons final : public Aimed {
public:
    /// The part of a triangle that the light sees.
    enum class Seen : std::uint8_t {
        unknown,  ///< it is edge-on, has no area, or every point tried in it lies on an outline
        lit,
        umbra,
        parts  ///< both
    };

    LitPolygons(const atherton::WeldedTriangles& among, LightId at);
    ~LitPolygons() override;
    [[nodiscard]] std::size_t memory_bytes() const override;

    [[nodiscard]] Seen seen(TriangleId t) const { return seen_[t]; }
    /// The lit polygons of a triangle that is Seen::parts; the next two are of such a triangle, too.
    [[nodiscard]] const atherton::LitPart& part(TriangleId t) const { return *parts_[t]; }
    /// Their outlines in the triangle's barycentric coordinates, rounded: outer ones counterclockwise, holes clockwise.
    [[nodiscard]] const std::vector<std::vector<dvec2>>& lit_loops(TriangleId t) const;
    /// The same polygons cut into triangles, counterclockwise. Made at each call.
    [[nodiscard]] std::vector<std::array<dvec2, 3>> lit_triangles(TriangleId t) const;

private:
    using Pieces = std::vector<atherton::OutlinePiece>;
    /// A point of a receiver, and how many triangles are over it.
    struct Probe {
        float u, v;
        int covers;
    };

    void cut(TriangleId t);
    [[nodiscard]] std::optional<Probe> find_probe(TriangleId t) const;
    void add_outlines(const atherton::Receiver& receiver, Pieces& pieces) const;
    void add_cuts(TriangleId own, const atherton::Receiver& receiver, Pieces& pieces) const;
    void add_cut(TriangleId own, TriangleId t, const atherton::Receiver& receiver, Pieces& pieces) const;

    const atherton::WeldedTriangles& triangles_;
    /// One a triangle: +1 if it faces the light, -1 if it faces away, 0 if edge-on.
    const std::vector<std::int8_t> sides_;
    const std::vector<ChangeEdge> outlines_;  ///< of those that block
    const BoxTree outline_tree_;
    std::vector<Seen> seen_;                                 ///< one a triangle
    std::vector<std::unique_ptr<atherton::LitPart>> parts_;  ///< one a triangle; null where not Seen::parts
};

extern const MethodInfo atherton_weiler;

}  // namespace umbra
