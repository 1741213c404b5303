#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/motion/motion.h"
#include "umbra/bench/motion/record_view.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/statistics/statistics.h"

namespace umbra {
namespace {

std::string number_text(const Json& value, int digits = 2) {
    return value.is_null() ? "-" : fmt::format("{:.{}f}", value.get<double>(), digits);
}

std::string noise_text(const Json& noise_bar) {
    if (noise_bar.is_null()) return "not ranked: without a control no two times differ";
    const double bar = noise_bar.get<double>();
    return fmt::format("{}times that differ by less than {:.0f} % are equal{}", is_too_noisy(bar) ? "not ranked: " : "",
                       std::ceil(100 * bar), is_too_noisy(bar) ? "; run it again when the machine is less busy" : "");
}

std::string winner_text(const Json& winner, bool ranked) {
    if (winner.is_null()) return "none";
    if (!ranked) return "not ranked";
    std::string text = fmt::format("{} {} ms", winner["method"].get<std::string>(), number_text(winner["ms"]));
    for (const Json& tie : winner["ties"]) text += " = " + tie.get<std::string>();
    if (winner["ties"].empty() && !winner["runner_up"].is_null())
        text += fmt::format(" (next: {}, x {})", winner["runner_up"].get<std::string>(),
                            number_text(winner["runner_up_over_winner"]["median"]));
    return text;
}

/// "97.9 %" of the points of all frames.
std::string answered_text(const Json& movement) {
    const std::optional<double> share = answered_share(movement);
    return share ? percent(share) + " %" : "-";
}

/// Of fewer than six frames there is no interval.
std::string method_rows(const Json& scene) {
    std::string text =
        fmt::format("  {:34} {:8} {:>10} {:>10} {:>8}  {:>17} {:>7} {:>10} {:>10} {:>10} {:>10}\n", "method", "moves",
                    "median ms", "model", "ratio", "interval", "holds", "mean rmse", "worst", "interior", "answered");
    for (const Json& method : scene["methods"]) {
        const std::string name = method["text"];
        if (method.contains("failed"))
            text += fmt::format("  {:34} failed: {}\n", name, method["failed"].get<std::string>());
        else if (!method.contains("movements"))
            text += fmt::format("  {:34} does not serve: {}\n", name, method["serves"]["why"].get<std::string>());
        if (!method.contains("movements")) continue;
        for (const auto& [movement, m] : method["movements"].items()) {
            const auto frames    = static_cast<double>(m["frames"].size());
            const Json& interval = m["frame_over_model"]["interval"];
            text += fmt::format("  {:34} {:8} {:>10} {:>10.2f} {:>8}  {:>8} {:>8} {:>7} {:>10} {:>10} {:>10} {:>10}\n",
                                name, movement, number_text(m["median_ms"]), m["model_ms"].get<double>() / frames,
                                number_text(m["frame_over_model"]["median"]), number_text(interval[0]),
                                number_text(interval[1]), coverage_text(m["frame_over_model"]),
                                number_text(m["mean_rmse"], 4), number_text(m["worst_rmse"], 4),
                                m["interior"].is_null() ? "-" : m["interior"].dump(), answered_text(m));
        }
    }
    return text;
}

}  // namespace

std::string motion_table(const Json& record) {
    std::string text;
    for (const Json& scene : record["motion"]) {
        text += fmt::format("{}: {} triangles, {} x {}, {} frames a movement, no method updates incrementally\n",
                            scene["scene"].get<std::string>(), scene["triangles"].get<std::size_t>(),
                            scene["size"]["width"].get<int>(), scene["size"]["height"].get<int>(),
                            record["frames"].get<int>());
        for (const Json& movement : scene["movements"])
            text += fmt::format("  {:8} {}\n", movement["movement"].get<std::string>(),
                                movement.contains("cannot") ? "cannot: " + movement["cannot"].get<std::string>()
                                                            : movement["what"].get<std::string>());
        text += method_rows(scene);
        text += fmt::format(
            "  fastest by median of those that answer every point; the same with an RMSE of at most {:g} in every "
            "frame; {}\n",
            record["max_rmse"].get<double>(), noise_text(scene["noise_bar"]));
        const bool ranked = is_ranked(scene["noise_bar"]);
        for (const Json& row : scene["winners"])
            text += fmt::format("  {:28} {:60} | {}\n", row["mix"].get<std::string>(),
                                winner_text(row["complete"], ranked), winner_text(row["within"], ranked));
        for (const Json& pair : scene["break_even"])
            text += fmt::format(
                "  {} pays off over {} from {} on{}\n", pair["method"].get<std::string>(),
                pair["over"].get<std::string>(), counted(pair["frames"].get<double>(), "camera frame"),
                pair["rounds"][0] == pair["rounds"][1]
                    ? ""
                    : fmt::format(" ({} to {} by the rounds)", number_text(pair["rounds"][0], 0),
                                  pair["rounds"][1].is_null() ? "never" : number_text(pair["rounds"][1], 0)));
    }
    text += fmt::format("{}, {}, load average {} to {}\n", record["machine"]["cpu"].get<std::string>(),
                        counted(record["machine"]["threads"].get<double>(), "thread"),
                        number_text(record["load_average"]["before"]), number_text(record["load_average"]["after"]));
    return text;
}

}  // namespace umbra
