#include <cstring>
#include <fstream>

#include "umbra/core/image/image_io.h"
#include "umbra/core/io/gltf/cutout.h"
#include "umbra/tests/support/scene_files.h"

namespace umbra {
namespace {

template <class T>
std::string bytes_of(std::initializer_list<T> numbers) {
    std::string s(numbers.size() * sizeof(T), '\0');
    std::memcpy(s.data(), numbers.begin(), s.size());
    return s;
}

std::string base64(std::string_view bytes) {
    static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t x = 0;
        for (std::size_t k = 0; k < 3; ++k)
            x = x << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : kDigits[x >> (18 - 6 * k) & 63];
    }
    return out;
}

// A unit square in z = 0, its corners in the order of a strip; 116 bytes:
//     0 positions, 48 normals (0, 0, 2), 96 six 16-bit indices, 108 four 8-bit ones in the order of a fan, 112 four
//     bytes
const std::string kSquare =
    bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}) + bytes_of<float>({0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2}) +
    bytes_of<std::uint16_t>({0, 1, 2, 2, 1, 3}) + bytes_of<std::uint8_t>({0, 1, 3, 2}) + std::string(4, '\0');

const std::string kAccessors = R"("accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
    {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3"},
    {"bufferView": 0, "byteOffset": 96, "componentType": 5123, "count": 6, "type": "SCALAR"},
    {"bufferView": 0, "byteOffset": 108, "componentType": 5121, "count": 4, "type": "SCALAR"}],
  "bufferViews": [{"buffer": 0, "byteLength": 116}])";

const std::string kMesh = R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}])";

std::string buffers(std::string_view bytes = kSquare) {
    return fmt::format(R"("buffers": [{{"byteLength": {}, "uri": "data:application/octet-stream;base64,{}"}}])",
                       bytes.size(), base64(bytes));
}

/// A document of these top-level members, with the square's accessors and buffer behind them.
std::string document(const std::string& members) {
    return R"({"asset": {"version": "2.0"},)"
           "\n" +
           members + ",\n" + kAccessors + ",\n" + buffers() + "}";
}

/// One with these nodes, all of them roots, and the square as mesh 0.
std::string with_nodes(const std::string& nodes, const std::string& more = "") {
    return document("\"nodes\": [" + nodes + "], " + (more.empty() ? "" : more + ", ") + kMesh);
}

const std::string kGood = with_nodes(R"({"mesh": 0})");

Scene load(const std::string& text) {
    const TemporaryFolder folder;
    Scene scene = load_scene(folder.write("t.gltf", text));
    expect_sound(scene);
    return scene;
}

std::string glb(std::string json, std::string_view bin, bool with_bin = true) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto size = [](std::size_t n) { return bytes_of<std::uint32_t>({std::uint32_t(n)}); };
    std::string s   = size(json.size()) + "JSON" + json;
    if (with_bin) s += size(bin.size()) + std::string("BIN\0", 4) + std::string(bin);
    return "glTF" + size(2) + size(s.size() + 12) + s;
}

void expect_near(vec3 a, vec3 b, float tolerance = 1e-5f) {
    EXPECT_LT(glm::distance(a, b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

// ---- geometry ----

TEST(Gltf, NodesPlaceMeshes) {
    // Twice as large, turned by 90 degrees about y, moved.
    const Scene scene = load(with_nodes(
        R"({"mesh": 0, "name": "wall", "scale": [2, 2, 2], "rotation": [0, 0.7071067811865476, 0, 0.7071067811865476], "translation": [10, 0, 0]})"));
    ASSERT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(scene.objects[0].name, "wall");
    expect_near(scene.vertex(0, 0), {10, 0, 0});
    expect_near(scene.vertex(0, 1), {10, 0, -2});
    expect_near(scene.vertex(0, 2), {10, 2, 0});
    expect_near(scene.normals[scene.triangles[0].x], {1, 0, 0});
    EXPECT_GT(area_normal(scene, 0).x, 0);
    EXPECT_TRUE(warns(scene, "no scenes"));
}

TEST(Gltf, ChildrenFollowTheirParents) {
    // Matrices are stored column by column; the last four numbers are the translation.
    const Scene scene = load(document(
        R"("scene": 0, "scenes": [{"nodes": [1], "name": "family"}], "nodes": [{"mesh": 0, "translation": [0, 0, 5]},
           {"children": [0, 2], "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1]}, {"mesh": 0}, {"mesh": 0}], )" +
        kMesh));
    ASSERT_EQ(scene.objects.size(), 2u) << "node 3 is in no scene";
    expect_near(scene.vertex(0, 1), {3, 1, 5});
    expect_near(scene.vertex(2, 1), {3, 1, 0});
    EXPECT_EQ(scene.title, "family");
}

/// A triangle, three translations, rotations (none, 90 degrees about z, none) and scales (1, 2, 1).
std::string instanced(const std::string& attributes, const std::string& more = "") {
    const float h = std::sqrt(0.5f);
    const std::string bytes =
        bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<float>({0, 0, 0, 1, 0, 0, 2, 0, 5}) +
        bytes_of<float>({0, 0, 0, 1, 0, 0, h, h, 0, 0, 0, 1}) + bytes_of<float>({1, 1, 1, 2, 2, 2, 1, 1, 1});
    return R"({"asset": {"version": "2.0"}, "extensionsUsed": ["EXT_mesh_gpu_instancing"], )" + more +
           R"("nodes": [{"mesh": 0, "name": "leaf", "translation": [0, 0, 10], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {)" +
           attributes + R"(}}}}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 0, "byteOffset": 72, "componentType": 5126, "count": 3, "type": "VEC4"},
        {"bufferView": 0, "byteOffset": 120, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3"},
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC4"}],
        "bufferViews": [{"buffer": 0, "byteLength": 156}], )" +
           buffers(bytes) + "}";
}

TEST(Gltf, InstancesArePlaced) {
    const std::string required = R"("extensionsRequired": ["EXT_mesh_gpu_instancing"], )";
    const Scene all            = load(instanced(R"("TRANSLATION": 1, "ROTATION": 2, "SCALE": 3, "_ID": 4)", required));
    ASSERT_EQ(all.objects.size(), 3u);
    EXPECT_EQ(all.objects[2].name, "leaf");
    expect_near(all.vertex(0, 1), {1, 0, 10});
    expect_near(all.vertex(1, 1), {1, 2, 10});
    expect_near(all.vertex(1, 2), {-1, 0, 10});
    expect_near(all.vertex(2, 1), {3, 0, 15});
    EXPECT_FALSE(warns(all, "Extensions"));

    const Scene translated = load(instanced(R"("TRANSLATION": 1)"));
    ASSERT_EQ(translated.triangles.size(), 3u);
    expect_near(translated.vertex(1, 2), {1, 1, 10});
    const Scene turned = load(instanced(R"("ROTATION": 2)"));
    ASSERT_EQ(turned.triangles.size(), 3u);
    expect_near(turned.vertex(1, 1), {0, 1, 10});
    EXPECT_EQ(load(instanced(R"("_ID": 1)")).triangles.size(), 1u) << "an attribute of another meaning";
}

TEST(Gltf, FaultyInstancesAreRefused) {
    const TemporaryFolder folder;
    for (const auto& [attributes, expected] :
         {std::pair{R"("TRANSLATION": 2)", "TRANSLATION has 4 components an instance, expected 3"},
          {R"("ROTATION": 1)", "ROTATION has 3 components an instance, expected 4"},
          {R"("ROTATION": 5)", "ROTATION of instance 2 has length 0, expected a unit quaternion"},
          {R"("TRANSLATION": 1, "SCALE": 4)", "attributes of 3 and of 2 instances"},
          {R"("TRANSLATION": 9)", "TRANSLATION 9 does not exist"}}) {
        const std::string message = refusal(folder.write("a.gltf", instanced(attributes)));
        EXPECT_NE(message.find(expected), std::string::npos) << message;
    }
}

TEST(Gltf, AMirrorTurnsTheWinding) {
    const Scene scene = load(with_nodes(R"({"mesh": 0, "scale": [-1, 1, 1]})"));
    for (TriangleId t = 0; t < 2; ++t) EXPECT_GT(area_normal(scene, t).z, 0) << "still seen from +z";
    expect_near(scene.normals[0], {0, 0, 1});
}

TEST(Gltf, UnevenScalesTurnNormalsTheOtherWay) {
    // The plane x + y = const, stretched along x, leans more towards y.
    const std::string bytes = bytes_of<float>({1, 0, 0, 0, 1, 0, 0, 1, 1, 1, 1, 0, 1, 1, 0, 1, 1, 0});
    const Scene scene       = load(R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0, "scale": [2, 1, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}, {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 72}], )" +
                                   buffers(bytes) + "}");
    expect_near(scene.normals[0], vec3(glm::normalize(dvec3(1, 2, 0))));
    EXPECT_GT(glm::dot(glm::normalize(area_normal(scene, 0)), dvec3(scene.normals[0])), 0.99999);
}

TEST(Gltf, ScalesThatFlattenLeaveFaceNormals) {
    const Scene scene = load(with_nodes(R"({"mesh": 0, "scale": [1, 1, 0]})"));
    EXPECT_EQ(scene.normals[0], vec3(0));
    EXPECT_EQ(scene.triangles.size(), 2u);
}

TEST(Gltf, StripsAndFansAreTheSameSquare) {
    for (const char* primitive : {R"({"attributes": {"POSITION": 0}, "mode": 5})",
                                  R"({"attributes": {"POSITION": 0}, "indices": 3, "mode": 6})",
                                  R"({"attributes": {"POSITION": 0}, "indices": 2, "mode": 4})"}) {
        const Scene scene =
            load(document(fmt::format(R"("nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{}]}}])", primitive)));
        ASSERT_EQ(scene.triangles.size(), 2u) << primitive;
        for (TriangleId t = 0; t < 2; ++t) EXPECT_EQ(area_normal(scene, t), dvec3(0, 0, 1)) << primitive;
        EXPECT_EQ(scene.normals[0], vec3(0)) << "none given: face normals";
    }
}

TEST(Gltf, PointsLinesAndTheIncompleteAreLeftOutWithAWarning) {
    const Scene scene = load(document(
        R"("nodes": [{"mesh": 0}], "animations": [{"channels": [], "samplers": []}], "meshes": [{"primitives": [
        {"attributes": {"POSITION": 0}, "mode": 0}, {"attributes": {"POSITION": 0}, "mode": 3},
        {"attributes": {"NORMAL": 1}}, {"attributes": {"POSITION": 0, "COLOR_0": 1}}]}])"));
    EXPECT_EQ(scene.triangles.size(), 1u);
    EXPECT_TRUE(warns(scene, "2 primitives of points or lines"));
    EXPECT_TRUE(warns(scene, "without positions"));
    EXPECT_TRUE(warns(scene, "has 4 corners, which do not divide into triangles"));
    EXPECT_TRUE(warns(scene, "Colours of vertices"));
    EXPECT_TRUE(warns(scene, "Animations are ignored"));
    EXPECT_FALSE(warns(load(kGood), "Animations"));
}

/// One triangle with normals along z and two morph targets: all of it 2 along z, with normals that lean by (0, 1, 0);
/// corner 2 by (0, 3, 0), sparse.
std::string morphing(const std::string& nodes, const std::string& mesh,
                     const std::string& targets = R"({"POSITION": 2, "NORMAL": 3}, {"POSITION": 4})") {
    const std::string bytes =
        bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + bytes_of<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}) +
        bytes_of<float>({0, 0, 2, 0, 0, 2, 0, 0, 2}) + bytes_of<float>({0, 1, 0, 0, 1, 0, 0, 1, 0}) +
        bytes_of<std::uint16_t>({2, 0}) + bytes_of<float>({0, 3, 0});
    return R"({"asset": {"version": "2.0"}, "nodes": [)" + nodes + R"(], "meshes": [{)" + mesh +
           R"("primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "targets": [)" + targets + R"(]}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"bufferView": 0, "byteOffset": 72, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"bufferView": 0, "byteOffset": 108, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {"count": 1,
                        "indices": {"bufferView": 0, "byteOffset": 144, "componentType": 5123},
                        "values": {"bufferView": 0, "byteOffset": 148}}},
                      {"bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 160}], )" +
           buffers(bytes) + "}";
}

TEST(Gltf, MorphTargetsAreAppliedByTheirWeights) {
    const Scene scene = load(morphing(
        R"({"mesh": 0}, {"mesh": 0, "weights": [0, 0]}, {"mesh": 0, "weights": [1, 0], "translation": [0, 0, 10]})",
        R"("weights": [0.5, 2], )"));
    ASSERT_EQ(scene.triangles.size(), 3u);
    EXPECT_EQ(scene.vertex(0, 0), vec3(0, 0, 1)) << "half of 2 along z";
    EXPECT_EQ(scene.vertex(0, 2), vec3(0, 7, 1)) << "1 + 2 * 3, of the sparse target";
    expect_near(scene.normals[scene.triangles[0].x], vec3(glm::normalize(dvec3(0, 0.5, 1))));
    EXPECT_EQ(scene.vertex(1, 2), vec3(0, 1, 0)) << "the node's weights replace the mesh's";
    EXPECT_EQ(scene.vertex(2, 2), vec3(0, 1, 12));
    expect_near(scene.normals[scene.triangles[2].x], vec3(glm::normalize(dvec3(0, 1, 1))));
    EXPECT_FALSE(warns(scene, "orph"));
    EXPECT_EQ(load(morphing(R"({"mesh": 0})", "")).vertex(0, 2), vec3(0, 1, 0)) << "without weights all are 0";
}

/// One triangle, its normals along x, that follows two joints: of corner 0 joint 0 alone, of corner 1 joint 1, of
/// corner 2 both with the weight `shared` each. The inverse bind matrix of joint 0 moves by -5 along z, that of joint 1
/// is 1.
std::string skinned(const std::string& nodes, const std::string& skin, float shared = 2,
                    const std::string& attributes = R"("POSITION": 0, "NORMAL": 1, "JOINTS_0": 2, "WEIGHTS_0": 3)") {
    const std::string bytes = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) +
                              bytes_of<float>({1, 0, 0, 1, 0, 0, 1, 0, 0}) +
                              bytes_of<std::uint8_t>({0, 0, 9, 0, 1, 0, 0, 0, 0, 1, 0, 0}) +
                              bytes_of<float>({1, 0, 0, 0, 1, 0, 0, 0, shared, shared, 0, 0}) +
                              bytes_of<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -5, 1,
                                               1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0,  1});
    return R"({"asset": {"version": "2.0"}, "nodes": [)" + nodes + R"(], "skins": [)" + skin +
           R"(], "meshes": [{"primitives": [{"attributes": {)" + attributes + R"(}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"bufferView": 0, "byteOffset": 72, "componentType": 5121, "count": 3, "type": "VEC4"},
                      {"bufferView": 0, "byteOffset": 84, "componentType": 5126, "count": 3, "type": "VEC4"},
                      {"bufferView": 0, "byteOffset": 132, "componentType": 5126, "count": 2, "type": "MAT4"},
                      {"bufferView": 0, "byteOffset": 132, "componentType": 5126, "count": 1, "type": "MAT4"}],
        "bufferViews": [{"buffer": 0, "byteLength": 260}], )" +
           buffers(bytes) + "}";
}

const std::string kSkin = R"({"joints": [1, 2], "inverseBindMatrices": 4})";
/// Joint 1 is turned by 90 degrees about z: (x, y, z) becomes (1 - y, x, z + 5).
const std::string kJoints =
    R"({"mesh": 0, "skin": 0, "translation": [100, 0, 0]}, {"translation": [0, 0, 5], "children": [2]},
       {"translation": [1, 0, 0], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]})";

TEST(Gltf, SkinsFollowTheJointsOfTheFile) {
    const Scene scene = load(skinned(kJoints, kSkin));
    ASSERT_EQ(scene.triangles.size(), 1u);
    expect_near(scene.vertex(0, 0), {0, 0, 0});
    expect_near(scene.vertex(0, 1), {1, 1, 5});
    expect_near(scene.vertex(0, 2), {0, 0.5f, 2.5f});
    expect_near(scene.normals[scene.triangles[0].x], {1, 0, 0});
    expect_near(scene.normals[scene.triangles[0].y], {0, 1, 0});
    EXPECT_FALSE(warns(scene, "kin"));
    const Scene bound = load(skinned(kJoints, R"({"joints": [1, 2]})"));
    expect_near(bound.vertex(0, 0), {0, 0, 5});
    const Scene none = load(skinned(kJoints, kSkin, 0));
    expect_near(none.vertex(0, 2), {0, 1, 0});
    EXPECT_TRUE(warns(none, "The weights of 1 vertices' joints"));
}

TEST(Gltf, AMirroredSkeletonTurnsTheWinding) {
    const Scene scene = load(
        skinned(R"({"mesh": 0, "skin": 0}, {"scale": [-1, 1, 1]}, {"scale": [-1, 1, 1]})", R"({"joints": [1, 2]})"));
    EXPECT_EQ(area_normal(scene, 0), dvec3(0, 0, 1));
    expect_near(scene.normals[0], {-1, 0, 0});
}

TEST(Gltf, ASkinWithoutJointsInItsMeshLeavesItWhereItIs) {
    const Scene scene = load(skinned(kJoints, kSkin, 1, R"("POSITION": 0)"));
    expect_near(vec3(dvec3(scene.vertex(0, 1)) + scene.origin), {101, 0, 0});
    EXPECT_TRUE(warns(scene, "1 primitives of nodes with a skin have no JOINTS_0"));
}

TEST(Gltf, InterleavedQuantisedSparseAndMissingData) {
    // Positions as normalised bytes 4 apart; accessor 1 is zeros with element 2 and 3 replaced.
    const std::string bytes = bytes_of<std::int8_t>({-127, -127, 0, 99, 127, -127, 0, 99, -128, 127, 0, 99}) +
                              bytes_of<std::uint16_t>({1, 2}) + bytes_of<float>({1, 0, 0, 0, 1, 0});
    const Scene scene = load(
        R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"],
        "nodes": [{"mesh": 0}, {"mesh": 1}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}, {"primitives": [{"attributes": {"POSITION": 1}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3"},
                      {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {"count": 2,
                        "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 1, "byteOffset": 4}}}],
        "bufferViews": [{"buffer": 0, "byteLength": 12, "byteStride": 4}, {"buffer": 0, "byteOffset": 12, "byteLength": 28}], )" +
        buffers(bytes) + "}");
    ASSERT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(scene.vertex(0, 0), vec3(-1, -1, 0));
    EXPECT_EQ(scene.vertex(0, 2), vec3(-1, 1, 0)) << "-128 means -1 too";
    EXPECT_EQ(scene.vertex(1, 0), vec3(0));
    EXPECT_EQ(scene.vertex(1, 2), vec3(0, 1, 0));
    EXPECT_FALSE(warns(scene, "KHR_mesh_quantization"));
}

TEST(Gltf, BuffersInFilesAndInTheBinaryChunk) {
    const TemporaryFolder folder;
    (void)folder.write("my data.bin", kSquare + "more than is needed");
    const std::string rest = R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], )" + kMesh + ", " + kAccessors;
    const Scene outside =
        load_scene(folder.write("a.gltf", rest + R"(, "buffers": [{"byteLength": 116, "uri": "my%20data.bin"}]})"));
    EXPECT_EQ(outside.triangles.size(), 2u);
    const std::string elsewhere = R"(, "buffers": [{"byteLength": 116, "uri": "..\\my%20data.bin"}]})";
    EXPECT_EQ(load_scene(folder.write("sub/a.gltf", rest + elsewhere)).positions, outside.positions);
    const Scene inside =
        load_scene(folder.write("a.glb", glb(rest + R"(, "buffers": [{"byteLength": 116}]})", kSquare)));
    EXPECT_EQ(inside.positions, outside.positions);
    EXPECT_EQ(inside.name, "a");
}

TEST(Gltf, AFileWithoutNodesShowsItsMeshes) {
    const Scene scene = load(document(kMesh));
    EXPECT_EQ(scene.triangles.size(), 2u);
    EXPECT_TRUE(warns(scene, "no nodes"));
}

TEST(Gltf, AnEmptyDocumentIsAnEmptyScene) {
    const Scene scene = load(R"({"asset": {"version": "2.0"}})");
    EXPECT_TRUE(scene.triangles.empty());
    EXPECT_TRUE(warns(scene, "no triangles"));
}

std::string normals_of(const std::string& four) {
    return kGood.substr(0, kGood.find("\"buffers\"")) + buffers(kSquare.substr(0, 48) + four + kSquare.substr(96)) +
           "}";
}

TEST(Gltf, NormalsThatAreNotFiniteOrHaveNoLengthBecomeTheFaces) {
    const float nan   = std::nanf("");
    const Scene scene = load(normals_of(bytes_of<float>({nan, 0, 2, 0, 0, 2, 0, -kInfinity, 0, 0, 0, 0})));
    ASSERT_EQ(scene.normals.size(), 4u);
    int kept = 0;
    for (std::size_t i = 0; i < 4; ++i)
        if (scene.positions[i] == vec3(1, 0, 0)) {
            ++kept;
            EXPECT_EQ(scene.normals[i], vec3(0, 0, 1)) << "the sound one stays";
        } else {
            EXPECT_EQ(scene.normals[i], vec3(0)) << "zero means the face's normal";
        }
    EXPECT_EQ(kept, 1);
    const auto counts = [](const std::string& w) { return w.find("3 of 4 vertex normals") != std::string::npos; };
    EXPECT_EQ(std::count_if(scene.warnings.begin(), scene.warnings.end(), counts), 1);
    EXPECT_FALSE(warns(load(kGood), "vertex normals"));
}

TEST(Gltf, AnAccessorThatIsNotOnlyANormalStaysChecked) {
    const std::string bad      = normals_of(bytes_of<float>({std::nanf(""), 0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2}));
    const std::string as_both  = R"({"POSITION": 1, "NORMAL": 1})";
    const std::string as_other = R"({"POSITION": 0, "TEXCOORD_0": 1})";
    for (const std::string& attributes : {as_both, as_other}) {
        std::string text           = bad;
        const std::string original = R"({"POSITION": 0, "NORMAL": 1})";
        text.replace(text.find(original), original.size(), attributes);
        const TemporaryFolder folder;
        EXPECT_NE(refusal(folder.write("a.gltf", text)).find("accessors[1]: component 0 of element 0 is nan"),
                  std::string::npos)
            << attributes;
    }
}

// ---- cameras ----

TEST(Gltf, PerspectiveCameraOfTheFirstNode) {
    const Scene scene = load(with_nodes(
        R"({"mesh": 0}, {"camera": 1, "translation": [0, 0, 7]}, {"camera": 0})",
        R"("cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 1}},
                                            {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1, "aspectRatio": 2}}])"));
    EXPECT_EQ(scene.camera.projection, Projection::perspective);
    EXPECT_NEAR(scene.camera.fov_y, 0.5 * 180 / kPi, 1e-5);
    EXPECT_EQ(scene.camera.eye, vec3(0, 0, 7));
    expect_near(glm::normalize(scene.camera.target - scene.camera.eye), {0, 0, -1});
    EXPECT_EQ(scene.camera.up, vec3(0, 1, 0));
    EXPECT_EQ(scene.width, 640);
    EXPECT_EQ(scene.height, 320);
    EXPECT_TRUE(warns(scene, "several cameras"));
}

TEST(Gltf, OrthographicCameraTurnedByItsNode) {
    // Looks down, from above, with the world's -z upwards in the picture.
    const Scene scene = load(with_nodes(
        R"({"mesh": 0}, {"camera": 0, "rotation": [-0.7071067811865476, 0, 0, 0.7071067811865476], "scale": [3, 3, 3], "translation": [0, 9, 0]})",
        R"("cameras": [{"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 4, "znear": 0, "zfar": 100}}])"));
    EXPECT_EQ(scene.camera.projection, Projection::orthographic);
    EXPECT_EQ(scene.camera.height, 8);
    expect_near(glm::normalize(scene.camera.target - scene.camera.eye), {0, -1, 0});
    expect_near(scene.camera.up, {0, 0, -1});
    EXPECT_EQ(scene.width, 320);
    EXPECT_EQ(scene.height, 640);
}

// ---- lights ----

std::string punctual(const std::string& lights) {
    return R"("extensions": {"KHR_lights_punctual": {"lights": [)" + lights + "]}}";
}
std::string shining(int light, const std::string& more = "") {
    return fmt::format(R"({{"extensions": {{"KHR_lights_punctual": {{"light": {}}}}}{}}})", light, more);
}

TEST(Gltf, PunctualLights) {
    const Scene scene = load(with_nodes(
        R"({"mesh": 0},)" + shining(0, R"(, "rotation": [-0.7071067811865476, 0, 0, 0.7071067811865476])") + "," +
            shining(1, R"(, "translation": [0, 0, 4], "name": "lamp post")") + "," +
            shining(2, R"(, "translation": [0, 0, 2], "scale": [5, 5, 5])") + "," + shining(1),
        punctual(
            R"({"type": "directional", "name": "sun", "color": [1, 0.5, 0]}, {"type": "point", "intensity": 8, "range": 10},
                    {"type": "spot", "name": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 1.5707963705062866}})")));
    ASSERT_EQ(scene.lights.size(), 4u);
    const Light& sun = scene.lights[0];
    EXPECT_EQ(sun.kind, LightKind::directional);
    EXPECT_EQ(sun.diffuse, vec3(1, 0.5f, 0));
    expect_near(glm::normalize(sun.direction), {0, -1, 0});
    EXPECT_EQ(falloff(sun, vec3(0, -1e6f, 0)), 1);
    const Light& lamp = scene.lights[1];
    EXPECT_EQ(lamp.name, "lamp_post") << "a nameless light is called as its node is";
    EXPECT_EQ(lamp.diffuse, vec3(8));
    EXPECT_EQ(lamp.specular, vec3(8));
    EXPECT_FLOAT_EQ(falloff(lamp, vec3(0)), 1.0f / 16);
    EXPECT_FLOAT_EQ(falloff(lamp, vec3(0, 0, 3.75f)), 16) << "nearer than 1 it is not limited";
    EXPECT_EQ(falloff(lamp, vec3(0, 0, -7)), 0) << "out of range";
    const Light& spot = scene.lights[2];
    expect_near(spot.direction, {0, 0, -1});
    EXPECT_EQ(spot.spot.falloff, SpotFalloff::smooth);
    EXPECT_FLOAT_EQ(spot.spot.inner, 0.1f);
    EXPECT_FLOAT_EQ(falloff(spot, vec3(0)), 0.25f) << "a node's scale does not reach its light";
}

/// The largest float, as Unity writes it, and 0, as tinygltf did.
TEST(Gltf, RangesThatMeanNoLimit) {
    for (const char* range : {"3.4028234663852886e38", "1e300", "0"}) {
        const Scene scene = load(with_nodes(R"({"mesh": 0},)" + shining(0),
                                            punctual(fmt::format(R"({{"type": "point", "range": {}}})", range))));
        EXPECT_FLOAT_EQ(falloff(scene.lights.at(0), vec3(0, 0, 1e6f)), 1e-12f) << range;
        EXPECT_EQ(warns(scene, "has the range 0, which the extension forbids"), range[0] == '0') << range;
    }
    EXPECT_EQ(load(with_nodes(R"({"mesh": 0}, {"camera": 0, "translation": [0, 0, 5]})",
                              R"("cameras": [{"type": "perspective",
                                 "perspective": {"yfov": 1, "znear": 0.1, "zfar": 3.4e38}}])"))
                  .camera.eye,
              vec3(0, 0, 5));
}

TEST(Gltf, WhatANodeOfNoSizeLightsOrSeesIsLeftOut) {
    for (const char* scale : {"[0, 0, 0]", "[1, 1, 0]"}) {
        const Scene scene = load(with_nodes(
            R"({"mesh": 0},)" + shining(0, fmt::format(R"(, "name": "gone", "scale": {})", scale)) + "," + shining(1) +
                fmt::format(
                    R"(,{{"camera": 0, "name": "blind", "scale": {}}},{{"camera": 0, "translation": [0, 0, 7]}})",
                    scale),
            R"("cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}],)" +
                punctual(R"({"type": "spot", "spot": {}}, {"type": "point"})")));
        ASSERT_EQ(scene.lights.size(), 1u);
        EXPECT_EQ(scene.lights[0].kind, LightKind::point);
        EXPECT_EQ(scene.camera.eye, vec3(0, 0, 7));
        EXPECT_TRUE(warns(scene, "The light of node \"gone\" has no direction, since the node is scaled to 0"));
        EXPECT_TRUE(warns(scene, "The camera of node \"blind\" has no direction"));
    }
    const Scene thin = load(with_nodes(R"({"mesh": 0},)" + shining(0, R"(, "scale": [0, 1, 1])"),
                                       punctual(R"({"type": "spot", "spot": {}})")));
    EXPECT_EQ(thin.lights.size(), 1u) << "a spot has an axis, however thin its node is";
}

TEST(Gltf, NodesThatAreNotVisibleHideWhatIsBelowThem) {
    const auto hidden = [](const char* visible) {
        return load(with_nodes(fmt::format(R"({{"mesh": 0}},
            {{"children": [2], "extensions": {{"KHR_node_visibility": {{"visible": {}}}}}}}, {{"mesh": 0}})",
                                           visible)));
    };
    EXPECT_EQ(hidden("false").triangles.size(), 2u);
    EXPECT_EQ(hidden("true").triangles.size(), 4u);
}

/// Off by the rounding of a program that wrote it.
TEST(Gltf, ValuesARoundingAwayFromWhatTheFormatAllows) {
    const Scene scene = load(with_nodes(R"({"mesh": 0, "matrix": [1,0,0,1e-9, 0,1,0,0, 0,0,1,-2e-7, 1,2,3,0.9999999]})",
                                        R"("materials": [{"alphaMode": "BLEND", "pbrMetallicRoughness":
            {"baseColorFactor": [1.00016, 0.5, -1e-7, 1.1], "metallicFactor": 1.5, "roughnessFactor": -0.1}}])"));
    EXPECT_EQ(scene.vertex(0, 0), vec3(1, 2, 3));
    EXPECT_EQ(scene.materials.at(0).O_d, vec3(1, 0.5f, 0));
    EXPECT_EQ(scene.materials[0].k_d, vec3(0));
    EXPECT_EQ(scene.materials[0].opacity, 1);
    EXPECT_TRUE(warns(scene, "A factor of a material is not from 0 to 1"));
    EXPECT_FALSE(warns(load(kGood), "A factor of a material"));
}

TEST(Gltf, AByteOrderMarkIsSkipped) { EXPECT_EQ(load("\xef\xbb\xbf" + kGood).triangles.size(), 2u); }

/// A spot of that file, of intensity 1. An empty `warning`: none about spots is given.
Light only_spot(const std::string& angles, std::string_view warning) {
    const Scene scene =
        load(with_nodes(R"({"mesh": 0},)" + shining(0), punctual(R"({"type": "spot", "spot": {)" + angles + "}}")));
    EXPECT_EQ(warns(scene, warning.empty() ? "spot lights have" : warning), !warning.empty()) << angles;
    return scene.lights.at(0);
}

/// Blender without blend, other rounding, the default outer angle, more than the outer angle by rounding.
TEST(Gltf, SpotsOfEqualAnglesHaveHardEdges) {
    for (const char* angles : {R"("innerConeAngle": 0.08968102931976317, "outerConeAngle": 0.08968102931976318)",
                               R"("innerConeAngle": 0.25, "outerConeAngle": 0.25)", R"("innerConeAngle": 0.78539819)",
                               R"("innerConeAngle": 0.0100000002, "outerConeAngle": 0.01)"}) {
        const Light spot = only_spot(angles, "1 spot lights have an innerConeAngle as large as");
        EXPECT_EQ(spot.spot.inner, spot.spot.cutoff) << angles;
        EXPECT_EQ(spot_factor(spot.spot, std::cos(0.99f * spot.spot.cutoff)), 1) << angles;
        EXPECT_EQ(spot_factor(spot.spot, std::cos(1.01f * spot.spot.cutoff)), 0) << angles;
    }
}

TEST(Gltf, SpotsOfHalfASphereMayBeRounded) {
    for (const char* angle : {"1.5707964", "1.5708", "1.571"}) {
        const Light spot = only_spot(std::string(R"("outerConeAngle": )") + angle, "a little above pi/2");
        EXPECT_EQ(spot.spot.cutoff, static_cast<float>(kPi / 2)) << angle;
    }
}

/// max(0.001, cos inner - cos outer) of the extension, in narrow cones and those of narrow rims.
TEST(Gltf, SpotsHaveTheExtensionsFormula) {
    for (const auto& [inner, outer] : {std::pair{0.1, 0.7}, {0.699, 0.7}, {0.03, 0.05}, {0.01, 0.02}, {0.0, 0.01}}) {
        const Light spot = only_spot(fmt::format(R"("innerConeAngle": {}, "outerConeAngle": {})", inner, outer), "");
        for (const double a : {0.0, 0.3 * outer, 0.9 * outer, 0.9995 * outer, 1.01 * outer}) {
            const double ramp = (std::cos(a) - std::cos(outer)) / std::max(0.001, std::cos(inner) - std::cos(outer));
            const double t    = std::clamp(ramp, 0.0, 1.0);
            const auto at     = static_cast<double>(spot_factor(spot.spot, static_cast<float>(std::cos(a))));
            EXPECT_NEAR(at * static_cast<double>(spot.diffuse.r), t * t, 2e-3) << inner << " " << outer << " " << a;
        }
    }
}

std::string flat_lights(const std::string& list) {
    return R"("extensionsRequired": ["EXT_lights_area"], "extensionsUsed": ["EXT_lights_area"],
              "extensions": {"EXT_lights_area": {"lights": [)" +
           list + "]}}";
}
std::string flat(int light, const std::string& more = "") {
    return fmt::format(R"({{"extensions": {{"EXT_lights_area": {{"light": {}}}}}{}}})", light, more);
}

TEST(Gltf, AreaLights) {
    const Scene scene = load(with_nodes(
        R"({"mesh": 0},)" + flat(0, R"(, "name": "panel", "translation": [0, 3, 0], "scale": [1, -2, 0.5],
                        "rotation": [-0.7071067811865476, 0, 0, 0.7071067811865476])") +
            "," + flat(1) + "," + flat(2),
        flat_lights(R"({"type": "rect", "size": 0.5, "intensity": 40, "color": [1, 0.5, 0.25], "rect": {"aspect": 3}},
                       {"type": "disk", "size": 4, "name": "dish"}, {"rect": {}})")));
    ASSERT_EQ(scene.lights.size(), 3u);
    const Light& panel = scene.lights[0];
    EXPECT_EQ(panel.kind, LightKind::rectangle);
    EXPECT_EQ(panel.name, "panel");
    expect_near(panel.position, {0, 3, 0});
    expect_near(panel.direction, {0, -1, 0});
    expect_near(panel.edge_u, {3, 0, 0});  // 2, the largest scale, * 0.5 * 3
    expect_near(vec3(glm::abs(dvec3(panel.edge_v))), {0, 0, 1});
    expect_near(vec3(glm::cross(dvec3(panel.edge_u), dvec3(panel.edge_v))), {0, -3, 0});
    expect_near(panel.diffuse, {120, 60, 30}, 1e-3f);  // 40 nits * 3 m2
    EXPECT_EQ(panel.specular, panel.diffuse);
    EXPECT_FLOAT_EQ(falloff(panel, vec3(0, 1, 0)), 0.25f);
    const Light& dish = scene.lights[1];
    EXPECT_EQ(dish.kind, LightKind::disk);
    EXPECT_EQ(dish.name, "dish");
    EXPECT_FLOAT_EQ(dish.radius, 2) << "size is the diameter";
    expect_near(dish.direction, {0, 0, -1});
    EXPECT_NEAR(dish.diffuse.r, 1000 * kPi * 4, 0.01) << "1000 nits by default";
    const Light& square = scene.lights[2];
    EXPECT_EQ(square.kind, LightKind::rectangle) << "by default";
    expect_near(square.edge_u, {1, 0, 0});
    expect_near(square.edge_v, {0, -1, 0});
    EXPECT_FALSE(warns(scene, "Extensions"));

    const Scene unknown = load(with_nodes(R"({"mesh": 0},)" + flat(0), flat_lights(R"({"type": "tube"})")));
    EXPECT_TRUE(warns(unknown, "lights[0] \"\" of EXT_lights_area is of the unknown type \"tube\""));
}

TEST(Gltf, UnknownKindsOfLightsAreLeftOut) {
    const Scene scene = load(with_nodes(R"({"mesh": 0},)" + shining(0), punctual(R"({"type": "laser", "name": "l"})")));
    EXPECT_TRUE(warns(scene, "unknown type \"laser\""));
    EXPECT_EQ(scene.lights.at(0).name, "default");
}

TEST(Gltf, ExposureMakesLuxVisible) {
    // 20 000 lux on a square: as is it would be white.
    const std::string sun = R"({"type": "directional", "intensity": 20000})";
    const Scene bright    = load(with_nodes(R"({"mesh": 0},)" + shining(0), punctual(sun)));
    EXPECT_FLOAT_EQ(bright.exposure, 1.0f / 20000);
    EXPECT_TRUE(warns(bright, "the exposure is set to 5e-05"));
    const Scene normal =
        load(with_nodes(R"({"mesh": 0},)" + shining(0), punctual(R"({"type": "directional", "intensity": 1.5})")));
    EXPECT_EQ(normal.exposure, 1);
    const Scene said =
        load(with_nodes(R"({"mesh": 0},)" + shining(0),
                        punctual(sun) + R"(, "scenes": [{"nodes": [0, 1], "extras": {"umbra": {"exposure": 0.5}}}])"));
    EXPECT_EQ(said.exposure, 0.5f);
}

// 1000 W at 4 units and a sun of 5 W/m2, as Blender writes them by default and in the units of its other mode.
std::string blender_lights(double candela) {
    return with_nodes(R"({"mesh": 0},)" + shining(0, R"(, "translation": [0, 0, 4])") + "," + shining(1),
                      punctual(fmt::format(R"({{"type": "point", "name": "lamp", "intensity": {}}},
                                              {{"type": "directional", "name": "sun", "intensity": 5}})",
                                           candela)));
}

TEST(Gltf, CandelaBesideLuxNamesTheUnitsOfBlender) {
    const Scene standard = load(blender_lights(54351));
    EXPECT_TRUE(warns(standard, "Lighting Mode \"Unitless\"")) << "3400 lux beside 5";
    EXPECT_TRUE(warns(standard, "The ambient light of 0.1 cannot be seen"));
    EXPECT_FALSE(warns(standard, "Light \"sun\" cannot be seen")) << "0.15 % can";
    const Scene unitless = load(blender_lights(79.6));
    EXPECT_FALSE(warns(unitless, "Blender"));
    EXPECT_FALSE(warns(unitless, "cannot be seen"));
}

// ---- materials ----

Material material(const std::string& json) {
    const Scene scene = load(
        document(R"("nodes": [{"mesh": 0}], "materials": [)" + json +
                 R"(], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 2, "material": 0}]}])"));
    return scene.materials.at(0);
}

TEST(GltfMaterial, DielectricsAndMetals) {
    const Material plastic = material(
        R"({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 0.5], "metallicFactor": 0, "roughnessFactor": 0.5}})");
    EXPECT_EQ(plastic.O_d, vec3(0.5f, 0.25f, 1));
    EXPECT_FLOAT_EQ(plastic.k_d.r, 0.96f);
    EXPECT_EQ(plastic.k_a, plastic.k_d);
    EXPECT_FLOAT_EQ(plastic.k_s.g, 0.04f) << "a = 0.25: the peak 1 / (4 a^2) = 4 is limited to 1";
    EXPECT_FLOAT_EQ(plastic.shininess, 7.5f) << "1 / (2 a^2) - 1/2";
    EXPECT_FALSE(plastic.two_sided);
    EXPECT_EQ(plastic.opacity, 1) << "alphaMode is OPAQUE";
    const Material gold = material(
        R"({"doubleSided": true, "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.75, 0.25, 0.5], "roughnessFactor": 0.25}})");
    EXPECT_EQ(gold.k_d, vec3(0));
    EXPECT_EQ(gold.k_s, vec3(1, 0.75f, 0.25f));
    EXPECT_FLOAT_EQ(gold.shininess, 127.5f);
    EXPECT_TRUE(gold.two_sided);
    EXPECT_EQ(gold.opacity, 0.5f);
    const Material rough = material(R"({"name": "none given"})");
    EXPECT_EQ(rough.k_s, vec3(0.25f)) << "metal and rough by default: F0 = 1, a = 1";
    EXPECT_EQ(rough.shininess, 1);
    const Material mirror = material(R"({"pbrMetallicRoughness": {"roughnessFactor": 0}})");
    EXPECT_EQ(mirror.shininess, 10000);
}

TEST(GltfMaterial, NoneGivesBackMoreThanItGets) {
    for (const double m : {0.0, 0.3, 1.0})
        for (const double r : {0.0, 0.2, 0.6, 1.0})
            for (const double c : {0.0, 0.5, 1.0}) {
                const Material x = material(fmt::format(
                    R"({{"pbrMetallicRoughness": {{"baseColorFactor": [{0}, {0}, {0}, 1], "metallicFactor": {1}, "roughnessFactor": {2}}}}})",
                    c, m, r));
                EXPECT_LE(x.k_d.r * x.O_d.r + x.k_s.r * x.O_s.r, 1.00001f) << c << ' ' << m << ' ' << r;
            }
}

TEST(GltfMaterial, EmissionAndExtensions) {
    EXPECT_EQ(
        material(
            R"({"emissiveFactor": [1, 0.5, 0], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}})")
            .emission,
        vec3(4, 2, 0));
    const Material unlit = material(
        R"({"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}, "extensions": {"KHR_materials_unlit": {}}})");
    EXPECT_EQ(unlit.emission, vec3(1, 0.5f, 0));
    EXPECT_EQ(unlit.k_d + unlit.k_s + unlit.k_a, vec3(0));
    const Material glass = material(
        R"({"extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.9}, "KHR_materials_ior": {"ior": 1.3}}})");
    EXPECT_EQ(glass.transmit, 0.9f);
    EXPECT_EQ(glass.index_of_refraction, 1.3f);
    const Material gloss = material(
        R"({"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.5, 0.5, 1], "specularFactor": [0.25, 0.2, 0.1], "glossinessFactor": 0.5}}})");
    EXPECT_EQ(gloss.O_d, vec3(0.5f));
    EXPECT_EQ(gloss.k_d, vec3(0.75f));
    EXPECT_EQ(gloss.k_s, vec3(0.25f, 0.2f, 0.1f));
    EXPECT_FLOAT_EQ(gloss.shininess, 7.5f);
}

TEST(GltfMaterial, TexturesAreNotReadNorEvenOpened) {
    const Scene scene =
        load(document(R"("nodes": [{"mesh": 0}], "images": [{"uri": "/dev/zero"}], "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "normalTexture": {"index": 0}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 2, "material": 0}]}])"));
    EXPECT_EQ(std::count_if(scene.warnings.begin(), scene.warnings.end(),
                            [](const std::string& w) { return w.starts_with("Textures"); }),
              1);
}

Scene masked(const std::string& members, const std::string& more = "") {
    return load(document(R"("nodes": [{"mesh": 0}], "images": [{"uri": "leaf.png"}], "textures": [{"source": 0}],
        "materials": [{"name": "leaf", "alphaMode": "MASK", )" +
                         members + R"(}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 2,
        "material": 0}]}])" +
                         more));
}

TEST(GltfMaterial, MasksWithoutATextureLeaveAllOrNothing) {
    const Scene whole = masked(R"("pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]})");
    EXPECT_EQ(whole.triangles.size(), 2u) << "alphaCutoff is 0.5";
    EXPECT_EQ(whole.materials[0].opacity, 1);
    EXPECT_FALSE(whole.materials[0].cutout);
    for (
        const char* members :
        {R"("pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.4]})",
         R"("alphaCutoff": 0.9, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.8], "baseColorTexture": {"index": 0}})",
         R"("extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [1, 1, 1, 0.4]}})"}) {
        const Scene none = masked(members);
        EXPECT_TRUE(none.triangles.empty()) << members;
        EXPECT_TRUE(warns(none, "1 primitives are left out: the alpha of their material")) << members;
    }
}

TEST(GltfMaterial, MasksByATextureAreCutouts) {
    const Scene leaf = masked(R"("pbrMetallicRoughness": {"baseColorTexture": {"index": 0}})");
    EXPECT_EQ(leaf.triangles.size(), 2u);
    EXPECT_TRUE(leaf.materials[0].cutout);
    EXPECT_TRUE(warns(leaf, "The cutout of material \"leaf\" is not computed: surfaces are whole"));
    EXPECT_FALSE(
        masked(R"("alphaCutoff": 0, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}})").materials[0].cutout)
        << "every alpha is enough";
    EXPECT_FALSE(masked(R"("normalTexture": {"index": 0})").materials[0].cutout) << "its alpha cuts nothing";
}

class GltfMask : public ::testing::Test {
protected:
    GltfMask() {
        Image image(2, 2, {"R", "G", "B", "A"});
        image.at(0, 3) = 1;     // above on the left
        image.at(1, 3) = 0.3f;  // above on the right
        write_image(folder_.path() / "leaf.png", image);
    }

    /// The unit square in z = 0, the texture upright on it, under this material.
    Scene leaf(const std::string& material, const std::string& more = "", const std::string& uri = "leaf.png") const {
        const std::string bytes = kSquare + bytes_of<float>({0, 1, 1, 1, 0, 0, 1, 0});
        const std::string uv =
            R"(, {"bufferView": 0, "byteOffset": 116, "componentType": 5126, "count": 4, "type": "VEC2"}],
            "bufferViews": [{"buffer": 0, "byteLength": 148}])";
        Scene scene = load_scene(folder_.write(
            "leaf.gltf", R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "images": [{"uri": ")" + uri +
                             R"("}], )" + more + R"("materials": [{"alphaMode": "MASK", )" + material +
                             R"(}], "meshes": [{"primitives": [{"material": 0, "indices": 2,
            "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 4}}]}], )" +
                             kAccessors.substr(0, kAccessors.find(']')) + uv + ", " + buffers(bytes) + "}"));
        expect_sound(scene);
        return scene;
    }
    static double area(const Scene& scene) {
        double sum = 0;
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
            sum += glm::length(area_normal(scene, t)) / 2;
            EXPECT_GT(area_normal(scene, t).z, 0) << "wound as before";
        }
        return sum;
    }

    TemporaryFolder folder_;
    const std::string plain_   = R"("textures": [{"source": 0}], )";
    const std::string texture_ = R"("pbrMetallicRoughness": {"baseColorTexture": {"index": 0}})";
};

TEST_F(GltfMask, IsCutIntoTriangles) {
    const Scene scene = leaf(texture_, plain_);
    EXPECT_EQ(scene.triangles.size(), 2u) << "a quarter, on both sides of the diagonal";
    EXPECT_DOUBLE_EQ(area(scene), 0.25);
    EXPECT_EQ(bounds(scene).min, vec3(0, 0.5f, 0));
    EXPECT_EQ(bounds(scene).max, vec3(0.5f, 1, 0));
    EXPECT_EQ(scene.normals[0], vec3(0, 0, 1));
    EXPECT_FALSE(scene.materials[0].cutout);
    EXPECT_FALSE(warns(scene, "cutout"));

    std::ifstream in(folder_.path() / "leaf.png", std::ios::binary);
    const std::string file{std::istreambuf_iterator<char>(in), {}};
    EXPECT_DOUBLE_EQ(area(leaf(texture_, plain_, "data:image/png;base64," + base64(file))), 0.25);
}

TEST_F(GltfMask, AlphaIsThatOfFactorAndTexture) {
    const auto material = [](const char* cutoff) {
        return fmt::format(
            R"("alphaCutoff": {}, "pbrMetallicRoughness": {{"baseColorFactor": [1, 1, 1, 0.5], "baseColorTexture": {{"index": 0}}}})",
            cutoff);
    };
    const Scene both = leaf(material("0.1"), plain_);
    EXPECT_DOUBLE_EQ(area(both), 0.5) << "0.5 * 0.3 is above 0.1";
    EXPECT_EQ(both.triangles.size(), 3u) << "neighbours make one rectangle: a triangle and a quadrangle of it";
    EXPECT_DOUBLE_EQ(area(leaf(material("0.2"), plain_)), 0.25);
    EXPECT_DOUBLE_EQ(area(leaf(material("0.5"), plain_)), 0.25) << "at the cutoff it is there";
}

TEST_F(GltfMask, TexturesGoOnAsTheirSamplersSay) {
    const std::string twice =
        R"("pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2]}}}})";
    const auto wrapped = [&](const char* wrap) {
        return leaf(
            twice,
            fmt::format(R"("textures": [{{"source": 0, "sampler": 0}}], "samplers": [{{"wrapS": {}}}], )", wrap));
    };
    // Along x of 4 texels each: kept are 0 and 2, 0 and 3, 0 alone. Along y: two of four.
    const Scene repeated = wrapped("10497"), mirrored = wrapped("33648"), clamped = wrapped("33071");
    EXPECT_DOUBLE_EQ(area(repeated), 0.25);
    EXPECT_EQ(bounds(repeated).max, vec3(0.75f, 1, 0));
    EXPECT_DOUBLE_EQ(area(mirrored), 0.25);
    EXPECT_EQ(bounds(mirrored).max, vec3(1, 1, 0));
    EXPECT_DOUBLE_EQ(area(clamped), 0.125);
    EXPECT_EQ(bounds(clamped).max, vec3(0.25f, 1, 0));
}

TEST_F(GltfMask, WhatCannotBeReadStaysWhole) {
    for (const char* uri : {"none.png", "leaf.gltf"}) {
        const Scene scene = leaf(texture_, plain_, uri);
        EXPECT_DOUBLE_EQ(area(scene), 1) << uri;
        EXPECT_TRUE(scene.materials[0].cutout) << uri;
        EXPECT_TRUE(warns(scene, "The texture that cuts the outlines of materials[0] is not read")) << uri;
        EXPECT_FALSE(warns(scene, "/proc/")) << uri;
        EXPECT_TRUE(warns(scene, "The cutout of material \"material_0\" is not computed")) << uri;
    }
}

TEST_F(GltfMask, StaysWholeBeyondALimitOfTriangles) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    Cutout cutout;
    cutout.width = cutout.height = 2;
    cutout.kept                  = {1, 0, 0, 1};
    const std::vector<dvec2> at{{0, 0}, {2, 0}, {0, 2}};
    // The triangle below the diagonal of 4 x 4 texels. Kept are those of an even sum of coordinates: four whole ones of
    // two triangles each, at (0, 0), (1, 1), (2, 0), (0, 2); the next ones, of the sum 4, only touch the diagonal.
    const auto all = cut_out(mesh, at, cutout, 8);
    ASSERT_TRUE(all.has_value());
    EXPECT_EQ(all->triangles.size(), 8u);
    EXPECT_FALSE(cut_out(mesh, at, cutout, all->triangles.size() - 1).has_value());
}

// ---- extensions ----

/// The square with 16-bit positions as they are, scaled by its node, and normals of normalised bytes.
TEST(Gltf, QuantisedAttributes) {
    const std::string bytes = bytes_of<std::uint16_t>({0, 0, 0, 0, 4000, 0, 0, 0, 0, 60000, 0, 0}) +
                              bytes_of<std::int8_t>({0, 0, 127, 0, 0, -127, 0, 0, -128, 0, 0, 0});
    const Scene scene = load(R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_mesh_quantization"],
        "extensionsRequired": ["KHR_mesh_quantization"], "nodes": [{"mesh": 0, "scale": [0.001, 0.001, 0.001]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5123, "count": 3, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 24, "byteStride": 8},
                        {"buffer": 0, "byteOffset": 24, "byteLength": 12, "byteStride": 4}], )" +
                             buffers(bytes) + "}");
    expect_near(scene.vertex(0, 1), {4, 0, 0});
    expect_near(scene.vertex(0, 2), {0, 60, 0});
    EXPECT_EQ(scene.normals[scene.triangles[0].x], vec3(0, 0, 1));
    EXPECT_EQ(scene.normals[scene.triangles[0].y], vec3(0, -1, 0));
    EXPECT_EQ(scene.normals[scene.triangles[0].z], vec3(-1, 0, 0));
}

TEST(Gltf, CompressedDataWithAFallbackLoad) {
    const Scene draco = load(document(
        R"("extensionsUsed": ["KHR_draco_mesh_compression"], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [
        {"attributes": {"POSITION": 0}, "indices": 2, "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0,
         "attributes": {"POSITION": 0}}}}]}])"));
    EXPECT_EQ(draco.triangles.size(), 2u);
    EXPECT_EQ(draco.vertex(0, 1), vec3(1, 0, 0));
    EXPECT_TRUE(warns(draco, "KHR_draco_mesh_compression"));
    const auto with_both = [](const std::string& fallback) {
        return R"({"asset": {"version": "2.0"}, "extensionsUsed": ["EXT_meshopt_compression"], "nodes": [{"mesh": 0}], )" +
               kMesh + ", " + kAccessors.substr(0, kAccessors.find("\"bufferViews\"")) +
               R"("bufferViews": [{"buffer": 1, "byteLength": 116, "extensions": {"EXT_meshopt_compression": {"buffer": 0,
               "byteLength": 4, "byteStride": 4, "mode": "ATTRIBUTES", "count": 29}}}], "buffers": [
               {"byteLength": 4, "uri": "data:application/octet-stream;base64,AAAAAA=="}, {"byteLength": 116, )" +
               fallback + R"("extensions": {"EXT_meshopt_compression": {"fallback": true}}}]})";
    };
    const Scene meshopt =
        load(with_both("\"uri\": \"data:application/octet-stream;base64," + base64(kSquare) + "\", "));
    EXPECT_EQ(meshopt.triangles.size(), 2u);
    const TemporaryFolder folder;
    const std::string message = refusal(folder.write("a.gltf", with_both("")));
    EXPECT_NE(message.find("buffers[1] has no uri: its data are compressed by EXT_meshopt_compression"),
              std::string::npos)
        << message;
}

TEST(Gltf, TexturesInOtherFormatsAreNoReasonToRefuse) {
    const Scene scene = load(document(R"("extensionsUsed": ["EXT_texture_webp", "KHR_texture_basisu"],
        "extensionsRequired": ["EXT_texture_webp", "KHR_texture_basisu"], "nodes": [{"mesh": 0}],
        "images": [{"uri": "a.webp", "mimeType": "image/webp"}],
        "textures": [{"extensions": {"EXT_texture_webp": {"source": 0}}}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 2, "material": 0}]}])"));
    EXPECT_EQ(scene.triangles.size(), 2u);
    EXPECT_TRUE(warns(scene, "Textures are ignored"));
}

TEST(Gltf, ExtensionsThatAreNotRead) {
    EXPECT_TRUE(warns(
        load(document(
            R"("extensionsUsed": ["ACME_fur", "KHR_texture_transform"], "extensionsRequired": ["KHR_texture_transform"])")),
        "ignored: ACME_fur, KHR_texture_transform."));
}

// ---- extras.umbra ----

TEST(GltfExtras, EverythingThatTheFormatLacks) {
    const Scene scene = load_scene(std::filesystem::path(UMBRA_TEST_DATA) / "gltf/extras.gltf");
    expect_sound(scene);
    EXPECT_EQ(scene.title, "what glTF lacks");
    EXPECT_EQ(scene.shows.substr(0, 8), "All that");
    EXPECT_EQ(scene.ambient, vec3(0.2f, 0.2f, 0.25f));
    EXPECT_EQ(scene.background, vec3(0.5f));
    EXPECT_EQ(scene.tone, ToneMap::hue);
    EXPECT_EQ(scene.exposure, 0.75f);
    EXPECT_FALSE(scene.local_viewer);
    EXPECT_EQ(scene.width, 320);
    EXPECT_EQ(scene.height, 200);

    ASSERT_EQ(scene.lights.size(), 4u);
    const Light& panel = scene.lights[0];
    EXPECT_EQ(panel.kind, LightKind::rectangle);
    EXPECT_EQ(panel.name, "ceiling_panel");
    expect_near(panel.position, {0, 4, 0});
    EXPECT_NEAR(glm::length(panel.edge_u), 2, 1e-5) << "the node is scaled by 2";
    EXPECT_NEAR(glm::length(panel.edge_v), 1, 1e-5);
    expect_near(panel.direction, {0, -1, 0});
    EXPECT_EQ(panel.diffuse, vec3(12));
    EXPECT_FLOAT_EQ(falloff(panel, vec3(0, 2, 0)), 0.25f);
    const Light& dish = scene.lights[1];
    EXPECT_EQ(dish.kind, LightKind::disk);
    EXPECT_EQ(dish.name, "dish");
    EXPECT_EQ(dish.radius, 0.25f);
    expect_near(dish.direction, {0, -1, 0});
    EXPECT_EQ(dish.diffuse, vec3(1, 0.9f, 0.8f));
    EXPECT_EQ(falloff(dish, vec3(-2, 0, 1)), 1);
    EXPECT_EQ(dish.range, 9);
    const Light& bulb = scene.lights[2];
    EXPECT_EQ(bulb.kind, LightKind::sphere);
    EXPECT_FLOAT_EQ(bulb.radius, 0.2f);
    EXPECT_EQ(bulb.diffuse, vec3(2));
    EXPECT_EQ(bulb.specular, vec3(0));
    EXPECT_TRUE(bulb.attenuation.clamp);
    const Light& lamp = scene.lights[3];
    EXPECT_EQ(lamp.kind, LightKind::spot);
    EXPECT_EQ(lamp.spot.falloff, SpotFalloff::cosine);
    EXPECT_EQ(lamp.spot.exponent, 4);
    EXPECT_EQ(lamp.diffuse, vec3(8, 4, 2));
    EXPECT_EQ(lamp.specular, vec3(1));
    EXPECT_EQ(lamp.ambient, vec3(0.05f));
    EXPECT_FLOAT_EQ(falloff(lamp, vec3(0, 3, 2)), 1.0f / 3) << "1 / (1 + d^2 / 2)";

    const Material& m = scene.materials[1];
    EXPECT_EQ(m.k_a, vec3(0.2f));
    EXPECT_EQ(m.k_d, vec3(0.6f, 0.1f, 0.1f));
    EXPECT_EQ(m.k_s, vec3(0.4f));
    EXPECT_EQ(m.O_d, vec3(1, 0.9f, 0.8f));
    EXPECT_EQ(m.emission, vec3(0, 0, 0.1f));
    EXPECT_EQ(m.shininess, 40);
    EXPECT_EQ(m.lobe, Lobe::blinn_phong);
    EXPECT_TRUE(m.two_sided);
    EXPECT_EQ(m.opacity, 0.9f);
    EXPECT_EQ(m.reflect, 0.1f);
    EXPECT_EQ(m.transmit, 0.05f);
    EXPECT_EQ(m.index_of_refraction, 1.4f);
}

TEST(GltfExtras, AMirroredPanelFacesTheSameWay) {
    for (const char* scale : {"[1, 1, 1]", "[-1, 1, 1]", "[1, -2, 1]"}) {
        const Scene scene = load(with_nodes(fmt::format(
            R"({{"mesh": 0}}, {{"scale": {}, "extras": {{"umbra": {{"light": {{"type": "rectangle", "size": [1, 1]}}}}}}}})",
            scale)));
        expect_near(scene.lights.at(0).direction, {0, 0, -1});
    }
}

TEST(GltfExtras, ANodeSaysWhatItsMeshTakesPartIn) {
    const Scene scene = load(with_nodes(
        R"({"mesh": 0, "extras": {"umbra": {"casts_shadows": false, "seen_by_camera": false}}, "children": [1]},
           {"mesh": 0}, {"mesh": 0, "extras": {"umbra": {"receives_shadows": false}}})"));
    ASSERT_EQ(scene.objects.size(), 3u);
    EXPECT_EQ(scene.objects[0].switches, (ObjectSwitches{false, true, false}));
    EXPECT_EQ(scene.objects[1].switches, ObjectSwitches()) << "of the node alone, not of its children";
    EXPECT_EQ(scene.objects[2].switches, (ObjectSwitches{true, false, true}));
}

// ---- bad input ----

struct Bad {
    std::string name, text, expected;
    std::string file = "bad.gltf";
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

class BadGltf : public ::testing::TestWithParam<Bad> {};

TEST_P(BadGltf, IsRefusedWithPlaceAndReason) {
    const TemporaryFolder folder;
    const auto file           = folder.write(GetParam().file, GetParam().text);
    const std::string message = refusal(file);
    EXPECT_EQ(message.rfind(file.string(), 0), 0u) << message;
    EXPECT_NE(message.find(GetParam().expected), std::string::npos) << message;
}

std::string with(std::string s, const std::string& from, const std::string& to) {
    return s.replace(s.find(from), from.size(), to);
}
std::string node(const std::string& members) { return with_nodes("{" + members + "}"); }
std::string light(const std::string& json) { return with_nodes(R"({"mesh": 0})", punctual(json)); }
std::string camera(const std::string& json) { return with_nodes(R"({"mesh": 0})", R"("cameras": [)" + json + "]"); }
std::string extras(const std::string& json) { return with_nodes(R"({"mesh": 0, "extras": {"umbra": )" + json + "}}"); }
std::string floats(float x) {
    return kGood.substr(0, kGood.find("\"buffers\"")) + buffers(bytes_of<float>({x}) + kSquare.substr(4)) + "}";
}
std::string accessor(const std::string& json) {
    return R"({"asset": {"version": "2.0"}, "accessors": [)" + json + "]}";
}

INSTANTIATE_TEST_SUITE_P(
    Document, BadGltf,
    ::testing::ValuesIn(std::vector<Bad>{
        {"empty", "", "empty, expected a glTF 2.0 file"},
        {"not_json", "{]", ":1:2: not JSON"},
        {"cut_off", kGood.substr(0, kGood.size() - 40), "not JSON"},
        {"number_beyond", with(kGood, R"("mesh": 0)", R"("mesh": 1e999)"), "too large"},
        {"nan", with(kGood, R"("mesh": 0)", R"("mesh": NaN)"), "not JSON"},
        {"a_list", "[]", "expected an object"},
        {"no_asset", "{}", "no \"asset\""},
        {"version_1", R"({"asset": {"version": "1.0"}})", ":1:23: version \"1.0\""},
        {"version_number", R"({"asset": {"version": 2}})", "version is the number 2"},
        {"nodes_object", R"({"asset": {"version": "2.0"}, "nodes": {}})", "nodes is an object"},
        {"nested", R"({"asset": {"version": "2.0"}, "extras": )" + std::string(1000000, '['), "nested deeper"},
        {"requires_draco", document(R"("extensionsRequired": ["KHR_draco_mesh_compression"])"),
         "requires the extension KHR_draco_mesh_compression"},
        {"requires_meshopt", document(R"("extensionsRequired": ["EXT_meshopt_compression"])"),
         "requires the extension EXT_meshopt_compression"},
        {"requires_unknown", document(R"("extensionsRequired": ["ACME_fur"])"),
         ":2:24: the file requires the extension ACME_fur"},
        {"draco_inside",
         with(kGood, R"("accessors": [)", R"("accessors": [{"componentType": 5126, "count": 4, "type": "VEC3"},)")
             .replace(kGood.find(R"({"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2})"), 58,
                      R"({"attributes": {"POSITION": 0}, "extensions": {"KHR_draco_mesh_compression": {}}})"),
         "is compressed"},
    }),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Data, BadGltf,
    ::testing::ValuesIn(std::vector<Bad>{
        {"nan", floats(std::nanf("")), "accessors[0]: component 0 of element 0 is nan"},
        {"infinity", floats(-kInfinity), "accessors[0]: component 0 of element 0 is -inf"},
        {"too_far", floats(1e19f), "places a vertex at"},
        {"index_beyond",
         kGood.substr(0, kGood.find("\"buffers\"")) + buffers(kSquare.substr(0, 96) + "\x04" + kSquare.substr(97)) +
             "}",
         "index 0 of meshes[0].primitives[0] is 4, but there are 4 positions"},
        {"no_buffer", with(kGood, R"("buffer": 0)", R"("buffer": 1)"), "buffer 1 does not exist (the file has 1"},
        {"negative_buffer", with(kGood, R"("buffer": 0)", R"("buffer": -1)"), "buffer is -1"},
        {"half_a_buffer", with(kGood, R"("buffer": 0)", R"("buffer": 0.5)"), "buffer is 0.5"},
        {"no_view", with(kGood, R"("bufferView": 0)", R"("bufferView": 9)"), "bufferView 9 does not exist"},
        {"view_too_long", with(kGood, R"("byteLength": 116})", R"("byteLength": 117})"),
         "bufferViews[0] is bytes 0 to 117 of a buffer of 116"},
        {"view_beyond", with(kGood, R"({"buffer": 0, )", R"({"buffer": 0, "byteOffset": 9007199254740992, )"),
         "bufferViews[0] is bytes 9007199254740992"},
        {"view_negative", with(kGood, R"({"buffer": 0, )", R"({"buffer": 0, "byteOffset": -4, )"), "byteOffset is -4"},
        {"view_empty", with(kGood, R"("byteLength": 116})", R"("byteLength": 0})"), "byteLength is 0"},
        {"stride_small", with(kGood, R"({"buffer": 0, )", R"({"buffer": 0, "byteStride": 4, )"), "a byteStride of 4"},
        {"stride_huge", with(kGood, R"({"buffer": 0, )", R"({"buffer": 0, "byteStride": 4000000000, )"),
         "byteStride is"},
        {"count_too_large", with(kGood, R"("count": 4)", R"("count": 11)"), "accessors[0] has 11 elements"},
        {"count_huge", with(kGood, R"("count": 4)", R"("count": 9007199254740991)"),
         "accessors[0] has 9007199254740991 elements"},
        {"count_zero", with(kGood, R"("count": 4)", R"("count": 0)"), "count is 0"},
        {"count_word", with(kGood, R"("count": 4)", R"("count": "four")"), "count is the string \"four\""},
        {"count_missing", with(kGood, R"("count": 4,)", ""), "accessors[0] has no count"},
        {"offset_beyond", with(kGood, R"("byteOffset": 48)", R"("byteOffset": 116)"), "accessors[1] has 4 elements"},
        {"component_type", with(kGood, "5126", "5124"), "componentType is 5124"},
        {"type", with(kGood, "VEC3", "VEC5"), "VEC5"},
        {"zeros_without_end", accessor(R"({"componentType": 5126, "count": 4000000000, "type": "MAT4"})"),
         "4000000000 elements and no bufferView"},
        {"sparse_huge",
         accessor(
             R"({"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 4000000000, "indices": {}, "values": {}}})"),
         "count is 4000000000"},
        {"unequal_counts", with(kGood, R"("NORMAL": 1)", R"("NORMAL": 2)"),
         "NORMAL has 6 elements, another attribute 4"},
        {"position_scalar", with(kGood, R"({"POSITION": 0, "NORMAL": 1})", R"({"POSITION": 2})"),
         "POSITION is not an accessor of type VEC3"},
        {"indices_float", with(kGood, R"("indices": 2)", R"("indices": 0)"),
         "indices are not an accessor of type SCALAR"},
        {"no_attributes", with(kGood, R"("attributes")", R"("attribs")"), "has no attributes"},
        {"mode", with(kGood, R"("indices": 2)", R"("mode": 7)"), "mode is 7"},
        {"material", with(kGood, R"("indices": 2)", R"("material": 0)"), "material 0 does not exist (the file has 0"},
        {"length_beyond", with(kGood, R"("byteLength": 116,)", R"("byteLength": 117,)"),
         "buffers[0] says 117 bytes, but 116 are there"},
        {"length_huge", with(kGood, R"("byteLength": 116,)", R"("byteLength": 9007199254740991,)"),
         "but 116 are there"},
        {"no_base64", with(kGood, ";base64,", ";base64,*"), "what is not base64"},
        {"no_comma", with(kGood, ";base64,", ";base64"), "the data URI is malformed"},
        {"two_semicolons", with(kGood, ";base64,", ";;base64,"), "the data URI is malformed"},
        {"missing_file", with(kGood, "data:application/octet-stream;base64,", "no/such/"), "there is no file"},
        {"the_web", with(kGood, "data:application/octet-stream;base64,", "https://example.org/"),
         "is not read, expected a file beside this one"},
        {"absolute", with(kGood, "data:application/octet-stream;base64,", "/dev/"),
         "is not read, expected a file beside this one"},
        {"no_uri", R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4}]})", "buffers[0] has no uri"},
        {"morph_count", morphing(R"({"mesh": 0})", "", R"({"POSITION": 5})"),
         "POSITION of meshes[0].primitives[0].targets[0] has 2 elements, expected 3"},
        {"morph_weights", morphing(R"({"mesh": 0})", R"("weights": [1], )"),
         "1 weights, expected 2, as many as mesh_0 has morph targets"},
        {"morph_weights_of_a_node", morphing(R"({"mesh": 0, "weights": [1, 2, 3]})", ""), "3 weights, expected 2"},
        {"skin", skinned(R"({"mesh": 0, "skin": 1})", R"({"joints": [0]})"), "skin 1 does not exist"},
        {"skin_empty", skinned(kJoints, R"({"joints": []})"), "skins[0] has no joints"},
        {"skin_joint", skinned(kJoints, R"({"joints": [3]})"), "joint 3 does not exist"},
        {"skin_matrices", skinned(kJoints, R"({"joints": [1, 2], "inverseBindMatrices": 5})"),
         "skins[0] has 2 joints, but 1 inverseBindMatrices"},
        {"skin_matrix", skinned(kJoints, R"({"joints": [1, 2], "inverseBindMatrices": 3})"),
         "inverseBindMatrices is not an accessor of type MAT4"},
        {"skin_short", skinned(kJoints, R"({"joints": [1]})"),
         "vertex 1 of mesh_0 follows joint 1, but the skin of this node has 1 joints"},
        {"skin_no_weights", skinned(kJoints, kSkin, 1, R"("POSITION": 0, "JOINTS_0": 2)"),
         "has JOINTS_0 without WEIGHTS_0"},
        {"skin_joints_float", skinned(kJoints, kSkin, 1, R"("POSITION": 0, "JOINTS_0": 3, "WEIGHTS_0": 3)"),
         "JOINTS_0 is not an accessor of type VEC4 of unsigned integers"},
    }),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Things, BadGltf,
    ::testing::ValuesIn(std::vector<Bad>{
        {"mesh", node(R"("mesh": 1)"), "mesh 1 does not exist (the file has 1, counted from 0)"},
        {"camera", node(R"("camera": 0)"), "camera 0 does not exist (the file has 0"},
        {"light", with_nodes(shining(0)), "light 0 does not exist"},
        {"child", node(R"("children": [7])"), "node 7 does not exist"},
        {"own_child", node(R"("children": [0])"), "nodes[0] is its own ancestor"},
        {"loop", with_nodes(R"({"children": [1]}, {"children": [2]}, {"children": [0]})"),
         "is its own ancestor, expected a tree"},
        {"two_parents", with_nodes(R"({"children": [2]}, {"children": [2]}, {})"),
         "node 2 is a child of node 0 already"},
        {"scene", with_nodes(R"({"mesh": 0})", R"("scene": 3, "scenes": [{}])"), "scene 3 does not exist"},
        {"scene_node", with_nodes(R"({"mesh": 0})", R"("scenes": [{"nodes": [1]}])"), "node 1 does not exist"},
        {"scene_twice", with_nodes(R"({"mesh": 0})", R"("scenes": [{"nodes": [0, 0]}])"), "node 0 is named twice"},
        {"scene_of_children", with_nodes(R"({"children": [1]}, {})", R"("scenes": [{"nodes": [1]}])"),
         "node 1 is the child of another"},
        {"matrix_short", node(R"("matrix": [1, 0, 0])"), "expected 16 numbers"},
        {"matrix_projective", node(R"("matrix": [1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1])"),
         "the last row of matrix is (1, 0, 0, 1)"},
        {"matrix_and_scale", node(R"("matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "scale": [1, 1, 1])"),
         "both matrix and scale"},
        {"rotation_zero", node(R"("rotation": [0, 0, 0, 0])"), "rotation has length 0"},
        {"translation_far", node(R"("translation": [0, 0, 1e300])"), "1e+300"},
        {"scale_twice", with_nodes(R"({"children": [1], "scale": [1e15, 1, 1]}, {"mesh": 0, "scale": [1e15, 1, 1]})"),
         "places a vertex at"},
        {"light_angles", light(R"({"type": "spot", "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.1}})"),
         "innerConeAngle 0.2 is not less than outerConeAngle 0.1"},
        {"light_angles_nearly_the_same",
         light(R"({"type": "spot", "spot": {"innerConeAngle": 0.2501, "outerConeAngle": 0.25}})"), "is not less"},
        {"light_wide", light(R"({"type": "spot", "spot": {"outerConeAngle": 1.572}})"),
         "expected an angle in radians, from 1.75e-5 to pi/2"},
        {"light_inner", light(R"({"type": "spot", "spot": {"innerConeAngle": -0.01}})"), "innerConeAngle is -0.01"},
        {"light_no_spot", light(R"({"type": "spot"})"), "without \"spot\""},
        {"light_no_type", light(R"({})"), "lights[0] has no type"},
        {"light_type", light(R"({"type": 3})"), "type is the number 3"},
        {"light_colour", light(R"({"type": "point", "color": "#ff3366"})"), "color is the string"},
        {"light_colours", light(R"({"type": "point", "color": [1, 1, 1, 1]})"), "color is a list of 4 values"},
        {"light_negative", light(R"({"type": "point", "intensity": -1})"), "intensity is -1"},
        {"light_bright", light(R"({"type": "point", "intensity": 1e300})"), "intensity is 1e+300"},
        {"area_light", with_nodes(flat(1), flat_lights(R"({"type": "disk"})")), "light 1 does not exist"},
        {"area_light_of_no_size", with_nodes(R"({"mesh": 0})", flat_lights(R"({"type": "disk", "size": 0})")),
         "size is 0"},
        {"light_range", light(R"({"type": "point", "range": -1})"), "range is -1, expected a number of at least 0"},
        {"camera_far", camera(R"({"type": "perspective", "perspective": {"yfov": 1, "znear": 10, "zfar": 1}})"),
         "zfar 1 is not beyond znear 10"},
        {"camera_angle", camera(R"({"type": "perspective", "perspective": {"yfov": 3.2, "znear": 1}})"),
         "yfov is 3.2, expected an angle in radians"},
        {"camera_no_angle", camera(R"({"type": "perspective", "perspective": {"znear": 1}})"),
         "cameras[0] has no yfov"},
        {"camera_type", camera(R"({"type": "fisheye"})"), "fisheye"},
        {"camera_flat",
         camera(R"({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 0, "znear": 0, "zfar": 1}})"),
         "xmag or ymag is 0"},
        {"material_metallic", document(R"("materials": [{"pbrMetallicRoughness": {"metallicFactor": "all"}}])"),
         "metallicFactor is the string \"all\", expected a number"},
        {"material_base", document(R"("materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1]}}])"),
         "baseColorFactor is a list of 3 values, expected 4 numbers"},
        {"material_alpha", document(R"("materials": [{"alphaMode": "GLASS"}])"), "GLASS"},
        {"material_texture", document(R"("materials": [{"normalTexture": {"index": 0, "scale": "big"}}])"),
         "scale is the string \"big\""},
        {"extras_unknown", extras(R"({"lamp": {}})"), "\"lamp\""},
        {"extras_text", extras(R"("light")"), "extras.umbra of a node is the string"},
        {"extras_light_type", extras(R"({"light": {"type": "area"}})"), "\"area\""},
        {"extras_switch", extras(R"({"casts_shadows": "no"})"), "casts_shadows is the string \"no\""},
        {"extras_switch_of_nothing", node(R"("extras": {"umbra": {"seen_by_camera": false}})"),
         "seen_by_camera is for nodes with a mesh only"},
        {"extras_no_size", extras(R"({"light": {"type": "rectangle"}})"), "\"size\""},
        {"extras_radius", extras(R"({"light": {"type": "disk", "radius": -1}})"), "radius is -1"},
        {"extras_both", extras(R"({"light": {"type": "disk", "radius": 1, "size": [1, 1]}})"),
         "a rectangle has a size"},
        {"extras_attenuation", extras(R"({"light": {"type": "disk", "radius": 1, "attenuation": [0, 0, 0]}})"),
         "divides by zero"},
        {"extras_ellipse",
         with_nodes(R"({"scale": [1, 2, 1], "extras": {"umbra": {"light": {"type": "disk", "radius": 1}}}})"),
         "an ellipse"},
        {"extras_sheared",
         with_nodes(
             R"({"matrix": [1,0,0,0, 0.5,1,0,0, 0,0,1,0, 0,0,0,1], "extras": {"umbra": {"light": {"type": "rectangle", "size": [1, 1]}}}})"),
         "a parallelogram"},
        {"extras_material", document(R"("materials": [{"extras": {"umbra": {"shininess": -3}}}])"), "shininess is -3"},
    }),
    [](const auto& test) { return test.param.name; });

const std::string kGlb = glb(R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], )" + kMesh + ", " + kAccessors +
                                 R"(, "buffers": [{"byteLength": 116}]})",
                             kSquare);

INSTANTIATE_TEST_SUITE_P(
    Glb, BadGltf,
    ::testing::ValuesIn(std::vector<Bad>{
        {"magic", "GLTF" + kGlb.substr(4), "byte 0: does not begin with the letters glTF", "a.glb"},
        {"short", kGlb.substr(0, 15), "byte 0: 15 bytes", "a.glb"},
        {"version", with(kGlb, std::string("\x02\0\0\0", 4), std::string("\x01\0\0\0", 4)), "byte 4: version 1",
         "a.glb"},
        {"cut_off", kGlb.substr(0, kGlb.size() - 1), "byte 8: the header says", "a.glb"},
        {"chunk", kGlb.substr(0, 12) + "\xff\xff\xff\xff" + kGlb.substr(16), "byte 12: a chunk of 4294967295 bytes",
         "a.glb"},
        {"first_chunk", with(kGlb, "JSON", "BLOB"), "byte 16: the first chunk is not JSON", "a.glb"},
        {"no_bin", glb(R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 116}]})", "", false),
         "buffers[0] has no uri", "a.glb"},
        {"small_bin", glb(R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 117}]})", kSquare),
         "says 117 bytes, but 116 are there", "a.glb"},
    }),
    [](const auto& test) { return test.param.name; });

/// Padding, a newline, half a chunk; a length that ends within the header, behind the first chunk, or within the
/// second.
TEST(Glb, BytesBehindTheChunksAndShortLengthsAreToldOf) {
    const auto length       = [](std::size_t n) { return bytes_of<std::uint32_t>({std::uint32_t(n)}); };
    const auto with_length  = [&](std::size_t n) { return kGlb.substr(0, 8) + length(n) + kGlb.substr(12); };
    const std::size_t chunk = kGlb.find(std::string("BIN\0", 4)) - 4;
    const TemporaryFolder folder;
    for (const std::string& file :
         {kGlb + std::string(16, '\0'), kGlb + "\n", kGlb + length(100) + "BLOBx", with_length(0), with_length(chunk),
          with_length(chunk + 9), with_length(kGlb.size() - 1) + "rest"}) {
        const Scene scene = load_scene(folder.write("a.glb", file));
        EXPECT_EQ(scene.triangles.size(), 2u);
        EXPECT_TRUE(warns(scene, fmt::format("but the file has {}: what lies behind", file.size())));
    }
    EXPECT_FALSE(warns(load_scene(folder.write("a.glb", kGlb)), "but the file has"));
}

TEST(Gltf, AMillionNodesInAChainAreNoTrouble) {
    std::string nodes = R"({"mesh": 0})";
    for (int i = 0; i < 100000; ++i) nodes += fmt::format(",\n{{\"children\": [{}]}}", i);
    const Scene scene = load(with_nodes(nodes));
    EXPECT_EQ(scene.triangles.size(), 2u);
}

TEST(Gltf, ManyNodesOfOneMeshAreCountedBeforeTheyAreMade) {
    // 4096 zeros make 1365 triangles, 80,000 nodes too many of them.
    std::string nodes = R"({"mesh": 0})";
    for (int i = 0; i < 80000; ++i) nodes += R"(,{"mesh": 0})";
    const TemporaryFolder folder;
    const auto file = folder.write("a.gltf", R"({"asset": {"version": "2.0"}, "nodes": [)" + nodes +
                                                 R"(], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"componentType": 5126, "count": 4096, "type": "VEC3"}]})");
    EXPECT_NE(refusal(file).find("triangles with this node"), std::string::npos);
}

TEST(Gltf, Mutants) {
    const std::string everything = with_nodes(
        R"({"mesh": 0, "children": [1]}, {"camera": 0, "scale": [1, 2, 1], "rotation": [0, 0, 0, 1]},)" + shining(0) +
            R"(, {"extras": {"umbra": {"light": {"type": "disk", "radius": 1}}}})",
        punctual(R"({"type": "spot", "intensity": 5, "spot": {"outerConeAngle": 1}})") +
            R"(, "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}], "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}}], "scene": 0, "scenes": [{"nodes": [0, 2, 3]}])");
    expect_survives_mutants(
        "gltf", {everything, kGood, morphing(R"({"mesh": 0})", R"("weights": [1, 1], )"), skinned(kJoints, kSkin)});
}
TEST(Glb, Mutants) {
    const std::string json = kGlb.substr(20, kGlb.size() - 20 - 8 - kSquare.size());
    expect_survives_mutants("glb", {json + '\0' + kSquare}, [](const std::string& both) {
        const std::size_t cut = std::min(both.find('\0'), both.size());
        return glb(both.substr(0, cut), both.substr(std::min(cut + 1, both.size())));
    });
}
TEST(Glb, MutantsOfTheContainer) {
    // Most are refused for their lengths; some change bytes that nothing reads.
    expect_survives_mutants("glb", {glb(R"({"asset": {"version": "2.0"}})", std::string(2000, 'x'))});
}

}  // namespace
}  // namespace umbra
