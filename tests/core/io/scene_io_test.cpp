// Loading, for every format: dispatch, unreadable files, the checks and defaults that all share.
#include "umbra/core/io/scene_io.h"

#include <sys/stat.h>

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

std::string message_of(const std::filesystem::path& file) {
    try {
        (void)load_scene(file);
    } catch (const InputError& e) {
        return e.what();
    }
    return "loaded";
}

SceneFile with_box() {
    SceneFile read;
    const Mesh box = make_box(vec3(1));
    read.scene.materials.emplace_back();
    add_object(read.scene, "box", box.positions, box.normals, box.triangles, 0);
    read.has_camera = true;
    Light light;
    light.position = {0, 5, 0};
    read.scene.lights.push_back(light);
    return read;
}

Scene finish(SceneFile read, const std::filesystem::path& file = "x.obj") {
    check_scene(read, file);
    return complete_scene(std::move(read), file);
}

std::string refusal(SceneFile read) {
    try {
        (void)finish(std::move(read), "folder/made.obj");
    } catch (const InputError& e) {
        return e.what();
    }
    return "accepted";
}

/// An opacity just below 1: each reader says in one warning what the picture and the shadows make of it.
TEST(LoadScene, OpacityJustBelowOneIsSaidInEveryFormat) {
    const TemporaryFolder folder;
    const std::string wall = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl pane\nf 1 2 3\n";
    folder.write("d.obj", "mtllib d.mtl" + wall.substr(12)), folder.write("d.mtl", "newmtl pane\nd 0.99\n");
    folder.write("tr.obj", "mtllib tr.mtl" + wall.substr(12)), folder.write("tr.mtl", "newmtl pane\nTr 0.01\n");
    folder.write("native.json", R"({"camera": {"eye": [0, 0, 3], "target": [0, 0, 0]}, "lights": [{"type": "point",
        "position": [0, 5, 0]}], "materials": {"pane": {"opacity": 0.99}}, "objects": [{"name": "wall", "type": "box",
        "size": [1, 1, 1], "material": "pane"}]})");
    folder.write("blend.gltf",
                 R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}], "materials": [{"name": "pane",
        "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.99]}}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
        "max": [1, 1, 0]}], "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri":
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    folder.write("fill.nff",
                 "v\nfrom 0 0 3\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 8 8\nl 0 5 0\n"
                 "f 1 1 1 1 0 1 0.01 1\np 3\n0 0 0\n1 0 0\n0 1 0\n");
    for (const char* name : {"d.obj", "tr.obj", "native.json", "blend.gltf", "fill.nff"}) {
        const Scene scene = load_scene(folder.path() / name);
        std::vector<std::string> said;
        for (const std::string& warning : scene.warnings)
            if (warning.find("is not computed") != std::string::npos ||
                warning.find("are not computed") != std::string::npos)
                said.push_back(warning);
        ASSERT_EQ(said.size(), 1u) << name << ": " << fmt::format("{}", fmt::join(scene.warnings, "\n"));
        EXPECT_NE(said[0].find("opaque"), std::string::npos) << name << ": " << said[0];
        EXPECT_NE(said[0].find("shadow"), std::string::npos) << name << ": " << said[0];
    }
}

TEST(LoadScene, UnknownEndingsNameTheKnownOnes) {
    EXPECT_EQ(message_of("a/scene.blend"),
              "a/scene.blend: unknown ending \".blend\" (known: .json .gltf .glb .obj .nff .ply .off .stl)");
    EXPECT_NE(message_of("scene").find("scene: no ending"), std::string::npos);
    EXPECT_NE(message_of("").find("no ending"), std::string::npos);
}

TEST(LoadScene, EndingsAreReadInAnyCase) {
    const TemporaryFolder folder;
    EXPECT_EQ(message_of(folder.write("A.JSON", "{}")), "loaded");
}

TEST(LoadScene, FilesThatCannotBeReadSayWhy) {
    const TemporaryFolder folder;
    EXPECT_NE(message_of(folder.path() / "none.json").find("none.json: no such file"), std::string::npos);
    std::filesystem::create_directories(folder.path() / "folder.json");
    EXPECT_NE(message_of(folder.path() / "folder.json").find("is a folder"), std::string::npos);
    std::filesystem::create_symlink("/dev/zero", folder.path() / "endless.json");
    EXPECT_NE(message_of(folder.path() / "endless.json").find("is a device, expected a file"), std::string::npos);
    const auto large = folder.write("large.json", "{");
    std::filesystem::resize_file(large, std::uintmax_t{1} << 34);  // takes no room on the disk
    EXPECT_NE(message_of(large).find("larger than 128 MB"), std::string::npos);
}

/// A pipe that nobody writes to: opening it would wait for ever. Also by a link, and as a file that another one names.
TEST(LoadScene, PipesAndDevicesAreRefused) {
    const TemporaryFolder folder;
    const auto pipe = folder.path() / "pipe.obj";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::filesystem::create_symlink(pipe, folder.path() / "link.ply");
    std::filesystem::create_symlink("/dev/zero", folder.path() / "zero.stl");
    for (const char* name : {"pipe.obj", "link.ply", "zero.stl"})
        EXPECT_NE(message_of(folder.path() / name).find("expected a file"), std::string::npos) << name;
    for (const char* ending : {"gltf", "glb", "nff", "off", "json"}) {
        const auto other = folder.path() / (std::string("other.") + ending);
        ASSERT_EQ(::mkfifo(other.c_str(), 0600), 0);
        EXPECT_NE(message_of(other).find("is a pipe"), std::string::npos) << ending;
    }
    const auto scene = folder.write("scene.json", R"({"objects": [{"type": "mesh", "file": "pipe.obj"}]})");
    EXPECT_NE(message_of(scene).find("is a pipe"), std::string::npos);
    const auto mesh = folder.write("mesh.obj", "mtllib pipe.obj\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(message_of(mesh), "loaded") << "with a warning that the materials are not there";
}

/// Messages go to terminals and into JSON.
TEST(LoadScene, MessagesShowNoBytesThatAreNoText) {
    const TemporaryFolder folder;
    const std::string message = message_of(folder.write("a.off", "OFF \xff\xc3(\xe2\x82 \xc2\x9b\x1b[31m \xc3\xa4\n"));
    EXPECT_NE(message.find("1 | OFF ?"
                           "?(?"
                           "? "),
              std::string::npos)
        << message;
    EXPECT_NE(message.find("\xc3\xa4"), std::string::npos) << message;
    for (const char* bad : {"\xff", "\x1b", "\xc2\x9b"}) EXPECT_EQ(message.find(bad), std::string::npos) << message;
}

/// Lines end at LF, CR LF or CR: line, column and the line shown are the same.
TEST(LoadScene, MessagesCountLinesOfAllKinds) {
    const TemporaryFolder folder;
    for (const std::string& end : std::vector<std::string>{"\n", "\r\n", "\r"}) {
        const std::string message = message_of(folder.write("a.off", "OFF" + end + "1 1 0" + end + "0 0 zero" + end));
        EXPECT_NE(message.find("a.off:3:5: "), std::string::npos) << message;
        EXPECT_NE(message.find("\n  3 | 0 0 zero\n"), std::string::npos) << message;
    }
}

TEST(CompleteScene, NamesAndSource) {
    const Scene s = finish(with_box(), "folder/made.obj");
    EXPECT_EQ(s.name, "made");
    EXPECT_EQ(s.title, "made");
    EXPECT_EQ(s.source, "folder/made.obj");
    EXPECT_TRUE(s.warnings.empty());
}

TEST(CheckScene, NumbersThatAreNoneAreRefused) {
    for (const float bad : {kInfinity, -kInfinity, std::nanf(""), 1.5e18f}) {
        SceneFile read            = with_box();
        read.scene.positions[3].y = bad;
        EXPECT_NE(refusal(read).find("folder/made.obj: a vertex at"), std::string::npos) << bad;
        read                    = with_box();
        read.scene.camera.eye.x = bad;
        EXPECT_NE(refusal(read).find("camera"), std::string::npos) << bad;
        read                            = with_box();
        read.scene.lights[0].position.z = bad;
        EXPECT_NE(refusal(read).find("light \"\": position"), std::string::npos) << bad;
        read                          = with_box();
        read.scene.materials[0].k_d.g = bad;
        EXPECT_NE(refusal(read).find("k_d"), std::string::npos) << bad;
    }
    SceneFile read          = with_box();
    read.scene.normals[0].x = kInfinity;
    EXPECT_NE(refusal(read).find("a vertex normal"), std::string::npos);
}

TEST(CheckScene, IndicesOutOfRangeAreRefused) {
    SceneFile read            = with_box();
    read.scene.triangles[2].z = 8;
    EXPECT_NE(refusal(read).find("there are 8, counted from 0"), std::string::npos) << refusal(read);
}

TEST(CompleteScene, NormalsBecomeUnit) {
    SceneFile read        = with_box();
    read.scene.normals[0] = {0, 3e-30f, 4e-30f};
    read.scene.normals[1] = {0, 0, 0};
    const Scene s         = finish(std::move(read));
    EXPECT_NEAR(s.normals[0].y, 0.6, 1e-6);
    EXPECT_EQ(s.normals[1], vec3(0)) << "zero means the face normal";
}

TEST(CheckScene, CamerasThatCannotSeeAreRefused) {
    SceneFile read           = with_box();
    read.scene.camera.target = read.scene.camera.eye;
    EXPECT_NE(refusal(read).find("eye and target are the same point"), std::string::npos);
    read                 = with_box();
    read.scene.camera.up = read.scene.camera.target - read.scene.camera.eye;
    EXPECT_NE(refusal(read).find("parallel"), std::string::npos);
    read                    = with_box();
    read.scene.camera.fov_y = 180;
    EXPECT_NE(refusal(read).find("fov is 180"), std::string::npos);
    read             = with_box();
    read.scene.width = 1 << 20;
    EXPECT_NE(refusal(read).find("the picture is 1048576 x 360"), std::string::npos);
}

TEST(CheckScene, LightsThatCannotShineAreRefused) {
    const auto with = [](auto change) {
        SceneFile read = with_box();
        change(read.scene.lights[0]);
        return refusal(std::move(read));
    };
    EXPECT_NE(with([](Light& l) { l.attenuation = {0, 0, 0, true}; }).find("divides by zero"), std::string::npos);
    EXPECT_NE(with([](Light& l) { l.diffuse.r = -1; }).find("diffuse is (-1, 1, 1)"), std::string::npos);
    EXPECT_NE(with([](Light& l) { l.kind = LightKind::sphere; }).find("radius is 0"), std::string::npos);
    EXPECT_NE(with([](Light& l) { l.kind = LightKind::directional, l.direction = vec3(0); }).find("direction is"),
              std::string::npos);
    EXPECT_NE(with([](Light& l) { l.kind = LightKind::rectangle, l.edge_v = l.edge_u; }).find("span no area"),
              std::string::npos);
    EXPECT_NE(with([](Light& l) { l.kind = LightKind::spot, l.spot.cutoff = 2; }).find("half angle"),
              std::string::npos);
    EXPECT_NE(with([](Light& l) {
                  l.kind = LightKind::spot, l.spot.falloff = SpotFalloff::smooth, l.spot.inner = 1;
              }).find("inner"),
              std::string::npos);
    EXPECT_NE(with([](Light& l) { l.range = -1; }).find("range is -1"), std::string::npos);
    EXPECT_EQ(with([](Light& l) { l.kind = LightKind::spot, l.spot.cutoff = float(kPi / 2); }), "accepted");
}

TEST(CompleteScene, LightsThatCannotBeSeenWarn) {
    const auto warnings_of = [](auto change) {
        SceneFile read            = with_box();  // of size 1, lit from 5 above by 1 of intensity, without attenuation
        read.scene.ambient        = vec3(0);
        Light other               = read.scene.lights[0];
        read.scene.lights[0].name = "lamp";
        other.name                = "other";
        change(read.scene, other);
        read.scene.lights.push_back(other);
        return finish(std::move(read)).warnings;
    };
    const std::vector<std::string> faint = warnings_of([](Scene&, Light& l) { l.diffuse = vec3(0.0005f); });
    ASSERT_EQ(faint.size(), 1u);
    EXPECT_EQ(
        faint[0],
        "Light \"other\" cannot be seen: it adds at most 0.05 % of what light \"lamp\" gives at the middle of the "
        "scene.");
    const auto far = [](Scene&, Light& l) { l.attenuation = {0, 0, 1, false}, l.position = {0, 100, 0}; };
    EXPECT_EQ(warnings_of(far).size(), 1u) << "1 / 99.5^2";
    const auto out_of_range = [](Scene&, Light& l) { l.range = 4.4f; };
    EXPECT_EQ(warnings_of(out_of_range).size(), 1u) << "the box begins at 4.5";
    const auto ambient = [](Scene& s, Light&) { s.ambient = vec3(0.0005f); };
    ASSERT_EQ(warnings_of(ambient).size(), 1u);
    EXPECT_NE(warnings_of(ambient)[0].find("The ambient light of 0.0005"), std::string::npos);

    EXPECT_TRUE(warnings_of([](Scene&, Light& l) { l.diffuse = vec3(0.002f); }).empty());
    EXPECT_TRUE(warnings_of([](Scene&, Light& l) { l.range = 4.6f; }).empty()) << "reaches the lid";
    EXPECT_TRUE(warnings_of([](Scene&, Light& l) { l.diffuse = l.specular = vec3(0); }).empty()) << "switched off";
    EXPECT_TRUE(warnings_of([](Scene&, Light& l) { l.diffuse = vec3(1, 0, 0) * 0.0005f, l.ambient = vec3(1); }).empty())
        << "seen by its ambient term";
    EXPECT_TRUE(warnings_of([](Scene&, Light& l) {
                    l.kind = LightKind::spot, l.spot.cutoff = 0.1f, l.direction = {1, 0, 0};
                }).empty())
        << "a narrow cone between the samples is not an error";
}

TEST(CompleteScene, DirectionsOfAnyLengthAreScaledWithoutRounding) {
    SceneFile read                 = with_box();
    read.scene.lights[0].kind      = LightKind::directional;
    read.scene.lights[0].direction = {3e-38f, -7e-38f, 1e-38f};
    const Scene s                  = finish(std::move(read));
    const vec3 d                   = s.lights[0].direction;
    EXPECT_EQ(d.x / d.y, 3e-38f / -7e-38f);
    EXPECT_TRUE(std::abs(d.y) >= 0.5f && std::abs(d.y) < 1);
}

TEST(CompleteScene, DefaultCameraFramesTinyHugeAndFlatScenes) {
    for (const vec3 scale : {vec3(1e-12f), vec3(1e15f), vec3(1, 0, 1), vec3(1, 100, 1), vec3(100, 1, 1)}) {
        SceneFile read  = with_box();
        read.has_camera = false;
        for (vec3& p : read.scene.positions) p *= scale;
        const Scene s       = finish(std::move(read));
        const CameraFrame f = frame(s.camera, s.width, s.height);
        double widest       = 0;
        for (const vec3 p : s.positions) {
            const dvec3 q = f.project(dvec3(p));
            ASSERT_GT(q.z, 0);
            widest = std::max({widest, std::abs(q.x / s.width * 2 - 1), std::abs(q.y / s.height * 2 - 1)});
        }
        EXPECT_LT(widest, 1) << "cut off";
        EXPECT_GT(widest, 0.2) << "lost in the distance";
    }
}

}  // namespace
}  // namespace umbra
