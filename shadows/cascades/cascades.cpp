#include "umbra/shadows/cascades/cascades.h"

#include <algorithm>
#include <cmath>

namespace umbra {
namespace {

constexpr double kLeastNear    = 1e-4;  // of the farthest depth, for splits
constexpr double kLeastWindow  = 1e-7;  // of the window of all that casts: corners are snapped in double
constexpr double kNarrowest    = 1e-6;  // width of a window by its height, or the other way round
constexpr double kRoundingRoom = 1e-9;  // of all that casts: cuts and points are rounded otherwise
constexpr double kHalfTexel    = 0.5;   // a window may be asked that far beyond its bounds
constexpr double kOctaveSteps  = 4;     // ranges of stable cascades are rounded to these

LightExtents extents_of(const LightFrame& f) {
    return {MinMax{f.centre.x - f.half.x, f.centre.x + f.half.x}, MinMax{f.centre.y - f.half.y, f.centre.y + f.half.y},
            MinMax{f.near, f.far}};
}

/// Reaches over the window's border and in front of the first depth, as the maps of other lights do (LightViews).
void add_room(LightFrame& frame, const CascadeOptions& options, double border) {
    frame.half /= 1 - 2 * border / options.resolution;
    const double room = options.room.headroom * 2 * std::max(frame.half.x, frame.half.y) / options.resolution;
    frame.near        = std::min(frame.near, frame.far) - room;
    frame.far += 0.01 * (frame.far - frame.near);
    frame.reach = kInfinity;
}

/// The window over what both has receivers in it and casts onto them.
Cascade window_of(const CascadeOptions& options, const LightFrame& casters, LightExtents receivers) {
    Cascade cascade;
    cascade.frame = casters;
    if (receivers[0].min > receivers[0].max) {  // a part of the view without a surface
        cascade.casts = false;
        cascade.low   = dvec3(kInfinity);
        return cascade;
    }
    const LightExtents all = extents_of(casters);
    const double size      = std::max({all[0].half(), all[1].half(), all[2].half()});
    for (int axis = 0; axis < 3; ++axis) {
        MinMax& r = receivers[axis];
        r.min -= kRoundingRoom * size;
        r.max += kRoundingRoom * size;
        // Beyond the last that casts nothing is shaded: there a window needs no bound.
        const MinMax& c   = all[axis];
        const MinMax both = {std::max(r.min, c.min), std::min(r.max, c.max)};
        if (r.min > c.min) cascade.low[axis] = r.min;
        if (r.max < c.max) cascade.high[axis] = r.max;
        if (axis == 2) {
            // Depths that no receiver has need no values of their own: what casts before them all has nearness 1.
            cascade.frame.near = both.min;
            cascade.frame.far  = both.max;
        } else if (both.min > both.max) {
            cascade.casts = false;
        } else if (r.min > c.min || r.max < c.max) {
            cascade.frame.centre[axis] = both.centre();
            cascade.frame.half[axis]   = both.half();
        }
    }
    dvec2& half = cascade.frame.half;
    half        = glm::max(half, dvec2(std::max(kLeastWindow * size, kNarrowest * std::max(half.x, half.y))));
    add_room(cascade.frame, options, options.room.border);
    const dvec2 over = kHalfTexel * cascade.texel(options.resolution);
    cascade.low -= dvec3(over, std::max(over.x, over.y));
    cascade.high += dvec3(over, std::max(over.x, over.y));
    return cascade;
}

/// The window over a sphere, of a size that does not depend on the camera, whose corner is a multiple of a texel; along
/// axes where all that casts is no wider than the sphere, the window of that, which stays anyhow. Depths are those of
/// all that casts.
Cascade stable_window(const CascadeOptions& options, const LightFrame& casters, const View::Sphere& sphere) {
    Cascade cascade;
    cascade.frame      = casters;
    const dvec2 centre = dvec2(casters.light_space(sphere.centre));
    cascade.frame.half = glm::min(casters.half, dvec2(sphere.radius));
    add_room(cascade.frame, options, options.room.border + 1);  // and the reach of snapping
    const dvec2 texel   = cascade.texel(options.resolution);
    const dvec2 snapped = glm::floor((centre - cascade.frame.half) / texel) * texel + cascade.frame.half;
    for (int axis = 0; axis < 2; ++axis) {
        if (casters.half[axis] <= sphere.radius) continue;
        cascade.frame.centre[axis] = snapped[axis];
        cascade.low[axis]          = centre[axis] - sphere.radius - kHalfTexel * texel[axis];
        cascade.high[axis]         = centre[axis] + sphere.radius + kHalfTexel * texel[axis];
    }
    return cascade;
}

}  // namespace

std::vector<double> split_depths(Splits splits, double lambda, double near, double far, int m) {
    std::vector<double> depths{near};
    for (int i = 1; i < m; ++i) {
        const double part        = static_cast<double>(i) / m;
        const double uniform     = near + (far - near) * part;
        const double logarithmic = near * std::pow(far / near, part);
        depths.push_back(splits == Splits::uniform       ? uniform
                         : splits == Splits::logarithmic ? logarithmic
                                                         : lambda * logarithmic + (1 - lambda) * uniform);
    }
    depths.push_back(far);
    return depths;
}

bool Cascade::answers(dvec3 p) const {
    const dvec3 v = frame.light_space(p);
    return glm::all(glm::greaterThanEqual(v, low)) && glm::all(glm::lessThanEqual(v, high));
}

std::array<dvec4, 4> window_sides(const LightFrame& casters, const View& view) {
    const dvec3 eye        = casters.light_space(view.eye());
    const LightExtents all = extents_of(casters);
    return {dvec4(casters.x, eye.x - all[0].min), dvec4(-casters.x, all[0].max - eye.x),
            dvec4(casters.y, eye.y - all[1].min), dvec4(-casters.y, all[1].max - eye.y)};
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

Cascades fit_cascades(const CascadeOptions& options, const LightFrame& casters, const View& view,
                      const Receivers& receivers) {
    Cascades all{.parts = {}, .whole = {}, .splits = {}, .view = view, .blend = options.blend};
    all.whole.frame = casters;
    add_room(all.whole.frame, options, options.room.border);

    MinMax range = receivers.depths();
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
        seen = receivers.extents(slices, casters);
    } else {
        seen.resize(slices.size());
        for (std::size_t k = 0; k < slices.size(); ++k)
            for (const dvec3& corner : view.corners(slices[k].from, slices[k].to)) {
                const dvec3 v = casters.light_space(corner);
                for (int axis = 0; axis < 3; ++axis) seen[k][axis].add(v[axis]);
            }
    }
    for (const LightExtents& in_slice : seen) all.parts.push_back(window_of(options, casters, in_slice));
    return all;
}

}  // namespace umbra
