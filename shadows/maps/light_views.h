// The maps of one light: which views cover the directions that it sees, and drawing them.
//
//   directional     one orthographic view, fitted to the scene, in the roll about the light's direction of least area
//   point, area     one perspective view fitted to the scene where that fits into a cone of 50 degrees; else six faces
//                   of a cube. Area lights are taken as their centres
//   spot            one view of the cone, shrunk to the scene, and where the scene reaches out of it six faces at
//                   `surround` of the resolution: the spot's factor in the sum is 0 there, S_j is not
//
// Maps reach over their view's border by as much as the filter does, so that no filter ever crosses a cube's seam.
#pragma once

#include <optional>

#include "umbra/shadows/maps/depth_map.h"
#include "umbra/shadows/maps/light_frame.h"

namespace umbra {

/// A map and where it looks from.
struct MapView {
    LightFrame frame;
    DepthMap map;                        ///< of the first surface that the light sees
    std::optional<DepthMap> midpoint{};  ///< halfway in depth between that and the second, where there are two
};

/// Which triangle each sample of a view's map shows that `faces` of `casters` were drawn into, kNoTriangle where none.
/// Draws the map again.
[[nodiscard]] std::vector<TriangleId> owners(const MapView& view, const Casters& casters, Faces faces);

class LightViews {
public:
    /// Half of what the machine has.
    [[nodiscard]] static double half_of_memory();

    struct Options {
        std::string_view method{};  ///< in errors
        int resolution      = 2048;
        DepthFormat format  = DepthFormat::float32;
        Faces faces         = Faces::all;
        bool fit_to_casters = true;
        bool all_depths     = false;  ///< the maps keep how near everything is that they show; otherwise what is nearer
                                      ///< than all that they are fitted to has nearness 1
        bool midpoints      = false;  ///< the views have midpoints, which takes as much memory and time as the maps
        double surround     = 0.5;
        double border       = 2;                 ///< samples by which a map reaches over its view
        double headroom     = 64;                ///< samples' widths by which a bias may move points towards the light
        double memory_limit = half_of_memory();  ///< bytes, for all maps of a light
    };

    LightViews(const Scene& scene, const SceneFacts& facts, const Options& options)
        : options_(options), casters_(scene, facts, options.fit_to_casters) {}

    /// For the next fit. `fit_to_casters` stays as it was made.
    void set_options(const Options& options) { options_ = options; }

    /// Chooses the views of `light` and fits them; their maps are empty. Throws UsageError where the maps take more
    /// than `memory_limit`.
    void fit(LightId light);
    /// Draws the depth of what casts into the maps of all views, and their midpoints.
    void rasterise();

    [[nodiscard]] const std::vector<MapView>& views() const { return views_; }
    /// Which triangle each sample of view k's map shows, kNoTriangle where none. Draws the map again.
    [[nodiscard]] std::vector<TriangleId> owners(std::size_t k) const {
        return umbra::owners(views_[k], casters_, options_.faces);
    }
    /// False where what lies outside a spot's cone was left out; else nothing that casts lies where no view looks.
    [[nodiscard]] bool cover_all() const { return cover_all_; }
    [[nodiscard]] const Scene& scene() const { return casters_.scene(); }
    [[nodiscard]] std::size_t memory_bytes() const;

private:
    void add_view(LightFrame frame, int resolution);
    /// A cleared map, in the memory of a spare one if it can be had.
    [[nodiscard]] DepthMap new_map(int resolution);
    void fit_directional(dvec3 direction);
    void fit_around(const Light& light);
    /// Depth limits of a perspective window about the axis, with no geometry nearer to the light than `nearest`.
    void set_depth(LightFrame& frame, double nearest) const;

    Options options_;
    Casters casters_;
    std::vector<MapView> views_;
    std::vector<DepthMap> spare_;  ///< maps of the last fit, while the next one goes on
    bool cover_all_ = true;
};

}  // namespace umbra
