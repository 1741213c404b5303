#include "umbra/bench/studies/study_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "report_assets.h"
#include "umbra/bench/pages/chart_parts.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

Json value_of(const Json& row, std::string key) {
    std::ranges::replace(key, '.', '/');
    return row.value(Json::json_pointer("/" + key), Json());
}

/// A number as a page shows it, or a terminal, which groups no digits.
std::string written(const Json& value, const Notation& notation, bool on_page) {
    if (value.is_null()) return on_page ? kNone : "-";
    if (value.is_string()) return value.get<std::string>();
    const auto number = value.get<double>();
    switch (notation.kind) {
        case Notation::Kind::count: return on_page ? count(number) : fmt::format("{:.0f}", number);
        case Notation::Kind::general: return fmt::format("{:g}", number);
        case Notation::Kind::fixed: return fmt::format("{:.{}f}", number, notation.digits);
        default: return on_page ? score(number) : fmt::format("{:.4g}", number);
    }
}

bool is_number(const Column& column) {
    return column.notation.kind != Notation::Kind::text && column.notation.kind != Notation::Kind::code;
}

std::string head_of(const Column& column) {
    return column.unit.empty() ? column.head : fmt::format("{}, {}", column.head, column.unit);
}

template <class Thing>
std::vector<Thing> shown(const std::vector<Thing>& all, Shown where) {
    std::vector<Thing> here;
    std::ranges::copy_if(all, std::back_inserter(here),
                         [&](const Thing& thing) { return thing.shown == Shown::everywhere || thing.shown == where; });
    return here;
}

/// A section of the page, or another page.
std::string address_of(const std::string& link) { return link.find('/') == std::string::npos ? "#" + link : link; }

Json part(const std::string& text, const std::string& code = "", const std::string& sub = "") {
    return {{"text", text}, {"code", code}, {"sub", sub}, {"link", ""}};
}

/// Text in parts, for the template `study_words`.
Json marked(const std::string& text) {
    Json parts       = Json::array();
    std::size_t from = 0;
    for (std::size_t at = 0; at < text.size(); ++at)
        if (const std::size_t end = text.find('`', at + 1); text[at] == '`' && end != std::string::npos) {
            parts.push_back(part(text.substr(from, at - from), text.substr(at + 1, end - at - 1)));
            at = end, from = end + 1;
        } else if (text.substr(at, 3) == "S_j") {
            parts.push_back(part(text.substr(from, at + 1 - from), "", "j"));
            at += 2, from = at + 1;
        }
    parts.push_back(part(text.substr(from)));
    return parts;
}

/// The heads over neighbouring columns of a group, and how many columns each has. Empty without groups.
std::vector<std::pair<std::string, std::size_t>> groups_of(const std::vector<Column>& columns) {
    std::vector<std::pair<std::string, std::size_t>> groups;
    for (const Column& column : columns)
        if (!groups.empty() && !column.group.empty() && groups.back().first == column.group)
            ++groups.back().second;
        else
            groups.emplace_back(column.group, 1);
    if (std::ranges::all_of(groups, [](const auto& group) { return group.first.empty(); })) groups.clear();
    return groups;
}

std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool to_the_right) {
    const std::string gap(width - std::min(width, width_of(text)), ' ');
    return to_the_right ? gap + text : text + gap;
}

/// The line without spaces at its end.
std::string without_gap(const std::string& line) { return line.substr(0, line.find_last_not_of(' ') + 1); }

std::string table_text(const StudyTable& table) {
    const std::vector<Column> columns = shown(table.columns, Shown::in_terminal);
    std::vector<std::vector<std::string>> lines(1);
    for (const Column& column : columns) lines[0].push_back(head_of(column));
    for (const Json& row : table.rows) {
        lines.emplace_back();
        for (const Column& column : columns)
            lines.back().push_back(written(value_of(row, column.key), column.notation, false));
    }
    std::vector<std::size_t> widths(columns.size(), 0);
    for (const auto& line : lines)
        for (std::size_t k = 0; k < line.size(); ++k) widths[k] = std::max(widths[k], width_of(line[k]));
    std::string text;
    std::size_t first = 0;
    for (const auto& [group, size] : groups_of(columns)) {
        std::size_t width = 2 * (size - 1);
        for (std::size_t k = first; k < first + size; ++k) width += widths[k];
        if (width_of(group) > width) widths[first] += width_of(group) - width, width = width_of(group);
        text += (first == 0 ? "" : "  ") + padded(group, width, true);
        first += size;
    }
    if (!text.empty()) text = without_gap(text) + '\n';
    for (const auto& line : lines) {
        std::string all;
        for (std::size_t k = 0; k < line.size(); ++k)
            all += (k == 0 ? "" : "  ") + padded(line[k], widths[k], is_number(columns[k]));
        text += without_gap(all) + '\n';
    }
    return text;
}

std::string csv_field(const Json& value) {
    if (value.is_null()) return "";
    if (!value.is_string()) return value.dump();
    std::string quoted;
    for (const char c : value.get_ref<const std::string&>()) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted.find_first_of(",\"\n\r") == std::string::npos ? quoted : '"' + quoted + '"';
}

Json pictures_view(const std::vector<StudyPicture>& pictures) {
    Json view = Json::array();
    for (const StudyPicture& picture : pictures)
        view.push_back({{"src", picture.file}, {"alt", picture.alt}, {"caption", marked(picture.caption)}});
    return view;
}

Json curve_view(const StudyCurve& curve) {
    constexpr double kBottom = 250;
    std::vector<double> values;
    std::ranges::copy_if(curve.at, std::back_inserter(values), [](double value) { return value > 0; });
    const chart::LogAxis y(values, 1, kBottom, chart::kTop);
    const double last = std::max<double>(1, static_cast<double>(curve.at.size()) - 1);
    const auto x      = [&](double step) { return chart::kLeft + step / last * (chart::kRight - chart::kLeft); };
    std::string path;
    for (std::size_t step = 0; step < values.size(); ++step)
        path += fmt::format("{}{} {}", step == 0 ? 'M' : 'L', chart::coordinate(x(static_cast<double>(step))),
                            chart::coordinate(y(values[step])));
    Json x_ticks = Json::array();
    for (const double part_of_it : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const double step = std::round(part_of_it * last);
        x_ticks.push_back({{"at", chart::coordinate(x(step))}, {"label", count(step)}});
    }
    return {{"path", path},         {"x_ticks", std::move(x_ticks)}, {"y_ticks", y.ticks()},
            {"steps", curve.steps}, {"values", curve.values},        {"caption", curve.caption}};
}

}  // namespace

Json table_view(const StudyTable& table) {
    const std::vector<Column> columns = shown(table.columns, Shown::on_page);
    Json heads = Json::array(), groups = Json::array(), rows = Json::array();
    for (const Column& column : columns) heads.push_back({{"parts", marked(head_of(column))}});
    for (const auto& [group, size] : groups_of(columns))
        groups.push_back({{"parts", marked(group)}, {"size", std::to_string(size)}});
    for (const Json& row : table.rows) {
        Json cells = Json::array();
        for (const Column& column : columns) {
            const std::string cell = written(value_of(row, column.key), column.notation, true);
            Json shown_part        = column.notation.kind == Notation::Kind::code ? part("", cell) : part(cell);
            if (const Json link = value_of(row, column.link); link.is_string())
                shown_part["link"] = address_of(link.get<std::string>());
            cells.push_back({{"parts", Json::array({std::move(shown_part)})}});
        }
        Json label = cells.front();
        cells.erase(0);
        rows.push_back({{"label", std::move(label)}, {"cells", std::move(cells)}});
    }
    return {{"id", table.name},
            {"caption", marked(table.caption)},
            {"groups", std::move(groups)},
            {"heads", std::move(heads)},
            {"rows", std::move(rows)}};
}

std::string study_text(const StudyReport& report) {
    std::string text;
    for (const StudyTable& table : shown(report.tables, Shown::in_terminal))
        text += (text.empty() ? "" : "\n") + table_text(table);
    for (const StudySentence& sentence : shown(report.sentences, Shown::in_terminal))
        text += std::regex_replace(sentence.text, std::regex("\u202f"), "") + '\n';
    return text;
}

std::string table_csv(const StudyTable& table) {
    std::string text;
    for (const Column& column : table.columns) text += (text.empty() ? "" : ",") + csv_field(column.key);
    text += '\n';
    for (const Json& row : table.rows)
        for (std::size_t k = 0; k < table.columns.size(); ++k)
            text += csv_field(value_of(row, table.columns[k].key)) + (k + 1 < table.columns.size() ? ',' : '\n');
    return text;
}

void write_study_page(const StudyReport& report, const HeadRecord& head, const fs::path& folder, StagedFiles& staged) {
    Json view       = report.words;
    view["command"] = without_folders(head.command), view["version"] = head.version;
    view["tables"] = Json::object(), view["pictures"] = Json::object();
    view["curves"] = Json::array(), view["sentences"] = Json::array();
    for (const StudyTable& table : shown(report.tables, Shown::on_page))
        view["tables"][table.name] = Json::array({table_view(table)});
    for (const auto& [name, pictures] : report.pictures) view["pictures"][name] = pictures_view(pictures);
    for (const StudyCurve& curve : report.curves) view["curves"].push_back(curve_view(curve));
    for (const StudySentence& sentence : shown(report.sentences, Shown::on_page))
        view["sentences"].push_back({{"parts", marked(sentence.text)}});
    write_page(folder, report.page, {report.title}, view, staged);
}

}  // namespace umbra
