// The class of cascaded shadow maps; cascaded_maps.cpp has the recipe.
#pragma once

#include <optional>

#include "umbra/shadows/cascades/cascades.h"
#include "umbra/shadows/maps/light_views.h"
#include "umbra/shadows/maps/map_options.h"
#include "umbra/shadows/method.h"

namespace umbra {

enum class DepthRange : std::uint8_t { scene, visible };
enum class CascadeFilter : std::uint8_t { nearest, pcf };

/// The parameters; cascaded_maps.cpp and map_options.h document each.
struct CascadedMapsOptions : ComparingOptions {
    int cascades           = 4;
    Splits splits          = Splits::practical;
    double lambda          = 0.5;
    DepthRange depth_range = DepthRange::scene;
    CascadeWindow window   = CascadeWindow::receivers;
    bool stable            = false;
    double blend           = 0;
    CascadeFilter filter   = CascadeFilter::nearest;
};

class CascadedMaps final : public Method {
public:
    void configure(const Settings& settings) override;
    [[nodiscard]] Service serves(const SceneFacts& facts) const override;
    void build(const Scene& scene, const SceneFacts& facts) override;
    void aim(LightId light) override;
    /// Of a directional light it fits and draws the cascades first, each time: that is what a moved camera costs.
    /// The camera is that of the batch's raster; without one the scene's, with a picture of the scene's size.
    void visibility(const PointBatch& points, LightId light, Visibility out) const override;
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override;
    /// With the maps of the cascades, which `visibility` holds while it runs.
    [[nodiscard]] std::size_t memory_bytes() const override;

    /// The windows for a batch, of the directional light that it is aimed at; nothing casts: none.
    [[nodiscard]] std::optional<Cascades> fit(const PointBatch& points, LightId light) const;

private:
    /// Views of a light, and which of them are asked for each point.
    struct Lookups;
    [[nodiscard]] Lookups look_up(const PointBatch& points, LightId light) const;

    CascadedMapsOptions options_;
    CascadeOptions cascade_options_;
    LightViews::Options view_options_;
    Bias bias_;
    Filter filter_;
    const Scene* scene_ = nullptr;
    bool is_sun_        = false;      ///< the light that it is aimed at is directional
    std::optional<Casters> casters_;  ///< for directional lights, where there is one
    std::optional<LightFrame>
        window_;  ///< of all that casts, seen by the light that it is aimed at, where something does
    std::optional<LightViews> views_;  ///< for other lights, where there is one
};

}  // namespace umbra
