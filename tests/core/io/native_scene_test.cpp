// The native format: what its keys mean, and where and how its errors are reported.
#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

Scene load(const TemporaryFolder& folder, std::string_view text) {
    return load_scene(folder.write("scene.json", text));
}
Scene load(std::string_view text) { return load(TemporaryFolder(), text); }

constexpr std::string_view kCamera = R"("camera": {"eye": [0, 1, 5], "target": [0, 0, 0]})";
constexpr std::string_view kLights = R"("lights": [{"type": "point", "position": [0, 3, 0]}])";

Scene load_object(std::string_view object) {
    return load(fmt::format(R"({{{}, {}, "objects": [{}]}})", kCamera, kLights, object));
}
Scene load_light(std::string_view light) {
    return load(fmt::format(R"({{{}, "objects": [{{"type": "box"}}], "lights": [{}]}})", kCamera, light));
}

void expect_near(vec3 a, vec3 b, double tolerance = 1e-6) {
    EXPECT_LE(glm::distance(dvec3(a), dvec3(b)), tolerance)
        << fmt::format("({}, {}, {}) and ({}, {}, {})", a.x, a.y, a.z, b.x, b.y, b.z);
}

TEST(NativeScene, EveryKeyOfTheSceneIsRead) {
    const Scene s = load(R"({
        "$schema": "x", "note": "nothing", "title": "A title", "shows": "It shows.", "size": [320, 200],
        "camera": {"eye": [1, 2, 3], "target": [4, 5, 6], "up": [0, 0, 1], "height": 7, "note": "orthographic"},
        "ambient": [0.1, 0.2, 0.3], "background": "#ff8000", "tone": "hue", "exposure": 2.5, "viewer": "infinite",
        "materials": {"m": {"k_a": 0.5, "k_d": [0.1, 0.2, 0.3], "k_s": 0.4, "O_d": "#FFFFFF", "O_s": [1, 0, 0],
                            "emission": 2, "shininess": 50, "lobe": "blinn_phong", "two_sided": false, "opacity": 0.75,
                            "reflect": 0.25, "transmit": 0.125, "index_of_refraction": 1.5}},
        "lights": [{"type": "point", "position": [0, 9, 0]}],
        "objects": [{"name": "b", "type": "box", "material": "m"}]
    })");
    EXPECT_EQ(s.name, "scene");
    EXPECT_EQ(s.title, "A title");
    EXPECT_EQ(s.shows, "It shows.");
    EXPECT_EQ(s.width, 320);
    EXPECT_EQ(s.height, 200);
    EXPECT_EQ(s.camera.projection, Projection::orthographic);
    EXPECT_EQ(s.camera.eye, vec3(1, 2, 3));
    EXPECT_EQ(s.camera.target, vec3(4, 5, 6));
    EXPECT_EQ(s.camera.up, vec3(0, 0, 1));
    EXPECT_EQ(s.camera.height, 7);
    EXPECT_EQ(s.ambient, vec3(0.1f, 0.2f, 0.3f));
    expect_near(s.background, vec3(1, 0.2158605, 0));  // IEC 61966-2-1 of 128 / 255
    EXPECT_EQ(s.tone, ToneMap::hue);
    EXPECT_EQ(s.exposure, 2.5f);
    EXPECT_FALSE(s.local_viewer);
    ASSERT_EQ(s.materials.size(), 1u);
    const Material& m = s.materials[0];
    EXPECT_EQ(m.name, "m");
    EXPECT_EQ(m.k_a, vec3(0.5f));
    EXPECT_EQ(m.k_d, vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.k_s, vec3(0.4f));
    EXPECT_EQ(m.O_d, vec3(1));
    EXPECT_EQ(m.O_s, vec3(1, 0, 0));
    EXPECT_EQ(m.emission, vec3(2));
    EXPECT_EQ(m.shininess, 50);
    EXPECT_EQ(m.lobe, Lobe::blinn_phong);
    EXPECT_FALSE(m.two_sided);
    EXPECT_EQ(m.opacity, 0.75f);
    EXPECT_EQ(m.reflect, 0.25f);
    EXPECT_EQ(m.transmit, 0.125f);
    EXPECT_EQ(m.index_of_refraction, 1.5f);
    ASSERT_EQ(s.objects.size(), 1u);
    EXPECT_EQ(s.objects[0].name, "b");
    EXPECT_EQ(s.objects[0].triangle_count, 12u);
    const char* not_computed[] = {"opacity", "transmit", "reflect", "index_of_refraction"};
    ASSERT_EQ(s.warnings.size(), std::size(not_computed));
    for (std::size_t k = 0; k < s.warnings.size(); ++k)
        EXPECT_NE(s.warnings[k].find(not_computed[k]), std::string::npos) << s.warnings[k];
}

TEST(NativeScene, LightsOfEveryKind) {
    const Scene s = load(fmt::format(R"({{{}, "objects": [{{"type": "box"}}], "lights": [
        {{"name": "sun", "type": "directional", "direction": [1, -2, 0], "colour": [1, 0.5, 0.25], "intensity": 2}},
        {{"type": "point", "position": [1, 2, 3], "diffuse": 0.5, "specular": [0, 0, 1], "ambient": 0.1,
          "attenuation": [0, 0, 2], "clamp": false, "range": 9}},
        {{"type": "spot", "position": [0, 4, 0], "target": [3, 0, 0], "falloff": "zachmann", "exponent": 3, "cutoff": 30}},
        {{"type": "spot", "position": [0, 4, 0], "direction": [0, -7, 0], "falloff": "smooth", "cutoff": 90, "inner": 45}},
        {{"type": "rectangle", "position": [0, 4, 0], "size": [2, 1]}},
        {{"type": "rectangle", "position": [0, 4, 0], "edge_u": [0, 0, 3], "edge_v": [0, 2, 0]}},
        {{"type": "disk", "position": [0, 4, 0], "target": [0, 4, 8], "radius": 0.5}},
        {{"type": "sphere", "position": [0, 4, 0], "radius": 0.25}}]}})",
                                     kCamera));
    ASSERT_EQ(s.lights.size(), 8u);
    EXPECT_TRUE(s.warnings.empty());
    const Light& sun = s.lights[0];
    EXPECT_EQ(sun.kind, LightKind::directional);
    EXPECT_EQ(sun.name, "sun");
    EXPECT_EQ(sun.diffuse, vec3(2, 1, 0.5f));
    EXPECT_EQ(sun.specular, vec3(2, 1, 0.5f));
    EXPECT_EQ(sun.ambient, vec3(0));
    EXPECT_EQ(-2 * sun.direction.x, sun.direction.y) << "scaled by a power of two, so exactly parallel";
    const Light& point = s.lights[1];
    EXPECT_EQ(point.name, "point");
    EXPECT_EQ(point.position, vec3(1, 2, 3));
    EXPECT_EQ(point.diffuse, vec3(0.5f));
    EXPECT_EQ(point.specular, vec3(0, 0, 1));
    EXPECT_EQ(point.ambient, vec3(0.1f));
    EXPECT_EQ(point.attenuation.c1, 0);
    EXPECT_EQ(point.attenuation.c3, 2);
    EXPECT_FALSE(point.attenuation.clamp);
    EXPECT_EQ(point.range, 9);
    const Light& spot = s.lights[2];
    expect_near(spot.direction, vec3(0.6f, -0.8f, 0));
    EXPECT_EQ(spot.spot.falloff, SpotFalloff::zachmann);
    EXPECT_EQ(spot.spot.exponent, 3);
    EXPECT_NEAR(spot.spot.cutoff, kPi / 6, 1e-6);
    EXPECT_EQ(s.lights[3].name, "spot_2");
    EXPECT_EQ(s.lights[3].direction, vec3(0, -1, 0));
    EXPECT_NEAR(s.lights[3].spot.inner, kPi / 4, 1e-6);
    for (const std::size_t i : {4u, 5u}) {
        const Light& r = s.lights[i];
        expect_near(r.direction, glm::normalize(glm::cross(r.edge_u, r.edge_v)));
    }
    expect_near(s.lights[4].direction, vec3(0, -1, 0));
    expect_near(glm::abs(s.lights[4].edge_u), vec3(2, 0, 0));
    expect_near(glm::abs(s.lights[4].edge_v), vec3(0, 0, 1));
    EXPECT_EQ(s.lights[5].edge_u, vec3(0, 0, 3));
    EXPECT_EQ(s.lights[6].direction, vec3(0, 0, 1));
    EXPECT_EQ(s.lights[6].radius, 0.5f);
    EXPECT_EQ(s.lights[7].radius, 0.25f);
}

TEST(NativeScene, ASphereLightWithoutARadiusIsAPoint) {
    for (const char* zero : {"0", "0.0", "-0.0", "0e3"}) {
        const Scene s = load_light(fmt::format(
            R"({{"type": "sphere", "position": [1, 2, 3], "attenuation": [0, 0, 1], "radius": {0}}},
               {{"type": "sphere", "position": [1, 2, 3], "radius": {0}}})",
            zero));
        ASSERT_EQ(s.lights.size(), 2u);
        EXPECT_EQ(s.lights[0].kind, LightKind::point) << zero;
        EXPECT_EQ(s.lights[0].position, vec3(1, 2, 3));
        EXPECT_EQ(s.lights[0].attenuation.c3, 1);
        EXPECT_EQ(std::ranges::count(s.warnings, "A sphere light of radius 0 is taken as a point light."), 1) << zero;
    }
}

/// One photometric file for two lights: its warning once.
TEST(NativeScene, WarningsOfPhotometricFilesAreTold) {
    const TemporaryFolder folder;
    (void)folder.write("l.ies", "TILT=NONE\n1 1000 1 4 1 1 2 0 0 0\n1 1 50\n0 30 60 90\n0\n100 80 20 0\nEND\n");
    const std::string light = R"({"type": "point", "position": [0, 3, 0], "ies": "l.ies"})";
    const Scene s           = load(
                  folder, fmt::format(R"({{{}, "objects": [{{"type": "box"}}], "lights": [{}, {}]}})", kCamera, light, light));
    EXPECT_EQ(
        std::ranges::count_if(s.warnings, [](const std::string& w) { return w.find("1 words behind") != w.npos; }), 1);
}

/// A hard edge, as a scene that was written has it.
TEST(NativeScene, ASpotMayHaveEqualAngles) {
    const Scene s = load_light(
        R"({"type": "spot", "position": [0, 4, 0], "target": [0, 0, 0], "falloff": "smooth", "cutoff": 20, "inner": 20})");
    EXPECT_EQ(s.lights.at(0).spot.inner, s.lights.at(0).spot.cutoff);
}

TEST(NativeScene, ARectangleFacesItsTargetAndKeepsItsSize) {
    const Light r =
        load_light(
            R"({"type": "rectangle", "position": [3, 4, 0], "target": [0, 0, 0], "size": [2, 1], "up": [0, 0, 1]})")
            .lights[0];
    expect_near(r.direction, vec3(-0.6f, -0.8f, 0));
    EXPECT_NEAR(glm::length(r.edge_u), 2, 1e-6);
    EXPECT_NEAR(glm::length(r.edge_v), 1, 1e-6);
    expect_near(r.edge_v, vec3(0, 0, 1));
}

TEST(NativeScene, LightNamesFitChannels) {
    const Scene s = load(fmt::format(R"({{{}, "objects": [{{"type": "box"}}], "lights": [
        {{"type": "point", "position": [0, 3, 0], "name": "my lamp.left"}},
        {{"type": "point", "position": [0, 3, 0], "name": "my_lamp_left"}},
        {{"type": "point", "position": [0, 3, 0], "name": "Lämpchen"}}]}})",
                                     kCamera));
    EXPECT_EQ(s.lights[0].name, "my_lamp_left");
    EXPECT_EQ(s.lights[1].name, "my_lamp_left_2");
    EXPECT_EQ(s.lights[2].name, "L_mpchen");
    EXPECT_EQ(s.warnings.size(), 3u);
}

TEST(NativeScene, TransformStepsApplyInTheOrderWritten) {
    const auto x = [](std::string_view steps) {
        return bounds(load_object(fmt::format(R"({{"type": "box", "transform": [{}]}})", steps))).centre();
    };
    expect_near(x(R"({"translate": [1, 2, 3]}, {"scale": 2})"), vec3(2, 4, 6));
    expect_near(x(R"({"scale": 2}, {"translate": [1, 2, 3]})"), vec3(1, 2, 3));
    expect_near(x(R"({"translate": [1, 0, 0]}, {"rotate_y": 90})"), vec3(0, 0, -1));
    expect_near(x(R"({"translate": [0, 1, 0]}, {"rotate_x": 90})"), vec3(0, 0, 1));
    expect_near(x(R"({"translate": [1, 0, 0]}, {"rotate_z": 90})"), vec3(0, 1, 0));
    expect_near(x(R"({"translate": [1, 0, 0]}, {"rotate": {"axis": [1, 1, 1], "angle": 120}})"), vec3(0, 1, 0));
    expect_near(x(R"({"translate": [1, 2, 3]}, {"matrix": [[0, 1, 0, 10], [0, 0, 1, 20], [1, 0, 0, 30]]})"),
                vec3(12, 23, 31));
    expect_near(x(R"({"translate": [1, 2, 3]}, {"scale": [-1, 1, 1]})"), vec3(-1, 2, 3));
}

TEST(NativeScene, FitStandsABodyOnTheGround) {
    const auto box = [](std::string_view fit) {
        return bounds(load_object(fmt::format(
            R"({{"type": "box", "size": [1, 2, 4], "transform": [{{"translate": [7, 8, 9]}}, {{"fit": {}}}]}})", fit)));
    };
    expect_near(box("2").min, vec3(-0.25f, 0, -1));
    expect_near(box("2").max, vec3(0.25f, 1, 1));
    expect_near(box(R"({"height": 4})").max, vec3(1, 4, 4));
    expect_near(box(R"({"width": 4})").max, vec3(2, 8, 8));
    expect_near(box(R"({"depth": 8})").max, vec3(1, 4, 4));
    expect_near(box(R"({"size": 8})").max, vec3(1, 4, 4));
}

TEST(NativeScene, ShadingGivenFlatAveraged) {
    const auto normals = [](std::string_view rest) {
        return load_object(fmt::format(R"({{"type": "cylinder", "segments": 8 {}}})", rest)).normals;
    };
    for (const vec3 n : normals(R"(, "shading": "flat")")) EXPECT_EQ(n, vec3(0));
    for (const vec3 n : normals("")) EXPECT_TRUE(n.y == 0 || std::abs(n.y) == 1);
    const auto averaged = normals(R"(, "shading": "averaged")");
    EXPECT_EQ(averaged.size(), 18u) << "the rim is one position each";
    EXPECT_EQ(normals(R"(, "shading": "averaged", "crease": 60)").size(), 34u);
    EXPECT_EQ(normals(R"(, "shading": "averaged", "crease": 30)").size(), 8u * 6 + 2) << "45 degrees are a crease now";
}

TEST(NativeScene, TrianglesKeepTheirNormals) {
    const Scene s = load_object(R"({"type": "triangles", "positions": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]],
                                    "normals": [[0,0,2],[0,3,4],[0,0,1]], "material": {"k_d": 0.25}})");
    EXPECT_EQ(s.normals[0], vec3(0, 0, 1));
    expect_near(s.normals[1], vec3(0, 0.6f, 0.8f));
    EXPECT_EQ(s.materials[s.objects[0].material].k_d, vec3(0.25f));
}

TEST(NativeScene, ObjectsSayWhatTheyTakePartIn) {
    const auto of = [](std::string_view keys) {
        return load_object(fmt::format(R"({{"type": "box"{}}})", keys)).objects.at(0).switches;
    };
    EXPECT_EQ(of(""), ObjectSwitches());
    EXPECT_EQ(of(R"(, "casts_shadows": true, "receives_shadows": true, "seen_by_camera": true)"), ObjectSwitches());
    EXPECT_EQ(of(R"(, "casts_shadows": false)"), (ObjectSwitches{false, true, true}));
    EXPECT_EQ(of(R"(, "receives_shadows": false)"), (ObjectSwitches{true, false, true}));
    EXPECT_EQ(of(R"(, "seen_by_camera": false)"), (ObjectSwitches{true, true, false}));
}

/// All parts of a mesh file follow the object; terms that the object does not state are the file's.
TEST(NativeScene, PartsOfAMeshTakePartInWhatTheObjectSays) {
    const TemporaryFolder folder;
    folder.write("two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no a\nf 1 2 3\no b\nf 1 3 4\n");
    const Scene scene = load(folder, fmt::format(R"({{{}, {}, "objects": [
        {{"type": "mesh", "file": "two.obj", "casts_shadows": false}}, {{"type": "mesh", "file": "two.obj"}}]}})",
                                                 kCamera, kLights));
    ASSERT_EQ(scene.objects.size(), 4u);
    for (std::size_t o = 0; o < 4; ++o) EXPECT_EQ(scene.objects[o].switches.casts_shadows, o >= 2) << o;
}

TEST(NativeScene, MeshFilesArePlacedByPathRelativeToTheScene) {
    const TemporaryFolder folder;
    folder.write("sub/two.obj",
                 "o first\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no second\nv 0 0 5\nv 1 0 5\nv 0 1 5\nf 4 5 6\n");
    const Scene s = load_scene(folder.write("scene.json", fmt::format(R"({{{}, {}, "objects": [
            {{"name": "a", "type": "mesh", "file": "sub/two.obj", "material": {{"k_d": 0.5}}, "transform": [{{"scale": 2}}]}},
            {{"type": "box"}},
            {{"name": "b", "type": "mesh", "file": "sub/two.obj", "shading": "averaged", "material": {{}}}}]}})",
                                                                      kCamera, kLights)));
    ASSERT_EQ(s.objects.size(), 5u);
    EXPECT_EQ(s.objects[0].name, "a/first");
    EXPECT_EQ(s.objects[1].name, "a/second");
    EXPECT_EQ(s.objects[4].name, "b/second");
    EXPECT_EQ(s.materials[s.objects[1].material].k_d, vec3(0.5f));
    EXPECT_EQ(s.vertex(1, 1), vec3(2, 0, 10));
    EXPECT_EQ(s.normals[s.triangles[14].x], vec3(0, 0, 1));
}

TEST(NativeScene, WhatIsMissingIsAssumedAndSaid) {
    const Scene s = load(R"({"objects": [{"type": "box", "transform": [{"translate": [100, 0, 0]}]}]})");
    ASSERT_EQ(s.warnings.size(), 2u);
    EXPECT_NE(s.warnings[0].find("no camera"), std::string::npos);
    EXPECT_NE(s.warnings[1].find("no light"), std::string::npos);
    EXPECT_EQ(s.lights.size(), 1u);
    const CameraFrame f = frame(s.camera, s.width, s.height);
    for (const vec3 p : s.positions) {
        const dvec3 pixel = f.project(dvec3(p));
        EXPECT_GT(pixel.z, 0);
        EXPECT_TRUE(pixel.x > 0 && pixel.x < s.width && pixel.y > 0 && pixel.y < s.height) << pixel.x << " " << pixel.y;
    }
    EXPECT_EQ(load("{}").warnings.size(), 3u) << "nor triangles";
}

TEST(NativeScene, AnEmptyListOfLightsMeansDarkness) {
    const Scene s = load(fmt::format(R"({{{}, "lights": [], "objects": [{{"type": "box"}}]}})", kCamera));
    EXPECT_TRUE(s.lights.empty());
    EXPECT_TRUE(s.warnings.empty());
}

TEST(NativeScene, MoreLightThanThereIsWarns) {
    const Scene s = load_object(R"({"type": "box", "name": "b", "material": {"k_d": [0.5, 0.8, 0.5], "k_s": 0.3}})");
    ASSERT_EQ(s.warnings.size(), 1u);
    EXPECT_NE(s.warnings[0].find("\"b\""), std::string::npos);
    EXPECT_NE(s.warnings[0].find("1.1"), std::string::npos);
    EXPECT_TRUE(load_object(R"({"type": "box", "material": {"k_d": 0.7, "k_s": 0.3}})").warnings.empty());
}

TEST(NativeScene, DegenerateTrianglesWarn) {
    const Scene s = load_object(
        R"({"type": "triangles", "positions": [[0,0,0],[1,1,1],[3,3,3],[0,1,0]], "triangles": [[0,1,2],[0,1,1],[0,1,3]]})");
    ASSERT_EQ(s.warnings.size(), 1u);
    EXPECT_NE(s.warnings[0].find("2 of 3"), std::string::npos) << s.warnings[0];
}

// A fault each: '@' is where the message must point to.
struct Fault {
    std::string_view text;
    std::string_view message;
};
const Fault kFaults[] = {
    // Not JSON.
    {"@", "cut off"},
    {"  @", "cut off"},
    {R"({"title": "x"@)", "cut off"},
    {R"({"title": "x@)", "within a string, expected a closing quote"},
    {R"({"size": [1, 2,@)", "cut off"},
    {R"({"exposure": @NaN})", "neither NaN nor infinity"},
    {R"({"exposure": @Infinity})", "neither NaN nor infinity"},
    {R"({"exposure": @1e999})", "1e999 is too large"},
    {R"({"exposure": 1, @})", "remove the comma before it"},
    {R"({"size": [1, 2, @]})", "remove the comma before it"},
    {"{\n  @// a comment\n}", "no comments"},
    {R"({@title: 1})", "found \"title\", expected a key in quotes"},
    {R"({"title" @"x"})", "found a string, expected \":\""},
    {R"({"size": [1,@,2]})", "found \",\", expected a value"},
    {"{\"title\": \"\\@q\"}", "may not follow a backslash"},
    {"{\"title\": \"\\u12@g4\"}", "may not follow a backslash"},
    {"{\"title\": \"a\\n@\xff\"}", "not UTF-8"},
    {"{\"title\": \"a@\tb\"}", "the control character 9 in a string, expected \"\\u0009\""},
    {"{\"title\": \"a@\n\"}", "a line ends within a string"},
    {R"({"exposure": @-})", "found \"-\", expected a value"},
    {R"({"exposure" @1})", "found \"1\", expected \":\""},
    {R"({"exposure": 1 @"tone": 2})", "found a string, expected \",\" or \"}\""},
    {R"({"size": [1 @2]})", "found \"2\", expected \",\" or \"]\""},
    {R"({@1: 2})", "found \"1\", expected a key in quotes or \"}\""},
    {R"({"title": "x", @)", "cut off"},
    {R"(@])", "found \"]\", expected a value"},
    {R"({"exposure": @tru})", "found \"tru\", expected a value"},
    {"{\"title\": \"\xc3@(\"}", "not UTF-8"},
    {R"({} @{})", "found \"{\", expected the end of the file"},
    {std::string_view("{} @\0x", 6), "text after the end"},
    {"@\xef\xbb\xbf{}", "byte order mark"},
    {"@\xff\xfe{", "byte order mark"},
    {R"({"title": "a", @"title": "b"})", "given twice"},
    {"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[@[[[[[[[[[", "nested deeper than 32"},
    // The scene.
    {"@[]", "a scene is a list of 0 values"},
    {"@7", "a scene is the number 7"},
    {R"({@"camra": {}})", "did you mean \"camera\"? known: $schema, title"},
    {R"({@"zzzzzzz": {}})", "(known: $schema, title"},
    {R"({"size": @640})", "size is the number 640, expected two whole numbers [width, height]"},
    {R"({"size": @[640]})", "a list of 1 value"},
    {R"({"size": [@0, 360]})", "width is 0, expected a whole number from 1 to 16384"},
    {R"({"size": [640, @1e9]})", "height is 1000000000"},
    {R"({"size": [640, @360.5]})", "height is 360.5, expected a whole number"},
    {R"({"tone": @"hues"})", "unknown tone \"hues\" (did you mean \"hue\"? known: clamp, divide, hue)"},
    {R"({"exposure": @0})", "exposure is 0, expected a positive number"},
    {R"({"exposure": @"1"})", "exposure is the string \"1\", expected a positive number"},
    {R"({"background": @"#12345"})", "[r, g, b] or \"#rrggbb\""},
    {R"({"background": @"#12345g"})", "[r, g, b] or \"#rrggbb\""},
    {R"({"ambient": [1, @-1, 1]})", "ambient is -1, expected a number from 0"},
    {R"({"viewer": @null})", "viewer is null"},
    // Quotes, brackets and backslashes inside strings before the fault move nothing.
    {R"({"title": "a \"b\" ]}, \\", "note": "", "tone": @3})", "tone is the number 3"},
    // The camera.
    {R"({"camera": @{"eye": [0, 0, 1]}})", "the camera has no \"target\""},
    {R"({"camera": {"eye": @[0, 0], "target": [0, 0, 0]}})",
     "eye is a list of 2 values, expected three numbers [x, y, z]"},
    {R"({"camera": {"eye": [0, 0, @"1"], "target": [0, 0, 0]}})", "eye is the string \"1\""},
    {R"({"camera": {"eye": [0, 0, @1e19], "target": [0, 0, 0]}})", "eye is 1e+19"},
    {R"({"camera": {"eye": [1, 2, 3], "target": @[1, 2, 3]}})", "target is the same point as eye"},
    {R"({"camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "up": @[0, 0, 0]}})", "up is (0, 0, 0)"},
    {R"({"camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "up": @[0, 0, -2]}})", "parallel to the view"},
    {R"({"camera": @{"eye": [0, 5, 0], "target": [0, 0, 0]}})", "parallel to the view"},
    {R"({"camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "fov": @180}})", "fov is 180, expected an angle in degrees"},
    {R"({"camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "fov": 40, "height": @2}})", "both \"fov\" and \"height\""},
    {R"({"camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "height": @-2}})", "height is -2"},
    // Materials.
    {R"({"materials": {"m": @3}})", "a material is the number 3"},
    {R"({"materials": {@"": {}}})", "empty name"},
    {R"({"materials": {"m": {"k_d": @true}}})", "k_d is true or false"},
    {R"({"materials": {"m": {"opacity": @1.5}}})", "opacity is 1.5, expected a number from 0 to 1"},
    {R"({"materials": {"m": {"lobe": @"blinn"}}})", "unknown lobe \"blinn\""},
    {R"({"materials": {"m": {"two_sided": @1}}})", "two_sided is the number 1, expected true or false"},
    {R"({"materials": {"m": {@"shinines": 1}}})", "did you mean \"shininess\""},
    // Lights.
    {R"({"lights": @{}})", "a list of lights"},
    {R"({"lights": [@{}]})", "a light has no \"type\""},
    {R"({"lights": [{"type": @"spott", "position": [0, 3, 0]}]})",
     "unknown light type \"spott\" (did you mean \"spot\"? known: directional, point, spot, rectangle, disk, sphere)"},
    {R"({"lights": [@{"type": "point"}]})", "a point light has no \"position\""},
    {R"({"lights": [{"type": "point", "position": [0, 0, 0], @"radius": 1}]})",
     "unknown key of a point light \"radius\""},
    {R"({"lights": [{"type": "directional", "direction": @[0, 0, 0]}]})", "direction is (0, 0, 0)"},
    {R"({"lights": [{"type": "directional", "direction": @[1e-60, 0, 0]}]})", "direction is (0, 0, 0)"},
    {R"({"lights": [{"type": "directional", "direction": [1, 0, 0], @"attenuation": [1, 0, 0]}]})", "unknown key"},
    {R"({"lights": [{"type": "point", "position": [0, 0, 0], "attenuation": @[0, 0, 0]}]})", "divides by zero"},
    {R"({"lights": [{"type": "point", "position": [0, 0, 0], "attenuation": [1, @-1, 0]}]})", "attenuation is -1"},
    {R"({"lights": [{"type": "point", "position": [0, 0, 0], "colour": 1, "diffuse": @1}]})",
     "both \"colour\" and \"diffuse\""},
    {R"({"lights": [{"type": "point", "position": [0, 0, 0], "intensity": @-1}]})", "intensity is -1"},
    {R"({"lights": [{"type": "spot", "position": [1, 2, 3], "target": @[1, 2, 3]}]})", "target is the same point"},
    {R"({"lights": [{"type": "spot", "position": [1, 2, 3], "target": [0, 0, 0], "direction": @[1, 0, 0]}]})", "both"},
    {R"({"lights": [@{"type": "spot", "position": [1, 2, 3]}]})", "no \"direction\""},
    {R"({"lights": [{"type": "spot", "position": [1, 2, 3], "direction": [1, 0, 0], "cutoff": @91}]})", "cutoff is 91"},
    {R"({"lights": [{"type": "spot", "position": [1, 2, 3], "direction": [1, 0, 0], "cutoff": 20, "inner": @21}]})",
     "inner is 21 degrees, cutoff 20, expected inner at most cutoff"},
    {R"({"lights": [{"type": "disk", "position": [0, 0, 0], "radius": @0}]})",
     "radius is 0, expected a positive number"},
    {R"({"lights": [{"type": "sphere", "position": [0, 0, 0], "radius": @-1}]})",
     "radius is -1, expected a positive number"},
    {R"({"lights": [{"type": "sphere", "position": [0, 0, 0], "radius": @"0"}]})", "radius is the string"},
    {R"({"lights": [@{"type": "disk", "position": [0, 0, 0]}]})", "a disk light has no \"radius\""},
    {R"({"lights": [{"type": "rectangle", "position": [0, 0, 0], "size": @2}]})", "two numbers [width, height]"},
    {R"({"lights": [{"type": "rectangle", "position": [0, 0, 0], "size": [2, @0]}]})", "height is 0"},
    {R"({"lights": [{"type": "rectangle", "position": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": @[1, 1, 0]}]})",
     "perpendicular"},
    {R"({"lights": [@{"type": "rectangle", "position": [0, 0, 0], "edge_u": [1, 0, 0]}]})", "no \"edge_v\""},
    {R"({"lights": [{"type": "rectangle", "position": [0, 0, 0], "size": [1, 1], "up": @[0, 3, 0]}]})",
     "up is parallel"},
    // Objects.
    {R"({"objects": [@{}]})", "an object has no \"type\""},
    {R"({"objects": [{"type": @"bux"}]})", "did you mean \"box\"?"},
    {R"({"objects": [{"type": "box", @"radius": 1}]})", "unknown key of a box \"radius\""},
    {R"({"objects": [{"type": "box", "casts_shadows": @0}]})", "casts_shadows is the number 0, expected true or false"},
    {R"({"objects": [{"type": "box", "receives_shadows": @"no"}]})", "receives_shadows is the string \"no\""},
    {R"({"objects": [{"type": "sphere", "seen_by_camera": @null}]})", "seen_by_camera is null"},
    {R"({"objects": [{"type": "box", @"casts_shadow": false}]})", "did you mean \"casts_shadows\"?"},
    {R"({"objects": [{"type": "box", "size": [1, @0, 1]}]})", "size is 0"},
    {R"({"objects": [{"type": "plane", "size": @[1, 2, 3]}]})", "one number or two"},
    {R"({"objects": [{"type": "plane", "divisions": @1000000000}]})",
     "divisions is 1000000000, expected a whole number from 1 to 1024"},
    {R"({"objects": [{"type": "sphere", "longitudes": @1e9}]})",
     "longitudes is 1000000000, expected a whole number from 3 to 1024"},
    {R"({"objects": [{"type": "cylinder", "segments": @2}]})", "segments is 2, expected a whole number from 3 to 4096"},
    {R"({"objects": [@{"type": "torus", "minor": 2}]})", "cuts itself"},
    {R"({"objects": [{"type": "box", "material": @"gold"}], "materials": {"golf": {}}})",
     "unknown material \"gold\" (did you mean \"golf\"?"},
    {R"({"objects": [{"type": "box", "shading": @"smooth"}]})", "known: given, flat, averaged"},
    {R"({"objects": [{"type": "box", "crease": @30}]})", "for \"shading\": \"averaged\" only"},
    {R"({"objects": [{"type": "box", "transform": @{"scale": 2}}]})", "a list of steps"},
    {R"({"objects": [{"type": "box", "transform": [@{"scale": 2, "rotate_y": 3}]}]})",
     "a step of the transform has 2 keys"},
    {R"({"objects": [{"type": "box", "transform": [@{}]}]})", "a step of the transform has 0 keys"},
    {R"({"objects": [{"type": "box", "transform": [{@"rotate_w": 2}]}]})",
     "unknown transform \"rotate_w\" (did you mean"},
    {R"({"objects": [{"type": "box", "transform": [{"scale": @0}]}]})", "flattens"},
    {R"({"objects": [{"type": "box", "transform": [{"rotate": {"axis": @[0, 0, 0], "angle": 1}}]}]})",
     "axis is (0, 0, 0)"},
    {R"({"objects": [{"type": "box", "transform": [{"matrix": [@1, 2, 3]}]}]})", "a row of the matrix"},
    {R"({"objects": [{"type": "box", "transform": [{"matrix": @[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]]}]}]})",
     "determinant is 0"},
    {R"({"objects": [{"type": "box", "transform": [{"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], @[0, 0, 1, 1]]}]}]})",
     "last row"},
    {R"({"objects": [{"type": "box", "transform": @[{"translate": [1e18, 0, 0]}, {"scale": 10}]}]})",
     "puts a vertex at"},
    {R"({"objects": [{"type": "box", "transform": [{"fit": @{}}]}]})", "fit names one of size"},
    {R"({"objects": [@{"type": "triangles", "positions": []}]})", "no \"triangles\""},
    {R"({"objects": [{"type": "triangles", "positions": [], "triangles": @[]}]})", "list of triangles is empty"},
    {R"({"objects": [{"type": "triangles", "positions": [[0, 0, 0]], "triangles": [[0, 0, @1]]}]})",
     "names position 1 (there are 1, counted from 0)"},
    {R"({"objects": [{"type": "triangles", "positions": [[0, 0, 0]], "triangles": [[0, @-1, 0]]}]})",
     "names position -1"},
    {R"({"objects": [{"type": "triangles", "positions": [[0, 0, 0]], "triangles": [@[0, 0]]}]})", "three indices"},
    {R"({"objects": [{"type": "triangles", "positions": [[0, 0, 0]], "normals": @[], "triangles": [[0, 0, 0]]}]})",
     "0 normals for 1 positions"},
    {R"({"objects": [@{"type": "mesh"}]})", "a mesh has no \"file\""},
    {R"({"objects": [{"type": "mesh", "file": @"nowhere.obj"}]})", "no such file"},
    {R"({"objects": [{"type": "mesh", "file": @"scenes/real/bunny.off"}]})", "run `./umbra setup`"},
    {R"({"objects": [{"type": "mesh", "file": @"scene.json"}]})", "unknown ending \".json\" (known: .obj"},
    {R"({"objects": [{"type": "mesh", "file": @""}]})", "no ending"},
};

TEST(NativeScene, FaultsAreToldWithTheirPlace) {
    for (const auto& [marked, expected] : kFaults) {
        const std::size_t at    = marked.find('@');
        const std::string text  = std::string(marked.substr(0, at)) + std::string(marked.substr(at + 1));
        const auto before       = marked.substr(0, at);
        const auto line         = 1 + std::count(before.begin(), before.end(), '\n');
        const std::size_t start = before.rfind('\n') + 1;
        const auto column       = 1 + std::count_if(before.begin() + std::ptrdiff_t(start), before.end(),
                                                    [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
        try {
            (void)load(text);
            ADD_FAILURE() << "loaded: " << text;
        } catch (const InputError& e) {
            const std::string message = e.what();
            EXPECT_NE(message.find(expected), std::string::npos) << text << "\n"
                                                                 << message << "\nshould say: " << expected;
            EXPECT_NE(message.find(fmt::format("scene.json:{}:{}: ", line, column)), std::string::npos)
                << message << "\nshould point to " << line << ":" << column;
        }
    }
}

TEST(NativeScene, MessagesShowTheLineAndACaret) {
    const TemporaryFolder folder;
    const auto file =
        folder.write("court.json", "{\n  \"title\": \"Höhe\",\n  \"note\": \"ä\", \"tone\": \"soft\"\n}\n");
    try {
        (void)load_scene(file);
        FAIL();
    } catch (const InputError& e) {
        EXPECT_EQ(std::string(e.what()), file.string() +
                                             ":3:24: unknown tone \"soft\" (known: clamp, divide, hue)\n"
                                             "  3 |   \"note\": \"ä\", \"tone\": \"soft\"\n"
                                             "    |                        ^");
    }
}

TEST(NativeScene, ALongLineIsShownInPart) {
    const std::string text = "{\"note\": \"" + std::string(1 << 20, 'x') + "\", \"tone\": 3}";
    try {
        (void)load(text);
        FAIL();
    } catch (const InputError& e) {
        EXPECT_LT(std::string(e.what()).size(), 600u);
        EXPECT_NE(std::string(e.what()).find("\"tone\": 3"), std::string::npos);
    }
}

// Two spheres, a box, lights of three kinds: short, so that a mutation hits something that matters.
constexpr std::string_view kGood = R"({
  "title": "t", "shows": "s", "size": [64, 36],
  "camera": {"eye": [1, 2, 8], "target": [0, 0.5, 0], "up": [0, 1, 0], "fov": 40},
  "ambient": 0.2, "background": "#102030", "tone": "hue", "exposure": 1.5,
  "materials": {"m": {"k_a": 0.2, "k_d": [0.5, 0.6, 0.7], "k_s": 0.1, "shininess": 20, "lobe": "phong", "two_sided": true}},
  "lights": [
    {"name": "a", "type": "spot", "position": [0, 4, 0], "target": [0, 0, 0], "cutoff": 30, "falloff": "smooth", "inner": 10},
    {"name": "b", "type": "rectangle", "position": [0, 4, 0], "direction": [0, -1, 0], "size": [1, 2], "attenuation": [1, 0.5, 0]}
  ],
  "objects": [
    {"type": "sphere", "radius": 1.5, "longitudes": 8, "latitudes": 6, "material": "m", "transform": [{"scale": [1, 2, 1]}, {"rotate_y": 30}]},
    {"type": "triangles", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]], "transform": [{"fit": 2}]},
    {"type": "cylinder", "segments": 5, "shading": "averaged", "crease": 40, "transform": [{"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]}]}
  ]
}
)";

TEST(NativeScene, EveryTruncationIsRefused) {
    const TemporaryFolder folder;
    EXPECT_NO_THROW((void)load(folder, kGood));
    for (std::size_t n = 0; n + 2 < kGood.size(); ++n)
        EXPECT_THROW((void)load(folder, kGood.substr(0, n)), InputError) << "cut after " << n << " bytes";
}

TEST(NativeScene, MutantsLoadOrAreRefused) {
    constexpr std::string_view bytes   = "{}[]\",:0123456789eE+-.\\/truefalsnl \n\t\0\x01\x7f\x80\xc3\xff";
    constexpr std::string_view words[] = {"1e18",        "-1e18",      "1e-300", "-0", "1e999", "99999999999999999999",
                                          "null",        "true",       "\"\"",   "[]", "{}",    "[[[[[[[[",
                                          "0.1",         "-1",         "1024",   "3",  "0.5",   "17",
                                          "\"\\u0000\"", "\"#ffffff\""};
    std::mt19937 random(20240229);
    const auto below = [&](std::size_t n) { return std::size_t(random() % n); };
    const TemporaryFolder folder;
    int loaded = 0, refused = 0;
    for (int i = 0; i < 6000; ++i) {
        std::string text(kGood);
        for (std::size_t k = 1 + below(2); k > 0; --k) {
            const std::size_t at = below(text.size());
            switch (below(10)) {
                case 0: text[at] = bytes[below(bytes.size())]; break;
                case 1: text.insert(at, 1, bytes[below(bytes.size())]); break;
                case 2: text.erase(at, 1 + below(12)); break;
                case 3: text.insert(at, text.substr(below(text.size()), 1 + below(40))); break;
                case 4: text.insert(at, words[below(std::size(words))]); break;
                default: {  // a number becomes something else
                    const std::size_t from = text.find_first_of("0123456789", at);
                    if (from == std::string::npos) break;
                    const std::size_t to = std::min(text.find_first_not_of("0123456789.", from), text.size());
                    text.replace(from, to - from, words[below(std::size(words))]);
                }
            }
        }
        try {
            const Scene s = load(folder, text);
            ++loaded;
            for (const vec3 p : s.positions)
                ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << text;
        } catch (const InputError& e) {
            ++refused;
            ASSERT_NE(std::string(e.what()).find("scene.json:"), std::string::npos) << e.what();
        }
    }
    EXPECT_GT(loaded, 500);
    EXPECT_GT(refused, 2000);
}

}  // namespace
}  // namespace umbra
