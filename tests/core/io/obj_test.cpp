#include <algorithm>

#include "umbra/tests/support/scene_files.h"

namespace umbra {
namespace {

const std::string kBox =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

float area_of(const Scene& scene) {
    double sum = 0;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) sum += glm::length(area_normal(scene, t)) / 2;
    return static_cast<float>(sum);
}

TEST(Obj, BoxOfQuads) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("box.obj", kBox));
    expect_sound(scene);
    EXPECT_EQ(scene.triangles.size(), 12u);
    EXPECT_EQ(scene.positions.size(), 8u);
    EXPECT_FLOAT_EQ(area_of(scene), 24);
    EXPECT_EQ(scene.objects.at(0).name, "box");
    for (TriangleId t = 0; t < 12; ++t) {  // outwards
        const dvec3 middle = dvec3(scene.vertex(t, 0) + scene.vertex(t, 1) + scene.vertex(t, 2));
        EXPECT_GT(glm::dot(area_normal(scene, t), middle), 0) << t;
    }
    EXPECT_TRUE(warns(scene, "no camera"));
    EXPECT_TRUE(warns(scene, "no light"));
}

TEST(Obj, NoFinalNewlineCarriageReturnsCommentsAndContinuedLines) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(
        folder.write("t.obj", "# first\r\nv 0 0 0 # origin\r\nv \\\r\n 1 0 0\r\n\r\n  v 0 +1 0e0 1.0\r\nf 1 2 3"));
    ASSERT_EQ(scene.triangles.size(), 1u);
    EXPECT_EQ(scene.vertex(0, 1), vec3(1, 0, 0));
    EXPECT_EQ(scene.vertex(0, 2), vec3(0, 1, 0));
}

TEST(Obj, IndicesCountBackwardsAndForwards) {
    const TemporaryFolder folder;
    const Scene scene =
        load_scene(folder.write("t.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -4 2 3\n"));
    ASSERT_EQ(scene.triangles.size(), 3u);
    for (TriangleId t = 0; t < 3; ++t) EXPECT_EQ(scene.vertex(t, 0), vec3(0)) << t;
    EXPECT_EQ(scene.positions.size(), 3u) << "the fourth is used by no face";
}

TEST(Obj, PositionsAreSplitWhereNormalsDiffer) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("t.obj",
                                                "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 2\nvn 1 0 0\nvn 0 0 0\n"
                                                "f 1//1 2//1 3//1\nf 1//2 3//2 4//3\nf 1 4 2\n"));
    EXPECT_EQ(scene.positions.size(), 9u);
    EXPECT_EQ(scene.normals[scene.triangles[0].x], vec3(0, 0, 1)) << "made a unit vector";
    EXPECT_EQ(scene.normals[scene.triangles[1].x], vec3(1, 0, 0));
    EXPECT_EQ(scene.normals[scene.triangles[1].z], vec3(0)) << "zero: the face normal";
    EXPECT_EQ(scene.normals[scene.triangles[2].x], vec3(0));
}

/// "v//" and "v/t/", as some exporters write corners without a normal.
TEST(Obj, CornersWithAnEmptyNormalHaveNone) {
    const TemporaryFolder folder;
    const Scene scene =
        load_scene(folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1// 2// 3//\nf 1/1/ 2/1/ 3/1/\n"));
    ASSERT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(scene.positions.size(), 3u);
    for (const vec3 normal : scene.normals) EXPECT_EQ(normal, vec3(0));
}

TEST(Obj, NumbersTooNearToZeroAreZero) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(
        folder.write("t.obj", "v 1e-999 -1e-400 0." + std::string(400, '0') + "1\nv 1 0 0\nv 0 1e-3 0\nf 1 2 3\n"));
    EXPECT_EQ(scene.vertex(0, 0), vec3(0));
}

TEST(Obj, SmoothingGroupsAverageNormals) {
    const TemporaryFolder folder;
    const Scene flat   = load_scene(folder.write("flat.obj", "s off\n" + kBox));
    const Scene smooth = load_scene(folder.write("smooth.obj", "s 1\n" + kBox));
    EXPECT_EQ(flat.normals[flat.triangles[0].x], vec3(0));
    const vec3 corner = smooth.vertex(0, 0), n = smooth.normals[smooth.triangles[0].x];
    EXPECT_NEAR(glm::dot(n, glm::normalize(corner)), 1, 1e-5) << "a cube's corner has the diagonal for a normal";
}

TEST(Obj, ConcavePolygonsKeepTheirArea) {
    const TemporaryFolder folder;
    // An L of area 3, whose corner 1 sees only half of it, in all three planes and both orientations.
    const std::vector<std::string> planes{"v {0} {1} 0\n", "v 0 {0} {1}\n", "v {1} 0 {0}\n"};
    for (const auto& plane : planes)
        for (const char* face : {"f 1 2 3 4 5 6\n", "f 6 5 4 3 2 1\n"}) {
            std::string text;
            for (const auto& [x, y] : std::vector<std::pair<int, int>>{{2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 0}})
                text += fmt::format(fmt::runtime(plane), x, y);
            const Scene scene = load_scene(folder.write("l.obj", text + face));
            EXPECT_EQ(scene.triangles.size(), 4u);
            EXPECT_FLOAT_EQ(area_of(scene), 3) << plane << face;
        }
}

TEST(Obj, PolygonsThatCrossThemselvesAreToldOf) {
    const TemporaryFolder folder;
    const Scene scene =
        load_scene(folder.write("bow.obj", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1.5 0\nv -1 2 0\nf 1 2 3 4 5\n"));
    EXPECT_EQ(scene.triangles.size(), 3u);
}

TEST(Obj, GroupsBecomeObjectsAndComeBack) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("g.obj",
                                                "v 0 0 0\nv 1 0 0\nv 0 1 0\no left\nf 1 2 3\no right wing\nf 1 2 3\n"
                                                "g tip\nf 1 2 3\nf 3 2 1\ng\no left\nf 1 2 3\nusemtl red\nf 1 2 3\n"));
    expect_sound(scene);
    ASSERT_EQ(scene.objects.size(), 4u);
    EXPECT_EQ(scene.objects[0].name, "left");
    EXPECT_EQ(scene.objects[0].triangle_count, 2u);
    EXPECT_EQ(scene.objects[1].name, "right wing");
    EXPECT_EQ(scene.objects[2].name, "right wing/tip");
    EXPECT_EQ(scene.objects[2].triangle_count, 2u);
    EXPECT_EQ(scene.materials[scene.objects[3].material].name, "red");
}

TEST(Obj, NormalsThatAreNotFiniteOrHaveNoLengthBecomeTheFaces) {
    const TemporaryFolder folder;
    const Scene scene =
        load_scene(folder.write("n.obj",
                                "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan 0 0\nvn 0 0 0\nvn 0 1e999 0\nvn 0 0 2\n"
                                "f 1//1 2//2 3//3\nf 1//4 2//4 3//4\n"));
    expect_sound(scene);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(scene.normals[scene.triangles[0][k]], vec3(0));
    for (int k = 0; k < 3; ++k) EXPECT_EQ(scene.normals[scene.triangles[1][k]], vec3(0, 0, 1));
    EXPECT_TRUE(warns(scene, "3 of 4 vertex normals are not finite or have no length"));
}

TEST(Obj, MaterialsOfTheMtlFile) {
    const TemporaryFolder folder;
    (void)folder.write(
        "sub/two words.mtl",
        "# all terms\nnewmtl full\nKa 0.1 0.2 0.3\nKd 0.4 0.5 0.6\nKs 0.3\nKe 1 2 3\nNs 33.5\nd 0.75\nNi 1.5\n"
        "illum 2\nmap_Kd -s 1 1 1 wood.png\n"
        "newmtl matte\nKd 0.25 0.25 0.25\nKs 1 1 1\nillum 1\n"
        "newmtl shadeless\nKd 0.5 0 0\nillum 0\n"
        "newmtl glass\nKd 0 0 0\nKs .5 .9 .5\nTr 0.8\nTf 1 0.5 2\nillum 7\n"
        "newmtl curve\nKd spectral file.rfl 1\nsharpness 60\n");
    std::string text = "mtllib two words.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (const char* name : {"full", "matte", "shadeless", "glass", "curve", "unknown"})
        text += fmt::format("usemtl {}\nf 1 2 3\n", name);
    const Scene scene = load_scene(folder.write("sub/m.obj", text));
    ASSERT_EQ(scene.materials.size(), 6u);
    const auto& full = scene.materials[0];
    EXPECT_EQ(full.k_a, vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(full.k_d, vec3(0.4f, 0.5f, 0.6f));
    EXPECT_EQ(full.k_s, vec3(0.3f));
    EXPECT_EQ(full.emission, vec3(1, 2, 3));
    EXPECT_EQ(full.shininess, 33.5f);
    EXPECT_EQ(full.opacity, 0.75f);
    EXPECT_EQ(full.index_of_refraction, 1.5f);
    EXPECT_EQ(full.reflect, 0);
    EXPECT_EQ(scene.materials[1].k_s, vec3(0));
    EXPECT_EQ(scene.materials[1].k_a, vec3(0.25f)) << "Ka where the file has none: Kd";
    EXPECT_EQ(scene.materials[2].emission, vec3(0.5f, 0, 0));
    EXPECT_EQ(scene.materials[2].k_d, vec3(0));
    EXPECT_FLOAT_EQ(scene.materials[3].transmit, 0.8f);
    EXPECT_EQ(scene.materials[3].reflect, 0.9f);
    EXPECT_EQ(scene.materials[3].transmit_colour, vec3(1, 0.5f, 1)) << "no more than all passes";
    EXPECT_EQ(scene.materials[0].transmit_colour, vec3(1));
    EXPECT_EQ(scene.ambient, vec3(0.1f));
    EXPECT_TRUE(warns(scene, "textures are ignored"));
    EXPECT_TRUE(warns(scene, "a spectral or CIE Kd is ignored"));
    EXPECT_TRUE(warns(scene, "\"sharpness\""));
    EXPECT_TRUE(warns(scene, "describes \"unknown\""));
    EXPECT_TRUE(warns(scene, "I_a = 0.1"));
}

TEST(Obj, SeveralMtlFilesOnOneLineAndMissingOnes) {
    const TemporaryFolder folder;
    (void)folder.write("a.mtl", "newmtl a\nKd 1 0 0\n");
    (void)folder.write("b.mtl", "newmtl b\nKd 0 1 0\n");
    const std::string faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n";
    const Scene both        = load_scene(folder.write("both.obj", "mtllib a.mtl b.mtl\n" + faces));
    EXPECT_EQ(both.materials[0].k_d, vec3(1, 0, 0));
    EXPECT_EQ(both.materials[1].k_d, vec3(0, 1, 0));
    const Scene none = load_scene(folder.write("none.obj", "mtllib c.mtl\n" + faces));
    EXPECT_TRUE(warns(none, "\"c.mtl\" does not exist"));
    EXPECT_EQ(none.materials[0].name, "a") << "names are kept";
    const Scene windows = load_scene(folder.write("windows.obj", "mtllib C:\\art\\a.mtl\n" + faces));
    EXPECT_EQ(windows.materials[0].k_d, vec3(1, 0, 0)) << "looked for beside the OBJ too";
}

TEST(Obj, MaterialFilesAreFoundAsTheyAreNamed) {
    const TemporaryFolder folder;
    (void)folder.write("my scene final.mtl", "newmtl red wall\nKd 1 0 0\n");
    (void)folder.write("sub/Other.MTL", "newmtl red wall\nKd 1 0 0\n");
    const std::string rest = "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red wall\nf 1 2 3\n";
    for (const char* library :
         {"my scene final.mtl", "my\\ scene\\ final.mtl", "\"my scene final.mtl\"", "My Scene Final.mtl",
          "\"MY SCENE FINAL.MTL\" # the materials", "my scene final.mtl # the materials", "sub/other.mtl",
          "sub\\Other.mtl", "\"my scene final.mtl\" sub/Other.MTL"}) {
        const Scene scene = load_scene(folder.write("a.obj", std::string("mtllib ") + library + rest));
        EXPECT_EQ(scene.materials.at(0).k_d, vec3(1, 0, 0)) << library;
        EXPECT_FALSE(warns(scene, "does not exist")) << library;
    }
    const Scene none = load_scene(folder.write("a.obj", "mtllib my\\ scene\\ final.mtl none.mtl" + rest));
    EXPECT_TRUE(warns(none, "the material file \"none.mtl\" does not exist"));
}

/// A # in a name is part of it, as 3ds Max has it ("Material #25"); behind a name that is known without, it is a
/// comment.
TEST(Obj, HashesInNames) {
    const TemporaryFolder folder;
    (void)folder.write("a.mtl",
                       "newmtl Material #25\nKd 1 0 0\nnewmtl Material #26\nKd 0 1 0\nnewmtl plain\nKd 0 0 1\n"
                       "newmtl noted # a comment\nKd 1 1 0\nnewmtl #1\nKd 0 1 1\nnewmtl Material\nKd 1 0 1\n");
    const std::string triangle = "\nf 1 2 3\n";
    const Scene scene          = load_scene(folder.write(
                 "a.obj", "mtllib a.mtl # materials\nv 0 0 0 # origin\nv 1 0 0\nv 0 1 0\no Box#1\nusemtl Material #25" +
                              triangle + "o Box#2\nusemtl Material #26" + triangle + "o Box #3\nusemtl plain # left" + triangle +
                              "usemtl plain # right" + triangle + "usemtl noted" + triangle + "usemtl #1" + triangle));
    ASSERT_EQ(scene.materials.size(), 5u);
    const std::vector<vec3> colours{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}};
    for (std::size_t m = 0; m < 5; ++m) EXPECT_EQ(scene.materials[m].k_d, colours[m]) << m;
    EXPECT_EQ(scene.objects.at(0).name, "Box#1");
    EXPECT_EQ(scene.objects.at(1).name, "Box#2");
    EXPECT_EQ(scene.objects.at(2).name, "Box #3");
}

TEST(Obj, CommasBetweenNumbers) {
    const TemporaryFolder folder;
    (void)folder.write("a.mtl", "newmtl m\nKd 0.5, 0.25, 1\nKs 0,1,0\n");
    for (const char* mesh : {"v 0,0,0\nv 2.5,0,0\nv 0,1,0\n", "v 0, 0, 0\nv 2.5, 0, 0\nv 0, 1, 0\n",
                             "v 0 ,0 ,0\nv 2.5 , 0 , 0\nv 0,1,0,\n", "v 0 0 0\nv 2.5 0 0\nv 0 1 0 # 0,1 0\n"})
        for (const char* face : {"f 1,2,3", "f 1, 2, 3", "f 1 2 3"}) {
            const Scene scene =
                load_scene(folder.write("a.obj", std::string("mtllib a.mtl\n") + mesh + "usemtl m\n" + face + "\n"));
            EXPECT_EQ(scene.vertex(0, 1), vec3(2.5f, 0, 0)) << mesh << face;
            EXPECT_EQ(scene.vertex(0, 2), vec3(0, 1, 0)) << mesh << face;
            EXPECT_EQ(scene.materials.at(0).k_d, vec3(0.5f, 0.25f, 1));
            EXPECT_EQ(scene.materials.at(0).k_s, vec3(0, 1, 0));
        }
}

TEST(Obj, AByteOrderMarkEatsNothing) {
    const TemporaryFolder folder;
    (void)folder.write("a.mtl", "\xef\xbb\xbfnewmtl m\nKd 1 0 0\n");
    const Scene scene =
        load_scene(folder.write("a.obj", "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib a.mtl\nusemtl m\nf 1 2 3\n"));
    EXPECT_EQ(scene.vertex(0, 1), vec3(1, 0, 0));
    EXPECT_EQ(scene.materials.at(0).k_d, vec3(1, 0, 0));
    EXPECT_FALSE(warns(scene, "statement"));
}

TEST(Obj, LinesThatEndInCr) {
    const TemporaryFolder folder;
    std::string text = "# made elsewhere\nmtllib a.mtl\ng one\n" + kBox + "# end\n";
    std::replace(text.begin(), text.end(), '\n', '\r');
    (void)folder.write("a.mtl", "newmtl m\rKd 1 0 0\r");
    const Scene scene = load_scene(folder.write("a.obj", text));
    EXPECT_EQ(scene.triangles.size(), 12u);
    EXPECT_EQ(scene.objects.at(0).name, "one");
}

TEST(Obj, WhatFollowsPositionsIsToldOf) {
    const TemporaryFolder folder;
    const auto load = [&](const std::string& behind) {
        return load_scene(folder.write("a.obj", "v 0 0 0" + behind + "\nv 1 0 0" + behind + "\nv 0 1 0\nf 1 2 3\n"));
    };
    for (const char* colour : {" 1 0.5 0", " 1 1 0.5 0", " 255 0 0 255"})
        EXPECT_TRUE(warns(load(colour), "a.obj:1: the colour of a vertex is ignored, 2 times")) << colour;
    for (const char* weight : {" 2", " 10", " 0.5"})
        EXPECT_TRUE(warns(load(weight), "the weight w of a vertex is ignored, 2 times")) << weight;
    for (const char* nothing : {"", " 1", " 1.000"}) EXPECT_FALSE(warns(load(nothing), "ignored")) << nothing;
}

/// d and Tr in either order, in agreement, in contradiction, alone.
TEST(Obj, OpacityByDissolveOrTransparency) {
    const TemporaryFolder folder;
    struct Case {
        std::string lines;
        float opacity;
        bool contradicts;
    };
    for (const Case& c : std::vector<Case>{{"d 1\nTr 1\n", 1, true},
                                           {"Tr 1\nd 1\n", 1, true},
                                           {"d 0.25\nTr 0.75\n", 0.25f, false},
                                           {"Tr 0.75\nd 0.25\n", 0.25f, false},
                                           {"d 0\nTr 0\n", 0, true},
                                           {"Tr 0.25\n", 0.75f, false},
                                           {"d 0.25\n", 0.25f, false},
                                           {"", 1, false}}) {
        (void)folder.write("a.mtl", "newmtl m\n" + c.lines);
        const Scene scene =
            load_scene(folder.write("a.obj", "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
        EXPECT_EQ(scene.materials.at(0).opacity, c.opacity) << c.lines;
        EXPECT_EQ(warns(scene, "a.mtl:3: a Tr other than 1 - d is ignored."), c.contradicts) << c.lines;
        EXPECT_EQ(warns(scene, "They throw no shadow (transparent_occluders: ignore)"), c.opacity < 1) << c.lines;
    }
}

TEST(Obj, NegativeColoursOfAnMtlFileAreRefusedWhereTheyStand) {
    const TemporaryFolder folder;
    const auto mesh = folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    for (const char* colour : {"-1e18", "-0.1 0 0", "0 0 -1e-9"}) {
        (void)folder.write("a.mtl", std::string("newmtl a\nKd ") + colour + "\n");
        EXPECT_NE(refusal(mesh).find("a.mtl:2:4: Kd is negative"), std::string::npos) << refusal(mesh);
    }
}

const std::string kThree = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(Obj, WhatIsNotReadIsToldOnce) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("t.obj", kBox + "l 1 2\nl 2 3\np 1\ncurv 0 1 1 2\nvp 0 0\nvp 1 1\n"));
    EXPECT_TRUE(warns(scene, "t.obj:15: lines are ignored, 2 times"));
    EXPECT_TRUE(warns(scene, "points are ignored."));
    EXPECT_TRUE(warns(scene, "\"curv\" is ignored"));
    EXPECT_TRUE(warns(scene, "\"vp\" is ignored, 2 times"));
}

/// Faces of one or two corners, normals and texture points that are 0 for "none", texture points that are not numbers,
/// as Windows prints them, too, and smoothing that is "on", "OFF" or nothing.
TEST(Obj, WhatExportersWriteForNoneIsNone) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(
        folder.write("n.obj",
                     "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt nan 0\nvt 1.#QNAN 1.#INF00\nvt\nvn -1.#IND 0 0\nvn 0 0 1 # up\n"
                     "f 1\nf 1 2\nf\nf 1/0/0 2/1/2 3/2/2\ns OFF\nf 1 2 3\ns on\nf 1 3 2\ns\nf 2 3 1\n"));
    expect_sound(scene);
    EXPECT_EQ(scene.triangles.size(), 4u);
    EXPECT_TRUE(warns(scene, "n.obj:9: faces of fewer than 3 corners are ignored, 3 times"));
    EXPECT_TRUE(warns(scene, "1 of 2 vertex normals"));
    EXPECT_EQ(scene.normals[scene.triangles[0].x], vec3(0)) << "a normal numbered 0 is the face's";
    EXPECT_EQ(scene.normals[scene.triangles[0].y], vec3(0, 0, 1));
    ASSERT_EQ(scene.objects.size(), 2u) << "what is smooth, and what is not";
    EXPECT_EQ(scene.objects[1].triangle_count, 1u);
}

/// A path that ends in a backslash keeps the line behind it; terms out of range, and an index of 0, are as good as not
/// given.
TEST(Obj, MtlTermsThatMeanNothingDoNotRefuseTheMesh) {
    const TemporaryFolder folder;
    (void)folder.write("a.mtl",
                       "newmtl a\nKd 1 0 0\nmap_Kd C:\\tex\\\nnewmtl b\nKd 0 1 0\nNi 0\nd 1.000001\nillum 99\n"
                       "newmtl c\nTr -0.5\nillum 7.0\nNi 1.25\nd 0.5\n");
    const Scene scene = load_scene(
        folder.write("a.obj", "mtllib a.mtl\n" + kThree + "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n"));
    ASSERT_EQ(scene.materials.size(), 3u);
    EXPECT_EQ(scene.materials[0].k_d, vec3(1, 0, 0));
    EXPECT_EQ(scene.materials[1].k_d, vec3(0, 1, 0));
    EXPECT_EQ(scene.materials[1].opacity, 1);
    EXPECT_EQ(scene.materials[1].index_of_refraction, Material().index_of_refraction);
    EXPECT_EQ(scene.materials[2].index_of_refraction, 1.25f);
    EXPECT_EQ(scene.materials[2].transmit, 0.5f) << "illum 7.0";
    EXPECT_TRUE(warns(scene, "a.mtl:7: what d has beyond 0 to 1 is ignored."));
    EXPECT_TRUE(warns(scene, "a.mtl:8: an illum that is none of 0 to 10 is ignored."));
    EXPECT_TRUE(warns(scene, "a.mtl:10: what Tr has beyond 0 to 1 is ignored."));
}

struct Bad {
    std::string name, text, expected;
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

class BadObj : public ::testing::TestWithParam<Bad> {};

TEST_P(BadObj, IsRefusedWithPlaceAndReason) {
    const TemporaryFolder folder;
    const auto file           = folder.write("bad.obj", GetParam().text);
    const std::string message = refusal(file);
    EXPECT_EQ(message.rfind(file.string(), 0), 0u) << message;
    EXPECT_NE(message.find(GetParam().expected), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadObj,
    ::testing::ValuesIn(std::vector<Bad>{
        {"empty", "", "holds no faces"},
        {"no_faces", kThree, "holds no faces"},
        {"prose", "Dear reader,\nthis is no mesh.\n", "holds no faces"},
        {"word_for_a_number", "v 0 zero 0\n", ":1:5: a vertex coordinate is \"zero\""},
        {"number_with_a_tail", "v 0 1.5x 0\n", ":1:5: a vertex coordinate is \"1.5x\""},
        {"comma_for_a_point", "v 0 1,5 0\n", ":1:5: a vertex coordinate is \"1,5\", expected a number with a decimal"},
        {"commas_for_points", "v 1,0 1,5 -2,0\n", ":1:3: a vertex coordinate is \"1,0\""},
        {"comma_at_the_end", "v 1 1 -2,5\n", ":1:7: a vertex coordinate is \"-2,5\""},
        {"comma_in_a_normal", "vn 0 0 1,0\n", ":1:8: a component of a normal is \"1,0\""},
        {"two_coordinates", "v 0 1\n" + kThree, ":1:6: a vertex coordinate is missing"},
        {"nan", "v 0 nan 0\n", "a vertex coordinate is \"nan\""},
        {"infinity", "v 0 -inf 0\n", "is \"-inf\""},
        {"beyond_double", "v 0 1e999 0\n", "is \"1e999\""},
        {"beyond_double_spelt_out", "v 0 1" + std::string(400, '0') + " 0\n", ":1:5: a vertex coordinate is"},
        {"beyond_float", "v 0 1e30 0\n", "is \"1e30\""},
        {"normal_word", kThree + "vn one 0 0\nf 1 2 3\n", ":4:4: a component of a normal"},
        {"texture_word", kThree + "vt one 0\nf 1 2 3\n", ":4:4: a texture coordinate"},
        {"index_zero", kThree + "f 1 0 3\n", ":4:5: the vertex index is 0"},
        {"index_beyond", kThree + "f 1 2 4\n", ":4:1: corner 3 of the face names vertex 4, but the file has 3"},
        {"index_far_beyond", kThree + "f 1 2 4294967299\n", ":4:7: the vertex index is 4294967299"},
        {"index_huge", kThree + "f 1 2 99999999999999999999\n", ":4:7: the vertex index is \"99999999999999999999\""},
        {"index_too_far_back", kThree + "f 1 2 -4\n", ":4:7: the vertex index is -4, but only 3 come before"},
        {"index_smallest", kThree + "f 1 2 -9223372036854775808\n", ":4:7:"},
        {"index_fraction", kThree + "f 1 2 3.0\n", "is \"3.0\""},
        {"index_word", kThree + "f one two three\n", ":4:3: the vertex index is \"one\""},
        {"index_missing", kThree + "f /1 2 3\n", ":4:3: the vertex index is missing"},
        {"four_parts", kThree + "f 1/1/1/1 2 3\n", ":4:3: the face corner is \"1/1/1/1\""},
        {"normal_beyond", kThree + "vn 0 0 1\nf 1//1 2//1 3//2\n", ":5:1: corner 3 of the face names normal 2"},
        {"two_corners", kThree + "f 1 2\n", "holds no faces"},
        {"bytes", std::string("\0\x01\x02v 1\xff\n", 8), "holds no faces"},
    }),
    [](const auto& test) { return test.param.name; });

class BadMtl : public ::testing::TestWithParam<Bad> {};

TEST_P(BadMtl, IsRefusedWithPlaceAndReason) {
    const TemporaryFolder folder;
    const auto mtl            = folder.write("bad.mtl", GetParam().text);
    const std::string message = refusal(folder.write("good.obj", "mtllib bad.mtl\n" + kBox));
    EXPECT_EQ(message.rfind(mtl.string(), 0), 0u) << message;
    EXPECT_NE(message.find(GetParam().expected), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(All, BadMtl,
                         ::testing::ValuesIn(std::vector<Bad>{
                             {"before_newmtl", "Kd 1 1 1\n", ":1:1: Kd before any newmtl"},
                             {"no_name", "newmtl\n", ":1:7: newmtl without a name"},
                             {"negative", "newmtl a\nKd 1 -1 1\n", ":2:4: Kd is negative"},
                             {"two_channels", "newmtl a\nKd 1 1\n", "Kd is missing"},
                             {"comma", "newmtl a\nKd 0,8 0,8 0,8\n", ":2:4: Kd is \"0,8\", expected a number with"},
                             {"nan", "newmtl a\nNs nan\n", ":2:4: Ns is \"nan\""},
                             {"index", "newmtl a\nNi -1\n", ":2:4: Ni is \"-1\", expected a positive number"},
                         }),
                         [](const auto& test) { return test.param.name; });

TEST(Obj, FolderAndMissingFile) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "a.obj");
    EXPECT_NE(refusal(folder.path() / "a.obj").find("is a folder"), std::string::npos);
    EXPECT_NE(refusal(folder.path() / "b.obj").find("no such file"), std::string::npos);
}

TEST(Obj, AnEndlessPolygonTakesNoEndlessTime) {
    // A comb of 8,000 corners: most are reflex or blocked, the worst case of ear cutting.
    std::string text, face = "f";
    const int n = 8000;
    for (int i = 0; i < n; ++i) {
        text += fmt::format("v {} {} 0\n", i, i % 2 == 0 ? 0 : 1 + (i * 7919) % 1000);
        face += fmt::format(" {}", n - i);
    }
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("comb.obj", text + face + "\n"));
    EXPECT_EQ(scene.triangles.size(), std::size_t(n - 2));
}

TEST(Obj, Mutants) {
    expect_survives_mutants(
        "obj", {kBox + "s 1\nvn 0 0 1\nvt 0 0\ng a\nusemtl m\nf 1/1/1 2/1/1 3//1 -1//-1\n",
                "mtllib x.mtl\no o\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n"});
}

}  // namespace
}  // namespace umbra
