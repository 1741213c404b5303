// The sun of native scenes, against published positions.
//
// Ibrahim Reda, Afshin Andreas. Solar Position Algorithm for Solar Radiation Applications. NREL/TP-560-34302. 2008
// (table A5.1: 17 October 2003 at Golden, Colorado)
#include <fmt/format.h>

#include <cmath>

#include "umbra/core/io/scene_writer.h"
#include "umbra/tests/support/scene_files.h"

namespace umbra {
namespace {

std::string scene(std::string_view sun, std::string_view more = "") {
    return fmt::format(R"({{"objects": [{{"type": "box"}}], "lights": [{{"type": "directional", "sun": {{{}}}{}}}]}})",
                       sun, more);
}
std::string at(double latitude, double longitude, std::string_view time, std::string_view more = "") {
    return scene(fmt::format(R"("latitude": {}, "longitude": {}, "time": "{}"{})", latitude, longitude, time, more));
}

struct Sky {
    double elevation, azimuth;  ///< degrees; from north by east
};

/// Where the sun stands, with north along -z and east along x.
Sky sky(const std::string& text) {
    const TemporaryFolder folder;
    const dvec3 sun   = -glm::normalize(dvec3(load_scene(folder.write("a.json", text)).lights[0].direction));
    const double turn = glm::degrees(std::atan2(sun.x, -sun.z));
    return {glm::degrees(std::asin(sun.y)), turn < 0 ? turn + 360 : turn};
}

constexpr double kGoldenLatitude = 39.742476, kGoldenLongitude = -105.1786;

TEST(Sun, StandsWhereThePublishedAlgorithmPutsIt) {
    for (const std::string_view time :
         {"2003-10-17T12:30:30-07:00", "2003-10-17T19:30:30Z", "2003-10-17T19:30:30.0Z"}) {
        const Sky golden = sky(at(kGoldenLatitude, kGoldenLongitude, time));
        EXPECT_NEAR(golden.elevation, 39.872046, 0.01) << time;  // without refraction
        EXPECT_NEAR(golden.azimuth, 194.340241, 0.01) << time;
    }
}

// Solstices and equinox of 2026 at the minute of the almanac: the declination is that of the ecliptic, 23.436 degrees,
// or 0. At a pole the elevation is the declination, and at the equator of an equinox the sun goes by east, zenith,
// west.
TEST(Sun, SolsticesAndEquinoxByHand) {
    EXPECT_NEAR(sky(at(90, 0, "2026-06-21T08:24:00Z")).elevation, 23.436, 0.01);
    EXPECT_NEAR(sky(at(-90, 0, "2026-12-21T20:50:00Z")).elevation, 23.436, 0.01);
    const Sky afternoon = sky(at(0, 0, "2026-03-20T14:46:00Z"));
    EXPECT_NEAR(afternoon.azimuth, 270, 0.02);
    // 2 h 46 min past noon less 7.4 min, by which the sun is late in March: 39.65 degrees from the zenith.
    EXPECT_NEAR(afternoon.elevation, 50.35, 0.05);
    EXPECT_NEAR(sky(at(0, -90, "2026-03-20T14:46:00Z")).azimuth, 90, 0.02);
}

TEST(Sun, NorthTurnsIt) {
    const double golden = sky(at(kGoldenLatitude, kGoldenLongitude, "2003-10-17T19:30:30Z")).azimuth;
    const double to_east =
        sky(at(kGoldenLatitude, kGoldenLongitude, "2003-10-17T19:30:30Z", R"(, "north": [2, 0, 0])")).azimuth;
    EXPECT_NEAR(to_east, golden + 90, 1e-4);
}

TEST(Sun, IsWrittenAsADirection) {
    const TemporaryFolder folder;
    const Scene once  = load_scene(folder.write("a.json", at(50, 8, "2026-06-21T14:00+02:00")));
    const Scene again = load_scene(folder.write("a.json", native_text(once)));
    EXPECT_EQ(native_text(once).find("latitude"), std::string::npos);
    EXPECT_EQ(again.lights[0].direction, once.lights[0].direction);
}

TEST(Sun, WhatItCannotBeIsRefused) {
    const std::string day = R"("latitude": 50, "longitude": 8, "time": "2026-06-21T12:00:00Z")";
    const std::vector<std::pair<std::string, std::string>> refused{
        {at(50, 8, "2026-06-21T23:30:00Z"), "degrees below the horizon at this place and time"},
        {at(50, 8, "2026-06-21T12:00:00"), "expected a date of the years 1800 to 2200, a time and its offset"},
        {at(50, 8, "2026-02-30T12:00:00Z"), "time is \"2026-02-30T12:00:00Z\""},
        {at(50, 8, "2026-06-21T12:60:00Z"), "time is"},
        {at(50, 8, "2026-06-21T12:00:00+2"), "time is"},
        {at(50, 8, "noon"), "time is \"noon\""},
        {at(91, 8, "2026-06-21T12:00:00Z"), "latitude is 91"},
        {at(50, 181, "2026-06-21T12:00:00Z"), "longitude is 181"},
        {scene(R"("latitude": 50, "longitude": 8)"), "\"time\""},
        {scene(day + R"(, "elevation": 3)"), "elevation"},
        {scene(day + R"(, "north": [0, 1, 0])"), "expected a horizontal direction"},
        {scene(day, R"(, "direction": [0, -1, 0])"), "both \"direction\" and \"sun\""},
        {scene(day, R"(, "fixed_to": "camera")"), "both \"fixed_to\" and \"sun\""}};
    const TemporaryFolder folder;
    for (const auto& [text, says] : refused) {
        const std::string found = refusal(folder.write("a.json", text));
        EXPECT_NE(found.find(says), std::string::npos) << text << '\n' << found;
        EXPECT_NE(found.find("a.json:1:"), std::string::npos) << found;
    }
}

}  // namespace
}  // namespace umbra
