#include "umbra/bench/ladders/textbook_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "umbra/bench/ladders/ladder_cells.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/statistics/statistics.h"

namespace umbra {
namespace {

using nlohmann::json;

constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

/// A method that was climbed in both forms.
struct Twins {
    Field textbook, by_default;
};

std::vector<Twins> twins_of(const Field& ladder) {
    std::vector<Twins> all;
    for (const Field& textbook : ladder["methods"].items()) {
        if (textbook["preset"].text() != "textbook") continue;
        for (const Field& method : ladder["methods"].items())
            if (method["text"].text() == textbook["name"].text()) all.push_back({textbook, method});
    }
    return all;
}

/// The rung from which a method has no answer that can be judged; kNever where it always has one.
std::size_t answers_until(const Field& ladder, const Field& method) {
    std::size_t end = kNever;
    for (const char* key : {"not_served_from", "silent_from", "not_judged_from"})
        if (const auto r = rung_of(ladder, method[key])) end = std::min(end, *r);
    return end;
}

std::vector<double> milliseconds_of(const Field& method) {
    std::vector<double> all;
    for (const Field& ms : method["first_rung_ms"].items()) all.push_back(ms.number().value_or(0));
    return all;
}

/// One method over all ladders.
struct Tally {
    Field textbook, by_default;
    int ladders = 0, earlier = 0, later = 0, not_compared = 0;
    std::vector<double> ratios;  ///< of times: default form to textbook form, one a ladder
};

/// By the method's name, in the order of the list.
std::vector<Tally> tallies_of(const Field& root) {
    std::vector<Tally> tallies;
    for (const Field& ladder : root["ladders"].items())
        for (const Twins& twins : twins_of(ladder)) {
            auto tally = std::find_if(tallies.begin(), tallies.end(), [&](const Tally& t) {
                return t.textbook["text"].text() == twins.textbook["text"].text();
            });
            if (tally == tallies.end())
                tally = tallies.insert(tally, Tally{twins.textbook, twins.by_default, 0, 0, 0, 0, {}});
            const Textbook outcome = compare_with_textbook(ladder, twins.textbook, twins.by_default).outcome;
            ++tally->ladders;
            tally->earlier += outcome == Textbook::earlier;
            tally->later += outcome == Textbook::later;
            tally->not_compared += outcome == Textbook::not_compared;
            const Ratio ratio = paired_ratio(milliseconds_of(twins.by_default), milliseconds_of(twins.textbook));
            if (ratio.pairs > 0) tally->ratios.push_back(ratio.median);
        }
    return tallies;
}

std::string settings_of(const Field& method) {
    const std::string text = method["text"].text();
    const auto colon       = text.find(':');
    return colon == std::string::npos ? "" : text.substr(colon + 1);
}

json tally_view(const Tally& tally) {
    std::vector<double> ratios = tally.ratios;
    std::sort(ratios.begin(), ratios.end());
    const std::size_t n = ratios.size();
    return {{"title", tally.by_default["title"].text()},
            {"settings", settings_of(tally.textbook)},
            {"ladders", count(tally.ladders)},
            {"earlier", count(tally.earlier)},
            {"later", count(tally.later)},
            {"not_compared", count(tally.not_compared)},
            {"ratio", ratios.empty() ? kNone : score(median(ratios))},
            {"range", n > 1 ? fmt::format("{}–{}", score(ratios[n / 4]), score(ratios[3 * n / 4])) : ""}};
}

std::string rungs_in_words(int rungs) {
    return fmt::format("{}{} rung{}", rungs > 0 ? "+" : "−", std::abs(rungs), std::abs(rungs) == 1 ? "" : "s");
}

json cell_view(const Field& ladder, const Twins& twins) {
    const TextbookClimb c = compare_with_textbook(ladder, twins.textbook, twins.by_default);
    return {{"absent", false},
            {"textbook", fared(ladder, twins.textbook)},
            {"by_default", fared(ladder, twins.by_default)},
            {"earlier", c.outcome == Textbook::earlier},
            {"change", c.rungs == 0 ? "" : rungs_in_words(c.rungs)}};
}

}  // namespace

bool is_textbook_twin(const Field& ladder, const Field& method) {
    const std::vector<Twins> all = twins_of(ladder);
    return std::any_of(all.begin(), all.end(),
                       [&](const Twins& t) { return t.textbook["text"].text() == method["text"].text(); });
}

TextbookClimb compare_with_textbook(const Field& ladder, const Field& textbook, const Field& by_default) {
    const std::size_t t = rung_of(ladder, textbook["breaks_at"]).value_or(kNever),
                      d = rung_of(ladder, by_default["breaks_at"]).value_or(kNever);
    if (t == d) return {};
    if ((t == kNever && answers_until(ladder, textbook) <= d) ||
        (d == kNever && answers_until(ladder, by_default) <= t))
        return {Textbook::not_compared, 0};
    const std::size_t end = ladder["rungs"].items().size();
    return {t < d ? Textbook::earlier : Textbook::later, int(std::min(d, end)) - int(std::min(t, end))};
}

json textbook_view(const Field& root, const std::string& page) {
    const std::vector<Tally> tallies = tallies_of(root);
    if (tallies.empty()) return false;
    json view = {{"columns", json::array()}, {"tallies", json::array()}, {"rows", json::array()}};
    int pairs = 0, earlier = 0, later = 0;
    for (const Tally& tally : tallies) {
        view["columns"].push_back(tally.by_default["title"].text());
        view["tallies"].push_back(tally_view(tally));
        pairs += tally.ladders, earlier += tally.earlier, later += tally.later;
    }
    for (const Field& ladder : root["ladders"].items()) {
        const std::vector<Twins> all = twins_of(ladder);
        bool differs                 = false;
        json cells                   = json::array();
        for (const Tally& tally : tallies) {
            const auto twins = std::find_if(all.begin(), all.end(), [&](const Twins& t) {
                return t.textbook["text"].text() == tally.textbook["text"].text();
            });
            if (twins == all.end()) {
                cells.push_back({{"absent", true}});
                continue;
            }
            const Textbook outcome = compare_with_textbook(ladder, twins->textbook, twins->by_default).outcome;
            differs                = differs || outcome != Textbook::same;
            cells.push_back(cell_view(ladder, *twins));
        }
        if (differs)
            view["rows"].push_back({{"title", ladder["title"].required_text()},
                                    {"unit", ladder["unit"].text()},
                                    {"href", page + "#" + ladder["name"].required_text()},
                                    {"cells", std::move(cells)}});
    }
    view["page"]     = page;
    view["has_rows"] = !view["rows"].empty();
    view["sentence"] = fmt::format(
        "Of {} climbs (a method on a ladder) the textbook form breaks at an earlier rung than the default form on {}, "
        "at "
        "a later one on {}.",
        count(pairs), count(earlier), count(later));
    return view;
}

}  // namespace umbra
