// Ladders of a user's own: what a file may say, the scenes of its rungs, and that they are climbed beside ours.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "umbra/bench/base/files.h"
#include "umbra/bench/ladders/ladder_file.h"
#include "umbra/bench/ladders/ladder_record.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/program.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class LadderFile : public testing::Test {
protected:
    void SetUp() override {
        folder_.write("quad.obj", "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 4 3 2 1\n");
        folder_.write("room.json", R"({"camera": {"eye": [0, 5, 9], "target": [0, 0, 0]}, "size": [64, 36],
            "lights": [{"name": "lamp", "type": "point", "position": [0, 4, 0]}],
            "objects": [{"name": "floor", "type": "plane", "size": [8, 8]},
                        {"name": "lid", "type": "mesh", "file": "quad.obj", "transform": [{"translate": [0, 1, 0]}]}]})");
        ladder_ = {{"title", "A lamp that sinks"},
                   {"unit", "m"},
                   {"scene", "room.json"},
                   {"set", {"/lights/0/position/1"}},
                   {"rungs", {4, 2, 1.5}}};
    }
    const Ladder& read(const json& ladder) {
        folder_.write("low.json", ladder.dump());
        return read_ladder(folder_.path() / "low.json", [](const std::string& name) -> fs::path {
            if (name != "ours") throw UsageError("no scene " + name);
            return fs::path(UMBRA_SCENES) / "stairs.json";
        });
    }
    std::string refusal(const std::string& member, const json& value) {
        json ladder    = ladder_;
        ladder[member] = value;
        try {
            static_cast<void>(read(ladder));
        } catch (const InputError& e) {
            return e.what();
        }
        return "";
    }
    void expect_refused(const std::string& member, const json& value, const std::string& with) {
        const std::string message = refusal(member, value);
        EXPECT_NE(message.find("low.json:/" + with), std::string::npos) << member << ": " << message;
    }

    TemporaryFolder folder_;
    json ladder_;
};

TEST_F(LadderFile, SetsItsNumbersInTheSceneBesideIt) {
    const Ladder& low = read(ladder_);
    EXPECT_EQ(low.name, "low");
    EXPECT_EQ(low.title, "A lamp that sinks");
    EXPECT_EQ(low.unit, "m");
    EXPECT_EQ(low.about, "/lights/0/position/1 of room.json changes.");
    ASSERT_EQ(low.rungs.size(), 3u);
    for (const double rung : low.rungs) {
        const Scene scene = low.scene(rung);
        EXPECT_EQ(scene.lights.at(0).position, vec3(0, static_cast<float>(rung), 0));
        EXPECT_EQ(scene.triangles.size(), 4u) << "the mesh beside it is there";
        EXPECT_EQ(scene.name, "room");
    }

    json of_ours     = ladder_;
    of_ours["scene"] = "ours", of_ours["set"] = {"/size/0", "/size/1"}, of_ours["rungs"] = {16, 32};
    of_ours.erase("title");
    const Ladder& size = read(of_ours);
    EXPECT_EQ(size.title, "low");
    EXPECT_EQ(size.scene(32).width, 32);
    EXPECT_EQ(size.scene(32).height, 32);
    EXPECT_EQ(low.title, "A lamp that sinks") << "a ladder outlives the next";
}

TEST_F(LadderFile, IsRefusedWithItsPlace) {
    expect_refused("rung", {1, 2}, "rung");
    expect_refused("scene", "nowhere.json", "scene: found \"nowhere.json\"");
    expect_refused("scene", "quad.obj", "scene: found \"quad.obj\", expected a native scene");
    for (const char* pointer : {"/lights/1/position/1", "/lights/0/position", "/lights/0/name", "lights"})
        expect_refused("set", {"/lights/0/position/1", pointer}, "set/1: found");
    expect_refused("set", json::array(), "set: found");
    for (const json& rungs : {json{1}, json::array(), json{1, 1}, json{1, 3, 2}, json{3, 1, 2}, json{1, nullptr}})
        expect_refused("rungs", rungs, "rungs: found");
    folder_.write("room.json", R"({"lights": 3})");
    EXPECT_NE(refusal("unit", "m").find("room.json:1:12"), std::string::npos) << refusal("unit", "m");
}

TEST_F(LadderFile, IsClimbedBesideOurs) {
    folder_.write("low.json", ladder_.dump());
    const auto umbra = [&](const std::string& line) {
        return run_program(fmt::format("cd '{}' && {} {}", folder_.path().string(), UMBRA_PROGRAM, line));
    };
    const ProgramAnswer answer =
        umbra("ladder --methods planar_projection shadow_zbuffer:bias=manual,constant=0 low.json thin_walls -o out");
    ASSERT_EQ(answer.exit_code, 0) << answer.output;
    const LaddersRecord record = read_ladders(folder_.path() / "out/results.json");
    ASSERT_EQ(record.ladders.size(), 2u);
    EXPECT_EQ(record.ladders[0].name, "low");
    EXPECT_EQ(record.ladders[1].name, "thin_walls");
    ASSERT_EQ(record.ladders[0].methods.size(), 2u);
    EXPECT_EQ(record.ladders[0].methods[0].breaks_at, std::nullopt);
    EXPECT_EQ(record.ladders[0].methods[1].breaks_at, 1.5) << "its acne grows as the lamp sinks";
    EXPECT_NE(bytes_of(folder_.path() / "out/index.html").find("A lamp that sinks"), std::string::npos);
    EXPECT_EQ(umbra("report out -o report").exit_code, 0);
    EXPECT_NE(bytes_of(folder_.path() / "report/index.html").find("A lamp that sinks"), std::string::npos);

    json no_scene     = ladder_;
    no_scene["rungs"] = {4, 2, -1e30};  // farther away than a scene may be
    folder_.write("low.json", no_scene.dump());
    const ProgramAnswer refused = umbra("ladder low.json --methods planar_projection -o out2");
    EXPECT_EQ(refused.exit_code, 5);
    EXPECT_NE(refused.output.find("low: the reference: It failed at -1e+30: "), std::string::npos) << refused.output;

    fs::create_directory(folder_.path() / "other");
    folder_.write("other/low.json", ladder_.dump());
    for (const char* name : {"room.json", "quad.obj"})
        fs::copy_file(folder_.path() / name, folder_.path() / "other" / name);
    EXPECT_EQ(umbra("ladder low.json other/low.json -o out3").exit_code, 64) << "two are called low";
    EXPECT_EQ(umbra("ladder low.json low.json -o out3").exit_code, 64);
    EXPECT_EQ(umbra("ladder gone.json -o out3").exit_code, 4);
}

}  // namespace
}  // namespace umbra
