#include "umbra/bench/lab/turns.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/lab/pinned_threads.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

constexpr std::size_t kFewestRounds = 3;  ///< those that the whole budget pays for

/// One thing that takes turns: a setting, or the control's twin.
struct Entry {
    std::size_t setting;
    bool twin     = false;
    bool unknown  = false;  ///< its first run is still to come
    bool playing  = true;
    double spent  = 0;  ///< ms, in rounds
    double latest = 0;  ///< ms of its latest run
    std::vector<RunTimes> runs{};
    std::vector<int> order{};
};

using Group = std::vector<std::size_t>;  ///< indices of entries that share a build

class Schedule {
public:
    Schedule(const PreparedScene& prepared, const TurnOptions& options, Turns& turns)
        : prepared_(prepared), options_(options), turns_(turns), dice_(options.seed), plane_(prepared.points.size()) {}

    /// The first run of each setting, or what is known of it.
    void run_cold() {
        if (!options_.first.empty() && options_.first.size() != turns_.settings.size())
            throw std::logic_error("first runs are given, but not one a setting");
        for (std::size_t k = 0; k < turns_.settings.size(); ++k) {
            TurnTimes& t = turns_.settings[k];
            try {
                t.service = verdict(*t.choice.make(), prepared_.facts);
            } catch (const UsageError& e) {  // its settings contradict one another
                t.service = {How::not_at_all, e.what()};
                t.failed  = e.what();
            }
            if (!t.service) continue;
            entries_.push_back({k});
            if (!options_.first.empty() && options_.first[k])
                keep_cold(entries_.back(), *options_.first[k]);
            else
                entries_.back().unknown = true;
        }
        for (const Group& group : groups([](const Entry& e) { return e.unknown; })) run_group(group, true);
        const auto ranked =
            static_cast<std::size_t>(std::ranges::count_if(entries_, [&](const Entry& e) { return is_ranked(e); }));
        share_           = options_.budget_ms / static_cast<double>(std::max<std::size_t>(ranked, 1));
        share_of_others_ = kPartOfOthers * options_.budget_ms /
                           static_cast<double>(std::max<std::size_t>(entries_.size() - ranked, 1));
        std::erase_if(entries_, [](const Entry& e) { return !e.playing; });
    }

    void add_control() {
        if (entries_.empty()) return;
        const auto cheapest = std::min_element(entries_.begin(), entries_.end(),
                                               [](const Entry& a, const Entry& b) { return a.latest < b.latest; });
        Entry twin{cheapest->setting, true};
        twin.latest    = cheapest->latest;
        turns_.control = cheapest->setting;
        turns_.twin    = TurnTimes{choice_of(*cheapest), turns_.settings[cheapest->setting].service};
        entries_.push_back(std::move(twin));
    }

    void run_rounds() {
        for (int round = 0; round < std::max(1, options_.rounds); ++round) {
            choose(static_cast<std::size_t>(round));
            std::vector<Group> order = groups([](const Entry& e) { return e.playing; });
            if (order.empty()) return;
            tell(fmt::format("round {} of {}", round + 1, options_.rounds));
            turns_.calibration.push_back(timed_by(options_.clock, options_.calibration_loop));
            for (Group& group : order) dice_.shuffle(group);
            dice_.shuffle(order);
            int position = 0;
            for (const Group& group : order) {
                for (const std::size_t e : group) entries_[e].order.push_back(position++);
                run_group(group, false);
            }
        }
    }

    /// Moves what was measured into the result.
    void finish() {
        for (Entry& e : entries_) {
            TurnTimes& t = e.twin ? *turns_.twin : turns_.settings[e.setting];
            t.order      = std::move(e.order);
            t.order.resize(std::min(t.order.size(), e.runs.size()));  // it may have failed within a round
            if (e.runs.empty() && t.failed.empty() && !e.twin) {
                e.runs.push_back(t.cold);
                t.only_cold = true;
            }
            keep_samples(t, e.runs);
        }
        Ratio control;
        if (turns_.control && !turns_.settings[*turns_.control].only_cold)
            control = paired_ratio(totals(*turns_.twin), totals(turns_.settings[*turns_.control]));
        turns_.noise_bar = noise_bar(control);
    }

private:
    void keep_samples(TurnTimes& t, const std::vector<RunTimes>& runs) const {
        const std::size_t lights = prepared_.scene.lights.size();
        t.light_aim.resize(lights);
        t.light_visibility.resize(lights);
        for (const RunTimes& run : runs) {
            t.build.push_back(run.build);
            t.aim.push_back(run.aims());
            t.look.push_back(run.look);
            t.visibility.push_back(run.visibilities());
            for (std::size_t j = 0; j < lights; ++j) {
                t.light_aim[j].push_back(run.aim[j]);
                t.light_visibility[j].push_back(run.visibility[j]);
            }
        }
    }

    void tell(const std::string& what) const {
        if (options_.progress) options_.progress(what);
    }

    /// Or the control, which all are ranked by.
    [[nodiscard]] bool is_ranked(const Entry& e) const {
        return e.setting < options_.ranked || e.setting == turns_.control;
    }
    [[nodiscard]] const MethodChoice& choice_of(const Entry& e) const { return turns_.settings[e.setting].choice; }

    /// Leaves out of this and all later rounds what the budget no longer affords.
    void choose(std::size_t round) {
        double spent = 0, needed = 0;
        for (const Entry& e : entries_)
            if (is_ranked(e)) spent += e.spent, needed += e.playing ? e.latest : 0;
        const bool whole = round < kFewestRounds && spent + needed <= options_.budget_ms;
        for (Entry& e : entries_) {
            const double share = is_ranked(e) ? share_ : share_of_others_;
            e.playing          = e.playing && ((whole && is_ranked(e)) || e.spent + e.latest <= share);
        }
    }

    template <class Wanted>
    [[nodiscard]] std::vector<Group> groups(const Wanted& wanted) const {
        std::vector<Group> groups;
        for (std::size_t e = 0; e < entries_.size(); ++e) {
            if (!wanted(entries_[e])) continue;
            const auto shares = [&](const Group& group) {
                const Entry& first = entries_[group[0]];
                return !first.twin && choice_of(first).info == choice_of(entries_[e]).info &&
                       first_changed_phase(choice_of(first).settings, choice_of(entries_[e]).settings) != Phase::build;
            };
            const auto found = entries_[e].twin || !options_.share_builds
                                   ? groups.end()
                                   : std::find_if(groups.begin(), groups.end(), shares);
            if (found == groups.end())
                groups.push_back({e});
            else
                found->push_back(e);
        }
        return groups;
    }

    /// One build, then aim and visibility of each member. One that throws is out of all later rounds; those behind it
    /// in the group get a build of their own.
    void run_group(const Group& group, bool cold) {
        std::optional<MethodAtWork> work;
        double build = 0;
        for (std::size_t k = 0; k < group.size(); ++k) {
            Entry& e = entries_[group[k]];
            if (cold) tell(choice_of(e).text());
            try {
                if (k == 0) {
                    work.emplace(choice_of(e), prepared_.scene, prepared_.facts);
                    work->limit(options_.most);
                    work->warm_up();
                    build = timed_by(options_.clock, [&] { work->build(); });
                } else {
                    work->set(choice_of(e));
                    work->limit(options_.most);
                }
                RunTimes run{.build = build};
                work->forget_look();
                run.look = timed_by(options_.clock, [&] { work->look(prepared_.points); });
                for (LightId j = 0; j < prepared_.scene.lights.size(); ++j) {
                    plane_.clear();
                    work->forget_aims();
                    run.aim.push_back(timed_by(options_.clock, [&] { work->aim(j); }));
                    run.visibility.push_back(timed_by(options_.clock, [&] { work->visibility(j, plane_.out()); }));
                }
                turns_.settings[e.setting].memory_bytes = work->memory_bytes();
                if (cold)
                    keep_cold(e, run);
                else
                    keep(e, std::move(run));
            } catch (...) {
                fail(e, failure(choice_of(e), std::nullopt));
                if (k + 1 < group.size()) {  // the others start on a method that has not thrown
                    run_group(Group(group.begin() + static_cast<std::ptrdiff_t>(k) + 1, group.end()), cold);
                }
                return;
            }
        }
    }

    void fail(Entry& e, Failure failure) {
        e.playing = false;
        if (e.twin) return;
        turns_.settings[e.setting].failed = std::move(failure.message);
        turns_.settings[e.setting].cut    = failure.cut;
    }

    void keep_cold(Entry& e, const RunTimes& run) {
        turns_.settings[e.setting].cold = run;
        e.latest                        = run.all();
    }

    void keep(Entry& e, RunTimes run) {
        e.latest = run.all();
        e.spent += e.latest;
        e.runs.push_back(std::move(run));
    }

    const PreparedScene& prepared_;
    const TurnOptions& options_;
    Turns& turns_;
    Shuffler dice_;
    VisibilityPlane plane_;
    std::vector<Entry> entries_;
    double share_ = 0, share_of_others_ = 0;  ///< of the budget, of one setting
};

TimingRecord samples_record(const std::vector<double>& samples) {
    TimingRecord record = timing_record(samples);
    record.samples      = samples;
    return record;
}

}  // namespace

double wall_clock_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<double> totals(const TurnTimes& times) {
    std::vector<double> all(times.build.size());
    for (std::size_t r = 0; r < all.size(); ++r)
        all[r] = times.build[r] + times.aim[r] + times.look[r] + times.visibility[r];
    return all;
}

Turns time_in_turns(const PreparedScene& prepared, std::span<const MethodChoice> choices, const TurnOptions& options) {
    const PinnedThreads pinned;
    Turns turns;
    turns.pinned = pinned.pinned();
    for (const MethodChoice& choice : choices) turns.settings.push_back({choice});
    Schedule schedule(prepared, options, turns);
    schedule.run_cold();
    schedule.add_control();
    schedule.run_rounds();
    schedule.finish();
    return turns;
}

TurnTimesRecord turn_times_record(const TurnTimes& times) {
    return {{samples_record(times.build), samples_record(times.aim), samples_record(times.look),
             samples_record(times.visibility)},
            {times.cold.build, times.cold.aims(), times.cold.look, times.cold.visibilities()},
            {times.order.begin(), times.order.end()}};
}

}  // namespace umbra
