#include "umbra/bench/ladders/ladder_cells.h"

#include <fmt/format.h>

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

std::string label_of(const Field& method) {
    if (method["text"].text() == method["name"].text()) return method["title"].text();
    if (const std::string preset = method["preset"].text(); !preset.empty())
        return fmt::format("{}, {}", method["title"].text(), preset);
    return method["text"].text();
}

std::optional<std::size_t> rung_of(const Field& ladder, const Field& value) {
    if (!value.present()) return std::nullopt;
    const auto rungs = ladder["rungs"].items();
    for (std::size_t r = 0; r < rungs.size(); ++r)
        if (rungs[r]["value"].number() == value.number()) return r;
    value.refuse("the value of a rung");
}

std::string left_out_in_words(double judged_rungs, double rungs, double least_coverage) {
    std::string words;
    if (judged_rungs < rungs) words = fmt::format("judged on {} of {}", count(judged_rungs), counted(rungs, "rung"));
    if (judged_rungs > 0 && least_coverage < 1)
        words += fmt::format("{}answers {} % of the points{}", words.empty() ? "" : ", ", percent(least_coverage),
                             judged_rungs > 1 ? " or more" : "");
    return words;
}

json fared(const Field& ladder, const Field& method) {
    const std::string unit = ladder["unit"].text();
    std::string note;
    const auto from = [&](const char* key, const char* words) {
        if (const auto r = rung_of(ladder, method[key])) {
            if (!note.empty()) note += ", ";
            note += *r == 0 ? std::string(words) : fmt::format("{} from {}", words, rung_value(*method[key].number()));
        }
    };
    from("not_served_from", "not served");
    from("silent_from", "mostly undefined");
    from("not_judged_from", "not judged");
    const bool breaks = method["breaks_at"].present();
    const bool holds  = !breaks && note.empty();
    std::string words = breaks ? rung_value(*method["breaks_at"].number()) : holds ? "holds" : "";
    if (const auto judged = method["judged_rungs"].number(); judged && !breaks) {
        const double rungs = double(ladder["rungs"].items().size()) + ladder["not_climbed"].number().value_or(0);
        const std::string part =
            left_out_in_words(*judged, holds ? rungs : 0, method["least_coverage"].number().value_or(1));
        if (!part.empty()) note += (note.empty() ? "" : ", ") + part;
    }
    return {{"words", words},   {"kind", method["kind"].text()},
            {"note", note},     {"why", method["why"].text()},
            {"breaks", breaks}, {"holds", holds}};
}

}  // namespace umbra
