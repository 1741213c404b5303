#include <cstring>

#include "umbra/tests/support/scene_files.h"

namespace umbra {
namespace {

const std::string kOff =
    "OFF\n# a square pyramid\n5 5 8\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 0.5 1\n4 3 2 1 0\n3 0 1 4\n3 1 2 4 255 0 0\n3 2 3 "
    "4\n3 3 0 4\n";

const std::string kPlyHead =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPly = kPlyHead + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

const std::string kStl =
    "solid a thing\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
    "0\nendloop\nendfacet\nendsolid a thing\n";

std::string bytes_of(std::uint32_t x) { return {reinterpret_cast<const char*>(&x), 4}; }
std::string bytes_of(float x) { return {reinterpret_cast<const char*>(&x), 4}; }
template <class T>
std::string swapped(T x) {
    std::string s(reinterpret_cast<const char*>(&x), sizeof(T));
    return {s.rbegin(), s.rend()};
}

std::string binary_stl(std::uint32_t says, int facets, float x = 1) {
    std::string s = "solid but binary" + std::string(64, ' ') + bytes_of(says);
    for (int f = 0; f < facets; ++f) {
        for (const float c : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, x, 0.f, 0.f, 0.f, 1.f, 0.f}) s += bytes_of(c);
        s += std::string(2, '\0');
    }
    return s;
}

std::string binary_ply(bool big) {
    std::string s = fmt::format(
        "ply\nformat binary_{}_endian 1.0\nelement note 1\nproperty list uchar uchar text\nelement vertex 3\nproperty "
        "double x\nproperty float y\nproperty float z\nproperty uchar red\n"
        "element face 1\nproperty uchar flags\nproperty list uchar int vertex_index\nproperty list uchar float "
        "weights\nend_header\n",
        big ? "big" : "little");
    const auto put = [&](auto x) { s += big ? swapped(x) : std::string(reinterpret_cast<const char*>(&x), sizeof(x)); };
    put(std::uint8_t{3});
    s += "abc";
    for (const vec3 p : {vec3(0), vec3(2, 0, 0), vec3(0, 2, 0)}) {
        put(double(p.x));
        put(p.y);
        put(p.z);
        put(std::uint8_t{200});
    }
    put(std::uint8_t{7});
    put(std::uint8_t{3});
    for (const int i : {0, 1, 2}) put(i);
    put(std::uint8_t{2});
    put(0.5f);
    put(0.25f);
    return s;
}

std::string with(std::string s, const std::string& from, const std::string& to) {
    return s.replace(s.find(from), from.size(), to);
}

TEST(Off, Pyramid) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("p.off", kOff));
    expect_sound(scene);
    EXPECT_EQ(scene.triangles.size(), 6u);
    EXPECT_EQ(scene.positions.size(), 5u);
    double volume = 0;
    for (TriangleId t = 0; t < 6; ++t) volume += glm::dot(area_normal(scene, t), dvec3(scene.vertex(t, 0))) / 6;
    EXPECT_NEAR(volume, 1.0 / 3, 1e-6) << "closed, outwards";
}

TEST(Off, CountsOnTheFirstLineAndPrefixes) {
    const TemporaryFolder folder;
    const std::string body = " 3 1 0\n0 0 0 {0}\n1 0 0 {0}\n0 1 0 {0}\n3 0 1 2\n";
    EXPECT_EQ(load_scene(folder.write("a.off", "OFF" + fmt::format(fmt::runtime(body), ""))).triangles.size(), 1u);
    EXPECT_EQ(load_scene(folder.write("b.off", "COFF" + fmt::format(fmt::runtime(body), "1 0 0 1"))).triangles.size(),
              1u);
    const Scene n = load_scene(folder.write("c.off", "NOFF" + fmt::format(fmt::runtime(body), "0 0 2")));
    EXPECT_EQ(n.normals[0], vec3(0, 0, 1));
}

TEST(Ply, TextWithQuad) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.ply", kPly));
    expect_sound(scene);
    EXPECT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(scene.positions[2], vec3(1, 1, 0));
}

TEST(Ply, BinaryOfBothOrders) {
    const TemporaryFolder folder;
    for (const bool big : {false, true}) {
        const Scene scene = load_scene(folder.write("a.PLY", binary_ply(big)));
        ASSERT_EQ(scene.triangles.size(), 1u);
        EXPECT_EQ(scene.vertex(0, 1), vec3(2, 0, 0));
        EXPECT_EQ(scene.vertex(0, 2), vec3(0, 2, 0));
    }
}

TEST(Ply, NormalsAndStrips) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(
        folder.write("a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 5\nproperty float nx\nproperty float ny\nproperty float "
                     "nz\nproperty float x\nproperty float y\nproperty float z\n"
                     "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                     "0 0 3 0 0 0\n0 0 3 1 0 0\n0 0 3 0 1 0\n0 0 3 1 1 0\n0 0 3 0 2 0\n9 0 1 2 3 4 -1 0 1 2\n"));
    ASSERT_EQ(scene.triangles.size(), 4u);
    for (TriangleId t = 0; t < 4; ++t) EXPECT_GT(area_normal(scene, t).z, 0) << "strip triangles turn alternately";
    EXPECT_EQ(scene.normals[0], vec3(0, 0, 1));
}

TEST(MeshNormals, WhatIsNotFiniteBecomesTheFaces) {
    const TemporaryFolder folder;
    const std::string head =
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float "
        "ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const std::string text = "0 0 0 nan 0 1\n1 0 0 0 0 2\n0 1 0 0 -inf 1\n3 0 1 2\n";
    std::string binary;
    for (const float x :
         {0.f, 0.f, 0.f, std::nanf(""), 0.f, 1.f, 1.f, 0.f, 0.f, 0.f, 0.f, 2.f, 0.f, 1.f, 0.f, 0.f, -kInfinity, 1.f})
        binary += bytes_of(x);
    binary += '\3' + bytes_of(0u) + bytes_of(1u) + bytes_of(2u);
    for (const auto& file : {folder.write("a.ply", "ply\nformat ascii 1.0\n" + head + text),
                             folder.write("b.ply", "ply\nformat binary_little_endian 1.0\n" + head + binary),
                             folder.write("c.off", "NOFF\n3 1 0\n" + text)}) {
        const Scene scene = load_scene(file);
        EXPECT_EQ(scene.normals, (std::vector<vec3>{vec3(0), vec3(0, 0, 1), vec3(0)})) << file;
        EXPECT_TRUE(warns(scene, "2 of 3 vertex normals")) << file;
    }
}

TEST(Stl, NormalsAreIgnoredWhateverTheyAre) {
    const TemporaryFolder folder;
    std::string binary = binary_stl(1, 1);
    binary.replace(84, 4, bytes_of(std::nanf("")));
    for (const auto& file :
         {folder.write("a.stl", with(kStl, "normal 0 0 1", "normal nan nan nan")), folder.write("b.stl", binary)}) {
        const Scene scene = load_scene(file);
        EXPECT_EQ(scene.triangles.size(), 1u);
        EXPECT_FALSE(warns(scene, "normals"));
    }
}

TEST(Stl, TextAndSeveralSolids) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.stl", kStl + kStl));
    expect_sound(scene);
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[0].name, "a thing");
    EXPECT_EQ(scene.triangles.size(), 2u);
}

TEST(Stl, BinaryEvenIfItBeginsWithSolid) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.stl", binary_stl(3, 3)));
    EXPECT_EQ(scene.triangles.size(), 3u);
    EXPECT_EQ(scene.vertex(0, 1), vec3(1, 0, 0));
}

struct Bad {
    std::string name, file, text, expected;
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

class BadMesh : public ::testing::TestWithParam<Bad> {};

TEST_P(BadMesh, IsRefusedWithPlaceAndReason) {
    const TemporaryFolder folder;
    const auto file           = folder.write(GetParam().file, GetParam().text);
    const std::string message = refusal(file);
    EXPECT_EQ(message.rfind(file.string(), 0), 0u) << message;
    EXPECT_NE(message.find(GetParam().expected), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadMesh,
    ::testing::ValuesIn(std::vector<Bad>{
        {"off_empty", "a.off", "", ", expected OFF, or OFF with any of"},
        {"off_other", "a.off", "solid x\n", ":1:1: the file begins with \"solid\""},
        {"off_binary", "a.off", "OFF BINARY\n", "binary OFF is not read"},
        {"off_no_edges", "a.off", "OFF\n3 4\n0 0 0\n", ":2:4: the number of edges is missing"},
        {"off_vertices_claimed", "a.off", "OFF\n4000000000 1 0\n0 0 0\n",
         ":2:1: 4000000000 vertices, but only 7 bytes follow"},
        {"off_faces_claimed", "a.off", "OFF\n1 4000000000 0\n0 0 0\n",
         ":2:3: 4000000000 faces, but only 7 bytes follow"},
        {"off_negative", "a.off", "OFF\n-1 1 0\n", "the number of vertices is -1"},
        {"off_overflow", "a.off", "OFF\n99999999999999999999 1 0\n", "is \"99999999999999999999\""},
        {"off_index", "a.off", with(kOff, "3 0 1 4", "3 0 1 5"), ":10:7: vertex index 5 (there are 5, counted from 0)"},
        {"off_index_negative", "a.off", with(kOff, "3 0 1 4", "3 0 1 -1"), "vertex index -1"},
        {"off_edge_face", "a.off", with(kOff, "3 0 1 4", "2 0 1"), ":10:1: a face of 2 corners"},
        {"off_nan", "a.off", with(kOff, "0.5 0.5 1", "0.5 nan 1"), ":8:5: a vertex coordinate is \"nan\""},
        {"off_cut_off", "a.off", kOff.substr(0, kOff.size() - 9), "the file ends after 4 of 5 faces"},
        {"off_face_huge", "a.off", with(kOff, "4 3 2 1 0", "999999999 3 2 1 0"), ":"},
        {"off_no_faces", "a.off", "OFF\n1 0 0\n0 0 0\n", "holds no faces"},
        {"ply_empty", "a.ply", "", ", expected ply"},
        {"ply_cut_header", "a.ply", kPly.substr(0, kPly.find("element")), "the file ends within the header"},
        {"ply_format", "a.ply", with(kPly, "ascii", "morse"), ":2:8: unknown format \"morse\""},
        {"ply_no_format", "a.ply", with(kPly, "format ascii 1.0\n", ""), "names no format"},
        {"ply_type", "a.ply", with(kPly, "float", "complex"), ":5:10: unknown type \"complex\""},
        {"ply_line", "a.ply", with(kPly, "comment", "remark"), ":3:1: unknown header line \"remark\""},
        {"ply_claims", "a.ply", with(kPly, "vertex 4", "vertex 4000000000"),
         "the header says 4000000000 of element vertex"},
        {"ply_claims_more", "a.ply", with(kPly, "vertex 4", "vertex 99999999999"),
         "the number of elements is 99999999999"},
        {"ply_no_z", "a.ply", with(kPly, "float z", "float w"), "no properties x, y and z"},
        {"ply_no_vertices", "a.ply", with(kPly, "element vertex", "element vertices"),
         "not exactly one element vertex"},
        {"ply_no_indices", "a.ply", with(kPly, "vertex_indices", "corners"), "no list vertex_indices"},
        {"ply_float_indices", "a.ply", with(kPly, "uchar int", "uchar float"), "no list vertex_indices"},
        {"ply_float_counts", "a.ply", with(kPly, "uchar int", "float int"), "a list counted by fractions"},
        {"ply_index", "a.ply", with(kPly, "4 0 1 2 3", "4 0 1 2 4"), ":15:9: vertex index 4 (there are 4"},
        {"ply_list_short", "a.ply", with(kPly, "4 0 1 2 3", "2 0 1"), ":15:1: a face of 2 corners"},
        {"ply_list_negative", "a.ply", with(kPly, "4 0 1 2 3", "-1"), "a list of length -1"},
        {"ply_list_huge", "a.ply", with(kPly, "4 0 1 2 3", "4000000000 0 1 2 3"), "the vertex index is missing"},
        {"ply_nan", "a.ply", with(kPly, "1 1 0", "1 nan 0"), ":13:3: y is \"nan\""},
        {"ply_faces_first", "a.ply",
         "ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_indices\nelement vertex 1\nproperty "
         "float x\nproperty float y\nproperty float z\nend_header\n3 0 0 0\n0 0 0\n",
         "faces before their vertices"},
        {"ply_binary_cut_off", "a.ply", binary_ply(false).substr(0, binary_ply(false).size() - 10),
         "the file ends within"},
        {"stl_empty", "a.stl", "", "at least 84 bytes (0 found)"},
        {"stl_short", "a.stl", "solidity", "neither text STL nor binary STL"},
        {"stl_counts", "a.stl", with(binary_stl(2, 1), "solid", "heavy"),
         "byte 80: 2 facets take 184 bytes, but the file has 134"},
        {"stl_nan", "a.stl", binary_stl(1, 1, std::nanf("")), "byte 108: a coordinate of a facet is nan"},
        {"stl_infinity", "a.stl", binary_stl(1, 1, kInfinity), "byte 108: a coordinate of a facet is inf"},
        {"stl_text_nan", "a.stl", with(kStl, "vertex 1 0 0", "vertex 1 nan 0"),
         ":5:10: a vertex coordinate is \"nan\""},
        {"stl_text_two_vertices", "a.stl", with(kStl, "vertex 1 0 0\n", ""),
         ":6:1: found \"endloop\", expected \"vertex\""},
        {"stl_text_cut_off", "a.stl", kStl.substr(0, kStl.find("endfacet")),
         "found the end of the file, expected \"endfacet\""},
        {"stl_text_no_end", "a.stl", kStl.substr(0, kStl.find("endsolid")),
         "found the end of the file, expected \"facet\" or \"endsolid\""},
        {"stl_no_facets", "a.stl", "solid x\nendsolid x\n", "holds no faces"},
    }),
    [](const auto& test) { return test.param.name; });

TEST(Ply, AnyNumberOfElementsWithoutPropertiesIsNothing) {
    const TemporaryFolder folder;
    const Scene scene =
        load_scene(folder.write("a.ply", with(kPly, "element face", "element nothing 4294967290\nelement face")));
    EXPECT_EQ(scene.triangles.size(), 2u);
}

TEST(Off, Mutants) { expect_survives_mutants("off", {kOff}); }
TEST(Ply, Mutants) { expect_survives_mutants("ply", {kPly, binary_ply(false), binary_ply(true)}); }
TEST(Stl, Mutants) { expect_survives_mutants("stl", {kStl, binary_stl(2, 2)}); }

}  // namespace
}  // namespace umbra
