// exact for area lights with visible fractions from a formula: lights that are tilted, that the point's own plane cuts,
// that occluders touch, enclose or pass through.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

using Real = long double;
struct Place {  // of a light's plane
    Real x, y;
};
using Polygon = std::vector<Place>;
struct Real3 {
    Real x, y, z;
};
Real3 real(vec3 v) { return {v.x, v.y, v.z}; }
Real3 operator+(Real3 a, Real3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Real3 operator-(Real3 a, Real3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Real3 operator*(Real s, Real3 a) { return {s * a.x, s * a.y, s * a.z}; }
Real dot(Real3 a, Real3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Real3 cross(Real3 a, Real3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

/// Where the point of that name lies, as its floats say.
Real3 exact_place(const Scene& scene, const PointBatch& points, std::size_t i) {
    const TriangleId t = points.triangle[i];
    const Real3 a = real(scene.vertex(t, 0)), b = real(scene.vertex(t, 1)), c = real(scene.vertex(t, 2));
    return a + Real(points.u[i]) * (b - a) + Real(points.v[i]) * (c - a);
}

/// The part of a convex polygon where f >= 0, `f` linear.
Polygon clip(const Polygon& polygon, const std::function<Real(Place)>& f) {
    Polygon kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Place p = polygon[k], q = polygon[(k + 1) % polygon.size()];
        const Real at_p = f(p), at_q = f(q);
        if (at_p >= 0) kept.push_back(p);
        if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) {
            const Real t = at_p / (at_p - at_q);
            kept.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
        }
    }
    return kept;
}
Real area(const Polygon& p) {
    Real sum = 0;
    for (std::size_t k = 0; k < p.size(); ++k) {
        const Place &a = p[k], &b = p[(k + 1) % p.size()];
        sum += a.x * b.y - b.x * a.y;
    }
    return std::abs(sum) / 2;
}
const Polygon kWhole{
    {-0.5L, -0.5L}, {0.5L, -0.5L}, {0.5L, 0.5L}, {-0.5L, 0.5L}};  // area 1: centre + x edge_u + y edge_v

/// Positive at the points of the light that lie, seen from p, on one side of the edge from a to b.
/// Seen from a point below, an edge that runs anticlockwise from above has its inside there.
std::function<Real(Place)> beside(const Light& light, Real3 p, Real3 a, Real3 b) {
    const Real3 n        = cross(a - p, b - p);
    const Real at_centre = dot(n, real(light.position) - p), u = dot(n, real(light.edge_u)),
               v = dot(n, real(light.edge_v));
    return [=](Place q) { return at_centre + q.x * u + q.y * v; };
}

Light rectangle(vec3 centre, vec3 edge_u, vec3 edge_v) {
    Light light;
    light.name      = "window";
    light.kind      = LightKind::rectangle;
    light.position  = centre;
    light.edge_u    = edge_u;
    light.edge_v    = edge_v;
    light.direction = glm::normalize(glm::cross(edge_u, edge_v));
    return light;
}
/// A rectangle turned by `turn` in its plane, its normal turned from -y by `tilt` about z and then by `round` about y.
Light askew(vec3 centre, float width, float depth, double turn, double tilt, double round) {
    const auto turned = [&](double x, double z) {
        const double x1 = x * std::cos(turn) - z * std::sin(turn), z1 = x * std::sin(turn) + z * std::cos(turn);
        const double x2 = x1 * std::cos(tilt), y2 = x1 * std::sin(tilt);
        return vec3(
            dvec3(x2 * std::cos(round) + z1 * std::sin(round), y2, z1 * std::cos(round) - x2 * std::sin(round)));
    };
    return rectangle(centre, turned(width, 0), turned(0, -depth));
}

void add(Scene& scene, const Mesh& mesh) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    add_object(scene, "part", mesh.positions, {}, mesh.triangles, 0);
}
Mesh quad(vec3 a, vec3 b, vec3 c, vec3 d) { return Mesh{{a, b, c, d}, {}, {{0, 1, 2}, {0, 2, 3}}}; }

/// A floor of two triangles, an eye above it.
Scene floor_scene() {
    Scene scene;
    scene.camera.eye = vec3(1, 9, 3);
    add(scene, make_plane(8, 8));
    return scene;
}

/// Random points of triangles 0 .. count - 1.
PointBatch points_on_first(const Scene& scene, TriangleId triangles, std::size_t count, vec3 eye = vec3(1, 9, 3)) {
    PointBatch batch;
    batch.eye = eye;
    batch.resize(count);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    for (std::size_t i = 0; i < count; ++i) {
        const float a = unit(random), b = unit(random);
        set_point(batch, i, scene, static_cast<TriangleId>(random() % triangles), a + b > 1 ? 1 - a : a,
                  a + b > 1 ? 1 - b : b);
    }
    face_lights(batch, scene);
    return batch;
}

using Formula = std::function<Real(Real3 p, LightId light)>;

/// Of the light: what `exact` states of areas in floating point.
constexpr double kSlack = 1e-9;

struct Found {
    std::size_t lit = 0, umbra = 0, penumbra = 0, partly = 0;
};
/// Compares both arithmetics with the formula at every point that a light may reach: to half an ulp of the answer, and
/// kSlack.
Found expect_meets(const Scene& scene, const PointBatch& points, const Formula& formula) {
    Found found;
    for (const char* choice : {"exact", "exact:arithmetic=rational"}) {
        MethodCase run(choice, scene);
        run.build();
        found = {};
        std::string where;
        double worst      = 0;
        std::size_t wrong = 0;
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            run.aim(j);
            const VisibilityPlane got = run.visibility(points, j);
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (!is_open(points, j, i)) continue;
                const Real3 p    = exact_place(scene, points, i);
                const Real right = formula(p, j);
                const double off = double(std::abs(Real(got.s[i]) - right) - 0x1p-24L * right);  // beyond half an ulp
                if (off > worst)
                    worst = off, where = fmt::format("light {} at ({}, {}, {}): {} instead of {}", j, double(p.x),
                                                     double(p.y), double(p.z), got.s[i], double(right));
                wrong += off > kSlack;
                EXPECT_EQ(got.answer[i], Answer::given);
                found.lit += right == 1;
                found.umbra += right == 0;
                found.penumbra += right > 0 && right < 1;
                found.partly += points.facing[j][i] == Facing::partly;
            }
        }
        EXPECT_EQ(wrong, 0u) << choice << ", " << where;
    }
    return found;
}

TEST(ExactClosedForms, HalfPlaneUnderRectanglesThatStandAskew) {
    Scene scene = floor_scene();
    add(scene, quad({0, 2, -64}, {64, 2, -64}, {64, 2, 64}, {0, 2, 64}));
    scene.lights      = {askew({0, 4, 0}, 1.5f, 1, 0.4, 0, 0), askew({0.25f, 4, 0.5f}, 2, 0.5f, 1.1, 0.5, 0.3),
                         askew({0, 5, -1}, 0.3f, 3, -0.7, -0.9, 2), askew({-1, 4, 0}, 1, 1, 0.78, 1.4, 0.2)};
    const Found found = expect_meets(scene, points_on_first(scene, 2, 1500), [&](Real3 p, LightId j) {
        // What is left of the plane through p and the edge x = 0, y = 2 is seen; p is below, left is x -> -infinity.
        const Light& light = scene.lights[j];
        return area(clip(kWhole, beside(light, p, {0, 2, 1}, {0, 2, -1}))) / area(kWhole);
    });
    EXPECT_GT(found.penumbra, 400u);
    EXPECT_GT(found.lit, 400u);
    EXPECT_GT(found.umbra, 400u);
}

TEST(ExactClosedForms, PolygonOfManyCornersBeforeARectangle) {
    // A fan of 64 triangles whose hub is no corner of its outline, round enough to be a disk to the eye.
    constexpr int kCorners = 64;
    Scene scene            = floor_scene();
    const Mesh disk        = make_disk(0.6f, kCorners);
    Mesh raised            = disk;
    for (vec3& q : raised.positions) q += vec3(0.125f, 2, -0.25f);
    const std::size_t first = scene.positions.size();
    add(scene, raised);
    scene.lights = {rectangle({0, 4, 0}, {1, 0, 0}, {0, 0, -1}), askew({0.5f, 4.5f, 0}, 2.5f, 2, 0.6, 0.4, 0.7),
                    rectangle({0.125f, 3, -0.25f}, {0.25f, 0, 0}, {0, 0, -0.25f})};
    std::vector<Real3> rim;
    for (std::size_t k = first; k < scene.positions.size(); ++k) {
        const vec3 q = scene.positions[k];
        if (std::hypot(q.x - 0.125f, q.z + 0.25f) > 0.3f) rim.push_back(real(q));
    }
    std::sort(rim.begin(), rim.end(), [](Real3 a, Real3 b) {
        return std::atan2(a.z + 0.25L, a.x - 0.125L) < std::atan2(b.z + 0.25L, b.x - 0.125L);
    });
    rim.erase(std::unique(rim.begin(), rim.end(), [](Real3 a, Real3 b) { return a.x == b.x && a.z == b.z; }),
              rim.end());
    ASSERT_EQ(rim.size(), std::size_t(kCorners));
    const Found found = expect_meets(scene, points_on_first(scene, 2, 2500), [&](Real3 p, LightId j) {
        Polygon hidden = kWhole;
        for (std::size_t k = 0; k < rim.size() && !hidden.empty(); ++k)
            hidden = clip(hidden, beside(scene.lights[j], p, rim[(k + 1) % rim.size()], rim[k]));
        return 1 - area(hidden);
    });
    EXPECT_GT(found.penumbra, 400u);
    EXPECT_GT(found.lit, 400u);
    EXPECT_GT(found.umbra, 10u);
}

TEST(ExactClosedForms, LightsThatThePlaneOfThePointCuts) {
    // Lights that reach below the floor, with and without the half-plane x >= 0 at height 0.5.
    for (const bool blocked : {false, true}) {
        Scene scene = floor_scene();
        if (blocked) add(scene, quad({0, 0.5f, -64}, {64, 0.5f, -64}, {64, 0.5f, 64}, {0, 0.5f, 64}));
        scene.lights      = {askew({1, 0.25f, -5}, 3, 2, 0.3, 1.2, 1.9), askew({-5, 0.5f, 0.5f}, 2, 3, -0.2, 1.3, 0.1),
                             rectangle({0.25f, 0.125f, 5}, {3, 0, 0}, {0, 1, 0})};
        const Found found = expect_meets(scene, points_on_first(scene, 2, 1500), [&](Real3 p, LightId j) {
            const Light& light = scene.lights[j];
            const auto height  = [&](Place q) -> Real {
                return real(light.position).y + q.x * real(light.edge_u).y + q.y * real(light.edge_v).y;
            };
            const Polygon above = clip(kWhole, height);
            if (!blocked) return area(above);
            // Hidden is what is above 0.5 and right of the edge.
            const Polygon high = clip(above, [&](Place q) { return height(q) - 0.5L; });
            const Polygon over = clip(high, beside(light, p, {0, 0.5L, -1}, {0, 0.5L, 1}));
            return area(above) - area(over);
        });
        EXPECT_GT(found.partly, 4000u);
        EXPECT_GT(found.penumbra, 4000u);
    }
}

TEST(ExactClosedForms, AWallThatStandsOnThePoint) {
    // A wall over the diagonal of the floor, part of whose foot is the very edge on which the points lie: they touch
    // it.
    Scene scene  = floor_scene();
    const vec3 a = scene.vertex(0, 0), b = scene.vertex(0, 1);
    add(scene, quad(a, b, b + vec3(0, 16, 0), a + vec3(0, 16, 0)));
    scene.lights = {askew((a + b) * 0.5f + vec3(0, 4, 0), 1.5f, 1, 0.4, 0.3, 0.9),
                    askew((a + b) * 0.5f + vec3(0.25f, 3, 0.25f), 1, 1, 0.8, 0, 0)};
    PointBatch points;
    points.eye = scene.camera.eye;
    points.resize(200);
    for (std::size_t i = 0; i < points.size(); ++i)  // on the edge, and a little beside it
        set_point(points, i, scene, 0, 0.1f + 0.004f * static_cast<float>(i), i % 2 == 0 ? 0 : 1e-5f);
    face_lights(points, scene);
    const Real3 foot = real(a), along = real(b) - real(a);
    const Real3 n     = cross(along, {0, 1, 0});  // of the wall's plane
    const Real third  = dot(n, real(scene.vertex(0, 2)) - foot);
    const Found found = expect_meets(scene, points, [&](Real3 p, LightId j) -> Real {
        // From the edge itself the wall is seen edge-on and hides nothing; from beside it, what is behind it.
        if (std::abs(dot(n, p - foot)) == 0) return 1;
        const Light& light = scene.lights[j];
        const Real turn    = third > 0 ? 1 : -1;
        return area(clip(kWhole, [&](Place q) {
            return turn * (dot(n, real(light.position) - foot) + q.x * dot(n, real(light.edge_u)) +
                           q.y * dot(n, real(light.edge_v)));
        }));
    });
    EXPECT_EQ(found.lit, points.size());
    EXPECT_GT(found.penumbra, points.size() / 2);
}

TEST(ExactClosedForms, ALightInAClosedBox) {
    Scene scene = floor_scene();
    Mesh lamp   = make_box(vec3(2, 2, 2));  // above the floor
    for (vec3& q : lamp.positions) q += vec3(0, 3, 0);
    add(scene, lamp);
    // Within it, a board, which is all that hides anything there.
    // 0.75].
    add(scene, quad({0, 2.5f, -0.875f}, {0.75f, 2.5f, -0.875f}, {0.75f, 2.5f, 0.875f}, {0, 2.5f, 0.875f}));
    scene.lights = {askew({0.125f, 3.5f, 0}, 0.75f, 0.5f, 0.4, 0.3, 0.2), askew({0, 3.25f, 0}, 0.25f, 1, 0, -0.4, 0)};
    const PointBatch outside = points_on_first(scene, 2, 500);
    const Found dark         = expect_meets(scene, outside, [](Real3, LightId) -> Real { return 0; });
    EXPECT_EQ(dark.umbra, 1000u);

    // Inside: the box's floor, y = 2, seen from within.
    PointBatch inside;
    inside.eye = vec3(0, 3, 0);
    std::vector<TriangleId> bottom;
    for (TriangleId t = 2; t < 14; ++t)
        if (scene.vertex(t, 0).y == 2 && scene.vertex(t, 1).y == 2 && scene.vertex(t, 2).y == 2) bottom.push_back(t);
    ASSERT_EQ(bottom.size(), 2u);
    inside.resize(1000);
    std::mt19937 random(9);
    std::uniform_real_distribution<float> unit(0, 1);
    for (std::size_t i = 0; i < inside.size(); ++i) {
        const float u = unit(random), v = unit(random);
        set_point(inside, i, scene, bottom[i % 2], u + v > 1 ? 1 - u : u, u + v > 1 ? 1 - v : v);
    }
    face_lights(inside, scene);
    const Found found = expect_meets(scene, inside, [&](Real3 p, LightId j) {
        const Real3 rim[] = {{0, 2.5L, -0.875L}, {0.75L, 2.5L, -0.875L}, {0.75L, 2.5L, 0.875L}, {0, 2.5L, 0.875L}};
        Polygon hidden    = kWhole;
        for (int k = 0; k < 4; ++k) hidden = clip(hidden, beside(scene.lights[j], p, rim[(k + 1) % 4], rim[k]));
        return 1 - area(hidden);
    });
    EXPECT_GT(found.lit, 100u);
    EXPECT_GT(found.penumbra, 100u);
    EXPECT_GT(found.umbra, 10u);
}

TEST(ExactClosedForms, AWallThatPassesThroughTheLight) {
    // The wall x = 0.25 from y = 3.875 on, through lights that hang at about 4 and 5. It hides what is on its other
    // side, except for what is visible below its edge.
    Scene scene = floor_scene();
    add(scene, quad({0.25f, 3.875f, -64}, {0.25f, 3.875f, 64}, {0.25f, 9, 64}, {0.25f, 9, -64}));
    scene.lights      = {rectangle({0, 4, 0}, {1.5f, 0, 0}, {0, 0, -1}), askew({0, 4, 0.25f}, 2, 1, 0.5, 0.3, 0.4),
                         askew({0.25f, 5, 0}, 1, 2, 0.9, -0.6, 0)};
    std::size_t below = 0;
    const Found found = expect_meets(scene, points_on_first(scene, 2, 2000), [&](Real3 p, LightId j) {
        const Light& light = scene.lights[j];
        const Real side    = p.x < 0.25L ? 1 : -1;
        const Polygon far  = clip(kWhole, [&](Place q) {
            return side * (real(light.position).x + q.x * real(light.edge_u).x + q.y * real(light.edge_v).x - 0.25L);
        });
        const auto above   = beside(light, p, {0.25L, 3.875L, side}, {0.25L, 3.875L, -side});
        const Real hidden  = area(clip(far, above));
        below += hidden < area(far);
        return 1 - hidden;
    });
    EXPECT_GT(found.penumbra, 1000u);
    EXPECT_GT(below, 1000u);
}

}  // namespace
}  // namespace umbra
