#include "umbra/bench/ladders/ladder_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/report_text.h"

namespace umbra {

using nlohmann::json;

std::string rung_value(double value) {
    if (value == 0 || (value >= 0.999e-3 && value < 1e4)) return fmt::format("{:g}", value);
    const std::string text   = fmt::format("{:.2e}", value);  // 3.20e-05
    const std::size_t e      = text.find('e');
    const std::string factor = fmt::format("{:g}", std::stod(text.substr(0, e)));
    return (factor == "1" ? "" : factor + "·") + "10" + superscript(std::stoi(text.substr(e + 1)));
}

std::string label_of(const ClimbRecord& climbed) {
    if (climbed.text == climbed.name) return climbed.title;
    return climbed.preset ? fmt::format("{}, {}", climbed.title, *climbed.preset) : climbed.text;
}

std::optional<std::size_t> rung_of(const LadderRecord& ladder, const std::optional<double>& value) {
    const auto rung = std::ranges::find(ladder.rungs, value, &Rung::value);
    if (rung == ladder.rungs.end()) return std::nullopt;
    return rung - ladder.rungs.begin();
}

std::string left_out_in_words(const LadderRecord& ladder, const ClimbRecord& climbed) {
    if (climbed.breaks_at || !climbed.judged_rungs) return "";
    const bool holds          = !climbed.not_served_from && !climbed.silent_from && !climbed.not_judged_from;
    const std::uint64_t rungs = ladder.rungs.size() + ladder.not_climbed, judged_rungs = *climbed.judged_rungs;
    const double least_coverage = climbed.least_coverage.value_or(1);
    std::string words;
    if (holds && judged_rungs < rungs)
        words = fmt::format("judged on {} of {}", count(double(judged_rungs)), counted(double(rungs), "rung"));
    if (judged_rungs > 0 && least_coverage < 1)
        words += fmt::format("{}answers {} % of the points{}", words.empty() ? "" : ", ", percent(least_coverage),
                             judged_rungs > 1 ? " or more" : "");
    return words;
}

json fared(const LadderRecord& ladder, const ClimbRecord& climbed) {
    std::string note;
    const auto add  = [&](const std::string& words) { note += (note.empty() ? "" : ", ") + words; };
    const auto from = [&](const std::optional<double>& rung, const char* words) {
        if (rung) add(rung_of(ladder, rung) == 0u ? words : fmt::format("{} from {}", words, rung_value(*rung)));
    };
    from(climbed.not_served_from, "not served");
    from(climbed.silent_from, "mostly undefined");
    from(climbed.not_judged_from, "not judged");
    const std::optional<double>& breaks_at = climbed.breaks_at;
    const bool holds                       = !breaks_at && note.empty();
    const std::string words                = breaks_at ? rung_value(*breaks_at) : holds ? "holds" : "";
    if (const std::string part = left_out_in_words(ladder, climbed); !part.empty()) add(part);
    return {{"words", words},     {"kind", climbed.kind.value_or("")}, {"note", note},
            {"why", climbed.why}, {"breaks", breaks_at.has_value()},   {"holds", holds}};
}

}  // namespace umbra
