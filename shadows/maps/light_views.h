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

#include <memory>
#include <mutex>
#include <optional>

#include "umbra/shadows/maps/depth_map.h"
#include "umbra/shadows/maps/light_frame.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// A map and where it looks from.
struct MapView {
    LightFrame frame;
    DepthMap map;                        ///< of the first surface that the light sees
    std::optional<DepthMap> midpoint{};  ///< halfway in depth between that and the second, where there are two
};

/// Which triangle each of some samples of a view's map shows that `faces` of `casters` were drawn into, kNoTriangle where
/// none. They ascend, row by row. Draws the map again.
[[nodiscard]] std::vector<TriangleId> owners(const MapView& view, const SelectedCasters& casters, Faces faces,
                                             std::span<const std::size_t> samples);
/// The same of one sample: draws a few samples around it.
[[nodiscard]] TriangleId owner(const MapView& view, const SelectedCasters& casters, Faces faces, ivec2 sample);
/// Draws the triangles that reach the samples at most `around` from this one in x and in y. These become as in the
/// whole map; others have some of the triangles that they would show.
void draw_around(MapView& view, const SelectedCasters& casters, Faces faces, ivec2 sample, int around);

/// Keeps the maps of a LightViews that ends, so that the next one draws in their memory: the system clears new memory
/// page by page, which takes longer than drawing a small scene.
class SpareMaps {
public:
    /// Keeps these, and returns the ones that it kept before. Any thread.
    [[nodiscard]] std::vector<MapView> exchange(std::vector<MapView> views) {
        const std::lock_guard lock(mutex_);
        kept_.swap(views);
        return views;
    }

private:
    std::mutex mutex_;
    std::vector<MapView> kept_;  ///< of one light at most
};

/// Whether maps are fitted to Casters or to the scene.
enum class Fit : std::uint8_t { casters, scene };

/// Options of methods whose maps are LightViews alone (map_options.h).
struct ViewOptions {
    Fit fit         = Fit::casters;
    double surround = 0.5;
};

/// The result of `build` for methods with depth maps: the casters.
class BuiltCasters final : public Built {
public:
    BuiltCasters(const Scene& of, const SceneFacts& its_facts, const ViewOptions& options = {})
        : Built(of, its_facts), casters(of, its_facts, options.fit == Fit::casters) {}
    [[nodiscard]] std::size_t memory_bytes() const override { return casters.memory_bytes(); }
    const Casters casters;
    const std::shared_ptr<SpareMaps> spare = std::make_shared<SpareMaps>();
};

/// The result of `aim`: the views of one light, fitted and drawn.
class LightViews : public Aimed {
public:
    /// Half of the machine's memory, bytes.
    [[nodiscard]] static double half_of_memory();

    struct Options {
        std::string_view method{};  ///< in errors
        int resolution      = 2048;
        DepthFormat format  = DepthFormat::float32;
        Faces faces         = Faces::all;
        bool all_depths     = false;  ///< otherwise surfaces nearer than all that is fitted have nearness 1
        bool midpoints      = false;  ///< the views have midpoints, which takes as much memory and time as the maps
        double surround     = 0.5;
        double border       = 2;                 ///< samples by which a map reaches over its view
        double headroom     = 64;                ///< samples' widths by which a bias may move points towards the light
        double memory_limit = half_of_memory();  ///< bytes, for all maps of a light
    };

    /// `from` is a BuiltCasters. Throws UsageError where maps and casters take more than `memory_limit`.
    LightViews(const Built& from, LightId at, const Options& options);
    ~LightViews() override;

    [[nodiscard]] const std::vector<MapView>& views() const { return views_; }
    /// Which triangle each sample of view k's map shows, kNoTriangle where none. Draws the map again.
    [[nodiscard]] std::vector<TriangleId> owners(std::size_t k, std::span<const std::size_t> samples) const {
        return umbra::owners(views_[k], casters_, faces_, samples);
    }
    [[nodiscard]] TriangleId owner(std::size_t k, ivec2 sample) const {
        return umbra::owner(views_[k], casters_, faces_, sample);
    }
    /// False where the outside of a spot's cone was left out; else all casters are in some view.
    [[nodiscard]] bool cover_all() const { return cover_all_; }
    [[nodiscard]] std::size_t memory_bytes() const override;

private:
    void rasterise();

    const SelectedCasters casters_;
    const std::shared_ptr<SpareMaps> spare_;
    const Faces faces_;
    std::vector<MapView> views_;
    bool cover_all_ = true;
};

}  // namespace umbra
