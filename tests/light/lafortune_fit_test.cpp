// Lafortune's lobes from samples: what generated them is found again.
#include "umbra/tests/light/lafortune_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "umbra/core/render/brdf.h"

namespace umbra {
namespace {

dvec3 direction(std::mt19937& random) {
    std::uniform_real_distribution<double> share(0, 1);
    const double z = 0.1 + 0.9 * share(random), phi = 2 * kPi * share(random), sine = std::sqrt(1 - z * z);
    return {sine * std::cos(phi), sine * std::sin(phi), z};
}

std::vector<ReflectanceSample> samples_of(const Material& m, std::size_t n, double noise, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0, noise);
    std::vector<ReflectanceSample> samples(n);
    for (ReflectanceSample& s : samples) {
        s.l = direction(random), s.v = direction(random);
        s.value = reflected(m, {0, 0, 1}, s.l, s.v);
        if (noise > 0)
            for (int c = 0; c < 3; ++c) s.value[c] += error(random);
    }
    return samples;
}

Material with_lobes(const std::vector<LafortuneLobe>& lobes) {
    Material m;
    m.k_d   = {0.3f, 0.2f, 0.1f};
    m.lobes = lobes;
    return m;
}

double largest_difference(const Material& a, const Material& b) {
    std::mt19937 random(99);
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
        const dvec3 l = direction(random), v = direction(random),
                    d = reflected(a, {0, 0, 1}, l, v) - reflected(b, {0, 0, 1}, l, v);
        largest       = std::max({largest, std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    }
    return largest;
}

const LafortuneLobe kMirroring{.k_s = vec3(0.5f, 0.4f, 0.3f), .shininess = 12};
const LafortuneLobe kBrushed{
    .rows = {vec3(-0.95f, 0, 0), vec3(0, -0.7f, 0), vec3(0, 0, 0.9f)}, .k_s = vec3(0.2f, 0.3f, 0.6f), .shininess = 40};

TEST(LafortuneFit, FindsTheLobesThatMadeTheSamples) {
    for (const auto& lobes : {std::vector{kMirroring}, std::vector{kMirroring, kBrushed}}) {
        const Material truth   = with_lobes(lobes);
        const LafortuneFit fit = fit_lafortune(samples_of(truth, 3000, 0, 1), static_cast<int>(lobes.size()));
        EXPECT_TRUE(fit.converged);
        EXPECT_LT(fit.rms, 1e-4);
        EXPECT_LT(largest_difference(fit.material, truth), 2e-3) << "at other directions";
        EXPECT_NEAR(double(fit.material.k_d.r), 0.3, 1e-3);
        EXPECT_NEAR(double(fit.material.k_d.b), 0.1, 1e-3);
    }
    // The length of C and k_s are one number too many: (s e.C l)^n / s^n. Their product is found.
    const LafortuneLobe lobe = fit_lafortune(samples_of(with_lobes({kMirroring}), 3000, 0, 1), 1).material.lobes[0];
    const float length       = std::abs(lobe.rows[2].z);
    EXPECT_NEAR(double(lobe.shininess), 12, 0.05);
    EXPECT_NEAR(double(lobe.k_s.r * std::pow(length, lobe.shininess)), 0.5, 5e-3);
    EXPECT_NEAR(double(lobe.rows[0].x / lobe.rows[2].z), -1, 5e-3);
}

TEST(LafortuneFit, LeavesTheNoiseOfMeasurements) {
    constexpr double kNoise = 0.01;
    const Material truth    = with_lobes({kMirroring});
    const LafortuneFit fit  = fit_lafortune(samples_of(truth, 4000, kNoise, 2), 1);
    EXPECT_NEAR(fit.rms, kNoise, 0.03 * kNoise);
    EXPECT_LT(largest_difference(fit.material, truth), kNoise);
}

/// Phong's lobe is one of Lafortune's; a diffuse surface needs none.
TEST(LafortuneFit, HoldsPhongAndLambert) {
    Material phong;
    phong.k_d = vec3(0.4f), phong.k_s = vec3(0.6f), phong.shininess = 25;
    EXPECT_LT(largest_difference(fit_lafortune(samples_of(phong, 3000, 0, 3), 1).material, phong), 2e-3);
    const Material lambert = with_lobes({});
    EXPECT_LT(fit_lafortune(samples_of(lambert, 50, 0, 4), 0).rms, 1e-7);
    EXPECT_GT(fit_lafortune(samples_of(phong, 3000, 0, 3), 0).rms, 0.01);
}

/// B17 of the lectures shows this fit: 4,000 samples with errors of 0.02.
TEST(LafortuneFit, OfTheLectureIsFoundInNoisySamples) {
    Material phong, shown;
    phong.k_d = vec3(0.4f), phong.k_s = vec3(0.6f), phong.shininess = 25;
    std::ifstream in(std::string(UMBRA_TOP) + "/bench/report/lectures/experiments.json");
    const auto b17      = nlohmann::json::parse(in)["experiments"]["B17"]["variants"][1]["set"]["/objects/0/material"];
    const auto& lobe    = b17["lobes"][0];
    const auto vector   = [](const nlohmann::json& v) { return vec3(v[0], v[1], v[2]); };
    shown.k_d           = vector(b17["k_d"]);
    LafortuneLobe& made = shown.lobes.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) made.rows[k] = vector(lobe["C"][k]);
    made.k_s = vector(lobe["k_s"]), made.shininess = lobe["shininess"];
    const LafortuneFit fit = fit_lafortune(samples_of(phong, 4000, 0.02, 3), 1);
    EXPECT_LT(largest_difference(fit.material, phong), 0.01);
    EXPECT_LT(largest_difference(fit.material, shown), 0.005) << "the lecture shows such a fit";
    EXPECT_GT(largest_difference(shown, phong), 1e-4) << "and not the surface itself";
}

TEST(LafortuneFit, RefusesTooFewSamples) {
    const Material m = with_lobes({kMirroring});
    EXPECT_THROW((void)fit_lafortune(samples_of(m, 5, 0, 5), 1), std::invalid_argument);
    EXPECT_THROW((void)fit_lafortune(samples_of(m, 500, 0, 5), 9), std::invalid_argument);
}

}  // namespace
}  // namespace umbra
