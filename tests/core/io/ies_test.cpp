// Photometric files, and the tables that they hold: angles, symmetries, interpolation, flux, refusals.
#include "umbra/core/io/ies.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "umbra/core/base/error.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

Photometry of_data(const std::string& name) {
    std::vector<std::string> warnings;
    Photometry table = read_ies(std::string(UMBRA_TEST_DATA) + "/ies/" + name, warnings);
    EXPECT_TRUE(warnings.empty()) << warnings[0];
    return table;
}

/// Checks that there is one warning, and that it has these words; none where they are empty.
Photometry of_text(const std::string& text, std::string_view warning = "") {
    const TemporaryFolder folder;
    std::vector<std::string> warnings;
    Photometry table = read_ies(folder.write("light.ies", text), warnings);
    EXPECT_EQ(warnings.size(), warning.empty() ? 0u : 1u) << text;
    for (const std::string& w : warnings) EXPECT_NE(w.find(warning), std::string::npos) << w;
    return table;
}

/// A file of type C whose header is given, with candela values v + 100 h.
std::string with_angles(const std::string& vertical, int n_vertical, const std::string& horizontal, int n_horizontal,
                        int type = 1) {
    std::string text = fmt::format("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {} {} {} 2 0 0 0\n1 1 10\n{}\n{}\n", n_vertical,
                                   n_horizontal, type, vertical, horizontal);
    for (int h = 0; h < n_horizontal; ++h)
        for (int v = 0; v < n_vertical; ++v) text += fmt::format("{} ", v + 100 * h);
    return text;
}

/// 1000 cd cos(V), every 5 degrees, below the light: pi 1000 lm.
TEST(Ies, CosineHasPiLumensACandela) {
    const Photometry table = of_data("cosine.ies");
    EXPECT_EQ(table.type, PhotometricType::C);
    EXPECT_NEAR(intensity_at(table, 60, 0), 500, 1e-3);
    EXPECT_NEAR(intensity_at(table, 62.5, 123), (500 + 1000 * std::cos(glm::radians(65.0))) / 2, 1e-3);
    EXPECT_EQ(intensity_at(table, 90.5, 0), 0);
    EXPECT_EQ(peak(table), 1000);
    EXPECT_NEAR(flux(table), 1000 * kPi, 0.002 * 1000 * kPi);
}

/// In the form of 1986: no line that names the format, commas, lines that end in CR LF, TILT=INCLUDE; multiplier 1,
/// ballast factor 1, ballast-lamp factor 0.5, and 0.9 for a luminaire that is not tilted. A quarter of the planes.
TEST(Ies, QuarterOf1986) {
    const Photometry table = of_data("quarter_1986.ies");
    const double factor    = 0.9 * 0.5;
    EXPECT_NEAR(intensity_at(table, 90, 0), factor * 110, 1e-3);
    EXPECT_NEAR(intensity_at(table, 90, 90), factor * 90, 1e-3);
    EXPECT_NEAR(intensity_at(table, 0, 17), factor * 100, 1e-3);
    for (const double h : {10.0, 30.0, 47.0})
        for (const double mirrored : {180 - h, 180 + h, 360 - h, h + 360, -h})
            EXPECT_NEAR(intensity_at(table, 75, mirrored), intensity_at(table, 75, h), 1e-9) << mirrored;
    // The cosine of 2 H cancels out: 100 cd in all directions.
    EXPECT_NEAR(flux(table), factor * 100 * 4 * kPi, 0.002 * factor * 400 * kPi);
}

/// Type B: 1000 cd cos(H) cos(V) is 1000 cd times the cosine from the axis, half of the horizontal angles in the file.
/// The ballast-lamp factor of 0.25 is reserved since 2002, and not applied.
TEST(Ies, FloodlightOfTypeB) {
    const Photometry table = of_data("floodlight_b.ies");
    EXPECT_EQ(table.type, PhotometricType::B);
    const dvec3 forward(0, 0, -1), side(1, 0, 0);
    EXPECT_NEAR(intensity_towards(table, forward, side, {0, 0, -2}), 1000, 1e-3);
    EXPECT_EQ(intensity_towards(table, forward, side, {0, 0, 1}), 0);
    // 30 degrees up, then 60 degrees to either side: on the grid.
    const double v = glm::radians(30.0), h = glm::radians(60.0);
    for (const double sign : {1.0, -1.0}) {
        const dvec3 to(sign * std::sin(h), std::cos(h) * std::sin(v), -std::cos(h) * std::cos(v));
        EXPECT_NEAR(intensity_towards(table, forward, side, to), 1000 * std::cos(h) * std::cos(v), 1e-2);
    }
    EXPECT_NEAR(flux(table), 1000 * kPi, 0.06 * 1000 * kPi) << "steps of 30 degrees";
}

/// The three types name directions differently: the same two angles, in a table that has one value there.
TEST(Photometry, TypesNameDirections) {
    Photometry table{.type       = PhotometricType::C,
                     .vertical   = {0, 30, 60, 90},
                     .horizontal = {0, 90, 180, 270, 360},
                     .candela    = std::vector<float>(20, 0)};
    table.candela[1 * 4 + 1] = 1;  // V = 30, H = 90
    const dvec3 down(0, -1, 0), x(1, 0, 0);
    // From above, a quarter anticlockwise from +x is -z.
    EXPECT_NEAR(intensity_towards(table, down, x, {0, -std::sqrt(3.0), -1}), 1, 1e-6);
    EXPECT_NEAR(intensity_towards(table, down, x, {0, -std::sqrt(3.0), 1}), 0, 1e-6);

    const dvec3 forward(0, 0, -1);
    const double v = glm::radians(30.0), h = glm::radians(60.0);
    table                    = {.type       = PhotometricType::A,
                                .vertical   = {-90, 0, 30, 90},
                                .horizontal = {-90, 0, 60, 90},
                                .candela    = std::vector<float>(16, 0)};
    table.candela[2 * 4 + 2] = 1;  // V = 30, H = 60: to the right and up
    const dvec3 in_a(std::cos(v) * std::sin(h), std::sin(v), -std::cos(v) * std::cos(h));
    EXPECT_NEAR(intensity_towards(table, forward, x, in_a), 1, 1e-6);
    EXPECT_EQ(intensity_towards(table, forward, x, -in_a), 0);
    table.type = PhotometricType::B;
    const dvec3 in_b(std::sin(h), std::cos(h) * std::sin(v), -std::cos(h) * std::cos(v));
    EXPECT_NEAR(intensity_towards(table, forward, x, in_b), 1, 1e-6);
    EXPECT_LT(intensity_towards(table, forward, x, in_a), 0.9);
}

/// A light that is the same in all directions of its type's sphere or half sphere.
TEST(Photometry, FluxOfAnEvenLight) {
    const auto even = [](PhotometricType type, std::vector<float> vertical, std::vector<float> horizontal) {
        const std::size_t n = vertical.size() * horizontal.size();
        return flux({type, std::move(vertical), std::move(horizontal), std::vector<float>(n, 10)});
    };
    for (const std::vector<float>& h : {std::vector<float>{0}, {0, 45, 90}, {0, 180}, {0, 90, 180, 360}, {90, 270}})
        EXPECT_NEAR(even(PhotometricType::C, {0, 70, 180}, h), 40 * kPi, 1e-4) << h.size();
    for (const PhotometricType type : {PhotometricType::A, PhotometricType::B}) {
        EXPECT_NEAR(even(type, {-90, 0, 90}, {-90, 90}), 20 * kPi, 1e-4);
        EXPECT_NEAR(even(type, {-90, 90}, {0, 10, 90}), 20 * kPi, 1e-4);
    }
    // The zone between two parallels.
    EXPECT_NEAR(even(PhotometricType::C, {60, 90}, {0}), 10 * 2 * kPi * 0.5, 1e-4);
}

TEST(Photometry, IsLinearBetweenAngles) {
    const Photometry table = of_text(with_angles("0 10 90", 3, "0 90 180 270 360", 5));
    EXPECT_NEAR(intensity_at(table, 5, 45), 50.5, 1e-6);
    EXPECT_NEAR(intensity_at(table, 50, 315), 351.5, 1e-6);
    EXPECT_NEAR(intensity_at(table, 50, -45), 351.5, 1e-6);
}

/// 90 to 270: symmetric about the plane through both.
TEST(Photometry, IsSymmetricAboutTheOtherPlane) {
    const Photometry table = of_text(with_angles("0 90", 2, "90 180 270", 3));
    for (const auto& [h, same] : {std::pair{45.0, 135.0}, {0.0, 180.0}, {300.0, 240.0}, {90.0, 90.0}})
        EXPECT_NEAR(intensity_at(table, 30, h), intensity_at(table, 30, same), 1e-9) << h;
}

TEST(Ies, PlanesThatDoNotCloseAreClosed) {
    const Photometry table = of_text(with_angles("0 90", 2, "0 120 240", 3));
    EXPECT_EQ(table.horizontal.back(), 360);
    EXPECT_NEAR(intensity_at(table, 90, 300), 0.5 * (201 + 1), 1e-6);
}

const std::string kSpelled =
    "IESNA:LM-63-2002\n[TEST] ours\nTILT=NONE\n1 1000 1 4 1 1 2 0 0 0\n1 1 50\n0 30 60 90\n0\n100 80 20 0\n";

void expect_spelled(const Photometry& table, const std::string& text) {
    EXPECT_EQ(table.type, PhotometricType::C) << text;
    EXPECT_EQ(table.vertical, (std::vector<float>{0, 30, 60, 90})) << text;
    EXPECT_EQ(table.horizontal, std::vector<float>{0}) << text;
    EXPECT_EQ(table.candela, (std::vector<float>{100, 80, 20, 0})) << text;
}

/// Forms that the format forbids and programs write: they are read all the same, with a sentence where something is
/// assumed.
TEST(Ies, OtherSpellings) {
    struct Other {
        std::string from, to, warning;
    };
    for (const Other& o :
         std::vector<Other>{{"TILT=NONE", "Tilt=None", ""},
                            {"TILT=NONE", "tilt=none", ""},
                            {"TILT=NONE", "  TILT=NONE  ", ""},
                            {"TILT=NONE", "\tTILT = NONE", ""},
                            {"TILT=NONE", "TILT=", "TILT=NONE is assumed"},
                            {"TILT=NONE", "TILT=lamp.tlt", "the file \"lamp.tlt\" of lamp factors does not exist"},
                            {"TILT=NONE", "TILT=\\lamps\\lamp.tlt", "lamp factors does not exist"},
                            {"1 1000 1 4 1 1 2", "1.0 1000. 1.0 4.0 1.0 1.0 2.0", ""},
                            {"1 1000 1 4 1 1 2", "1,1000,1,4.,1,1,2", ""},
                            {"4 1 1 2", "4 1 C 2", ""},
                            {"4 1 1 2", "4 1 c 2", ""},
                            {"20 0\n", "20 0\nEND\n", "1 words behind the 4 candela values"},
                            {"20 0\n", "20 0\n\n[END] of file\n", "3 words behind"},
                            {"20 0\n", "20 0 0 0 7\n", "3 words behind"},
                            {"20 0\n", "20 -0.0001\n", "1 candela values are negative"},
                            {"100 80 20 0", "100 80 20 -3", "1 candela values are negative"},
                            {"\n0\n", "\n90\n", "the only horizontal angle is 90"},
                            {"\n0\n", "\n-45\n", "the only horizontal angle is -45"},
                            {"1 1 50\n", "1 1\n", "the input watts are left out"},
                            {"1 1 50\n0 30 60 90\n", "1 1\n0 30\n60 90\n", "the input watts are left out"},
                            {"1 1 50\n", "1\n1\n50\n", ""},
                            {"1 1 50\n", "1 1\n50\n", ""},
                            {"IESNA", "\xef\xbb\xbfIESNA", ""}}) {
        std::string text = kSpelled;
        text.replace(text.find(o.from), o.from.size(), o.to);
        expect_spelled(of_text(text, o.warning), text);
        std::replace(text.begin(), text.end(), '\n', '\r');
        expect_spelled(of_text(text, o.warning), text);
    }
}

/// A file of lamp factors that lies beside is read; of it the factor of a luminaire that is not tilted.
TEST(Ies, FileOfLampFactors) {
    const TemporaryFolder folder;
    (void)folder.write("lamp.tlt", "1\n3\n0 45 90\n0.5 0.8 0.9\n");
    std::string text = kSpelled;
    text.replace(text.find("NONE"), 4, "lamp.tlt");
    std::vector<std::string> warnings;
    const Photometry table = read_ies(folder.write("light.ies", text), warnings);
    EXPECT_EQ(table.candela, (std::vector<float>{50, 40, 10, 0}));
    EXPECT_TRUE(warnings.empty());
}

TEST(Ies, FaultsAreNamed) {
    const std::string head = "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 ";
    for (const auto& [text, expected] :
         {std::pair<std::string, std::string>{"", "no line begins with TILT="},
          {"IESNA91\nTILT NONE\n1 1", "no line begins with TILT="},
          {head + "2 1.5 1 2", "the number of horizontal angles is \"1.5\", expected a whole number"},
          {head + "2 1 D 2", "the photometric type is \"D\""},
          {"TILT=INCLUDE\n4\n", "2:1: the lamp's position in the luminaire is 4"},
          {"TILT=INCLUDE\n1\n2\n10 20\n1 1\n", "do not increase from 0"},
          {head + "2 1 4 2 0 0 0\n1 1 1\n0 90\n0\n1 1\n", "photometric type is 4, expected a whole number from 1 to 3"},
          {head + "2 1 1 3 0 0 0\n", "the unit of lengths is 3"},
          {head + "2 x 1", "the number of horizontal angles is \"x\""},
          {head + "900000000 1 1 2 0 0 0\n1 1 1\n", "the number of vertical angles is 900000000"},
          {head + "2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1\n", "a candela value is missing"},
          {head + "2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n1 END\n", "a candela value is \"END\""},
          {head + "2 1 1 2 0 0 0\n1 1 1\n90 0\n0\n1 1\n", "5:1: the vertical angle 0 follows 90"},
          {head + "2 1 1 2 0 0 0\n1 1 1\n0 200\n0\n1 1\n", "a vertical angle of 200 degrees"},
          {with_angles("0 90", 2, "0 120", 2), "go from 0 to 120 degrees, expected 0 alone"},
          {with_angles("-90 90", 2, "0 60", 2, 2), "expected 0 to 90 or -90 to 90 of type B"},
          {with_angles("0 90", 2, "0 90", 2, 3), "expected negative ones, too, of type A"}}) {
        try {
            (void)of_text(text);
            ADD_FAILURE() << text << " was read";
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find(expected), std::string::npos) << e.what();
        }
    }
    EXPECT_NO_THROW((void)of_text(with_angles("0 90", 2, "0", 1) + "\n\x1a")) << "the end of a file under DOS";
}

}  // namespace
}  // namespace umbra
