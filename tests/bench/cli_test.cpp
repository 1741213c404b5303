// The program as people and scripts see it: exit codes, messages, JSON.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "umbra/shadows/method.h"
#include "umbra/tests/support/json_schema.h"
#include "umbra/tests/support/program.h"
#include "umbra/tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

using Answer   = umbra::ProgramAnswer;
const auto run = umbra::run_program;

Answer umbra(const std::string& arguments) { return run(std::string(UMBRA_PROGRAM) + " " + arguments); }

const std::string kScene = std::string(UMBRA_SOURCE) + "/scenes/sun_on_plane.json";

class Cli : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("umbra-cli-" + std::to_string(::getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string file(const char* name) const { return (folder_ / name).string(); }

    fs::path folder_;
};

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Standard error alone.
std::string errors_of(const std::string& arguments) {
    std::string command = "(";
    command += UMBRA_PROGRAM;
    return run(command + " " + arguments + " 2>&1 >/dev/null)").output;
}

TEST_F(Cli, UsageErrorsEndWithSixtyFour) {
    const std::string render  = "render " + kScene;
    const std::string compare = "compare " + kScene + " -o " + file("out");
    const std::string diff    = "diff a.png b.png ";
    for (const std::string& arguments :
         std::vector<std::string>{"",
                                  "paint",
                                  "render",
                                  render,
                                  render + " --method crayon -o " + file("a.png"),
                                  render + " --method ray_traced:samples=0 -o " + file("a.png"),
                                  render + " --method ray_traced:samples -o " + file("a.png"),
                                  render + " --size 0x0 -o " + file("a.png"),
                                  render + " -o " + file("a.tiff"),
                                  "--threads 0 list",
                                  "inspect --nonsense x",
                                  "inspect no_such_scene",
                                  "list no_such_thing",
                                  "ladder no_such_ladder -o " + file("out"),
                                  "compare -o " + file("out"),
                                  compare + " --methods crayon",
                                  compare + " --reference crayon",
                                  compare + " --reference-points 0",
                                  compare + " --reference-points many",
                                  compare + " --pixel-samples 0",
                                  compare + " --pixel-samples 5",
                                  compare + " --pixel-samples=-4",
                                  compare + " --pixel-samples x",
                                  compare + " --pixel-samples ''",
                                  compare + " --size ''",
                                  compare + " --reference ''",
                                  render + " --pixel-samples 2 -o " + file("a.png"),
                                  "whitted umbra_penumbra --pixel-samples 100 -o " + file("a"),
                                  "growth --over pixels --max nan -o " + file("a"),
                                  "growth --over pixels --max '' -o " + file("a"),
                                  "sweep umbra_penumbra --list=-1 -o " + file("a"),
                                  "sweep umbra_penumbra --pack '' -o " + file("a"),
                                  "why umbra_penumbra '' 3",
                                  "recommend umbra_penumbra --max rmse=0.1 --seconds nan",
                                  "recommend umbra_penumbra --max rmse=0.1 --seconds=-1",
                                  "completion fish",
                                  diff + "--fail -1",
                                  diff + "--fail nan",
                                  diff + "--fail-percent 200",
                                  diff + "--fail-percent -1",
                                  diff + "--fail-flip 2",
                                  diff + "--fail-ssim 3",
                                  diff + "--fail-psnr inf",
                                  diff + "--fail-rmse x",
                                  diff + "--warn -1",
                                  diff + "-o map.bmp",
                                  diff + "--embed",
                                  diff + "--tolerance x.json --fail 1",
                                  "diff " + file("") + " " + kScene,
                                  "accept moon"}) {
        const Answer answer = umbra(arguments);
        EXPECT_EQ(answer.exit_code, 64) << arguments << "\n" << answer.output;
        EXPECT_EQ(answer.output.find("umbra: "), 0u) << answer.output;
        EXPECT_LT(answer.output.size(), 1500u) << answer.output;
    }
    EXPECT_TRUE(contains(umbra(render + " --method crayon -o " + file("a.png")).output, "shadow_zbuffer"));
    const std::string points = umbra(compare + " --reference-points 0").output;
    EXPECT_LT(points.size(), 160u) << points;
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Cli, SweepAndRecommendAnswerWithTheirExitCodes) {
    const std::string out   = " --size 48x27 --views 2 -o " + (folder_ / "out").string();
    const std::string sweep = "sweep umbra_penumbra --methods 'ray_traced:samples=1|4' --no-times" + out;
    const Answer swept      = umbra(sweep);
    EXPECT_EQ(swept.exit_code, 0) << swept.output;
    EXPECT_NE(swept.output.find("4 cells, 4 of them computed now"), std::string::npos) << swept.output;
    EXPECT_NE(umbra(sweep).output.find("4 cells, 0 of them computed now"), std::string::npos);
    const std::string recommend = "recommend umbra_penumbra --held-out 0 --methods ray_traced:samples=4" + out;
    EXPECT_EQ(umbra(recommend + " --max rmse=0.9").exit_code, 0);
    EXPECT_EQ(umbra(recommend + " --max rmse=0").exit_code, 1);
    EXPECT_EQ(umbra(recommend).exit_code, 64);
    EXPECT_EQ(umbra(recommend + " --max psnr=1").exit_code, 64);
    EXPECT_EQ(umbra("sweep umbra_penumbra --pack 3/2" + out).exit_code, 64);
    const Answer merged = umbra("sweep --merge " + (folder_ / "none").string() + " -o " + (folder_ / "m").string());
    EXPECT_EQ(merged.exit_code, 4);
    EXPECT_NE(merged.output.find("holds no plan.json"), std::string::npos) << merged.output;
}

/// A scene without any is not served; one with some gets the picture.
TEST_F(Cli, FormulaNeedsASphereOrABox) {
    const std::string out = " --formula --no-shadows --pixel-samples 1 --size 32x18 -o " + file("out");
    const Answer none     = umbra("whitted open_mesh" + out);
    EXPECT_EQ(none.exit_code, 1) << none.output;
    EXPECT_TRUE(contains(none.output, "no mesh of it is a sphere or a box")) << none.output;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    const Answer some = umbra("whitted sun_on_plane" + out);
    EXPECT_EQ(some.exit_code, 0) << some.output;
    EXPECT_TRUE(contains(some.output, "spheres: 1, boxes: 1")) << some.output;
    EXPECT_TRUE(fs::exists(folder_ / "out/formula.png"));
}

TEST_F(Cli, MistypedNamesGetSuggestions) {
    EXPECT_TRUE(contains(umbra("compar x").output, "unknown command \"compar\"; did you mean compare?"));
    EXPECT_TRUE(contains(umbra("--threads 2 --quiet redner").output, "did you mean render?"));
    EXPECT_TRUE(contains(umbra("inspect sun_on_plan").output, "did you mean sun_on_plane?"));
    EXPECT_TRUE(contains(umbra("ladder far_from_orign -o " + file("out")).output, "did you mean far_from_origin?"));
    EXPECT_TRUE(contains(umbra("list shadow_zbufer").output, "did you mean shadow_zbuffer?"));
    EXPECT_TRUE(contains(umbra("compare sun_on_plane --metods exact -o out").output, "did you mean --methods?"));
}

TEST_F(Cli, CanonicalNamesAreScenes) {
    const std::string by_file = umbra("inspect --json " + kScene).output;
    EXPECT_EQ(umbra("inspect --json sun_on_plane").output, by_file);
    EXPECT_EQ(umbra("render sun_on_plane --size 32x18 -o " + file("a.png")).exit_code, 0);
    // Those that the report leaves out have names, too.
    EXPECT_EQ(umbra("render mirror_and_glass --quiet --size 32x18 -o " + file("a.png")).exit_code, 0);
    // A file of that name comes first.
    EXPECT_EQ(
        run("cd " + folder_.string() + " && echo nothing > sun_on_plane && " + UMBRA_PROGRAM + " inspect sun_on_plane")
            .exit_code,
        4);
}

TEST_F(Cli, ListsOfMethodsLeaveTheScene) {
    const std::string options = " --size 32x18 --quiet -o " + file("out");
    EXPECT_EQ(umbra("compare --methods planar_projection shadow_volumes sun_on_plane" + options).exit_code, 0);
    EXPECT_TRUE(fs::exists(file("out/sun_on_plane/shadow_volumes.png")));
    EXPECT_EQ(umbra("compare --methods shadow_volumes " + kScene + options).exit_code, 0);
    EXPECT_EQ(umbra("ladder --methods planar_projection far_from_origin -o " + file("ladders")).exit_code, 0);
    const std::string missing = umbra("compare --methods exact" + options).output;
    EXPECT_TRUE(contains(missing, "SCENE is required")) << missing;
}

TEST_F(Cli, WarningsGoToStandardErrorWithTheScene) {
    std::ofstream(file("away.json")) << R"({
        "camera": {"eye": [0, 1, 0], "target": [0, 2, 0.1]},
        "lights": [{"name": "lamp", "type": "point", "position": [0, 4, 0]}],
        "objects": [{"name": "floor", "type": "plane", "size": [8, 8]}]
    })";
    std::ofstream(file("bare.obj")) << "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::string nothing = "warning: away: the camera sees nothing: no primary ray meets a surface\n";
    const std::string size    = " --size 32x18 ";
    EXPECT_EQ(errors_of("render " + file("away.json") + size + "-o " + file("a.png")), nothing);
    EXPECT_EQ(errors_of("compare " + file("away.json") + size + "--methods ray_traced -o " + file("out")), nothing);
    std::ifstream in(file("out/away/results.json"));
    EXPECT_TRUE(contains(nlohmann::json::parse(in)["scene"]["warnings"].dump(), "the camera sees nothing"));
    const std::string bare = errors_of("render " + file("bare.obj") + size + "-o " + file("a.png"));
    EXPECT_TRUE(contains(bare, "none.mtl")) << bare;
    std::istringstream lines(bare);
    int count = 0;
    for (std::string line; std::getline(lines, line); ++count) EXPECT_EQ(line.find("warning: bare: "), 0u) << line;
    EXPECT_GE(count, 2) << bare;  // the materials, the camera
    EXPECT_EQ(errors_of("render --quiet " + file("bare.obj") + size + "-o " + file("a.png")), "");
    EXPECT_EQ(errors_of("render " + kScene + size + "-o " + file("a.png")), "");
}

/// A sheet over a floor; `terms` are those of the sheet's material, with a comma before each.
std::string sheet_scene(const std::string& terms) {
    return R"({"camera": {"eye": [0, 3, 6], "target": [0, 0, 0]},
        "lights": [{"name": "lamp", "type": "point", "position": [0, 4, 0]}],
        "materials": {"grey": {}, "foil": {"k_d": 0.5)" +
           terms + R"(}},
        "objects": [{"name": "floor", "type": "plane", "size": [8, 8], "material": "grey"},
                    {"name": "sheet", "type": "plane", "size": [2, 2], "material": "foil",
                     "transform": [{"translate": [0, 1, 0]}]}]})";
}

std::string gltf_scene(const std::string& material) {
    return R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "materials": [)" +
           material + "]}";
}

TEST_F(Cli, WhatAMaterialAsksForAndNothingComputesIsNamedByInspect) {
    const std::string nff_before =
        "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 0.1\nresolution 32 32\nl 2 3 4\nf 1 0 0 ";
    const std::string nff_after = "\np 3\n-1 -1 0\n1 -1 0\n0 1 0\n";
    const std::string obj       = "mtllib a.mtl\nusemtl foil\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    struct Asks {
        const char* file;
        std::string text;
        std::vector<std::string> terms;
        std::string mtl{};
    };
    const std::vector<Asks> all = {
        {"a.json", sheet_scene(""), {}},
        {"a.json", sheet_scene(R"(, "opacity": 0)"), {"opacity"}},
        {"a.json", sheet_scene(R"(, "transmit": 0.5)"), {"transmit"}},
        {"a.json", sheet_scene(R"(, "reflect": 0.5)"), {"reflect"}},
        {"a.json", sheet_scene(R"(, "index_of_refraction": 1.5)"), {"index_of_refraction"}},
        {"a.nff", nff_before + "0.8 0 10 0 0" + nff_after, {}},
        {"a.nff", nff_before + "0.8 0.2 10 0 0" + nff_after, {"reflect"}},
        {"a.nff", nff_before + "0.8 0 10 0.5 1.5" + nff_after, {"transmit", "index_of_refraction"}},
        {"a.obj", obj, {}, "newmtl foil\nd 1\nNi 1\nillum 2\n"},
        {"a.obj", obj, {"opacity"}, "newmtl foil\nd 0.5\n"},
        {"a.obj", obj, {"opacity"}, "newmtl foil\nTr 0.5\n"},
        {"a.obj", obj, {"index_of_refraction"}, "newmtl foil\nNi 1.5\n"},
        {"a.obj", obj, {"reflect"}, "newmtl foil\nKs 1 1 1\nillum 3\n"},
        {"a.obj", obj, {"opacity", "transmit"}, "newmtl foil\nd 0.5\nillum 4\n"},
        {"a.gltf", gltf_scene(R"({"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}})"), {}},
        {"a.gltf",
         gltf_scene(R"({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}})"),
         {"opacity"}},
        {"a.gltf",
         gltf_scene(R"({"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}})"),
         {}},
        {"a.gltf",
         gltf_scene(
             R"({"alphaMode": "MASK", "alphaCutoff": 0.1, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}})"),
         {}},
        {"a.gltf",
         gltf_scene(R"({"extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.9}}})"),
         {"transmit", "index_of_refraction"}},
        {"a.gltf", gltf_scene(R"({"extensions": {"KHR_materials_ior": {"ior": 1.3}}})"), {"index_of_refraction"}},
    };
    for (const Asks& asks : all) {
        std::ofstream(file(asks.file)) << asks.text;
        std::ofstream(file("a.mtl")) << asks.mtl;
        const Answer answer = umbra("inspect --json " + file(asks.file));
        ASSERT_EQ(answer.exit_code, 0) << answer.output;
        const auto record = nlohmann::json::parse(answer.output);
        std::vector<std::string> terms;
        for (const auto& term : record["facts"]["not_computed"]) {
            terms.push_back(term["term"]);
            EXPECT_EQ(term["materials"].size(), 1u);
        }
        EXPECT_EQ(terms, asks.terms) << asks.text << asks.mtl;
        for (const std::string& term : asks.terms)
            EXPECT_TRUE(contains(record["scene"]["warnings"].dump(), "The " + term + " of material ")) << term;
        if (asks.terms.empty()) {
            EXPECT_FALSE(contains(answer.output, "not computed:"));
        }
        for (const auto& method : record["methods"]) {
            const std::string how = method["serves"]["how"], why = method["serves"]["why"];
            EXPECT_FALSE(contains(why, "is not computed")) << method["name"] << ": " << why;
            if (method["name"] == "exact") {
                EXPECT_EQ(how, "exactly");
            }
        }
    }
}

TEST_F(Cli, ATransparentSheetIsNamedWhereverItIsDrawn) {
    std::ofstream(file("sheet.json")) << sheet_scene(R"(, "opacity": 0)");
    const std::string size = " --size 48x32 ";
    const std::string says =
        "The opacity of material \"foil\" is not computed: surfaces are drawn opaque. They throw no shadow "
        "(transparent_occluders: ignore).";
    EXPECT_TRUE(contains(umbra("inspect " + file("sheet.json")).output, "warning: " + says));
    EXPECT_EQ(errors_of("render " + file("sheet.json") + size + "-o " + file("a.png")),
              "warning: sheet: " + says + "\n");
    EXPECT_EQ(errors_of("compare " + file("sheet.json") + size + "--methods shadow_volumes -o " + file("out")),
              "warning: sheet: " + says + "\n");
    std::ifstream in(file("out/sheet/results.json"));
    const auto record = nlohmann::json::parse(in);
    EXPECT_EQ(record["scene"]["warnings"], nlohmann::json::array({says}));
    EXPECT_EQ(record["facts"]["not_computed"][0]["term"], "opacity");
    EXPECT_TRUE(record["reference"]["exact"]);
    for (const auto& method : record["methods"]) EXPECT_EQ(method["serves"]["how"], "to_rounding");
    std::ifstream page(file("out/sheet/index.html"));
    std::stringstream html;
    html << page.rdbuf();
    EXPECT_TRUE(contains(html.str(), "is not computed: surfaces are drawn opaque"));
}

TEST_F(Cli, LightsThatAddNothingAndCamerasThatSeeNothingAreWarnedOf) {
    const auto scene = [](const std::string& light, const std::string& eye = "[0, 3, 6]") {
        return R"({"camera": {"eye": )" + eye + R"(, "target": [0, 0, 0]},
            "lights": [{"name": "main", "type": "point", "position": [0, 4, 0]}, )" +
               light + R"(], "objects": [{"name": "floor", "type": "plane", "size": [8, 8]}]})";
    };
    const std::string in_vain                         = "Light \"extra\" adds nothing to this picture";
    const std::pair<std::string, std::string> cases[] = {
        {R"({"name": "extra", "type": "point", "position": [1, 4, 0]})", ""},
        {R"({"name": "extra", "type": "spot", "position": [1, 4, 0], "direction": [0, -1, 0.1]})", ""},
        {R"({"name": "extra", "type": "point", "position": [1, 4, 0], "intensity": 0})",
         "Light \"extra\" has intensity 0: it adds nothing"},
        {R"({"name": "extra", "type": "spot", "position": [1, 4, 0], "direction": [0, 1, 0.1]})", in_vain},
        {R"({"name": "extra", "type": "point", "position": [1, 4, 0], "range": 2})", in_vain},
        {R"({"name": "extra", "type": "disk", "position": [0, -1, 0], "direction": [0, 1, 0], "radius": 0.1})",
         in_vain},
    };
    const std::string size = " --size 48x32 ";
    for (const auto& [light, warning] : cases) {
        std::ofstream(file("a.json")) << scene(light);
        for (const std::string& command : {std::string("inspect "), "render -o " + file("a.png") + size,
                                           "compare --methods shadow_volumes -o " + file("out") + size}) {
            const std::string output = umbra(command + file("a.json")).output;
            EXPECT_EQ(contains(output, "warning: "), !warning.empty()) << command << light << output;
            EXPECT_TRUE(contains(output, warning)) << command << light << output;
        }
    }
    // The eye looks up.
    std::ofstream(file("a.json")) << R"({"camera": {"eye": [0, 1, 0], "target": [0, 2, 0.1]},
        "lights": [{"name": "main", "type": "point", "position": [0, 4, 0]}],
        "objects": [{"name": "floor", "type": "plane", "size": [8, 8]}]})";
    EXPECT_TRUE(contains(umbra("inspect " + file("a.json")).output, "warning: the camera sees nothing"));
    EXPECT_TRUE(contains(umbra("inspect --json " + file("a.json")).output, "the camera sees nothing"));
}

TEST_F(Cli, UnreadableInputEndsWithFourAndLeavesNothing) {
    std::ofstream(file("broken.json")) << "{\n  \"lights\": [ { \"type\": \"spott\" } ]\n}\n";
    const Answer answer = umbra("render " + file("broken.json") + " -o " + file("a.png"));
    EXPECT_EQ(answer.exit_code, 4);
    EXPECT_NE(answer.output.find("broken.json:2"), std::string::npos) << answer.output;
    EXPECT_NE(answer.output.find("spot"), std::string::npos) << answer.output;
    EXPECT_FALSE(fs::exists(file("a.png")));
    EXPECT_EQ(umbra("inspect " + file("nowhere.obj")).exit_code, 4);
    EXPECT_EQ(umbra("compare " + file("broken.json") + " -o " + file("out")).exit_code, 4);
    EXPECT_EQ(umbra("render " + kScene + " --size 32x18 -o /nonexistent/folder/a.png").exit_code, 4);
}

TEST_F(Cli, RenderEndsWithOneWhereTheMethodDoesNotServe) {
    std::ofstream(file("ball.json")) << R"({"camera": {"eye": [0, 1, 5], "target": [0, 0, 0]},
        "lights": [{"name": "lamp", "type": "point", "position": [0, 4, 3]}],
        "objects": [{"name": "ball", "type": "sphere"}]})";
    const Answer answer =
        umbra("render " + file("ball.json") + " --size 32x18 --method planar_projection -o " + file("a.png"));
    EXPECT_EQ(answer.exit_code, 1);
    EXPECT_TRUE(contains(answer.output, "does not serve this scene")) << answer.output;
    EXPECT_FALSE(fs::exists(file("a.png")));
}

TEST_F(Cli, AMeshThatIsMissingEndsWithFourAndTheOtherScenesAreThere) {
    std::ofstream(file("gone.json")) << R"({"objects": [{"name": "x", "type": "mesh", "file": "gone.obj"}]})";
    const Answer answer =
        umbra("compare " + file("gone.json") + " " + kScene + " --size 32x18 --methods exact -o " + file("out"));
    EXPECT_EQ(answer.exit_code, 4) << answer.output;
    EXPECT_TRUE(contains(answer.output, "gone.obj")) << answer.output;
    EXPECT_TRUE(fs::exists(file("out/sun_on_plane/results.json")));
}

/// Names in the table of commands.
std::vector<std::string> command_names() {
    std::vector<std::string> names;
    std::ifstream in(std::string(UMBRA_SOURCE) + "/bench/cli/commands.def");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("COMMAND(")) names.push_back(line.substr(8, line.find(',') - 8));
    return names;
}

TEST_F(Cli, HelpAndVersionAreThereEverywhere) {
    ASSERT_GE(command_names().size(), 10u);
    const Answer all = umbra("--help");
    EXPECT_EQ(all.exit_code, 0);
    EXPECT_TRUE(contains(all.output, "./umbra"));
    EXPECT_TRUE(contains(all.output, "64 wrong usage"));
    for (const std::string& command : command_names()) {
        EXPECT_TRUE(contains(all.output, "\n  " + command + " ")) << command;
        const Answer answer = umbra(command + " --help");
        EXPECT_EQ(answer.exit_code, 0) << command;
        EXPECT_GT(answer.output.size(), 80u) << command;
        EXPECT_FALSE(contains(answer.output, "./umbra")) << answer.output;
    }
    EXPECT_EQ(umbra("--version").exit_code, 0);
}

// OpenImageIO and the 250 libraries that it brings take 0.4 s: only commands that need image files load them.
TEST_F(Cli, StartsWithoutTheLibrariesOfImageFiles) {
    const Answer libraries = run("LD_TRACE_LOADED_OBJECTS=1 " + std::string(UMBRA_PROGRAM));
    EXPECT_NE(libraries.output.find("libembree"), std::string::npos) << libraries.output;
    EXPECT_EQ(libraries.output.find("OpenImageIO"), std::string::npos) << libraries.output;
}

TEST_F(Cli, ScriptPrintsHelpOnAFreshCloneWithoutSettingUp) {
    fs::create_directories(folder_ / "bench/cli");
    fs::copy(std::string(UMBRA_SOURCE) + "/umbra", folder_ / "umbra");
    fs::copy(std::string(UMBRA_SOURCE) + "/bench/cli/commands.def", folder_ / "bench/cli/commands.def");
    for (const char* arguments : {"", " --help", " -h", " help"}) {
        const Answer answer = run(file("umbra") + arguments);
        EXPECT_EQ(answer.exit_code, 0) << answer.output;
        for (const std::string& command : command_names())
            EXPECT_TRUE(contains(answer.output, "\n  " + command + " ")) << command << "\n" << answer.output;
        for (const char* command : {"setup", "test", "bench", "faults", "check"})
            EXPECT_TRUE(contains(answer.output, std::string("\n  ") + command + " ")) << command;
    }
    EXPECT_FALSE(fs::exists(folder_ / ".build"));
}

TEST_F(Cli, ListNamesEveryMethodWithItsParameters) {
    const nlohmann::json record = nlohmann::json::parse(umbra("list --json").output);
    std::vector<std::string> names, expected, scenes;
    for (const auto& m : record["methods"]) {
        names.push_back(m["name"]);
        EXPECT_FALSE(m["paper"].get<std::string>().empty());
        for (const auto& p : m["parameters"]) EXPECT_FALSE(p["doc"].get<std::string>().empty()) << p;
    }
    for (const umbra::MethodInfo* info : umbra::methods()) expected.emplace_back(info->name);
    EXPECT_EQ(names, expected);
    std::ifstream canonical(std::string(UMBRA_SCENES) + "/canonical.txt");
    for (std::string line; std::getline(canonical, line);)
        if (!line.empty() && line[0] != '#') scenes.push_back(line.substr(0, line.find('.')));
    EXPECT_EQ(record["scenes"].get<std::vector<std::string>>(), scenes);
}

// The schema that is printed fits what the command writes, and another record's does not.
TEST_F(Cli, ListPrintsTheSchemasOfRecords) {
    ASSERT_EQ(umbra("compare " + kScene + " --size 16x9 --methods ray_traced -o " + file("schemas")).exit_code, 0);
    std::ifstream in(file("schemas/results.json"));
    const std::string compared{std::istreambuf_iterator<char>(in), {}};
    EXPECT_TRUE(umbra::fits(umbra("list --schema results").output, compared));
    for (const char* other : {"ladders", "motion", "growth", "sweep", "recommend"})
        EXPECT_FALSE(umbra::fits(umbra(fmt::format("list --schema {}", other)).output, compared)) << other;
    EXPECT_EQ(umbra("list --schema colours").exit_code, 64);
    const std::string out = " --size 16x9 -o " + file("studies");
    for (const auto& [study, more] : std::map<std::string, std::string>{
             {"bias", out}, {"brdf", ""}, {"radiosity", out}, {"shading", out}, {"whitted", out}}) {
        const Answer printed = umbra(study + " " + kScene + more + " --json");
        EXPECT_TRUE(umbra::fits(umbra("list --schema " + study).output, printed.output)) << study;
        if (study == "bias") {
            EXPECT_EQ(umbra("report " + file("studies")).exit_code, 4) << "its page stays";
        }
        EXPECT_FALSE(umbra::fits(umbra("list --schema truth").output, printed.output)) << study;
    }
    ASSERT_EQ(umbra("truth " + kScene + " --size 16x9 -o " + file("truth")).exit_code, 0);
    std::ifstream truth(file("truth/results.json"));
    EXPECT_TRUE(umbra::fits(umbra("list --schema truth").output, {std::istreambuf_iterator<char>(truth), {}}));
}

TEST_F(Cli, ListShowsOneEntryInFull) {
    const Answer method = umbra("list shadow_zbuffer");
    EXPECT_EQ(method.exit_code, 0);
    EXPECT_TRUE(contains(method.output, "resolution=")) << method.output;
    EXPECT_FALSE(contains(method.output, "planar_projection"));
    const Answer ladder = umbra("list far_from_origin");
    EXPECT_TRUE(contains(ladder.output, "rungs: 1, ")) << ladder.output;
    const Answer scene = umbra("list sun_on_plane");
    EXPECT_TRUE(contains(scene.output, "A light at infinity over one plane")) << scene.output;
    EXPECT_EQ(nlohmann::json::parse(umbra("list exact --json").output)["method"]["name"], "exact");
}

/// What the Bash completion offers for a line that ends at the cursor, sorted by it.
std::string completed(const std::string& script, const std::string& line) {
    return run("bash -c 'source " + script + R"(; COMP_WORDBREAKS=" =:"; COMP_LINE=$1; COMP_POINT=${#1}; _umbra; )" +
               R"(printf "%s\n" "${COMPREPLY[@]}"' - ')" + line + "'")
        .output;
}

/// From the gate to a row of a table, in a folder of its own; and what else the two commands refuse.
TEST_F(Cli, ProgramsFromOutsideAreCheckedAndThenNamed) {
    const auto here = [&](const std::string& arguments) {
        return run("cd " + folder_.string() + " && " + UMBRA_PROGRAM + " " + arguments);
    };
    const std::string planted = UMBRA_PLANTED_CONTENDER;
    const Answer wrong        = here("contender check --save mine -- " + planted + " exchanged");
    EXPECT_EQ(wrong.exit_code, 1) << wrong.output;
    EXPECT_TRUE(contains(wrong.output, "0 and 1 are exchanged")) << wrong.output;
    EXPECT_FALSE(fs::exists(file("contenders/mine.json")));
    EXPECT_EQ(here("compare " + kScene + " --methods mine -o out").exit_code, 64) << "it has not passed";
    EXPECT_EQ(here("contender check --save exact -- " + planted + " none").exit_code, 64) << "the name is taken";
    EXPECT_EQ(here("contender check").exit_code, 64);
    EXPECT_EQ(here("contender check -- /no/such/program").exit_code, 5);
    EXPECT_EQ(here("contender show " + kScene).exit_code, 64) << "no folder";
    const Answer right = here("contender check --json --save mine -- " + planted + " none");
    EXPECT_EQ(right.exit_code, 0) << right.output;
    EXPECT_EQ(nlohmann::json::parse(right.output)["passed"], true);
    EXPECT_EQ(nlohmann::json::parse(right.output)["rows"].size(), 6u);
    EXPECT_TRUE(contains(here("list mine").output, "Planted 1"));
    const Answer with = here("report out --with mine 2>&1");
    EXPECT_EQ(with.exit_code, 64);
    EXPECT_TRUE(contains(with.output, "expected no DIR")) << "the name is known: " << with.output;
    const std::string small =
        std::string(UMBRA_SOURCE) + "/scenes/light_inside_view.json --size 32x18 --pixel-samples 1";
    const Answer compared = here("compare " + small + " --methods mine ray_traced --json -o out");
    ASSERT_EQ(compared.exit_code, 0) << compared.output;
    const auto record = nlohmann::json::parse(compared.output);
    EXPECT_EQ(record["methods"][0]["outside"], "program");
    EXPECT_EQ(record["methods"][0]["errors"][0]["rmse"], 0);
    EXPECT_EQ(record["methods"][0]["own_times"]["build_ms"], 2.5);
    std::ifstream in(file("out/light_inside_view/index.html"));
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    EXPECT_TRUE(contains(page,
                         "By its own clock: <em>build</em> 2.50 ms, <em>aim</em> 2.50 ms, <em>look</em> 2.50 ms, "
                         "<em>visibility</em> 2.50 ms"));
    std::ofstream(file("contenders/mine.json")) << "{}";
    const Answer broken = here("list methods");
    EXPECT_TRUE(contains(broken.output, "\"command\" is missing")) << broken.output;
    EXPECT_EQ(here("truth -o set").exit_code, 64);
    for (const char* folders : {"-o set --withhold set", "-o set --withhold ./set/", "-o set --withhold set/in",
                                "-o set/in --withhold set"}) {
        EXPECT_EQ(here("truth " + kScene + " " + folders).exit_code, 64) << folders;
        EXPECT_FALSE(fs::exists(file("set"))) << folders;
    }
    EXPECT_EQ(here("score set a=b a=c").exit_code, 64) << "one name twice";
    EXPECT_EQ(here("score set").exit_code, 64);
    EXPECT_EQ(here("score set a=b").exit_code, 4);
    EXPECT_EQ(
        here("compare " + kScene + " " + kScene + " --answers a=" + file("contenders/mine.json") + " -o o").exit_code,
        64);
}

TEST_F(Cli, LibrariesFromOutsideAreNamedOnEachLine) {
    if (std::system("command -v gcc > /dev/null") != 0) GTEST_SKIP() << "there is no gcc";
    const std::string source = UMBRA_SOURCE;
    const auto compiled      = [&](const std::string& from, const char* to) {
        return run("gcc -std=c11 -O2 -shared -fPIC -I " + source + "/bench/contenders/include " + from + " -lm -o " +
                        file(to));
    };
    ASSERT_EQ(compiled(source + "/bench/contenders/libraries/rays.c", "rays.so").exit_code, 0);
    const std::string plugin = " --plugin " + file("rays.so");
    const Answer right       = umbra("contender check --json rays" + plugin);
    EXPECT_EQ(right.exit_code, 0) << right.output;
    EXPECT_EQ(nlohmann::json::parse(right.output)["passed"], true);
    EXPECT_EQ(umbra("contender check --save mine rays" + plugin).exit_code, 64);
    EXPECT_TRUE(contains(errors_of("contender check other" + plugin), "that of the library is \"rays\""));
    std::ofstream(file("empty.c")) << "int nothing;";
    ASSERT_EQ(compiled(file("empty.c"), "empty.so").exit_code, 0);
    EXPECT_TRUE(contains(errors_of("list --plugin " + file("empty.so")), "exports no umbra_contender()"));
    const std::string small = source + "/scenes/light_inside_view.json --size 32x18 --pixel-samples 1 --json";
    const Answer compared   = umbra("compare " + small + plugin + " --methods rays -o " + file("out"));
    ASSERT_EQ(compared.exit_code, 0) << compared.output;
    const auto method = nlohmann::json::parse(compared.output)["methods"][0];
    EXPECT_EQ(method["outside"], "library");
    EXPECT_EQ(method["errors"][0]["rmse"], 0);
    EXPECT_EQ(umbra("compare " + small + " --methods rays -o " + file("out")).exit_code, 64) << "named on no line";
    EXPECT_EQ(umbra("list --plugin " + file("none.so")).exit_code, 4);
    EXPECT_EQ(umbra("report " + file("out") + plugin + " --with rays").exit_code, 64) << "only pages are rebuilt";

    // One that breaks takes the program with it, which says whose fault that is.
    std::ofstream(file("breaks.c")) << R"(#include "umbra/contender.h"
static int answer(const umbra_question* q, size_t begin, size_t end, float* s, char* why) {
    (void)q, (void)begin, (void)end, (void)why;
    *(volatile float*)(size_t)(end - end) = 1;
    return 1;
}
const umbra_contender_info* umbra_contender(void) {
    static const umbra_contender_info info = {.version = UMBRA_CONTENDER_VERSION, .lights = UMBRA_HARD, .name = "breaks",
        .title = "Breaks", .release = "1", .visibility = answer};
    return &info;
}
)";
    ASSERT_EQ(compiled(file("breaks.c"), "breaks.so").exit_code, 0);
    const std::string broken =
        errors_of("compare " + small + " --plugin " + file("breaks.so") + " --methods breaks -o " + file("out"));
    EXPECT_TRUE(contains(broken, "a fault within the library " + file("breaks.so"))) << broken;
}

TEST_F(Cli, BashCompletes) {
    ASSERT_EQ(run(std::string(UMBRA_PROGRAM) + " completion bash > " + file("umbra.bash")).exit_code, 0);
    const std::string script = file("umbra.bash");
    EXPECT_EQ(completed(script, "umbra com"), "compare\ncompletion\n");
    EXPECT_EQ(completed(script, "./umbra --thr"), "--threads\n");
    EXPECT_EQ(completed(script, "umbra --threads 2 rend"), "render\n");
    EXPECT_EQ(completed(script, "umbra render x.json --meth"), "--method\n");
    EXPECT_EQ(completed(script, "umbra render --method shadow_z"), "shadow_zbuffer\n");
    EXPECT_EQ(completed(script, "umbra compare --methods exact shadow_v"), "shadow_volumes\n");
    EXPECT_EQ(completed(script, "umbra render sun_on"), "sun_on_plane\n");
    EXPECT_EQ(completed(script, "umbra render --size 3x3 sun_on"), "sun_on_plane\n");
    EXPECT_EQ(completed(script, "umbra ladder far_from"), "far_from_origin\n");
    EXPECT_EQ(completed(script, "umbra completion "), "bash\nzsh\n");
    // Readline replaces what follows the last : or =.
    EXPECT_EQ(completed(script, "umbra render --method shadow_zbuffer:resol"), "resolution=\n");
    EXPECT_EQ(completed(script, "umbra render --method shadow_zbuffer:bias=rec"), "receiver_plane\n");
    EXPECT_EQ(completed(script, "umbra render --method shadow_zbuffer:resolution=64,bias=man"), "manual\n");
    std::ofstream(file("picture.png")) << "file names are completed, too";
    EXPECT_EQ(completed(script, "umbra diff " + file("pict")), file("picture.png") + "\n");
    // Every command, and every option in its help.
    const std::string commands = completed(script, "umbra ");
    for (const std::string& command : command_names()) {
        EXPECT_TRUE(contains("\n" + commands, "\n" + command + "\n")) << command;
        const std::string help    = umbra(command + " --help").output,
                          options = completed(script, "umbra " + command + " --");
        for (std::size_t at = help.find("--"); at != std::string::npos; at = help.find("--", at + 2)) {
            const std::string option = help.substr(at, help.find_first_of(" ,\n", at) - at);
            EXPECT_TRUE(contains("\n" + options, "\n" + option + "\n")) << command << ' ' << option << '\n' << options;
        }
    }
}

TEST_F(Cli, ZshScriptHoldsTheSameTables) {
    const std::string bash = umbra("completion bash").output, zsh = umbra("completion zsh").output;
    EXPECT_EQ(zsh.find("#compdef umbra\n"), 0u);
    const std::string tables =
        bash.substr(bash.find("_umbra_list()"), bash.find("_umbra() {") - bash.find("_umbra_list()"));
    EXPECT_GT(tables.size(), 1000u);
    EXPECT_TRUE(contains(zsh, tables));
}

TEST_F(Cli, InspectSaysWhoServesAndWhy) {
    const Answer answer = umbra("inspect " + kScene + " --silhouettes 50 --seed 3 --json");
    ASSERT_EQ(answer.exit_code, 0) << answer.output;
    const nlohmann::json record = nlohmann::json::parse(answer.output);
    for (const auto& m : record["methods"]) EXPECT_FALSE(m["serves"]["why"].get<std::string>().empty());
    for (const auto& s : record["silhouettes"]) EXPECT_GE(s["standard_error"].get<double>(), 0);
    EXPECT_EQ(umbra("inspect " + kScene + " --silhouettes 50 --seed 3 --json").output, answer.output);
}

/// A floor under a board that casts no shadow, and under a lid that it takes none of.
TEST_F(Cli, ObjectsThatTakeNoPartAreNamed) {
    std::ofstream(file("off.json")) << R"({"camera": {"eye": [0, 3, 6], "target": [0, 0, 0]},
        "lights": [{"name": "sun", "type": "directional", "direction": [0, -1, 0]}],
        "objects": [{"name": "ground", "type": "plane", "size": 8, "receives_shadows": false},
                    {"name": "lid", "type": "plane", "transform": [{"translate": [0, 5, 0]}],
                     "casts_shadows": false, "seen_by_camera": false}]})";
    const std::string inspected = umbra("inspect " + file("off.json")).output;
    EXPECT_TRUE(contains(inspected, "planar, receives_shadows is false\n")) << inspected;
    EXPECT_TRUE(contains(inspected, "planar, casts_shadows is false, seen_by_camera is false\n")) << inspected;
    const std::string why = "why " + file("off.json") + " 24 20 --size 48x32 --methods exact";
    EXPECT_TRUE(contains(umbra(why).output, "The object receives no shadows: S is 1 for every method."));
    const auto record = nlohmann::json::parse(umbra(why + " --json").output);
    EXPECT_EQ(record["lights"][0]["unshadowed"], true);
    EXPECT_FALSE(record["lights"][0].contains("away"));
}

TEST_F(Cli, WhySaysTheTruthWhicheverMethodIsAsked) {
    const std::string box   = R"({"camera": {"eye": [0, 3, 6], "target": [0, 0, 0]}, "lights": [)";
    const std::string lower = R"(], "objects": [{"name": "ground", "type": "plane", "size": 8},
        {"name": "lid", "type": "plane", "transform": [{"translate": [0, 1, 0]}], "seen_by_camera": false}]})";
    std::ofstream(file("lamp.json")) << box << R"({"name": "lamp", "type": "point", "position": [0, 4, 0]})" << lower;
    const std::string why = "why " + file("lamp.json") + " 27 15 --size 49x33 --methods planar_projection";
    const std::string said =
        "  the truth                Triangle 3 of lid is in the way, 1.01 from the point and 3.04 from the light";
    EXPECT_TRUE(contains(umbra(why).output, said)) << umbra(why).output;
    const auto light = nlohmann::json::parse(umbra(why + " --json").output)["lights"][0];
    EXPECT_EQ(light["methods"].size(), 1u);
    EXPECT_TRUE(contains(light["truth"].get<std::string>(), "Triangle 3 of lid is in the way"));
}

TEST_F(Cli, InspectSaysHowClosedMeshesAreOriented) {
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    std::ofstream(file("outwards.obj")) << corners << "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::ofstream(file("inwards.obj")) << corners << "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
    EXPECT_TRUE(contains(umbra("inspect " + file("outwards.obj")).output, "closed, oriented outwards"));
    EXPECT_TRUE(contains(umbra("inspect " + file("inwards.obj")).output, "closed, oriented inwards"));
}

TEST_F(Cli, RenderIsTheSameForAnyNumberOfThreads) {
    for (const umbra::MethodInfo* info : umbra::methods()) {
        const std::string method(info->name);
        const auto render = [&](int threads, const std::string& scene, const char* to) {
            return umbra(fmt::format("--threads {} render {} --size 160x90 --quiet --method {} -o {}", threads, scene,
                                     method, file(to)))
                .exit_code;
        };
        // Exit code 1: the method does not serve this scene; one with an area light it does.
        const int first         = render(1, kScene, "one.exr");
        const std::string scene = first == 1 ? "umbra_penumbra" : kScene;
        ASSERT_EQ(first == 1 ? render(1, scene, "one.exr") : first, 0) << method;
        ASSERT_EQ(render(3, scene, "three.exr"), 0) << method;
        EXPECT_EQ(umbra("diff " + file("one.exr") + " " + file("three.exr")).exit_code, 0) << method;
    }
}

TEST_F(Cli, DiffExitCodes) {
    ASSERT_EQ(umbra("render " + kScene + " --size 160x90 -o " + file("a.png")).exit_code, 0);
    ASSERT_EQ(umbra("render " + kScene + " --size 160x90 --method shadow_zbuffer:resolution=64 -o " + file("b.png"))
                  .exit_code,
              0);
    ASSERT_EQ(umbra("render " + kScene + " --size 80x45 -o " + file("c.png")).exit_code, 0);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("a.png")).exit_code, 0);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("b.png")).exit_code, 2);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("b.png") + " --fail 1").exit_code, 1);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("c.png")).exit_code, 3);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("none.png")).exit_code, 4);
    const Answer nowhere = umbra("diff " + folder_.string() + " " + file("none"));
    EXPECT_EQ(nowhere.exit_code, 4);
    EXPECT_FALSE(contains(nowhere.output, "rm --")) << "a mistyped folder accepts nothing";
    const nlohmann::json record =
        nlohmann::json::parse(umbra("diff " + file("a.png") + " " + file("b.png") + " --json").output);
    for (const char* key : {"mae", "rmse", "max", "psnr", "ssim", "flip", "worst"})
        EXPECT_TRUE(record.contains(key)) << key;
    EXPECT_TRUE(record["worst"].contains("a") && record["worst"].contains("b")) << record["worst"];
}

TEST_F(Cli, DiffOfFoldersAndChosenChannels) {
    fs::create_directories(folder_ / "old");
    fs::create_directories(folder_ / "new");
    const std::string render = "render sun_on_plane --size 64x36 --quiet -o ";
    ASSERT_EQ(umbra(render + file("old/a.exr")).exit_code, 0);
    ASSERT_EQ(umbra(render + file("old/b.exr")).exit_code, 0);
    ASSERT_EQ(umbra(render + file("new/a.exr")).exit_code, 0);
    ASSERT_EQ(umbra(render + file("new/b.exr --geometry")).exit_code, 0);
    const std::string folders = "diff " + file("old") + " " + file("new");
    Answer answer             = umbra(folders + " --html " + file("page.html") + " --junit " + file("junit.xml"));
    EXPECT_EQ(answer.exit_code, 3) << answer.output;
    EXPECT_TRUE(contains(answer.output, "same       a.exr\nunlike     b.exr: channels differ"));
    EXPECT_TRUE(contains(answer.output, "--channels"));
    EXPECT_TRUE(fs::exists(file("page.html")) && fs::exists(file("junit.xml")));
    answer = umbra(folders + " --channels 'R,G,B,S.*'");
    EXPECT_EQ(answer.exit_code, 0) << answer.output;

    // One file instead of a page with a folder; rules from a file.
    ASSERT_EQ(umbra(render + file("new/a.exr") + " --method shadow_zbuffer:resolution=16").exit_code, 0);
    fs::remove_all(file("page.files"));
    std::ofstream(file("rules.json")) << R"({"images": [{"name": "a.*", "passes": {"flip": 1}}]})";
    answer = umbra(folders + " --channels 'R,G,B,S.*' --tolerance " + file("rules.json") + " --html " +
                   file("page.html") + " --embed --markdown " + file("summary.md"));
    EXPECT_EQ(answer.exit_code, 1) << answer.output;
    EXPECT_FALSE(fs::exists(file("page.files")));
    EXPECT_TRUE(contains(text_of(file("page.html")), "<img src=\"data:image/png;base64,iVBORw0KGgo"));
    EXPECT_FALSE(contains(text_of(file("page.html")), "src=\"page"));
    EXPECT_TRUE(contains(text_of(file("summary.md")), "| a.exr | close |"));
    EXPECT_EQ(umbra(folders + " --tolerance " + file("none.json")).exit_code, 4);
    answer = umbra("diff --channels R,G,B " + file("old/b.exr") + " " + file("new/b.exr"));
    EXPECT_EQ(answer.exit_code, 0) << answer.output;
    fs::remove(file("new/b.exr"));
    EXPECT_EQ(umbra(folders).exit_code, 2);
    EXPECT_EQ(umbra(folders + " --channels R").exit_code, 2);
}

TEST_F(Cli, AcceptRenewsOnceAndCheckNeverWrites) {
    fs::copy(kScene, file("sun.json"));
    std::ofstream(file("canonical.txt")) << "# one scene\nsun.json\n";
    const std::string with_folders =
        "UMBRA_SCENES=" + folder_.string() + " UMBRA_GOLDEN=" + file("golden") + " " + UMBRA_PROGRAM + " accept ";
    EXPECT_EQ(run(with_folders + "moon").exit_code, 64);
    Answer answer = run(with_folders + "--check");
    EXPECT_EQ(answer.exit_code, 1);
    EXPECT_NE(answer.output.find("sun/shadow_zbuffer: new"), std::string::npos) << answer.output;
    EXPECT_FALSE(fs::exists(file("golden")));

    EXPECT_EQ(run(with_folders + "sun/exact sun/shadow_zbuffer").exit_code, 0);
    EXPECT_TRUE(fs::exists(file("golden/sun/exact.exr")));
    EXPECT_FALSE(fs::exists(file("golden/sun/ray_traced.exr")));
    EXPECT_EQ(run(with_folders).exit_code, 0);
    answer = run(with_folders);
    EXPECT_EQ(answer.exit_code, 0);
    EXPECT_EQ(answer.output, "nothing changed\n");
    EXPECT_EQ(run(with_folders + "--check").exit_code, 0);

    std::ofstream(file("golden/sun/figures.json")) << "no figures";
    EXPECT_EQ(run(with_folders + "--check").exit_code, 4);
    fs::remove(file("golden/sun/figures.json"));
    EXPECT_EQ(run(with_folders + "--check").exit_code, 1);
}

TEST_F(Cli, StreamsMayBeClosedFullOrWithoutAReader) {
    const auto shell = [](const std::string& rest) {
        return run("sh -c '" + std::string(UMBRA_PROGRAM) + " " + rest + "'");
    };
    for (const char* command : {"list", "--help"}) {
        const Answer closed = shell(std::string(command) + " >&-"), full = shell(std::string(command) + " >/dev/full");
        EXPECT_EQ(closed.exit_code, 4);
        EXPECT_TRUE(contains(closed.output, "standard output: cannot be written: Bad file descriptor"))
            << closed.output;
        EXPECT_EQ(full.exit_code, 4);
        EXPECT_TRUE(contains(full.output, "standard output: cannot be written: No space left")) << full.output;
    }
    // Whoever reads enough and leaves ends the program as a closed pipe does, without a word.
    const Answer gone = run("bash -c '" + std::string(UMBRA_PROGRAM) + " list --json | true; exit ${PIPESTATUS[0]}'");
    EXPECT_TRUE(gone.exit_code == 141 || gone.exit_code == 0) << gone.exit_code;
    EXPECT_EQ(gone.output, "");
    // No file of ours becomes standard output: what is printed there would be written into it.
    EXPECT_EQ(
        shell("compare sun_on_plane --size 32x18 --methods ray_traced -o " + file("out") + " >&- 2>&- <&-").exit_code,
        4);
    EXPECT_EQ(shell("compare sun_on_plane --size 32x18 --methods ray_traced -o " + file("out2") + " --quiet >&- 2>&-")
                  .exit_code,
              0);
    for (const char* out : {"out", "out2"}) EXPECT_EQ(umbra("report --quiet " + file(out)).exit_code, 0);
}

TEST_F(Cli, AnOutputFolderThatIsNotOursIsLeftAlone) {
    std::ofstream(file("index.html")) << "<p>home</p>";
    for (const std::string& command : {"compare " + kScene, "bias " + kScene, std::string("report")}) {
        const Answer answer = umbra(command + " -o " + folder_.string());
        EXPECT_EQ(answer.exit_code, 4) << command;
        EXPECT_TRUE(contains(answer.output, "holds index.html, which umbra did not write")) << answer.output;
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(Cli, MemoryThatIsNotThereIsRefusedAtOnce) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "AddressSanitizer needs all of the address space";
#endif
    const std::string limited = "bash -c 'ulimit -v 2000000; " + std::string(UMBRA_PROGRAM) + " --threads 1 ";
    for (const std::string& command :
         {"compare " + kScene + " -o " + file("out"), "render " + kScene + " -o " + file("a.exr")}) {
        const Answer answer = run(limited + command + " --size 16384x4096'");
        EXPECT_EQ(answer.exit_code, 4) << answer.output;
        EXPECT_TRUE(contains(answer.output, "16384 x 4096 pixels") && contains(answer.output, "GB may be used"))
            << answer.output;
    }
    EXPECT_TRUE(fs::is_empty(folder_));
    EXPECT_TRUE(contains(umbra("render " + kScene + " --size 16384x16384 -o " + file("a.exr")).output, "GB"));
}

TEST_F(Cli, CompareThenReportAnewFromFilesAlone) {
    ASSERT_EQ(umbra("compare " + kScene + " --size 96x54 --methods ray_traced shadow_zbuffer:resolution=128 -o " +
                    file("out"))
                  .exit_code,
              0);
    ASSERT_TRUE(fs::exists(file("out/index.html")));
    ASSERT_TRUE(fs::exists(file("out/results.json")));
    ASSERT_EQ(umbra("report " + file("out/sun_on_plane") + " -o " + file("anew")).exit_code, 0);
    EXPECT_TRUE(fs::exists(file("anew/index.html")));
    // The program that a first `./umbra report` builds has this command alone, and writes the same.
    const std::string alone = UMBRA_REPORT_PROGRAM;
    ASSERT_EQ(run(alone + " report " + file("out/sun_on_plane") + " -o " + file("alone")).exit_code, 0);
    std::size_t pages = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(file("anew"))) {
        if (entry.path().extension() != ".html") continue;
        EXPECT_EQ(text_of(entry.path()), text_of(file("alone") / fs::relative(entry.path(), file("anew"))));
        ++pages;
    }
    EXPECT_GT(pages, 0u);
    EXPECT_EQ(run(alone + " report --help").output, umbra("report --help").output);
    EXPECT_EQ(run(alone + " compare").exit_code, 64);
}

TEST_F(Cli, UpTurnsMeshFilesAndSaysWhereThereIsNone) {
    std::ofstream(file("part.obj")) << "v 1 2 3\nv 4 2 3\nv 1 5 7\nf 1 2 3\n";
    const auto extent = [&](const std::string& arguments) {
        return nlohmann::json::parse(
            run("(" + std::string(UMBRA_PROGRAM) + " inspect --json " + arguments + " 2>/dev/null)")
                .output)["facts"]["extent"];
    };
    const nlohmann::json z = extent(file("part.obj") + " --up z");
    EXPECT_EQ(z, (nlohmann::json{{"min", {1, 3, -5}}, {"max", {4, 7, -2}}}));
    EXPECT_EQ(extent(file("part.obj") + "@z"), z);
    EXPECT_EQ(extent(file("part.obj") + " --up=-y")["min"], (nlohmann::json{1, -5, -7}));
    const Answer none = umbra("inspect " + kScene + " --up z");
    EXPECT_EQ(none.exit_code, 64);
    EXPECT_TRUE(contains(none.output, "says itself which way is up, expected a mesh file")) << none.output;
    EXPECT_EQ(umbra("inspect " + file("part.obj") + " --up x").exit_code, 64);
    EXPECT_EQ(umbra("compare " + kScene + " " + file("part.obj") +
                    " --up z --size 16x12 --methods ray_traced --quiet -o " + file("out"))
                  .exit_code,
              0);
    EXPECT_TRUE(fs::exists(file("out/part/results.json")));
}

TEST_F(Cli, AFarSceneSaysWhatItsNumbersAreRelativeTo) {
    std::ofstream(file("far.obj")) << "v 569001 5929000 0\nv 569002 5929000 0\nv 569001 5929001 0\nf 1 2 3\n";
    EXPECT_TRUE(contains(umbra("inspect " + file("far.obj")).output, "Origin: (569000, 5929000, 0) of the file"));
    const Answer answer =
        run("(" + std::string(UMBRA_PROGRAM) + " inspect --json " + file("far.obj") + " 2>/dev/null)");
    EXPECT_EQ(nlohmann::json::parse(answer.output)["scene"]["origin"], (nlohmann::json{569000, 5929000, 0}));
    EXPECT_FALSE(contains(umbra("inspect " + kScene).output, "Origin:"));
}

/// Commands that take scenes and write a folder, in forms that take moments.
const std::vector<std::string> kSceneCommands = {
    "compare --size 32x18 --methods ray_traced", "sweep --size 32x18 --methods ray_traced --views 1 --no-times",
    "motion --size 32x18 --methods ray_traced --frames 1", "bias --size 16x9 --map resolution=64",
    "energy --method ray_traced --points 100"};

std::string first_word(const std::string& text) { return text.substr(0, text.find(' ')); }

/// The names under which a record, and the folders of a command that makes some, tell scenes apart.
std::vector<std::string> names_in(const fs::path& out, const std::string& command) {
    std::vector<std::string> names;
    if (command == "compare" || command == "sweep") {
        for (const auto& entry : fs::directory_iterator(out))
            if (fs::exists(entry.path() / "results.json")) names.push_back(entry.path().filename().string());
        std::ranges::sort(names);
        return names;
    }
    std::ifstream in(out / "results.json");
    const nlohmann::json record = nlohmann::json::parse(in);
    for (const nlohmann::json& scene : record[command == "energy" ? "frames" : command])
        if (scene["scene"] != "all")
            names.push_back(scene["scene"].is_object() ? scene["scene"]["name"] : scene["scene"]);
    return names;
}

TEST_F(Cli, ScenesOfOneNameInAnyCaseAreToldApartByEveryCommand) {
    fs::create_directories(folder_ / "a");
    fs::create_directories(folder_ / "b");
    fs::copy_file(kScene, folder_ / "a/X.json");
    fs::copy_file(kScene, folder_ / "b/x.json");
    const std::string x = file("a/X.json");
    for (const std::string& command : kSceneCommands) {
        const std::string name = first_word(command), out = file(name.c_str());
        const std::string start = name + " " + x + " ", rest = command.substr(name.size()) + " --quiet -o " + out;
        const Answer twice = umbra(start + file("a/../a/X.json") + rest);
        EXPECT_EQ(twice.exit_code, 64) << command << '\n' << twice.output;
        EXPECT_TRUE(contains(twice.output, "is given twice, expected each scene once")) << command << twice.output;
        const bool is_listed = name == "compare" || name == "sweep";
        const Answer both    = umbra(start + file("b/x.json") + rest + (is_listed ? " --json" : ""));
        ASSERT_EQ(both.exit_code, 0) << command << '\n' << both.output;
        if (is_listed) {
            EXPECT_EQ(nlohmann::json::parse(both.output).size(), 2u) << "records of several scenes are a list";
        }
        EXPECT_EQ(names_in(out, name), (std::vector<std::string>{"X", "x-2"})) << command;
    }
}

TEST_F(Cli, EveryCommandReplacesWhatItWrote) {
    std::vector<std::string> commands = kSceneCommands;
    for (const char* more : {"polygons", "radiosity --size 32x18 --steps 3", "shading --size 32x18 --runs 1 --views 1",
                             "whitted --size 32x18 --runs 1 --pixel-samples 1"})
        commands.emplace_back(more);
    for (const std::string& command : commands) {
        const std::string name = first_word(command);
        const std::string line =
            name + " " + kScene + command.substr(name.size()) + " --quiet -o " + file(name.c_str());
        for (const char* time : {"first", "second"}) {
            const Answer answer = umbra(line);
            EXPECT_EQ(answer.exit_code, 0) << time << " run of " << line << '\n' << answer.output;
        }
    }
    std::ofstream(file("energy/mine.csv")) << "a user's";
    EXPECT_EQ(umbra("energy " + kScene + " --points 100 --quiet -o " + file("energy")).exit_code, 4);
    EXPECT_TRUE(fs::exists(file("energy/mine.csv")));
}

TEST_F(Cli, ShadowsAreSwitchedOffAlikeEverywhere) {
    for (const std::string command : {"energy --points 100", "shading --size 32x18 --runs 1 --views 1",
                                      "whitted --size 32x18 --runs 1 --pixel-samples 1"})
        for (const char* off : {" --no-shadows", " --method none", " --methods none"}) {
            const std::string name = first_word(command);
            const Answer answer    = umbra(name + " " + kScene + command.substr(name.size()) + off +
                                           " --json --quiet -o " + file(name.c_str()));
            ASSERT_EQ(answer.exit_code, 0) << command << off << '\n' << answer.output;
            EXPECT_TRUE(nlohmann::json::parse(answer.output)["method"].is_null()) << command << off;
        }
}

TEST_F(Cli, OptionsHaveOneSpellingAndTakeTheOther) {
    EXPECT_EQ(umbra("render " + kScene + " --methods ray_traced --size 16x9 -o " + file("a.png")).exit_code, 0);
    EXPECT_EQ(umbra("compare --method ray_traced " + kScene + " --size 16x9 --quiet -o " + file("out")).exit_code, 0);
    EXPECT_FALSE(contains(umbra("compare --help").output, "--method ")) << "one spelling in the help";
    EXPECT_FALSE(contains(umbra("render --help").output, "--methods"));
    for (const char* command : {"compare --methods ray_traced", "bias --map resolution=64"}) {
        const std::string name = first_word(command);
        const Answer answer    = run("(" + std::string(UMBRA_PROGRAM) + " " + name + " " + kScene +
                                     std::string(command).substr(name.size()) + " --size 16x9 --json -o " +
                                     file(name.c_str()) + " 2>/dev/null)");
        ASSERT_EQ(answer.exit_code, 0) << answer.output;
        EXPECT_EQ(nlohmann::json::parse(answer.output)["size"]["width"], 16) << "the record, and nothing else";
    }
}

}  // namespace
