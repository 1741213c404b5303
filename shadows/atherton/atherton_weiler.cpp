// Hidden surfaces removed from the light: what the light sees of each triangle is a set of polygons, cut once for all
// cameras; a surface point is lit if it lies in a polygon of its triangle.
//
// Weiler and Atherton clip every polygon against all that are nearer. The polygons that are left are bounded by the
// outlines of what is nearer alone, so only outlines are projected here, and where they divide a receiver, an
// arrangement of them says which parts are covered. All of it is exact: vertices, barycentrics and light are the floats
// of the scene, every sign is proven and every intersection a rational point.
//
// This work is based on:
// Peter Atherton, Kevin Weiler, Donald Greenberg. Polygon Shadow Generation. 1978
// Samuli Laine et al. Soft Shadow Volumes for Ray Tracing. 2005 (triangles counted by outlines)
#include "umbra/shadows/atherton/atherton_weiler.h"

#include <algorithm>
#include <array>
#include <utility>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/facing.h"
#include "umbra/shadows/atherton/lit_part.h"
#include "umbra/shadows/atherton/receiver.h"
#include "umbra/shadows/shared/exact_segment.h"

namespace umbra {

using namespace atherton_detail;
using exact_detail::ExactPoint;
using exact_detail::Segment;

AthertonWeiler::AthertonWeiler()  = default;
AthertonWeiler::~AthertonWeiler() = default;

const std::vector<std::vector<dvec2>>& AthertonWeiler::lit_loops(TriangleId t) const { return parts_[t]->loops(); }
std::vector<std::array<dvec2, 3>> AthertonWeiler::lit_triangles(TriangleId t) const { return parts_[t]->triangles(); }

Service AthertonWeiler::serves(const SceneFacts& facts) const {
    if (!facts.hard_lights_only) return {How::not_at_all, "Lit polygons have no penumbra: no area lights."};
    return {How::exactly, "Lit polygons are cut by exact arithmetic, and points are found in them by exact signs."};
}

void AthertonWeiler::build(const Scene& scene, const SceneFacts&) {
    scene_    = &scene;
    topology_ = find_topology(scene, 0, static_cast<std::uint32_t>(scene.triangles.size()));
    triangles_.emplace(scene);
}

void AthertonWeiler::aim(LightId light) {
    light_ = &scene_->lights[light];
    find_sides();
    outlines_ = find_outlines(*scene_, topology_, covers_);
    std::vector<Box> boxes;
    for (const OutlineEdge& edge : outlines_) boxes.push_back(extend(extend(Box{}, edge.from), edge.to));
    outline_tree_.emplace(std::move(boxes));
    seen_.assign(sides_.size(), Seen::unknown);
    parts_.clear();
    parts_.resize(sides_.size());
    parallel_ranges(sides_.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            if (sides_[t] != 0) cut(static_cast<TriangleId>(t));
    });
}

void AthertonWeiler::visibility(const PointBatch& points, LightId light, Visibility out) const {
    parallel_ranges(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!points.asks(light, i)) continue;
            const TriangleId t = points.triangle[i];
            switch (seen_[t]) {
                case Seen::unknown: out.answer[i] = Answer::undefined; break;
                case Seen::lit: out.s[i] = 1; break;
                case Seen::umbra: out.s[i] = 0; break;
                case Seen::parts: {
                    const LitPart::At at = parts_[t]->at(points.u[i], points.v[i]);
                    out.s[i]             = at == LitPart::At::umbra ? 0.0f : 1.0f;
                    if (at == LitPart::At::boundary) out.answer[i] = Answer::on_boundary;
                    break;
                }
            }
        }
    });
}

/// +1 for triangles that face the light, -1 for those that face away, 0 for those that it sees edge-on.
void AthertonWeiler::find_sides() {
    sides_.resize(scene_->triangles.size());
    covers_.resize(sides_.size());
    parallel_ranges(sides_.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const auto id = static_cast<TriangleId>(t);
            sides_[t]     = static_cast<std::int8_t>(
                side_of_light(*light_, scene_->vertex(id, 0), scene_->vertex(id, 1), scene_->vertex(id, 2)));
            covers_[t] = scene_->blocks(id) ? sides_[t] : std::int8_t{0};
        }
    });
}

namespace {

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

/// Every triangle that the segment from a point of triangle `own` to the light crosses or touches, until visit
/// returns false.
template <class Visit>
void AthertonWeiler::visit_met(TriangleId own, float u, float v, const Visit& visit) const {
    const ExactPoint point(*scene_, own, u, v);
    const Segment segment(point, *light_);
    triangles_->visit(segment.piece(), [&](TriangleId t) {
        if (t == own || topology_.degenerate[t] || !scene_->blocks(t)) return true;
        const auto met = segment.meeting(scene_->vertex(t, 0), scene_->vertex(t, 1), scene_->vertex(t, 2));
        return met == Segment::Meeting::none || visit(t, met);
    });
}

void AthertonWeiler::cut(TriangleId t) {
    const std::optional<Probe> probe = find_probe(t);
    if (!probe) return;
    const Receiver receiver(*scene_, t, *light_);
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
std::optional<AthertonWeiler::Probe> AthertonWeiler::find_probe(TriangleId t) const {
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
        visit_met(t, u, v, [&](TriangleId, Segment::Meeting met) {
            clear = met != Segment::Meeting::touches;
            covers += met == Segment::Meeting::crosses;
            return clear;
        });
        if (clear) return Probe{u, v, covers};
    }
    return std::nullopt;
}

/// The outlines of what is over the receiver.
void AthertonWeiler::add_outlines(const Receiver& receiver, Pieces& pieces) const {
    outline_tree_->visit(
        receiver.towards_light(), [](std::uint32_t, const Box&) { return true; },
        [&](BoxTree::Item item) {
            const OutlineEdge& edge = outlines_[item];
            if (receiver.may_cover(edge.from, edge.to))
                add(receiver, receiver.project(edge.from), receiver.project(edge.to), edge.change, false, pieces);
            return true;
        });
}

/// The lines in which triangles meet the receiver's plane: what is below does not cover it.
void AthertonWeiler::add_cuts(TriangleId own, const Receiver& receiver, Pieces& pieces) const {
    triangles_->visit(
        receiver.itself(), [](std::uint32_t, const Box&) { return true; },
        [&](TriangleId t) {
            if (t != own && covers_[t] != 0) add_cut(own, t, receiver, pieces);
            return true;
        });
}

void AthertonWeiler::add_cut(TriangleId own, TriangleId t, const Receiver& receiver, Pieces& pieces) const {
    std::array<int, 3> side{}, corner{-1, -1, -1};
    std::array<vec3, 3> position{};
    const uvec3 mine = topology_.triangles[own], its = topology_.triangles[t];
    int shared = 0;
    for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        position[at]  = scene_->vertex(t, k);
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

void AthertonWeiler::blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const {
    parallel_ranges(points.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            blockers[i] = kNoTriangle;
            if (!points.asks(light, i)) continue;
            visit_met(points.triangle[i], points.u[i], points.v[i], [&](TriangleId t, Segment::Meeting met) {
                if (met == Segment::Meeting::crosses) blockers[i] = t;
                return met != Segment::Meeting::crosses;
            });
        }
    });
}

std::size_t AthertonWeiler::memory_bytes() const {
    std::size_t bytes = (triangles_ ? triangles_->memory_bytes() : 0) +
                        (outline_tree_ ? outline_tree_->memory_bytes() : 0) +
                        topology_.triangles.size() * sizeof(uvec3) + topology_.edges.size() * sizeof(Edge) +
                        topology_.uses.size() * sizeof(EdgeUse) + topology_.position.size() * sizeof(std::uint32_t) +
                        topology_.degenerate.size() + outlines_.size() * sizeof(OutlineEdge) + 2 * sides_.size() +
                        seen_.size() + parts_.size() * sizeof(parts_[0]);
    for (const auto& part : parts_) bytes += part ? part->memory_bytes() : 0;
    return bytes;
}

extern const MethodInfo atherton_weiler;
const MethodInfo atherton_weiler{
    .name  = "atherton_weiler",
    .title = "Lit polygons",
    .paper = "Peter Atherton, Kevin Weiler, Donald Greenberg, Polygon Shadow Generation, 1978",
    .summary =
        "Removes hidden surfaces as the light sees them, in object space and exactly: each triangle is cut into lit "
        "polygons, once for all cameras, and a point is looked up in the polygons of its triangle. Limit: no area "
        "lights; the time to cut grows with the outlines that cross one another on a receiver.",
    .by_default = false,
    .shown_on   = {"sun_on_plane", "stairs", "interpenetrating"},
    .create     = create<AthertonWeiler>};

}  // namespace umbra
