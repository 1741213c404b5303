// S_j of one method at any points, for studies of what S_j is used for.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "umbra/bench/lab/at_work.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// A method, built for one scene and asked for one batch after another; or none, with S_j = 1 where a light is in
/// front. The scene and its facts must outlive this object.
class AskedMethod {
public:
    /// The method must serve the scene. Throws what its `build` throws.
    AskedMethod(const Scene& scene, const SceneFacts& facts, const std::optional<MethodChoice>& choice);

    /// One plane a light, as AskVisibility wants it: aim and visibility of each light. `points` is faced to all lights.
    [[nodiscard]] std::vector<VisibilityPlane> operator()(const PointBatch& points);
    /// The same of several batches, [batch][light]: aims at each light once.
    [[nodiscard]] std::vector<std::vector<VisibilityPlane>> of(std::span<const PointBatch* const> batches);

    /// Pairs of point and light that the method was asked for in the last call.
    [[nodiscard]] std::size_t asked() const { return asked_; }

private:
    const Scene* scene_;
    std::optional<MethodAtWork> work_;
    std::size_t asked_ = 0;
};

}  // namespace umbra
