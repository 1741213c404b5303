// What methods are held against: which reference, and on how many points.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "umbra/bench/run/run.h"

namespace umbra {

/// What the others are held against, and why that is a reference and what it is not.
struct Reference {
    MethodChoice choice;
    bool exact = false;
    std::string note;
};

/// `exact` where it serves the scene, else ray-traced shadows with many samples.
[[nodiscard]] Reference default_reference(const SceneFacts& facts);

/// The reference's answers: for lights without an area at all points of the picture, for area lights at all or at a
/// stratified sample of them. Elsewhere its planes hold guesses (kGuess): ray-traced shadows with many samples, which
/// say where boundaries are and make the reference's picture, and which judge nothing.
struct ReferenceRun {
    MethodRun run;
    std::uint64_t judged = 0, of = 0;  ///< points, of those with a surface; equal where the whole picture is judged
    std::string guess;                 ///< the method of the guesses; empty where there are none
};

/// `wanted`: how many points to judge an area light on; none: the whole picture where that is not too dear, by a rule
/// that depends on the scene and the picture alone, so that figures come out the same on every machine. The sample is
/// one pixel, at random but always the same, out of each square tile. Throws UsageError where the reference does not
/// serve the scene.
[[nodiscard]] ReferenceRun run_reference(const Reference& reference, const Scene& scene, const SceneFacts& facts,
                                         const PointBatch& points, std::optional<std::uint64_t> wanted);

}  // namespace umbra
