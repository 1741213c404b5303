// The shadow z-buffer's class; shadow_zbuffer.cpp has the recipe.
#pragma once

#include <optional>

#include "umbra/shadows/method.h"
#include "umbra/shadows/zbuffer/depth_lookup.h"

namespace umbra {

enum class FilterKind : std::uint8_t { nearest, pcf };
enum class Fit : std::uint8_t { casters, scene };

/// The parameters, as docs in shadow_zbuffer.cpp say.
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
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> who) const override;
    [[nodiscard]] std::size_t memory_bytes() const override;

private:
    [[nodiscard]] Facet make_facet(TriangleId t, bool flipped) const;
    /// Calls body(point, facet, place) for the points that face the light, in parallel.
    template <class Body>
    void for_each_facet(const PointBatch& points, LightId light, const Body& body) const;
    /// Writes S_j of one point; false where no view covers it.
    [[nodiscard]] bool look_up(const Facet& facet, dvec3 p, Facing facing, const Light& light, float& s) const;

    Bias bias_;
    Filter filter_;
    LightViews::Options map_options_;
    std::optional<LightViews> views_;
};

}  // namespace umbra
