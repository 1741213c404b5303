#include "umbra/bench/report/report_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "umbra/bench/base/statistics.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {

using nlohmann::json;

namespace {

using Samples = std::vector<double>;

/// Milliseconds of each round by what moved, as the page's columns are.
struct Movements {
    std::array<Samples, 3> ms;  ///< object, light, camera
    bool paired = false;        ///< its samples are of rounds, and of more than one
};
constexpr std::array<const char*, 3> kMovements{"object", "light", "camera"};

const Samples& samples(const std::optional<TimingRecord>& phase) {
    static const Samples none;
    return phase ? phase->samples : none;
}

Movements movements(const TurnTimesRecord& times) {
    const Samples &build = samples(times.phases.build_ms), &aim = samples(times.phases.aim_ms),
                  &visibility = samples(times.phases.visibility_ms);
    Samples look              = samples(times.phases.look_ms);
    if (!times.phases.look_ms) look.assign(visibility.size(), 0);  // records of older versions
    Movements m;
    m.paired = times.order.size() > 1;
    for (std::size_t r = 0; r < std::min({build.size(), aim.size(), look.size(), visibility.size()}); ++r) {
        m.ms[0].push_back(build[r] + aim[r] + look[r] + visibility[r]);
        m.ms[1].push_back(aim[r] + visibility[r]);
        m.ms[2].push_back(look[r] + visibility[r]);
    }
    return m;
}

struct Row {
    std::string label;
    Movements times;
};

std::string against(const Row& row, const Row& fastest, std::size_t movement, double bar) {
    const Samples &mine = row.times.ms[movement], &its = fastest.times.ms[movement];
    if (!row.times.paired || !fastest.times.paired)
        return fmt::format("×{}, one run", score(median(mine) / median(its)));
    const Ratio ratio = paired_ratio(mine, its);
    if (!ratio.has_interval()) return fmt::format("×{}, {} rounds", score(ratio.median), ratio.pairs);
    if (!differs(ratio, bar)) return "no difference";
    return fmt::format("×{} ({}–{}, {:.1f} %)", score(ratio.median), score(ratio.interval.low),
                       score(ratio.interval.high), 100 * ratio.coverage);
}

std::string bar_in_words(double bar) { return std::isfinite(bar) ? fmt::format("{:.1f} %", 100 * bar) : kNone; }

}  // namespace

json time_ratio_view(const Results& results) {
    const auto control = results.turns ? results.turns->control : std::nullopt;
    std::vector<Row> rows;
    std::array<Ratio, 3> same{};
    for (const MethodRecord& method : results.methods) {
        if (!serves(method) || !method.times) continue;
        Row row{method_label(method, results.methods), movements(*method.times)};
        if (row.times.ms[0].empty()) continue;
        if (control && method.text == control->text) {
            const Movements again = movements(control->again);
            for (std::size_t m = 0; m < same.size(); ++m) same[m] = paired_ratio(again.ms[m], row.times.ms[m]);
        }
        rows.push_back(std::move(row));
    }
    if (!results.turns || rows.empty()) return false;

    json table = json::array(), bars = json::array();
    for (const Row& row : rows) table.push_back({{"label", row.label}});
    for (std::size_t m = 0; m < kMovements.size(); ++m) {
        const auto faster  = [&](const Row& a, const Row& b) { return median(a.times.ms[m]) < median(b.times.ms[m]); };
        const auto fastest = std::min_element(rows.begin(), rows.end(), faster);
        const double bar   = noise_bar(same[m]);
        for (std::size_t k = 0; k < rows.size(); ++k)
            table[k][kMovements[m]] = &rows[k] == &*fastest ? "fastest" : against(rows[k], *fastest, m, bar);
        bars.push_back({{"movement", kMovements[m]}, {"bar", bar_in_words(bar)}});
    }
    const Samples& calibration = results.turns->calibration_ms;
    json view                  = {{"rows", std::move(table)}, {"bars", std::move(bars)}, {"calibrated", false}};
    if (!calibration.empty()) {
        const auto [least, largest] = std::minmax_element(calibration.begin(), calibration.end());
        view["calibrated"]          = {{"median", milliseconds(median(calibration))},
                                       {"least", milliseconds(*least)},
                                       {"largest", milliseconds(*largest)},
                                       {"rounds", std::to_string(calibration.size())}};
    }
    return view;
}

}  // namespace umbra
