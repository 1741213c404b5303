#include "umbra/bench/ladders/ladder_record.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/ladders/ladder_cells.h"

namespace umbra {
namespace {

RungOutcomeRecord outcome_record(const RungOutcome& o) {
    RungOutcomeRecord record{.serves = service_record(o.service), .stopped = o.stopped};
    if (!o.ran()) return record;
    record.points          = o.points;
    record.undefined       = o.undefined;
    record.false_shadow    = o.false_shadow;
    record.false_light     = o.false_light;
    record.interior_lit    = o.can_show.lit;
    record.interior_shadow = o.can_show.shadow;
    record.interior_share  = o.interior_share();
    record.mae             = o.mae;
    record.broken          = o.broken();
    record.kind.emplace();
    if (!o.kind.empty()) *record.kind = o.kind;
    return record;
}

/// The preset whose settings these are.
std::optional<std::string> preset_of(const MethodChoice& choice) {
    if (choice.text() == choice.info->name) return "default";
    for (const Preset& preset : choice.info->presets)
        if (parse_method(fmt::format("{}@{}", choice.info->name, preset.name)).text() == choice.text())
            return std::string(preset.name);
    return {};
}

ClimbRecord climb_record(const LadderRun& run, std::size_t m) {
    const Climb c       = climb(run, m);
    const auto value_of = [&](const std::optional<std::size_t>& rung) {
        return rung ? std::optional(run.rungs[*rung].value) : std::nullopt;
    };
    ClimbRecord record{.name = "sum", .title = "The sum", .text = "sum"};
    if (!run.methods.empty()) {
        const MethodChoice& method = run.methods[m];
        record.name                = method.info->name;
        record.title               = method.info->title;
        record.text                = method.text();
        record.preset              = preset_of(method);
    }
    record.breaks_at       = value_of(c.breaks_at);
    record.silent_from     = value_of(c.silent_from);
    record.not_served_from = value_of(c.not_served_from);
    record.not_judged_from = value_of(c.not_judged_from);
    record.why             = c.why;
    record.judged_rungs    = c.judged;
    record.least_coverage  = c.least_coverage;
    if (c.breaks_at) {
        const RungOutcome& o = run.rungs[*c.breaks_at].outcomes[m];
        record.kind          = o.stopped.empty() ? o.kind : run.methods.empty() ? "wrong sum" : "stopped";
    }
    for (const Rung& rung : run.rungs)
        if (rung.unjudged.empty()) record.rungs.push_back(outcome_record(rung.outcomes[m]));
    if (m < run.first_rung_ms.size()) record.first_rung_ms = run.first_rung_ms[m];
    return record;
}

LadderWordsRecord words_of(const Ladder& ladder) { return {ladder.name, ladder.title, ladder.about, ladder.unit}; }

}  // namespace

LadderInfoRecord ladder_info(const Ladder& ladder) { return {words_of(ladder), ladder.rungs}; }

LadderRecord ladder_record(const LadderRun& run) {
    LadderRecord record{words_of(*run.ladder), run.rungs, run.ladder->rungs.size() - run.rungs.size(), {}};
    for (std::size_t m = 0; m < std::max<std::size_t>(run.methods.size(), run.methods.empty()); ++m)
        record.methods.push_back(climb_record(run, m));
    return record;
}

LaddersRecord read_ladders(const std::filesystem::path& file) {
    const Field root     = read_results(file);
    LaddersRecord record = from_record<LaddersRecord>(root);
    for (const Field& ladder : root["ladders"].items()) {
        const std::vector<Field> rungs = ladder["rungs"].items();
        for (const Field& method : ladder["methods"].items())
            for (const char* key : {"breaks_at", "silent_from", "not_served_from", "not_judged_from"})
                if (const auto value = method[key].number();
                    value && std::ranges::none_of(rungs, [&](const Field& r) { return r["value"].number() == value; }))
                    method[key].refuse("the value of a rung");
    }
    return record;
}

std::vector<ListedFailureRecord> failed_climbs(const LadderRun& run) {
    std::vector<ListedFailureRecord> all;
    const auto add = [&](double rung, const std::string& method, const std::optional<std::string>& light,
                         const std::string& message) {
        all.push_back({.ladder  = run.ladder->name,
                       .rung    = rung,
                       .method  = method,
                       .failure = {.light = light, .message = message}});
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

std::string failed_climb_in_words(const ListedFailureRecord& failed) {
    const std::optional<std::string>& light = failed.failure.light;
    return fmt::format("{}: {}: It failed{}{}: {}", failed.ladder, failed.method,
                       failed.rung ? fmt::format(" at {:g}", *failed.rung) : "",
                       light ? fmt::format(", light {}", *light) : "", failed.failure.message);
}

std::string climb_in_words(const ClimbRecord& climbed, const LadderRecord& ladder) {
    std::string words;
    if (climbed.breaks_at) words = fmt::format("{:g} {}", *climbed.breaks_at, climbed.kind.value_or(""));
    for (const auto& [from, what] : {std::pair(climbed.not_served_from, "not served"),
                                     {climbed.silent_from, "mostly undefined"},
                                     {climbed.not_judged_from, "not judged"}}) {
        if (!from) continue;
        const bool never = rung_of(ladder, from) == 0u;
        if (!words.empty()) words += "; ";
        words += never ? what : fmt::format("{} from {:g}", what, *from);
    }
    return words.empty() ? "holds" : words;
}

namespace {
/// A column of the table: the method as typed, by its preset where it has one.
std::string heading(std::span<const LadderRecord> ladders, const std::string& text) {
    for (const LadderRecord& ladder : ladders)
        for (const ClimbRecord& climbed : ladder.methods)
            if (climbed.text == text && climbed.preset && climbed.preset != "default")
                return fmt::format("{}@{}", climbed.name, *climbed.preset);
    return text;
}

/// How a method fared, and what that leaves out.
std::string cell_of(const ClimbRecord& climbed, const LadderRecord& ladder) {
    const std::string words = climb_in_words(climbed, ladder), part = left_out_in_words(ladder, climbed);
    return part.empty() ? words : fmt::format("{} ({})", words, part);
}
}  // namespace

std::string ladder_table(std::span<const LadderRecord> ladders) {
    // Columns are the methods in the order in which they first appear; ladders over the sum have a column of their own.
    std::vector<std::string> columns;
    for (const LadderRecord& ladder : ladders)
        for (const ClimbRecord& climbed : ladder.methods)
            if (std::ranges::find(columns, climbed.text) == columns.end()) columns.push_back(climbed.text);
    std::vector<std::vector<std::string>> rows(1, {"ladder"});
    for (const std::string& column : columns) rows[0].push_back(heading(ladders, column));
    rows[0].emplace_back("judged up to");
    for (const LadderRecord& ladder : ladders) {
        std::vector<std::string> row = {ladder.name};
        for (const std::string& column : columns) {
            std::string cell;
            for (const ClimbRecord& climbed : ladder.methods)
                if (climbed.text == column) cell = cell_of(climbed, ladder);
            row.push_back(cell);
        }
        std::string last = "no rung";
        for (const Rung& rung : ladder.rungs)
            if (rung.unjudged.empty()) last = fmt::format("{:g} {}", rung.value, ladder.unit);
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
