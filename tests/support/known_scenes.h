// Small scenes whose S_j is known without any method: by a formula, or by asking every triangle.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "umbra/core/errors/visibility_error.h"
#include "umbra/core/render/points.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

/// S_j at a position of a surface by a formula, where the formula holds there.
using ClosedForm = std::function<std::optional<double>(dvec3 place, LightId light)>;

struct KnownScene {
    Scene scene;
    ClosedForm closed_form;      ///< may be empty
    double approximate_mae = 0;  ///< scenes with area lights: what a method that only approximates them may be off
};

struct NamedScene {
    std::string_view name;
    KnownScene (*make)();
};
[[nodiscard]] const std::vector<NamedScene>& known_scenes();
[[nodiscard]] KnownScene known_scene(std::string_view name);

/// S_j of a hard light by brute force: the segment to the light against every triangle but the point's own, in double.
/// `defined` is 0 where rounding could turn the answer: the segment passes an edge, or a surface, closer than that.
[[nodiscard]] VisibilityPlane brute_force(const Scene& scene, const PointBatch& points, LightId light);

/// The closed form at each point of the batch; `defined` is 0 where it says nothing.
[[nodiscard]] VisibilityPlane by_formula(const KnownScene& known, const PointBatch& points, LightId light);

/// What is known: by brute force for hard lights, by formula for area lights.
[[nodiscard]] VisibilityPlane truth(const KnownScene& known, const PointBatch& points, LightId light);

/// Where the point lies, from its exact name.
[[nodiscard]] dvec3 place(const Scene& scene, const PointBatch& points, std::size_t i);

}  // namespace umbra
