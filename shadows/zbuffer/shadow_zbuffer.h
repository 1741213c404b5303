// The shadow z-buffer as a class, for those who want many biases from one map; all others ask methods.h's list for it.
#pragma once

#include <optional>

#include "umbra/shadows/method.h"
#include "umbra/shadows/zbuffer/depth_lookup.h"

namespace umbra {

class ShadowZBuffer final : public Method {
public:
    explicit ShadowZBuffer(const Settings& settings);

    [[nodiscard]] Service serves(const SceneFacts& facts) const override;
    void build(const Scene& scene, const SceneFacts& facts) override;
    void aim(LightId light) override;
    void visibility(const PointBatch& points, LightId light, std::span<float> s,
                    std::span<std::uint8_t> defined) override;
    /// Whose depth the map holds in the sample that blocks the point, the nearest of several. Draws the maps again.
    void blame(const PointBatch& points, LightId light, std::span<TriangleId> who) override;
    [[nodiscard]] std::size_t memory_bytes() const override;

    /// Another bias for the maps that there are. Its normal offset must not be larger than the one it was made with,
    /// which the maps' borders were drawn for.
    void set_bias(const Bias& bias) { bias_ = bias; }

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
