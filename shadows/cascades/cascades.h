// Cascades: the view is split by depth, and each part has a window onto the scene of its own, as the light sees it.
//
// This work is based on:
// Wolfgang Engel. Cascaded Shadow Maps. 2006
// Fan Zhang, Hanqiu Sun, Leilei Xu, Lee Kit Lun. Parallel-Split Shadow Maps for Large-Scale Virtual Environments. 2006
// Brandon Lloyd, David Tuft, Sung-eui Yoon, Dinesh Manocha. Warping and Partitioning for Low Error Shadow Maps. 2006
// Michal Valient. Stable Rendering of Cascaded Shadow Maps. 2008
// Andrew Lauritzen, Marco Salvi, Aaron Lefohn. Sample Distribution Shadow Maps. 2011
#pragma once

#include <cstdint>
#include <vector>

#include "umbra/shadows/cascades/receivers.h"
#include "umbra/shadows/maps/map_options.h"

namespace umbra {

/// The depths at which one cascade ends and the next begins, n to f, i of m.
enum class Splits : std::uint8_t {
    uniform,      ///< n + (f - n) i / m
    logarithmic,  ///< n (f / n)^(i / m): from the first to the last depth of a part pixels grow by (f / n)^(1 / m)
    practical     ///< lambda times the logarithmic one and 1 - lambda times the uniform one
};

/// The m + 1 depths from `near` to `far`, ascending, the two ends as they are: depths i and i + 1 bound part i.
/// 0 < near <= far, m >= 1; `lambda` is in [0, 1] and of use to `practical` alone.
[[nodiscard]] std::vector<double> split_depths(Splits splits, double lambda, double near, double far, int m);

/// The contents of a cascade's window.
enum class CascadeWindow : std::uint8_t {
    receivers,  ///< the surfaces in the part of the view that may be shaded
    frustum     ///< the part of the view, whatever is in it
};

struct SplitOptions {
    int cascades         = 4;  ///< > 0
    Splits splits        = Splits::practical;
    double lambda        = 0.5;
    CascadeWindow window = CascadeWindow::receivers;
    bool stable          = false;  ///< windows hold the sphere about the part of the view, and move in whole texels
    double blend         = 0;      ///< of a cascade's depth: how much of its end is answered by the next one, too
};

struct CascadeOptions : SplitOptions {
    int resolution = 2048;  ///< texels a side of a map
    MapMargins room{};
};

/// One map's window, and where it answers.
struct Cascade {
    LightFrame frame{};     ///< reaches without end; border and headroom included
    dvec3 low{-kInfinity};  ///< bounds of its answers, light space of `frame`; infinite where no caster is beyond
    dvec3 high{kInfinity};
    bool casts = true;  ///< else nothing in it is shaded, and no map is needed
    /// Along x and y, world units.
    [[nodiscard]] dvec2 texel(int resolution) const { return 2.0 * frame.half / static_cast<double>(resolution); }
    [[nodiscard]] bool answers(dvec3 p) const;
};

/// The sides of the window of all casters, in its own roll, as `planes` of receivers_in_view: they bound the points
/// that can be shaded.
[[nodiscard]] std::array<dvec4, 4> window_sides(const LightFrame& casters, const View& view);

/// The windows of one light for one camera.
struct Cascades {
    std::vector<Cascade> parts;  ///< near to far; empty where the camera sees nothing that may be shaded
    Cascade whole;               ///< over all that casts: for points that no part answers, as those outside of the view
    std::vector<double> splits;  ///< depths that bound the parts, one more than parts
    View view;
    double blend;

    /// Which windows answer a point: indices of parts, parts.size() for the whole, kLit where nothing can shade it.
    struct Choice {
        std::size_t first  = kLit;
        std::size_t second = kLit;
        double share       = 0;  ///< of the second, [0, 1]; where it is 0 there is none
    };
    static constexpr std::size_t kLit = ~std::size_t{0};
    [[nodiscard]] Choice choose(dvec3 p) const;
};

/// Fits cascades to `receivers`. `casters` is the light's view of all casters, as fit_to_scene makes it; all windows
/// have its roll, in which the floors and walls of most scenes lie along the texels: then light that grazes them, too,
/// finds contacts where they are.
///
/// The splits go from the least to the greatest depth; of a nearest depth below 1/10000 of the farthest, only the
/// splits take notice as if it were that. `stable` rounds both to quarters of octaves, outwards, so that they stay
/// while the camera moves a little.
[[nodiscard]] Cascades fit_cascades(const CascadeOptions& options, const LightFrame& casters, const View& view,
                                    const Receivers& receivers);

}  // namespace umbra
