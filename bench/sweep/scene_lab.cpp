#include "umbra/bench/sweep/scene_lab.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "umbra/bench/record/field.h"
#include "umbra/bench/sweep/content_key.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {

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

bool SceneLab::has_cell(const MethodChoice& choice, int view_number) {
    return store_.find(view(view_number).key(choice)).has_value();
}

Json SceneLab::cell(const MethodChoice& choice, int view_number) {
    CellView& here = view(view_number);
    if (auto found = store_.find(here.key(choice))) return std::move(*found);
    static_cast<void>(here.reference());  // where there is none, no method is to blame
    if (options_.progress) options_.progress(fmt::format("view {}: {}", view_number, choice.text()));
    Json made = here.compute(choice);
    ++computed_;
    const bool starved = made.contains("failed") && made["failed"]["message"] == std::bad_alloc().what();
    if (!starved && here.is_whole()) store_.keep(made);
    return made;
}

Json SceneLab::reference() {
    const std::string key = view(0).reference_key();
    if (const auto found = store_.find(key)) return found->at("reference");
    Json made = {{"key", key}, {"reference", view(0).reference()}};
    if (!made["reference"].contains("failed") || !made["reference"]["failed"].contains("cut")) store_.keep(made);
    return made.at("reference");
}

std::string SceneLab::machine_key(const std::string& kind, const MethodChoice& choice) {
    const MachineRecord machine = machine_record(thread_count());
    return combined_key({kind, machine.cpu, fmt::format("{}", thread_count()), machine.compiler, view(0).key(choice)});
}

std::optional<Json> SceneLab::measured(const std::string& key) const {
    if (anew_ && !measured_here_.contains(key)) return std::nullopt;
    return store_.find(key);
}

void SceneLab::keep_measured(const Json& entry) {
    store_.keep(entry);
    measured_here_.insert(entry.at("key").get<std::string>());
}

double TimedTogether::noise_bar() const {
    const bool known = turns.is_object() && turns.at("noise_bar").is_number();
    return known ? turns.at("noise_bar").get<double>() : std::numeric_limits<double>::infinity();
}

std::optional<RunTimes> SceneLab::price(const MethodChoice& choice, int runs) {
    const std::string key = machine_key("price", choice);
    std::optional<RunTimes> price;
    int paid = 0;
    if (const auto found = measured(key)) {
        const Json& kept = found->at("price");
        price            = RunTimes{kept.at("build_ms").get<double>(), kept.at("aim_ms").get<std::vector<double>>(),
                         kept.at("look_ms").get<double>(), kept.at("visibility_ms").get<std::vector<double>>()};
        paid             = kept.at("runs").get<int>();
    }
    if (paid >= runs) return price;
    for (; paid < runs; ++paid) {
        if (options_.progress) options_.progress(fmt::format("price: {}", choice.text()));
        std::optional<RunTimes> run = view(0).times_of_one_run(choice, paid > 0);
        if (!run) return std::nullopt;
        if (!price || run->all() < price->all()) price = std::move(run);
    }
    keep_measured({{"key", key},
                   {"price",
                    {{"build_ms", price->build},
                     {"aim_ms", price->aim},
                     {"look_ms", price->look},
                     {"visibility_ms", price->visibility},
                     {"runs", paid}}}});
    return price;
}

std::optional<TimedTogether> SceneLab::stored_times(std::span<const MethodChoice> choices) {
    TimedTogether all;
    for (const MethodChoice& choice : choices) {
        auto found = measured(machine_key("time", choice));
        if (!found) return std::nullopt;
        if (all.settings.empty())
            all.turns = found->at("turns");
        else if (found->at("turns") != all.turns)
            return std::nullopt;
        all.settings.push_back(std::move(found->at("times")));
    }
    return all;
}

TimedTogether SceneLab::times(std::span<const MethodChoice> choices, TurnOptions options, double most_noise) {
    if (choices.empty()) return {};
    // Without a control there is no bar, and another run of the same budget has none either.
    const auto noisy = [&](const TimedTogether& t) {
        return std::isfinite(t.noise_bar()) && t.noise_bar() > most_noise;
    };
    if (auto stored = stored_times(choices); stored && !noisy(*stored)) return std::move(*stored);
    options.progress    = options_.progress;
    options.most        = options_.budget;
    bool was_cut        = false;
    const auto together = [&] {
        const Turns turns = time_in_turns(view(0).prepared(), choices, options);
        TimedTogether all;
        all.turns = {
            {"pinned", turns.pinned}, {"noise_bar", number(turns.noise_bar)}, {"calibration_ms", Json::array()}};
        for (const double ms : turns.calibration) all.turns["calibration_ms"].push_back(number(ms));
        was_cut = std::ranges::any_of(turns.settings, &TurnTimes::cut);
        for (const TurnTimes& t : turns.settings)
            all.settings.push_back(!t.build.empty() && t.failed.empty() ? to_record(turn_times_record(t)) : Json());
        return all;
    };
    TimedTogether all = together();
    if (noisy(all)) {
        if (options_.progress)
            options_.progress(fmt::format("noise bar {:.0f} %: timing again", 100 * all.noise_bar()));
        if (TimedTogether again = together(); again.noise_bar() < all.noise_bar()) all = std::move(again);
    }
    for (std::size_t k = 0; k < choices.size() && !was_cut; ++k)
        keep_measured({{"key", machine_key("time", choices[k])}, {"times", all.settings[k]}, {"turns", all.turns}});
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
