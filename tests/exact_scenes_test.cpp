// exact on whole scenes with area lights: floating point against rationals, and against sampling.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <mutex>
#include <random>

#include "core/parallel.h"
#include "core/primitives.h"
#include "core/scene_io.h"
#include "shadows/exact_area.h"
#include "shadows/triangle_tree.h"
#include "tests/method_case.h"

namespace umbra {
namespace {

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
    ExactArea fast(ExactArea::Arithmetic::filtered), slow(ExactArea::Arithmetic::rational);
    fast.build(scene, tree), slow.build(scene, tree);
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        ASSERT_TRUE(is_area(scene.lights[j].kind));
        fast.aim(scene.lights[j]), slow.aim(scene.lights[j]);
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
                EXPECT_LE(difference, kAgree) << "point " << k << ": " << f.visibility << " and " << r.visibility;
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

}  // namespace
}  // namespace umbra
