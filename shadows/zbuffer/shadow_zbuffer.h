// The shadow z-buffer's class; shadow_zbuffer.cpp has the recipe.
#pragma once

#include <optional>

#include "umbra/shadows/maps/depth_lookup.h"
#include "umbra/shadows/method.h"

namespace umbra {

enum class FilterKind : std::uint8_t { nearest, pcf, pcss };
enum class Fit : std::uint8_t { casters, scene };

/// The parameters; shadow_zbuffer.cpp documents each.
struct ZBufferOptions {
    int resolution       = 2048;
    DepthFormat depth    = DepthFormat::float32;
    BiasMode bias        = BiasMode::automatic;
    double constant      = 0;
    double slope         = 0;
    double normal_offset = 0;
    FilterKind filter    = FilterKind::nearest;
    int radius           = 1;
    bool bilinear        = true;
    int samples          = 32;
    double search        = 0.1;
    Faces faces          = Faces::all;
    Fit fit              = Fit::casters;
    double surround      = 0.5;
};

class ShadowZBuffer final : public Method {
public:
    void configure(const Settings& settings) override;
    [[nodiscard]] Service serves(const SceneFacts& facts) const override;
    void build(const Scene& scene, const SceneFacts& facts) override;
    void aim(LightId light) override;
    void visibility(const PointBatch& points, LightId light, Visibility out) const override;
    /// Whose depth the map holds in the texel that blocks the point, the nearest of several. Draws the maps again.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> blockers) const override;
    [[nodiscard]] std::size_t memory_bytes() const override;

private:
    Bias bias_;
    Filter filter_;
    SoftFilter soft_;              ///< of the light that it is aimed at
    bool finds_blockers_ = false;  ///< filter=pcss
    bool is_soft_        = false;  ///< and the light has an area
    LightViews::Options map_options_;
    std::optional<LightViews> views_;
};

}  // namespace umbra
