// exact's fraction of irradiance: Lambert's formula on the part of a light that is left, closed forms of spheres, sums
// over many samples, and its two arithmetics.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "umbra/core/render/sampling.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/exact/exact_area.h"
#include "umbra/shadows/geometry/triangle_tree.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

using exact_visibility::AimedLight;
using exact_visibility::AreaOccluders;
using exact_visibility::ExactArea;
using Arithmetic = ExactArea::Arithmetic;
using Real       = long double;
using Real3      = glm::vec<3, Real>;
using Polygon    = std::vector<Real3>;  // in space, convex

void add(Scene& scene, const Mesh& mesh) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    add_object(scene, "part", mesh.positions, {}, mesh.triangles, 0);
}
/// Floor y = 0 of one triangle, and the half-plane x >= 0 at height `sheet`, if any.
Scene floor_scene(float sheet = 0) {
    Scene scene;
    add(scene, Mesh{{{-16, 0, -16}, {-16, 0, 48}, {48, 0, -16}}, {}, {{0, 1, 2}}});
    if (sheet > 0)
        add(scene, Mesh{{{0, sheet, -512}, {512, sheet, -512}, {512, sheet, 512}, {0, sheet, 512}},
                        {},
                        {{0, 2, 1}, {0, 3, 2}}});
    return scene;
}
/// Points of the floor, given by x and z.
PointBatch floor_points(const Scene& scene, const std::vector<dvec2>& places) {
    PointBatch batch;
    batch.eye = vec3(0, 1, 0);
    batch.resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
        set_point(batch, i, scene, 0, static_cast<float>((places[i].y + 16) / 64),
                  static_cast<float>((places[i].x + 16) / 64));
    face_lights(batch, scene);
    return batch;
}
Real3 place_of(const Scene& scene, const PointBatch& points, std::size_t i) {
    const TriangleId t = points.triangle[i];
    const Real3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
    return a + Real(points.u[i]) * (b - a) + Real(points.v[i]) * (c - a);
}
std::vector<dvec2> random_places(std::size_t count, double from, double to) {
    std::vector<dvec2> places(count);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> anywhere(from, to);
    for (dvec2& p : places) p = {anywhere(random), anywhere(random)};
    return places;
}

Light light_of(LightKind kind, vec3 centre, float radius, vec3 edge_u = vec3(1, 0, 0), vec3 edge_v = vec3(0, 0, -1)) {
    Light light;
    light.kind      = kind;
    light.position  = centre;
    light.radius    = radius;
    light.edge_u    = edge_u;
    light.edge_v    = edge_v;
    light.direction = glm::normalize(glm::cross(edge_u, edge_v));
    return light;
}

/// body(i, answer) for each point that light 0 may reach.
template <class Body>
std::uint64_t ask(const Scene& scene, const PointBatch& points, Arithmetic arithmetic, const Body& body) {
    const TriangleTree tree(scene);
    const AreaOccluders among(scene, tree);
    const AimedLight light(scene.lights[0], among.occluders);
    const ExactArea area(among, light, arithmetic, Measure::irradiance);
    ExactArea::Workspace work;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (is_open(points, 0, i))
            body(i, area.seen(points.triangle[i], points.u[i], points.v[i], points.facing[0][i] == Facing::partly,
                              points.flipped[i] ? -1 : 1, work));
    return work.rational_points;
}
constexpr Arithmetic kBoth[] = {Arithmetic::filtered, Arithmetic::rational};

Polygon cut(const Polygon& polygon, const std::function<Real(Real3)>& f) {
    Polygon kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Real3 p = polygon[k], q = polygon[(k + 1) % polygon.size()];
        const Real at_p = f(p), at_q = f(q);
        if (at_p >= 0) kept.push_back(p);
        if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) kept.push_back(p + (q - p) * (at_p / (at_p - at_q)));
    }
    return kept;
}
/// [Daniel Baum et al., Improving Radiosity Solutions Through the Use of Analytically Determined Form-Factors, 1989]
Real lambert(const Polygon& polygon, Real3 p, Real3 n) {
    Real sum = 0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Real3 a = polygon[k] - p, b = polygon[(k + 1) % polygon.size()] - p, c = glm::cross(a, b);
        const Real length = std::sqrt(glm::dot(c, c));
        if (length > 0) sum += glm::dot(c, n) / length * std::atan2(length, glm::dot(a, b));
    }
    return std::abs(sum) / 2;
}

/// Of the half-plane x >= 0 at that height: what is left of its edge, or below it.
void expect_lambert(Scene scene, const Light& light, float sheet, PointBatch points, std::size_t penumbra,
                    double widest) {
    scene.lights = {light};
    face_lights(points, scene);
    const Real3 c(light.position), u(light.edge_u * 0.5f), v(light.edge_v * 0.5f), n(0, 1, 0);
    for (const Arithmetic arithmetic : kBoth) {
        std::size_t between = 0;
        ask(scene, points, arithmetic, [&](std::size_t i, const ExactArea::Answer& got) {
            const Real3 p       = place_of(scene, points, i);
            const Polygon whole = cut({c - u - v, c + u - v, c + u + v, c - u + v}, [](Real3 q) { return q.y; });
            const Real edge     = sheet;
            const auto above    = [&](Real3 q) { return q.y - edge; };
            const auto beyond   = [&](Real3 q) { return q.x * edge - p.x * (edge - q.y); };  // of the edge, times q.y
            const Polygon high = cut(whole, above), hidden = cut(high, beyond);
            const Real all = lambert(whole, p, n), right = 1 - lambert(hidden, p, n) / all;
            EXPECT_NEAR(got.irradiance, double(right), double(got.irradiance_half_width))
                << double(p.x) << ", " << double(p.z);
            EXPECT_LE(got.irradiance_half_width, widest);
            between += right > 1e-6L && right < 1 - 1e-6L;
        });
        EXPECT_GT(between, penumbra);
    }
}

/// Half an ulp of a float, and what is said of the bound.
constexpr double kNarrow = 0x1p-25 + 2e-9;

TEST(ExactIrradiance, MeetsLambertsFormulaUnderAHalfPlane) {
    const Scene scene       = floor_scene(2);
    const PointBatch points = floor_points(scene, random_places(300, -4, 4));
    for (const Light& light :
         {light_of(LightKind::rectangle, vec3(0, 4, 0), 0), light_of(LightKind::rectangle, vec3(0, 2.5f, 0), 0),
          light_of(LightKind::rectangle, vec3(0, 4, 0), 0, vec3(6, 1, 0.5f), vec3(0, 2, -3)),
          light_of(LightKind::rectangle, vec3(0.5f, 3, 1), 0, vec3(0.25f, 0, 0), vec3(0, 0.5f, -4))})
        expect_lambert(scene, light, 2, points, 30, kNarrow);
}

TEST(ExactIrradiance, MeetsLambertsFormulaOfALightThatTheFloorCuts) {
    const Scene scene       = floor_scene(0.5f);
    const PointBatch points = floor_points(scene, random_places(300, -4, 4));
    expect_lambert(scene, light_of(LightKind::rectangle, vec3(1, 0.25f, -5), 0, vec3(3, 1, 0), vec3(0, 2, 0.5f)), 0.5f,
                   points, 30, kNarrow);
    expect_lambert(scene, light_of(LightKind::rectangle, vec3(-1, 0.25f, 5), 0, vec3(2, 0, 0), vec3(0, 3, 0)), 0.5f,
                   points, 30, kNarrow);
}

/// So close that the light's nearest point weighs 1e7 times what its farthest does, the light is cut into many pieces.
TEST(ExactIrradiance, MeetsLambertsFormulaJustBelowALight) {
    const Scene scene       = floor_scene(1.0f / 256);
    const PointBatch points = floor_points(scene, random_places(200, -1.0 / 64, 1.0 / 64));
    expect_lambert(scene, light_of(LightKind::rectangle, vec3(0, 1.0f / 64, 0), 0, vec3(2, 0, 0), vec3(0, 0, -2)),
                   1.0f / 256, points, 50, 1e-6);
}

/// A light that all but touches the points, behind a comb: the part between any two teeth is cut into many pieces
/// beside the point. Beyond kSplits of them nothing is known of what it sends, whereas its visible area still is.
TEST(ExactIrradiance, OfALightThatAllButTouchesThePointBehindACombIsUnknown) {
    for (const unsigned teeth : {16u, 512u}) {
        Scene scene = floor_scene();
        Mesh comb;
        const float pitch = 4 / static_cast<float>(teeth), y = 1.0f / 256;
        for (unsigned k = 0; k < teeth; ++k) {
            const float x = -2 + pitch * static_cast<float>(k);
            for (const vec2 corner : {vec2(x, -4), vec2(x + pitch / 2, -4), vec2(x + pitch / 2, 4), vec2(x, 4)})
                comb.positions.emplace_back(corner.x, y, corner.y);
            comb.triangles.emplace_back(4 * k, 4 * k + 1, 4 * k + 2);
            comb.triangles.emplace_back(4 * k, 4 * k + 2, 4 * k + 3);
        }
        add(scene, comb);
        scene.lights = {light_of(LightKind::rectangle, vec3(0, 1.0f / 64, 0), 0, vec3(16, 0, 0), vec3(0, 0, -16))};
        const PointBatch points = floor_points(scene, random_places(4, -1.0 / 64, 1.0 / 64));
        std::size_t asked       = 0;
        ask(scene, points, Arithmetic::filtered, [&](std::size_t, const ExactArea::Answer& got) {
            EXPECT_NEAR(got.visibility, 0.5, 0.05);
            if (teeth == 16) {
                EXPECT_LT(got.irradiance_half_width, 1e-3f);
            } else {
                EXPECT_EQ(got.irradiance, 0.5f);
                EXPECT_GE(got.irradiance_half_width, 0.5f);
            }
            ++asked;
        });
        EXPECT_EQ(asked, points.size());
    }
}

/// A plane through the point and the axis of the sphere halves the cone of half angle A around the axis e. With m, the
/// plane's normal on the seen side, the half adds n . (e pi sin^2(A) / 2 + m (A - sin(A) cos(A))).
TEST(ExactIrradiance, MeetsTheClosedFormOfAHalvedSphere) {
    for (const float x : {0.0f, 0.5f, 1.0f}) {
        Scene scene  = floor_scene(2);
        scene.lights = {light_of(LightKind::sphere, vec3(-x, 4, 0), 1.5f)};
        std::vector<dvec2> places;
        for (int k = -8; k <= 8; ++k) places.emplace_back(x, k / 4.0);
        const PointBatch points = floor_points(scene, places);
        for (const Arithmetic arithmetic : kBoth) {
            std::size_t asked = 0;
            ask(scene, points, arithmetic, [&](std::size_t i, const ExactArea::Answer& got) {
                const dvec3 p(place_of(scene, points, i)), to = dvec3(-x, 4, 0) - p;
                const double sine = 1.5 / glm::length(to), cosine = std::sqrt(1 - sine * sine);
                const double axis  = to.y / glm::length(to) * kPi * sine * sine;
                const dvec3 normal = glm::normalize(dvec3(-4, -2.0 * x, 0));  // against the edge's plane
                const double right = 0.5 + normal.y * (std::asin(sine) - sine * cosine) / axis;
                EXPECT_NEAR(got.irradiance, right, double(got.irradiance_half_width)) << x << ", " << p.z;
                EXPECT_LT(got.irradiance_half_width, 2e-5f);
                EXPECT_NEAR(got.visibility, 0.5, double(got.half_width));
                ++asked;
            });
            EXPECT_EQ(asked, places.size());
        }
    }
}

/// Sums over N x N points of a round light, N on each of N rings of equal area, each ring turned by the golden ratio so
/// that no edge follows the points. Along an edge a part of 1 / N of them is in doubt, of which most cancels.
TEST(ExactIrradiance, AgreesWithSumsOverRoundLights) {
    constexpr int kSide = 2400;
    for (const LightKind kind : {LightKind::disk, LightKind::sphere}) {
        Scene scene             = floor_scene(1);
        const Light light       = light_of(kind, vec3(0, 1.75f, 0), 1.5f, vec3(1, 0.5f, 0), vec3(0, 0.25f, -1));
        scene.lights            = {light};
        const PointBatch points = floor_points(scene, random_places(16, -1.2, 1.2));
        std::size_t between     = 0;
        ask(scene, points, Arithmetic::filtered, [&](std::size_t i, const ExactArea::Answer& got) {
            const dvec3 p(place_of(scene, points, i));
            DiskAxes axes{};
            dvec3 centre(light.position);
            if (kind == LightKind::disk) {
                axes = disk_axes(light);
            } else {
                TangentDisk disk;
                ASSERT_TRUE(tangent_disk(p, centre, double(light.radius), disk));
                centre = disk.centre, axes = {disk.axis_u, disk.axis_v};
            }
            double all = 0, seen = 0;
            for (int j = 0; j < kSide; ++j)
                for (int k = 0; k < kSide; ++k) {  // rings of equal area
                    const double radius = std::sqrt((j + 0.5) / kSide),
                                 angle  = 2 * kPi * ((k + 0.5) / kSide + 0.6180339887 * j);
                    const dvec3 q = centre + radius * (std::cos(angle) * axes.u + std::sin(angle) * axes.v), d = q - p;
                    if (!(d.y > 0)) continue;
                    const double weight = d.y / (glm::dot(d, d) * glm::dot(d, d));
                    all += weight;
                    if (q.y < 1 || p.x + d.x / d.y < 0) seen += weight;
                }
            EXPECT_NEAR(got.irradiance, seen / all, double(got.irradiance_half_width) + 5e-5) << p.x << ", " << p.z;
            EXPECT_LT(got.irradiance_half_width, 1e-3f);
            between += seen > 0.01 * all && seen < 0.99 * all;
        });
        EXPECT_GT(between, 4u);
    }
}

TEST(ExactIrradiance, IsAllOfALightThatNothingHides) {
    for (const LightKind kind : {LightKind::rectangle, LightKind::disk, LightKind::sphere})
        for (const float height : {0.25f, 3.0f}) {  // the floor cuts the first
            Scene scene             = floor_scene();
            scene.lights            = {light_of(kind, vec3(0, height, 0), 1, vec3(1, 1, 0), vec3(0, 0, -1))};
            const PointBatch points = floor_points(scene, random_places(50, -4, 4));
            std::size_t asked       = 0;
            ask(scene, points, Arithmetic::filtered, [&](std::size_t, const ExactArea::Answer& got) {
                EXPECT_EQ(got.irradiance, 1.0f);
                EXPECT_EQ(got.irradiance_half_width, 0.0f);
                ++asked;
            });
            EXPECT_GT(asked, 30u);
        }
}

/// Seen from afar all points of a light have equal weight: to 8 times its size over its distance.
TEST(ExactIrradiance, OfASmallLightIsItsVisibleArea) {
    for (const LightKind kind : {LightKind::rectangle, LightKind::disk, LightKind::sphere})
        for (const float size : {1e-2f, 1e-4f, 1e-7f}) {
            Scene scene             = floor_scene(2);
            scene.lights            = {light_of(kind, vec3(0, 4, 0), size, vec3(size, 0, 0), vec3(0, 0, -size))};
            const PointBatch points = floor_points(scene, random_places(100, -size, size));
            std::size_t between     = 0;
            ask(scene, points, Arithmetic::filtered, [&](std::size_t, const ExactArea::Answer& got) {
                EXPECT_NEAR(got.irradiance, got.visibility,
                            double(2 * size + got.irradiance_half_width + got.half_width) + 0x1p-24);
                between += got.visibility > 0 && got.visibility < 1;
            });
            EXPECT_GT(between, 30u);
        }
}

/// Triangles anywhere over a floor, and a light of each kind that some of them pass through.
TEST(ExactIrradiance, ItsTwoArithmeticsAgree) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(-1, 1);
    Scene scene = floor_scene();
    add(scene, transformed(make_sphere(0.5f, 8, 5), glm::translate(mat4(1), vec3(0.25f, 0.75f, 0))));
    Mesh leaves;
    for (unsigned k = 0; k < 30; ++k) {
        const vec3 at = vec3(unit(random), unit(random), unit(random)) * vec3(2, 1, 2) + vec3(0, 1.5f, 0);
        for (int j = 0; j < 3; ++j)
            leaves.positions.push_back(at + 0.6f * vec3(unit(random), unit(random), unit(random)));
        leaves.triangles.emplace_back(3 * k, 3 * k + 1, 3 * k + 2);
    }
    add(scene, leaves);
    for (const LightKind kind : {LightKind::rectangle, LightKind::disk, LightKind::sphere}) {
        scene.lights = {light_of(kind, vec3(0.25f, 2.25f, 0), 0.75f, vec3(1.5f, 0.25f, 0), vec3(0, 0.25f, -1))};
        PointBatch points;
        points.eye = vec3(1, 9, 3);
        points.resize(400);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const float a = (unit(random) + 1) / 2, b = (unit(random) + 1) / 2;
            const auto t = static_cast<TriangleId>(i % 2 == 0 ? 0 : random() % scene.triangles.size());
            if (t == 0)
                set_point(points, i, scene, 0, 0.25f + unit(random) / 32, 0.25f + unit(random) / 32);
            else
                set_point(points, i, scene, t, a + b > 1 ? 1 - a : a, a + b > 1 ? 1 - b : b);
        }
        face_lights(points, scene);
        std::vector<ExactArea::Answer> quick(points.size());
        std::size_t open = 0, between = 0;
        const auto fallen = ask(scene, points, Arithmetic::filtered, [&](std::size_t i, const ExactArea::Answer& got) {
            quick[i] = got;
            ++open;
        });
        ask(scene, points, Arithmetic::rational, [&](std::size_t i, const ExactArea::Answer& got) {
            const ExactArea::Answer& fast = quick[i];
            const double difference       = std::abs(double(got.irradiance) - double(fast.irradiance));
            EXPECT_LE(difference, double(got.irradiance_half_width) + double(fast.irradiance_half_width)) << i;
            if (fast.irradiance <= 0 || fast.irradiance >= 1) return;
            EXPECT_LE(difference, 0x1p-24 + 1e-8) << i;
            EXPECT_LE(fast.irradiance_half_width, kind == LightKind::rectangle ? 1e-7f : 3e-3f);
            ++between;
        });
        EXPECT_GT(between, 60u);
        EXPECT_LT(fallen, open / 10);
    }
}

}  // namespace
}  // namespace umbra
