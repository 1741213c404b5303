// Scenes far from their file's origin: read as their twins at the origin, bit for bit, with Scene::origin between them.
#include <fmt/format.h>

#include "umbra/core/io/reading.h"
#include "umbra/core/io/scene_writer.h"
#include "umbra/tests/support/scene_files.h"

namespace umbra {
namespace {

/// A point of a file whose origin is `o` away.
std::string point(dvec3 o, double x, double y, double z) { return fmt::format("{} {} {}", o.x + x, o.y + y, o.z + z); }
std::string vector(dvec3 o, double x, double y, double z) {
    return fmt::format("[{}, {}, {}]", o.x + x, o.y + y, o.z + z);
}

/// Everything of a scene and of its twin is equal, except for their positions and the warnings about them.
void expect_twins(Scene afar, const Scene& here, dvec3 offset) {
    EXPECT_EQ(here.origin, dvec3(0));
    EXPECT_EQ(afar.origin, offset);
    EXPECT_TRUE(warns(afar, fmt::format("relative to ({}, {}, {}) of the file", offset.x, offset.y, offset.z)));
    EXPECT_FALSE(warns(here, "relative to"));
    afar.origin = dvec3(0);
    EXPECT_EQ(native_text(afar), native_text(here));
}

TEST(FarScenes, OriginIsWholeAndOnlyWhereItIsNeeded) {
    const auto around = [](dvec3 middle, double half) {
        return local_origin(middle - dvec3(half, 0, 0), middle + dvec3(half, 0, 0));
    };
    EXPECT_EQ(around({64, 0, 0}, 0.5), dvec3(0));  // 64 diagonals away: not farther
    EXPECT_EQ(around({65, 0, 0}, 0.5), dvec3(65, 0, 0));
    EXPECT_EQ(around({0, -65, 64}, 0.5), dvec3(0, -65, 0));
    EXPECT_EQ(around({-569234, 5929481, 9}, 6), dvec3(-569200, 5929500, 0));  // 12 wide: multiples of 100
    EXPECT_EQ(around({1, 0, 0}, 0x1p-11), dvec3(1, 0, 0));                    // 2^-10 wide: multiples of it
    EXPECT_EQ(around({1e9, 0, 0}, 0), dvec3(1e9, 0, 0));
    EXPECT_EQ(local_origin(Box{}), dvec3(0));
}

/// The same triangles in each format of meshes.
std::string mesh_text(const std::string& ending, dvec3 o) {
    const std::vector<std::string> points{point(o, -6, -6, 9.125), point(o, 6, -6, 9.125), point(o, 6, 6, 9.125),
                                          point(o, -3.0625, -0.03125, 9.5), point(o, -3.0625, 0.046875, 10.75)};
    const std::vector<uvec3> faces{{0, 1, 2}, {3, 4, 2}};
    std::string all, ring;
    for (const std::string& p : points) all += (ending == "obj" ? "v " : "") + p + "\n";
    for (const uvec3& f : faces) {
        if (ending == "obj") ring += fmt::format("f {} {} {}\n", f.x + 1, f.y + 1, f.z + 1);
        if (ending == "off" || ending == "ply") ring += fmt::format("3 {} {} {}\n", f.x, f.y, f.z);
        if (ending == "nff") ring += fmt::format("p 3\n{}\n{}\n{}\n", points[f.x], points[f.y], points[f.z]);
        if (ending == "stl")
            ring += fmt::format("facet normal 0 0 0 outer loop vertex {} vertex {} vertex {} endloop endfacet\n",
                                points[f.x], points[f.y], points[f.z]);
    }
    if (ending == "obj") return all + ring;
    if (ending == "off") return "OFF\n5 2 0\n" + all + ring;
    if (ending == "stl") return "solid s\n" + ring + "endsolid s\n";
    if (ending == "nff")
        return fmt::format(
                   "v\nfrom {}\nat {}\nup 0 0 1\nangle 40\nhither 1\nresolution 80 60\nl {}\nf 1 1 1 1 0 0 0 1\n",
                   point(o, 0, -40, 30), point(o, 0, 0, 9), point(o, 5, 5, 50)) +
               ring +
               fmt::format("s {} 0.5\nc {} 1\n{} 0.25\n", point(o, 2, 2, 10), point(o, 4, 2, 9), point(o, 4, 2, 11));
    return "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\n"
           "element face 2\nproperty list uchar int vertex_indices\nend_header\n" +
           all + ring;
}

TEST(FarScenes, EveryFormatOfMeshesEqualsItsTwin) {
    const TemporaryFolder folder;
    const dvec3 offset(569000, 5929000, 0);
    for (const std::string ending : {"obj", "off", "ply", "stl", "nff"}) {
        const Scene here = load_scene(folder.write("here/a." + ending, mesh_text(ending, dvec3(0))));
        const Scene afar = load_scene(folder.write("afar/a." + ending, mesh_text(ending, offset)));
        SCOPED_TRACE(ending);
        expect_twins(afar, here, offset);
        EXPECT_EQ(afar.positions[0], vec3(-6, -6, 9.125f));
    }
}

TEST(FarScenes, BinaryPlyInDoubleIsNotRounded) {
    const auto text = [](dvec3 o) {
        std::string s =
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty "
            "double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
        const auto put = [&](auto x) { s += std::string(reinterpret_cast<const char*>(&x), sizeof(x)); };
        for (const dvec3 p : {dvec3(0), dvec3(1, 0.0625, 0), dvec3(0, 1, 0.03125)})
            for (int k = 0; k < 3; ++k) put(o[k] + p[k]);
        put(std::uint8_t{3});
        for (const int i : {0, 1, 2}) put(i);
        return s;
    };
    const TemporaryFolder folder;
    const dvec3 offset(0, -7000000, 3000000);
    expect_twins(load_scene(folder.write("afar/a.ply", text(offset))),
                 load_scene(folder.write("here/a.ply", text(dvec3(0)))), offset);
}

TEST(FarScenes, WhatFloatsSqueezeToAPointIsFoundAgain) {
    // Floats at 3e9 are 256 apart.
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write(
        "a.obj", "v 3000000000 0 0\nv 3000000001 0 0\nv 3000000000 1 0\nv 3000000000 0.25 1\nf 1 2 3\nf 1 2 4\n"));
    EXPECT_FALSE(warns(scene, "no area"));
    EXPECT_EQ(scene.origin + dvec3(scene.positions[1]), dvec3(3000000001, 0, 0));
    EXPECT_EQ(bounds(scene).size(), vec3(1));
}

std::string native(dvec3 o, const std::string& more = "") {
    return fmt::format(
        R"({{"camera": {{"eye": {}, "target": {}}},
            "lights": [{{"name": "sun", "type": "directional", "direction": [0.5, -1, -0.3]}},
                {{"name": "lamp", "type": "point", "position": {}}},
                {{"name": "round", "type": "point", "position": {}, "target": {},
                  "distribution": {{"vertical": [0, 90], "candela": [[1, 0]]}}}},
                {{"name": "held", "type": "spot", "position": [0, 1, 0], "target": [0.25, 0, -4], "fixed_to": "camera"}},
                {{"name": "spot", "type": "spot", "position": {}, "target": {}}},
                {{"name": "window", "type": "rectangle", "size": [1, 2], "position": {}, "target": {}}},
                {{"name": "dish", "type": "disk", "radius": 1, "position": {}, "target": {}}},
                {{"name": "ball", "type": "sphere", "radius": 1, "position": {}}}],
            "objects": [{{"name": "floor", "type": "plane", "size": 20, "transform": [{{"translate": {}}}]}},
                {{"name": "box", "type": "box", "size": [2, 3, 2],
                  "transform": [{{"rotate_y": 30}}, {{"translate": {}}}]}},
                {{"name": "tent", "type": "triangles", "positions": [{}, {}, {}], "triangles": [[0, 1, 2]]}},
                {{"name": "turned", "type": "triangles", "positions": [{}, {}, {}], "triangles": [[0, 1, 2]],
                  "transform": [{{"scale": [1, 2, 1]}}]}}]{}}})",
        vector(o, 6, 7, 9), vector(o, 0, 1, 0), vector(o, 1, 5, 2), vector(o, 2, 5, 2), vector(o, 1.5, 0, 2),
        vector(o, -2, 5, 2), vector(o, 0, 0.25, 0), vector(o, -1, 6, 0), vector(o, 0.75, 0, 0), vector(o, 3, 6, 0),
        vector(o, 2, 0, 0.5), vector(o, 3, 6, 4), vector(o, 0, 0, 0), vector(o, 0.25, 1.5, 0.125), vector(o, 3, 0, 3),
        vector(o, 4.0625, 0, 3), vector(o, 3, 1.03125, 3), vector(o, -3, 0, 3), vector(o, -2.0625, 0, 3),
        vector(o, -3, 1.03125, 3), more);
}

TEST(FarScenes, NativeScenesMoveWithLightsAndCamera) {
    const TemporaryFolder folder;
    const dvec3 offset(5000000, 0, -3000000);
    const Scene here = load_scene(folder.write("here/a.json", native(dvec3(0))));
    const Scene afar = load_scene(folder.write("afar/a.json", native(offset)));
    expect_twins(afar, here, offset);
    EXPECT_EQ(afar.camera.eye, vec3(6, 7, 9));
    EXPECT_EQ(afar.lights[1].position, vec3(1, 5, 2));
}

TEST(FarScenes, FramesShareTheOriginOfTheRestingScene) {
    const TemporaryFolder folder;
    const dvec3 offset(5000000, 0, -3000000);
    const auto animated = [](dvec3 o) {
        return native(o, fmt::format(
                             R"(, "animation": {{"frames": 5,
                "camera": {{"keys": [{{"frame": 0, "eye": {}}}, {{"frame": 4, "eye": {}, "target": {}}}]}},
                "lights": {{"lamp": {{"keys": [{{"frame": 0, "position": {}}}, {{"frame": 4, "position": {}}}]}}}},
                "objects": {{"box": {{"keys": [{{"frame": 0, "turn": 0}}, {{"frame": 4, "turn": 90, "move": [60000, 0, 0]}}]}}}}}})",
                             vector(o, 6, 7, 9), vector(o, -6, 7, 9), vector(o, 0, 2, 0), vector(o, 1, 5, 2),
                             vector(o, 3, 5, 2)));
    };
    const std::string here = folder.write("here/a.json", animated(dvec3(0))).string();
    const std::string afar = folder.write("afar/a.json", animated(offset)).string();
    for (const std::string frame : {"@0", "@1", "@4"}) {
        SCOPED_TRACE(frame);
        expect_twins(load_scene(afar + frame), load_scene(here + frame), offset);
    }
}

TEST(FarScenes, WhatOnlyFloatsTakeForOnePointIsNoFault) {
    // Floats at 3e9 are 256 apart: eye and target, lamp and target, both ends of a cylinder.
    const TemporaryFolder folder;
    const dvec3 offset(3000000000, 0, 0);
    expect_twins(load_scene(folder.write("afar/a.json", native(offset))),
                 load_scene(folder.write("here/a.json", native(dvec3(0)))), offset);
    const auto cylinder = [](dvec3 o) {
        return fmt::format("c {} 1\n{} 1\n", point(o, -0.125, 0, 0), point(o, 0.125, 0, 0));
    };
    expect_twins(load_scene(folder.write("afar/c.nff", cylinder(offset))),
                 load_scene(folder.write("here/c.nff", cylinder(dvec3(0)))), offset);
}

TEST(FarScenes, GltfNodesMoveMeshesLightsAndCamera) {
    const auto text = [](dvec3 o) {
        return fmt::format(
            R"({{"asset": {{"version": "2.0"}}, "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "point"}}, {{"type": "spot", "spot": {{}}}}]}}}},
            "scenes": [{{"nodes": [0, 1]}}], "scene": 0,
            "nodes": [{{"translation": {}, "children": [2, 3, 4, 5]}}, {{"mesh": 0, "name": "root", "translation": {}}},
                {{"mesh": 0, "name": "leaf", "translation": [2.0625, 0, 0], "rotation": [0, 0.6, 0, 0.8], "scale": [9, 9, 9]}},
                {{"camera": 0, "translation": [0, 0.03125, 20]}},
                {{"translation": [1, 4, 0], "extensions": {{"KHR_lights_punctual": {{"light": 1}}}}}},
                {{"translation": [0, 5, 0.5], "extras": {{"umbra": {{"light": {{"type": "disk", "radius": 1}}}}}}}}],
            "cameras": [{{"type": "perspective", "perspective": {{"yfov": 1, "znear": 0.1}}}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "buffers": [{{"byteLength": 36, "uri":
                "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}]}})",
            vector(o, 0, 0, 0), vector(o, -3.0625, 0, 0));
    };
    const TemporaryFolder folder;
    const dvec3 offset(5000000, 0, -3000000);
    const Scene here = load_scene(folder.write("here/a.gltf", text(dvec3(0))));
    const Scene afar = load_scene(folder.write("afar/a.gltf", text(offset)));
    expect_twins(afar, here, offset);
    EXPECT_EQ(afar.lights.size(), 2u);
    EXPECT_EQ(afar.camera.eye, vec3(0, 0.03125f, 20));
}

TEST(FarScenes, AFarMeshFileMayBePlacedNearOrLeftFar) {
    const TemporaryFolder folder;
    const dvec3 offset(569000, 5929000, 0);
    const auto scene = [](const std::string& file, const std::string& transform) {
        return fmt::format(R"({{"objects": [{{"type": "mesh", "file": "{}"{}}}]}})", file, transform);
    };
    (void)folder.write("near.obj", mesh_text("obj", dvec3(0)));
    (void)folder.write("afar.obj", mesh_text("obj", offset));
    const Scene here = load_scene(folder.write("a.json", scene("near.obj", "")));
    const Scene back = load_scene(
        folder.write("a.json", scene("afar.obj", R"(, "transform": [{"translate": [-569000, -5929000, 0]}])")));
    EXPECT_EQ(back.origin, dvec3(0));
    EXPECT_EQ(back.positions, here.positions);
    const Scene afar = load_scene(folder.write("a.json", scene("afar.obj", "")));
    EXPECT_EQ(afar.origin, offset);
    EXPECT_EQ(afar.positions, here.positions);
    const auto fitted = [&](const std::string& file) {
        return load_scene(folder.write("a.json", scene(file, R"(, "transform": [{"fit": 3}])"))).positions;
    };
    EXPECT_EQ(fitted("afar.obj"), fitted("near.obj"));
}

TEST(FarScenes, AWrittenSceneKeepsItsOriginAndItsFloats) {
    const TemporaryFolder folder;
    Scene scene;
    scene.materials.push_back({.name = "grey"});
    add_object(scene, "far", {vec3(1e7f, 0, 0), vec3(1e7f + 4, 0, 0), vec3(1e7f, 3, 0)}, {}, {uvec3(0, 1, 2)}, 0);
    scene.camera.eye = vec3(1e7f, 0, 9);
    const Scene raw  = load_scene(folder.write("raw.json", native_text(scene)));
    EXPECT_EQ(raw.positions, scene.positions);
    EXPECT_EQ(raw.origin, dvec3(0));
    EXPECT_FALSE(warns(raw, "relative to"));

    const dvec3 offset(5000000, 0, -3000000);
    const Scene afar  = load_scene(folder.write("afar.json", native(offset)));
    const Scene again = load_scene(folder.write("again.json", native_text(afar)));
    EXPECT_EQ(again.origin, offset);
    EXPECT_EQ(again.positions, afar.positions);
    EXPECT_EQ(again.camera.eye, afar.camera.eye);
}

constexpr std::string_view kUprightStl =
    "solid s\nfacet normal 0 0 0 outer loop vertex 1 2 3 vertex 4 2 3 vertex 1 5 7 endloop endfacet\nendsolid s\n";
constexpr std::string_view kUprightPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
    "nx\nproperty float ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "1 2 3 0 1 0\n4 2 3 0 1 0\n1 5 7 0 1 0\n3 0 1 2\n";

TEST(UpAxis, MeshFilesAreTurnedByTradingCoordinates) {
    const TemporaryFolder folder;
    const std::vector<std::pair<std::string, std::string>> files{
        {"part.obj", "v 1 2 3\nv 4 2 3\nv 1 5 7\nvn 0 1 0\nf 1//1 2//1 3//1\n"},
        {"part.stl", std::string(kUprightStl)},
        {"part.ply", std::string(kUprightPly)},
        {"part.off", "NOFF\n3 1 0\n1 2 3 0 1 0\n4 2 3 0 1 0\n1 5 7 0 1 0\n3 0 1 2\n"}};
    for (const auto& [name, text] : files) {
        SCOPED_TRACE(name);
        const std::string file = folder.write(name, text).string();
        const auto corners     = [&](const std::string& tail) { return load_scene(file + tail).positions; };
        using Corners          = std::vector<vec3>;
        EXPECT_EQ(corners(""), (Corners{{1, 2, 3}, {4, 2, 3}, {1, 5, 7}}));
        EXPECT_EQ(corners("@y"), corners(""));
        EXPECT_EQ(corners("@z"), (Corners{{1, 3, -2}, {4, 3, -2}, {1, 7, -5}}));
        EXPECT_EQ(corners("@-y"), (Corners{{1, -2, -3}, {4, -2, -3}, {1, -5, -7}}));
        const Scene z = load_scene(file + "@z");
        EXPECT_EQ(z.name, "part");
        EXPECT_EQ(z.source, std::filesystem::path(file).generic_string() + "@z");
        EXPECT_EQ(z.normals[0], name == "part.stl" ? vec3(0) : vec3(0, 0, -1));
    }
    // A file of the whole name is that file.
    EXPECT_EQ(load_scene(folder.write("part@z.obj", "v 1 2 3\nv 4 2 3\nv 1 5 7\nf 1 2 3\n")).positions[0],
              vec3(1, 2, 3));
}

TEST(UpAxis, FarFilesStandBeforeTheyMove) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.obj", mesh_text("obj", dvec3(569000, 5929000, 0))).string() + "@z");
    EXPECT_EQ(scene.origin, dvec3(569000, 0, -5929000));
    EXPECT_EQ(scene.positions[0], vec3(-6, 9.125f, 6));
}

TEST(UpAxis, NativeScenesSayItOfEachMeshFile) {
    const TemporaryFolder folder;
    (void)folder.write("part.obj", "v 1 2 3\nv 4 2 3\nv 1 5 7\nf 1 2 3\n");
    const auto file = folder.write("a.json", R"({"objects": [
        {"type": "mesh", "file": "part.obj", "up": "z"}, {"type": "mesh", "file": "part.obj"},
        {"type": "mesh", "file": "part.obj", "up": "-y"}]})");
    const Scene s   = load_scene(file);
    EXPECT_EQ(s.positions[0], vec3(1, 3, -2));
    EXPECT_EQ(s.positions[3], vec3(1, 2, 3));
    EXPECT_EQ(s.positions[6], vec3(1, -2, -3));
}

TEST(UpAxis, FilesThatSayItThemselvesAreRefused) {
    const TemporaryFolder folder;
    const auto native_file = folder.write("a.json", R"({"objects": [{"type": "box"}]})");
    EXPECT_NE(refusal(native_file.string() + "@z").find("expected a mesh file (.obj .ply .off .stl)"),
              std::string::npos);
    EXPECT_NE(refusal(folder.write("b.json", R"({"objects": [{"type": "mesh", "file": "c.gltf", "up": "z"}]})"))
                  .find("up is for files that do not say it themselves (.obj .ply .off .stl)"),
              std::string::npos);
    EXPECT_NE(refusal(folder.write("c.json", R"({"objects": [{"type": "mesh", "file": "c.obj", "up": "w"}]})"))
                  .find("unknown up \"w\""),
              std::string::npos);
}

}  // namespace
}  // namespace umbra
