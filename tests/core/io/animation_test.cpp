// Keyframes in native scene files: FILE@N is the scene as it is in frame N.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/io/scene_writer.h"
#include "umbra/core/scene/facts.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

class Keyframes : public testing::Test {
protected:
    std::string write(const std::string& animation) const {
        return folder_
            .write("moving.json", R"({"camera": {"eye": [0, 3, 9], "target": [0, 1, 0]},
                "lights": [{"name": "sun", "type": "directional", "direction": [3, 0, 0]},
                           {"name": "lamp", "type": "point", "position": [0, 4, 0]},
                           {"name": "torch", "type": "spot", "position": [0, 4, 0], "direction": [0, -1, 0]},
                           {"name": "held", "type": "point", "position": [0, 0, 0], "fixed_to": "camera"}],
                "objects": [{"name": "floor", "type": "plane", "size": [8, 8]},
                            {"name": "box", "type": "box", "size": [2, 1, 1], "transform": [{"translate": [1, 0.5, 0]}]}],
                "animation": )" + animation +
                                      "}")
            .string();
    }
    void expect_refused(const std::string& animation, const std::string& frame, const std::string& says) const {
        try {
            (void)load_scene(write(animation) + frame);
            ADD_FAILURE() << animation << frame << " was read";
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << e.what();
        }
    }
    TemporaryFolder folder_;
};

void expect_near(vec3 a, dvec3 b) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(double(a[c]), b[c], 1e-6) << c;
}

TEST_F(Keyframes, PointsMoveAlongLinesAndDirectionsTurnEvenly) {
    const std::string file = write(R"({"frames": 9,
        "camera": {"keys": [{"frame": 2, "eye": [0, 3, 9]}, {"frame": 6, "eye": [4, 3, 9], "target": [0, 2, 0]}]},
        "lights": {"sun": {"keys": [{"frame": 0, "direction": [3, 0, 0]}, {"frame": 8, "direction": [0, -1, 0]}]},
                   "lamp": {"keys": [{"frame": 0, "position": [0, 4, 0]}, {"frame": 4, "position": [8, 4, 2]}]}}})");
    for (int frame = 0; frame < 9; ++frame) {
        const Scene scene = load_scene(file + "@" + std::to_string(frame));
        EXPECT_EQ(scene.frame, frame);
        EXPECT_EQ(scene.frames, 9);
        EXPECT_EQ(scene.name, "moving@" + std::to_string(frame));
        EXPECT_EQ(scene.title, "moving, frame " + std::to_string(frame));
        const double angle = frame / 8.0 * kPi / 2, eye = std::clamp((frame - 2) / 4.0, 0.0, 1.0),
                     lamp = std::min(frame / 4.0, 1.0);
        expect_near(scene.lights[0].direction / glm::length(scene.lights[0].direction),
                    {std::cos(angle), -std::sin(angle), 0});
        expect_near(scene.lights[1].position, {8 * lamp, 4, 2 * lamp});
        expect_near(scene.lights[2].position, {0, 4, 0});
        expect_near(scene.camera.eye, {4 * eye, 3, 9});
        expect_near(scene.camera.target, {0, 2, 0});  // one key has it: it holds in all frames
        expect_near(scene.lights[3].position, dvec3(scene.camera.eye));
    }
    EXPECT_EQ(load_scene(file).frame, 0);
    EXPECT_EQ(load_scene(file).name, "moving");
    Scene first = load_scene(file + "@0");
    first.title = load_scene(file).title;
    EXPECT_EQ(native_text(load_scene(file)), native_text(first));
}

TEST_F(Keyframes, ObjectsMoveAndTurnAboutTheirMiddle) {
    const std::string file = write(R"({"frames": 5, "objects": {"box": {"axis": [0, 2, 0], "keys":
        [{"frame": 0}, {"frame": 4, "move": [0, 0, 4], "turn": 180}, {"frame": 2, "turn": 0}]}}})");
    EXPECT_THROW((void)load_scene(file), InputError) << "keys are in order";
    // A key without a value has the object where the scene has it.
    const std::string late =
        write(R"({"frames": 9, "objects": {"box": {"keys": [{"frame": 2}, {"frame": 4, "move": [0, 0, 4]}]}}})");
    const auto z_at = [&](const std::string& frame) { return load_scene(late + frame).vertex(13, 0).z; };
    EXPECT_EQ(z_at("@0"), z_at("@2"));
    EXPECT_NEAR(z_at("@3"), z_at("@0") + 2, 1e-6);
    EXPECT_NEAR(z_at("@8"), z_at("@0") + 4, 1e-6);
    const std::string turning = write(R"({"frames": 5, "objects": {"box": {"axis": [0, 2, 0], "keys":
        [{"frame": 0, "move": [0, 0, 0], "turn": 0}, {"frame": 4, "move": [0, 0, 4], "turn": 180}]}}})");
    const Scene start = load_scene(turning), half = load_scene(turning + "@2"), end = load_scene(turning + "@4");
    ASSERT_EQ(start.positions.size(), half.positions.size());
    const Object& box = start.objects[1];
    EXPECT_EQ(box.name, "box");
    for (TriangleId t = 0; t < start.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const dvec3 p(start.vertex(t, k)), arm = p - dvec3(1, 0.5, 0);
            if (t < box.first_triangle) {
                EXPECT_EQ(half.vertex(t, k), start.vertex(t, k));
                continue;
            }
            expect_near(half.vertex(t, k), dvec3(1, 0.5, 0) + dvec3(arm.z, arm.y, -arm.x) + dvec3(0, 0, 2));
            expect_near(end.vertex(t, k), dvec3(1, 0.5, 0) + dvec3(-arm.x, arm.y, -arm.z) + dvec3(0, 0, 4));
        }
}

TEST_F(Keyframes, LightsAreSwitched) {
    const std::string file = write(R"({"frames": 4, "lights": {
        "sun": {"keys": [{"frame": 2, "on": false}]},
        "lamp": {"keys": [{"frame": 0, "on": false}, {"frame": 1, "on": true, "position": [0, 1, 0]}, {"frame": 3, "on": false}]}}})");
    const auto names       = [&](const char* frame) {
        std::string all;
        for (const Light& light : load_scene(file + frame).lights) all += light.name + " ";
        return all;
    };
    EXPECT_EQ(names("@0"), "sun torch held ");
    EXPECT_EQ(names("@1"), "sun lamp torch held ");
    EXPECT_EQ(names("@2"), "lamp torch held ");
    EXPECT_EQ(names("@3"), "torch held ");
}

/// Each frame has one light, at one of the four places that DE1 tells apart.
TEST(LightPlacesScene, HasOneLightAtEachPlace) {
    for (const auto& [frame, place] : {std::pair{"@0", LightPlace::at_infinity},
                                       {"@1", LightPlace::outside_view},
                                       {"@2", LightPlace::inside_view},
                                       {"@3", LightPlace::at_eye}}) {
        const Scene scene      = load_scene(std::string(UMBRA_SCENES) + "/light_places.json" + frame);
        const SceneFacts facts = find_facts(scene);
        ASSERT_EQ(facts.lights.size(), 1u) << frame;
        EXPECT_EQ(facts.lights[0].place, place) << frame;
    }
}

TEST_F(Keyframes, FaultsAreNamed) {
    expect_refused(R"({"frames": 3})", "@3", "frame 3 is asked for, expected 0 to 2");
    expect_refused(R"({})", "", "frames");
    expect_refused(R"({"frames": 3, "lights": {"moon": {"keys": [{"frame": 0}]}}})", "", "no light that is on");
    expect_refused(R"({"frames": 3, "lights": {"held": {"keys": [{"frame": 0}]}}})", "", "fixed to the camera");
    expect_refused(R"({"frames": 3, "lights": {"sun": {"keys": [{"frame": 0, "position": [0, 0, 0]}]}}})", "",
                   "position");
    expect_refused(R"({"frames": 3, "lights": {"sun": {"keys": []}}})", "", "no key");
    expect_refused(R"({"frames": 3, "lights": {"sun": {"keys": [{"frame": 3}]}}})", "", "frame");
    expect_refused(R"({"frames": 3, "lights": {"sun": {"keys": [{"frame": 1}, {"frame": 1}]}}})", "", "order");
    expect_refused(R"({"frames": 3, "objects": {"ball": {"keys": [{"frame": 0}]}}})", "", "no object is named");
    expect_refused(R"({"frames": 3, "camera": {"keys": [{"frame": 0, "eye": [0, 1, 0]}]}})", "",
                   "eye is at its target");
    const std::string still = folder_.write("still.json", R"({"objects": [{"type": "box"}]})").string();
    EXPECT_EQ(load_scene(still + "@0").name, "still@0");
    EXPECT_THROW((void)load_scene(still + "@1"), InputError);
    EXPECT_THROW((void)load_scene(folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").string() + "@1"),
                 InputError);
}

/// A file whose name ends so is that file.
TEST_F(Keyframes, AFileOfThatNameComesFirst) {
    const auto file = folder_.write("odd@2.json", R"({"objects": [{"type": "box"}]})");
    EXPECT_EQ(load_scene(file).name, "odd@2");
    EXPECT_EQ(split_frame("a/b.json@12").frame, "@12");
    EXPECT_EQ(split_frame("a/b.json@12").file, "a/b.json");
    EXPECT_EQ(split_frame("a@b.json").frame, "");
    EXPECT_EQ(split_frame("b.json@").frame, "");
}

}  // namespace
}  // namespace umbra
