// Options of all methods with depth maps. A method's options derive from the structs here, and its list of parameters
// names the functions: each parameter is declared once.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/shadows/maps/depth_lookup.h"
#include "umbra/shadows/settings.h"

namespace umbra {

struct MapOptions {
    int resolution       = 2048;
    double constant      = 0;
    double slope         = 0;
    double normal_offset = 0;
    int radius           = 1;
};

/// For methods that compare a point with one depth after the other.
struct ComparingOptions : MapOptions {
    BiasMode bias = BiasMode::automatic;
    bool bilinear = true;
};

/// For methods that search for the blockers of an area light.
struct SearchOptions {
    double search = 0.1;
};

/// The reach of maps over the fitted casters, in samples: see LightViews::Options.
struct MapMargins {
    double border = 2, headroom = 64;
};

/// For maps that are asked for samples up to `reach` from the point, by a kernel of (2 radius + 1)^2 samples; headroom
/// is at least `room`. Throws UsageError, which names `method`, where the border would take half of the map.
[[nodiscard]] inline MapMargins margins(std::string_view method, const MapOptions& options, int radius, double reach,
                                        double room = 64) {
    // The reach of the filter and the offset, and a rounding.
    const MapMargins m{.border   = reach + options.normal_offset + 2,
                       .headroom = std::max(room, kMostAutomatic * (4 * radius + 2)) + options.constant};
    if (4 * m.border > options.resolution)
        throw UsageError(fmt::format(
            "{}: radius={} and normal_offset={} reach over a quarter of resolution={}, expected a resolution of at "
            "least {}",
            method, radius, options.normal_offset, options.resolution, std::ceil(4 * m.border)));
    return m;
}

// The parameters of the structs above and of ViewOptions, for the method's own struct `Options`.

template <class Options>
[[nodiscard]] Parameter resolution_parameter(std::string_view doc, std::string_view sweep) {
    return parameter<&MapOptions::resolution, Options>(
        "resolution", doc, {.unit = "texels", .phase = Phase::aim, .min = 16, .max = 16384, .sweep = sweep});
}

template <class Options>
[[nodiscard]] Parameter constant_parameter() {
    return parameter<&MapOptions::constant, Options>(
        "constant", "Moves the point towards the light.",
        {.unit = "texel widths at the point's depth", .phase = Phase::aim, .min = 0, .max = 1e6});
}

template <class Options>
[[nodiscard]] Parameter slope_parameter() {
    return parameter<&MapOptions::slope, Options>(
        "slope", "Moves the point towards the light.",
        {.unit = "depth gradients of the receiver's plane a texel", .min = 0, .max = 1e6});
}

template <class Options>
[[nodiscard]] Parameter normal_offset_parameter() {
    return parameter<&MapOptions::normal_offset, Options>(
        "normal_offset", "Moves the point along its normal, times the sine of the light's angle.",
        {.unit = "texel widths", .phase = Phase::aim, .min = 0, .max = 64});
}

template <class Options>
[[nodiscard]] Parameter radius_parameter(std::string_view doc, int most, std::string_view sweep = {}) {
    return parameter<&MapOptions::radius, Options>(
        "radius", doc,
        {.unit = "texels", .phase = Phase::aim, .min = 0, .max = static_cast<double>(most), .sweep = sweep});
}

template <class Options>
[[nodiscard]] Parameter bias_parameter() {
    return parameter<&ComparingOptions::bias, Options>(
        "bias",
        "Reference depth of the comparison. manual: the depth of the point plus constant and slope bias. "
        "receiver_plane: the receiver's plane at the texel, minus a rounding margin. auto: the smaller of the "
        "two, minus a texel width and a quarter of the depth gradient, at most 16 texel widths in front of the "
        "plane.",
        {.choices = "auto|receiver_plane|manual"});
}

template <class Options>
[[nodiscard]] Parameter bilinear_parameter() {
    return parameter<&ComparingOptions::bilinear, Options>(
        "bilinear", "pcf: bilinear weights, so that the kernel does not step from texel to texel.");
}

template <class Options>
[[nodiscard]] Parameter fit_parameter() {
    return parameter<&ViewOptions::fit, Options>(
        "fit",
        "What a map covers. scene: everything; casters: what can block the light, without planes that have "
        "everything else in front of them.",
        {.phase = Phase::build, .choices = "casters|scene"});
}

template <class Options>
[[nodiscard]] Parameter surround_parameter() {
    return parameter<&ViewOptions::surround, Options>(
        "surround",
        "Spot lights: resolution of the maps outside the cone, relative to the cone's own map; 0: no such "
        "maps, points there are undefined.",
        {.phase = Phase::aim, .min = 0, .max = 1});
}

template <class Options>
[[nodiscard]] Parameter search_parameter(std::string_view doc) {
    return parameter<&SearchOptions::search, Options>(
        "search", doc, {.unit = "sides of the map", .phase = Phase::aim, .min = 0, .max = 0.1, .area_lights = true});
}

}  // namespace umbra
