#include "umbra/bench/motion/record_view.h"

#include <fmt/format.h>

#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/statistics/statistics.h"

namespace umbra {

bool is_ranked(const Json& noise_bar) { return !noise_bar.is_null() && !is_too_noisy(noise_bar.get<double>()); }

std::string coverage_text(const Json& ratio) {
    const double coverage = ratio.value("coverage", 0.0);
    return coverage > 0 ? fmt::format("{:.1f} %", 100 * coverage) : "-";
}

std::optional<double> answered_share(const Json& movement) {
    double answered = 0, asked = 0;
    for (const Json& frame : movement["frames"]) {
        answered += frame["points"].get<double>();
        asked += frame["points"].get<double>() + frame["undefined"].get<double>();
    }
    return asked > 0 ? std::optional(answered / asked) : std::nullopt;
}

nlohmann::json record_view(const Json& record, const char* place) {
    nlohmann::json failures = nlohmann::json::array();
    for (const Json& failure : record["failed"])
        failures.push_back(
            fmt::format("{}: {}: {}", text(failure[place]), text(failure["method"]), text(failure["message"])));
    const Json& load = record["load_average"];
    return {{"command", without_folders(text(record["command"]))},
            {"version", record["version"]},
            {"cpu", record["machine"]["cpu"]},
            {"threads", counted(record["machine"]["threads"].get<double>(), "thread")},
            {"load", fmt::format("{} to {}", score(value(load["before"])), score(value(load["after"])))},
            {"has_failures", !failures.empty()},
            {"failures", std::move(failures)}};
}

}  // namespace umbra
