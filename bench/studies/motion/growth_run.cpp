#include "umbra/bench/studies/motion/growth_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/core/base/error.h"

namespace umbra {
namespace {

/// The least of the rounds, or the memory; positive and long enough to fit, or nothing.
std::optional<double> fitted_value(const GrowthPoint& point, Quantity quantity) {
    if (quantity == Quantity::memory) {
        const auto bytes = static_cast<double>(point.times.memory_bytes);
        return bytes > 0 ? std::optional(bytes) : std::nullopt;
    }
    const std::vector<double> rounds = GrowthSeries::rounds(point, quantity);
    const double ms                  = *std::ranges::min_element(rounds);
    return ms >= kShortest ? std::optional(ms) : std::nullopt;
}

/// Adds the times at one size to the series.
void keep(Turns turns, double x, double longest_ms, const std::vector<std::size_t>& which, GrowthRun& run) {
    for (std::size_t k = 0; k < which.size(); ++k) {
        GrowthSeries& series = run.series[which[k]];
        TurnTimes& times     = turns.settings[k];
        if (!times.service)
            series.left_out = fmt::format("does not serve from {:g} on: {}", x, times.service.why);
        else if (!times.failed.empty())
            series.left_out = fmt::format("failed at {:g}: {}", x, times.failed);
        else {
            const double ms = times.cold.all();
            if (ms > longest_ms) series.left_out = fmt::format("took {:.0f} ms at {:g}", ms, x);
            series.points.push_back({x, std::move(times), turns.noise_bar});
        }
    }
}

}  // namespace

std::vector<double> GrowthSeries::rounds(const GrowthPoint& point, Quantity quantity) {
    const TurnTimes& t = point.times;
    switch (quantity) {
        case Quantity::build: return t.build;
        case Quantity::aim: return t.aim;
        case Quantity::camera_frame:
        case Quantity::light_frame:
        case Quantity::object_frame: break;
        case Quantity::memory: return {static_cast<double>(t.memory_bytes)};
    }
    std::vector<double> sums(t.visibility);
    for (std::size_t r = 0; r < sums.size(); ++r)
        sums[r] += (quantity != Quantity::light_frame ? t.look[r] : 0) +
                   (quantity != Quantity::camera_frame ? t.aim[r] : 0) +
                   (quantity == Quantity::object_frame ? t.build[r] : 0);
    return sums;
}

GrowthRun run_growth(const GrowthFamily& family, const std::vector<MethodChoice>& choices, double up_to,
                     const GrowthOptions& options) {
    GrowthRun run{&family, {}, {}};
    for (const MethodChoice& choice : choices) {
        run.series.push_back({choice});
        if (family.at(choice, family.least).empty())
            run.series.back().left_out = fmt::format("has no parameter for {}", family.name);
    }
    for (const double asked : family.sizes(up_to)) {
        std::vector<MethodChoice> settings;
        std::vector<std::size_t> which;
        for (std::size_t m = 0; m < run.series.size(); ++m) {
            if (!run.series[m].left_out.empty()) continue;
            settings.push_back(family.at(choices[m], asked).front());
            which.push_back(m);
        }
        if (settings.empty()) break;
        if (options.progress) options.progress(fmt::format("{}: {:g} {}", family.name, asked, family.unit));
        const PreparedScene prepared = prepare_growth(family, asked);
        const double x               = family.size(prepared.scene, asked);
        run.sizes.push_back(x);
        keep(time_in_turns(prepared, settings, options.turns), x, options.longest_ms, which, run);
    }
    return run;
}

std::optional<PowerLaw> fit_growth(const GrowthSeries& series, Quantity quantity) {
    std::vector<double> x, y;
    const double largest = series.points.empty() ? 0 : series.points.back().x;
    for (const GrowthPoint& point : series.points) {
        const std::optional<double> value = fitted_value(point, quantity);
        if (point.x < largest / 100 * (1 - 1e-9) || !value) continue;
        x.push_back(point.x);
        y.push_back(*value);
    }
    if (x.size() < 3) return std::nullopt;
    return fit_power_law(x, y);
}

}  // namespace umbra
