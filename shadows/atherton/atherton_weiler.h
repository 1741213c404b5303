// The class of atherton_weiler; atherton_weiler.cpp has the recipe.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "umbra/core/scene/topology.h"
#include "umbra/shadows/atherton/outlines.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/shared/triangle_tree.h"

namespace umbra {

namespace atherton_detail {  // complete in atherton_weiler.cpp alone, which has CGAL
class LitPart;
class Receiver;
struct OutlinePiece;
}  // namespace atherton_detail

class AthertonWeiler final : public Method {
public:
    /// What the light sees of a triangle.
    enum class Seen : std::uint8_t {
        unknown,  ///< it is edge-on, has no area, or every point tried in it lies on an outline
        lit,
        umbra,
        parts  ///< both
    };

    AthertonWeiler();
    ~AthertonWeiler() override;

    void configure(const Settings&) override {}  // it has no parameters
    [[nodiscard]] Service serves(const SceneFacts& facts) const override;
    void build(const Scene& scene, const SceneFacts& facts) override;
    void aim(LightId light) override;
    void visibility(const PointBatch& points, LightId light, Visibility out) const override;
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override;
    [[nodiscard]] std::size_t memory_bytes() const override;

    /// After aim, of a triangle of the scene.
    [[nodiscard]] Seen seen(TriangleId t) const { return seen_[t]; }
    /// The outlines of its lit polygons in its barycentric coordinates, rounded: outer ones counterclockwise, holes
    /// clockwise; of a triangle that is Seen::parts.
    [[nodiscard]] const std::vector<std::vector<dvec2>>& lit_loops(TriangleId t) const;
    /// The same polygons cut into triangles, counterclockwise. Made at each call.
    [[nodiscard]] std::vector<std::array<dvec2, 3>> lit_triangles(TriangleId t) const;

private:
    using Pieces = std::vector<atherton_detail::OutlinePiece>;
    /// A point of a receiver, and how many triangles are over it.
    struct Probe {
        float u, v;
        int covers;
    };

    void find_sides();
    void cut(TriangleId t);
    [[nodiscard]] std::optional<Probe> find_probe(TriangleId t) const;
    void add_outlines(const atherton_detail::Receiver& receiver, Pieces& pieces) const;
    void add_cuts(TriangleId own, const atherton_detail::Receiver& receiver, Pieces& pieces) const;
    void add_cut(TriangleId own, TriangleId t, const atherton_detail::Receiver& receiver, Pieces& pieces) const;
    template <class Visit>
    void visit_met(TriangleId own, float u, float v, const Visit& visit) const;

    const Scene* scene_ = nullptr;
    const Light* light_ = nullptr;
    Topology topology_;
    std::optional<TriangleTree> triangles_;
    std::vector<std::int8_t> sides_;   ///< one a triangle: +1 if it faces the light, -1 if it faces away, 0 if edge-on
    std::vector<std::int8_t> covers_;  ///< the same, 0 for triangles that do not block
    std::vector<atherton_detail::OutlineEdge> outlines_;
    std::optional<BoxTree> outline_tree_;
    std::vector<Seen> seen_;                                        ///< one a triangle
    std::vector<std::unique_ptr<atherton_detail::LitPart>> parts_;  ///< one a triangle; null where not Seen::parts
};

}  // namespace umbra
