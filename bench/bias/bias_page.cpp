#include "umbra/bench/bias/bias_page.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "report_assets.h"
#include "umbra/bench/pages/page_template.h"
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
    void add(double x, double y, const Json& errors) {
        for (std::size_t kind = 0; kind < kErrors.size(); ++kind)
            if (const int d = decade(errors[kErrors[kind]]["interior"].get<std::uint64_t>()); d > 0)
                paths_[kind][d - 1] += half_cell(x, y, kind, kCell);
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

json ticks(const Json& values, double first, double step, double offset) {
    json all = json::array();
    for (std::size_t i = 0; i < values.size(); ++i)
        all.push_back({{"at", fmt::format("{:g}", first + step * static_cast<double>(i) + offset)},
                       {"label", tick(values[i].get<double>())}});
    return all;
}

json slice_view(const Json& record, const Json& study, const Json& slice) {
    const Json &constants = record["constants"], &slopes = record["slopes"], &best = study["best_manual"];
    const double columns = static_cast<double>(constants.size()), rows = static_cast<double>(slopes.size());
    const double bottom = kTop + rows * kCell, side = kLeft + columns * kCell + 14;
    Paths paths;
    json marks = json::array();
    for (std::size_t row = 0; row < slopes.size(); ++row)
        for (std::size_t column = 0; column < constants.size(); ++column) {
            const double x = kLeft + static_cast<double>(column) * kCell;
            const double y = bottom - static_cast<double>(row + 1) * kCell;
            paths.add(x, y, slice["rows"][row][column]);
            if (best["normal_offset"] == slice["normal_offset"] && best["slope"] == slopes[row] &&
                best["constant"] == constants[column])
                marks.push_back({{"x", fmt::format("{:g}", x + kCell / 2)}, {"y", fmt::format("{:g}", y + kCell / 2)}});
        }
    // Beside the grid: neither has a position in it.
    paths.add(side, kTop + kCell, study["automatic"]);
    paths.add(side, kTop + 4 * kCell, study["receiver_plane"]);
    const auto text = [](double v) { return fmt::format("{:g}", v); };
    return {{"normal_offset", text(slice["normal_offset"].get<double>())},
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

json errors_view(const Json& errors) {
    const auto text = [&](const char* kind, const char* place) { return count(errors[kind][place].get<double>()); };
    return {{"shadow", text("false_shadow", "interior")},
            {"shadow_edge", text("false_shadow", "edge")},
            {"light", text("false_light", "interior")},
            {"light_edge", text("false_light", "edge")}};
}

json row(const std::string& name, const std::string& how, const Json& errors) {
    json view    = errors_view(errors);
    view["name"] = name, view["how"] = how;
    return view;
}

json study_view(const Json& record, const Json& study) {
    const Json& best = study["best_manual"];
    json slices      = json::array();
    for (const Json& slice : study["slices"]) slices.push_back(slice_view(record, study, slice));
    json first = slices.front();
    slices.erase(0);
    std::string lights;
    for (const Json& light : study["lights"]) lights += (lights.empty() ? "" : ", ") + light.get<std::string>();
    const auto all    = study["settings"].get<double>();
    const auto better = study["settings_better_than_automatic"].get<double>();
    return {{"id", study["scene"]},
            {"title", study["title"]},
            {"lights", lights},
            {"points", count(study["points"].get<double>())},
            {"first", json::array({std::move(first)})},
            {"others", std::move(slices)},
            {"best_below", best["normal_offset"] != study["slices"][0]["normal_offset"]},
            {"better", count(better)},
            {"settings", count(all)},
            {"auto", errors_view(study["automatic"])},
            {"best", errors_view(best)},
            {"plane", errors_view(study["receiver_plane"])},
            {"best_constant", fmt::format("{:g}", best["constant"].get<double>())},
            {"best_slope", fmt::format("{:g}", best["slope"].get<double>())},
            {"best_offset", fmt::format("{:g}", best["normal_offset"].get<double>())},
            {"rows",
             {row("auto", "the default", study["automatic"]),
              row("best manual",
                  fmt::format("constant={:g}, slope={:g}, normal_offset={:g}", best["constant"].get<double>(),
                              best["slope"].get<double>(), best["normal_offset"].get<double>()),
                  best),
              row("receiver_plane", "no bias beyond a rounding margin", study["receiver_plane"])}}};
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

void write_bias_page(const Json& record, const std::filesystem::path& out, StagedFiles& staged) {
    json studies = json::array();
    for (const Json& study : record["bias"]) studies.push_back(study_view(record, study));
    json failures = json::array();
    for (const Json& failure : record["failed"])
        failures.push_back(
            fmt::format("{}: {}", failure["scene"].get<std::string>(), failure["message"].get<std::string>()));
    const json view     = {{"command", without_folders(record["command"].get<std::string>())},
                           {"version", record["version"]},
                           {"width", fmt::format("{}", record["size"]["width"].get<int>())},
                           {"height", fmt::format("{}", record["size"]["height"].get<int>())},
                           {"map", record["map"]},
                           {"legend", legend()},
                           {"has_failures", !failures.empty()},
                           {"failures", std::move(failures)},
                           {"studies", std::move(studies)}};
    const PageHead head = {"The shadow z-buffer’s bias: acne against detachment", "", {}};
    staged.write(out / "index.html", render_page(assets::bias_html, head, view));
    write_page_assets(out, head.scripts, staged);
}

}  // namespace umbra
