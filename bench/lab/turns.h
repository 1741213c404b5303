// Times of several settings on one scene, measured in turns: a machine whose speed drifts favours none of them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "umbra/bench/lab/calibration.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/base/random_bits.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// Milliseconds of wall clock.
[[nodiscard]] double wall_clock_ms();

/// How long `work` takes by a clock of milliseconds.
template <class Work>
double timed_by(const std::function<double()>& clock, const Work& work) {
    const double start = clock();
    work();
    return clock() - start;
}

/// Random orders: permutations by Fisher and Yates, from a counter.
class Shuffler {
public:
    explicit Shuffler(std::uint32_t seed) : counter_(std::uint64_t{seed} << 32) {}
    template <class T>
    void shuffle(std::vector<T>& items) {
        for (std::size_t n = items.size(); n > 1; --n)
            std::swap(items[n - 1], items[((mixed_bits(counter_++) >> 32) * n) >> 32]);
    }

private:
    std::uint64_t counter_;
};

inline constexpr double kPartOfOthers = 0.25;  ///< of TurnOptions::budget_ms

struct TurnOptions {
    int rounds       = 7;     ///< at most, at least 1
    double budget_ms = 3000;  ///< for all settings together, without their first runs
    /// So many of the first settings are to be ranked, and the control. The others take turns with them, but may take kPartOfOthers of
    /// the budget on top, each an equal part: one that takes longer has fewer rounds, or its first run alone.
    std::size_t ranked = ~std::size_t{0};
    std::uint32_t seed = 1;     ///< of the order
    bool share_builds  = true;  ///< false: every setting has a build of its own in each round
    Budget most{};              ///< of each run of a setting: one that takes more has failed
    std::function<void(const std::string&)> progress{};
    /// First runs that have already happened, one a setting (nothing for one that does not serve): they are not run
    /// again. Empty: each setting runs once before the first round.
    std::vector<std::optional<RunTimes>> first{};
    std::function<double()> clock          = wall_clock_ms;
    std::function<void()> calibration_loop = calibration_work;  ///< timed at the begin of each round
};

/// Of one setting: one value a round, all lights together, milliseconds. A setting takes part in the first rounds and
/// then in none, so that samples of two settings with one index are of one round.
struct TurnTimes {
    MethodChoice choice;
    Service service{};
    std::vector<double> build{}, aim{}, look{}, visibility{};
    std::vector<std::vector<double>> light_aim{}, light_visibility{};  ///< [light][round]
    RunTimes cold{};                                                   ///< the first run, kept apart
    std::vector<int> order{};          ///< its position within each round, from 0; the A/A twin has one too
    std::size_t memory_bytes = 0;      ///< of geometry and of the last light
    bool only_cold           = false;  ///< it took so long that the first run is also the one sample
    std::string failed{};              ///< the message of what it threw; its samples up to there are kept
    bool cut = false;                  ///< it failed since a run took more than `most`
};

struct Turns {
    std::vector<TurnTimes> settings;    ///< as given
    std::vector<double> calibration{};  ///< ms of the calibration loop, one a round
    double noise_bar = 0;  ///< of the control's total time; infinite where it took part in fewer than six rounds
    std::optional<std::size_t> control{};  ///< the setting that ran twice a round: the cheapest
    std::optional<TurnTimes> twin{};       ///< its second run of each round
    bool pinned = false;                   ///< each thread stayed on one processor (PinnedThreads)
};

/// Every setting once a round, in an order drawn for each round. Settings of one method that differ only in parameters
/// of later phases than build form a group: in each round they follow one another behind one build, which is new in
/// this round, and each is recorded with the time of that build. The order of the groups is drawn, and that within
/// each. The cheapest setting runs a second time, in a group of its own, as an A/A control.
///
/// Only the phases are inside the clock: not the construction of a method, nor Method::warm_up, nor the end of values,
/// nor the clearing of planes. Each run looks at the points once, and then takes light after light.
///
/// Before the first round each setting runs once (`cold`), in the order given, groups together. It takes part in a
/// round where its time by its last run fits into what is left of its part of the budget, the budget over the number of
/// settings; in the first three rounds also where the round fits into what is left of the whole. Where it never does,
/// its cold run is its only sample.
///
/// A setting that throws keeps the message in `failed`, and the others go on. Throws std::logic_error where `first`
/// is neither empty nor one a setting.
[[nodiscard]] Turns time_in_turns(const PreparedScene& prepared, std::span<const MethodChoice> choices,
                                  const TurnOptions& options);

/// Times of all phases and lights, one a round.
[[nodiscard]] std::vector<double> totals(const TurnTimes& times);

/// `times` of a setting in results.json: median, least, largest, number and samples of each phase, the cold run, and
/// its position in each round. Throws std::logic_error where it has no samples: it does not serve, or failed.
[[nodiscard]] TurnTimesRecord turn_times_record(const TurnTimes& times);

}  // namespace umbra
