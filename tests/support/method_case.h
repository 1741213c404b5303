// One method on one scene, as tests run it.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "umbra/core/errors/visibility_error.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/facts.h"
#include "umbra/shadows/method.h"

namespace umbra {

struct MethodCase {
    const Scene& scene;
    SceneFacts facts = find_facts(scene);
    std::unique_ptr<Method> method;

    MethodCase(const MethodInfo& info, const Scene& s) : scene(s), method(info.make()) {}
    MethodCase(std::string_view choice, const Scene& s) : scene(s) {
        const MethodChoice parsed = parse_method(choice);
        method                    = parsed.make();
    }

    [[nodiscard]] Service serves() const { return method->serves(facts); }
    void prepare(LightId light) {
        method->build(scene, facts);
        method->aim(light);
    }
    [[nodiscard]] VisibilityPlane visibility(const PointBatch& points, LightId light) const {
        VisibilityPlane plane(points.size());
        method->visibility(points, light, plane.out());
        return plane;
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
