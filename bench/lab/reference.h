// The truth of a scene: which reference methods are compared with, and at how many points.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/run.h"

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

/// Indices of pixels with a surface: one, at random but always the same, out of each square tile that has any; about
/// `wanted` of them where all have. `wanted` > 0; the batch has a raster.
[[nodiscard]] std::vector<std::uint32_t> stratified_sample(const PointBatch& points, std::uint64_t wanted);

/// At how many of `all` points the reference answers for area lights where nobody says: at all of them, or at a sample
/// where the triangles, or the steps of a point that the method has counted (Visibility::steps), promise minutes.
[[nodiscard]] std::uint64_t affordable_points(std::uint64_t all, std::size_t triangles, double steps_of_a_point);

/// `wanted`: how many points to judge an area light on; none: `affordable_points`, which depends on the scene and the
/// picture alone, so that figures come out the same on every machine. The sample is
/// one pixel, at random but always the same, out of each square tile. `work`: as begin_run takes it. Throws UsageError
/// where the reference does not serve the scene, and CutShort where it takes more than the budget.
[[nodiscard]] ReferenceRun run_reference(const Reference& reference, const Scene& scene, const SceneFacts& facts,
                                         const PointBatch& points, std::optional<std::uint64_t> wanted,
                                         std::optional<LightId>* at = nullptr, const Budget& budget = {},
                                         std::shared_ptr<MethodAtWork> work = nullptr);

/// A method that threw or was cut short, for the record.
struct Failure {
    std::string method;            ///< as typed
    std::optional<LightId> light;  ///< none: before any light, or between them
    std::string message;
    bool cut = false;  ///< by its budget
};
/// Of the exception that is being handled. Only in a catch block.
[[nodiscard]] Failure failure(const MethodChoice& choice, std::optional<LightId> light);

/// The answers that others are compared with.
struct Truth {
    Reference reference;
    ReferenceRun ran;
    std::optional<Failure> failed{};  ///< of the reference that this one stands in for
};

struct TruthOptions {
    std::optional<std::string> reference{};              ///< as typed; none: default_reference
    std::optional<std::uint64_t> points{};               ///< as run_reference takes it
    Budget budget{};                                     ///< of a reference that may be replaced
    std::function<void(const std::string&)> progress{};  ///< receives "reference METHOD"; may be empty
    /// Where answers are kept from one run to the next; may be empty. `find` fills in planes and what is judged.
    std::function<bool(const Reference& of, ReferenceRun& ran)> find{};
    std::function<void(const Reference& of, const ReferenceRun& ran)> keep{};
    /// As begin_run takes it; may be empty.
    std::function<std::shared_ptr<MethodAtWork>(const MethodChoice& reference)> at_work{};
};

/// The truths of one scene, found when they are first asked for. A reference that throws, or takes more than the budget,
/// is replaced by a substitute that is not exact, unless the options name it. What is given must outlive this object.
/// Throws UsageError, and what a reference throws that cannot be replaced.
class Truths {
public:
    Truths(const Scene& scene, const SceneFacts& facts, const PointBatch& points, TruthOptions options);

    /// Of the options' reference.
    [[nodiscard]] const Truth& main();
    /// What a method is compared with: under lights with an area, one that measures the same as it does.
    [[nodiscard]] const Truth& of(const Method& method);

private:
    [[nodiscard]] Truth found(Reference reference, bool replaceable) const;

    const Scene& scene_;
    const SceneFacts& facts_;
    const PointBatch& points_;
    TruthOptions options_;
    std::optional<Truth> main_;
    std::map<Measure, Truth> others_;
};

}  // namespace umbra
