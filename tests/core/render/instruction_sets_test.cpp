// Answers stay the same where Embree runs with other instructions, as it does on other machines. Its kernels fuse
// multiply and add from AVX2 on, and sum in another order with AVX-512: the last bits of its barycentrics differ, so
// that ours are computed without it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/embree_api.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/off_pixel.h"
#include "umbra/core/scene/facts.h"
#include "umbra/tests/support/asked.h"

namespace umbra {
namespace {

std::vector<std::string> instruction_sets() {
    std::vector<std::string> all{"sse2"};
    if (__builtin_cpu_supports("sse4.2")) all.emplace_back("sse4.2");
    if (__builtin_cpu_supports("avx2")) all.emplace_back("avx2");
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl")) all.emplace_back("avx512");
    return all;
}

/// While it lives, Embree's new devices have these instructions and no later ones.
class Limit {
public:
    explicit Limit(const std::string& instructions) { setenv("UMBRA_EMBREE", ("isa=" + instructions).c_str(), 1); }
    ~Limit() { unsetenv("UMBRA_EMBREE"); }
    Limit(const Limit&)            = delete;
    Limit& operator=(const Limit&) = delete;
};

PointBatch seen_with(const std::string& instructions, const Scene& scene) {
    const Limit limit(instructions);
    return primary_points(RayScene(scene), scene, scene.camera, 320, 180);
}

/// Barycentrics as Embree has them, of rays from the eye to points on both sides of the scene's centre.
std::vector<float> embree_with(const std::string& instructions, const Scene& scene) {
    const Limit limit(instructions);
    const RayScene rays(scene);
    const vec3 eye = rays.space().point(scene.camera.eye);
    std::vector<float> all;
    for (int k = 0; k < 400; ++k) {
        RTCRayHit one{};
        const vec3 to = rays.space().point(scene.camera.target) + 0.002f * vec3(k % 20 - 10, 0, k / 20 - 10);
        one.ray.org_x = eye.x, one.ray.org_y = eye.y, one.ray.org_z = eye.z;
        one.ray.dir_x = to.x - eye.x, one.ray.dir_y = to.y - eye.y, one.ray.dir_z = to.z - eye.z;
        one.ray.tfar = kInfinity, one.ray.mask = ~0u, one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        intersect_one(rays.impl().scene, one);
        all.push_back(one.hit.u);
    }
    return all;
}

std::vector<VisibilityPlane> answers_with(const std::string& instructions, const MethodInfo& info, const Scene& scene,
                                          const PointBatch& points) {
    const Limit limit(instructions);
    const SceneFacts facts = find_facts(scene);
    Asked method(info);
    std::vector<VisibilityPlane> planes;
    if (!method.serves(facts)) return planes;
    method.build(scene, facts);
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        method.aim(light);
        planes.push_back(method.visibility(points, light));
    }
    return planes;
}

class InstructionSets : public ::testing::TestWithParam<const char*> {
protected:
    const Scene scene = load_scene(std::string(UMBRA_SCENES) + "/" + GetParam() + ".json");
};

TEST_P(InstructionSets, SeeTheSamePointsToTheBitAndOnTheirPixels) {
    const PointBatch first = seen_with("sse2", scene);
    for (const std::string& instructions : instruction_sets()) {
        const PointBatch points = seen_with(instructions, scene);
        EXPECT_EQ(points.triangle, first.triangle) << instructions;
        EXPECT_EQ(points.u, first.u) << instructions;
        EXPECT_EQ(points.v, first.v) << instructions;
        EXPECT_EQ(off_pixel(scene, points).points, 0u) << instructions;
        // Else the limit limits nothing, and the test compares one thing with itself.
        if (instructions == "avx2") {
            EXPECT_NE(embree_with("avx2", scene), embree_with("sse2", scene));
        }
    }
}

TEST_P(InstructionSets, GiveTheSameBitsOfVisibilityAtTheSamePoints) {
    const PointBatch points = seen_with("sse2", scene);
    for (const MethodInfo* info : methods()) {
        if (info->reference || !info->by_default) continue;  // slow, and without Embree
        const std::vector<VisibilityPlane> first = answers_with("sse2", *info, scene, points);
        for (const std::string& instructions : instruction_sets()) {
            const std::vector<VisibilityPlane> planes = answers_with(instructions, *info, scene, points);
            ASSERT_EQ(planes.size(), first.size());
            for (std::size_t j = 0; j < planes.size(); ++j)
                EXPECT_EQ(planes[j].s, first[j].s) << info->name << ", light " << j << ", " << instructions;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, InstructionSets, ::testing::Values("six_lights", "interpenetrating"),
                         [](const auto& of) { return std::string(of.param); });

}  // namespace
}  // namespace umbra
