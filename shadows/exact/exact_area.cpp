#include "umbra/shadows/exact/exact_area.h"

#include <fmt/format.h>

#include "umbra/shadows/exact/filtered_light.h"

namespace umbra::exact_visibility {
namespace {

using Answer = ExactArea::Answer;

constexpr Answer kNothingKnown{
    .visibility = 0.5f, .half_width = 0.5f, .irradiance = 0.5f, .irradiance_half_width = 0.5f};
constexpr Answer kAllVisible{.visibility = 1, .irradiance = 1};

/// Limit of LightPlane::rounding. Edges move by twice that: half of the distance between the light and the reach within
/// which edges are kept. Where the plane is rougher, an edge that was left out might lie over the light.
constexpr double kRoughest = (kCutReach - 1) / 4;

/// Candidates are few where every point may ask each of them: kFew, or one kPart-th of all edges up to kMostEdges, whose
/// ends and normals fill a cache of a megabyte.
constexpr std::size_t kFew = 64, kPart = 12, kMostEdges = 24576;

/// A value and its half width. Numbers within `unsure`, rounding, of 0 or 1 may be 0 or 1.
std::pair<float, float> value_of(const Bracket& bracket, double unsure) {
    const auto [low, high] = bracket;
    if (high <= unsure) return {0.0f, static_cast<float>(high)};
    if (low >= 1 - unsure) return {1.0f, static_cast<float>(1 - low)};
    // Half an ulp of the answer belongs to its error.
    const auto half = static_cast<float>((high - low) / 2 * (1 + 0x1p-22) + 0x1p-25);
    return {static_cast<float>((low + high) / 2), half};
}

/// Rectangles have the area alone, with an error below kTrusted.
Answer answer(const VisibleArea& area, bool round) {
    const Bracket visible{std::max(0.0, (area.visible - area.error) / area.whole),
                          std::min(1.0, (area.visible + area.open + area.error) / area.whole)};
    const double unsure                 = area.error <= kTrusted ? 2 * area.error / area.whole : 0;
    const auto [visibility, half]       = value_of(visible, unsure);
    const auto [irradiance, light_half] = value_of(area.irradiance, kTrusted / 4);
    return {visibility, round ? half : 0, irradiance, light_half};
}

/// The steps of a point, and how many times as many rationals take.
constexpr std::uint64_t kStepsOfPoint = 20, kRationalSteps = 300;

/// In half axes: narrower gaps join what they part, and corners less far from a line lie on it.
constexpr double kNarrow = 1e-9;

double turn(dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Outlines of the area under trapezoids, which come row by row from bottom to top, each row from left to right.
///
///      .___________.__       A walk goes up the right side of a trapezoid (T). At its top it turns to the last of the
///     /     N     / \  \     trapezoids above that touch T there (N): up the right side of that one or, where it
///    /___.____.__/   \__\    lies over another one of T's row (S), too, down the left side of the first such one.
///     | T|    |S \           Where nothing is above, down T's own left side. Down a left side is up a right one in
///     |__|    |___\          the picture turned by half a turn.
class Outlines {
public:
    explicit Outlines(const std::vector<Trapezoid>& pieces) {
        for (const Trapezoid& p : pieces)
            if (p.low < p.high) in_turn_[0].push_back(p);
        for (const Trapezoid& p : in_turn_[0])
            in_turn_[1].push_back({-p.high, -p.low, -p.high_right, -p.high_left, -p.low_right, -p.low_left});
        std::ranges::reverse(in_turn_[1]);
    }

    /// One after the other; each goes on from its last point to its first.
    [[nodiscard]] std::vector<std::vector<dvec2>> walk() const {
        const std::size_t n = in_turn_[0].size();
        std::vector<bool> done[2]{std::vector<bool>(n), std::vector<bool>(n)};
        std::vector<std::vector<dvec2>> all;
        for (std::size_t begin = 0; begin < n; ++begin) {
            if (done[0][begin]) continue;
            all.emplace_back();
            for (TrapezoidSide at{0, begin}; !done[at.turn][at.piece]; at = next(at)) {
                done[at.turn][at.piece] = true;
                const Trapezoid& p      = in_turn_[at.turn][at.piece];
                const double sign       = at.turn == 0 ? 1 : -1;
                all.back().push_back(sign * dvec2(p.low_right, p.low));
                all.back().push_back(sign * dvec2(p.high_right, p.high));
            }
        }
        return all;
    }

private:
    /// The right side of a trapezoid in one of the two pictures.
    struct TrapezoidSide {
        int turn;
        std::size_t piece;
    };

    [[nodiscard]] TrapezoidSide next(const TrapezoidSide& at) const {
        const std::vector<Trapezoid>& all = in_turn_[at.turn];
        const Trapezoid& p                = all[at.piece];
        const auto touch                  = [](const Trapezoid& below, const Trapezoid& above) {
            return std::min(below.high_right, above.low_right) - std::max(below.high_left, above.low_left) > kNarrow;
        };
        const auto other_side = [&](std::size_t piece) { return TrapezoidSide{1 - at.turn, all.size() - 1 - piece}; };
        const auto row_begin  = std::ranges::lower_bound(all, p.high, {}, &Trapezoid::low);
        for (auto above = std::ranges::upper_bound(all, p.high, {}, &Trapezoid::low); above != row_begin;) {
            if (!touch(p, *--above)) continue;
            for (std::size_t k = at.piece + 1; k < all.size() && all[k].low == p.low; ++k)
                if (touch(all[k], *above)) return other_side(k);
            return {at.turn, static_cast<std::size_t>(above - all.begin())};
        }
        return other_side(at.piece);
    }

    std::vector<Trapezoid> in_turn_[2];
};

/// Twice the area; negative where the outline goes clockwise.
double twice_area(const std::vector<dvec2>& outline) {
    double sum = 0;
    for (std::size_t k = 0; k < outline.size(); ++k) sum += turn(outline[k], outline[(k + 1) % outline.size()]);
    return sum;
}

/// Without points between two others.
std::vector<dvec2> corners_of(std::vector<dvec2> outline) {
    const auto lowest = [](dvec2 a, dvec2 b) { return a.y < b.y || (a.y == b.y && a.x < b.x); };
    std::rotate(outline.begin(), std::ranges::min_element(outline, lowest), outline.end());  // to one that is a corner
    outline.push_back(outline.front());
    std::vector<dvec2> corners;
    for (const dvec2 p : outline) {
        for (; corners.size() >= 2; corners.pop_back()) {
            const dvec2 a = corners[corners.size() - 2];
            if (std::abs(turn(corners.back() - a, p - a)) > kNarrow * glm::length(p - a)) break;
        }
        corners.push_back(p);
    }
    corners.pop_back();
    return corners;
}

}  // namespace

/// For a plane of any roughness: whether the light is wholly visible or hidden, where no edge comes near it.
ExactArea::Answer ExactArea::seen_in_rough_plane(const Sight& sight, Workspace& work) const {
    const FloatSpace space(sight.viewpoint.point(), sight.plane);
    if (!std::isfinite(sight.plane.rounding) || sight.partly || !space.orientation()) return kNothingKnown;
    const double reach = kGatherReach + 8 * sight.plane.rounding;
    edges_.gather(sight.viewpoint, space, reach, work.silhouette);
    bool clear = true;
    for (const auto& [edge, change] : work.silhouette) {
        const CandidateEdge& e = edges_.candidate(edge);
        const auto clipped =
            clip_around_light(space.project(occluders_.position(e.a)), space.project(occluders_.position(e.b)), reach);
        clear = clear && clipped && clipped->empty;
    }
    // Nor may a triangle pass through the plane there.
    const dvec3 to_light = space.to_centre().value;
    const double around  = 2 * reach * std::max(glm::length(sight.plane.u), glm::length(sight.plane.v)) +
                          space.to_centre().error + 2 * sight.viewpoint.point().slack();
    occluders_.triangles.visit(BoxTree::Piece{sight.viewpoint.point().rounded() + to_light, dvec3(0), 0, around},
                               [&](TriangleId t) {
                                   clear = clear && t == sight.viewpoint.own();
                                   return clear;
                               });
    if (!clear) return kNothingKnown;
    const Projection<FloatSpace> projection(sight, space);
    TriangleId blocker = kNoTriangle;
    const auto layers  = LayerCount<FloatSpace>(projection).at(0, 0, blocker);
    return !layers ? kNothingKnown : *layers > 0 ? Answer{} : kAllVisible;
}

void ExactArea::find_silhouette(const Viewpoint& viewpoint, const FloatSpace& space, Workspace& work) const {
    if (work.in_group && space.orientation())
        edges_.pick(viewpoint, space, kGatherReach, work.group, work.silhouette);
    else
        edges_.gather(viewpoint, space, kGatherReach, work.silhouette);
}

/// Splits points in two groups of one size, apart from each other.
void ExactArea::halve(const PointBatch& points, std::span<std::uint32_t> which) {
    Box box;
    for (const std::uint32_t i : which) box = extend(box, points.position(i));
    const vec3 size   = box.max - box.min;
    const int axis    = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto middle = which.begin() + static_cast<std::ptrdiff_t>(which.size() / 2);
    std::nth_element(which.begin(), middle, which.end(), [&](std::uint32_t a, std::uint32_t b) {
        return points.position(a)[axis] < points.position(b)[axis];
    });
}

/// Finds the candidates of all these points. False where they are too many for that, or the light is too close.
bool ExactArea::look_around(const PointBatch& points, std::span<const std::uint32_t> which, Workspace& work) const {
    if (which.size() < kFewest) return false;
    constexpr double kApart    = 1.0 / 8;  // of the distance to the light: they do not lie together
    const std::uint32_t middle = which[which.size() / 2];
    const Viewpoint viewpoint(occluders_.scene, points.triangle[middle], points.u[middle], points.v[middle],
                              work.coplanar);
    const std::optional<LightPlane> plane = light_.plane_from(viewpoint.point());
    if (!plane || !(plane->rounding <= kRoughest)) return false;
    double around = 0;
    for (const std::uint32_t i : which) {
        const ExactPoint p(occluders_.scene, points, i);
        around = std::max(around, largest(p.rounded() - viewpoint.point().rounded()) + p.slack());
    }
    const Entries to_centre = viewpoint.point().to(plane->centre_from_corner);
    if (around > kApart * largest(to_centre.value)) return false;
    // The planes of two points differ by twice what each may be off.
    const std::optional<BoxTree::Region> region = light_.region_from(viewpoint.point(), kGatherReach + 4 * kRoughest);
    if (!region) return false;
    const std::size_t most = std::clamp(edges_.candidates() / kPart, kFew, kMostEdges);
    around                 = (1 + 4 * kUnit) * (around + viewpoint.point().slack());
    if (!edges_.gather_around(viewpoint, *region, around, most, work.group)) return false;
    const dvec2 place = counting_place(0);
    work.over.gather(occluders_, viewpoint.point(), to_centre.value + place.x * plane->u + place.y * plane->v, place.x,
                     place.y, around);
    return true;
}

ExactArea::Answer ExactArea::seen(TriangleId own, float u, float v, bool partly, int turn, Workspace& work) const {
    const Viewpoint viewpoint(occluders_.scene, own, u, v, work.coplanar);
    const std::optional<LightPlane> plane = light_.plane_from(viewpoint.point());
    if (!plane) return kAllVisible;
    const Sight sight{occluders_, edges_, light_, *plane, viewpoint, partly, turn, work.over};
    if (!(plane->rounding <= kRoughest)) return seen_in_rough_plane(sight, work);

    const FloatSpace space(viewpoint.point(), *plane);
    if (arithmetic_ == Arithmetic::filtered && space.orientation()) {
        const VisiblePart<FloatSpace> part(sight, space, measure_, work.in_double);
        // The triangle that hid the whole light of the point before often hides it from this one.
        if (work.blocker != kNoTriangle && work.blocker != own && part.is_hidden_by(work.blocker)) return {};
        find_silhouette(viewpoint, space, work);
        work.steps += kStepsOfPoint + work.silhouette.size() + light_.across().size();
        if (const auto area = part.find(work.silhouette, work.blocker)) return answer(*area, light_.round());
    } else {
        find_silhouette(viewpoint, space, work);
    }

    const RationalSpace exact_space(viewpoint.point(), *plane);
    if (exact_space.orientation() == 0) return {.edge_on = true};
    ++work.rational_points;
    work.steps += kRationalSteps * (kStepsOfPoint + work.silhouette.size());
    const VisiblePart<RationalSpace> part(sight, exact_space, measure_, work.in_rationals);
    const Filtered<VisibleArea> area = part.find(work.silhouette, work.blocker);
    return area ? answer(*area, light_.round()) : kNothingKnown;
}

ExactArea::Account ExactArea::account(TriangleId own, float u, float v, bool partly, int turn) const {
    Workspace work;
    Account account{.answer = seen(own, u, v, partly, turn, work)};
    account.edges           = work.silhouette.size();
    account.open_sides      = work.coplanar.known.size();
    const bool in_rationals = work.rational_points > 0 || account.answer.edge_on;
    std::string_view open   = work.in_double.left_open;
    if (open.empty()) open = "the point's side of the light's plane";
    account.arithmetic = !in_rationals                         ? "doubles"
                         : arithmetic_ == Arithmetic::rational ? "rationals, as set"
                                                               : fmt::format("rationals: doubles leave open {}", open);

    const Viewpoint viewpoint(occluders_.scene, own, u, v, work.coplanar);
    const std::optional<LightPlane> plane = light_.plane_from(viewpoint.point());
    if (!plane || !(plane->rounding <= kRoughest) || account.answer.edge_on) return account;
    const Sight sight{occluders_, edges_, light_, *plane, viewpoint, partly, turn, work.over};
    const auto pieces = [&](const auto& space, auto& covering) {
        return VisiblePart<std::decay_t<decltype(space)>>(sight, space, measure_, covering).pieces(work.silhouette);
    };
    const Outlines outlines(in_rationals ? pieces(RationalSpace(viewpoint.point(), *plane), work.in_rationals)
                                         : pieces(FloatSpace(viewpoint.point(), *plane), work.in_double));
    for (const std::vector<dvec2>& walked : outlines.walk()) {
        std::vector<dvec2> corners = corners_of(walked);
        const double twice         = twice_area(corners);
        if (std::abs(twice) <= kNarrow) continue;
        if (twice > 0) ++account.pieces;
        if (light_.round()) std::erase_if(corners, [](dvec2 c) { return glm::length(c) > 1 - kNarrow; });
        account.outlines.push_back(std::move(corners));
    }
    return account;
}

std::optional<vec3> ExactArea::seen_through(TriangleId own, float u, float v, bool partly, int turn, const Answer& seen,
                                            Workspace& work) const {
    const vec3 without(seen.visibility);
    if (seen.edge_on || seen.visibility == 0) return without;
    const Scene& scene = occluders_.scene;
    const Viewpoint viewpoint(scene, own, u, v, work.coplanar);
    const std::optional<LightPlane> plane = light_.plane_from(viewpoint.point());
    if (!plane) return without;
    bool any_filter = false;
    work.between.clear();
    const auto take = [&](TriangleId t) {
        if (t == own || !occluders_.has_area(t) || scene.lets_through(t) == vec3(1)) return true;
        work.between.push_back(t);
        any_filter = any_filter || !scene.blocks(t);
        return true;
    };
    const FloatSpace space(viewpoint.point(), *plane);
    if (space.orientation())
        occluders_.triangles.visit(
            shaft(viewpoint.point(), space, 1 + 8 * plane->rounding), [](std::uint32_t, const Box&) { return true; },
            take);
    else
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) take(t);
    if (!any_filter) return without;
    const RationalSpace exact_space(viewpoint.point(), *plane);
    if (exact_space.orientation() == 0) return without;
    const Sight sight{occluders_, edges_, light_, *plane, viewpoint, partly, turn, work.over};
    const std::optional<dvec3> passed = light_through_filters(sight, exact_space, work.between, work.steps);
    if (!passed) return std::nullopt;
    return vec3(glm::clamp(*passed, 0.0, 1.0));
}

}  // namespace umbra::exact_visibility
