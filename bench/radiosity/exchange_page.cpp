#include "umbra/bench/radiosity/exchange_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report_assets.h"
#include "umbra/bench/pages/chart_parts.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/record_folder.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

constexpr double kBottom = 250;

/// Unshot power, logarithmic, over the steps, linear.
json curve(const Json& unshot) {
    std::vector<double> values;
    for (const Json& value : unshot)
        if (const auto share = value.get<double>(); share > 0) values.push_back(share);
    const chart::LogAxis y(values, 1, kBottom, chart::kTop);
    const double last = std::max<double>(1, static_cast<double>(unshot.size()) - 1);
    const auto x      = [&](double step) { return chart::kLeft + step / last * (chart::kRight - chart::kLeft); };
    std::string path;
    for (std::size_t step = 0; step < values.size(); ++step)
        path += fmt::format("{}{} {}", step == 0 ? 'M' : 'L', chart::coordinate(x(static_cast<double>(step))),
                            chart::coordinate(y(values[step])));
    json x_ticks = json::array();
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const double step = std::round(share * last);
        x_ticks.push_back({{"at", chart::coordinate(x(step))}, {"label", count(step)}});
    }
    return {{"path", path}, {"x_ticks", std::move(x_ticks)}, {"y_ticks", y.ticks()}};
}

}  // namespace

void write_exchange_page(const Json& record, const std::filesystem::path& folder, StagedFiles& staged) {
    const Json& unshot = record["unshot"];
    json elements      = json::array();
    for (const Json& entry : record["elements"])
        elements.push_back({{"light", entry["light"]}, {"picture", entry["picture"]}});
    const json view     = {{"title", record["scene"]["title"]},
                           {"command", without_folders(record["command"].get<std::string>())},
                           {"version", record["version"]},
                           {"patches", count(record["patches"].get<double>())},
                           {"steps", count(record["steps"].get<double>())},
                           {"left", fmt::format("{:.2g} %", 100 * unshot.back().get<double>())},
                           {"arrived", fmt::format("{:.1f} %", 100 * record["arrived"].get<double>())},
                           {"curve", json::array({curve(unshot)})},
                           {"elements", std::move(elements)}};
    const PageHead head = {fmt::format("Radiosity: {}", record["scene"]["title"].get<std::string>()), "", {}};
    staged.write(folder / "index.html", render_page(assets::radiosity_html, head, view));
    write_page_assets(folder, head.scripts, staged);
}

Json write_exchange_study(const PreparedScene& prepared, const ExchangeOptions& options,
                          const std::filesystem::path& out) {
    return write_record_folder(
        out, [&](const std::filesystem::path& folder) { return exchange_light(prepared, options, folder); },
        write_exchange_page);
}

}  // namespace umbra
