#include "umbra/shadows/cascades/cascades.h"

#include <algorithm>
#include <cmath>

namespace umbra {
namespace {

constexpr double kLeastNear    = 1e-4;  // of the farthest depth, for splits
constexpr double kLeastWindow  = 1e-7;  // of the window of all that casts: corners are snapped in double
constexpr double kRoundingRoom = 1e-9;  // of the same: cuts and points are rounded otherwise
constexpr double kHalfTexel    = 0.5;   // a window may be asked that far beyond its bounds
constexpr double kOctaveSteps  = 4;     // ranges of stable cascades are rounded to these

Extent common(const Extent& a, const Extent& b) { return {std::max(a.min, b.min), std::min(a.max, b.max)}; }

/// Of a window that holds `extents` in its roll: no less than `least` wide.
void set_window(LightFrame& frame, const Extent& x, const Extent& y, double least) {
    frame.centre = {x.centre(), y.centre()};
    frame.half   = glm::max(with_area({x.half(), y.half()}), dvec2(least));
}

/// Reaches over the window's border and in front of the first depth, as the maps of other lights do (LightViews).
void add_room(LightFrame& frame, const CascadeOptions& options, double border) {
    frame.half /= 1 - 2 * border / options.resolution;
    const double room = options.headroom * 2 * std::max(frame.half.x, frame.half.y) / options.resolution;
    frame.near        = std::min(frame.near, frame.far) - room;
    frame.far += 0.01 * (frame.far - frame.near);
    frame.reach = kInfinity;
}

/// The roll in which the common part of both extents has the least area.
int best_roll(const LightExtents& a, const LightExtents& b) {
    const auto area = [&](int i) {
        const double x = common(a[2 * i], b[2 * i]).half(), y = common(a[2 * i + 1], b[2 * i + 1]).half();
        return std::max(x, 0.0) * std::max(y, 0.0);
    };
    int best = 0;
    for (int i = 1; i < kRolls; ++i)
        if (area(i) < area(best)) best = i;
    return best;
}

/// The window over what both has receivers in it and casts onto them.
Cascade window_of(const CascadeOptions& options, const CasterWindow& casters, LightExtents receivers) {
    const LightExtents& all = casters.extents();
    const double size       = std::max({all[0].half(), all[1].half(), all.back().half()});
    for (Extent& extent : receivers) extent.min -= kRoundingRoom * size, extent.max += kRoundingRoom * size;

    Cascade cascade;
    if (receivers[0].min > receivers[0].max) {  // a part of the view without a surface
        cascade.casts = false;
        cascade.low   = dvec3(kInfinity);
        return cascade;
    }
    const int roll  = best_roll(receivers, all);
    cascade.frame   = casters.space().frame(roll);
    const Extent* r = &receivers[2 * roll];
    const Extent* c = &all[2 * roll];
    const Extent x = common(r[0], c[0]), y = common(r[1], c[1]);
    cascade.casts = x.min <= x.max && y.min <= y.max;
    // Depths that no receiver has need no values of their own: what casts before them all has nearness 1.
    const Extent& rz   = receivers.back();
    const Extent& cz   = all.back();
    cascade.frame.near = std::max(rz.min, cz.min);
    cascade.frame.far  = std::min(rz.max, cz.max);
    set_window(cascade.frame, cascade.casts ? x : r[0], cascade.casts ? y : r[1], kLeastWindow * size);
    add_room(cascade.frame, options, options.border);
    // Beyond the last that casts nothing is shaded: there a window needs no bound.
    const dvec2 over = kHalfTexel * cascade.texel(options.resolution);
    const auto bound = [&](int axis, const Extent& receiver, const Extent& caster, double beyond) {
        if (receiver.min > caster.min) cascade.low[axis] = receiver.min - beyond;
        if (receiver.max < caster.max) cascade.high[axis] = receiver.max + beyond;
    };
    bound(0, r[0], c[0], over.x);
    bound(1, r[1], c[1], over.y);
    bound(2, rz, cz, std::max(over.x, over.y));
    return cascade;
}

/// The window over a sphere, of a size that does not depend on the camera, whose corner is a multiple of a texel. Roll
/// and depths are those of all that casts.
Cascade stable_window(const CascadeOptions& options, const CasterWindow& casters, const View::Sphere& sphere) {
    Cascade cascade;
    cascade.frame      = casters.space().frame(casters.roll());
    const dvec3 centre = cascade.frame.light_space(sphere.centre);
    cascade.frame.near = casters.extents().back().min;
    cascade.frame.far  = casters.extents().back().max;
    cascade.frame.half = dvec2(sphere.radius);
    add_room(cascade.frame, options, options.border + 1);  // and what snapping moves it
    const dvec2 texel    = cascade.texel(options.resolution);
    cascade.frame.centre = glm::floor((dvec2(centre) - cascade.frame.half) / texel) * texel + cascade.frame.half;
    cascade.low          = dvec3(dvec2(centre) - sphere.radius - kHalfTexel * texel, -kInfinity);
    cascade.high         = dvec3(dvec2(centre) + sphere.radius + kHalfTexel * texel, kInfinity);
    return cascade;
}

}  // namespace

bool Cascade::answers(dvec3 p) const {
    const dvec3 v = frame.light_space(p);
    return glm::all(glm::greaterThanEqual(v, low)) && glm::all(glm::lessThanEqual(v, high));
}

CasterWindow::CasterWindow(const Casters& casters, dvec3 direction)
    : space_(looking_along(dvec3(casters.box().centre()), direction, false)),
      extents_(casters.ranges<2 * kRolls + 1>([&](dvec3 p) { return space_.values(p); })),
      roll_(best_roll(extents_, extents_)) {}

std::array<dvec4, 4> CasterWindow::sides(const View& view) const {
    const LightFrame frame = space_.frame(roll_);
    const dvec3 eye        = frame.light_space(view.eye());
    const Extent &x = extents_[2 * roll_], &y = extents_[2 * roll_ + 1];
    return {dvec4(frame.x, eye.x - x.min), dvec4(-frame.x, x.max - eye.x), dvec4(frame.y, eye.y - y.min),
            dvec4(-frame.y, y.max - eye.y)};
}

Cascades::Choice Cascades::choose(dvec3 p) const {
    const dvec2 aside = dvec2(whole.frame.light_space(p)) - whole.frame.centre;
    if (std::abs(aside.x) > whole.frame.half.x || std::abs(aside.y) > whole.frame.half.y) return {};
    if (parts.empty()) return {.first = 0};
    const double depth = view.depth(p);
    const auto inner   = std::span(splits).subspan(1, parts.size() - 1);
    const auto k       = static_cast<std::size_t>(std::ranges::upper_bound(inner, depth) - inner.begin());
    if (!parts[k].answers(p)) return {.first = parts.size()};
    Choice choice{.first = k};
    const double width = blend * (splits[k + 1] - splits[k]);
    if (k + 1 < parts.size() && depth > splits[k + 1] - width && parts[k + 1].answers(p)) {
        choice.second = k + 1;
        choice.share  = std::clamp((depth - (splits[k + 1] - width)) / width, 0.0, 1.0);
    }
    return choice;
}

Cascades fit_cascades(const CascadeOptions& options, const CasterWindow& casters, const View& view,
                      const Receivers& receivers) {
    Cascades all{.parts = {}, .whole = {}, .splits = {}, .view = view, .blend = options.blend};
    const LightExtents& extents = casters.extents();
    const int roll              = casters.roll();
    all.whole.frame             = casters.space().frame(roll);
    all.whole.frame.near        = extents.back().min;
    all.whole.frame.far         = extents.back().max;
    set_window(all.whole.frame, extents[2 * roll], extents[2 * roll + 1], 0);
    add_room(all.whole.frame, options, options.border);

    Extent range = receivers.depths();
    if (!(range.max > 0)) return all;
    if (options.stable) {
        range.max = std::exp2(std::ceil(kOctaveSteps * std::log2(range.max)) / kOctaveSteps);
        range.min = std::max(range.min, kLeastNear * range.max);
        range.min = std::exp2(std::floor(kOctaveSteps * std::log2(range.min)) / kOctaveSteps);
    }
    const double near = std::max(range.min, kLeastNear * range.max);
    all.splits        = split_depths(options.splits, options.lambda, near, range.max, options.cascades);
    std::vector<DepthSlice> slices;
    for (int k = 0; k < options.cascades; ++k) {
        const double overlap = k == 0 ? 0 : options.blend * (all.splits[k] - all.splits[k - 1]);
        slices.push_back({all.splits[k] - overlap, all.splits[k + 1]});
    }
    if (near > range.min) slices[0].from = 0;

    if (options.stable) {
        for (const DepthSlice& slice : slices)
            all.parts.push_back(stable_window(options, casters, view.sphere(slice.from, slice.to)));
        return all;
    }
    std::vector<LightExtents> seen;
    if (options.window == CascadeWindow::receivers) {
        seen = receivers.extents(slices, casters.space());
    } else {
        seen.resize(slices.size());
        for (std::size_t k = 0; k < slices.size(); ++k)
            for (const dvec3& corner : view.corners(slices[k].from, slices[k].to)) casters.space().add(seen[k], corner);
    }
    for (const LightExtents& in_slice : seen) all.parts.push_back(window_of(options, casters, in_slice));
    return all;
}

}  // namespace umbra
