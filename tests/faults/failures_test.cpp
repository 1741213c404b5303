// A method that throws loses its own results and nothing else, whatever the command and the phase. The program is
// `umbra_planted`, which plant.cpp describes.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "umbra/tests/support/program.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
json json_of(const fs::path& file) { return json::parse(text_of(file)); }

constexpr std::string_view kLamp  = R"({"name": "lamp", "type": "point", "position": [0.5, 4, 0.5]})";
constexpr std::string_view kPanel = R"({"name": "panel", "type": "rectangle", "position": [1, 4, 0], "size": [1, 1]})";

class Failures : public testing::Test {
protected:
    void SetUp() override {
        for (const char* name : {"first", "second"}) {
            write_scene(name, fmt::format("{}, {}", kLamp, kPanel));
            write_scene(fmt::format("hard/{}", name), std::string(kLamp));
        }
        folder_.write("hard/canonical.txt", "first.json\nsecond.json\n");
    }
    void write_scene(const std::string& name, const std::string& lights) const {
        folder_.write(name + ".json", fmt::format(R"({{"camera": {{"eye": [3, 4, 6], "target": [0, 0, 0]}},
            "size": [48, 27], "lights": [{}],
            "objects": [{{"name": "floor", "type": "plane", "size": [8, 8]}},
                        {{"name": "box", "type": "box", "size": [1, 1, 1], "transform": [{{"translate": [0, 1.5, 0]}}]}}]}})",
                                                  lights));
    }
    [[nodiscard]] ProgramAnswer planted(const std::string& plant, const std::string& arguments) const {
        return run_program(fmt::format("cd '{0}' && UMBRA_SCENES=hard UMBRA_GOLDEN=golden UMBRA_PLANT='{1}' {2} {3}",
                                       folder_.path().string(), plant, UMBRA_PLANTED, arguments));
    }
    [[nodiscard]] fs::path file(const std::string& name) const { return folder_.path() / name; }

    TemporaryFolder folder_;
};

const std::string kCompare =
    "compare first.json second.json --quiet --methods shadow_zbuffer:resolution=16,bias=manual shadow_volumes -o out";

TEST_F(Failures, CompareRecordsMethodLightAndMessageAndGoesOn) {
    struct Case {
        std::string plant;
        json light;
        std::string message;
    };
    const std::vector<Case> cases = {{"build - exception", nullptr, "a <planted> defect"},
                                     {"build - bad_alloc", nullptr, "not enough memory"},
                                     {"aim 1 worker", "panel", "a <planted> defect"},
                                     {"look - worker", nullptr, "a <planted> defect"},
                                     {"visibility 0 unknown", "lamp", "an exception of unknown type"},
                                     {"visibility 1 worker", "panel", "a <planted> defect"},
                                     {"visibility 1 contract", "panel", "breaks its contract"},
                                     {"blame 1 bad_alloc", "panel", "not enough memory"}};
    for (const Case& c : cases) {
        fs::remove_all(file("out"));
        const ProgramAnswer answer = planted("shadow_zbuffer " + c.plant + " first", kCompare);
        EXPECT_EQ(answer.exit_code, 5) << c.plant << '\n' << answer.output;
        EXPECT_TRUE(contains(answer.output, "first: shadow_zbuffer:resolution=16,bias=manual: It failed"))
            << answer.output;
        const json first = json_of(file("out/first/results.json")), second = json_of(file("out/second/results.json"));
        const json& failed = first["methods"][0]["failed"];
        ASSERT_TRUE(failed.is_object()) << c.plant;
        EXPECT_EQ(failed["light"], c.light) << c.plant;
        EXPECT_TRUE(contains(failed["message"], c.message)) << failed;
        EXPECT_EQ(first["methods"][1]["errors"].size(), 2u) << c.plant << ": the other method goes on";
        EXPECT_FALSE(second["methods"][0].contains("failed")) << c.plant << ": the other scene goes on";
        EXPECT_EQ(second["methods"][0]["errors"].size(), 2u);
        for (const char* page : {"out/first/index.html", "out/index.html"}) {
            const std::string html = text_of(file(page));
            EXPECT_TRUE(contains(html, "Shadow z-buffer (resolution=16,bias=manual) failed")) << page;
            EXPECT_FALSE(contains(html, "<planted>")) << page << ": a message is text, not markup";
        }
        EXPECT_FALSE(contains(text_of(file("out/second/index.html")), " failed"));
    }
}

TEST_F(Failures, NothingFailsWithoutAPlant) {
    EXPECT_EQ(planted("", kCompare).exit_code, 0);
    EXPECT_FALSE(contains(text_of(file("out/index.html")), " failed"));
}

TEST_F(Failures, ASubstituteReplacesAReferenceThatThrows) {
    EXPECT_EQ(planted("exact visibility 1 exception first", kCompare).exit_code, 5);
    const json record = json_of(file("out/first/results.json")), &reference = record["reference"];
    EXPECT_EQ(reference["failed"], (json{{"method", "exact"}, {"light", "panel"}, {"message", "a <planted> defect"}}));
    EXPECT_EQ(reference["exact"], false);
    EXPECT_EQ(reference["name"], "ray_traced");
    for (const json& method : record["methods"]) EXPECT_EQ(method["errors"].size(), 2u);
    EXPECT_TRUE(contains(text_of(file("out/first/index.html")), "The reference exact failed at light panel"));
    EXPECT_TRUE(json_of(file("out/second/results.json"))["reference"]["exact"]);

    // One that the user chose is not replaced: the scene has no results, and the first page says so.
    const ProgramAnswer chosen = planted("exact visibility 1 exception first", kCompare + "2 --reference exact");
    EXPECT_EQ(chosen.exit_code, 5);
    EXPECT_FALSE(fs::exists(file("out2/first")));
    EXPECT_TRUE(contains(text_of(file("out2/index.html")), "first: a &lt;planted&gt; defect"));
}

/// What takes more than its budget has failed, in words and as a record, and nothing else has.
TEST_F(Failures, WhatTakesTooLongIsCutShortAndTheRestIsWhole) {
    for (const char* plant : {"visibility 1 hang", "aim - slow", "blame 1 hang"}) {
        fs::remove_all(file("out"));
        const ProgramAnswer answer = planted(fmt::format("shadow_zbuffer {} first", plant), kCompare + " --budget 2");
        EXPECT_EQ(answer.exit_code, 5) << plant << '\n' << answer.output;
        EXPECT_TRUE(contains(answer.output, "It failed at light panel: cut short after ")) << answer.output;
        EXPECT_TRUE(contains(answer.output, ", the budget is 2 s (--budget)\n")) << answer.output;
        const json first = json_of(file("out/first/results.json")), second = json_of(file("out/second/results.json"));
        EXPECT_EQ(first["methods"][0]["failed"]["cut"], true) << plant;
        EXPECT_EQ(first["methods"][0]["failed"]["light"], "panel") << plant;
        EXPECT_EQ(first["methods"][1]["errors"].size(), 2u) << plant << ": the other method goes on";
        EXPECT_EQ(first["budget"], (json{{"seconds", 2.0}, {"memory_bytes", nullptr}}));
        EXPECT_FALSE(second["methods"][0].contains("failed")) << plant << ": the other scene goes on";
        for (const char* page : {"out/first/index.html", "out/index.html"})
            EXPECT_TRUE(contains(text_of(file(page)), "cut short after")) << page;
    }
    EXPECT_EQ(planted("", kCompare + "3").exit_code, 0);
    EXPECT_FALSE(json_of(file("out3/first/results.json")).contains("budget")) << "nothing is limited";
}

TEST_F(Failures, AReferenceThatIsCutShortIsReplaced) {
    EXPECT_EQ(planted("exact visibility 1 hang first", kCompare + " --budget 2").exit_code, 5);
    const json record = json_of(file("out/first/results.json")), &reference = record["reference"];
    EXPECT_EQ(reference["failed"]["cut"], true);
    EXPECT_EQ(reference["failed"]["light"], "panel");
    EXPECT_EQ(reference["name"], "ray_traced");
    for (const json& method : record["methods"]) EXPECT_EQ(method["errors"].size(), 2u);
    EXPECT_TRUE(
        contains(text_of(file("out/first/index.html")), "The reference exact failed at light panel: cut short"));
}

/// 2048 x 2048 depths of four bytes are 16 MiB; the volumes of a box take kilobytes.
TEST_F(Failures, AMethodOverItsMemoryIsCutShortAndTheOthersAreWhole) {
    const ProgramAnswer answer = planted(
        "",
        "compare first.json --quiet --methods shadow_zbuffer:resolution=2048 shadow_volumes --memory-budget 4 -o out");
    EXPECT_EQ(answer.exit_code, 5);
    EXPECT_TRUE(contains(answer.output, "It failed at light lamp: cut short at ")) << answer.output;
    EXPECT_TRUE(contains(answer.output, "MiB of memory, the budget is 4 MiB (--memory-budget)")) << answer.output;
    const json record = json_of(file("out/first/results.json"));
    EXPECT_EQ(record["methods"][0]["failed"]["cut"], true);
    EXPECT_EQ(record["methods"][1]["errors"].size(), 2u);
    EXPECT_TRUE(record["reference"]["exact"]);
    EXPECT_EQ(record["budget"], (json{{"seconds", nullptr}, {"memory_bytes", 4.0 * (1 << 20)}}));
}

/// No key of a cell has the budget: what was cut short is computed again.
TEST_F(Failures, ACellThatIsCutShortIsNotKept) {
    const std::string sweep =
        "sweep first.json --quiet --methods shadow_volumes planar_projection --views 1 --no-times --budget 2 -o out";
    EXPECT_EQ(planted("shadow_volumes visibility 1 hang", sweep).exit_code, 5);
    const auto settings = [&] { return json_of(file("out/results.json"))["sweep"]["settings"]; };
    EXPECT_EQ(settings()[0]["failed"]["cut"], true);
    EXPECT_EQ(settings()[0]["excluded"], "it failed");
    EXPECT_FALSE(settings()[1].contains("failed"));
    EXPECT_EQ(planted("", sweep).exit_code, 0);
    EXPECT_FALSE(settings()[0].contains("failed"));
}

TEST_F(Failures, LaddersAndMotionGoOnWithoutWhatIsCutShort) {
    const std::string plant = "shadow_volumes visibility - hang";
    EXPECT_EQ(planted(plant, "ladder thin_walls --methods shadow_volumes planar_projection --budget 2 --quiet -o out")
                  .exit_code,
              0);
    const json ladder = json_of(file("out/results.json"))["ladders"][0];
    for (const json& rung : ladder["methods"][0]["rungs"]) {
        EXPECT_EQ(rung["serves"]["how"], "not");
        EXPECT_TRUE(contains(rung["serves"]["why"], "cut short after")) << rung;
    }
    EXPECT_EQ(ladder["methods"][0]["not_served_from"], ladder["rungs"][0]["value"]);
    EXPECT_NE(ladder["methods"][1]["rungs"][0]["serves"]["how"], "not");

    const ProgramAnswer motion = planted(plant,
                                         "motion hard/first.json --methods shadow_volumes planar_projection "
                                         "--frames 1 --size 32x18 --budget 2 --quiet -o moved");
    EXPECT_EQ(motion.exit_code, 5);
    EXPECT_TRUE(contains(motion.output, "first: shadow_volumes: at rest: cut short after ")) << motion.output;
    const json record = json_of(file("moved/results.json"));
    ASSERT_EQ(record["motion"][0]["methods"].size(), 2u);
    EXPECT_EQ(record["motion"][0]["methods"][1]["movements"]["camera"]["frames"].size(), 1u);
    EXPECT_TRUE(contains(text_of(file("moved/index.html")), "cut short after"));
}

TEST_F(Failures, ABlamingReferenceIsNamed) {
    EXPECT_EQ(planted("exact blame 0 exception first",
                      "compare first.json --methods shadow_zbuffer:resolution=64,bias=manual,constant=128 -o out")
                  .exit_code,
              5);
    const json record = json_of(file("out/first/results.json"));
    EXPECT_EQ(record["methods"][0]["failed"]["message"], "exact, asked for occluders: a <planted> defect");
}

TEST_F(Failures, RenderWritesNothingAndNamesTheLight) {
    const ProgramAnswer answer =
        planted("shadow_volumes visibility 1 bad_alloc", "render first.json --method shadow_volumes -o a.png");
    EXPECT_EQ(answer.exit_code, 5);
    EXPECT_EQ(answer.output, "umbra: shadow_volumes failed at light panel: not enough memory\n");
    EXPECT_FALSE(fs::exists(file("a.png")));
}

TEST_F(Failures, LaddersGoOn) {
    const std::string command =
        "ladder far_from_origin thin_walls --methods shadow_volumes planar_projection --quiet -o out";
    const ProgramAnswer answer = planted("shadow_volumes visibility - worker", command);
    EXPECT_EQ(answer.exit_code, 5);
    EXPECT_TRUE(contains(answer.output, "far_from_origin: shadow_volumes: It failed at 1, light")) << answer.output;
    const json record = json_of(file("out/results.json"));
    ASSERT_EQ(record["failed"].size(), 2u) << record["failed"];
    EXPECT_EQ(record["failed"][1]["method"], "shadow_volumes");
    EXPECT_EQ(record["failed"][1]["message"], "a <planted> defect");
    EXPECT_EQ(record["ladders"][0]["methods"][0]["kind"], "stopped");
    EXPECT_GT(record["ladders"][1]["methods"][1]["rungs"].size(), 1u);
    EXPECT_TRUE(contains(text_of(file("out/index.html")), "shadow_volumes failed at 1 at light"));

    fs::remove_all(file("out"));
    EXPECT_EQ(planted("exact build - bad_alloc", command).exit_code, 5);
    EXPECT_EQ(json_of(file("out/results.json"))["failed"][0]["method"], "the reference");
    EXPECT_EQ(planted("", "ladder thin_walls --methods planar_projection -o out").exit_code, 0);
    EXPECT_EQ(json_of(file("out/results.json"))["failed"], json::array());
}

TEST_F(Failures, ReportShowsWhatFailedAndIsWhole) {
    const ProgramAnswer answer = planted("exact build - exception", "report --quiet -o out");
    EXPECT_EQ(answer.exit_code, 5);
    const std::string index = text_of(file("out/index.html"));
    for (const char* what : {"first: The reference exact failed", "second: Exact visibility failed",
                             "far_from_origin: the reference failed at 1: a &lt;planted&gt; defect",
                             "A9: the experiment failed: a &lt;planted&gt; defect"})
        EXPECT_TRUE(contains(index, what)) << what;
    EXPECT_TRUE(contains(answer.output, "A9: the experiment: a <planted> defect")) << answer.output;
    EXPECT_TRUE(contains(text_of(file("out/lectures.html")), "lectures/D1-1.png")) << "experiments of other methods";
    EXPECT_TRUE(fs::exists(file("out/second/ray_traced.png")));
    EXPECT_TRUE(fs::exists(file("out/ladders/index.html")));
}

TEST_F(Failures, AcceptKeepsTheGoldenOfAMethodThatThrows) {
    EXPECT_EQ(planted("", "accept --quiet").exit_code, 0);
    fs::remove(file("golden/first/shadow_volumes.exr"));
    folder_.write("golden/first/shadow_zbuffer.exr", "not an image, but not to be lost");
    const auto changes = [&](const std::string& plant) { return planted(plant, "accept first/shadow_volumes second"); };
    const ProgramAnswer answer = changes("shadow_volumes build - worker first");
    EXPECT_EQ(answer.exit_code, 5);
    EXPECT_TRUE(contains(answer.output, "first/shadow_volumes: failed\n    a <planted> defect\n")) << answer.output;
    EXPECT_TRUE(contains(answer.output, "1 failed"));
    EXPECT_FALSE(fs::exists(file("golden/first/shadow_volumes.exr")));
    EXPECT_EQ(changes("exact build - unknown first").exit_code, 5);
    EXPECT_EQ(changes("").exit_code, 0);
    EXPECT_TRUE(fs::exists(file("golden/first/shadow_volumes.exr")));
    EXPECT_EQ(text_of(file("golden/first/shadow_zbuffer.exr")), "not an image, but not to be lost");
}

TEST_F(Failures, BiasStudiesTheOtherScenes) {
    const ProgramAnswer answer = planted("shadow_zbuffer visibility 0 bad_alloc first",
                                         "bias --quiet --size 16x9 -o out hard/first.json hard/second.json");
    EXPECT_EQ(answer.exit_code, 5);
    EXPECT_EQ(answer.output, "first: not enough memory\n");
    const json record = json_of(file("out/results.json"));
    EXPECT_EQ(record["bias"].size(), 1u);
    EXPECT_EQ(record["bias"][0]["scene"], "second");
    EXPECT_EQ(record["failed"][0]["scene"], "first");
    EXPECT_TRUE(contains(text_of(file("out/index.html")), "first: not enough memory"));
    EXPECT_EQ(planted("", "bias --map resolution=abc -o out2 hard/first.json").exit_code, 64);
}

}  // namespace
}  // namespace umbra
