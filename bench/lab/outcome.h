// What a method made of a scene: its answers, and its errors with their causes beside the truth.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "umbra/bench/lab/reference.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/errors/error_classes.h"
#include "umbra/core/errors/noise.h"
#include "umbra/core/errors/shadow_edges.h"
#include "umbra/core/errors/visibility_error.h"

namespace umbra {

/// One light of one method compared with the reference.
struct Explained {
    ClassPlane classes;
    VisibilityError error;
    std::optional<EdgeDisplacement> displacement;
    std::optional<PenumbraWidth> penumbra_width;  ///< area lights only
    std::optional<Noise> noise;                   ///< where a meter was given
};

/// Sorts every point into its class and counts them; measures edges and penumbrae. `meter`, fed with runs of the same
/// method with other seeds, tells noise from other errors; none: no point is of class `noise`. Both runs are of this
/// scene and batch, and serve it; their methods are asked again where interior errors need a name. `named`: whether
/// they get one, and edges and penumbrae are measured.
[[nodiscard]] Explained explain(const Scene& scene, const PointBatch& points, LightId light, const MethodRun& run,
                                const MethodRun& reference, const NoiseMeter* meter = nullptr, bool named = true);

/// The setting with another seed, `step` farther, which must be one that the method has: within the range of its seed.
[[nodiscard]] MethodChoice with_seed(MethodChoice choice, std::int64_t step);

/// Runs of a method with other seeds than its own, for its noise. The relative error of a variance from K runs is
/// sqrt(2 / (K - 1)) at one point, and nothing over the thousands of a penumbra.
inline constexpr int kNoiseRuns = 8;

/// One meter a light, fed with `runs` runs; empty for methods that have no seed (their answers are always the same)
/// and for lights without an area (all their samples are one point).
/// `work` is on this scene; what it has built is shared.
[[nodiscard]] std::vector<std::optional<NoiseMeter>> noise_runs(const MethodAtWork& work, const Scene& scene,
                                                                const PointBatch& points, int runs = kNoiseRuns);

/// What came of one method. Without errors where it does not serve, or has failed.
struct Outcome {
    MethodRun run;
    std::vector<Explained> explained{};  ///< [light]
    std::optional<Failure> failed{};
};

/// How an outcome is found.
struct Trial {
    /// The answers; empty: those of run_method, each phase once. `at` is the light that is being worked on.
    std::function<MethodRun(std::optional<LightId>& at)> run{};
    std::function<const MethodRun&(const MethodRun& run)> truth{};  ///< what the run is compared with
    int noise_runs = kNoiseRuns;                                    ///< 0: noise is not told from other errors
    bool named     = true;                                          ///< as of `explain`
    Budget budget{};                                   ///< of the run, and again of what is asked behind it
    std::function<void(const Outcome& found)> then{};  ///< what else asks the method; may be empty
};

/// Runs the method, compares it with the truth, and hands that to `trial.then`. Whatever is thrown meanwhile is the
/// method's failure, but for InputError: a file that cannot be written is no fault of a method.
[[nodiscard]] Outcome outcome(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts,
                              const PointBatch& points, const Trial& trial);

}  // namespace umbra
