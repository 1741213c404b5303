#include "umbra/bench/studies/motion/growth_record.h"

#include <cmath>

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

QuantityRecord quantity_record(const GrowthRun& run, const GrowthSeries& series, Quantity quantity) {
    QuantityRecord record{.quantity = std::string(to_string(quantity))};
    const auto fit = fit_growth(series, quantity);
    if (fit)
        record.fit = {.exponent  = fit->exponent,
                      .interval  = ends(fit->exponent_interval),
                      .factor    = fit->factor,
                      .r_squared = fit->r_squared,
                      .points    = static_cast<std::uint64_t>(fit->points),
                      .range     = ends(fit->range)};
    if (const auto theory = growth_theory(run.family->name, series.choice.info->name, quantity)) {
        record.theory = TheoryRecord{.interval = ends(theory->exponent), .why = std::string(theory->why)};
        if (fit) record.verdict = compare_with_theory(fit->exponent_interval, *theory);
    }
    return record;
}

GrowthSeriesRecord series_record(const GrowthRun& run, const GrowthSeries& series) {
    GrowthSeriesRecord record{.name     = std::string(series.choice.info->name),
                              .title    = std::string(series.choice.info->title),
                              .text     = series.choice.text(),
                              .left_out = series.left_out};
    for (const GrowthPoint& point : series.points)
        record.points.push_back({.x            = point.x,
                                 .text         = point.times.choice.text(),
                                 .times        = turn_times_record(point.times),
                                 .memory_bytes = point.times.memory_bytes,
                                 .noise_bar    = point.noise_bar});
    for (const Quantity quantity : kQuantities) {
        QuantityRecord fitted = quantity_record(run, series, quantity);
        if (fitted.fit.points > 0 || fitted.theory) record.fits.push_back(std::move(fitted));
    }
    return record;
}

/// The fits of two methods at any x: a crossing outside the sizes is a guess, and so marked.
std::optional<FittedCrossingRecord> fitted_crossing(const GrowthRun& run, const GrowthSeries& a, const GrowthSeries& b,
                                                    Quantity quantity) {
    const auto fit_a = fit_growth(a, quantity), fit_b = fit_growth(b, quantity);
    if (!fit_a || !fit_b) return std::nullopt;
    const auto found = crossing(*fit_a, *fit_b);
    if (!found) return std::nullopt;
    const bool inside = found->x >= run.sizes.front() && found->x <= run.sizes.back();
    return FittedCrossingRecord{.x = found->x, .interval = ends(found->interval), .inside = inside};
}

std::vector<CrossingRecord> crossing_records(const GrowthRun& run) {
    std::vector<CrossingRecord> records;
    for (std::size_t a = 0; a < run.series.size(); ++a)
        for (std::size_t b = a + 1; b < run.series.size(); ++b)
            for (const Quantity quantity : {Quantity::camera_frame, Quantity::light_frame, Quantity::object_frame})
                for (CrossingRecord& c : measured_crossings(run.series[a], run.series[b], quantity)) {
                    c.fitted = fitted_crossing(run, run.series[a], run.series[b], quantity);
                    records.push_back(std::move(c));
                }
    return records;
}

/// Where silhouettes and single triangles cross, beside others' figures; nothing where not both ran.
std::optional<ExternalRecord> external_record(const GrowthRun& run) {
    const GrowthSeries *silhouettes = nullptr, *triangles = nullptr;
    for (const GrowthSeries& series : run.series) {
        if (series.choice.text() == kSilhouettes) silhouettes = &series;
        if (series.choice.text() == kTriangles) triangles = &series;
    }
    if (run.family->name != "pixels" || silhouettes == nullptr || triangles == nullptr) return std::nullopt;
    ExternalRecord record{.source         = "dormon/ShadowsTestData, Sponza, 1000 frames on a GPU",
                          .quantity       = std::string(to_string(Quantity::light_frame)),
                          .their_crossing = {2048.0 * 2048, 4096.0 * 4096}};
    for (const TheirRatio& t : kTheirs)
        record.theirs.push_back({.pixels = double(t.side) * t.side, .ratio = t.silhouettes_ms / t.triangles_ms});
    for (const GrowthPoint& p : silhouettes->points)
        for (const GrowthPoint& q : triangles->points) {
            if (p.x != q.x) continue;
            const Ratio ratio = paired_ratio(GrowthSeries::rounds(p, Quantity::light_frame),
                                             GrowthSeries::rounds(q, Quantity::light_frame));
            const auto none   = std::vector<double>{kUnknown, kUnknown};
            record.ours.push_back({.pixels   = p.x,
                                   .ratio    = ratio.median,
                                   .interval = ratio.has_interval() ? ends(ratio.interval) : none,
                                   .coverage = ratio.coverage});
        }
    for (const CrossingRecord& c : measured_crossings(*silhouettes, *triangles, Quantity::light_frame))
        record.our_crossings.push_back(c.between);
    return record;
}

}  // namespace

Allowed quantities() {
    Allowed allowed;
    for (const Quantity quantity : kQuantities) allowed.words.push_back(to_string(quantity));
    return allowed;
}

std::vector<CrossingRecord> measured_crossings(const GrowthSeries& a, const GrowthSeries& b, Quantity quantity) {
    struct Decided {
        double x, log_ratio;
    };
    std::optional<Decided> before;
    std::vector<CrossingRecord> found;
    for (const GrowthPoint& p : a.points)
        for (const GrowthPoint& q : b.points) {
            if (p.x != q.x) continue;
            const Ratio ratio = paired_ratio(GrowthSeries::rounds(p, quantity), GrowthSeries::rounds(q, quantity));
            if (ratio.pairs == 0 || !differs(ratio, p.noise_bar)) continue;
            const Decided now{p.x, std::log(ratio.median)};
            if (before && (before->log_ratio < 0) != (now.log_ratio < 0)) {
                const double t     = before->log_ratio / (before->log_ratio - now.log_ratio);
                const bool a_below = before->log_ratio < 0;
                found.push_back({.quantity = std::string(to_string(quantity)),
                                 .below    = (a_below ? a : b).choice.text(),
                                 .above    = (a_below ? b : a).choice.text(),
                                 .x        = before->x * std::pow(now.x / before->x, t),
                                 .between  = {before->x, now.x}});
            }
            before = now;
        }
    return found;
}

FamilyRecord family_record(const GrowthRun& run) {
    FamilyRecord record{.name      = std::string(run.family->name),
                        .title     = std::string(run.family->title),
                        .about     = std::string(run.family->about),
                        .unit      = std::string(run.family->unit),
                        .sizes     = run.sizes,
                        .crossings = crossing_records(run),
                        .external  = external_record(run)};
    for (const GrowthSeries& series : run.series) record.methods.push_back(series_record(run, series));
    return record;
}

}  // namespace umbra
