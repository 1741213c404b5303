// Every method on every scene whose answer is known, and what the contract asks of all methods.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "umbra/core/base/parallel.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

/// Share of the points that a method may get wrong outside the edge band where it says that it only approximates.
constexpr double kApproximateShare = 0.01;

/// The first point that is wrong outside the edge band, in words.
std::string first_wrong(const Scene& scene, const PointBatch& points, LightId light, const VisibilityPlane& got,
                        const VisibilityPlane& known, float tolerance) {
    const auto band = edge_band(points, light, known, tolerance);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, light, i) || !got.defined(i) || !known.defined(i) || band[i]) continue;
        if (std::abs(got.s[i] - known.s[i]) <= tolerance) continue;
        const dvec3 p     = place(scene, points, i);
        const auto pixels = static_cast<std::size_t>(points.raster->width);
        return fmt::format("pixel {} {} at ({}, {}, {}) on {}: S {} instead of {}", i % pixels, i / pixels, p.x, p.y,
                           p.z, scene.objects[scene.triangle_object[points.triangle[i]]].name, got.s[i], known.s[i]);
    }
    return "none";
}

/// The point that is most wrong, in words, of those whose S lies further from what is known than the method states;
/// anywhere, on edges of penumbrae, too.
std::string worst_beyond_bracket(const PointBatch& points, LightId light, const VisibilityPlane& got,
                                 const VisibilityPlane& known) {
    std::string said  = "none";
    double worst      = 1e-6;
    std::size_t asked = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, light, i) || got.answer[i] != Answer::given || !known.defined(i)) continue;
        ++asked;
        const auto bracket  = double(got.half_width[i]);
        const double beyond = std::abs(double(got.s[i]) - double(known.s[i])) - bracket;
        if (beyond <= worst) continue;
        worst = beyond;
        said  = fmt::format("point {}: S {} -+ {} instead of {}", i, got.s[i], bracket, known.s[i]);
    }
    return asked > 0 ? said : "no point was asked";
}

TEST(KnownScenes, BruteForceAgreesWithTheFormulas) {
    for (const NamedScene& named : known_scenes()) {
        const KnownScene known = named.make();
        if (!known.closed_form) continue;
        const PointBatch points = primary(known.scene);
        for (LightId j = 0; j < known.scene.lights.size(); ++j) {
            if (is_area(known.scene.lights[j].kind)) continue;
            const VisibilityPlane formula = by_formula(known, points, j), force = brute_force(known.scene, points, j);
            std::size_t compared = 0, wrong = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (!is_open(points, j, i) || !formula.defined(i) || !force.defined(i)) continue;
                ++compared;
                wrong += formula.s[i] != force.s[i];
            }
            EXPECT_GT(compared, 1000u) << named.name;
            EXPECT_EQ(wrong, 0u) << named.name;
        }
    }
}

TEST(KnownScenes, ShowBothLightAndShadow) {
    // A scene in which a method that always says lit (or never) would pass proves little; few may be so on purpose.
    for (const NamedScene& named : known_scenes()) {
        const KnownScene known  = named.make();
        const PointBatch points = primary(known.scene);
        for (LightId j = 0; j < known.scene.lights.size(); ++j) {
            const VisibilityPlane plane = truth(known, points, j);
            std::size_t lit = 0, umbra = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (!is_open(points, j, i) || !plane.defined(i)) continue;
                lit += plane.s[i] == 1;
                umbra += plane.s[i] == 0;
            }
            EXPECT_GT(lit, 200u) << named.name;
            const bool all_lit = named.name == "light_at_eye" || named.name == "light_over_wall";
            if (!all_lit && named.name != "no_anti_shadows") {
                EXPECT_GT(umbra, 40u) << named.name;
            }
        }
    }
}

class Matrix : public testing::TestWithParam<std::tuple<const MethodInfo*, NamedScene>> {};

TEST_P(Matrix, IsRight) {
    const auto& [info, named] = GetParam();
    const KnownScene known    = named.make();
    MethodCase run(*info, known.scene);
    const Service service = run.serves();
    EXPECT_FALSE(service.why.empty());
    if (!service) GTEST_SKIP() << service.why;

    const PointBatch points = primary(known.scene);
    run.method->build(known.scene, run.facts);
    for (LightId j = 0; j < known.scene.lights.size(); ++j) {
        run.method->aim(j);
        const VisibilityPlane got = run.visibility(points, j), right = truth(known, points, j);
        const LightKind kind    = known.scene.lights[j].kind;
        const float tolerance   = visibility_tolerance(kind);
        const VisibilityError e = visibility_error(points, j, got, right, tolerance);
        EXPECT_GT(e.points, 500u);
        const std::uint64_t interior = e.false_shadow.interior + e.false_light.interior;
        if (service.how >= How::to_rounding) {
            EXPECT_EQ(interior, 0u) << first_wrong(known.scene, points, j, got, right, tolerance);
            if (is_area(kind)) {
                EXPECT_EQ(worst_beyond_bracket(points, j, got, right), "none");
                for (const float half : got.half_width) ASSERT_LE(half, 1e-4f);
            }
        } else if (is_area(kind)) {
            EXPECT_LE(e.mae, known.approximate_mae);
        } else {
            EXPECT_LE(static_cast<double>(interior), kApproximateShare * static_cast<double>(e.points))
                << first_wrong(known.scene, points, j, got, right, tolerance);
        }
    }
}

std::string name_of(const MethodInfo* info) { return std::string(info->name); }

INSTANTIATE_TEST_SUITE_P(All, Matrix,
                         testing::Combine(testing::ValuesIn(methods().begin(), methods().end()),
                                          testing::ValuesIn(known_scenes())),
                         [](const auto& param) {
                             return name_of(std::get<0>(param.param)) + "_" +
                                    std::string(std::get<1>(param.param).name);
                         });

/// What shadows/method.h promises, by each method, on scenes that every kind of method serves somehow.
class Contract : public testing::TestWithParam<const MethodInfo*> {
protected:
    const MethodInfo& info() const { return *GetParam(); }
};

TEST_P(Contract, AnswersAreInRangeAndClosedPointsStayUntouched) {
    for (const char* name : {"two_lights", "open_meshes", "room", "penumbra_of_half_plane"}) {
        const KnownScene known = known_scene(name);
        MethodCase run(info(), known.scene);
        if (!run.serves()) continue;
        const PointBatch points = primary(known.scene);
        for (LightId j = 0; j < known.scene.lights.size(); ++j) {
            run.prepare(j);
            const VisibilityPlane got = run.visibility(points, j);
            std::size_t defined       = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                ASSERT_GE(got.s[i], 0);
                ASSERT_LE(got.s[i], 1);
                ASSERT_LE(got.answer[i], Answer::on_boundary);
                ASSERT_GE(got.half_width[i], 0);
                ASSERT_LE(got.half_width[i], 1);
                if (!is_open(points, j, i)) {
                    ASSERT_EQ(got.s[i], 0);
                    ASSERT_EQ(got.answer[i], Answer::given);
                    ASSERT_EQ(got.half_width[i], 0);
                }
                defined += is_open(points, j, i) && got.defined(i);
                if (!is_area(known.scene.lights[j].kind) && run.serves().how >= How::to_rounding && got.defined(i)) {
                    ASSERT_TRUE(got.s[i] == 0 || got.s[i] == 1);
                }
            }
            EXPECT_GT(defined, 1000u) << name;
        }
    }
}

TEST_P(Contract, SameBitsForAnyNumberOfThreads) {
    for (const char* name : {"two_lights", "badly_oriented", "penumbra_of_half_plane"}) {
        const KnownScene known  = known_scene(name);
        const PointBatch points = primary(known.scene);
        std::vector<VisibilityPlane> planes;
        for (const int threads : {1, 2, 5}) {
            const ThreadLimit limit(threads);
            MethodCase run(info(), known.scene);
            if (!run.serves()) break;
            run.prepare(0);
            planes.push_back(run.visibility(points, 0));
            EXPECT_EQ(planes.back().s, planes.front().s) << name << " with " << threads << " threads";
            EXPECT_EQ(planes.back().answer, planes.front().answer) << name << " with " << threads << " threads";
        }
    }
}

TEST_P(Contract, ABatchWithoutARasterGetsTheSameAnswers) {
    const KnownScene known = known_scene("two_lights");
    MethodCase run(info(), known.scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    const PointBatch raster = primary(known.scene);

    // Every second point, shuffled, with some entries that are no point.
    std::vector<std::size_t> from;
    for (std::size_t i = 0; i < raster.size(); i += 2) from.push_back(i);
    std::shuffle(from.begin(), from.end(), std::mt19937(7));
    PointBatch points;
    points.eye = raster.eye;
    points.resize(from.size());
    for (std::size_t i = 0; i < from.size(); ++i)
        if (raster.triangle[from[i]] != kNoTriangle)
            set_point(points, i, known.scene, raster.triangle[from[i]], raster.u[from[i]], raster.v[from[i]]);
    face_lights(points, known.scene);

    for (LightId j = 0; j < known.scene.lights.size(); ++j) {
        run.prepare(j);
        const VisibilityPlane all = run.visibility(raster, j), some = run.visibility(points, j);
        const auto band       = edge_band(raster, j, truth(known, raster, j), kHardTolerance);
        std::size_t differing = 0, compared = 0;
        for (std::size_t i = 0; i < from.size(); ++i) {
            if (!is_open(points, j, i) || band[from[i]]) continue;
            ++compared;
            differing += all.s[from[i]] != some.s[i] || all.answer[from[i]] != some.answer[i];
        }
        EXPECT_GT(compared, 500u);
        EXPECT_EQ(differing, 0u) << "of " << compared;
    }
}

TEST_P(Contract, PhasesMayBeCalledAgain) {
    KnownScene known = known_scene("two_lights");
    MethodCase run(info(), known.scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    PointBatch points = primary(known.scene);
    run.prepare(1);
    const VisibilityPlane once = run.visibility(points, 1);

    const std::size_t memory = run.method->memory_bytes();
    run.method->aim(0);
    run.method->build(known.scene, run.facts);
    run.method->aim(1);
    EXPECT_EQ(run.visibility(points, 1).s, once.s) << "built again";
    EXPECT_EQ(run.method->memory_bytes(), memory) << "built again";

    // A light moves: aim alone must do, and must give what a new start gives.
    known.scene.lights[1].position += vec3(4, 0.5f, 0);
    face_light(points, known.scene, 1);
    run.method->aim(1);
    const VisibilityPlane moved = run.visibility(points, 1);
    EXPECT_NE(moved.s, once.s);
    MethodCase fresh(info(), known.scene);
    fresh.prepare(1);
    EXPECT_EQ(moved.s, fresh.visibility(points, 1).s) << "aimed again";

    // An object moves: build and aim.
    for (std::size_t p = 4; p < 12; ++p) known.scene.positions[p] += vec3(0.3f, 0, 0.2f);
    points                 = primary(known.scene);
    const SceneFacts facts = find_facts(known.scene);
    run.method->build(known.scene, facts);
    run.method->aim(1);
    MethodCase again(info(), known.scene);
    again.prepare(1);
    EXPECT_EQ(run.visibility(points, 1).s, again.visibility(points, 1).s) << "built again";
}

TEST_P(Contract, AnEmptyBatchIsServed) {
    const KnownScene known = known_scene("two_lights");
    MethodCase run(info(), known.scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    run.prepare(0);
    PointBatch none;
    face_lights(none, known.scene);
    EXPECT_TRUE(run.visibility(none, 0).s.empty());
}

/// Points of the batch that the plane calls dark, as a batch without a raster.
PointBatch dark_points(const Scene& scene, const PointBatch& from, LightId light, const VisibilityPlane& plane) {
    std::vector<std::size_t> dark;
    for (std::size_t i = 0; i < from.size(); ++i)
        if (is_open(from, light, i) && plane.answer[i] == Answer::given && plane.s[i] < 1) dark.push_back(i);
    PointBatch points;
    points.eye = from.eye;
    points.resize(dark.size());
    for (std::size_t k = 0; k < dark.size(); ++k)
        set_point(points, k, scene, from.triangle[dark[k]], from.u[dark[k]], from.v[dark[k]]);
    face_lights(points, scene);
    return points;
}

/// How far the segment to the light passes outside the triangle, as a fraction of the scene: 0 where it crosses it.
double miss(const Scene& scene, const PointBatch& points, std::size_t i, const Light& light, TriangleId t) {
    const dvec3 p   = place(scene, points, i);
    const dvec3 way = light.kind == LightKind::directional ? -dvec3(light.direction) : dvec3(light.position) - p;
    const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
    const dvec3 n      = glm::cross(b - a, c - a);
    const double share = glm::dot(n, a - p) / glm::dot(n, way);
    const dvec3 q      = p + share * way;
    double outside = std::max({0.0, -share, light.kind == LightKind::directional ? 0.0 : share - 1}) * glm::length(way);
    for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}})
        outside = std::max(outside,
                           -glm::dot(glm::cross(to - from, q - from), n) / (glm::length(n) * glm::length(to - from)));
    return outside / static_cast<double>(bounds(scene).diagonal());
}

TEST_P(Contract, BlamesATriangleThatBlocks) {
    std::size_t named = 0, served = 0;
    for (const char* name : {"two_lights", "open_meshes", "room"}) {
        const KnownScene known = known_scene(name);
        MethodCase run(info(), known.scene);
        if (!run.serves()) continue;
        ++served;
        const PointBatch raster = primary(known.scene);
        // What a method samples, as texels of a map, may lie off the segment to the light. One that answers by
        // irradiance interpolates between patches: near a shadow's edge points are dark that nothing hides.
        const bool interpolates  = run.method->measures() == Measure::irradiance;
        const double allowed     = run.serves().how >= How::to_rounding ? 1e-9 : 5e-3;
        const double at_most     = interpolates ? 0.05 : allowed;
        const std::size_t one_in = interpolates ? 5 : 100;
        for (LightId j = 0; j < known.scene.lights.size(); ++j) {
            run.prepare(j);
            const PointBatch dark = dark_points(known.scene, raster, j, run.visibility(raster, j));
            std::vector<TriangleId> who(dark.size(), 12345);
            run.method->blame(dark, j, who);
            std::ptrdiff_t off = 0;
            for (std::size_t i = 0; i < who.size(); ++i) {
                ASSERT_TRUE(who[i] == kNoTriangle || who[i] < known.scene.triangles.size());
                if (who[i] == kNoTriangle) continue;
                ++named;
                const double by = miss(known.scene, dark, i, known.scene.lights[j], who[i]);
                ASSERT_LE(by, at_most) << name << ' ' << i;
                off += by > allowed ? 1 : 0;
            }
            EXPECT_LE(off + std::ranges::count(who, kNoTriangle), std::ptrdiff_t(who.size() / one_in)) << name;
        }
    }
    if (served == 0) GTEST_SKIP() << "it serves none of these scenes";
    EXPECT_GT(named, 500u);
}

TEST_P(Contract, BlamesSomeOccluderOfAnAreaLight) {
    const KnownScene known = known_scene("penumbra_of_half_plane");
    MethodCase run(info(), known.scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    run.prepare(0);
    const PointBatch raster = primary(known.scene);
    const PointBatch dark   = dark_points(known.scene, raster, 0, run.visibility(raster, 0));
    std::vector<TriangleId> who(dark.size(), 12345);
    run.method->blame(dark, 0, who);
    std::size_t right = 0;
    for (std::size_t i = 0; i < who.size(); ++i) {
        ASSERT_TRUE(who[i] == kNoTriangle || who[i] < known.scene.triangles.size());
        right += who[i] != kNoTriangle && who[i] != dark.triangle[i];
    }
    EXPECT_GT(dark.size(), 300u);
    EXPECT_GE(right, dark.size() * 99 / 100);
}

INSTANTIATE_TEST_SUITE_P(All, Contract, testing::ValuesIn(methods().begin(), methods().end()),
                         [](const auto& param) { return name_of(param.param); });

}  // namespace
}  // namespace umbra
