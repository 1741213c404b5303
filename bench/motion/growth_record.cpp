#include <cmath>

#include "umbra/bench/motion/growth.h"

namespace umbra {
namespace {

/// What the external check compares: shadow volumes of silhouettes and of single triangles.
constexpr std::string_view kSilhouettes = "shadow_volumes:edges=silhouette",
                           kTriangles   = "shadow_volumes:edges=per_triangle";

/// Mean times of the shadow phases over a flight of 1000 frames through Sponza on a GPU, silhouette volumes over
/// per-triangle volumes (the method of Sintorn and others), computed from the tables of dormon/ShadowsTestData.
struct TheirRatio {
    int side;
    double silhouettes_ms, triangles_ms;
};
constexpr TheirRatio kTheirs[] = {{512, 1.86, 3.61}, {1024, 2.85, 6.66}, {2048, 6.04, 9.89}, {4096, 23.6, 18.7}};

Json interval_json(const Interval& interval) { return {number(interval.low), number(interval.high)}; }

Json fit_json(const GrowthRun& run, const GrowthSeries& series, Quantity quantity) {
    Json j = {{"quantity", to_string(quantity)}};
    if (const auto fit = fit_growth(series, quantity)) {
        j["exponent"]  = number(fit->law.exponent);
        j["interval"]  = interval_json(fit->law.exponent_interval);
        j["factor"]    = number(fit->law.factor);
        j["r_squared"] = number(fit->law.r_squared);
        j["points"]    = fit->law.points;
        j["range"]     = {fit->from, fit->to};
    }
    if (const auto theory = growth_theory(run.family->name, series.choice.info->name, quantity)) {
        j["theory"] = {{"interval", interval_json(theory->exponent)}, {"why", theory->why}};
        if (const auto fit = fit_growth(series, quantity))
            j["verdict"] = compare_with_theory(fit->law.exponent_interval, *theory);
    }
    return j;
}

Json series_json(const GrowthRun& run, const GrowthSeries& series) {
    Json j = {{"name", series.choice.info->name},
              {"title", series.choice.info->title},
              {"text", series.choice.text()},
              {"points", Json::array()},
              {"fits", Json::array()}};
    if (!series.left_out.empty()) j["left_out"] = series.left_out;
    for (const GrowthPoint& point : series.points)
        j["points"].push_back({{"x", point.x},
                               {"text", point.times.choice.text()},
                               {"times", to_record(turn_times_record(point.times))},
                               {"memory_bytes", point.times.memory_bytes},
                               {"noise_bar", number(point.noise_bar)}});
    for (const Quantity quantity : kQuantities) {
        Json fit = fit_json(run, series, quantity);
        if (fit.contains("exponent") || fit.contains("theory")) j["fits"].push_back(std::move(fit));
    }
    return j;
}

/// The fits of two methods at any x: a crossing outside the sizes is a guess, and so marked.
Json fitted_crossing_json(const GrowthRun& run, const GrowthSeries& a, const GrowthSeries& b, Quantity quantity) {
    const auto fit_a = fit_growth(a, quantity), fit_b = fit_growth(b, quantity);
    if (!fit_a || !fit_b) return nullptr;
    const auto found = crossing(fit_a->law, fit_b->law);
    if (!found) return nullptr;
    const bool inside = found->x >= run.sizes.front() && found->x <= run.sizes.back();
    return {{"x", number(found->x)}, {"interval", interval_json(found->interval)}, {"inside", inside}};
}

void add_crossings(const GrowthRun& run, Json& crossings) {
    for (std::size_t a = 0; a < run.series.size(); ++a)
        for (std::size_t b = a + 1; b < run.series.size(); ++b)
            for (const Quantity quantity : {Quantity::camera_frame, Quantity::light_frame, Quantity::object_frame})
                for (const MeasuredCrossing& c : measured_crossings(run.series[a], run.series[b], quantity)) {
                    const std::string first = run.series[a].choice.text(), second = run.series[b].choice.text();
                    crossings.push_back(
                        {{"quantity", to_string(quantity)},
                         {"below", c.first_is_faster_below ? first : second},
                         {"above", c.first_is_faster_below ? second : first},
                         {"x", number(c.x)},
                         {"between", interval_json(c.between)},
                         {"fitted", fitted_crossing_json(run, run.series[a], run.series[b], quantity)}});
                }
}

/// Where silhouettes and single triangles cross, beside others' figures; null where not both ran.
Json external_json(const GrowthRun& run) {
    const GrowthSeries *silhouettes = nullptr, *triangles = nullptr;
    for (const GrowthSeries& series : run.series) {
        if (series.choice.text() == kSilhouettes) silhouettes = &series;
        if (series.choice.text() == kTriangles) triangles = &series;
    }
    if (run.family->name != "pixels" || silhouettes == nullptr || triangles == nullptr) return nullptr;
    Json j = {{"source", "dormon/ShadowsTestData, Sponza, 1000 frames on a GPU"},
              {"quantity", to_string(Quantity::light_frame)},
              {"theirs", Json::array()},
              {"their_crossing", {2048.0 * 2048, 4096.0 * 4096}},
              {"ours", Json::array()},
              {"our_crossings", Json::array()}};
    for (const TheirRatio& t : kTheirs)
        j["theirs"].push_back({{"pixels", double(t.side) * t.side}, {"ratio", t.silhouettes_ms / t.triangles_ms}});
    for (const GrowthPoint& p : silhouettes->points)
        for (const GrowthPoint& q : triangles->points) {
            if (p.x != q.x) continue;
            const Ratio ratio = paired_ratio(GrowthSeries::rounds(p, Quantity::light_frame),
                                             GrowthSeries::rounds(q, Quantity::light_frame));
            j["ours"].push_back(
                {{"pixels", p.x},
                 {"ratio", number(ratio.median)},
                 {"interval", ratio.has_interval() ? interval_json(ratio.interval) : Json{nullptr, nullptr}},
                 {"coverage", ratio.coverage}});
        }
    for (const MeasuredCrossing& c : measured_crossings(*silhouettes, *triangles, Quantity::light_frame))
        j["our_crossings"].push_back(interval_json(c.between));
    return j;
}

}  // namespace

Json growth_json(const GrowthRun& run) {
    Json j = {{"name", run.family->name},   {"title", run.family->title},
              {"about", run.family->about}, {"unit", run.family->unit},
              {"sizes", run.sizes},         {"methods", Json::array()},
              {"crossings", Json::array()}, {"external", external_json(run)}};
    for (const GrowthSeries& series : run.series) j["methods"].push_back(series_json(run, series));
    add_crossings(run, j["crossings"]);
    return j;
}

}  // namespace umbra
