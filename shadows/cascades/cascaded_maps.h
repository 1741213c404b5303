// The class of cascaded shadow maps; cascaded_maps.cpp has the recipe.
#pragma once

#include <optional>

#include "umbra/shadows/cascades/cascades.h"
#include "umbra/shadows/maps/light_views.h"
#include "umbra/shadows/method.h"

namespace umbra {

enum class DepthRange : std::uint8_t { scene, visible };
enum class CascadeFilter : std::uint8_t { nearest, pcf };

/// The parameters; cascaded_maps.cpp and map_options.h document each.
struct CascadedMapsOptions : ComparingOptions, SplitOptions {
    DepthRange depth_range = DepthRange::scene;
    CascadeFilter filter   = CascadeFilter::nearest;
};

class CascadedMaps final : public MethodWith<CascadedMapsOptions, BuiltCasters> {
public:
    explicit CascadedMaps(const Settings& settings);
    [[nodiscard]] Service serves(const SceneFacts& facts) const override;
    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override;
    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override;
    /// For a directional light it fits and draws the cascades first, each time, as for a moved camera. The camera is
    /// that of the batch's raster; without one the scene's, with a picture of the scene's size.
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override;
    void blame(const Aimed& aimed, const Looked& looked, std::span<TriangleId> blockers) const override;
    [[nodiscard]] Reason explain(const Aimed& aimed, const Looked& looked, std::size_t i, Given given) const override;

    /// The windows for a batch, of a directional light; nothing casts: none.
    [[nodiscard]] std::optional<Cascades> fit(const Aimed& aimed, const Looked& looked) const;

private:
    /// Views of a light, and which of them are asked for each point.
    struct Lookups;
    /// With maps for all points that ask, or for point `alone`: then a map holds what that point reads, and no more.
    [[nodiscard]] Lookups look_up(const Aimed& aimed, const Looked& looked,
                                  std::optional<std::size_t> alone = {}) const;

    const Bias bias_;
    const Filter filter_;
    const MapMargins room_;
    const LightViews::Options view_options_;  ///< of other lights than directional ones
};

}  // namespace umbra
