// The part of an area light that one point sees, in one arithmetic.
//
// Over the light's plane lie the projected triangles, here two that overlap. All that is kept of them is where the
// number of layers over a point changes: the silhouette edges, and the chords, where a triangle passes through the
// light's plane and its part before the plane ends.
//
//        ^ y       0           .
//        |   .----------------/-\-----.      1. COUNT. At one point (#) of the light, count the triangles that the
//        |   | light    0    / 1 \    |         segment to it meets: here 2.
//        |   |        ------/-----\---|---   2. FOLLOW. From there to the far left of the lowest row, through the edges
//        |   |        \  1 /   #2  \  |         in between (Covering::relative_layers): the base layers, here 0.
//    row =   | visible \  /         \ | 1    3. SWEEP. Row by row, from the base layers on, edges change the number;
//        |   '----------\/-----------\'         the trapezoids of the light over which it is 0 are visible.
//      base    0        /\    2       \      4. CAPS. To the sweep a round light is a polygon; what lies between it and
//     layers           /  \            \        the circle follows its chord, or is left open (disk_caps.h). In doubles
//                                              the area needs no polygon (whole_light.h).
//        +-------------------------------> x
//
// The signs of triangles and the count are exact. In between is a chain of edges that closes whatever the rounding of
// its corners, since each corner is projected by itself alone.
//
// The error of the area is bounded by covering_edges.h and depth_doubt.h, and by the roundings of the sweep. Where
// rationals would do much better, or a sign remains open, doubles cannot tell.
//
// This work is based on:
// Samuli Laine et al. Soft Shadow Volumes for Ray Tracing. 2005
#pragma once

#include <string_view>

#include "umbra/core/render/visibility.h"
#include "umbra/shadows/exact/covering_edges.h"
#include "umbra/shadows/exact/depth_doubt.h"
#include "umbra/shadows/exact/horizon.h"
#include "umbra/shadows/exact/layer_count.h"
#include "umbra/shadows/exact/received_light.h"

namespace umbra::exact_visibility {

/// In area, of a light of 4: below 1e-9 of it, and far below half an ulp of a float.
inline constexpr double kTrusted = 0x1p-28;

/// The memory of the sweep, kept from point to point.
template <class T>
struct PartialCovering {
    Covering<T> edges;
    DiskCaps caps;
    typename Covering<T>::Outline cut;  ///< of a light that the plane of the point's triangle cuts
    std::string_view left_open{};       ///< what this arithmetic could not tell of a point, if any
};

/// Areas in the light's plane, in half axes.
struct VisibleArea {
    double whole   = 4;  ///< of the light
    double visible = 0;
    double open    = 0;    ///< may be visible, too
    double error   = 0;    ///< by which both sums may be off
    Bracket irradiance{};  ///< where it was asked for: a fraction
};

template <class Space>
class VisiblePart {
public:
    using T = typename Space::Number;

    VisiblePart(const Sight& sight, const Space& space, Measure measure, PartialCovering<T>& covering)
        : sight_(sight), projection_(sight, space), measure_(measure), covering_(covering) {}

    /// Whether triangle t surely hides the whole light.
    [[nodiscard]] bool is_hidden_by(TriangleId t) const {
        return LayerCount<Space>(projection_).covers_all(t) && surely_before_light(sight_, t);
    }

    /// `blocker` becomes a triangle that hides the whole light, where one is found, else kNoTriangle.
    [[nodiscard]] Filtered<VisibleArea> find(const std::vector<SilhouetteEdge>& silhouette, TriangleId& blocker) const;

    /// The visible part of the light, of a round one's polygon: rows from bottom to top, each from left to right.
    /// Nothing where `find` is kUnsure.
    [[nodiscard]] std::vector<Trapezoid> pieces(const std::vector<SilhouetteEdge>& silhouette) const;

private:
    std::nullopt_t unsure(std::string_view of) const {
        covering_.left_open = of;
        return kUnsure;
    }
    [[nodiscard]] bool is_clear(double x, double y, double widest) const;
    [[nodiscard]] Filtered<int> base_layers(double widest, TriangleId& blocker) const;
    using Light = typename Covering<T>::Outline;
    [[nodiscard]] const Light& light_before_horizon(const Horizon<T>& horizon) const;
    [[nodiscard]] Filtered<Bracket> irradiance(const ReceivedLight& received, const Light& light, double visible,
                                               double error) const;
    [[nodiscard]] static double whole_irradiance(const ReceivedLight& received, const Light& light, DiskCaps& caps);
    [[nodiscard]] bool round() const { return sight_.light.round(); }
    /// Whether the light is swept to its rim, and not as a polygon.
    [[nodiscard]] bool to_rim() const { return std::is_same_v<T, double> && measure_ == Measure::area; }

    const Sight& sight_;
    Projection<Space> projection_;
    Measure measure_;
    PartialCovering<T>& covering_;
};

/// Point k of the light to count layers at, spread over most of the square without a pattern that a scene could share
/// [Martin Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018].
inline dvec2 counting_place(int k) {
    const double x = (k + 1) * 0.7548776662466927, y = (k + 1) * 0.5698402909980532;
    return 1.9 * (dvec2(x, y) - glm::floor(dvec2(x, y))) - 0.95;
}

/// Whether no edge lies so close to the point that its rounding, `widest` at most, could put it on the other side.
template <class Space>
bool VisiblePart<Space>::is_clear(double x, double y, double widest) const {
    const double near = 4 * widest + 0x1p-40;  // two coordinates, twice; and the rounding below
    bool clear        = true;
    covering_.edges.each_edge([&](const auto& low, const auto& high) {
        const double x0 = as_double(low.x), y0 = as_double(low.y), x1 = as_double(high.x), y1 = as_double(high.y);
        if (y < y0 - near || y > y1 + near || x < std::min(x0, x1) - near || x > std::max(x0, x1) + near) return;
        const double dx = x1 - x0, dy = y1 - y0, length = std::hypot(dx, dy);
        const double t = length > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / (length * length), 0.0, 1.0) : 0;
        if (std::hypot(x0 + t * dx - x, y0 + t * dy - y) < near) clear = false;
    });
    return clear;
}

/// Layers at the far left of the lowest row.
template <class Space>
Filtered<int> VisiblePart<Space>::base_layers(double widest, TriangleId& blocker) const {
    // In doubles few tries, since rationals come after them.
    const int tries = std::is_same_v<T, double> ? 8 : 256;
    const LayerCount<Space> count(projection_);
    for (int k = 0; k < tries; ++k) {
        const dvec2 place = counting_place(k);
        if (!is_clear(place.x, place.y, widest)) continue;
        if (const auto layers = count.at(place.x, place.y, blocker))
            return *layers - covering_.edges.relative_layers({T(place.x), T(place.y)});
    }
    return kUnsure;
}

template <class Space>
const typename VisiblePart<Space>::Light& VisiblePart<Space>::light_before_horizon(const Horizon<T>& horizon) const {
    static const Light square({{T(-1), T(-1)}, {T(1), T(-1)}, {T(1), T(1)}, {T(-1), T(1)}});
    static const Light polygon(DiskCaps::polygon<T>());
    const Light& whole = round() ? polygon : square;
    if (!sight_.partly) return whole;
    covering_.cut.assign(before_horizon(whole.corners(), horizon));
    return covering_.cut;
}

/// The light from the whole polygon before the horizon; `caps` is filled.
template <class Space>
double VisiblePart<Space>::whole_irradiance(const ReceivedLight& received, const Light& light, DiskCaps& caps) {
    std::vector<LightCorner<double>> corners;
    for (const LightCorner<T>& c : light.corners()) corners.push_back({as_double(c.x), as_double(c.y), c.cap});
    Covering<double> nothing;
    double sum      = 0;
    const auto area = nothing.uncovered(Covering<double>::Outline(std::move(corners)), 0, caps.within_chords(),
                                        [&](const Trapezoid& piece) { sum += received.of(piece); });
    return area.first > 0 ? sum : 0;
}

/// `visible` arrives from the polygon's trapezoids, whose areas are off by `error`.
template <class Space>
Filtered<Bracket> VisiblePart<Space>::irradiance(const ReceivedLight& received, const Light& light, double visible,
                                                 double error) const {
    if (!received.usable()) return Bracket{0, 1};
    DiskCaps caps;
    if (round() && sight_.partly) touch_caps(horizon_of<double>(sight_), caps);
    const double whole = whole_irradiance(received, light, caps);
    if (!received.usable()) return Bracket{0, 1};
    const double moved = error * received.most();
    if (std::is_same_v<T, double> && !(moved <= kTrusted / 4 * whole)) return kUnsure;
    const double relative = received.weight_error() + ReceivedLight::kQuadrature;
    const double absolute = received.height_error() * (round() ? kPi : 4);
    const auto widened    = [&](double sum, Bracket of_caps, double by) {
        return Bracket{(sum + of_caps.low) * (1 - relative) - absolute - by,
                       (sum + of_caps.high) * (1 + relative) + absolute + by};
    };
    const Bracket none;
    return fraction(widened(visible, round() ? received.of(covering_.caps) : none, moved),
                    widened(whole, round() ? received.of(caps) : none, 0));
}

template <class Space>
Filtered<VisibleArea> VisiblePart<Space>::find(const std::vector<SilhouetteEdge>& silhouette,
                                               TriangleId& blocker) const {
    VisibleArea result{.whole = round() ? kPi : 4};
    blocker = kNoTriangle;
    Displacement displacement;
    DiskCaps* const caps = round() && !to_rim() ? &covering_.caps : nullptr;
    if (caps) caps->reset();
    if (!CoveringEdges<Space>(projection_, covering_.edges, caps).add(silhouette, displacement))
        return unsure("where edges lie before the light");

    const Filtered<int> base = base_layers(displacement.widest, blocker);
    if (!base) return unsure("which triangles lie over the light");
    if (blocker != kNoTriangle && surely_before_light(sight_, blocker)) return result;
    const double in_doubt = area_in_doubt(sight_);
    result.error          = in_doubt;
    const bool no_edges   = covering_.edges.empty();
    if (blocker != kNoTriangle || (no_edges && *base > 0)) return result;
    if (no_edges) result.irradiance = {1, 1};
    if (no_edges && !sight_.partly) {
        result.visible = result.whole;
        return result;
    }

    const bool weighted = measure_ == Measure::irradiance && !no_edges;
    Horizon<T> horizon{};
    if (sight_.partly || weighted) horizon = horizon_of<T>(sight_);
    if (sight_.partly) {
        if (caps) touch_caps(horizon, *caps);
        // On the light no line is longer than 3.
        displacement.move_edge(horizon.off(), 2 * sight_.plane.rounding, 3);
    }
    std::optional<ReceivedLight> received;
    if (weighted) received.emplace(sight_, rounded(horizon));
    double arrives           = 0;
    const auto area_and_rows = [&]() -> std::pair<double, double> {
        if constexpr (std::is_same_v<T, double>) {
            if (to_rim()) {
                std::optional<HalfPlane> before;
                if (sight_.partly) before = HalfPlane{horizon.lx, horizon.ly, horizon.l};
                return round() ? covering_.edges.template uncovered_of<WholeDisk>(*base, before)
                               : covering_.edges.template uncovered_of<WholeSquare>(*base, before);
            }
        }
        const Light& light = light_before_horizon(horizon);
        const auto chords  = caps ? caps->within_chords() : std::span<ChordState>();
        if (!weighted) return covering_.edges.uncovered(light, *base, chords, NoPieces{});
        return covering_.edges.uncovered(light, *base, chords,
                                         [&](const Trapezoid& piece) { arrives += received->of(piece); });
    }();
    const auto [area, rows] = area_and_rows;
    result.visible          = area;
    result.error            = in_doubt + displacement.swept + 16 * kUnit * (rows + 4);
    // Rationals have these errors, too. They are worth their time where they more than halve the bound.
    const double of_frame = in_doubt + displacement.by_frame;
    if (std::is_same_v<T, double> && !(result.error - of_frame <= std::max(kTrusted, of_frame)))
        return unsure("the area to 1e-9");
    if (caps) {
        const DiskCaps::Area with_caps = caps->with_caps(area);
        result.visible                 = with_caps.visible;
        result.open                    = with_caps.open;
    }
    if (weighted) {
        const Filtered<Bracket> bracket = irradiance(*received, light_before_horizon(horizon), arrives, result.error);
        if (!bracket) return unsure("the irradiance");
        result.irradiance = *bracket;
    }
    return result;
}

template <class Space>
std::vector<Trapezoid> VisiblePart<Space>::pieces(const std::vector<SilhouetteEdge>& silhouette) const {
    std::vector<Trapezoid> found;
    Displacement displacement;
    TriangleId blocker = kNoTriangle;
    if (!CoveringEdges<Space>(projection_, covering_.edges, nullptr).add(silhouette, displacement)) return found;
    const Filtered<int> base = base_layers(displacement.widest, blocker);
    if (!base || blocker != kNoTriangle) return found;
    DiskCaps caps;  // the polygon's chords are counted there
    const Light& light = light_before_horizon(sight_.partly ? horizon_of<T>(sight_) : Horizon<T>{});
    (void)covering_.edges.uncovered(light, *base, caps.within_chords(),
                                    [&](const Trapezoid& piece) { found.push_back(piece); });
    return found;
}

}  // namespace umbra::exact_visibility
