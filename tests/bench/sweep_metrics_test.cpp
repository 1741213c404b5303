#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <random>

#include "made_cell.h"
#include "umbra/bench/sweep/bounds.h"
#include "umbra/bench/sweep/metrics.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

Json direction(int shadow, int light) { return {{"false_shadow", shadow}, {"false_light", light}}; }

/// An entry of `errors` with a figure of its own in each place.
Json light_error(int points, double scale) {
    return {{"light", "l"},
            {"points", points},
            {"false_shadow", {{"interior", 3 * scale}, {"edge", 5 * scale}, {"acne", 2 * scale}}},
            {"false_light",
             {{"interior", 7 * scale}, {"edge", 11 * scale}, {"detachment", 1 * scale}, {"leak", 6 * scale}}},
            {"penumbra_error", direction(int(13 * scale), int(17 * scale))},
            {"noise_error", direction(int(19 * scale), int(23 * scale))},
            {"terminator", {{"wrong", 29 * scale}}},
            {"bracket", nullptr},
            {"mae", 0.01 * scale},
            {"rmse", 0.03 * scale},
            {"max", 0.1 * scale},
            {"edge_displacement_px", {{"mean", 0.2 * scale}, {"p95", 0.4 * scale}, {"max", 0.8 * scale}}}};
}

Cell cell(std::vector<Json> errors) {
    return cell_from({{"text", "m"},
                      {"serves", {{"how", "approximately"}, {"why", ""}}},
                      {"undefined", 0.25},
                      {"memory_bytes", 3000000},
                      {"image", {{"rmse", 0.004}, {"flip", 0.005}, {"flip_hdr", 0.006}}},
                      {"errors", std::move(errors)}});
}

double value(const char* name, const Cell& c) {
    const auto v = metric_value(find_metric(name), c);
    EXPECT_TRUE(v.has_value()) << name;
    return v.value_or(-1);
}

TEST(Metrics, ReadTheirOwnPlaces) {
    const Cell c                                               = cell({light_error(1000, 1)});
    const std::vector<std::pair<const char*, double>> expected = {{"rmse", 0.03},
                                                                  {"mae", 0.01},
                                                                  {"max", 0.1},
                                                                  {"interior", 0.010},
                                                                  {"edge", 0.016},
                                                                  {"false_shadow.interior", 0.003},
                                                                  {"false_shadow.edge", 0.005},
                                                                  {"false_shadow.acne", 0.002},
                                                                  {"false_light.interior", 0.007},
                                                                  {"false_light.edge", 0.011},
                                                                  {"false_light.detachment", 0.001},
                                                                  {"false_light.leak", 0.006},
                                                                  {"penumbra_error", 0.030},
                                                                  {"noise_error", 0.042},
                                                                  {"terminator.wrong", 0.029},
                                                                  {"edge_displacement_px.mean", 0.2},
                                                                  {"edge_displacement_px.p95", 0.4},
                                                                  {"edge_displacement_px.max", 0.8},
                                                                  {"image_rmse", 0.004},
                                                                  {"flip", 0.005},
                                                                  {"flip_hdr", 0.006},
                                                                  {"undefined", 0.25},
                                                                  {"memory_mb", 3}};
    EXPECT_EQ(expected.size(), metrics().size());
    for (const auto& [name, v] : expected) EXPECT_NEAR(value(name, c), v, 1e-15) << name;
}

TEST(Metrics, PoolLightsByTheirPoints) {
    const Cell c = cell({light_error(1000, 1), light_error(3000, 2)});
    EXPECT_NEAR(value("rmse", c), std::sqrt((1000 * 0.03 * 0.03 + 3000 * 0.06 * 0.06) / 4000), 1e-15);
    EXPECT_NEAR(value("mae", c), (1000 * 0.01 + 3000 * 0.02) / 4000, 1e-15);
    EXPECT_NEAR(value("max", c), 0.2, 1e-15);
    EXPECT_NEAR(value("interior", c), (10 + 20) / 4000.0, 1e-15);
    EXPECT_NEAR(value("edge_displacement_px.p95", c), 0.8, 1e-15);
}

TEST(Metrics, SayNothingOfWhatWasNotJudged) {
    const Json empty = light_error(0, 0);
    const Cell c     = cell({light_error(1000, 1), empty});
    EXPECT_NEAR(value("rmse", c), 0.03, 1e-15);
    Json unnamed                    = light_error(1000, 1);
    unnamed["false_light"]["leak"]  = nullptr;
    unnamed["edge_displacement_px"] = nullptr;
    EXPECT_EQ(metric_value(find_metric("false_light.leak"), cell({light_error(1000, 1), unnamed})), std::nullopt);
    EXPECT_EQ(metric_value(find_metric("edge_displacement_px.p95"), cell({unnamed})), std::nullopt);
    EXPECT_NEAR(value("edge_displacement_px.p95", cell({unnamed, light_error(10, 1)})), 0.4, 1e-15);
    for (const Metric& m : metrics()) {
        if (m.kind != Metric::Kind::entry) {
            EXPECT_EQ(metric_value(m, cell({empty})), std::nullopt) << m.name;
        }
    }
    const Cell unserved = cell_from({{"text", "m"}, {"serves", {{"how", "not"}, {"why", "x"}}}});
    for (const Metric& m : metrics()) EXPECT_EQ(metric_value(m, unserved), std::nullopt) << m.name;
    EXPECT_THROW(static_cast<void>(find_metric("psnr")), UsageError);
}

/// Of `pieces` of the edge, `unmatched` are not found within 8 pixels.
Json with_edges(const Json& mean, const Json& p95, const Json& max, int pieces, int unmatched) {
    Json e                    = light_error(1000, 1);
    e["edge_displacement_px"] = {{"mean", mean},           {"p95", p95}, {"max", max}, {"pieces", pieces},
                                 {"unmatched", unmatched}, {"reach", 8}};
    return e;
}

TEST(Metrics, EdgesThatAreNotFoundAreTheReachAway) {
    const Json near = with_edges(0.5, 1, 1.75, 100, 0), lost = with_edges(nullptr, nullptr, nullptr, 100, 100);
    for (const char* name : {"edge_displacement_px.mean", "edge_displacement_px.p95", "edge_displacement_px.max"}) {
        const Metric& metric = find_metric(name);
        EXPECT_EQ(value(name, cell({near, lost})), 8) << name;
        EXPECT_TRUE(is_at_least(metric, cell({near, lost}))) << name;
        EXPECT_EQ(upper_bound(metric, std::vector{cell({near}), cell({near, lost})}), std::nullopt) << name;
        EXPECT_FALSE(is_at_least(metric, cell({near}))) << name;
        EXPECT_TRUE(upper_bound(metric, std::vector{cell({near}), cell({near})})) << name;
    }
    EXPECT_FALSE(is_at_least(find_metric("max"), cell({lost})));
    // 9 pieces at 1 on average and one beyond 8; of 10 pieces in order the ninth is the 95th percentile.
    const Cell torn = cell({with_edges(1, 1.5, 2, 10, 1)});
    EXPECT_NEAR(value("edge_displacement_px.mean", torn), (9 * 1 + 8) / 10.0, 1e-15);
    EXPECT_EQ(value("edge_displacement_px.p95", torn), 2);
    EXPECT_FALSE(is_at_least(find_metric("edge_displacement_px.p95"), torn));
    EXPECT_EQ(value("edge_displacement_px.max", torn), 8);
    EXPECT_EQ(value("edge_displacement_px.p95", cell({with_edges(1, 1.5, 2, 10, 2)})), 8);
    // A record that does not say how far its edges are off, of edges that there are.
    EXPECT_EQ(metric_value(find_metric("edge_displacement_px.max"), cell({near, with_edges(1, 1, nullptr, 10, 0)})),
              std::nullopt);
}

TEST(Metrics, ALightWithoutAnAnswerIsUnknown) {
    for (const char* why : {"undefined", "not_judged"}) {
        Json open = light_error(0, 0);
        open[why] = 12;
        for (const Metric& m : metrics())
            EXPECT_EQ(metric_value(m, cell({light_error(1000, 1), open})).has_value(), m.kind == Metric::Kind::entry)
                << m.name << ' ' << why;
    }
}

TEST(UpperShare, IsAboutThreeOverNForNone) {
    EXPECT_NEAR(upper_share(0, 1000), 1 - std::pow(0.05, 1e-3), 1e-12);
    EXPECT_NEAR(upper_share(0, 100000) * 100000, 3, 0.01);
    EXPECT_EQ(upper_share(0, 0), 1);
    EXPECT_EQ(upper_share(10, 10), 1);
    // The share p at which at most 5 of 100 wrong points have the probability 5 %.
    const double p = upper_share(5, 100);
    double sum = 0, term = std::pow(1 - p, 100);
    for (int k = 0; k <= 5; ++k) {
        sum += term;
        term *= (100.0 - k) / (k + 1) * p / (1 - p);
    }
    EXPECT_NEAR(sum, 0.05, 1e-9);
}

Cell with_rmse(double rmse, int points = 10000) {
    Json e    = light_error(points, 0);
    e["rmse"] = rmse;
    return cell({e});
}

std::optional<double> bound(const char* name, const std::vector<Cell>& views) {
    return upper_bound(find_metric(name), views);
}

TEST(UpperBound, IsTheLogNormalPrediction) {
    const std::vector<Cell> views = {with_rmse(0.01), with_rmse(0.02), with_rmse(0.04)};
    // ln: mean ln 0.02, deviation ln 2; t of 2 degrees of freedom at 95 %: 2.919986.
    EXPECT_NEAR(*bound("rmse", views), 0.02 * std::pow(2.0, 2.919986 * std::sqrt(4.0 / 3.0)), 1e-6);
    EXPECT_NEAR(*bound("rmse", {with_rmse(0.01), with_rmse(0.01)}), 0.01, 1e-12);
    EXPECT_EQ(bound("rmse", {with_rmse(0.01)}), std::nullopt);
    EXPECT_EQ(bound("rmse", {}), std::nullopt);
    EXPECT_EQ(bound("rmse", {with_rmse(0.01), cell({light_error(0, 0)})}), std::nullopt);
    EXPECT_EQ(*bound("rmse", {with_rmse(0.01), with_rmse(1)}), 1);
}

TEST(UpperBound, OfNoErrorIsWhatNonePointsLeavePossible) {
    const double missed = 1 - std::pow(0.05, 1e-4);
    EXPECT_NEAR(*bound("rmse", {with_rmse(0), with_rmse(0)}), std::sqrt(missed), 1e-9);
    EXPECT_NEAR(*bound("interior", {with_rmse(0), with_rmse(0)}), missed, 1e-9);
    EXPECT_EQ(*bound("max", {with_rmse(0), with_rmse(0)}), 1);
    EXPECT_EQ(*bound("edge_displacement_px.p95", {with_rmse(0), with_rmse(0)}), 0);
}

TEST(UpperBound, OfAProvenMethodIsTheReferencesHalfWidth) {
    Json e                  = light_error(10000, 0);
    e["bracket"]            = {{"max_half_width", 2e-6}};
    Cell exact              = cell({e});
    exact.method.serves.how = "exactly";
    EXPECT_EQ(*bound("rmse", {exact, exact}), 2e-6);
    EXPECT_EQ(*bound("rmse", {exact}), 2e-6);
    EXPECT_EQ(*bound("interior", {exact, exact}), 0);
    // One that says so and is wrong is treated as any other.
    Json wrong             = light_error(10000, 1);
    Cell liar              = cell({wrong});
    liar.method.serves.how = "exactly";
    EXPECT_EQ(bound("interior", {liar}), std::nullopt);
    EXPECT_GE(*bound("interior", {liar, exact}), upper_share(10, 10000));
}

TEST(UpperBound, HoldsInNineteenOfTwentyFurtherViews) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal(std::log(0.02), 0.5);
    int held              = 0;
    constexpr int kTrials = 2000;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<Cell> views;
        for (int v = 0; v < 5; ++v) views.push_back(with_rmse(std::exp(normal(random))));
        held += std::exp(normal(random)) <= *bound("rmse", views);
    }
    // Binomial: 0.95 +- 4 standard deviations of 0.0049.
    EXPECT_NEAR(double(held) / kTrials, 0.95, 0.02);
}

}  // namespace
}  // namespace umbra
