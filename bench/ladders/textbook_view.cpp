#include "umbra/bench/ladders/textbook_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/ladders/ladder_cells.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

/// A method that was climbed in both forms.
struct Twins {
    const ClimbRecord *textbook, *by_default;
};

std::vector<Twins> twins_of(const LadderRecord& ladder) {
    std::vector<Twins> all;
    for (const ClimbRecord& textbook : ladder.methods) {
        if (textbook.preset != "textbook") continue;
        for (const ClimbRecord& other : ladder.methods)
            if (other.text == textbook.name) all.push_back({&textbook, &other});
    }
    return all;
}

/// The rung from which a method has no answer that can be judged; kNever where it always has one.
std::size_t answers_until(const LadderRecord& ladder, const ClimbRecord& climbed) {
    std::size_t end = kNever;
    for (const auto& from : {climbed.not_served_from, climbed.silent_from, climbed.not_judged_from})
        end = std::min(end, rung_of(ladder, from).value_or(kNever));
    return end;
}

std::vector<double> milliseconds_of(const ClimbRecord& climbed) {
    return climbed.first_rung_ms.value_or(std::vector<double>());
}

/// One method over all ladders.
struct Tally {
    Twins first;
    int ladders = 0, earlier = 0, later = 0, not_compared = 0;
    std::vector<double> ratios;  ///< of times: default form to textbook form, one a ladder
};

/// By the method's name, in the order of the list.
std::vector<Tally> tallies_of(const LaddersRecord& record) {
    std::vector<Tally> tallies;
    for (const LadderRecord& ladder : record.ladders)
        for (const Twins& twins : twins_of(ladder)) {
            auto tally =
                std::ranges::find(tallies, twins.textbook->text, [](const Tally& t) { return t.first.textbook->text; });
            if (tally == tallies.end()) tally = tallies.insert(tally, Tally{twins, 0, 0, 0, 0, {}});
            const Textbook outcome = compare_with_textbook(ladder, *twins.textbook, *twins.by_default).outcome;
            ++tally->ladders;
            tally->earlier += outcome == Textbook::earlier;
            tally->later += outcome == Textbook::later;
            tally->not_compared += outcome == Textbook::not_compared;
            const Ratio ratio = paired_ratio(milliseconds_of(*twins.by_default), milliseconds_of(*twins.textbook));
            if (ratio.pairs > 0) tally->ratios.push_back(ratio.median);
        }
    return tallies;
}

std::string settings_after_colon(const std::string& text) {
    const auto colon = text.find(':');
    return colon == std::string::npos ? "" : text.substr(colon + 1);
}

json tally_view(const Tally& tally) {
    std::vector<double> ratios = tally.ratios;
    std::sort(ratios.begin(), ratios.end());
    const std::size_t n = ratios.size();
    return {{"title", tally.first.by_default->title},
            {"settings", settings_after_colon(tally.first.textbook->text)},
            {"ladders", count(tally.ladders)},
            {"earlier", count(tally.earlier)},
            {"later", count(tally.later)},
            {"not_compared", count(tally.not_compared)},
            {"ratio", ratios.empty() ? kNone : score(median(ratios))},
            {"range", n > 1 ? fmt::format("{}–{}", score(ratios[n / 4]), score(ratios[3 * n / 4])) : ""}};
}

std::string rungs_in_words(int rungs) { return (rungs > 0 ? "+" : "−") + counted(std::abs(rungs), "rung"); }

json cell_view(const LadderRecord& ladder, const Twins& twins) {
    const TextbookClimb c = compare_with_textbook(ladder, *twins.textbook, *twins.by_default);
    return {{"absent", false},
            {"textbook", fared(ladder, *twins.textbook)},
            {"by_default", fared(ladder, *twins.by_default)},
            {"earlier", c.outcome == Textbook::earlier},
            {"change", c.rungs == 0 ? "" : rungs_in_words(c.rungs)}};
}

}  // namespace

bool is_textbook_twin(const LadderRecord& ladder, const ClimbRecord& climbed) {
    return std::ranges::any_of(twins_of(ladder), [&](const Twins& t) { return t.textbook->text == climbed.text; });
}

TextbookClimb compare_with_textbook(const LadderRecord& ladder, const ClimbRecord& textbook,
                                    const ClimbRecord& by_default) {
    const std::size_t t = rung_of(ladder, textbook.breaks_at).value_or(kNever),
                      d = rung_of(ladder, by_default.breaks_at).value_or(kNever);
    if (t == d) return {};
    if ((t == kNever && answers_until(ladder, textbook) <= d) ||
        (d == kNever && answers_until(ladder, by_default) <= t))
        return {Textbook::not_compared, 0};
    const std::size_t end = ladder.rungs.size();
    return {t < d ? Textbook::earlier : Textbook::later, int(std::min(d, end)) - int(std::min(t, end))};
}

json textbook_view(const LaddersRecord& record, const std::string& page) {
    const std::vector<Tally> tallies = tallies_of(record);
    if (tallies.empty()) return false;
    json view = {{"columns", json::array()}, {"tallies", json::array()}, {"rows", json::array()}};
    int pairs = 0, earlier = 0, later = 0;
    for (const Tally& tally : tallies) {
        view["columns"].push_back(tally.first.by_default->title);
        view["tallies"].push_back(tally_view(tally));
        pairs += tally.ladders, earlier += tally.earlier, later += tally.later;
    }
    for (const LadderRecord& ladder : record.ladders) {
        const std::vector<Twins> all = twins_of(ladder);
        bool differs                 = false;
        json cells                   = json::array();
        for (const Tally& tally : tallies) {
            const auto twins =
                std::ranges::find(all, tally.first.textbook->text, [](const Twins& t) { return t.textbook->text; });
            if (twins == all.end()) {
                cells.push_back({{"absent", true}});
                continue;
            }
            const Textbook outcome = compare_with_textbook(ladder, *twins->textbook, *twins->by_default).outcome;
            differs                = differs || outcome != Textbook::same;
            cells.push_back(cell_view(ladder, *twins));
        }
        if (differs)
            view["rows"].push_back({{"title", ladder.title},
                                    {"unit", ladder.unit},
                                    {"href", page + "#" + ladder.name},
                                    {"cells", std::move(cells)}});
    }
    view["page"]     = page;
    view["sentence"] = fmt::format(
        "Of {} climbs (a method on a ladder) the textbook form breaks at an earlier rung than the default form on {}, "
        "at "
        "a later one on {}.",
        count(pairs), count(earlier), count(later));
    return view;
}

}  // namespace umbra
