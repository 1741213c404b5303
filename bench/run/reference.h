// Which reference methods are compared with, and at how many points.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "umbra/bench/run/run.h"

namespace umbra {

/// The substitute where no reference serves, or where one takes too long at every point.
inline constexpr std::string_view kStandIn = "ray_traced@best";

/// What the others are compared with, why that is a reference, and what it is not.
struct Reference {
    MethodChoice choice;
    bool exact = false;
    std::string note;
};

/// The first method of the list that may be a reference and serves the scene, else a substitute that is not exact.
/// Its answers are of the given measure.
[[nodiscard]] Reference default_reference(const SceneFacts& facts, Measure measure = Measure::area);

/// The reference's answers: at all points of the picture for lights without an area; for area lights at all points, or
/// at a stratified sample of them. Elsewhere its planes hold values of another method (kStandIn), which
/// locate shadow edges and make the reference's picture, and are never compared (MethodRun::judged).
struct ReferenceRun {
    MethodRun run;
    std::uint64_t judged = 0, of = 0;  ///< points, of those with a surface; equal where the whole picture is judged
    std::string stand_in;              ///< the other method, as typed; empty where every point is judged
};

/// At how many of `all` points the reference answers for area lights where nobody says: at all of them, or at a sample
/// where the triangles, or the steps of a point that the method has counted (Visibility::steps), promise minutes.
[[nodiscard]] std::uint64_t affordable_points(std::uint64_t all, std::size_t triangles, double steps_of_a_point);

/// `wanted`: how many points to judge an area light on; none: `affordable_points`, which depends on the scene and the
/// picture alone, so that figures come out the same on every machine. The sample is
/// one pixel, at random but always the same, out of each square tile. Throws UsageError where the reference does not
/// serve the scene.
[[nodiscard]] ReferenceRun run_reference(const Reference& reference, const Scene& scene, const SceneFacts& facts,
                                         const PointBatch& points, std::optional<std::uint64_t> wanted,
                                         std::optional<LightId>* at = nullptr);

/// A method that threw, for the record.
struct Failure {
    std::string method;            ///< as typed
    std::optional<LightId> light;  ///< none: before any light
    std::string message;
};

/// As run_reference. Where the reference throws, `reference` becomes a substitute that is not exact and is run instead;
/// then returns why. Throws what the substitute throws.
struct TruthRun {
    ReferenceRun ran;
    std::optional<Failure> failed;
};
[[nodiscard]] TruthRun run_reference_or_substitute(Reference& reference, const Scene& scene, const SceneFacts& facts,
                                                   const PointBatch& points, std::optional<std::uint64_t> wanted);

}  // namespace umbra
