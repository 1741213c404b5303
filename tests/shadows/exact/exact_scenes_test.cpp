// exact on whole scenes with area lights: floating point against rationals, and against sampling.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <mutex>
#include <random>

#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/exact/exact_area.h"
#include "umbra/shadows/geometry/triangle_tree.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

using exact_visibility::AimedLight;
using exact_visibility::AreaOccluders;
using exact_visibility::ExactArea;

/// Half an ulp of a float, and twice what each arithmetic may be off.
constexpr double kAgree = 0x1p-24 + 4e-9;

/// Every other point on a triangle drawn by its area, which finds the shadows on grounds; the others on any triangle,
/// which finds those on the meshes.
class RandomPoints {
public:
    RandomPoints(const Scene& scene, unsigned seed) : scene_(scene), random_(seed) {
        double sum = 0;
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
            const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
            areas_.push_back(sum += glm::length(glm::cross(b - a, c - a)));
        }
    }

    PointBatch next(std::size_t count) {
        PointBatch batch;
        batch.eye = scene_.camera.eye;
        batch.resize(count);
        std::uniform_real_distribution<double> unit(0, 1);
        for (std::size_t i = 0; i < count; ++i) {
            auto t = static_cast<TriangleId>(random_() % areas_.size());
            if (i % 2 == 0)
                t = static_cast<TriangleId>(
                    std::lower_bound(areas_.begin(), areas_.end() - 1, unit(random_) * areas_.back()) - areas_.begin());
            const auto a = static_cast<float>(unit(random_)), b = static_cast<float>(unit(random_));
            set_point(batch, i, scene_, t, a + b > 1 ? 1 - a : a, a + b > 1 ? 1 - b : b);
        }
        face_lights(batch, scene_);
        return batch;
    }

private:
    const Scene& scene_;
    std::mt19937 random_;
    std::vector<double> areas_;  ///< running sums
};

struct Answers {
    std::vector<ExactArea::Answer> of;
    std::uint64_t rational_points = 0;
};
Answers ask(const ExactArea& area, const PointBatch& points, LightId light) {
    Answers answers;
    answers.of.resize(points.size());
    std::mutex adding;
    parallel_ranges(points.size(), 16, [&](std::size_t begin, std::size_t end) {
        ExactArea::Workspace work;
        for (std::size_t i = begin; i < end; ++i)
            if (is_open(points, light, i))
                answers.of[i] = area.seen(points.triangle[i], points.u[i], points.v[i],
                                          points.facing[light][i] == Facing::partly, points.flipped[i] ? -1 : 1, work);
        const std::lock_guard lock(adding);
        answers.rational_points += work.rational_points;
    });
    return answers;
}

class AreaLights : public testing::TestWithParam<const char*> {};

/// UMBRA_EXACT_POINTS sets how many points in penumbrae each light is asked at; as many lit or in the umbra follow.
TEST_P(AreaLights, FloatingPointAgreesWithRationals) {
    const char* said         = std::getenv("UMBRA_EXACT_POINTS");
    const std::size_t wanted = said ? std::strtoull(said, nullptr, 10) : 300;
    const Scene scene        = load_scene(fmt::format("{}/{}.json", UMBRA_SCENES, GetParam()));
    const TriangleTree tree(scene);
    const AreaOccluders among(scene, tree);
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        ASSERT_TRUE(is_area(scene.lights[j].kind));
        const AimedLight light(scene.lights[j], among.occluders);
        const ExactArea fast(among, light, ExactArea::Arithmetic::filtered),
            slow(among, light, ExactArea::Arithmetic::rational);
        RandomPoints source(scene, j + 1);
        std::size_t asked = 0, compared = 0;
        std::uint64_t fallen_back = 0, fallen_back_in_penumbra = 0;
        double worst = 0;
        while (compared < wanted && asked < 2000 * wanted) {
            const PointBatch points = source.next(5000);
            const Answers quick     = ask(fast, points, j);
            fallen_back += quick.rational_points;
            std::vector<std::uint32_t> chosen;
            for (std::uint32_t i = 0; i < points.size(); ++i) {
                asked += is_open(points, j, i);
                const float s = quick.of[i].visibility;
                if (s > 0 && s < 1 && compared + chosen.size() < wanted) chosen.push_back(i);
            }
            const std::size_t in_penumbra = chosen.size();
            fallen_back_in_penumbra += ask(fast, pick(points, chosen), j).rational_points;
            for (std::uint32_t i = 0; i < points.size() && chosen.size() < 2 * in_penumbra; ++i)  // lit or in the umbra
                if (is_open(points, j, i) && (quick.of[i].visibility <= 0 || quick.of[i].visibility >= 1))
                    chosen.push_back(i);
            const Answers right = ask(slow, pick(points, chosen), j);
            EXPECT_GE(right.rational_points, chosen.size());
            for (std::size_t k = 0; k < chosen.size(); ++k) {
                const ExactArea::Answer &f = quick.of[chosen[k]], &r = right.of[k];
                const double difference = std::abs(double(f.visibility) - double(r.visibility));
                EXPECT_LE(difference, double(f.half_width) + double(r.half_width) + kAgree) << "point " << k;
                EXPECT_EQ(f.edge_on, r.edge_on);
                // Of a round light that one triangle hides, floating point says 0 and rationals a bracket above it.
                if (k >= in_penumbra) continue;
                // Of a round light rationals leave open what an edge cuts off beyond a polygon.
                EXPECT_LE(difference, kAgree + double(r.half_width))
                    << "point " << k << ": " << f.visibility << " and " << r.visibility;
                EXPECT_LE(r.half_width, 1e-4f);
                worst = std::max(worst, difference);
            }
            compared += in_penumbra;
        }
        EXPECT_EQ(compared, wanted) << scene.lights[j].name << ": too few points in penumbrae";
        const double share    = static_cast<double>(fallen_back) / static_cast<double>(asked);
        const double penumbra = static_cast<double>(fallen_back_in_penumbra) / static_cast<double>(compared);
        fmt::print(
            "{} {}: {} points, differ by at most {:.2g}; in rationals {:.3g} of {} open points, {:.3g} of these\n",
            GetParam(), scene.lights[j].name, compared, worst, share, asked, penumbra);
        // Else the filter is none, and every picture takes a hundred times as long.
        EXPECT_LT(share, 0.02);
        EXPECT_LT(penumbra, 0.1);
    }
}

INSTANTIATE_TEST_SUITE_P(Canonical, AreaLights, testing::Values("umbra_penumbra", "eclipse", "light_sizes"),
                         [](const auto& param) { return std::string(param.param); });

/// Some 80 triangles over a floor, most of them anywhere, and a light of each kind.
Scene thicket(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto anywhere = [&] { return vec3(unit(random), unit(random), unit(random)); };
    Scene scene;
    scene.camera.eye = vec3(1, 9, 3);
    scene.materials.emplace_back();
    const auto add = [&](const Mesh& mesh) { add_object(scene, "part", mesh.positions, {}, mesh.triangles, 0); };
    add(make_plane(6, 6));
    add(transformed(make_sphere(0.5f, 6, 4), glm::translate(mat4(1), vec3(unit(random), 0.75f, unit(random)))));
    Mesh leaves;
    for (unsigned k = 0; k < 40; ++k) {
        const vec3 at = anywhere() * vec3(2, 1, 2) + vec3(0, 1.5f, 0);
        for (int j = 0; j < 3; ++j) leaves.positions.push_back(at + 0.6f * anywhere());
        leaves.triangles.emplace_back(3 * k, 3 * k + 1, 3 * k + 2);
    }
    add(leaves);
    Light light;
    light.position  = vec3(0.25f * unit(random), 4, 0.25f * unit(random));
    light.edge_u    = vec3(1, 0.25f, 0);
    light.edge_v    = vec3(0, 0.25f, -1);
    light.direction = glm::normalize(glm::cross(light.edge_u, light.edge_v));
    light.radius    = 0.5f;
    for (const LightKind kind : {LightKind::rectangle, LightKind::disk, LightKind::sphere}) {
        light.kind = kind;
        light.name = to_string(kind);
        scene.lights.push_back(light);
    }
    return scene;
}

/// Of N rays that are drawn at random, each is blocked or not: their share is off by sqrt(S (1 - S) / N) in the mean.
/// Of the quotients of what each point is off and that number, the squares have the mean 1, and the mean lies within
/// 5 / sqrt(points) of 0. Samples that are well spread are off by less: nowhere by what half a light is off otherwise.
TEST(ExactScenes, SamplingComesToTheSameShares) {
    constexpr int kSamples = 4096;
    for (const unsigned seed : {1u, 2u}) {
        const Scene scene = thicket(seed);
        EXPECT_GE(scene.triangles.size(), 50u);
        const PointBatch points = RandomPoints(scene, seed).next(1500);
        MethodCase exact("exact", scene);
        MethodCase sampled(fmt::format("ray_traced:samples={},sampler=random", kSamples), scene),
            spread(fmt::format("ray_traced:samples={}", kSamples), scene);
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            exact.prepare(j), sampled.prepare(j), spread.prepare(j);
            const VisibilityPlane right = exact.visibility(points, j), noisy = sampled.visibility(points, j),
                                  smooth = spread.visibility(points, j);
            std::size_t counted          = 0;
            double sum = 0, squares = 0, worst = 0, smooth_squares = 0, smooth_worst = 0, outside = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (!is_open(points, j, i) || right.answer[i] != Answer::given) continue;
                const double s = right.s[i], smooth_off = double(smooth.s[i]) - s;
                smooth_worst = std::max(smooth_worst, std::abs(smooth_off));
                if (s * (1 - s) * kSamples < 20) {  // too near 0 or 1 for a normal distribution
                    outside = std::max(outside, std::abs(double(noisy.s[i]) - s));
                    continue;
                }
                const double z = (double(noisy.s[i]) - s) / std::sqrt(s * (1 - s) / kSamples);
                ++counted;
                sum += z, squares += z * z;
                worst = std::max(worst, std::abs(z));
                smooth_squares += smooth_off * smooth_off;
            }
            const auto n = static_cast<double>(counted);
            EXPECT_GT(counted, 300u);
            EXPECT_LT(std::abs(sum / n), 5 / std::sqrt(n));
            EXPECT_NEAR(squares / n, 1, 5 * std::sqrt(2 / n));
            EXPECT_LT(worst, 5.5);
            EXPECT_LT(outside, 5.5 * std::sqrt(20.0) / kSamples);
            EXPECT_LT(std::sqrt(smooth_squares / n), 0.0015);
            EXPECT_LT(smooth_worst, 0.5 / std::sqrt(kSamples));
        }
    }
}

}  // namespace
}  // namespace umbra
