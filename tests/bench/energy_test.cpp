// The light that arrives at faces and objects, beside sums by hand.
#include "umbra/bench/studies/energy/energy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "umbra/core/base/error.h"
#include "umbra/tests/support/planted_method.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

/// A roof of 2 x 2 over a ground of 8 x 8, one unit of it apart, under a sun that turns from the zenith to 60 degrees.
std::string write_roof(const TemporaryFolder& folder, const std::string& animation = "") {
    return folder
        .write("roof.json", R"({"camera": {"eye": [0, -5, 9], "target": [0, 0, 0]},
        "lights": [{"name": "sun", "type": "directional", "direction": [0, -1, 0], "colour": [1, 2, 3]}],
        "objects": [{"name": "ground", "type": "plane", "size": [8, 8]},
                    {"name": "roof", "type": "plane", "size": [2, 2], "transform": [{"translate": [0, 1, 0]}]}])" +
                                animation + "}")
        .string();
}

const std::string kColumns =
    "area,irradiance,unshadowed,coverage,irradiance_r,irradiance_g,irradiance_b,back_irradiance,back_unshadowed,"
    "back_coverage";
const std::string kUnit =
    "unit: that of the lights, by luminance: lx for intensities in candelas, lengths in metres and photometric "
    "attenuation\n";

const double kSun = 0.2126 * 1 + 0.7152 * 2 + 0.0722 * 3;

EnergyOptions with(const char* method, std::uint64_t points = 40000) {
    EnergyOptions options;
    if (method != nullptr) options.method = parse_method(method);
    options.points = points;
    return options;
}

TEST(Energy, IsTheLightThatArrives) {
    const TemporaryFolder folder;
    const std::string scene = write_roof(folder);
    const Json record       = measure_energy(std::vector<std::filesystem::path>{scene}, with("exact"), folder.path());
    const Json &ground = record["frames"][0]["objects"][0], &roof = record["frames"][0]["objects"][1];
    EXPECT_EQ(ground["name"], "ground");
    EXPECT_NEAR(ground["area"].get<double>(), 64, 1e-5);
    EXPECT_NEAR(ground["unshadowed"].get<double>(), kSun, 1e-5);
    EXPECT_NEAR(ground["irradiance"].get<double>(), kSun * (1 - 4.0 / 64), 2e-3 * kSun);
    EXPECT_NEAR(ground["fraction"].get<double>(), 1 - 4.0 / 64, 2e-3);
    EXPECT_NEAR(roof["irradiance"].get<double>(), kSun, 1e-5) << "its upper side, though the eye sees the lower one";
    EXPECT_NEAR(roof["fraction"].get<double>(), 1, 1e-9);
    EXPECT_EQ(record["method"], "exact");

    const Json bare = measure_energy(std::vector<std::filesystem::path>{scene}, with(nullptr), folder.path());
    EXPECT_NEAR(bare["frames"][0]["objects"][0]["irradiance"].get<double>(), kSun, 1e-5);
    EXPECT_TRUE(bare["method"].is_null());
}

TEST(Energy, FollowsTheSunFrameByFrame) {
    const TemporaryFolder folder;
    const std::string scene = write_roof(folder, R"(, "animation": {"frames": 3, "lights": {"sun": {"keys": [
        {"frame": 0, "direction": [0, -1, 0]}, {"frame": 2, "direction": [0.8660254, -0.5, 0]}]}}})");
    const std::vector<std::filesystem::path> frames{scene + "@0", scene + "@1", scene + "@2"};
    const Json record = measure_energy(frames, with("exact"), folder.path());
    ASSERT_EQ(record["frames"].size(), 3u);
    double sum = 0, shadowed = 0;
    for (int k = 0; k < 3; ++k) {
        const Json& frame   = record["frames"][static_cast<std::size_t>(k)];
        const double cosine = std::cos(k * kPi / 6);
        EXPECT_EQ(frame["scene"], "roof@" + std::to_string(k));
        EXPECT_NEAR(frame["objects"][1]["irradiance"].get<double>(), kSun * cosine, 1e-4);
        // The shadow has the roof's size wherever the sun is.
        EXPECT_NEAR(frame["objects"][0]["irradiance"].get<double>(), kSun * cosine * (1 - 4.0 / 64), 2e-3 * kSun);
        sum += kSun * cosine / 3, shadowed += frame["objects"][0]["irradiance"].get<double>() / 3;
    }
    EXPECT_NEAR(record["mean"][1]["irradiance"].get<double>(), sum, 1e-4);
    EXPECT_NEAR(record["mean"][0]["irradiance"].get<double>(), shadowed, 1e-9);
    EXPECT_EQ(record["mean"][0]["name"], "ground");
    const std::string text = energy_text(record);
    EXPECT_NE(text.find("means of 3 frames"), std::string::npos) << text;
    EXPECT_NE(text.find("0.93"), std::string::npos) << text;

    std::ifstream in(folder.path() / "faces.csv");
    std::string line;
    std::vector<std::string> rows;
    while (std::getline(in, line)) rows.push_back(line);
    ASSERT_EQ(rows.size(), 1u + 3 * 4);
    EXPECT_EQ(rows[0], "scene,object,triangle," + kColumns);
    EXPECT_EQ(rows[1].substr(0, 27), R"("roof@0","ground",0,32,1.74)");
}

/// A sheet of 4 x 4 with a sun of (1, 2, 3) above and a lamp below it that a plate of 2 x 2 hides from a quarter of it;
/// a sun below has half of its light where the sheet's back is lit. A box beside closes around its inside.
TEST(Energy, HasBothSidesOfOpenFacesAndTheirColours) {
    const TemporaryFolder folder;
    const auto measure = [&](const char* material) {
        const auto file = folder.write("sheet.json", std::string(R"({"camera": {"eye": [0, 6, 9], "target": [0, 0, 0]},
            "materials": {"sheet": )") + material + R"(},
            "lights": [{"name": "above", "type": "directional", "direction": [0, -1, 0], "colour": [1, 2, 3]},
                       {"name": "below", "type": "directional", "direction": [0, 1, 0], "colour": [0, 4, 0]}],
            "objects": [{"name": "sheet", "type": "plane", "size": [4, 4], "material": "sheet"},
                        {"name": "plate", "type": "plane", "size": [2, 2], "transform": [{"translate": [0, -1, 0]}]},
                        {"name": "box", "type": "box", "size": [1, 1, 1], "transform": [{"translate": [9, 0, 0]}]}]})");
        return measure_energy(std::vector<std::filesystem::path>{file}, with("exact"), folder.path());
    };
    const Json record = measure(R"({"k_d": 1})");
    const Json &sheet = record["mean"][0], &plate = record["mean"][1], &box = record["mean"][2];
    EXPECT_NEAR(sheet["irradiance"].get<double>(), kSun, 1e-5);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sheet["irradiance_rgb"].at(c).get<double>(), c + 1, 1e-5);
    const double green = 0.7152 * 4;
    const Json& back   = sheet["back"];
    EXPECT_NEAR(back["area"].get<double>(), 16, 1e-5);
    EXPECT_NEAR(back["unshadowed"].get<double>(), green, 1e-5);
    EXPECT_NEAR(back["irradiance"].get<double>(), green * 0.75, 5e-3 * green);
    EXPECT_NEAR(back["irradiance_rgb"].at(1).get<double>(), 3, 0.02);
    EXPECT_EQ(back["irradiance_rgb"].at(0), 0);
    EXPECT_NEAR(plate["irradiance"].get<double>(), 0, 1e-9) << "under the sheet";
    EXPECT_NEAR(plate["back"]["irradiance"].get<double>(), green, 1e-5);
    EXPECT_TRUE(box["back"].is_null()) << "nothing is lit inside";
    const std::string text = energy_text(record);
    EXPECT_NE(text.find("sheet, back"), std::string::npos) << text;
    EXPECT_EQ(text.find("box, back"), std::string::npos) << text;
    EXPECT_NE(text.find(kUnit), std::string::npos) << text;

    EXPECT_TRUE(measure(R"({"k_d": 1, "two_sided": false})")["mean"][0]["back"].is_null());
}

/// A pane that lets half of red through and nothing else.
TEST(Energy, OfColouredShadowsIsByChannel) {
    Scene scene;
    scene.materials.resize(2);
    scene.materials[1].opacity         = 0;
    scene.materials[1].transmit_colour = {0.5f, 0, 0};
    scene.transparent                  = TransparentOccluders::multiply;
    add_object(scene, "ground", {{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    add_object(scene, "pane", {{-9, 1, -9}, {9, 1, -9}, {9, 1, 9}, {-9, 1, 9}}, {}, {{0, 2, 1}, {0, 3, 2}}, 1);
    Light sun;
    sun.kind                                = LightKind::directional;
    sun.direction                           = {0, -1, 0};
    sun.diffuse                             = {4, 4, 4};
    scene.lights                            = {sun};
    const std::vector<ReceivedEnergy> faces = received_by_faces(scene, find_facts(scene), with("exact", 64));
    EXPECT_NEAR(faces[0].colour.x, 2, 1e-5);
    EXPECT_NEAR(faces[0].colour.y, 0, 1e-9);
    EXPECT_NEAR(faces[0].irradiance, 0.2126 * 2, 1e-5);
    EXPECT_NEAR(faces[0].unshadowed, 4, 1e-5);
}

/// Half of the faces in the umbra, half lit: faces differ where their object is between.
TEST(Energy, IsOfFacesToo) {
    const TemporaryFolder folder;
    Scene scene = [&] {
        Scene s;
        s.materials.resize(1);
        add_object(s, "ground", {{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
        add_object(s, "lid", {{-2, 1, -2}, {2, 1, -2}, {2, 1, 2}}, {}, {{0, 2, 1}}, 0);
        Light sun;
        sun.kind      = LightKind::directional;
        sun.direction = {0, -1, 0};
        s.lights      = {sun};
        return s;
    }();
    const std::vector<ReceivedEnergy> faces = received_by_faces(scene, find_facts(scene), with("exact", 3000));
    ASSERT_EQ(faces.size(), 3u);
    EXPECT_NEAR(faces[0].irradiance, 0, 1e-9);
    EXPECT_NEAR(faces[1].irradiance, 1, 1e-6);
    EXPECT_NEAR(faces[2].irradiance, 1, 1e-6);
    const std::vector<ReceivedEnergy> objects = received_by_objects(scene, faces);
    EXPECT_NEAR(objects[0].irradiance, 0.5, 1e-6);
    EXPECT_NEAR(objects[0].unshadowed, 1, 1e-6);

    scene.objects[0].switches.receives_shadows = false;
    EXPECT_NEAR(received_by_faces(scene, find_facts(scene), with("exact", 3000))[0].irradiance, 1, 1e-6);
}

/// Fog that dims lights dims what arrives, as in the sum.
TEST(Energy, HasTheFogOfTheSum) {
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "patch", {{-1e-3f, 0, -1e-3f}, {1e-3f, 0, -1e-3f}, {0, 0, 1e-3f}}, {}, {{0, 2, 1}}, 0);
    Light lamp;
    lamp.position         = {0, 3, 0};
    scene.lights          = {lamp};
    scene.fog.law         = FogLaw::exponential;
    scene.fog.density     = 0.25f;
    scene.fog.dims_lights = true;
    const auto lit        = [&] { return received_by_faces(scene, find_facts(scene), with("exact", 8))[0].irradiance; };
    EXPECT_NEAR(lit(), std::exp(-0.75), 1e-5);
    scene.fog.dims_lights = false;
    EXPECT_NEAR(lit(), 1, 1e-5);
}

/// A ground of 2 x 2 under two suns: one of luminance 1 at the zenith, and one of 3 that is 60 degrees lower and so
/// brings 1.5. A step of 1 x 1 lies beside it. A planted method answers by light and by index of the point.
class PlantedEnergy : public testing::Test {
protected:
    ~PlantedEnergy() override { planted_behaviour = {}; }

    [[nodiscard]] Json measure(const std::function<PlantedAnswer(LightId light, std::size_t point)>& answer) const {
        planted_behaviour.answer = [&](LightId light, std::size_t x, std::size_t, int) { return answer(light, x); };
        EnergyOptions options;
        options.method = MethodChoice(info_);
        options.points = 1000;
        return measure_energy(std::vector<std::filesystem::path>{file_}, options, folder_.path());
    }
    [[nodiscard]] std::vector<std::string> lines(const char* file) const {
        std::ifstream in(folder_.path() / file);
        std::vector<std::string> rows;
        for (std::string line; std::getline(in, line);) rows.push_back(line);
        return rows;
    }

    const MethodInfo info_ = planted_method();
    const TemporaryFolder folder_;
    const std::filesystem::path file_ =
        folder_.write("suns.json", R"({"camera": {"eye": [0, 5, 5], "target": [0, 0, 0]},
        "lights": [{"name": "noon", "type": "directional", "direction": [0, -1, 0], "colour": [1, 1, 1]},
                   {"name": "late", "type": "directional", "direction": [0.8660254, -0.5, 0], "colour": [3, 3, 3]}],
        "objects": [{"name": "ground", "type": "plane", "size": [2, 2]},
                    {"name": "step", "type": "plane", "size": [1, 1], "transform": [{"translate": [4, 0, 0]}]}]})");
};

/// 0.25 * 1 + 0.5 * 1.5 of 1 + 1.5.
TEST_F(PlantedEnergy, EachLightHasItsOwnShadow) {
    const Json record = measure([](LightId light, std::size_t) { return PlantedAnswer{light == 0 ? 0.25f : 0.5f}; });
    for (const Json& object : record["mean"]) {
        EXPECT_NEAR(object["irradiance"].get<double>(), 1, 1e-6);
        EXPECT_NEAR(object["unshadowed"].get<double>(), 2.5, 1e-6);
        EXPECT_NEAR(object["fraction"].get<double>(), 0.4, 1e-6);
        EXPECT_EQ(object["coverage"], 1);
    }
    EXPECT_NEAR(record["mean"][0]["area"].get<double>(), 4, 1e-6);
    EXPECT_NEAR(record["mean"][1]["area"].get<double>(), 1, 1e-6);
    EXPECT_EQ(lines("objects.csv"),
              (std::vector<std::string>{"scene,object," + kColumns, R"("suns","ground",4,1,2.5,1,1,1,1,0,0,)",
                                        R"("suns","step",1,1,2.5,1,1,1,1,0,0,)"}));
    EXPECT_EQ(lines("faces.csv").at(3), R"("suns","step",2,0.5,1,2.5,1,1,1,1,0,0,)");
    EXPECT_EQ(energy_text(record), "irradiance without shadows, with shadows, and their quotient; means of 1 frame\n" +
                                       kUnit +
                                       "ground          2.5          1  0.400\n"
                                       "step            2.5          1  0.400\n");
}

/// The late sun brings 1.5 of 2.5: without an answer for it, 0.4 is covered, of which a quarter arrives.
TEST_F(PlantedEnergy, WhatHasNoAnswerIsNeitherLitNorDark) {
    const Json record = measure([](LightId light, std::size_t) { return PlantedAnswer{0.25f, light == 0}; });
    const Json& part  = record["mean"][0];
    EXPECT_NEAR(part["irradiance"].get<double>(), 0.25, 1e-6);
    EXPECT_NEAR(part["unshadowed"].get<double>(), 1, 1e-6);
    EXPECT_NEAR(part["fraction"].get<double>(), 0.25, 1e-6);
    EXPECT_NEAR(part["coverage"].get<double>(), 0.4, 1e-6);
    EXPECT_EQ(lines("objects.csv").at(1), R"("suns","ground",4,0.25,1,0.4,0.25,0.25,0.25,0,0,)");
    EXPECT_EQ(energy_text(record),
              "irradiance without shadows, with shadows, and their quotient; means of 1 frame\n" + kUnit +
                  "of the part that planted answers; last column: that part of what arrives without shadows\n"
                  "ground            1       0.25  0.250  0.400\n"
                  "step              1       0.25  0.250  0.400\n");

    // Every second point, lit: half of what arrives is covered, and all of that is there.
    const Json half = measure([](LightId, std::size_t point) { return PlantedAnswer{1, point % 2 == 0}; });
    EXPECT_NEAR(half["mean"][0]["coverage"].get<double>(), 0.5, 1e-6);
    EXPECT_NEAR(half["mean"][0]["fraction"].get<double>(), 1, 1e-6);
}

TEST_F(PlantedEnergy, WithoutAnyAnswerThereIsNoFigure) {
    const Json record  = measure([](LightId, std::size_t point) { return PlantedAnswer{1, point < 800}; });
    const Json &ground = record["frames"][0]["objects"][0], &step = record["frames"][0]["objects"][1];
    EXPECT_EQ(ground["coverage"], 1) << "its points are the first 800 of 1000";
    EXPECT_EQ(step["coverage"], 0);
    for (const char* figure : {"irradiance", "unshadowed", "fraction"}) EXPECT_TRUE(step[figure].is_null()) << figure;
    EXPECT_EQ(lines("objects.csv").at(2), R"("suns","step",1,,,0,,,,0,0,)");
    EXPECT_NE(energy_text(record).find("step              -          -      -  0.000\n"), std::string::npos)
        << energy_text(record);
}

/// Methods that leave points open: the ring of a torus is on no plane.
TEST(Energy, DoesNotTakeTheOpenPointsOfAMethodForLit) {
    const std::filesystem::path file = std::filesystem::path(UMBRA_SCENES) / "self_shadow.json";
    const TemporaryFolder folder;
    const Json record =
        measure_energy(std::vector<std::filesystem::path>{file}, with("planar_projection", 2000), folder.path());
    std::size_t open = 0;
    for (const Json& object : record["mean"])
        if (object["coverage"] == 0) {
            ++open;
            EXPECT_TRUE(object["fraction"].is_null()) << object;
        }
    EXPECT_GT(open, 0u);
}

TEST(Energy, RefusesWhatAMethodDoesNotServeAndOtherObjects) {
    const TemporaryFolder folder;
    const std::string roof = write_roof(folder);
    const auto other       = folder.write("other.json", R"({"objects": [{"type": "box"}]})");
    EXPECT_THROW((void)measure_energy(std::vector<std::filesystem::path>{roof, other}, with("exact"), folder.path()),
                 UsageError);
    const auto area = folder.write("area.json", R"({"objects": [{"type": "box"}],
        "lights": [{"type": "sphere", "position": [0, 4, 0], "radius": 1}]})");
    EXPECT_THROW((void)measure_energy(std::vector<std::filesystem::path>{area}, with("atherton_weiler"), folder.path()),
                 UsageError);
}

}  // namespace
}  // namespace umbra
