// The shadow z-buffer's class; shadow_zbuffer.cpp has the recipe.
#pragma once

#include <optional>

#include "umbra/shadows/maps/map_options.h"
#include "umbra/shadows/method.h"
#include "umbra/shadows/zbuffer/contact_march.h"

namespace umbra {

enum class FilterKind : std::uint8_t { nearest, pcf, pcss };
enum class KeptSurface : std::uint8_t { first, midpoint };

/// The parameters; shadow_zbuffer.cpp and map_options.h document each.
struct ZBufferOptions : ComparingOptions, ViewOptions, SearchOptions {
    DepthFormat depth        = DepthFormat::float32;
    FilterKind filter        = FilterKind::nearest;
    Kernel kernel            = Kernel::grid;
    Rotation rotation        = Rotation::none;
    int samples              = 32;
    Faces faces              = Faces::all;
    KeptSurface surface      = KeptSurface::first;
    int contact_steps        = 0;
    double contact_length    = 0.3;
    double contact_thickness = 0.1;
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
    /// With the angle that discs about a point at world position p are rotated by; `camera` has its pixel.
    [[nodiscard]] Receiver rotated(Receiver receiver, const CameraFrame& camera, dvec3 p) const;

    /// Of the points, if they have one, or traced into `traced`: none where there is no march, or no eye near enough.
    [[nodiscard]] const PointBatch* picture(const PointBatch& points, PointBatch& traced) const;

    Bias bias_;
    ContactMarch contact_;
    std::vector<dvec2> points_;  ///< of discs
    Filter filter_;
    Rotation rotation_ = Rotation::none;
    SoftFilter soft_;              ///< of the light that it is aimed at
    bool finds_blockers_ = false;  ///< filter=pcss
    bool is_soft_        = false;  ///< and the light has an area
    LightViews::Options map_options_;
    std::optional<LightViews> views_;
};

}  // namespace umbra
