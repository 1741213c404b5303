// The maps of one light, as methods with depth maps make them, with all that they refer to.
#pragma once

#include "umbra/core/scene/facts.h"
#include "umbra/shadows/maps/light_views.h"

namespace umbra {

/// `scene` must outlive it. Throws as LightViews does.
struct DrawnViews {
    DrawnViews(const Scene& scene, const LightViews::Options& options, bool fit_to_casters = true, LightId light = 0)
        : facts(find_facts(scene)),
          built(scene, facts, {.fit = fit_to_casters ? Fit::casters : Fit::scene}),
          aimed(built, light, options) {}

    [[nodiscard]] const std::vector<MapView>& views() const { return aimed.views(); }
    [[nodiscard]] std::size_t memory_bytes() const { return built.memory_bytes() + aimed.memory_bytes(); }

    const SceneFacts facts;
    const BuiltCasters built;
    const LightViews aimed;
};

}  // namespace umbra
