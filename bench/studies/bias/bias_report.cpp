#include "umbra/bench/studies/bias/bias_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>

#include "report_assets.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

// The heat map, in units of its viewBox.
constexpr double kCell = 22, kLeft = 46, kTop = 10;
constexpr std::array kErrors{"false_shadow", "false_light"};
constexpr int kDecades = 5;  // 1 to 9, 10 to 99, ..., from 10,000 on

int decade(std::uint64_t wrong) {
    return wrong == 0 ? 0 : std::min(kDecades, 1 + static_cast<int>(std::log10(static_cast<double>(wrong))));
}

/// Half a cell: false shadow on the upper left, false light on the lower right.
std::string half_cell(double x, double y, std::size_t kind, double cell) {
    return kind == 0 ? fmt::format("M{:g} {:g}h{:g}l{:g} {:g}z", x, y, cell, -cell, cell)
                     : fmt::format("M{:g} {:g}v{:g}h{:g}z", x + cell, y, cell, -cell);
}

/// One path per colour with all its half cells: thousands of elements would make a slow page.
class Paths {
public:
    void add(double x, double y, const BiasErrors& errors) {
        const std::array wrong{errors.false_shadow.interior, errors.false_light.interior};
        for (std::size_t kind = 0; kind < kErrors.size(); ++kind)
            if (const int d = decade(wrong[kind]); d > 0) paths_[kind][d - 1] += half_cell(x, y, kind, kCell);
    }
    [[nodiscard]] json view() const {
        json all = json::array();
        for (std::size_t kind = 0; kind < kErrors.size(); ++kind)
            for (int d = 0; d < kDecades; ++d)
                if (!paths_[kind][d].empty())
                    all.push_back({{"class", fmt::format("{}-{}", kErrors[kind], d + 1)}, {"d", paths_[kind][d]}});
        return all;
    }

private:
    std::array<std::array<std::string, kDecades>, kErrors.size()> paths_;
};

/// Eighths, quarters and halves as fractions, which are short.
std::string tick(double v) {
    return v > 0 && v < 1 && 1 / v == std::round(1 / v) ? fmt::format("1/{:g}", 1 / v) : fmt::format("{:.3g}", v);
}

json ticks(const std::vector<double>& values, double first, double step, double offset) {
    json all = json::array();
    for (std::size_t i = 0; i < values.size(); ++i)
        all.push_back(
            {{"at", fmt::format("{:g}", first + step * static_cast<double>(i) + offset)}, {"label", tick(values[i])}});
    return all;
}

json slice_view(const BiasGrid& grid, const BiasSceneRecord& study, const BiasSliceRecord& slice) {
    const std::vector<double>&constants = grid.constants, &slopes = grid.slopes;
    const BiasCell& best = study.best_manual;
    const double columns = static_cast<double>(constants.size()), rows = static_cast<double>(slopes.size());
    const double bottom = kTop + rows * kCell, side = kLeft + columns * kCell + 14;
    Paths paths;
    json marks = json::array();
    for (std::size_t row = 0; row < slopes.size(); ++row)
        for (std::size_t column = 0; column < constants.size(); ++column) {
            const double x = kLeft + static_cast<double>(column) * kCell;
            const double y = bottom - static_cast<double>(row + 1) * kCell;
            paths.add(x, y, slice.rows[row][column]);
            if (best.normal_offset == slice.normal_offset && best.slope == slopes[row] &&
                best.constant == constants[column])
                marks.push_back({{"x", fmt::format("{:g}", x + kCell / 2)}, {"y", fmt::format("{:g}", y + kCell / 2)}});
        }
    // Beside the grid: neither has a position in it.
    paths.add(side, kTop + kCell, study.automatic);
    paths.add(side, kTop + 4 * kCell, study.receiver_plane);
    const auto text = [](double v) { return fmt::format("{:g}", v); };
    return {{"normal_offset", text(slice.normal_offset)},
            {"width", text(side + 3 * kCell + 4)},
            {"height", text(bottom + 40)},
            {"left", text(kLeft)},
            {"top", text(kTop)},
            {"bottom", text(bottom)},
            {"grid_width", text(columns * kCell)},
            {"grid_height", text(rows * kCell)},
            {"middle_x", text(kLeft + columns * kCell / 2)},
            {"middle_y", text(kTop + rows * kCell / 2)},
            {"side", text(side)},
            {"cell", text(kCell)},
            {"automatic_y", text(kTop + kCell)},
            {"automatic_label", text(kTop + kCell - 5)},
            {"receiver_y", text(kTop + 4 * kCell)},
            {"receiver_label", text(kTop + 4 * kCell - 5)},
            {"title_y", text(bottom + 34)},
            {"tick_y", text(bottom + 15)},
            {"x_ticks", ticks(constants, kLeft, kCell, kCell / 2)},
            {"y_ticks", ticks(slopes, bottom, -kCell, -kCell / 2 + 4)},
            {"paths", paths.view()},
            {"marks", std::move(marks)}};
}

/// Columns of false shadow and false light at a place of the errors in a member of a row.
void add_errors(std::vector<Column>& columns, const std::string& member, const std::string& group) {
    for (const auto& [kind, head] : {std::pair{"false_shadow", "shadow"}, {"false_light", "light"}})
        columns.push_back({fmt::format("{}.{}.interior", member, kind), head, kCount, "", group});
}

StudyTable summary(const BiasRecord& record) {
    StudyTable table{.name    = "bias",
                     .caption = "Wrong interior points, sums over all lights of a scene",
                     .columns = {{.key = "scene", .head = "scene", .shown = Shown::in_terminal},
                                 {.key = "title", .head = "scene", .shown = Shown::on_page, .link = "scene"},
                                 {"points", "points", kCount}},
                     .rows    = to_record(record.bias)};
    add_errors(table.columns, "automatic", "auto");
    add_errors(table.columns, "best_manual", "best manual");
    for (const char* setting : {"constant", "slope", "normal_offset"})
        table.columns.push_back(
            {std::string("best_manual.") + setting, in_words(setting), kGeneral, "", "best manual"});
    add_errors(table.columns, "receiver_plane", "receiver plane");
    table.columns.push_back({"better", "settings better than auto"});
    for (std::size_t k = 0; k < record.bias.size(); ++k)
        table.rows[k]["better"] =
            fmt::format("{} of {}", record.bias[k].settings_better_than_automatic, record.bias[k].settings);
    return table;
}

StudyTable notable(const BiasSceneRecord& study) {
    const BiasCell& best = study.best_manual;
    StudyTable table{.name    = "settings-" + study.scene,
                     .caption = "Notable settings",
                     .columns = {{"name", "setting", kCode},
                                 {"how", "what it is"},
                                 {"false_shadow.interior", "interior", kCount, "", "false shadow"},
                                 {"false_shadow.edge", "edge band", kCount, "", "false shadow"},
                                 {"false_light.interior", "interior", kCount, "", "false light"},
                                 {"false_light.edge", "edge band", kCount, "", "false light"}},
                     .rows    = {to_record(study.automatic), to_record(best), to_record(study.receiver_plane)}};
    table.rows[0]["name"] = "auto", table.rows[0]["how"] = "the default";
    table.rows[1]["name"] = "best manual";
    table.rows[1]["how"] =
        fmt::format("constant={:g}, slope={:g}, normal_offset={:g}", best.constant, best.slope, best.normal_offset);
    table.rows[2]["name"] = "receiver_plane", table.rows[2]["how"] = "no bias beyond a rounding margin";
    return table;
}

json study_view(const BiasGrid& grid, const BiasSceneRecord& study) {
    json slices = json::array();
    for (const BiasSliceRecord& slice : study.slices) slices.push_back(slice_view(grid, study, slice));
    json first = slices.front();
    slices.erase(0);
    return {{"id", study.scene},
            {"title", study.title},
            {"lights", fmt::format("{}", fmt::join(study.lights, ", "))},
            {"points", count(double(study.points))},
            {"first", json::array({std::move(first)})},
            {"others", std::move(slices)},
            {"best_below", study.best_manual.normal_offset != study.slices.front().normal_offset},
            {"settings", json::array({table_view(notable(study))})}};
}

json legend() {
    json all = json::array();
    for (int d = 0; d <= kDecades; ++d) {
        json view = {{"label", d == 0          ? "0"
                               : d == kDecades ? "10 000 and more"
                                               : fmt::format("{:g} to {:g}", std::pow(10, d - 1), std::pow(10, d) - 1)},
                     {"halves", json::array()}};
        for (std::size_t kind = 0; kind < kErrors.size() && d > 0; ++kind)
            view["halves"].push_back(
                {{"class", fmt::format("{}-{}", kErrors[kind], d)}, {"d", half_cell(1, 1, kind, 18)}});
        all.push_back(std::move(view));
    }
    return all;
}

}  // namespace

StudyReport bias_report(const BiasRecord& record) {
    json studies = json::array();
    for (const BiasSceneRecord& study : record.bias) studies.push_back(study_view(record.grid, study));
    json failures = json::array();
    for (const ListedFailureRecord& failed : record.failed)
        failures.push_back(fmt::format("{}: {}", failed.scene, failed.failure.message));
    return {.title  = "The shadow z-buffer’s bias: acne against detachment",
            .page   = assets::bias_html,
            .tables = {summary(record)},
            .words  = {{"width", fmt::format("{}", record.size.width.value_or(0))},
                       {"height", fmt::format("{}", record.size.height.value_or(0))},
                       {"map", record.map},
                       {"legend", legend()},
                       {"failures", std::move(failures)},
                       {"studies", std::move(studies)}}};
}

}  // namespace umbra
