#include "umbra/bench/sweep/scene_lab.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "umbra/bench/base/record.h"
#include "umbra/bench/sweep/content_key.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

struct PriceRecord {
    double build_ms = 0;
    std::vector<double> aim_ms{};
    double look_ms = 0;
    std::vector<double> visibility_ms{};
    int runs = 0;
};
DESCRIBE(PriceRecord) { MEMBERS(build_ms, aim_ms, look_ms, visibility_ms, runs); }

// What is kept beside cells.

struct KeptPrice {
    std::string key{};
    PriceRecord price{};
};
DESCRIBE(KeptPrice) { MEMBERS(key, price); }

struct KeptTimes {
    std::string key{};
    std::optional<TurnTimesRecord> times{};
    std::optional<SweptTurnsRecord> turns{};
};
DESCRIBE(KeptTimes) { MEMBERS(key, times, turns); }

struct KeptSeconds {  // spent on a setting, or less than one run of it takes
    std::string key{};
    double seconds = 0;
};
DESCRIBE(KeptSeconds) { MEMBERS(key, seconds); }

struct KeptReference {
    std::string key{};
    ReferenceRecord reference{};
};
DESCRIBE(KeptReference) { MEMBERS(key, reference); }

/// Each phase by the faster of two runs: what is disturbed once is another one in each.
void keep_faster(RunTimes& kept, const RunTimes& run) {
    const auto keep = [](double& to, double from) { to = std::min(to, from); };
    keep(kept.build, run.build), keep(kept.look, run.look);
    for (std::size_t light = 0; light < kept.aim.size(); ++light)
        keep(kept.aim[light], run.aim[light]), keep(kept.visibility[light], run.visibility[light]);
}

}  // namespace

SceneLab::SceneLab(const std::filesystem::path& file, CellOptions options, const CellStore& store)
    : own_(std::make_shared<OwnScene>(load_scene(file))), file_(file), options_(std::move(options)), store_(store) {}

SceneLab::SceneLab(const SceneLab& other, const Size& size)
    : own_(other.own_), file_(other.file_), options_(other.options_), store_(other.store_) {
    options_.size = size;
    anew_         = other.anew_;
}

Size SceneLab::size() const { return options_.size.width > 0 ? options_.size : Size{scene().width, scene().height}; }

CellView& SceneLab::view(int view) {
    const auto found = views_.find(view);
    if (found != views_.end()) return found->second;
    return views_.emplace(view, CellView(own_, file_, view, options_, store_.folder())).first->second;
}

/// Where a cell may be found: a whole one serves in place of a brief one.
std::vector<std::string> SceneLab::keys_of(const MethodChoice& choice, int view_number) {
    const CellView& here = view(view_number);
    std::vector<std::string> keys{here.key(choice)};
    if (options_.brief) keys.push_back(here.key(choice, true));
    return keys;
}

bool SceneLab::has_cell(const MethodChoice& choice, int view_number) {
    return std::ranges::any_of(keys_of(choice, view_number), [&](const std::string& key) { return store_.has(key); });
}

Cell SceneLab::cell(const MethodChoice& choice, int view_number) {
    for (const std::string& key : keys_of(choice, view_number))
        if (auto found = store_.find<Cell>(key)) return std::move(*found);
    CellView& here = view(view_number);
    static_cast<void>(here.reference());  // where there is none, no method is to blame
    if (options_.progress) options_.progress(fmt::format("view {}: {}", view_number, choice.text()));
    Cell made = here.compute(choice);
    ++computed_;
    const bool starved = made.method.failed && made.method.failed->message == std::bad_alloc().what();
    if (!starved && here.is_whole()) store_.keep(made);
    return made;
}

ReferenceRecord SceneLab::reference() {
    const std::string key = view(0).reference_key();
    if (auto found = store_.find<KeptReference>(key)) return std::move(found->reference);
    const KeptReference made{key, view(0).reference()};
    const auto& failed = made.reference.failed;
    if (!failed || !failed->failure.cut) store_.keep(made);
    return made.reference;
}

std::string SceneLab::machine_key(const std::string& kind, const MethodChoice& choice) {
    const MachineRecord machine = machine_record(thread_count());
    return combined_key({kind, machine.cpu, fmt::format("{}", thread_count()), machine.compiler, view(0).key(choice)});
}

double TimedTogether::noise_bar() const {
    return turns && turns->noise_bar ? *turns->noise_bar : std::numeric_limits<double>::infinity();
}

bool SceneLab::takes_longer(const MethodChoice& choice, double seconds) {
    const std::string key = machine_key("price", choice), longer = machine_key("longer", choice);
    if (is_fresh(key) && store_.has(key)) return price(choice)->all() > 1000 * seconds;
    if (const auto found = is_fresh(longer) ? store_.find<KeptSeconds>(longer) : std::nullopt)
        if (found->seconds >= seconds) return true;
    if (options_.progress) options_.progress(fmt::format("price: {}", choice.text()));
    try {
        static_cast<void>(view(0).times_of_one_run(choice, false, seconds));
    } catch (const CutShort&) {
        store_.keep(KeptSeconds{longer, seconds});
        measured_here_.insert(longer);
        return true;
    }
    return false;
}

std::optional<RunTimes> SceneLab::price(const MethodChoice& choice, int runs) {
    const std::string key = machine_key("price", choice);
    std::optional<RunTimes> price;
    int paid = 0;
    if (const auto found = is_fresh(key) ? store_.find<KeptPrice>(key) : std::nullopt) {
        const PriceRecord& kept = found->price;
        price                   = RunTimes{kept.build_ms, kept.aim_ms, kept.look_ms, kept.visibility_ms};
        paid                    = kept.runs;
    }
    if (paid >= runs) return price;
    for (; paid < runs; ++paid) {
        if (options_.progress) options_.progress(fmt::format("price: {}", choice.text()));
        std::optional<RunTimes> run = view(0).times_of_one_run(choice, paid > 0);
        if (!run) return std::nullopt;
        if (price)
            keep_faster(*price, *run);
        else
            price = std::move(run);
    }
    store_.keep(KeptPrice{key, {price->build, price->aim, price->look, price->visibility, paid}});
    measured_here_.insert(key);
    return price;
}

double SceneLab::spent_on(const MethodChoice& choice) {
    const std::string key = machine_key("spent", choice);
    const auto found      = is_fresh(key) ? store_.find<KeptSeconds>(key) : std::nullopt;
    return found ? found->seconds : 0;
}

void SceneLab::spend_on(const MethodChoice& choice, double seconds) {
    const std::string key = machine_key("spent", choice);
    store_.keep(KeptSeconds{key, spent_on(choice) + seconds});
    measured_here_.insert(key);
}

namespace {

/// Without a control there is no bar, and another run of the same budget has none either.
bool is_noisy(const TimedTogether& times, double most_noise) {
    return std::isfinite(times.noise_bar()) && times.noise_bar() > most_noise;
}

}  // namespace

std::optional<TimedTogether> SceneLab::stored_times(std::span<const MethodChoice> choices, double most_noise) {
    TimedTogether all;
    for (const MethodChoice& choice : choices) {
        const std::string key = machine_key("time", choice);
        auto found            = is_fresh(key) ? store_.find<KeptTimes>(key) : std::nullopt;
        if (!found) return std::nullopt;
        if (all.settings.empty())
            all.turns = found->turns;
        else if (found->turns != all.turns)
            return std::nullopt;
        all.settings.push_back(std::move(found->times));
    }
    return is_noisy(all, most_noise) ? std::nullopt : std::optional(std::move(all));
}

TimedTogether SceneLab::times(std::span<const MethodChoice> choices, TurnOptions options, double most_noise) {
    if (choices.empty()) return {};
    if (auto stored = stored_times(choices, most_noise)) return std::move(*stored);
    options.progress    = options_.progress;
    options.most        = options_.budget;
    bool was_cut        = false;
    const auto together = [&] {
        const Turns turns = time_in_turns(view(0).prepared(), choices, options);
        TimedTogether all;
        all.turns = SweptTurnsRecord{turns.pinned, known(turns.noise_bar), turns.calibration};
        was_cut   = std::ranges::any_of(turns.settings, &TurnTimes::cut);
        for (const TurnTimes& t : turns.settings) {
            all.settings.emplace_back();
            if (!t.build.empty() && t.failed.empty()) all.settings.back() = turn_times_record(t);
        }
        return all;
    };
    TimedTogether all = together();
    if (is_noisy(all, most_noise)) {
        if (options_.progress)
            options_.progress(fmt::format("noise bar {:.0f} %: timing again", 100 * all.noise_bar()));
        if (TimedTogether again = together(); again.noise_bar() < all.noise_bar()) all = std::move(again);
    }
    for (std::size_t k = 0; k < choices.size() && !was_cut; ++k) {
        const std::string key = machine_key("time", choices[k]);
        store_.keep(KeptTimes{key, all.settings[k], all.turns});
        measured_here_.insert(key);
    }
    return all;
}

std::vector<MethodChoice> by_build(std::span<const MethodChoice> choices) {
    std::vector<MethodChoice> ordered;
    std::vector<bool> taken(choices.size());
    for (std::size_t a = 0; a < choices.size(); ++a) {
        if (taken[a]) continue;
        for (std::size_t b = a; b < choices.size(); ++b) {
            if (taken[b] || choices[a].info != choices[b].info) continue;
            if (a != b && first_changed_phase(choices[a].settings, choices[b].settings) == Phase::build) continue;
            ordered.push_back(choices[b]);
            taken[b] = true;
        }
    }
    return ordered;
}

}  // namespace umbra
