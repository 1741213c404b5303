// Lit polygons: where they are known by hand, and against `exact` on random scenes in which visibility is hard to
// decide.
#include "umbra/shadows/atherton/atherton_weiler.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/adversarial_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

Light sun(vec3 direction) {
    Light light;
    light.name = "sun", light.kind = LightKind::directional, light.direction = direction;
    return light;
}

Light lamp(vec3 position) {
    Light light;
    light.name = "lamp", light.position = position;
    return light;
}

/// A right-angled floor of one triangle with sides of 4, and a square sheet of half size 0.5 over (1, h, 1).
Scene sheet_over_floor(float h, const Light& light) {
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "floor", {{0, 0, 0}, {0, 0, 4}, {4, 0, 0}}, {}, {{0, 1, 2}}, 0);
    add_object(scene, "sheet", {{0.5f, h, 0.5f}, {0.5f, h, 1.5f}, {1.5f, h, 1.5f}, {1.5f, h, 0.5f}}, {},
               {{0, 1, 2}, {0, 2, 3}}, 0);
    scene.lights.push_back(light);
    return scene;
}

double area(const std::vector<dvec2>& loop) {
    double twice = 0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
        const dvec2 p = loop[k], q = loop[(k + 1) % loop.size()];
        twice += p.x * q.y - q.x * p.y;
    }
    return twice / 2;
}

double lit_area(const LitPolygons& polygons, TriangleId t) {
    if (polygons.seen(t) == LitPolygons::Seen::lit) return 0.5;
    if (polygons.seen(t) != LitPolygons::Seen::parts) return 0;
    double sum = 0;
    for (const auto& loop : polygons.lit_loops(t)) sum += area(loop);
    return sum;
}

/// Barycentric coordinates are quarters of z and x: the floor has an area of 1/2 there.
TEST(LitPolygons, HaveTheAreasThatAreKnownByHand) {
    for (const bool mirrored : {false, true}) {
        const float side = mirrored ? -1.0f : 1.0f;  // the light below, so that it sees the back of the floor
        struct Case {
            Light light;
            double hidden, u, v;
        };
        for (const Case& known :
             {Case{sun({0, -side, 0}), 1.0 / 16, 0.125, 0.125}, Case{sun({0.5f, -side, 0}), 1.0 / 16, 0.125, 0.25},
              Case{lamp({1, 2 * side, 1}), 4.0 / 16, 0, 0}}) {
            const Scene scene = sheet_over_floor(side, known.light);
            MethodCase method("atherton_weiler", scene);
            method.prepare(0);
            const auto& polygons = as<LitPolygons>(method.aimed());
            ASSERT_EQ(polygons.seen(0), LitPolygons::Seen::parts);
            EXPECT_NEAR(lit_area(polygons, 0), 0.5 - known.hidden, 1e-15);
            double low_u = 1, low_v = 1;
            const auto& loops = polygons.lit_loops(0);
            const auto hole   = std::ranges::min_element(loops, {}, [](const auto& loop) { return area(loop); });
            for (const dvec2 p : *hole) low_u = std::min(low_u, p.x), low_v = std::min(low_v, p.y);
            if (known.hidden < 0.1) {
                EXPECT_EQ(loops.size(), 2u);
                EXPECT_NEAR(low_u, known.u, 1e-15);
                EXPECT_NEAR(low_v, known.v, 1e-15);
            }
            EXPECT_EQ(polygons.seen(1), LitPolygons::Seen::lit);
        }
    }
}

/// A wall that stands on the floor begins its shadow at its foot; one that goes through the floor, too.
TEST(LitPolygons, BeginWhereOccludersMeetTheReceiver) {
    for (const float foot : {0.0f, -1.0f}) {
        Scene scene;
        scene.materials.resize(1);
        add_object(scene, "floor", {{0, 0, 0}, {0, 0, 8}, {8, 0, 0}}, {}, {{0, 1, 2}}, 0);
        add_object(scene, "wall", {{1, foot, 1}, {1, foot, 3}, {1, 1, 3}, {1, 1, 1}}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
        scene.lights.push_back(sun({1, -1, 0}));
        MethodCase method("atherton_weiler", scene);
        method.prepare(0);
        const auto& polygons = as<LitPolygons>(method.aimed());
        EXPECT_NEAR(lit_area(polygons, 0), 0.5 - 2.0 / 64, 1e-15) << foot;
    }
}

TEST(LitPolygons, AgreeWithExactOnAdversarialScenes) {
    std::size_t compared = 0, lit = 0, on_boundary = 0, found_on_boundary = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        const AdversarialScene made = adversarial_scene(seed, LightsWanted::hard, 3, 60);
        MethodCase exact("exact", made.scene), polygons("atherton_weiler", made.scene);
        for (LightId light = 0; light < made.scene.lights.size(); ++light) {
            exact.prepare(light), polygons.prepare(light);
            const VisibilityPlane truth = exact.visibility(made.points, light),
                                  found = polygons.visibility(made.points, light);
            for (std::size_t i = 0; i < made.points.size(); ++i) {
                if (made.points.triangle[i] == kNoTriangle || !made.points.asks(light, i)) continue;
                const std::string where = fmt::format("{} ({}), light {}, triangle {}, u {:a}, v {:a}", made.scene.name,
                                                      made.pattern, made.scene.lights[light].name,
                                                      made.points.triangle[i], made.points.u[i], made.points.v[i]);
                EXPECT_NE(found.answer[i], Answer::undefined) << where;
                if (truth.answer[i] == Answer::on_boundary) {
                    ++on_boundary;
                    found_on_boundary += found.answer[i] == Answer::on_boundary;
                    continue;  // both answers are right
                }
                ++compared;
                lit += truth.s[i] == 1;
                EXPECT_EQ(found.answer[i], Answer::given) << where;
                EXPECT_EQ(found.s[i], truth.s[i]) << where;
            }
        }
        if (HasFailure()) break;
    }
    EXPECT_GT(compared, 20000u);
    EXPECT_GT(lit, compared / 10);
    EXPECT_LT(lit, compared - compared / 10);
    EXPECT_GT(on_boundary, 500u);
    // Most of the others touch a neighbour at the border of their own triangle, where no shadow begins.
    EXPECT_GT(found_on_boundary, 20u);
}

}  // namespace
}  // namespace umbra
