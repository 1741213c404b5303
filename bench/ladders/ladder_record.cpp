#include "umbra/bench/ladders/ladder_record.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/ladders/ladder_cells.h"

namespace umbra {
namespace {

Json outcome_json(const RungOutcome& o) {
    Json j = {{"serves", service_json(o.service)}};
    if (!o.stopped.empty()) j["stopped"] = o.stopped;
    if (!o.ran()) return j;
    j["points"]          = o.points;
    j["undefined"]       = o.undefined;
    j["false_shadow"]    = {{"interior", o.false_shadow.interior}, {"edge", o.false_shadow.edge}};
    j["false_light"]     = {{"interior", o.false_light.interior}, {"edge", o.false_light.edge}};
    j["interior_lit"]    = o.can_show.lit;
    j["interior_shadow"] = o.can_show.shadow;
    j["interior_share"]  = number(o.interior_share());
    j["mae"]             = number(o.mae);
    j["broken"]          = o.broken();
    j["kind"]            = o.kind.empty() ? Json(nullptr) : Json(o.kind);
    return j;
}

Json rung_json(const Rung& rung) {
    Json j = {{"value", rung.value},
              {"truth", rung.truth},
              {"surface_points", rung.surface_points},
              {"lit", rung.lit},
              {"umbra", rung.umbra},
              {"penumbra", rung.penumbra},
              {"on_boundary", rung.on_boundary},
              {"interior_lit", rung.can_show.lit},
              {"interior_shadow", rung.can_show.shadow}};
    if (!rung.unjudged.empty()) j["unjudged"] = rung.unjudged;
    return j;
}

/// The value of a rung that a climb names; null where it names none.
Json value_of(const LadderRun& run, const std::optional<std::size_t>& rung) {
    return rung ? Json(run.rungs[*rung].value) : Json(nullptr);
}

/// The preset whose settings these are; null where it is none.
Json preset_of(const MethodChoice& choice) {
    if (choice.text() == choice.info->name) return "default";
    for (const Preset& preset : choice.info->presets)
        if (parse_method(fmt::format("{}@{}", choice.info->name, preset.name)).text() == choice.text())
            return preset.name;
    return nullptr;
}

Json method_climb_json(const LadderRun& run, std::size_t m) {
    const Climb c = climb(run, m);
    Json j        = {{"name", run.methods.empty() ? "sum" : std::string(run.methods[m].info->name)},
                     {"title", run.methods.empty() ? "The sum" : std::string(run.methods[m].info->title)},
                     {"text", run.methods.empty() ? "sum" : run.methods[m].text()},
                     {"preset", run.methods.empty() ? Json() : preset_of(run.methods[m])},
                     {"breaks_at", value_of(run, c.breaks_at)},
                     {"kind", nullptr},
                     {"silent_from", value_of(run, c.silent_from)},
                     {"not_served_from", value_of(run, c.not_served_from)},
                     {"not_judged_from", value_of(run, c.not_judged_from)},
                     {"why", c.why},
                     {"judged_rungs", c.judged},
                     {"least_coverage", number(c.least_coverage)},
                     {"rungs", Json::array()}};
    if (c.breaks_at) {
        const RungOutcome& o = run.rungs[*c.breaks_at].outcomes[m];
        j["kind"]            = o.stopped.empty() ? o.kind : run.methods.empty() ? "wrong sum" : "stopped";
    }
    for (const Rung& rung : run.rungs)
        if (rung.unjudged.empty()) j["rungs"].push_back(outcome_json(rung.outcomes[m]));
    if (m < run.first_rung_ms.size()) j["first_rung_ms"] = run.first_rung_ms[m];
    return j;
}

}  // namespace

Json ladder_info_json(const Ladder& ladder) {
    return {{"name", ladder.name},
            {"title", ladder.title},
            {"about", ladder.about},
            {"unit", ladder.unit},
            {"rungs", std::vector<double>(ladder.rungs.begin(), ladder.rungs.end())}};
}

Json ladder_json(const LadderRun& run) {
    Json j     = ladder_info_json(*run.ladder);
    j["rungs"] = Json::array();
    for (const Rung& rung : run.rungs) j["rungs"].push_back(rung_json(rung));
    j["not_climbed"] = run.ladder->rungs.size() - run.rungs.size();
    j["methods"]     = Json::array();
    for (std::size_t m = 0; m < std::max<std::size_t>(run.methods.size(), run.methods.empty()); ++m)
        j["methods"].push_back(method_climb_json(run, m));
    return j;
}

Json failed_climbs_json(const LadderRun& run) {
    Json all       = Json::array();
    const auto add = [&](double rung, const std::string& method, const std::optional<std::string>& light,
                         const std::string& message) {
        all.push_back({{"ladder", run.ladder->name},
                       {"rung", rung},
                       {"method", method},
                       {"light", light ? Json(*light) : Json()},
                       {"message", message}});
    };
    for (const Rung& rung : run.rungs)
        if (!rung.failed.empty()) add(rung.value, "the reference", {}, rung.failed);
    for (std::size_t m = 0; m < run.methods.size(); ++m)
        for (const Rung& rung : run.rungs) {
            if (!rung.unjudged.empty() || rung.outcomes[m].stopped.empty()) continue;
            add(rung.value, run.methods[m].text(), rung.outcomes[m].light, rung.outcomes[m].stopped);
            break;
        }
    return all;
}

std::string failed_climb_in_words(const Json& failed) {
    return fmt::format("{}: {}: It failed{}{}: {}", failed["ladder"].get<std::string>(),
                       failed["method"].get<std::string>(),
                       failed["rung"].is_null() ? "" : fmt::format(" at {:g}", failed["rung"].get<double>()),
                       failed["light"].is_null() ? "" : fmt::format(", light {}", failed["light"].get<std::string>()),
                       failed["message"].get<std::string>());
}

std::string climb_in_words(const Json& method, const Json& ladder) {
    const auto value = [&](const char* key) { return method[key].get<double>(); };
    std::string words;
    if (!method["breaks_at"].is_null())
        words = fmt::format("{:g} {}", value("breaks_at"), method["kind"].get<std::string>());
    for (const auto& [key, what] : {std::pair("not_served_from", "not served"),
                                    {"silent_from", "mostly undefined"},
                                    {"not_judged_from", "not judged"}}) {
        if (method[key].is_null()) continue;
        const bool never = value(key) == ladder["rungs"][0]["value"].get<double>();
        if (!words.empty()) words += "; ";
        words += never ? what : fmt::format("{} from {:g}", what, value(key));
    }
    return words.empty() ? "holds" : words;
}

namespace {
/// A column of the table: the method as typed, by its preset where it has one.
std::string heading(const Json& ladders, const std::string& text) {
    for (const Json& ladder : ladders)
        for (const Json& method : ladder["methods"])
            if (method["text"] == text && method.contains("preset") && method["preset"].is_string() &&
                method["preset"] != "default")
                return fmt::format("{}@{}", method["name"].get<std::string>(), method["preset"].get<std::string>());
    return text;
}

/// How a method fared, and what that leaves out.
std::string cell_of(const Json& method, const Json& ladder) {
    std::string words = climb_in_words(method, ladder);
    if (!method["breaks_at"].is_null() || !method.contains("judged_rungs")) return words;
    const std::size_t rungs = ladder["rungs"].size() + ladder["not_climbed"].get<std::size_t>();
    const std::string part =
        left_out_in_words(method["judged_rungs"], words == "holds" ? double(rungs) : 0, method["least_coverage"]);
    return part.empty() ? words : fmt::format("{} ({})", words, part);
}
}  // namespace

std::string ladder_table(const Json& ladders) {
    // Columns are the methods in the order in which they first appear; ladders over the sum have a column of their own.
    std::vector<std::string> columns;
    for (const Json& ladder : ladders)
        for (const Json& method : ladder["methods"])
            if (const std::string name = method["text"];
                std::find(columns.begin(), columns.end(), name) == columns.end())
                columns.push_back(name);
    std::vector<std::vector<std::string>> rows(1, {"ladder"});
    for (const std::string& column : columns) rows[0].push_back(heading(ladders, column));
    rows[0].emplace_back("judged up to");
    for (const Json& ladder : ladders) {
        std::vector<std::string> row = {ladder["name"]};
        for (const std::string& column : columns) {
            std::string cell;
            for (const Json& method : ladder["methods"])
                if (method["text"] == column) cell = cell_of(method, ladder);
            row.push_back(cell);
        }
        std::string last = "no rung";
        for (const Json& rung : ladder["rungs"])
            if (!rung.contains("unjudged"))
                last = fmt::format("{:g} {}", rung["value"].get<double>(), ladder["unit"].get<std::string>());
        row.push_back(last);
        rows.push_back(std::move(row));
    }
    std::vector<std::size_t> widths(rows[0].size(), 0);
    for (const auto& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c) line += fmt::format("{:<{}}  ", row[c], widths[c]);
        text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
}

}  // namespace umbra
