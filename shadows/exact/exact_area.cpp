#include "umbra/shadows/exact/exact_area.h"

#include "umbra/shadows/exact/filtered_light.h"

namespace umbra::exact_visibility {
namespace {

using Answer = ExactArea::Answer;

constexpr Answer kNothingKnown{
    .visibility = 0.5f, .half_width = 0.5f, .irradiance = 0.5f, .irradiance_half_width = 0.5f};
constexpr Answer kAllVisible{.visibility = 1, .irradiance = 1};

/// Of LightPlane::rounding. Edges move by twice that: half of the distance between the light and the reach within which
/// edges are kept. Where the plane is rougher, an edge that was left out might lie over the light.
constexpr double kRoughest = (kCutReach - 1) / 4;

/// Candidates are few where every point may ask each of them: so many, or this part of all edges.
constexpr std::size_t kFew = 64, kPart = 12;

/// A value and its half width. What differs from 0 or 1 by no more than `unsure`, rounding, may be 0 or 1.
std::pair<float, float> value_of(const Bracket& bracket, double unsure) {
    const auto [low, high] = bracket;
    if (high <= unsure) return {0.0f, static_cast<float>(high)};
    if (low >= 1 - unsure) return {1.0f, static_cast<float>(1 - low)};
    // Half an ulp of the answer belongs to what it may be off.
    const auto half = static_cast<float>((high - low) / 2 * (1 + 0x1p-22) + 0x1p-25);
    return {static_cast<float>((low + high) / 2), half};
}

/// Of rectangles the area alone is stated, which is off by less than kTrusted.
Answer answer(const VisibleArea& area, bool round) {
    const Bracket share{std::max(0.0, (area.visible - area.error) / area.whole),
                        std::min(1.0, (area.visible + area.open + area.error) / area.whole)};
    const double unsure                 = area.error <= kTrusted ? 2 * area.error / area.whole : 0;
    const auto [visibility, half]       = value_of(share, unsure);
    const auto [irradiance, light_half] = value_of(area.irradiance, kTrusted / 4);
    return {visibility, round ? half : 0, irradiance, light_half};
}

/// Of a point, and how many times as long rationals take.
constexpr std::uint64_t kStepsOfPoint = 20, kRationalSteps = 300;

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
    constexpr double kApart = 1.0 / 8;  // of the distance to the light: they do not lie together
    const auto at           = [&](std::uint32_t i) {
        return ExactPoint(occluders_.scene, points.triangle[i], points.u[i], points.v[i]);
    };
    const std::uint32_t middle = which[which.size() / 2];
    const Viewpoint viewpoint(occluders_.scene, points.triangle[middle], points.u[middle], points.v[middle],
                              work.coplanar);
    const std::optional<LightPlane> plane = light_.plane_from(viewpoint.point());
    if (!plane || !(plane->rounding <= kRoughest)) return false;
    double around = 0;
    for (const std::uint32_t i : which) {
        const ExactPoint p = at(i);
        around             = std::max(around, largest(p.rounded() - viewpoint.point().rounded()) + p.slack());
    }
    const Entries to_centre = viewpoint.point().to(plane->centre_from_corner);
    if (around > kApart * largest(to_centre.value)) return false;
    // The planes of two points differ by twice what each may be off.
    const std::optional<BoxTree::Region> region = light_.region_from(viewpoint.point(), kGatherReach + 4 * kRoughest);
    if (!region) return false;
    const std::size_t most = std::max(kFew, edges_.candidates() / kPart);
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
        // What hid the whole light of the point before often hides it from this one.
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
        if (t == own || occluders_.topology.degenerate[t] || scene.lets_through(t) == vec3(1)) return true;
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
