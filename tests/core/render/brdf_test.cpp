// Reflection: lobes and how they relate, their figures by sampling, Lafortune's lobes, and the variants of the sum.
#include "umbra/core/render/brdf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/io/scene_writer.h"
#include "umbra/core/render/sum.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

constexpr dvec3 kUp(0, 0, 1);

dvec3 polar(double degrees, double azimuth) {
    const double theta = glm::radians(degrees), phi = glm::radians(azimuth);
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

double degrees_between(dvec3 a, dvec3 b) {
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

/// |angle(R, V) - 2 angle(N, H)| for light and eye at these polar angles, and this angle between their azimuths.
double half_angle_error(double light, double eye, double azimuth) {
    const dvec3 l = polar(light, 0), v = polar(eye, azimuth);
    const dvec3 r = 2 * l.z * kUp - l;
    return std::abs(degrees_between(r, v) - 2 * degrees_between(kUp, glm::normalize(l + v)));
}

Material glossy(float k_s, float shininess, Lobe lobe = Lobe::phong) {
    Material m;
    m.k_d       = vec3(0);
    m.k_s       = vec3(k_s);
    m.shininess = shininess;
    m.lobe      = lobe;
    return m;
}

/// The double angle of EL: exact in the plane of L and N, and only there.
TEST(HalfVector, DoubleAngleHoldsInThePlaneAlone) {
    for (double light = 0; light < 90; light += 7.5)
        for (double eye = 0; eye < 90; eye += 7.5) {
            EXPECT_NEAR(half_angle_error(light, eye, 180), 0, 1e-9);
            EXPECT_NEAR(half_angle_error(light, eye, 0), 0, 1e-9);
        }
    // Off the plane the error grows with the angles from the normal: the largest of eyes as far from it as the light.
    const auto largest = [](double angle) {
        double error = 0;
        for (double azimuth = 0; azimuth <= 180; azimuth += 0.25)
            error = std::max(error, half_angle_error(angle, angle, azimuth));
        return error;
    };
    EXPECT_NEAR(largest(10), 0.118, 0.001);
    EXPECT_NEAR(largest(30), 3.31, 0.01);
    EXPECT_NEAR(largest(60), 30.5, 0.1);
    EXPECT_NEAR(largest(80), 86.3, 0.1);
    // At a quarter turn, light and eye at 60 degrees: cos(R, V) = 1/4, and tan(N, H) = sqrt(3/2).
    EXPECT_NEAR(half_angle_error(60, 60, 90),
                std::abs(glm::degrees(std::acos(0.25)) - 2 * glm::degrees(std::atan(std::sqrt(1.5)))), 1e-9);
}

TEST(Lafortune, MirrorMatrixIsPhong) {
    const Material phong = glossy(0.5f, 12);
    Material lafortune;
    lafortune.k_d            = vec3(0);
    lafortune.lobes          = {{.k_s = vec3(0.5f), .shininess = 12}};  // C = diag(-1, -1, 1)
    Material printed         = lafortune;
    printed.lobes[0].rows[1] = vec3(0, 1, 0);  // DE2's diag(-1, 1, 1)
    std::mt19937 random(3);
    std::uniform_real_distribution<double> tilt(0, 85), turn(0, 360);
    double wrong = 0;
    for (int k = 0; k < 2000; ++k) {
        const dvec3 n = polar(tilt(random), turn(random));
        const dvec3 l = polar(tilt(random), turn(random)), v = polar(tilt(random), turn(random));
        if (glm::dot(n, l) <= 0) continue;
        EXPECT_NEAR(reflected(lafortune, n, l, v).r, reflected(phong, n, l, v).r, 1e-12);
        wrong = std::max(wrong, std::abs(reflected(printed, n, l, v).r - reflected(phong, n, l, v).r));
    }
    EXPECT_GT(wrong, 0.3) << "as printed, it mirrors only light without a y component";
    const dvec3 l = polar(40, 180), v = polar(55, 20);
    EXPECT_NEAR(reflected(printed, kUp, l, v).r, reflected(phong, kUp, l, v).r, 1e-12);
}

TEST(Lafortune, LobesAddUpAndTakeTheirMatrices) {
    Material m;
    m.k_d         = vec3(0.25f);
    m.lobes       = {{.rows = {vec3(-0.5f, 0, 0), vec3(0, -1, 0), vec3(0, 0, 0.75f)}, .k_s = vec3(2), .shininess = 3},
                     {.rows = {vec3(0, 0, 1), vec3(0, 0, 0), vec3(1, 0, 0)}, .k_s = vec3(0.5f), .shininess = 1}};
    const dvec3 l = polar(30, 180), v = polar(60, 0);
    const double first  = 0.5 * std::sin(glm::radians(30.0)) * v.x + 0.75 * l.z * v.z;
    const double second = l.z * v.x + l.x * v.z;
    EXPECT_NEAR(reflected(m, kUp, l, v).r, 0.25 * l.z + 2 * std::pow(first, 3) + 0.5 * second, 1e-9);
}

TEST(BrdfFigures, LambertKeepsAllLaws) {
    Material m;
    m.k_d              = vec3(0.75f);
    const auto figures = measure_brdf(brdf_of_sum(m));
    EXPECT_NEAR(figures.largest, 0.75 / kPi, 1e-12);
    EXPECT_LT(figures.reciprocity, 1e-12);
    EXPECT_LT(figures.anisotropy, 1e-12);
    EXPECT_NEAR(figures.energy, 0.75, 1e-9);
    EXPECT_NEAR(figures.without_cosine, 1.5, 1e-9) << "DE2's integral has no cosine: white surfaces would break it";
}

/// The sum of the lectures has no cosine in its specular term: towards grazing light, more leaves than arrives.
TEST(BrdfFigures, SpecularTermsOfTheSumBreakReciprocityAndEnergy) {
    for (const Lobe lobe : {Lobe::phong, Lobe::blinn_phong}) {
        const auto figures = measure_brdf(brdf_of_sum(glossy(1, 5, lobe)));
        EXPECT_GT(figures.reciprocity, 0.1);
        EXPECT_GT(figures.energy, 1.1);
        EXPECT_LT(figures.anisotropy, 1e-12);
    }
    EXPECT_LT(measure_brdf(brdf_of_sum(glossy(0.1f, 5))).energy, 1) << "small k_s hide it";
}

TEST(BrdfFigures, LobesWithTheCosineKeepBoth) {
    for (const Lobe lobe : {Lobe::phong, Lobe::blinn_phong})
        for (const float shininess : {1.0f, 20.0f}) {
            Material m         = glossy(0.75f, shininess, lobe);
            m.k_d              = vec3(0.25f);
            const auto figures = measure_brdf(brdf_with_cosine(m));
            EXPECT_LT(figures.reciprocity, 1e-12);
            EXPECT_LT(figures.anisotropy, 1e-12);
            EXPECT_NEAR(figures.energy, 1, 6e-3) << "all of it at normal incidence: k_d + k_s";
        }
}

/// C that stretches x and y differently shines more along one of them; a C that is not symmetric is not reciprocal.
TEST(BrdfFigures, LafortuneMayBeAnisotropic) {
    Material m;
    m.k_d        = vec3(0);
    m.lobes      = {{.rows = {vec3(-1, 0, 0), vec3(0, -0.6f, 0), vec3(0, 0, 0.9f)}, .k_s = vec3(0.2f), .shininess = 8}};
    auto figures = measure_brdf(brdf_with_cosine(m));
    EXPECT_GT(figures.anisotropy, 0.1);
    EXPECT_LT(figures.reciprocity, 1e-12);
    EXPECT_LT(figures.energy, 1);
    m.lobes[0].rows[1] = vec3(0, -1, 0);
    EXPECT_LT(measure_brdf(brdf_with_cosine(m)).anisotropy, 1e-12);
    m.lobes[0].rows[0] = vec3(-1, 0, 0.5f);
    figures            = measure_brdf(brdf_with_cosine(m));
    EXPECT_GT(figures.reciprocity, 0.1);
}

/// One triangle at the origin, its normal +y, with one light; read from a file.
Scene scene_with(const std::string& members, const std::string& material) {
    const TemporaryFolder folder;
    return load_scene(folder.write("scene.json", R"({"camera": {"eye": [0, 5, 0.001], "target": [0, 0, 0]}, )" +
                                                     members +
                                                     R"("ambient": 0.5, "lights": [
        {"type": "directional", "direction": [0, -1, 0], "diffuse": 0.5, "specular": 0.25}],
        "objects": [{"type": "triangles", "positions": [[0, 0, 0], [0, 0, 1], [1, 0, 0]], "triangles": [[0, 1, 2]],
                     "material": )" + material + "}]}"));
}

dvec3 sum_of(const Scene& scene, dvec3 n = {0, 1, 0}) {
    PointBatch points;
    points.eye = scene.camera.eye;
    points.resize(1);
    set_point(points, 0, scene, 0, 0, 0);
    face_lights(points, scene);
    std::vector<VisibilityPlane> planes(scene.lights.size(), VisibilityPlane(1));
    for (VisibilityPlane& plane : planes) plane.s[0] = 1;
    return PhongSum(scene, frame(scene.camera, 2, 2)).at(points, 0, n, planes);
}

/// Light, eye and normal are along y: every cosine is 1.
TEST(SumVariants, SpecularTintAndAmbientCoefficientAreChoices) {
    const std::string material = R"({"k_a": 0.25, "k_d": 0.5, "k_s": 0.5, "O_d": [0.5, 0, 1], "O_s": [1, 0.5, 0]})";
    const auto expect          = [&](const std::string& members, dvec3 expected) {
        const dvec3 got = sum_of(scene_with(members, material));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], expected[c], 1e-6) << members << c;
    };
    const dvec3 diffuse = 0.5 * 0.5 * dvec3(0.5, 0, 1), with_k_a = 0.5 * 0.25 * dvec3(0.5, 0, 1);
    const dvec3 with_o_s = 0.25 * 0.5 * dvec3(1, 0.5, 0), with_o_d = 0.25 * 0.5 * dvec3(0.5, 0, 1);
    expect("", with_k_a + diffuse + with_o_s);
    expect(R"("specular_colour": "O_s", "ambient_coefficient": "k_a", )", with_k_a + diffuse + with_o_s);
    expect(R"("specular_colour": "O_d", )", with_k_a + diffuse + with_o_d);
    expect(R"("ambient_coefficient": "k_d", )", 2.0 * with_k_a + diffuse + with_o_s);
    EXPECT_THROW((void)scene_with(R"("specular_colour": "k_d", )", material), InputError);
    EXPECT_THROW((void)scene_with(R"("ambient_coefficient": "O_d", )", material), InputError);
}

TEST(Lafortune, LobesAreReadSummedAndWritten) {
    const std::string lobes = R"({"k_a": 0, "k_d": 0.5, "k_s": 0.25, "tangent": [0, 0, 2], "lobes": [
        {"C": [-1, -1, 1], "k_s": [0.5, 0.25, 0], "shininess": 20},
        {"C": [[-0.5, 0.1, 0], [0, -0.5, 0], [0, 0, 0.5]], "k_s": 0.125, "shininess": 2}]})";
    const Scene scene       = scene_with("", lobes);
    const dvec3 got         = sum_of(scene);
    // Straight down, the lobes are k_s 1^20 and k_s (1/2)^2.
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(got[c], 0.5 * 0.5 + 0.25 * (0.25 + dvec3(0.5, 0.25, 0)[c] + 0.125 * 0.25), 1e-6);
    const TemporaryFolder folder;
    const Scene again = load_scene(folder.write("again.json", native_text(scene)));
    EXPECT_EQ(native_text(again), native_text(scene));
    ASSERT_EQ(again.materials[0].lobes.size(), 2u);
    EXPECT_EQ(again.materials[0].lobes[1].rows[0], vec3(-0.5f, 0.1f, 0));
    EXPECT_EQ(again.materials[0].tangent, vec3(0, 0, 2));

    for (const auto& [material, expected] : {std::pair{R"({"lobes": [{}]})", "k_s"},
                                             {R"({"lobes": [{"k_s": 1, "C": [1, 2]}]})", "C"},
                                             {R"({"lobes": [{"k_s": 1, "C": [[1, 2, 3]]}]})", "three rows"},
                                             {R"({"lobes": [{"k_s": 1, "shininess": -1}]})", "shininess"},
                                             {R"({"lobes": [{"k_s": 1, "n": 1}]})", "unknown"},
                                             {R"({"tangent": [0, 0, 0]})", "tangent is (0, 0, 0)"}}) {
        try {
            (void)scene_with("", material);
            ADD_FAILURE() << material << " was read";
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find(expected), std::string::npos) << e.what();
        }
    }
}

/// Twice the light gives twice the sum, and two lights give the sum of both.
TEST(BrdfFigures, SumIsLinearInTheLight) {
    Scene scene             = scene_with("", R"({"k_a": 0, "k_d": 0.5, "k_s": 0.25, "shininess": 7,
        "lobes": [{"C": [-1, -0.5, 1], "k_s": 0.5, "shininess": 4}]})");
    const dvec3 n           = glm::normalize(dvec3(0.2, 1, -0.1));
    scene.ambient           = vec3(0);
    scene.lights[0].diffuse = scene.lights[0].specular = vec3(0.5f);
    const dvec3 first                                  = sum_of(scene, n);
    Scene doubled                                      = scene;
    doubled.lights[0].diffuse = doubled.lights[0].specular = vec3(1);
    EXPECT_NEAR(sum_of(doubled, n).r, 2 * first.r, 1e-12);
    Scene other               = scene;
    other.lights[0].direction = vec3(0.5f, -0.5f, 0.25f);
    Scene both                = scene;
    both.lights.push_back(other.lights[0]);
    EXPECT_NEAR(sum_of(both, n).r, first.r + sum_of(other, n).r, 1e-12);
}

/// Both definitions that DE1 prints, of a square face under a near point light: L / E at its middle, and I / Phi of all
/// of it. For small faces they agree except for the cosine at the eye, since I = L A cos(theta) and Phi = E A.
TEST(BrdfDefinitions, AgreeForSmallFacesButForTheCosineAtTheEye) {
    Material material   = glossy(0.6f, 10);
    material.k_d        = vec3(0.4f);
    const Brdf f        = brdf_with_cosine(material);
    const dvec3 v       = polar(50, 30), light(0.7, 0.2, 1.1);
    const auto arriving = [&](dvec3 p) { return (light - p).z / std::pow(glm::length(light - p), 3.0); };
    const auto leaving  = [&](dvec3 p) { return f(glm::normalize(light - p), v) * arriving(p); };
    const double first  = leaving(dvec3(0)) / arriving(dvec3(0));
    EXPECT_NEAR(first, f(glm::normalize(light), v), 1e-12);
    double before = 1;
    for (const double side : {1.0, 0.1, 0.01}) {
        double intensity = 0, flux = 0;
        constexpr int kSteps = 40;
        for (int i = 0; i < kSteps * kSteps; ++i) {
            const int column = i % kSteps, row = i / kSteps;
            const dvec3 p(((column + 0.5) / kSteps - 0.5) * side, ((row + 0.5) / kSteps - 0.5) * side, 0);
            intensity += leaving(p) * v.z, flux += arriving(p);
        }
        const double error = std::abs(intensity / flux / (first * v.z) - 1);
        EXPECT_LT(error, 0.05 * before) << side;
        before = std::max(error, 1e-6);
    }
    EXPECT_LT(before, 1e-3);
}

}  // namespace
}  // namespace umbra
