// Running a method on a scene: its phases, timed apart, and the S_j planes that come out.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "umbra/bench/lab/at_work.h"
#include "umbra/core/errors/visibility_error.h"
#include "umbra/core/render/points.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// Throws std::logic_error, naming the method, where a plane that it wrote holds values outside [0, 1], or an answer
/// for a point that is not asked for.
void check_contract(std::string_view name, const VisibilityPlane& plane, const PointBatch& points, LightId light);

/// One run of all phases, milliseconds of wall clock; aim and visibility by light.
struct RunTimes {
    double build = 0;
    std::vector<double> aim{};         ///< [light]
    double look = 0;                   ///< of all batches of points, each once for all lights
    std::vector<double> visibility{};  ///< [light]

    [[nodiscard]] double aims() const;  ///< of all lights
    [[nodiscard]] double visibilities() const;
    [[nodiscard]] double all() const;  ///< of all phases and lights
};

/// What one method made of one scene. Where it does not serve, only `choice` and `service` mean something.
struct MethodRun {
    MethodChoice choice;
    Service service{};
    RunTimes times{};
    std::size_t memory_bytes = 0;                     ///< of geometry and of the last light
    std::size_t points_bytes = 0, device_bytes = 0;   ///< of the points; on a device
    std::vector<VisibilityPlane> planes{};            ///< [light]
    bool is_coloured = false;                         ///< planes have three channels
    std::vector<std::vector<std::uint8_t>> judged{};  ///< [light][point] of a reference: 0 where its value only finds
                                                      ///< edges and judges nothing; empty: every point judges
    std::shared_ptr<MethodAtWork> work{};             ///< to be asked further

    /// judged[light], or empty.
    [[nodiscard]] std::span<const std::uint8_t> judged_points(LightId light) const {
        return judged.empty() ? std::span<const std::uint8_t>{} : judged[light];
    }

    /// Share of the points that S_j is asked for (any light in front) that it is given for, [0, 1]; nothing where none
    /// is.
    [[nodiscard]] std::optional<double> coverage(const PointBatch& points) const;
};

/// Runs all phases once, for all lights. Throws std::logic_error if the method breaks its contract (values outside
/// [0, 1], or an answer for points that it must leave alone): a picture of such values would be worse than none. Throws
/// what the method throws, and CutShort where it takes more than the budget, which stays the limit of `work`; `at`, if
/// given, then says which light it was about, none for the phases before.
[[nodiscard]] MethodRun run_method(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts,
                                   const PointBatch& points, std::optional<LightId>* at = nullptr,
                                   const Budget& budget = {});

/// The phase of the points, where it does not look at these yet: adds to `run.times.look`. `points` must outlive the
/// next one.
void look_at(MethodRun& run, const PointBatch& points);

/// The phases of one light, and of the points where it does not look at these yet: adds to `run`, whose method has been
/// built. `points` must outlive the next call. `answer_light` is that without the aim, which `run.work` has.
void answer_light(MethodRun& run, const PointBatch& points, LightId light);
void run_light(MethodRun& run, const PointBatch& points, LightId light);

/// What the values of a run hold, into the run.
void note_memory(MethodRun& run);

/// A run of a setting whose phases are still to come: `work` and `service` are there. `work`: one of this setting that
/// may have built already; none: a new one.
[[nodiscard]] MethodRun begin_run(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts,
                                  const Budget& budget = {}, std::shared_ptr<MethodAtWork> work = nullptr);

/// Builds, where `work` has not.
void run_build(MethodRun& run);
/// All phases of a run that has begun, and what its values hold then.
void run_phases(MethodRun& run, const PointBatch& points, std::size_t lights, std::optional<LightId>* at = nullptr);

}  // namespace umbra
