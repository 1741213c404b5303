#include <algorithm>
#include <cctype>
#include <cstring>
#include <sstream>
#include <tuple>

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

/// As older C libraries of Windows print it; the numbers behind it keep their places.
TEST(MeshNormals, NotANumberHasManySpellings) {
    const TemporaryFolder folder;
    for (const char* odd : {"nan", "-nan(ind)", "-1.#IND", "1.#QNAN0", "+1.#SNAN", "1.#INF00", "-1.#INF"}) {
        const Scene scene = load_scene(folder.write(
            "a.off", std::string("NOFF\n3 1 0\n0 0 0 ") + odd + " 0 1\n1 0 0 0 0 2\n0 1 0 0 0 1 # last\n3 0 1 2\n"));
        ASSERT_EQ(scene.triangles.size(), 1u) << odd;
        EXPECT_EQ(scene.vertex(0, 2), vec3(0, 1, 0)) << odd;
        EXPECT_TRUE(warns(scene, "1 of 3 vertex normals")) << odd;
    }
    EXPECT_NE(refusal(folder.write("b.off", "OFF\n3 1 0\n0 0 1.#IND\n1 0 0\n0 1 0\n3 0 1 2\n")).find("\"1.#IND\""),
              std::string::npos);
}

TEST(Ply, PropertiesThatNobodyUsesMayBeAnyNumbersAndLeftOverOnesAreTold) {
    const TemporaryFolder folder;
    const std::string head =
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float scalar_intensity\n"
        "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n";
    const std::string text = "0 0 0 nan\n1 0 0 1e30\n0 1 0 -inf\n3 0 1 2 2 nan 1e30\n";
    std::string binary;
    for (const float x : {0.f, 0.f, 0.f, std::nanf(""), 1.f, 0.f, 0.f, 1e30f, 0.f, 1.f, 0.f, -kInfinity})
        binary += bytes_of(x);
    binary += '\3' + bytes_of(0u) + bytes_of(1u) + bytes_of(2u) + '\2' + bytes_of(std::nanf("")) + bytes_of(1e30f);
    for (const auto& file : {folder.write("a.ply", "ply\nformat ascii 1.0\n" + head + text),
                             folder.write("b.ply", "ply\nformat binary_little_endian 1.0\n" + head + binary),
                             folder.write("c.ply", "ply\nformat ascii 1.0\n" + head + text + "7 8\n")}) {
        const Scene scene = load_scene(file);
        EXPECT_EQ(scene.vertex(0, 2), vec3(0, 1, 0)) << file;
        EXPECT_EQ(warns(scene, "what stands behind the last element is ignored"), file.filename() == "c.ply") << file;
    }
}

TEST(Stl, NormalsAreIgnoredWhateverTheyAre) {
    const TemporaryFolder folder;
    std::string binary = binary_stl(1, 1);
    binary.replace(84, 4, bytes_of(std::nanf("")));
    for (const auto& file : {folder.write("a.stl", with(kStl, "normal 0 0 1", "normal nan nan nan")),
                             folder.write("c.stl", with(kStl, "normal 0 0 1", "normal -1.#IND -1.#IND 1.#INF")),
                             folder.write("b.stl", binary)}) {
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
        {"off_edges", "a.off", "OFF\n3 4 many\n0 0 0\n", ":2:5: the number of edges is \"many\""},
        {"off_dimensions", "a.off", "nOFF\n3 3 1 0\n0 0 0\n", ":1:1: OFF of any number of dimensions"},
        {"off_weight", "a.off", "4OFF\n1 1 0\n1 2 3 0\n3 0 0 0\n", ":3:7: the fourth coordinate is 0"},
        {"off_glued_word", "a.off", "OFFICE\n1 1 0\n", ":1:1: the file begins with \"OFFICE\""},
        {"off_vertices_claimed", "a.off", "OFF\n4000000000 1 0\n0 0 0\n",
         ":2:1: 4000000000 vertices, but only 7 bytes follow"},
        {"off_faces_claimed", "a.off", "OFF\n1 4000000000 0\n0 0 0\n",
         ":2:3: 4000000000 faces, but only 7 bytes follow"},
        {"off_negative", "a.off", "OFF\n-1 1 0\n", "the number of vertices is -1"},
        {"off_overflow", "a.off", "OFF\n99999999999999999999 1 0\n", "is \"99999999999999999999\""},
        {"off_index", "a.off", with(kOff, "3 0 1 4", "3 0 1 5"), ":10:7: vertex index 5 (there are 5, counted from 0)"},
        {"off_index_negative", "a.off", with(kOff, "3 0 1 4", "3 0 1 -1"), "vertex index -1"},
        {"off_face_negative", "a.off", with(kOff, "3 0 1 4", "-1 0 1"), ":10:1: a face of -1 corners"},
        {"off_nan", "a.off", with(kOff, "0.5 0.5 1", "0.5 nan 1"), ":8:5: a vertex coordinate is \"nan\""},
        {"off_cut_off", "a.off", kOff.substr(0, kOff.size() - 9), "the file ends after 4 of 5 faces"},
        {"off_face_huge", "a.off", with(kOff, "4 3 2 1 0", "999999999 3 2 1 0"), ":"},
        {"off_no_faces", "a.off", "OFF\n1 0 0\n0 0 0\n", "holds no faces"},
        {"ply_empty", "a.ply", "", ", expected ply"},
        {"ply_cut_header", "a.ply", kPly.substr(0, kPly.find("element")), "the file ends within the header"},
        {"ply_format", "a.ply", with(kPly, "ascii", "morse"), ":2:8: unknown format \"morse\""},
        {"ply_no_format", "a.ply", with(kPly, "format ascii 1.0\n", ""), "names no format"},
        {"ply_type", "a.ply", with(kPly, "float", "complex"), ":5:10: unknown type \"complex\""},
        {"ply_line", "a.ply", with(kPly, "property float z", "propery float z"),
         ":7:1: unknown header line \"propery\""},
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
        {"ply_list_short", "a.ply", with(kPly, "4 0 1 2 3", "2 0 1"), "holds no faces"},
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
        {"stl_text_word", "a.stl", with(kStl, "endsolid", "endfile"),
         ":9:1: found \"endfile\", expected \"facet\" or \"endsolid\""},
        {"stl_count_zero_cut_off", "a.stl", binary_stl(0, 2).substr(0, 170), "0 facets take 84 bytes"},
        {"stl_no_facets", "a.stl", "solid x\nendsolid x\n", "holds no faces"},
    }),
    [](const auto& test) { return test.param.name; });

// ---- forms that the formats forbid and other programs write ----

/// The file has the pyramid's triangles, and a warning says what was left out or assumed; none where `warning` is
/// empty.
void expect_pyramid(const std::string& text, std::string_view warning) {
    const TemporaryFolder folder;
    const Scene right = load_scene(folder.write("right.off", with(kOff, " 255 0 0", "")));
    Scene scene;
    try {
        scene = load_scene(folder.write("other.off", text));
    } catch (const InputError& e) {
        ADD_FAILURE() << text << e.what();
        return;
    }
    ASSERT_EQ(scene.triangles.size(), 6u) << text;
    EXPECT_EQ(scene.warnings.size(), right.warnings.size() + (warning.empty() ? 0 : 1)) << text;
    EXPECT_TRUE(warning.empty() || warns(scene, warning)) << text;
    for (TriangleId t = 0; t < 6; ++t)
        for (int k = 0; k < 3; ++k) EXPECT_EQ(scene.vertex(t, k), right.vertex(t, k)) << text << t;
}

TEST(Off, MagicWords) {
    const std::string text = with(with(kOff, " 255 0 0", ""), "# a square pyramid\n", ""), rest = text.substr(4);
    for (const char* magic : {"off\n", "Off ", "OFF", "OFF ", "off", "\xef\xbb\xbfOFF\n"})
        expect_pyramid(magic + rest, "");
    expect_pyramid(rest, "does not begin with OFF");
    expect_pyramid("\xef\xbb\xbf" + rest, "does not begin with OFF");
}

TEST(Off, Counts) {
    const std::string text = with(kOff, " 255 0 0", "");
    for (const char* counts :
         {"5\n5 8\n", "5 5\n8\n", "5\n5\n8\n", "5 # vertices\n5 # faces\n\n8 # edges\n", "5 5 -1\n"})
        expect_pyramid(with(text, "5 5 8\n", counts), "");
    for (const char* counts : {"5 5\n", "5\n5\n", "5 5 # and edges\n\n"})
        expect_pyramid(with(text, "5 5 8\n", counts), "the number of edges is left out");
}

TEST(Off, FacesOfFewCornersAreLeftOut) {
    const std::string text = with(with(kOff, " 255 0 0", ""), "5 5 8", "5 8 8");
    expect_pyramid(text + "2 0 1\n1 4\n0\n", "3 faces have fewer than 3 corners");
    expect_pyramid(with(text, "4 3 2 1 0\n", "4 3 2 1 0\n2 0 1\n1 4\n0\n"), "3 faces have fewer than 3 corners");
}

std::string with_lines_between(const std::string& text, std::size_t first, std::size_t last, const std::string& line) {
    std::string made;
    std::istringstream lines(text);
    std::size_t n = 0;
    for (std::string l; std::getline(lines, l); ++n) made += l + (n >= first && n <= last ? line : "") + "\n";
    return made;
}

TEST(Off, Colours) {
    const std::string text = with(kOff, " 255 0 0", ""), coloured = with(text, "OFF", "COFF");
    for (const char* colour : {" 255 0 0", " 255 0 0 255", " 0.1 0.2 0.3 1", " 3"}) {
        expect_pyramid(with_lines_between(coloured, 3, 7, colour), "colours of 5 vertices are ignored");
        expect_pyramid(with_lines_between(text, 3, 7, colour), "colours of 5 vertices are ignored");
        expect_pyramid(with_lines_between(text, 8, 12, colour), "colours of 5 faces are ignored");
    }
    for (const char* colour : {"\n255 0 0", "\n0 255 0 255", "\n\n0.1 0.2 0.3"}) {
        expect_pyramid(with_lines_between(coloured, 3, 7, colour), "colours of 5 vertices are ignored");
        expect_pyramid(with_lines_between(text, 8, 12, colour), "colours of 5 faces are ignored");
    }
    expect_pyramid(coloured, "");
}

TEST(Off, HomogeneousCoordinatesAreDivided) {
    const TemporaryFolder folder;
    for (const char* text : {"4OFF\n3 1 0\n0 0 0 1\n2 4 6 2\n0 -1 0 -0.5\n3 0 1 2\n",
                             "C4OFF\n3 1 0\n0 0 0 1 9 9 9\n2 4 6 2 9 9 9\n0 -1 0 -0.5 9 9 9\n3 0 1 2\n"}) {
        const Scene scene = load_scene(folder.write("a.off", text));
        EXPECT_EQ(scene.vertex(0, 1), vec3(1, 2, 3));
        EXPECT_EQ(scene.vertex(0, 2), vec3(0, 2, 0));
    }
}

/// Geomview has normals first, whatever the order of the letters, MeshLab colours; texture points are last.
TEST(Off, NormalsBesideColours) {
    const TemporaryFolder folder;
    const auto normal_of = [&](const std::string& magic, const std::string& terms) {
        std::string text = magic + "\n3 1 0\n";
        for (const char* position : {"0 0 0 ", "1 0 0 ", "0 1 0 "}) text += position + terms + "\n";
        const Scene scene = load_scene(folder.write("a.off", text + "3 0 1 2\n"));
        EXPECT_EQ(warns(scene, "colours of vertices stand before their normals"), terms.ends_with("0 0 -1")) << terms;
        return scene.normals.at(2);
    };
    const vec3 normal(0, 0, -1);
    for (const char* magic : {"NCOFF", "CNOFF"}) {
        EXPECT_EQ(normal_of(magic, "255 255 0 255 0 0 -1"), normal) << magic;
        EXPECT_EQ(normal_of(magic, "255 0 0 0 0 -1"), normal) << magic;
        EXPECT_EQ(normal_of(magic, "0 0 -1 255 255 0"), normal) << magic;
        EXPECT_EQ(normal_of(magic, "0 0 -1 0.5 0.5 0.1 1"), normal) << magic;
    }
    EXPECT_EQ(normal_of("STNCOFF", "0 0 -1 12 13 14 255 0.5 1"), normal);
    EXPECT_EQ(normal_of("NCOFF", "1 0 0 1 0 0 -1"), normal) << "both are unit vectors: the order of the letters";
    EXPECT_EQ(normal_of("CNOFF", "0 0 -1 1 0 0 1"), normal);
    EXPECT_EQ(normal_of("NCOFF", "\n0 0 -1 128 128 128"), normal) << "on lines of their own";
}

TEST(Ply, Words) {
    const TemporaryFolder folder;
    for (const auto& [from, to] : {std::pair<std::string, std::string>{"uchar int", "UCHAR INT"},
                                   {"float z", "Float32 Z"},
                                   {"property list", "PROPERTY LIST"},
                                   {"ascii", "ASCII"},
                                   {"ply\n", "PLY\n"},
                                   {"element face", "Element Face"},
                                   {"end_header", "END_HEADER"},
                                   {"vertex_indices", "vertex_indexes"},
                                   {"vertex_indices", "vertexIndices"},
                                   {"vertex_indices", "VERTEX_INDEX"},
                                   {"vertex_indices", "vert_ind"},
                                   {"by hand", "by C:\\hand\\"},
                                   {"ply\n", "\xef\xbb\xbfply\n"}}) {
        const auto file = folder.write("a.ply", with(kPly, from, to));
        ASSERT_EQ(refusal(file), "") << to;
        EXPECT_EQ(load_scene(file).triangles.size(), 2u) << to;
    }
}

/// The header's lines may end in CR alone: then an LF behind it is the first byte of the data.
TEST(Ply, LinesThatEndInCr) {
    const TemporaryFolder folder;
    const auto with_cr = [](std::string text) {
        std::replace(text.begin(), text.end(), '\n', '\r');
        return text;
    };
    EXPECT_EQ(load_scene(folder.write("a.ply", with_cr(kPly))).triangles.size(), 2u);
    const std::string head = with(with(kPlyHead, "ascii", "binary_little_endian"), "element vertex 4\n",
                                  "element vertex 3\nproperty uchar ten\n");
    std::string data;
    for (const vec3 p : {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)})
        data += '\n' + bytes_of(p.x) + bytes_of(p.y) + bytes_of(p.z);
    data += '\3' + bytes_of(0u) + bytes_of(1u) + bytes_of(2u);
    for (const std::string& header : {head, with_cr(head)}) {
        const Scene scene = load_scene(folder.write("b.ply", header + data));
        ASSERT_EQ(scene.triangles.size(), 1u);
        EXPECT_EQ(scene.vertex(0, 2), vec3(0, 1, 0));
    }
}

TEST(Ply, FacesOfFewCornersAreLeftOut) {
    const TemporaryFolder folder;
    for (const char* faces : {"2 0 1\n1 0\n0\n4 0 1 2 3\n", "4 0 1 2 3\n0\n1 3\n2 0 1\n"}) {
        const Scene scene =
            load_scene(folder.write("a.ply", with(with(kPly, "face 1", "face 4"), "4 0 1 2 3\n", faces)));
        EXPECT_EQ(scene.triangles.size(), 2u);
        EXPECT_TRUE(warns(scene, "3 faces have fewer than 3 corners"));
    }
}

TEST(Stl, TextInAnyCaseAndAsItIsWritten) {
    const TemporaryFolder folder;
    const auto upper = [](std::string text) {
        std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
        return text;
    };
    for (const std::string& text :
         {upper(kStl), with(kStl, "solid", "Solid"), "\xef\xbb\xbf" + kStl, with(kStl, "endloop", "end loop"),
          with(with(kStl, "endfacet", "end facet"), "endsolid", "END SOLID"), with(kStl, "solid a thing", "solid")}) {
        const Scene scene = load_scene(folder.write("a.stl", text));
        EXPECT_EQ(scene.triangles.size(), 1u) << text;
        EXPECT_FALSE(warns(scene, "endsolid")) << text;
    }
    std::string crs = kStl;
    std::replace(crs.begin(), crs.end(), '\n', '\r');
    EXPECT_EQ(load_scene(folder.write("a.stl", crs)).objects.at(0).name, "a thing");
}

TEST(Stl, SolidsWithoutAnEnd) {
    const TemporaryFolder folder;
    const std::string open = kStl.substr(0, kStl.find("endsolid"));
    for (const auto& [text, objects, warning] : {std::tuple{open, 1u, "1 solids have no endsolid"},
                                                 {open + open, 2u, "2 solids have no endsolid"},
                                                 {open + kStl, 2u, "1 solids have no endsolid"},
                                                 {kStl + open, 2u, "1 solids have no endsolid"}}) {
        const Scene scene = load_scene(folder.write("a.stl", text));
        EXPECT_EQ(scene.objects.size(), objects) << text;
        EXPECT_TRUE(warns(scene, warning)) << text;
    }
}

/// The number of facets may be unknown when the header is written; bytes behind the facets are reported.
TEST(Stl, BinaryWithANumberOfFacetsThatIsNone) {
    const TemporaryFolder folder;
    for (const char* beginning : {"solid", "heavy", "SOLID"}) {
        for (const std::uint32_t says : {0u, ~0u}) {
            const Scene scene = load_scene(folder.write("a.stl", with(binary_stl(says, 5), "solid", beginning)));
            EXPECT_EQ(scene.triangles.size(), 5u);
            EXPECT_TRUE(warns(scene, "facets, the file has 5"));
        }
        for (const std::string& behind : {std::string("\n"), std::string(7, '\0'), std::string(120, 'x')}) {
            const Scene scene = load_scene(folder.write("a.stl", with(binary_stl(2, 2), "solid", beginning) + behind));
            EXPECT_EQ(scene.triangles.size(), 2u);
            EXPECT_TRUE(warns(scene, fmt::format("{} bytes behind the 2 facets", behind.size())));
        }
    }
}

TEST(Ply, AnyNumberOfElementsWithoutPropertiesIsNothing) {
    const TemporaryFolder folder;
    const Scene scene =
        load_scene(folder.write("a.ply", with(kPly, "element face", "element nothing 4294967290\nelement face")));
    EXPECT_EQ(scene.triangles.size(), 2u);
}

// As a program that forgot the word "comment" signs its files.
TEST(Ply, UnknownLinesBeforeTheElementsAreToldAndLeftOut) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.ply", with(kPly, "comment", "Created by somebody\nremark")));
    EXPECT_EQ(scene.triangles.size(), 2u);
    EXPECT_NE(fmt::format("{}", fmt::join(scene.warnings, "\n"))
                  .find("a.ply: 2 lines of the header are unknown: the first is line 3: \"Created\"."),
              std::string::npos)
        << fmt::format("{}", fmt::join(scene.warnings, "\n"));
}

// As some shells write what a program prints. No reader guesses at it.
TEST(TextFormats, FilesInUtf16AreNamedSo) {
    const TemporaryFolder folder;
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (const auto& [name, text] :
         {std::pair{"a.obj", obj}, {"a.off", kOff}, {"a.nff", std::string("v\nfrom 0 0 1\n")}})
        for (const bool little : {true, false}) {
            std::string wide = little ? "\xff\xfe" : "\xfe\xff";
            for (const char c : text) {
                wide += little ? c : '\0';
                wide += little ? '\0' : c;
            }
            try {
                (void)load_scene(folder.write(name, wide));
                ADD_FAILURE() << name << " is read";
            } catch (const InputError& error) {
                EXPECT_NE(std::string(error.what()).find("the file is in UTF-16, expected UTF-8 or ASCII"),
                          std::string::npos)
                    << error.what();
            }
        }
}

TEST(Off, Mutants) { expect_survives_mutants("off", {kOff}); }
TEST(Ply, Mutants) { expect_survives_mutants("ply", {kPly, binary_ply(false), binary_ply(true)}); }
TEST(Stl, Mutants) { expect_survives_mutants("stl", {kStl, binary_stl(2, 2)}); }

}  // namespace
}  // namespace umbra
