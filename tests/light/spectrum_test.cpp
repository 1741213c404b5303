// Spectra against published values, and the error of RGB(k) RGB(I), as docs/spectral.md states it.
#include "umbra/tests/light/spectrum.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "umbra/core/image/metrics.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/lit_everywhere.h"

namespace umbra {
namespace {

const Spectrum kWhite = black_body(6504);

/// As bright as the white.
Spectrum as_bright(Spectrum light) {
    const double scale = xyz(kWhite).y / xyz(light).y;
    for (double& value : light.at) value *= scale;
    return light;
}

Spectrum three_bands() {
    Spectrum sum;
    for (const auto& [centre, width] : {std::pair{450.0, 8.0}, std::pair{545.0, 6.0}, std::pair{611.0, 6.0}}) {
        const Spectrum one = band(centre, width);
        for (std::size_t i = 0; i < Spectrum::kSamples; ++i) sum.at[i] += one.at[i];
    }
    return sum;
}

struct Named {
    const char* name;
    Spectrum spectrum;
};
const std::array<Named, 4> kLights{{{"black body, 2856 K", as_bright(black_body(2856))},
                                    {"black body, 10000 K", as_bright(black_body(10000))},
                                    {"three bands", as_bright(three_bands())},
                                    {"one band at 589 nm", as_bright(band(589, 3))}}};
const std::array<Named, 4> kPaints{
    {{"red", band(640, 40)}, {"yellow", band(580, 45)}, {"green", band(530, 35)}, {"blue", band(455, 30)}}};

dvec2 chromaticity(const Spectrum& light) {
    const dvec3 c = xyz(light);
    return dvec2(c.x, c.y) / (c.x + c.y + c.z);
}

/// CIE 15: illuminant E is at a third each, A (2856 K) at (0.4476, 0.4075); a black body of 6504 K lies at (0.3135,
/// 0.3237). The fits differ from the tables by some thousandths.
TEST(Spectrum, ChromaticitiesAreThoseOfTheObserver) {
    for (const auto& [light, at] :
         {std::pair{constant_spectrum(1), dvec2(1.0 / 3)}, std::pair{black_body(2856), dvec2(0.4476, 0.4075)},
          std::pair{black_body(6504), dvec2(0.3135, 0.3237)}}) {
        const dvec2 found = chromaticity(light);
        EXPECT_NEAR(found.x, at.x, 0.002);
        EXPECT_NEAR(found.y, at.y, 0.002);
    }
    EXPECT_NEAR(xyz(constant_spectrum(1)).y, 106.857, 0.2);  // of the tables, in nm
}

TEST(Spectrum, BlackBodiesPeakWhereWienSays) {
    for (const double kelvin : {4000.0, 5000.0, 7000.0}) {
        const Spectrum light   = black_body(kelvin);
        const std::size_t peak = std::size_t(std::ranges::max_element(light.at) - light.at.begin());
        EXPECT_NEAR(Spectrum::wavelength(peak), 2.897771955e6 / kelvin, 5);
    }
    EXPECT_THROW(static_cast<void>(black_body(0)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(band(500, 0)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(black_body(std::nan(""))), std::invalid_argument);
}

TEST(Spectrum, ProductsAreRightUnderWhiteAndOnGrey) {
    for (const Named& paint : kPaints) {
        const SpectralColour colour = spectral_colour(paint.spectrum, kWhite, kWhite);
        EXPECT_LT(glm::length(colour.spectral - colour.product), 1e-12) << paint.name;
        EXPECT_GT(std::max({colour.product.x, colour.product.y, colour.product.z}), 0.5) << paint.name;
    }
    for (const Named& light : kLights) {
        const SpectralColour colour = spectral_colour(constant_spectrum(0.3), light.spectrum, kWhite);
        EXPECT_LT(glm::length(colour.spectral - colour.product), 1e-12) << light.name;
    }
    const dvec3 white = rgb(kWhite, kWhite);
    EXPECT_EQ(white, dvec3(1));
}

/// One row of docs/spectral.md a light: the largest error of a channel for each paint.
TEST(Spectrum, ErrorsOfRgbAreThoseOfThePage) {
    std::ifstream in(std::string(UMBRA_TOP) + "/docs/spectral.md");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    for (const Named& light : kLights) {
        std::string row = fmt::format("| {} |", light.name);
        for (const Named& paint : kPaints) {
            const SpectralColour c = spectral_colour(paint.spectrum, light.spectrum, kWhite);
            const dvec3 off        = glm::abs(c.spectral - c.product);
            row += fmt::format(" {:.2f} |", std::max({off.x, off.y, off.z}));
        }
        EXPECT_NE(page.find(row), std::string::npos) << row;
    }
}

/// As [1, 0.5, 0]: what a picture cannot show is 0, six digits.
std::string list(dvec3 colour) {
    std::string text;
    for (int c = 0; c < 3; ++c) {
        std::string number = fmt::format("{:.6f}", std::max(colour[c], 0.0));
        number.erase(number.find_last_not_of('0') + 1);
        if (number.back() == '.') number.pop_back();
        text += (c > 0 ? ", " : "[") + number;
    }
    return text + "]";
}

/// B12 of the lectures shows each paint under the lamp of 2856 K.
TEST(Spectrum, ColoursAreThoseOfTheLecture) {
    std::ifstream in(std::string(UMBRA_TOP) + "/bench/report/lectures/experiments.json");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    const Spectrum& light = kLights[0].spectrum;
    EXPECT_NE(page.find("\"colour\": " + list(rgb(light, kWhite))), std::string::npos) << list(rgb(light, kWhite));
    for (std::size_t k = 0; k < kPaints.size(); ++k) {
        const SpectralColour c     = spectral_colour(kPaints[k].spectrum, light, kWhite);
        const dvec3 paint          = rgb(kPaints[k].spectrum * kWhite, kWhite);
        const std::string in_rgb   = fmt::format("\"O_d\": {}", list(paint)),
                          true_one = fmt::format("\"/objects/{}/material/O_d\": {}", k + 1, list(c.spectral / 2.0));
        for (const std::string& part : {in_rgb, true_one}) EXPECT_NE(page.find(part), std::string::npos) << part;
    }
}

/// A ball of each paint on a grey floor, once with the colours under the light itself, once with a coloured light.
TEST(Spectrum, OneSceneDiffersByWhatThePageSays) {
    const Spectrum& light = kLights[0].spectrum;
    Scene product, spectral;
    for (Scene* scene : {&product, &spectral}) {
        const bool true_colours = scene == &spectral;
        scene->width = 160, scene->height = 90;
        scene->camera.eye = {0, 3, 7}, scene->camera.target = {0, 0.4f, 0};
        Light sun;
        sun.name = "sun", sun.kind = LightKind::directional, sun.direction = {-1, -2, -1};
        sun.diffuse = true_colours ? vec3(1) : vec3(rgb(light, kWhite));
        scene->lights.push_back(sun);
        for (std::size_t k = 0; k <= kPaints.size(); ++k) {
            const Spectrum& paint  = k < kPaints.size() ? kPaints[k].spectrum : constant_spectrum(0.5);
            const SpectralColour c = spectral_colour(paint, light, kWhite);
            Material& material     = scene->materials.emplace_back();
            material.k_a = vec3(0), material.k_d = vec3(1);
            // What a camera records has no negative values.
            material.O_d    = vec3(glm::max(true_colours ? c.spectral : rgb(paint * kWhite, kWhite), dvec3(0)));
            const Mesh mesh = k < kPaints.size() ? make_sphere(0.8f, 48, 24) : make_plane(20, 20);
            std::vector<vec3> positions = mesh.positions;
            for (vec3& p : positions) p += k < kPaints.size() ? vec3(-3 + 2 * float(k), 0.8f, 0) : vec3(0);
            add_object(*scene, fmt::format("object_{}", k), positions, mesh.normals, mesh.triangles, std::uint32_t(k));
        }
    }
    const PointBatch points = points_of(product);
    const auto planes       = lit_everywhere(product, points);
    const double rmse       = image_error(shade(product, points, planes), shade(spectral, points, planes)).rmse;
    std::ifstream in(std::string(UMBRA_TOP) + "/docs/spectral.md");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    EXPECT_NE(page.find(fmt::format("RMSE {:.3f}", rmse)), std::string::npos) << rmse;
    EXPECT_GT(rmse, 0.005);
}

}  // namespace
}  // namespace umbra
