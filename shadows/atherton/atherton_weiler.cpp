// Hidden surfaces removed from the light: the part of each triangle that the light sees is a set of polygons, cut once
// for all cameras; a surface point is lit if it lies in a polygon of its triangle.
//
// Weiler and Atherton clip every polygon against all that are nearer. Outlines of nearer triangles alone bound the
// polygons that are left, so only outlines are projected here, and where they divide a receiver, an arrangement of them
// has the covered parts. All of it is exact: vertices, barycentrics and light are the floats of the scene, every sign
// is proven and every intersection a rational point.
//
//     build       welds the triangles, and makes a tree of their boxes
//     aim         finds the outlines as the light sees them, and cuts each triangle: counts the triangles over one of
//                 its points, and projects onto it the outlines above and the lines in which it is passed through
//     visibility  looks each point up in the polygons of its triangle
//
// This work is based on:
// Peter Atherton, Kevin Weiler, Donald Greenberg. Polygon Shadow Generation. 1978
// Samuli Laine et al. Soft Shadow Volumes for Ray Tracing. 2005 (triangles counted by outlines)
#include "umbra/shadows/atherton/atherton_weiler.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "umbra/core/base/geometry.h"
#include "umbra/core/base/parallel.h"
#include "umbra/shadows/atherton/lit_part.h"
#include "umbra/shadows/atherton/receiver.h"
#include "umbra/shadows/geometry/exact_segment.h"
#include "umbra/shadows/geometry/triangle_tree.h"

namespace umbra {

using namespace atherton;
using exact_visibility::ExactPoint;
using exact_visibility::Segment;

struct atherton::WeldedTriangles final : Built {
    WeldedTriangles(const Scene& of, const SceneFacts& its_facts) : Built(of, its_facts), mesh(of), tree(of) {}

    [[nodiscard]] std::size_t memory_bytes() const override { return tree.memory_bytes() + mesh.memory_bytes(); }

    const OccluderMesh mesh;
    const TriangleTree tree;
};

namespace {

std::vector<Box> boxes_of(const std::vector<ChangeEdge>& outlines, const OccluderMesh& mesh) {
    std::vector<Box> boxes;
    for (const ChangeEdge& edge : outlines)
        boxes.push_back(extend(extend(Box{}, mesh.position(edge.a)), mesh.position(edge.b)));
    return boxes;
}

/// Every triangle that the segment from a point of triangle `own` to the light crosses or touches, until visit
/// returns false.
template <class Visit>
void visit_between(const WeldedTriangles& triangles, const Light& light, TriangleId own, float u, float v,
                   const Visit& visit) {
    const ExactPoint point(triangles.scene, own, u, v);
    visit_met(
        triangles.tree, triangles.scene, Segment(point, light),
        [&](TriangleId t) { return t != own && triangles.mesh.blocks(t); }, visit);
}

/// Where the segment meets the receiver's plane.
Projected in_plane(const Projected& a, const Projected& b) { return between(a, b, a.height / (a.height - b.height)); }

void add(const Receiver& receiver, const Projected& from, const Projected& to, int change, bool in_plane,
         std::vector<OutlinePiece>& pieces) {
    const auto piece = clip(from, to, in_plane);
    if (!piece) return;
    const auto& [a, b] = *piece;
    pieces.push_back({{a.u / a.w, a.v / a.w}, {b.u / b.w, b.v / b.w}, receiver.mirrored() ? -change : change});
}

}  // namespace

LitPolygons::LitPolygons(const WeldedTriangles& among, LightId at)
    : Aimed(among, at),
      triangles_(among),
      sides_(sides_of_light(scene(), source())),
      outlines_(among.mesh.edges.changes(sides_)),
      outline_tree_(boxes_of(outlines_, among.mesh)),
      seen_(sides_.size(), Seen::unknown),
      parts_(sides_.size()) {
    parallel_ranges(sides_.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            if (sides_[t] != 0) cut(static_cast<TriangleId>(t));
    });
}

LitPolygons::~LitPolygons() = default;

const std::vector<std::vector<dvec2>>& LitPolygons::lit_loops(TriangleId t) const { return part(t).loops(); }
std::vector<std::array<dvec2, 3>> LitPolygons::lit_triangles(TriangleId t) const { return part(t).triangles(); }

std::size_t LitPolygons::memory_bytes() const {
    std::size_t bytes = outline_tree_.memory_bytes() + outlines_.size() * sizeof(ChangeEdge) + sides_.size() +
                        seen_.size() + parts_.size() * sizeof(parts_[0]);
    for (const auto& part : parts_) bytes += part ? part->memory_bytes() : 0;
    return bytes;
}

void LitPolygons::cut(TriangleId t) {
    const std::optional<Probe> probe = find_probe(t);
    if (!probe) return;
    const Receiver receiver(scene(), t, source());
    std::vector<OutlinePiece> pieces;
    add_outlines(receiver, pieces);
    add_cuts(t, receiver, pieces);
    seen_[t] = probe->covers > 0 ? Seen::umbra : Seen::lit;
    if (pieces.empty()) return;
    auto part = std::make_unique<LitPart>(pieces, probe->u, probe->v, probe->covers);
    if (!part->divides()) return;
    seen_[t]  = Seen::parts;
    parts_[t] = std::move(part);
}

/// The first of some points that lies on no outline; none where all do.
std::optional<LitPolygons::Probe> LitPolygons::find_probe(TriangleId t) const {
    constexpr std::array<std::pair<float, float>, 8> kPoints{{{0.34375f, 0.3125f},
                                                              {0.21f, 0.27f},
                                                              {0.51f, 0.13f},
                                                              {0.17f, 0.61f},
                                                              {0.0731f, 0.0917f},
                                                              {0.8713f, 0.0471f},
                                                              {0.0391f, 0.9013f},
                                                              {0.4337f, 0.4871f}}};
    for (const auto& [u, v] : kPoints) {
        bool clear = true;
        int covers = 0;
        visit_between(triangles_, source(), t, u, v, [&](TriangleId, Segment::Meeting met) {
            clear = met != Segment::Meeting::touches;
            covers += met == Segment::Meeting::crosses;
            return clear;
        });
        if (clear) return Probe{u, v, covers};
    }
    return std::nullopt;
}

void LitPolygons::add_outlines(const Receiver& receiver, Pieces& pieces) const {
    outline_tree_.visit(
        receiver.towards_light(), [](std::uint32_t, const Box&) { return true; },
        [&](BoxTree::Item item) {
            const ChangeEdge& edge = outlines_[item];
            const vec3 from = triangles_.mesh.position(edge.a), to = triangles_.mesh.position(edge.b);
            if (receiver.may_cover(from, to))
                add(receiver, receiver.project(from), receiver.project(to), edge.change, false, pieces);
            return true;
        });
}

/// The lines in which triangles meet the receiver's plane: their parts below it cover nothing.
void LitPolygons::add_cuts(TriangleId own, const Receiver& receiver, Pieces& pieces) const {
    triangles_.tree.visit(
        receiver.itself(), [](std::uint32_t, const Box&) { return true; },
        [&](TriangleId t) {
            if (t != own && sides_[t] != 0 && triangles_.mesh.blocks(t)) add_cut(own, t, receiver, pieces);
            return true;
        });
}

void LitPolygons::add_cut(TriangleId own, TriangleId t, const Receiver& receiver, Pieces& pieces) const {
    std::array<int, 3> side{}, corner{-1, -1, -1};
    std::array<vec3, 3> position{};
    const uvec3 mine = triangles_.mesh.corners[own], its = triangles_.mesh.corners[t];
    int shared = 0;
    for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        position[at]  = scene().vertex(t, k);
        for (int m = 0; m < 3; ++m)
            if (its[k] == mine[m]) corner[at] = m;
        shared += corner[at] >= 0;
    }
    if (shared > 1 || !receiver.may_meet(position, corner)) return;  // neighbours meet in the border
    for (std::size_t k = 0; k < 3; ++k) side[k] = corner[k] >= 0 ? 0 : receiver.side(position[k]);
    if (std::ranges::max(side) <= 0 || std::ranges::min(side) > 0) return;
    if (std::ranges::count_if(side, [](int s) { return s <= 0; }) == 1 && std::ranges::min(side) == 0) return;
    // Around the triangle: its part above the plane ends where a corner above is followed by one that is not.
    std::size_t end = 0;
    while (!(side[end] > 0 && side[(end + 1) % 3] <= 0)) ++end;
    std::size_t begin = end;
    while (!(side[begin] <= 0 && side[(begin + 1) % 3] > 0)) begin = (begin + 1) % 3;
    const auto passage = [&](std::size_t above, std::size_t below) {
        return Receiver::Passage{position[above], position[below], side[below] == 0, corner[below]};
    };
    if (!receiver.may_cut(passage(end, (end + 1) % 3), passage((begin + 1) % 3, begin))) return;
    const auto at = [&](std::size_t k) { return receiver.project(position[k % 3]); };
    add(receiver, in_plane(at(end), at(end + 1)), in_plane(at(begin), at(begin + 1)), sides_[t], true, pieces);
}

namespace {

class AthertonWeiler final : public MethodWith<NoOptions, WeldedTriangles, LitPolygons> {
public:
    explicit AthertonWeiler(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Service serves(const SceneFacts& facts) const override {
        if (!facts.hard_lights_only) return {How::not_at_all, "Lit polygons have no penumbra: no area lights."};
        return {How::exactly, "Lit polygons are cut by exact arithmetic, and points are found in them by exact signs."};
    }

    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        using Seen               = LitPolygons::Seen;
        const auto& polygons     = as<LitPolygons>(aimed);
        const PointBatch& points = looked.points;
        for_each_asked(aimed, looked, 1024, [&](std::size_t i) {
            const TriangleId t = points.triangle[i];
            switch (polygons.seen(t)) {
                case Seen::unknown: out.answer[i] = Answer::undefined; break;
                case Seen::lit: out.s[i] = 1; break;
                case Seen::umbra: out.s[i] = 0; break;
                case Seen::parts: {
                    const LitPart::At at = polygons.part(t).at(points.u[i], points.v[i]);
                    out.s[i]             = at == LitPart::At::umbra ? 0.0f : 1.0f;
                    if (at == LitPart::At::boundary) out.answer[i] = Answer::on_boundary;
                    break;
                }
            }
        });
    }

    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override {
        const PointBatch& points = looked.points;
        blame_each(aimed, looked, blockers, [&](std::size_t i) {
            TriangleId blocker = kNoTriangle;
            visit_between(as<WeldedTriangles>(aimed.built), aimed.source(), points.triangle[i], points.u[i],
                          points.v[i], [&](TriangleId t, Segment::Meeting met) {
                              if (met == Segment::Meeting::crosses) blocker = t;
                              return met != Segment::Meeting::crosses;
                          });
            return blocker;
        });
    }

    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override {
        Reason reason      = Method::explain(aimed, looked, i, given);
        const auto& light  = as<LitPolygons>(aimed);
        const TriangleId t = looked.points.triangle[i];
        constexpr std::array kSeen{"unknown", "lit", "umbra", "lit and umbra"};
        reason.evidence.push_back({"the light sees of the triangle", kSeen[static_cast<std::size_t>(light.seen(t))]});
        if (light.seen(t) != LitPolygons::Seen::parts) return reason;
        // In barycentric coordinates the nearest border of a lit polygon; in the world, by the triangle's own edges.
        const Scene& scene = aimed.scene();
        const dvec3 a(scene.vertex(t, 0)), ab = dvec3(scene.vertex(t, 1)) - a, ac = dvec3(scene.vertex(t, 2)) - a;
        const auto in_world = [&](dvec2 uv) { return a + uv.x * ab + uv.y * ac; };
        const dvec3 p       = in_world(dvec2(looked.points.u[i], looked.points.v[i]));
        double nearest      = std::numeric_limits<double>::infinity();
        for (const std::vector<dvec2>& loop : light.lit_loops(t))
            for (std::size_t k = 0; k < loop.size(); ++k)
                nearest =
                    std::min(nearest, distance_to_segment(p, in_world(loop[k]), in_world(loop[(k + 1) % loop.size()])));
        reason.evidence.push_back({"outlines of lit polygons", static_cast<double>(light.lit_loops(t).size())});
        if (nearest > 0 && nearest < std::numeric_limits<double>::infinity() && given.answer == Answer::given)
            reason.margin = given.s > 0 ? nearest : -nearest, reason.unit = "world";
        return reason;
    }
};

}  // namespace

const MethodInfo atherton_weiler{
    .name  = "atherton_weiler",
    .title = "Lit polygons",
    .paper = "Peter Atherton, Kevin Weiler, Donald Greenberg, Polygon Shadow Generation, 1978",
    .summary =
        "Removes hidden surfaces as the light sees them, in object space and exactly: each triangle is cut into lit "
        "polygons, once for all cameras, and a point is looked up in the polygons of its triangle. Limit: no area "
        "lights; the time to cut grows with the outlines that cross one another on a receiver.",
    .by_default = false,
    .shown      = true,
    .create     = create<AthertonWeiler>};

}  // namespace umbra
