// Ladders: families of scenes over one extreme, in geometric steps from harmless to absurd.
//
// A ladder is one function and one line in ladders.def. On each rung `exact` is the truth; a method breaks at the first
// rung where its interior errors exceed a stated share.
#pragma once

#include <span>
#include <string_view>

#include "core/scene.h"

namespace umbra {

struct Ladder {
    std::string_view name;   ///< as typed: "far_from_origin"
    std::string_view title;  ///< "Distance from the origin"
    std::string_view about;  ///< one or two sentences: what grows, and what it hurts
    std::string_view unit;   ///< of a rung's value, as read after the number: "scene sizes"; empty for pure numbers
    std::span<const double> rungs;          ///< harmless first
    Scene (*scene)(double rung) = nullptr;  ///< with lights, camera, picture size; the same bits each time
};

/// Each theme's file in bench/ladders/ defines several: `const Ladder NAME_ladder{...};`
#define LADDER(name) extern const Ladder name##_ladder;
#include "bench/ladders/ladders.def"
#undef LADDER

/// All ladders, in the order of the report.
[[nodiscard]] std::span<const Ladder* const> ladders();

}  // namespace umbra
