// One scene of a sweep: its cells and times, found where they have been computed before, computed where not.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/lab/turns.h"
#include "umbra/bench/sweep/cell.h"
#include "umbra/bench/sweep/cell_store.h"
#include "umbra/bench/sweep/sweep_results.h"

namespace umbra {

/// Of one run of time_in_turns.
struct TimedTogether {
    std::vector<std::optional<TurnTimesRecord>> settings{};  ///< as given; none for one that does not serve or failed
    std::optional<SweptTurnsRecord> turns{};                 ///< none where nothing was timed

    [[nodiscard]] double noise_bar() const;  ///< as of Turns
};

/// Quality cells and times of one scene. Quality is the same on every machine; times are of this one and are found
/// again only where machine, threads and code are the same. One thread.
class SceneLab {
public:
    /// Loads the scene. `store` must outlive this. Throws InputError.
    SceneLab(const std::filesystem::path& file, CellOptions options, const CellStore& store);
    /// The same scene with the same options, in pictures of another size.
    SceneLab(const SceneLab& other, const Size& size);

    [[nodiscard]] const Scene& scene() const { return own_->scene(); }
    [[nodiscard]] Size size() const;  ///< of the pictures
    [[nodiscard]] CellView& view(int view);
    [[nodiscard]] const SceneFacts& facts() const { return own_->facts(); }
    /// `reference` of the record of view 0.
    [[nodiscard]] ReferenceRecord reference();
    /// Frees what a view holds; its cells stay on disk.
    void release(int view) { views_.erase(view); }

    [[nodiscard]] bool has_cell(const MethodChoice& choice, int view);
    /// Settings of one method and build that follow one another cost one build. A cell that failed for want of
    /// memory, or that a budget cut short, is not kept: it is computed again when it is asked for.
    [[nodiscard]] Cell cell(const MethodChoice& choice, int view);
    [[nodiscard]] std::size_t computed() const { return computed_; }  ///< cells that were not found

    /// The fastest of `runs` runs of a setting on view 0 at least, phase by phase, alone: a price, not a time to compare
    /// closely. It is found where runs on this machine have paid it. Nothing where the setting does not serve, or failed.
    [[nodiscard]] std::optional<RunTimes> price(const MethodChoice& choice, int runs = 1);

    /// Whether one run of a setting takes longer than so many seconds: by its price where that is known, otherwise by a
    /// run that is cut short behind them, and is its price where it is not.
    [[nodiscard]] bool takes_longer(const MethodChoice& choice, double seconds);

    /// Seconds that were spent on looking at a setting, in this run and in those before, as their callers have said.
    [[nodiscard]] double spent_on(const MethodChoice& choice);
    void spend_on(const MethodChoice& choice, double seconds);

    /// Times of settings that took turns with one another. They are found where a run on this machine timed all of
    /// these together; otherwise all of them are timed now, also those that an earlier run has timed among others: a
    /// ratio of times from two runs would say as much of the machine as of the settings. Where the noise bar is above
    /// `most_noise`, what is found is timed now, and what is timed is timed once more; the quieter one is kept.
    [[nodiscard]] TimedTogether times(std::span<const MethodChoice> choices, TurnOptions options,
                                      double most_noise = std::numeric_limits<double>::infinity());
    /// What times() finds.
    [[nodiscard]] std::optional<TimedTogether> stored_times(std::span<const MethodChoice> choices, double most_noise);

    /// Prices and times that the store has already are measured anew.
    void measure_anew() { anew_ = true; }

    /// The key of what was measured on this machine: `kind` is "time", "price", "longer" or "spent".
    [[nodiscard]] std::string machine_key(const std::string& kind, const MethodChoice& choice);

private:
    [[nodiscard]] std::vector<std::string> keys_of(const MethodChoice& choice, int view_number);
    /// Whether what this machine measured need not be measured anew.
    [[nodiscard]] bool is_fresh(const std::string& key) const { return !anew_ || measured_here_.contains(key); }

    std::shared_ptr<OwnScene> own_;
    std::filesystem::path file_;
    CellOptions options_;
    const CellStore& store_;
    std::map<int, CellView> views_;
    std::size_t computed_ = 0;
    bool anew_            = false;
    std::set<std::string> measured_here_;  ///< keys
};

/// By method, then by what is built, so that builds are shared; the order of the methods stays.
[[nodiscard]] std::vector<MethodChoice> by_build(std::span<const MethodChoice> choices);

}  // namespace umbra
