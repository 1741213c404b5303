// Ladders: families of scenes over one extreme, in geometric steps from harmless to absurd.
//
// A ladder is one function and one line in ladders.def, or a file (ladder_file.h). On each rung `exact` is the truth; a method breaks at the first
// rung where its interior errors exceed a stated fraction (bench/ladders/ladder_run.h).
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/image/image.h"
#include "umbra/core/scene/scene.h"

namespace umbra {

struct Ladder {
    std::string name;           ///< as typed: "far_from_origin"
    std::string title;          ///< "Distance from the origin"
    std::string about;          ///< one or two sentences: what grows, and what it hurts
    std::string unit{};         ///< of a rung's value, as read after the number: "scene sizes"; empty for pure numbers
    std::vector<double> rungs;  ///< harmless first
    std::function<Scene(double rung)> scene;  ///< with lights, camera, picture size; the same bits each time

    /// Ladders over the sum, where S_j is correct: the error in the picture of that rung (scene-linear R G B,
    /// rendered with the true S_j); empty where there is none. Null: S_j is compared, method by method.
    std::string (*wrong_sum)(double rung, const Scene& scene, const Image& linear) = nullptr;
};

/// Each theme's file in bench/ladders/ defines several: `const Ladder NAME_ladder{...};`
#define LADDER(name) extern const Ladder name##_ladder;
#include "umbra/bench/ladders/ladders.def"
#undef LADDER

/// All ladders, in the order of the report.
[[nodiscard]] std::span<const Ladder* const> ladders();

/// Throws UsageError, naming the ladders that there are.
[[nodiscard]] const Ladder& find_ladder(std::string_view name);

}  // namespace umbra
