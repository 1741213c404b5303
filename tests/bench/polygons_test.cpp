// Lit polygons as files: their areas and corners where they are known by hand, read from the files as others do.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "umbra/bench/cli/lit_polygons.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/program.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// A floor of two triangles, 8 x 4, and over it, at height 1, a level sheet 2 x 1 with a corner at (1, 1, 1).
Scene sheet_over_floor() {
    Scene scene;
    scene.name = "sheet";
    scene.materials.resize(1);
    add_object(scene, "floor", {{0, 0, 0}, {0, 0, 4}, {8, 0, 4}, {8, 0, 0}}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
    add_object(scene, "sheet", {{1, 1, 1}, {1, 1, 2}, {3, 1, 2}, {3, 1, 1}}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
    Light sun, lamp;
    sun.name = "sun", sun.kind = LightKind::directional, sun.direction = {1, -1, 0};
    lamp.name = "lamp <1>", lamp.position = {2, 2, 1};
    scene.lights = {sun, lamp};
    return scene;
}

struct Triangle {
    dvec3 a, b, c;
    [[nodiscard]] double area() const { return glm::length(glm::cross(b - a, c - a)) / 2; }
    [[nodiscard]] double low(int axis) const { return std::min({a[axis], b[axis], c[axis]}); }
    [[nodiscard]] double high(int axis) const { return std::max({a[axis], b[axis], c[axis]}); }
};

/// The triangles of each object of an OBJ file.
std::map<std::string, std::vector<Triangle>> read_mesh(const fs::path& file) {
    std::map<std::string, std::vector<Triangle>> objects;
    std::vector<dvec3> vertices;
    std::ifstream in(file);
    std::string object;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "o") words >> object;
        if (kind == "v") {
            dvec3& p = vertices.emplace_back();
            words >> p.x >> p.y >> p.z;
        }
        std::size_t i = 0, j = 0, k = 0;
        if (kind == "f" && words >> i >> j >> k)
            objects[object].push_back({vertices.at(i - 1), vertices.at(j - 1), vertices.at(k - 1)});
    }
    return objects;
}

double area(const std::vector<Triangle>& triangles) {
    double sum = 0;
    for (const Triangle& t : triangles) sum += t.area();
    return sum;
}

using Loops = std::vector<std::vector<dvec2>>;

/// The loops of a path in an SVG file.
Loops read_path(const fs::path& file, const std::string& name) {
    std::ifstream in(file);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    std::smatch path;
    if (!std::regex_search(text, path, std::regex("class=\"" + name + "\"[^>]* d=\"([^\"]*)\""))) return {};
    Loops loops;
    std::istringstream all(path[1].str());
    for (std::string loop; std::getline(all, loop, 'Z');) {
        std::ranges::replace_if(
            loop, [](char c) { return c == 'M' || c == 'L'; }, ' ');
        std::istringstream numbers(loop);
        loops.emplace_back();
        for (dvec2 p; numbers >> p.x >> p.y;) loops.back().push_back(p);
    }
    return loops;
}

/// Holes count less than nothing.
double area(const Loops& loops) {
    double twice = 0;
    for (const auto& loop : loops)
        for (std::size_t k = 0; k < loop.size(); ++k) {
            const dvec2 p = loop[k], q = loop[(k + 1) % loop.size()];
            twice += p.x * q.y - p.y * q.x;
        }
    return std::abs(twice) / 2;
}

/// By the even-odd rule.
bool holds(const Loops& loops, dvec2 at) {
    bool inside = false;
    for (const auto& loop : loops)
        for (std::size_t k = 0; k < loop.size(); ++k) {
            const dvec2 p = loop[k], q = loop[(k + 1) % loop.size()];
            if ((p.y > at.y) != (q.y > at.y) && p.x + (at.y - p.y) / (q.y - p.y) * (q.x - p.x) > at.x) inside = !inside;
        }
    return inside;
}

// The sun moves the sheet's shadow by 1 along x: [2, 4] x [1, 2], area 2. The lamp, at height 2 over (2, 1), doubles it
// about that point: [0, 4] x [1, 3], area 8. The sheet itself is lit.
TEST(PolygonFiles, HaveTheAreasThatAreKnownByHand) {
    const TemporaryFolder folder;
    const Scene scene = sheet_over_floor();
    const Json record = to_record(write_lit_polygons(scene, find_facts(scene), folder.path()));
    ASSERT_EQ(record["lights"].size(), 2u);
    const struct { double hidden, low_x, high_x, low_z, high_z; } known[] = {{2, 2, 4, 1, 2}, {8, 0, 4, 1, 3}};
    for (std::size_t l = 0; l < 2; ++l) {
        const Json& light = record["lights"][l];
        const auto& shade = known[l];
        EXPECT_EQ(light["name"], scene.lights[l].name);
        EXPECT_NEAR(light["area"].get<double>(), 34, 1e-12);
        EXPECT_NEAR(light["lit_area"].get<double>(), 34 - shade.hidden, 1e-12);

        const auto mesh = read_mesh(folder.path() / light["mesh"].get<std::string>());
        ASSERT_EQ(mesh.size(), 2u);
        EXPECT_NEAR(area(mesh.at("floor")), 32 - shade.hidden, 1e-12);
        EXPECT_NEAR(area(mesh.at("sheet")), 2, 1e-12);
        for (const Triangle& t : mesh.at("floor")) {
            EXPECT_EQ(t.high(1), 0);
            EXPECT_GE(t.low(0), 0);
            EXPECT_LE(t.high(0), 8);
            // No part of it is in the shadow.
            const dvec3 middle = (t.a + t.b + t.c) / 3.0;
            EXPECT_FALSE(shade.low_x < middle.x && middle.x < shade.high_x && shade.low_z < middle.z &&
                         middle.z < shade.high_z);
        }

        // The floor is the larger plane.
        ASSERT_EQ(light["planes"].size(), 2u);
        const Json& floor = light["planes"][0];
        EXPECT_NEAR(floor["area"].get<double>(), 32, 1e-12);
        EXPECT_NEAR(floor["lit_area"].get<double>(), 32 - shade.hidden, 1e-12);
        const fs::path drawing = folder.path() / floor["drawing"].get<std::string>();
        const Loops lit = read_path(drawing, "lit"), all = read_path(drawing, "umbra");
        EXPECT_NEAR(area(lit), 32 - shade.hidden, 1e-9);
        EXPECT_NEAR(area(all), 32, 1e-9);
        // From above: x to the right, z down.
        EXPECT_TRUE(holds(all, {0.1, 0.1}) && holds(all, {7.9, 3.9}));
        for (const dvec2 step : {dvec2(1e-6, 1e-6), dvec2(-1e-6, -1e-6)}) {
            const bool inside = step.x > 0;
            EXPECT_EQ(holds(lit, dvec2(shade.low_x, shade.low_z) + step), !inside && shade.low_x > 0);
            EXPECT_EQ(holds(lit, dvec2(shade.high_x, shade.high_z) + step), inside);
        }
    }
}

/// A floor that receives no shadows is lit, all of it; a sheet that casts none leaves the floor lit, too.
TEST(PolygonFiles, AreWholeWhereNoShadowIsReceivedOrCast) {
    for (const bool receives : {true, false}) {
        const TemporaryFolder folder;
        Scene scene                                = sheet_over_floor();
        scene.objects[0].switches.receives_shadows = receives;
        scene.objects[1].switches.casts_shadows    = !receives;
        const Json record = to_record(write_lit_polygons(scene, find_facts(scene), folder.path()));
        for (const Json& light : record["lights"]) {
            EXPECT_NEAR(light["lit_area"].get<double>(), 34, 1e-12);
            EXPECT_NEAR(area(read_mesh(folder.path() / light["mesh"].get<std::string>()).at("floor")), 32, 1e-12);
        }
    }
}

TEST(PolygonFiles, EscapeNames) {
    const TemporaryFolder folder;
    const Scene scene = sheet_over_floor();
    const Json record = to_record(write_lit_polygons(scene, find_facts(scene), folder.path()));
    std::ifstream in(folder.path() / record["lights"][1]["planes"][0]["drawing"].get<std::string>());
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    EXPECT_NE(text.find("<title>What lamp &lt;1&gt; lights in sheet</title>"), std::string::npos) << text;
}

TEST(PolygonFiles, TheCommandWritesThemAndRefusesAreaLights) {
    const TemporaryFolder folder;
    const std::string out = (folder.path() / "out").string();
    const auto umbra    = [&](const std::string& line) { return run_program(std::string(UMBRA_PROGRAM) + " " + line); };
    const auto polygons = [&](const std::string& scene) { return umbra("polygons " + scene + " -o " + out); };
    const ProgramAnswer ok = polygons("stairs");
    EXPECT_EQ(ok.exit_code, 0) << ok.output;
    EXPECT_NE(ok.output.find("plane 1"), std::string::npos) << ok.output;
    std::ifstream in(out + "/results.json");
    const Json record = Json::parse(in);
    EXPECT_TRUE(fs::exists(out + "/" + record["lights"][0]["mesh"].get<std::string>()));
    EXPECT_EQ(polygons("stairs").exit_code, 0);  // in place of its own result

    const ProgramAnswer refused = polygons("umbra_penumbra");
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_NE(refused.output.find("no area lights"), std::string::npos) << refused.output;
    EXPECT_TRUE(fs::exists(out + "/results.json"));
}

}  // namespace
}  // namespace umbra
