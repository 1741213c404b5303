// The scenes of the project: each loads, warns of nothing, says what it shows, and shows something.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"

namespace umbra {
namespace {

using std::filesystem::path;

std::vector<path> scene_files() {
    std::vector<path> files;
    for (const auto& entry : std::filesystem::directory_iterator(UMBRA_SCENES))
        if (entry.path().extension() == ".json") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

class EveryScene : public testing::TestWithParam<path> {};

TEST_P(EveryScene, LoadsWithoutWarningAndIsSeen) {
    const bool real = GetParam().stem().string().starts_with("real_");
    if (real) {
        // Real scenes need meshes that are obtained at set-up: skipped where one is not there.
        std::ifstream stream(GetParam());
        std::stringstream text;
        text << stream.rdbuf();
        const std::string s = text.str();
        for (std::size_t at = s.find("\"real/"); at != std::string::npos; at = s.find("\"real/", at + 1)) {
            const std::string mesh = s.substr(at + 1, s.find('"', at + 1) - at - 1);
            if (!exists(path(UMBRA_SCENES) / mesh)) GTEST_SKIP() << mesh << " was not obtained";
        }
    }
    const Scene scene = load_scene(GetParam());
    // Scanned meshes have faces without area; umbra whitted alone shows surfaces behind clear ones and in mirrors; and
    // one scene is about materials that reflect more than arrives.
    const std::string name = GetParam().stem().string();
    const auto expected    = [&](const std::string& w) {
        const auto says = [&](const char* what) { return w.find(what) != std::string::npos; };
        if (real) return says("have no area");
        if (name == "mirror_and_glass") return says("is not computed") && !says("opacity");
        if (name == "two_sheets") return says("The opacity of materials");
        return name == "opengl_materials" && says("reflects more light than it receives");
    };
    for (const std::string& w : scene.warnings) EXPECT_TRUE(expected(w)) << w;
    EXPECT_GE(scene.shows.size(), 40u);
    EXPECT_TRUE(scene.shows.ends_with(".")) << "a sentence";
    EXPECT_NE(scene.title, scene.name);
    EXPECT_FALSE(scene.lights.empty());
    EXPECT_EQ(scene.width, 640);
    EXPECT_EQ(scene.height, 360);
    if (!real) {
        EXPECT_LT(scene.triangles.size(), 50'000u) << "small";
        EXPECT_LT(file_size(GetParam()), 8'000u) << "small enough to read";
    }

    // A picture of its own: surfaces in a good part of it, and every object but a few seen.
    const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 160, 90);
    std::vector<int> pixels(scene.objects.size());
    for (const TriangleId t : points.triangle)
        if (t != kNoTriangle) ++pixels[scene.triangle_object[t]];
    EXPECT_GT(
        std::count_if(points.triangle.begin(), points.triangle.end(), [](TriangleId t) { return t != kNoTriangle; }),
        160 * 90 / 3);
    for (std::size_t i = 0; i < pixels.size(); ++i) EXPECT_GT(pixels[i], 0) << scene.objects[i].name << " is not seen";
}

INSTANTIATE_TEST_SUITE_P(All, EveryScene, testing::ValuesIn(scene_files()),
                         [](const auto& scene) { return scene.param.stem().string(); });

}  // namespace
}  // namespace umbra
