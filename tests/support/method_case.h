// One method on one scene, as tests run it.
#pragma once

#include <string_view>

#include "umbra/core/errors/visibility_error.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/tests/support/asked.h"

namespace umbra {

struct MethodCase : Asked {
    const Scene& scene;
    SceneFacts facts = find_facts(scene);

    /// `method`: an info, a choice or text, as Asked takes it.
    template <class Choice>
    MethodCase(const Choice& method, const Scene& s) : Asked(method), scene(s) {}

    [[nodiscard]] Service serves() const { return Asked::serves(facts); }
    [[nodiscard]] Service verdict() const { return umbra::verdict(method(), facts); }
    using Asked::build;
    void build() { build(scene, facts); }
    void prepare(LightId light) {
        build();
        aim(light);
    }
};

inline PointBatch primary(const Scene& scene) {
    return primary_points(RayScene(scene), scene, scene.camera, scene.width, scene.height);
}

/// Points that the light can reach at all: the others are decided in core.
inline bool is_open(const PointBatch& points, LightId light, std::size_t i) {
    return points.facing[light][i] == Facing::partly || points.facing[light][i] == Facing::front;
}

}  // namespace umbra
