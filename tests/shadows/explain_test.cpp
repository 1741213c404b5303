// Reasons: every method's word for one point, compared with a segment test of this file's own in extended precision.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/asked.h"

namespace umbra {
namespace {

constexpr std::array kScenes{"sun_on_plane", "light_outside_view", "umbra_penumbra", "light_sizes",   "stairs",
                             "self_shadow",  "interpenetrating",   "six_lights",     "low_sun_fence", "three_reasons"};
constexpr std::size_t kPointsAScene = 20;

using Real  = long double;
using Point = std::array<Real, 3>;

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Real length(const Point& a) { return std::sqrt(dot(a, a)); }
Point of(dvec3 v) { return {v.x, v.y, v.z}; }

/// Where the segment from p to q meets the triangle, by the volumes of tetrahedra; NaN where it does not.
Real meets(const Scene& scene, TriangleId t, const Point& p, const Point& q) {
    const Point a = of(dvec3(scene.vertex(t, 0))), b = of(dvec3(scene.vertex(t, 1))), c = of(dvec3(scene.vertex(t, 2)));
    const auto volume = [](const Point& o, const Point& x, const Point& y, const Point& z) {
        return dot(minus(x, o), cross(minus(y, o), minus(z, o)));
    };
    const Real above = volume(a, b, c, p), below = volume(a, b, c, q);
    const Real u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
    // A hair of what the coordinates' rounding makes of a volume.
    const Real most   = std::max({length(minus(a, p)), length(minus(b, p)), length(minus(c, p)), length(minus(q, p))});
    const Real doubt  = 1e-12L * most * most * most;
    const bool inside = (u >= -doubt && v >= -doubt && w >= -doubt) || (u <= doubt && v <= doubt && w <= doubt);
    if (!inside || above * below >= 0) return NAN;
    return above / (above - below);
}

std::vector<std::size_t> spread(const PointBatch& points, LightId light, std::size_t wanted) {
    std::vector<std::size_t> asking, some;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points.asks(light, i)) asking.push_back(i);
    for (std::size_t k = 0; k < wanted && !asking.empty(); ++k)
        some.push_back(asking[(2 * k + 1) * asking.size() / (2 * wanted)]);
    return some;
}

struct Tally {
    std::size_t reasons = 0, blocked = 0, named = 0, lit = 0;
};

void check(const MethodInfo& info, const Scene& scene, const PointBatch& points, LightId light, Asked& method,
           Tally& tally) {
    const VisibilityPlane plane = method.visibility(points, light);
    const auto looked           = method.look(points);
    const bool hard             = !is_area(scene.lights[light].kind);
    for (const std::size_t i : spread(points, light, kPointsAScene / scene.lights.size() + 1)) {
        const Given given{plane.s[i], plane.answer[i]};
        const Reason reason = method.method().explain(method.aimed(), *looked, i, given);
        const std::string where =
            std::string(info.name) + " " + scene.name + " " + scene.lights[light].name + " point " + std::to_string(i);
        ++tally.reasons;
        EXPECT_EQ(reason.verdict, verdict_of(given)) << where;
        EXPECT_FALSE(reason.unit.empty()) << where;
        if (given.answer != Answer::given) continue;
        if (given.s == 1) {
            EXPECT_GT(reason.margin, 0) << where;
            EXPECT_EQ(reason.blocker, kNoTriangle) << where;
            ++tally.lit;
        } else if (given.s == 0) {
            EXPECT_LT(reason.margin, 0) << where;
        } else {
            EXPECT_GE(reason.margin * (given.s - 0.5), 0) << where;
        }
        if (hard && given.s == 0) ++tally.blocked;
        if (given.s < 1) {  // the same triangle as for many points at once
            const auto which   = static_cast<std::uint32_t>(i);
            TriangleId blocker = kNoTriangle;
            method.blame(pick(points, {&which, 1}), light, {&blocker, 1});
            EXPECT_EQ(reason.blocker, blocker) << where;
        }
        if (reason.blocker == kNoTriangle) {
            EXPECT_FALSE(reason.at) << where;
            continue;
        }
        EXPECT_TRUE(scene.blocks(reason.blocker)) << where;
        EXPECT_NE(reason.blocker, points.triangle[i]) << where;
        if (!reason.at) continue;  // a map's occluder need not lie on the segment
        if (hard && given.s == 0) ++tally.named;
        const Real at = meets(scene, reason.blocker, of(exact_position(scene, points, i)), of(reason.towards));
        EXPECT_NEAR(static_cast<double>(at), *reason.at, 1e-6) << where << ", triangle " << reason.blocker;
    }
}

class Explain : public testing::TestWithParam<const MethodInfo*> {};

TEST_P(Explain, TheBlockerBlocksAndTheMarginHasTheAnswersSign) {
    const MethodInfo& info = *GetParam();
    Tally tally;
    for (const char* name : kScenes) {
        const Scene scene = load_scene(std::string(UMBRA_SCENES) + "/" + name + ".json");
        Asked method(info);
        if (!verdict(method.method(), find_facts(scene))) continue;
        method.build(scene);
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 96, 54);
        for (LightId light = 0; light < scene.lights.size(); ++light) {
            method.aim(light);
            check(info, scene, points, light, method, tally);
        }
    }
    EXPECT_GE(tally.reasons, info.name == "brute_force" ? 100u : 20u);
    // Names are there for nearly all shadows of hard lights; a map names what its texel shows, which may lie beside.
    EXPECT_GE(10 * tally.named, 8 * tally.blocked) << tally.named << " of " << tally.blocked;
}

INSTANTIATE_TEST_SUITE_P(All, Explain, testing::ValuesIn(methods().begin(), methods().end()),
                         [](const auto& param) { return std::string(param.param->name); });

TEST(Explain, LitByTheDistanceOfTheNearestOccluder) {
    // A floor at y = 0, a light at y = 4 above (0, 0), and a small triangle at y = 2 beside the segment to (0, 0).
    Scene scene;
    scene.positions       = {{-5, 0, -5}, {5, 0, -5}, {0, 0, 8}, {1, 2, -1}, {2, 2, 0}, {1, 2, 1}};
    scene.triangles       = {{0, 2, 1}, {3, 5, 4}};
    scene.triangle_object = {0, 1};
    scene.objects.resize(2);
    scene.objects[0].triangle_count = scene.objects[1].triangle_count = 1;
    scene.objects[1].first_triangle                                   = 1;
    scene.materials.resize(1);
    Light light;
    light.name     = "lamp";
    light.position = {0, 4, 0};
    scene.lights   = {light};
    PointBatch points;
    points.resize(1);
    points.eye = {0, 3, 0};
    set_point(points, 0, scene, 0, 5.0f / 13, 4.0f / 13);  // near (0, 0, 0)
    face_lights(points, scene);
    const Reason lit = reason_by_geometry(scene, points, 0, 0, {1, Answer::given}, kNoTriangle);
    const dvec3 p    = exact_position(scene, points, 0);
    EXPECT_EQ(lit.verdict, PointVerdict::lit);
    EXPECT_EQ(lit.unit, "world");
    const dvec3 d = glm::normalize(dvec3(0, 4, 0) - p);
    const dvec3 v = dvec3(1, 2, 0) - p;
    EXPECT_NEAR(lit.margin, glm::length(v - glm::dot(v, d) * d), 0.01);
}

}  // namespace
}  // namespace umbra
