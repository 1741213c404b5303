// Reasons: every method's word for one point, compared with a segment test of this file's own in extended precision.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/shadows/cascades/cascaded_maps.h"
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

/// Null where the reason has none of that name.
const Evidence* find_evidence(const Reason& reason, std::string_view name) {
    const auto found = std::ranges::find(reason.evidence, name, &Evidence::name);
    return found == reason.evidence.end() ? nullptr : &*found;
}
/// NaN where it has none, or no number.
double number_of(const Reason& reason, std::string_view name) {
    const Evidence* found = find_evidence(reason, name);
    const auto* value     = found ? std::get_if<double>(&found->value) : nullptr;
    return value ? *value : NAN;
}
std::string text_of(const Reason& reason, std::string_view name) {
    const Evidence* found = find_evidence(reason, name);
    const auto* value     = found ? std::get_if<std::string>(&found->value) : nullptr;
    return value ? *value : std::string();
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

TEST(Explain, OfACascadeHoldsWhatTheWholeMapHolds) {
    constexpr int kTexels = 512;
    for (const char* name : {"sun_on_plane", "low_sun_fence"}) {
        const Scene scene       = load_scene(std::string(UMBRA_SCENES) + "/" + name + ".json");
        const SceneFacts facts  = find_facts(scene);
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 96, 54);
        for (const char* settings : {"filter=nearest", "filter=pcf,radius=4,blend=0.5", "depth_range=visible"}) {
            const CascadedMaps method(
                parse_method("cascaded_maps:resolution=" + std::to_string(kTexels) + "," + settings).settings);
            const auto built  = method.build(scene, facts);
            const auto aimed  = method.aim(*built, 0);
            const auto looked = method.look(*built, points);
            VisibilityPlane plane(points.size());
            method.visibility(*aimed, *looked, plane.out());

            const Cascades fit = method.fit(*aimed, *looked).value();
            const SelectedCasters casters(as<BuiltCasters>(*built).casters, scene.lights[0]);
            std::vector<MapView> maps;
            for (std::size_t k = 0; k <= fit.parts.size(); ++k) {
                const LightFrame& frame = k < fit.parts.size() ? fit.parts[k].frame : fit.whole.frame;
                maps.push_back({frame, DepthMap(kTexels, kTexels, DepthFormat::float32)});
                const dmat4 clip_from_world = frame.clip_from_world();
                maps.back().map.draw(clip_from_world, scene.positions, casters.seen_by(clip_from_world), Faces::all);
            }
            std::size_t compared = 0, blocked = 0;
            for (const std::size_t i : spread(points, 0, 100)) {
                const std::string where = std::string(name) + " " + settings + " point " + std::to_string(i);
                const Given given{plane.s[i], plane.answer[i]};
                const Reason reason = method.explain(*aimed, *looked, i, given);
                EXPECT_EQ(reason.verdict, verdict_of(given)) << where;
                const double k = number_of(reason, "map");
                if (std::isnan(k) || text_of(reason, "texel").starts_with("outside")) continue;  // nothing casts there
                const MapView& view = maps.at(static_cast<std::size_t>(k));
                int x = -1, y = -1;
                char comma = 0;
                std::istringstream(text_of(reason, "texel")) >> x >> comma >> y;
                ASSERT_TRUE(x >= 0 && x < kTexels && y >= 0 && y < kTexels) << where;
                EXPECT_EQ(number_of(reason, "stored depth"), view.frame.depth(view.map.nearness(x, y))) << where;
                ++compared;
                blocked += reason.blocker != kNoTriangle;
            }
            EXPECT_GE(compared, 10u) << name << " " << settings;
            EXPECT_GE(blocked, 1u) << name << " " << settings;
        }
    }
}

TEST(Explain, ThePointLiesInTheTexelThatWasCompared) {
    for (const char* name : {"sun_on_plane", "low_sun_fence", "six_lights", "stairs"}) {
        const Scene scene       = load_scene(std::string(UMBRA_SCENES) + "/" + name + ".json");
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 96, 54);
        for (const char* maps : {"shadow_zbuffer:resolution=256", "cascaded_maps:resolution=256"}) {
            Asked method(maps);
            if (!method.serves(find_facts(scene))) continue;
            method.build(scene);
            const auto looked = method.look(points);
            std::size_t drawn = 0;
            for (LightId light = 0; light < scene.lights.size(); ++light) {
                method.aim(light);
                const VisibilityPlane plane = method.visibility(points, light);
                for (const std::size_t i : spread(points, light, 80)) {
                    const Reason reason =
                        method.method().explain(method.aimed(), *looked, i, {plane.s[i], plane.answer[i]});
                    const std::string where = fmt::format("{} {} {} point {}", name, maps, scene.lights[light].name, i);
                    if (reason.texel.empty()) continue;
                    ASSERT_EQ(reason.texel.size(), 4u) << where;
                    ++drawn;
                    const dvec3 p      = exact_position(scene, points, i);
                    const dvec3 to     = glm::normalize(reason.towards - p);
                    const double width = number_of(reason, "width of the texel");
                    // Seen along the light's way: what lies in the texel's cone there is in the texel.
                    const double turn =
                        glm::dot(glm::cross(reason.texel[1] - reason.texel[0], reason.texel[2] - reason.texel[1]), to);
                    double longest = 0;
                    for (std::size_t k = 0; k < 4; ++k) {
                        const dvec3 a = reason.texel[k], side = reason.texel[(k + 1) % 4] - a;
                        EXPECT_GE(glm::dot(glm::cross(side, p - a), to) * turn, -1e-6 * turn * turn) << where;
                        longest = std::max(longest, glm::length(side - glm::dot(side, to) * to));
                    }
                    // Of a lamp, a texel beside the view's axis is seen from further away, and askew.
                    const bool lamp = scene.lights[light].kind != LightKind::directional;
                    EXPECT_LE(longest, 1.05 * width) << where;
                    EXPECT_GE(longest, (lamp ? 0.5 : 0.999) * width) << where;
                }
            }
            EXPECT_GE(drawn, 10u) << name << " " << maps;
        }
    }
}

/// The samples of a reason lie on the light, are as many as make the answer, and see what segments of this file see.
TEST(Explain, OfRaysShowsTheSamplesThatMakeTheAnswer) {
    const Scene scene       = load_scene(std::string(UMBRA_SCENES) + "/umbra_penumbra.json");
    const Light& lamp       = scene.lights[0];
    const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 96, 54);
    Asked method("ray_traced:samples=16");
    method.build(scene);
    method.aim(0);
    const auto looked           = method.look(points);
    const VisibilityPlane plane = method.visibility(points, 0);
    std::size_t partly = 0, samples = 0, unlike = 0;
    for (const std::size_t i : spread(points, 0, 120)) {
        const Reason reason = method.method().explain(method.aimed(), *looked, i, {plane.s[i], plane.answer[i]});
        const auto seen     = static_cast<std::size_t>(std::ranges::count_if(reason.samples, &LightSample::seen));
        EXPECT_EQ(static_cast<float>(seen) / 16, plane.s[i]) << i;
        partly += seen > 0 && seen < 16;
        const Point p = of(exact_position(scene, points, i));
        for (const LightSample& sample : reason.samples) {
            const dvec3 at = sample.at - dvec3(lamp.position), u(lamp.edge_u), v(lamp.edge_v);
            EXPECT_LE(std::abs(glm::dot(at, u)), 0.50001 * glm::dot(u, u)) << i;
            EXPECT_LE(std::abs(glm::dot(at, v)), 0.50001 * glm::dot(v, v)) << i;
            EXPECT_LE(std::abs(glm::dot(at, glm::normalize(glm::cross(u, v)))), 1e-4) << i;
            bool blocked = false;
            for (TriangleId t = 0; t < scene.triangles.size() && !blocked; ++t)
                blocked = t != points.triangle[i] && !std::isnan(meets(scene, t, p, of(sample.at)));
            ++samples;
            unlike += blocked == sample.seen;
        }
    }
    EXPECT_GT(partly, 5u);
    EXPECT_LE(unlike, samples / 200) << "of " << samples;
}

/// The edges of a reason are the blocker's own, and close: each vertex ends an even number of them.
TEST(Explain, OfVolumesShowsTheSilhouetteOfTheBlocker) {
    for (const char* name : {"sun_on_plane", "light_outside_view", "stairs"}) {
        const Scene scene       = load_scene(std::string(UMBRA_SCENES) + "/" + name + ".json");
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 96, 54);
        Asked method("shadow_volumes");
        method.build(scene);
        method.aim(0);
        const auto looked           = method.look(points);
        const VisibilityPlane plane = method.visibility(points, 0);
        std::size_t drawn           = 0;
        for (const std::size_t i : spread(points, 0, 60)) {
            const Reason reason = method.method().explain(method.aimed(), *looked, i, {plane.s[i], plane.answer[i]});
            EXPECT_EQ(reason.silhouette.empty(), reason.blocker == kNoTriangle) << name << i;
            if (reason.blocker == kNoTriangle) continue;
            ++drawn;
            const Object& object = scene.objects[scene.triangle_object[reason.blocker]];
            std::map<std::array<double, 3>, int> ends;
            for (const auto& edge : reason.silhouette)
                for (const dvec3& v : edge) ++ends[{v.x, v.y, v.z}];
            for (const auto& [v, count] : ends) {
                EXPECT_EQ(count % 2, 0) << name << i;
                bool own = false;
                for (std::uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
                    for (int k = 0; k < 3; ++k) own |= dvec3(scene.vertex(t, k)) == dvec3(v[0], v[1], v[2]);
                EXPECT_TRUE(own) << name << i;
            }
        }
        EXPECT_GT(drawn, 0u) << name;
    }
}

/// Outlines as the evidence has them: "x y, x y | x y, ...".
std::vector<std::vector<dvec2>> outlines_of(const std::string& text) {
    std::vector<std::vector<dvec2>> all;
    std::istringstream lines(text);
    for (std::string line, corner; std::getline(lines, line, '|');) {
        all.emplace_back();
        for (std::istringstream corners(line); std::getline(corners, corner, ',');) {
            dvec2 c(NAN);
            std::istringstream(corner) >> c.x >> c.y;
            all.back().push_back(c);
        }
    }
    return all;
}

TEST(Explain, OfAnAreaLightHasTheOutlineOfWhatIsVisible) {
    for (const char* name : {"umbra_penumbra", "light_sizes"}) {
        const Scene scene       = load_scene(std::string(UMBRA_SCENES) + "/" + name + ".json");
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 96, 54);
        for (const bool rational : {false, true}) {
            Asked method(rational ? "exact:arithmetic=rational" : "exact");
            method.build(scene);
            const auto looked    = method.look(points);
            std::size_t outlined = 0, rectangles = 0;
            for (LightId light = 0; light < scene.lights.size(); ++light) {
                method.aim(light);
                const bool rectangle = scene.lights[light].kind == LightKind::rectangle;
                rectangles += rectangle;
                for (const std::size_t i : spread(points, light, rational ? 3 : 60)) {
                    const auto which    = static_cast<std::uint32_t>(i);
                    const auto answered = method.visibility(pick(points, {&which, 1}), light);
                    const Given given{answered.s[0], answered.answer[0]};
                    const Reason reason     = method.method().explain(method.aimed(), *looked, i, given);
                    const std::string where = scene.lights[light].name + " point " + std::to_string(i);
                    const double share      = number_of(reason, "visible area");
                    EXPECT_NEAR(share, static_cast<double>(given.s), 1e-6) << where;
                    EXPECT_GE(number_of(reason, "visible pieces"), share > 1e-6 ? 1 : 0) << where;
                    EXPECT_GE(number_of(reason, "silhouette edges"), share > 0 && share < 1 ? 1 : 0) << where;
                    EXPECT_FALSE(text_of(reason, "arithmetic").empty()) << where;
                    EXPECT_TRUE(!rational || text_of(reason, "arithmetic") == "rationals, as set") << where;

                    double twice_area   = 0;
                    const auto outlines = outlines_of(text_of(reason, "corners in half axes"));
                    for (const std::vector<dvec2>& outline : outlines)
                        for (std::size_t k = 0; k < outline.size(); ++k) {
                            const dvec2 a = outline[k], b = outline[(k + 1) % outline.size()];
                            twice_area += a.x * b.y - a.y * b.x;
                            EXPECT_LE(rectangle ? std::max(std::abs(a.x), std::abs(a.y)) : glm::length(a), 1.0001)
                                << where;
                        }
                    if (!rectangle || outlines.empty()) continue;
                    EXPECT_NEAR(twice_area / 8, share, 1e-3) << where;
                    ++outlined;
                }
            }
            EXPECT_GE(outlined, rectangles) << name;
        }
    }
}

}  // namespace
}  // namespace umbra
