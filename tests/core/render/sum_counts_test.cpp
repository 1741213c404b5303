// Only terms that a scene requires: how often each term of the sum is evaluated.
#include <gtest/gtest.h>

#include <algorithm>

#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/render/sum.h"
#include "umbra/core/scene/facts.h"
#include "umbra/tests/support/lit_everywhere.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

SumCounts counts_of(const Scene& scene, bool lit = true) {
    const PointBatch points            = primary(scene);
    std::vector<VisibilityPlane> plane = lit_everywhere(scene, points);
    if (!lit)
        for (VisibilityPlane& p : plane) std::ranges::fill(p.s, 0.0f);
    const PhongSum sum(scene, *points.raster);
    SumCounts counts;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.triangle[i] != kNoTriangle) sum.count(points, i, shading_normal(scene, points, i), plane, counts);
    return counts;
}

/// Pixels with a surface, and those of them in front of which the only light is.
std::pair<std::uint64_t, std::uint64_t> surfaces_of(const Scene& scene) {
    const PointBatch points = primary(scene);
    std::uint64_t surfaces = 0, facing = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        surfaces += points.triangle[i] != kNoTriangle;
        facing += points.triangle[i] != kNoTriangle && points.asks(0, i);
    }
    return {surfaces, facing};
}

TEST(SumCounts, TermsThatNothingAsksForAreNotEvaluated) {
    Scene scene = load_scene(std::string(UMBRA_SCENES) + "/sun_on_plane.json");
    scene.width = 160, scene.height = 90;
    const auto [surfaces, facing] = surfaces_of(scene);
    ASSERT_FALSE(find_facts(scene).has_specular);
    SumCounts counts = counts_of(scene);
    EXPECT_EQ(counts.sums, surfaces);
    EXPECT_GT(counts.diffuse, facing * 9 / 10);
    EXPECT_LE(counts.diffuse, facing);
    EXPECT_EQ(counts.specular + counts.lobes + counts.ambient + counts.fog, 0u);

    // One element of the scene asks for a term, and it is evaluated there alone.
    const std::uint64_t diffuse = counts.diffuse;
    scene.materials[0].k_s      = vec3(0.2f);
    counts                      = counts_of(scene);
    EXPECT_EQ(counts.diffuse, diffuse);
    EXPECT_GT(counts.specular, 0u);
    EXPECT_LT(counts.specular, diffuse);
    for (Material& m : scene.materials) m.k_s = vec3(0.2f);
    EXPECT_EQ(counts_of(scene).specular, diffuse);
    scene.lights[0].specular = vec3(0);
    EXPECT_EQ(counts_of(scene).specular, 0u) << "a light without a specular colour";
    for (Material& m : scene.materials) m.k_s = vec3(0), m.lobes = {LafortuneLobe{}};
    EXPECT_EQ(counts_of(scene).lobes, diffuse);
    for (Material& m : scene.materials) m.lobes.clear();

    scene.fog.law     = FogLaw::exponential;
    scene.fog.density = 0.1f;
    EXPECT_EQ(counts_of(scene).fog, surfaces);
    scene.lights[0].ambient = vec3(0.1f);
    EXPECT_EQ(counts_of(scene).ambient, 0u) << "a constant is added once, not at each point";
    scene.light_ambient = LightAmbient::attenuated;
    EXPECT_EQ(counts_of(scene).ambient, surfaces);
}

/// Where S_j is 0, no term of the light is evaluated.
TEST(SumCounts, ShadowsCostNoTerms) {
    Scene scene = load_scene(std::string(UMBRA_SCENES) + "/six_lights.json");
    scene.width = 160, scene.height = 90;
    EXPECT_GT(counts_of(scene).specular, 0u);
    const SumCounts dark = counts_of(scene, false);
    EXPECT_EQ(dark.diffuse + dark.specular, 0u);
    EXPECT_EQ(dark.sums, surfaces_of(scene).first);
}

}  // namespace
}  // namespace umbra
