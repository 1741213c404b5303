#include "umbra/tests/support/scene_files.h"

namespace umbra {
namespace {

const std::string kView = "v\nfrom 0 0 10\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 320 240\n";
const std::string kFill = "f 1 0.5 0.25 0.6 0.4 20 0 1\n";

// Positive where the surface faces away from `centre` everywhere: six times the volume that it bounds with it.
double volume_from(const Scene& scene, dvec3 centre) {
    double sum = 0;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t)
        sum += glm::dot(area_normal(scene, t), dvec3(scene.vertex(t, 0)) - centre) / 6;
    return sum;
}

double area_of(const Scene& scene) {
    double sum = 0;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) sum += glm::length(area_normal(scene, t)) / 2;
    return sum;
}

// Every vertex normal on the side of its triangle's face.
void expect_normals_agree(const Scene& scene) {
    for (TriangleId t = 0; t < scene.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            ASSERT_GT(glm::dot(area_normal(scene, t), dvec3(scene.normals[scene.triangles[t][k]])), 0) << t;
}

TEST(Nff, ViewBackgroundLightsAndFill) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write(
        "a.nff", "# a scene\nb 0.1 0.2 0.3\n" + kView + "l 1 2 3\nl 4 5 6 \n" + kFill + "p 3 0 0 0 1 0 0 0 1 0\n" +
                     "f 0 0 1 0.5 0 1 0.5 1.5\np 3\n0 0 1\n1 0 1\n0 1 1\n" + kFill + "p 3\n0 0 2\n1 0 2\n0 1 2\n"));
    expect_sound(scene);
    EXPECT_EQ(scene.camera.eye, vec3(0, 0, 10));
    EXPECT_EQ(scene.camera.fov_y, 40);
    EXPECT_EQ(scene.width, 320);
    EXPECT_EQ(scene.height, 240);
    EXPECT_EQ(scene.background, vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(scene.ambient, vec3(0.1f));
    EXPECT_TRUE(warns(scene, "I_a = 0.1"));
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[1].position, vec3(4, 5, 6));
    EXPECT_FLOAT_EQ(scene.lights[0].diffuse.r, std::sqrt(0.5f));
    EXPECT_EQ(falloff(scene.lights[0], vec3(100, 0, 0)), 1) << "no attenuation";
    ASSERT_EQ(scene.materials.size(), 2u) << "a fill that comes back is the same material";
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.O_d, vec3(1, 0.5f, 0.25f));
    EXPECT_EQ(m.k_d, vec3(0.6f));
    EXPECT_EQ(m.k_a, vec3(0.6f));
    EXPECT_EQ(m.k_s, vec3(0.4f));
    EXPECT_EQ(m.reflect, 0.4f);
    EXPECT_EQ(m.shininess, 20);
    EXPECT_FALSE(m.two_sided);
    EXPECT_TRUE(scene.materials[1].two_sided) << "seen through from both sides";
    EXPECT_EQ(scene.materials[1].transmit, 0.5f);
    EXPECT_EQ(scene.materials[1].index_of_refraction, 1.5f);
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[0].triangle_count, 2u);
}

TEST(Nff, ColouredLightsKeepTheirColours) {
    const TemporaryFolder folder;
    const Scene scene =
        load_scene(folder.write("a.nff", kView + "l 1 2 3 0.5 0.25 1\nl 0 0 9\n" + kFill + "p 3 0 0 0 1 0 0 0 1 0"));
    EXPECT_EQ(scene.lights[0].diffuse, vec3(0.5f, 0.25f, 1));
    EXPECT_EQ(scene.lights[1].diffuse, vec3(1));
}

TEST(Nff, WordsCountAndNotLines) {
    const TemporaryFolder folder;
    const Scene lines =
        load_scene(folder.write("a.nff", kFill + "c\n0 0 0 1\n0 0 2 1\npp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n"));
    const Scene line = load_scene(folder.write(
        "b.nff", "f 1 0.5 0.25\n0.6 0.4\n20 0 1 c 0 0 0 1 0 0 2 1 pp 3 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1"));
    EXPECT_EQ(lines.positions, line.positions);
    EXPECT_EQ(lines.triangles, line.triangles);
    EXPECT_EQ(lines.normals.back(), vec3(0, 0, 1)) << "a patch brings its normals";
}

TEST(Nff, SpheresAreInscribedClosedAndFaceOutwards) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.nff", kFill + "s 5 6 7 2\n"));
    expect_normals_agree(scene);
    for (const vec3 p : scene.positions) EXPECT_NEAR(glm::distance(p, vec3(5, 6, 7)), 2, 1e-5);
    const double volume = volume_from(scene, {5, 6, 7}), exact = 4.0 / 3 * kPi * 8;
    EXPECT_LT(volume, exact);
    EXPECT_GT(volume, 0.97 * exact);
    EXPECT_NEAR(volume_from(scene, {0, 0, 0}), volume, 1e-4) << "closed: the same from any point";
}

TEST(Nff, ANegativeRadiusIsSeenFromInside) {
    const TemporaryFolder folder;
    const Scene ball = load_scene(folder.write("a.nff", kFill + "s 0 0 0 -1\n"));
    expect_normals_agree(ball);
    EXPECT_LT(volume_from(ball, dvec3(0)), 0);
    const Scene tube = load_scene(folder.write("b.nff", kFill + "c 0 0 0 -1 0 0 1 -1\n"));
    expect_normals_agree(tube);
    EXPECT_LT(volume_from(tube, dvec3(0, 0, 0.5)), 0);
}

TEST(Nff, ConesAndCylindersHaveTheirAreaAndFaceOutwards) {
    struct Case {
        const char* text;
        double area;
    };
    // pi (r + R) s with s the slant height
    for (const auto& [text, area] : {Case{"c 0 0 0 1 0 0 2 1\n", 4 * kPi}, Case{"c 1 2 3 2 1 5 3 2\n", 12 * kPi},
                                     Case{"c 0 0 0 3 4 0 0 0\n", 15 * kPi}, Case{"c 0 0 0 0 0 4 0 3\n", 15 * kPi},
                                     Case{"c 0 0 0 4 0 3 0 0\n", 20 * kPi}, Case{"c 0 0 0 2 0 0 0 1\n", 3 * kPi}}) {
        const TemporaryFolder folder;
        const Scene scene = load_scene(folder.write("a.nff", kFill + text));
        expect_sound(scene);
        expect_normals_agree(scene);
        EXPECT_NEAR(area_of(scene) / area, 1, 0.02) << text;
        EXPECT_LT(area_of(scene), area);
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) ASSERT_GT(glm::length(area_normal(scene, t)), 0);
        const Box box = bounds(scene);
        if (text[2] == '0') {
            EXPECT_GE(volume_from(scene, dvec3(box.centre())), 0) << text;
        }
    }
}

TEST(Nff, FineWhereTheViewIsNearCoarseWhereItIsFar) {
    const TemporaryFolder folder;
    const std::string matt = "f 1 0.5 0.25 0.6 0 20 0 1\n";
    std::size_t previous   = 1u << 30;
    for (const int distance : {3, 30, 300, 3000}) {
        const Scene scene = load_scene(folder.write(
            "a.nff", fmt::format("v from 0 0 {} at 0 0 0 up 0 1 0 angle 45 hither 0 resolution 512 512\n{}s 0 0 0 1\n",
                                 distance, matt)));
        EXPECT_LE(scene.triangles.size(), previous) << distance;
        previous = scene.triangles.size();
        // The silhouette's chord: r (1 - cos(pi / n)) in pixels, n the number around the equator.
        int n = 0;
        for (const vec3 p : scene.positions) n += std::abs(p.y) < 1e-6f;
        const double pixels = 512 / (2 * std::tan(kPi / 8) * (distance - 1));
        if (n < 96) {
            EXPECT_LE(pixels * (1 - std::cos(kPi / n)), 0.13) << distance;
        }
        EXPECT_GE(n, 8);
    }
    EXPECT_EQ(previous, 48u);
}

/// A body that mirrors or is clear has twice as many segments around, and along: 16 x 8, two rows of which are
/// triangles.
TEST(Nff, TwiceAsFineWhereNeighboursAreMirrored) {
    const TemporaryFolder folder;
    const auto triangles = [&](const std::string& fill) {
        return load_scene(
                   folder.write("a.nff", "v from 0 0 3000 at 0 0 0 up 0 1 0 angle 45 hither 0 resolution 512 512\n" +
                                             fill + "s 0 0 0 1\n"))
            .triangles.size();
    };
    EXPECT_EQ(triangles("f 1 1 1 1 0 1 0 1\n"), 48u);
    EXPECT_EQ(triangles("f 1 1 1 1 0.5 1 0 1\n"), 224u);
    EXPECT_EQ(triangles("f 1 1 1 1 0 1 0.5 1\n"), 224u);
    EXPECT_EQ(triangles(""), 48u) << "before any fill";
}

struct Bad {
    std::string name, text, expected;
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.name; }

class BadNff : public ::testing::TestWithParam<Bad> {};

TEST_P(BadNff, IsRefusedWithPlaceAndReason) {
    const TemporaryFolder folder;
    const auto file           = folder.write("bad.nff", GetParam().text);
    const std::string message = refusal(file);
    EXPECT_EQ(message.rfind(file.string(), 0), 0u) << message;
    EXPECT_NE(message.find(GetParam().expected), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadNff,
    ::testing::ValuesIn(std::vector<Bad>{
        {"empty", "", "holds no surfaces"},
        {"no_surfaces", kView + kFill, "holds no surfaces"},
        {"unknown", kFill + "q 1 2 3\n", ":2:1: unknown entity \"q\" (known: v b l f p pp s c)"},
        {"view_without_at", "v\nfrom 0 0 1\nup 0 1 0\n", ":3:1: found \"up\", expected \"at\""},
        {"angle", "v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\nangle 180\n",
         "the angle of view is 180, expected an angle in degrees"},
        {"resolution", "v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 0 99999999\n",
         ":7:12: the resolution in x is 0"},
        {"view_cut_off", "v\nfrom 0 0 1\nat 0 0", ":3:7: a coordinate of the target is missing"},
        {"light", "l 1 2\n", "a coordinate of the light is missing"},
        {"light_half_coloured", "l 1 2 3 0.5\n" + kFill, "the light's green is missing"},
        {"fill_short", "f 1 1 1 1 1 1 0\ns 0 0 0 1\n", ":2:1: the index of refraction is \"s\""},
        {"fill_negative", "f 1 -1 1 1 1 1 0 1\n", "green of this fill is negative"},
        {"fill_opaque_twice", "f 1 1 1 1 1 1 2 1\n", "T of this fill is above 1"},
        {"two_corners", kFill + "p 2\n0 0 0\n1 0 0\n", ":2:3: a polygon of 2 corners"},
        {"huge_count", kFill + "p 4000000000\n0 0 0\n1 0 0\n", "the file ends after 2 of this polygon's 4000000000"},
        {"negative_count", kFill + "p -3\n", "a polygon of -3 corners"},
        {"nan", kFill + "s 0 nan 0 1\n", ":2:5: a coordinate of the centre is \"nan\""},
        {"infinite_radius", kFill + "s 0 0 0 inf\n", "the radius is \"inf\""},
        {"no_radius", kFill + "s 0 0 0 0\n", ":2:1: a sphere of radius 0"},
        {"thin_cone", kFill + "c 0 0 0 0 0 0 1 0\n", "both radii of this cone are 0"},
        {"mixed_cone", kFill + "c 0 0 0 1 0 0 1 -1\n", "one radius of this cone is negative"},
        {"no_axis", kFill + "c 0 0 0 1 0 0 0 1\n", "base and apex of this cone are the same"},
    }),
    [](const auto& test) { return test.param.name; });

TEST(Nff, NormalsOfPatchesThatAreNotFiniteBecomeTheFaces) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(
        folder.write("a.nff", kFill + "pp 3\n0 0 0 nan 0 1\n1 0 0 0 0 2\n0 1 0 0 0 1\np 3\n0 0 0\n1 0 0\n0 1 0\n"));
    EXPECT_EQ(scene.normals[0], vec3(0));
    EXPECT_EQ(scene.normals[1], vec3(0, 0, 1));
    EXPECT_TRUE(warns(scene, "1 of 3 vertex normals")) << "polygons without normals are not counted";
}

TEST(Nff, SurfacesBeforeAnyFillAreGrey) {
    const TemporaryFolder folder;
    const Scene scene = load_scene(folder.write("a.nff", "s 0 0 0 1\n" + kFill + "s 3 0 0 1\n"));
    EXPECT_EQ(scene.materials.size(), 2u);
    EXPECT_TRUE(warns(scene, "before any fill"));
}

TEST(Nff, AFileOfMerelySpheresIsLimited) {
    // Each of these lines of 12 bytes makes 9,024 triangles: the eye is inside them all.
    std::string text = "v from 0 0 0 at 0 0 1 up 0 1 0 angle 40 hither 0 resolution 512 512\n" + kFill;
    for (int i = 0; i < 3000; ++i) text += "s 0 0 0 1000\n";
    const TemporaryFolder folder;
    EXPECT_NE(refusal(folder.write("a.nff", text)).find("more than 20000000 triangles"), std::string::npos);
}

TEST(Nff, Mutants) {
    expect_survives_mutants("nff",
                            {kView + "b 0 0 1\nl 1 2 3\n" + kFill +
                                 "p 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\npp 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n",
                             kView + kFill + "s 0 0 0 1\nc\n0 0 0 1\n0 0 2 0\nc 1 1 1 -2 3 3 3 -1\ns 1 1 1 -1\n"});
}

}  // namespace
}  // namespace umbra
