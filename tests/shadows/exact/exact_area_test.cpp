// exact for area lights: closed forms, brute force in rationals, its two arithmetics against each other, and sampling.
#include <CGAL/Gmpq.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "umbra/core/base/parallel.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

using Rational  = CGAL::Gmpq;
using Rational3 = std::array<Rational, 3>;
using Rational2 = std::array<Rational, 2>;
using Polygon   = std::vector<Rational2>;

Rational3 rational(vec3 v) { return {Rational(double(v.x)), Rational(double(v.y)), Rational(double(v.z))}; }
Rational3 operator-(const Rational3& a, const Rational3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Rational dot(const Rational3& a, const Rational3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Rational3 cross(const Rational3& a, const Rational3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Brute force: the light in pieces, from which each triangle of the scene takes away what it hides. Convex polygons
/// in the plane of the light, cut one by the other; no tree, no silhouettes, no rounding.
/// The part of a convex polygon where value(p) >= 0, `value` linear.
template <class Point, class Value>
std::vector<Point> cut(const std::vector<Point>& polygon, const Value& value) {
    std::vector<Point> kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        const Rational a = value(p), b = value(q);
        if (a >= 0) kept.push_back(p);
        if ((a > 0 && b < 0) || (a < 0 && b > 0)) {
            Point cross = p;
            for (std::size_t i = 0; i < cross.size(); ++i) cross[i] = p[i] + (q[i] - p[i]) * (a / (a - b));
            kept.push_back(cross);
        }
    }
    return kept;
}

Rational twice_area(const Polygon& p) {
    Rational sum = 0;
    for (std::size_t k = 2; k < p.size(); ++k)
        sum += (p[k - 1][0] - p[0][0]) * (p[k][1] - p[0][1]) - (p[k - 1][1] - p[0][1]) * (p[k][0] - p[0][0]);
    return sum;
}

double brute_force(const Scene& scene, const Light& light, const PointBatch& points, std::size_t i) {
    const TriangleId own = points.triangle[i];
    const Rational3 a = rational(scene.vertex(own, 0)), b = rational(scene.vertex(own, 1)),
                    c = rational(scene.vertex(own, 2));
    const Rational u(double(points.u[i])), v(double(points.v[i]));
    Rational3 p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]);
    const Rational3 eu = rational(light.edge_u), ev = rational(light.edge_v), centre = rational(light.position);
    const Rational3 n = cross(eu, ev), to_centre = centre - p;
    const Rational height = dot(n, to_centre);

    // Points of the light: centre + x eu + y ev.
    const Rational half(1, 2);
    Polygon light_polygon       = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
    const Rational3 up          = cross(b - a, c - a);
    const Rational turn         = points.flipped[i] ? -1 : 1;
    light_polygon               = cut(light_polygon, [&](const Rational2& q) -> Rational {
        return turn * (dot(up, centre - a) + q[0] * dot(up, eu) + q[1] * dot(up, ev));
    });
    std::vector<Polygon> pieces = {light_polygon};
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
        if (t == own) continue;
        // Clipped to the space between p and the light's plane, and then to the cone over the light, which is where
        // 0 < w; what touches p alone is gone with it.
        const Rational3 xu = cross(ev, to_centre), xv = cross(to_centre, eu);
        std::vector<Rational3> hidden;  // x, y, w, times height
        for (int k = 0; k < 3; ++k) {
            const Rational3 d = rational(scene.vertex(t, k)) - p;
            const Rational s  = height > 0 ? 1 : -1;
            hidden.push_back({s * dot(d, xu), s * dot(d, xv), s * dot(d, n)});
        }
        const Rational far = height > 0 ? height : Rational(-height);
        // What lies in the light's plane, as the faces of its mesh do, is not in front of it.
        if (std::all_of(hidden.begin(), hidden.end(), [&](const Rational3& q) { return q[2] >= far; })) continue;
        hidden = cut(hidden, [&](const Rational3& q) -> Rational { return far - q[2]; });
        hidden = cut(hidden, [&](const Rational3& q) -> Rational { return half * q[2] - q[0]; });
        hidden = cut(hidden, [&](const Rational3& q) -> Rational { return half * q[2] + q[0]; });
        hidden = cut(hidden, [&](const Rational3& q) -> Rational { return half * q[2] - q[1]; });
        hidden = cut(hidden, [&](const Rational3& q) -> Rational { return half * q[2] + q[1]; });
        Polygon hole;
        bool through_p = false;
        for (const Rational3& q : hidden) {
            if (q[2] == 0)
                through_p = true;  // a triangle that holds p is seen edge-on
            else
                hole.push_back({q[0] / q[2], q[1] / q[2]});
        }
        if (through_p || hole.size() < 3) continue;
        if (twice_area(hole) == 0) continue;
        if (twice_area(hole) < 0) std::reverse(hole.begin(), hole.end());
        // Piece less hole: beyond the first side; within it, beyond the second; ...
        std::vector<Polygon> left;
        for (Polygon piece : pieces)
            for (std::size_t k = 0; k < hole.size() && piece.size() >= 3; ++k) {
                const Rational2 &from = hole[k], &to = hole[(k + 1) % hole.size()];
                if (from == to) continue;
                const auto inside = [&](const Rational2& q) -> Rational {
                    return (to[0] - from[0]) * (q[1] - from[1]) - (to[1] - from[1]) * (q[0] - from[0]);
                };
                Polygon beyond = cut(piece, [&](const Rational2& q) -> Rational { return -inside(q); });
                if (beyond.size() >= 3 && twice_area(beyond) != 0) left.push_back(std::move(beyond));
                piece = cut(piece, inside);
            }
        pieces = std::move(left);
    }
    double area = 0;
    for (const Polygon& piece : pieces) area += CGAL::to_double(twice_area(piece)) / 2;
    return area;
}

void add(Scene& scene, const Mesh& mesh) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    add_object(scene, "part", mesh.positions, {}, mesh.triangles, 0);
}
Mesh moved(const Mesh& mesh, vec3 by) { return transformed(mesh, glm::translate(mat4(1), by)); }

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

PointBatch random_points(const Scene& scene, std::size_t count, unsigned seed, vec3 eye = vec3(1, 9, 3)) {
    PointBatch batch;
    batch.eye = eye;
    batch.resize(count);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> u(0, 1);
    for (std::size_t i = 0; i < count; ++i) {
        const float a = u(random), b = u(random);
        const auto t = static_cast<TriangleId>(random() % scene.triangles.size());
        set_point(batch, i, scene, t, a + b > 1 ? 1 - a : a, a + b > 1 ? 1 - b : b);
    }
    face_lights(batch, scene);
    return batch;
}

/// A few solids that touch, overlap and repeat each other, a sheet, slivers, and a floor; the light at random.
Scene random_scene(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto anywhere = [&] { return vec3(unit(random), unit(random), unit(random)); };
    Scene scene;
    scene.camera.eye = vec3(1, 9, 3);
    add(scene, make_plane(8, 8));
    const Mesh box = make_box(vec3(0.8f, 0.8f, 0.8f));
    add(scene, moved(box, vec3(0, 0.4f, 0)));         // on the floor
    add(scene, moved(box, vec3(0.8f, 0.4f, 0.25f)));  // touches the first with a face
    add(scene, moved(transformed(box, glm::rotate(mat4(1), 0.7f, anywhere() + vec3(0, 0, 2))), vec3(0.5f, 1, 0.5f)));
    Mesh soup;
    for (int k = 0; k < 5; ++k) {
        const vec3 at = anywhere() * 1.5f + vec3(0, 1.5f, 0);
        for (int j = 0; j < 3; ++j) soup.positions.push_back(at + anywhere());
        soup.triangles.emplace_back(3 * k, 3 * k + 1, 3 * k + 2);
    }
    soup.triangles.push_back(soup.triangles[0]);  // twice
    soup.triangles.emplace_back(0, 2, 4);         // shares edges and corners
    soup.triangles.emplace_back(0, 2, 7);         // three in one edge
    soup.triangles.emplace_back(5, 5, 6);         // no area
    soup.positions.push_back(soup.positions[9] + vec3(1e-6f, 0, 0));
    soup.triangles.emplace_back(9, 10, 15);  // a sliver
    add(scene, soup);
    scene.lights.push_back(rectangle(anywhere() + vec3(0, 2.5f, 0), anywhere(), anywhere()));
    scene.lights.push_back(rectangle(vec3(1, 3, 0.5f), vec3(1.5f, 0, 0), vec3(0, 0, -1)));
    scene.lights.push_back(rectangle(vec3(0, 0.4f, 0.4f), vec3(0.25f, 0, 0), vec3(0, 0.25f, 0)));  // in a box's face
    return scene;
}

TEST(ExactArea, AgreesWithBruteForceInRationals) {
    std::size_t points = 0, penumbra = 0;
    for (unsigned seed = 1; seed <= 6; ++seed) {
        const Scene scene      = random_scene(seed);
        const PointBatch batch = random_points(scene, 150, seed);
        for (const char* choice : {"exact", "exact:arithmetic=rational"}) {
            MethodCase run(choice, scene);
            EXPECT_EQ(run.serves().how, How::exactly);
            run.build();
            for (LightId j = 0; j < scene.lights.size(); ++j) {
                run.aim(j);
                const VisibilityPlane got = run.visibility(batch, j);
                for (std::size_t i = 0; i < batch.size(); ++i) {
                    if (!is_open(batch, j, i) || got.answer[i] != Answer::given) continue;
                    const double right = brute_force(scene, scene.lights[j], batch, i);
                    EXPECT_NEAR(got.s[i], right, 6e-8)
                        << choice << " seed " << seed << " light " << j << " point " << i;
                    ++points;
                    penumbra += right > 0 && right < 1;
                }
            }
        }
    }
    EXPECT_GT(points, 1000u);
    EXPECT_GT(penumbra, 300u);
}

/// A triangle and a sliver folded back over its long side, both in y = 1, one corner off by 1e-17 as rotations leave
/// it: in double the direction of the sliver's normal is noise.
TEST(ExactArea, OfASliverThatIsFoldedOverATriangle) {
    Scene scene;
    add(scene, Mesh{{{0, 1, 1e-17f}, {1, 1, 0.5f}, {1, 1, 0}, {0.5f, 1, 0.25f}}, {}, {{0, 1, 2}, {0, 1, 3}}});
    add(scene, make_plane(6, 6));
    scene.lights.push_back(rectangle(vec3(0.5f, 2, 0.25f), vec3(0.5f, 0, 0), vec3(0, 0, 0.5f)));
    const PointBatch points = random_points(scene, 400, 2, vec3(0.5f, 6, 0.3f));
    MethodCase run("exact", scene);
    run.build();
    run.aim(0);
    const VisibilityPlane got = run.visibility(points, 0);
    std::size_t penumbra      = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i) || got.answer[i] != Answer::given) continue;
        const double right = brute_force(scene, scene.lights[0], points, i);
        EXPECT_NEAR(got.s[i], right, 6e-8) << i;
        penumbra += right > 0 && right < 1;
    }
    EXPECT_GT(penumbra, 5u);
}

/// Points within 1e-20 of an edge of another triangle: whether it passes over the light is lost in rounding.
TEST(ExactArea, BesideAnEdge) {
    Scene scene;
    add(scene,
        Mesh{{{3, 0, 4}, {4, 4, -4}, {0, 2, 2}, {3, 0, 4}, {1, -4, -4}, {4, 4, -4}}, {}, {{0, 1, 2}, {3, 4, 5}}});
    Light light     = rectangle(vec3(4, 0.5f, 4), vec3(1, 0, 0), vec3(0, 1, 0));
    light.kind      = LightKind::disk;
    light.direction = glm::normalize(vec3(2, 2, 1));
    light.radius    = 2;
    scene.lights    = {light};
    PointBatch points;
    points.eye = vec3(3.3f, 4.7f, 9.1f);
    points.resize(600);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    set_point(points, 0, scene, 1, 0x1p-67f, 0x1.80ef7ap-1f);
    for (std::size_t i = 1; i < points.size(); ++i)
        set_point(points, i, scene, 1, std::ldexp(1.0f, -50 - static_cast<int>(i % 30)), unit(random));
    face_lights(points, scene);
    MethodCase fast("exact", scene), slow("exact:arithmetic=rational", scene);
    fast.prepare(0), slow.prepare(0);
    const VisibilityPlane quick = fast.visibility(points, 0), right = slow.visibility(points, 0);
    std::size_t open = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i)) continue;
        ++open;
        EXPECT_NEAR(quick.s[i], right.s[i], double(quick.half_width[i]) + double(right.half_width[i]) + 1e-8) << i;
    }
    EXPECT_GT(open, 300u);
}

/// A half-plane x >= 0 at height 2 under a light at height 4: the floor point x sees what of the light is left of
/// X* = -x (4 - 2) / 2. All in eighths, so that the formula is exact.
Scene half_plane_scene() {
    Scene scene;
    scene.camera.eye = vec3(1, 9, 3);
    add(scene, make_plane(8, 8));
    add(scene, Mesh{{{0, 2, -64}, {64, 2, -64}, {64, 2, 64}, {0, 2, 64}}, {}, {{0, 2, 1}, {0, 3, 2}}});
    return scene;
}
PointBatch floor_points(const Scene& scene) {  // along z = 0.3 x about, on both triangles of the floor
    PointBatch batch;
    batch.eye = vec3(1, 9, 3);
    batch.resize(513);
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const vec3 target(-2 + static_cast<float>(i) / 128, 0, 0.25f);
        for (TriangleId t = 0; t < 2; ++t) {
            const vec3 a = scene.vertex(t, 0), ab = scene.vertex(t, 1) - a, ac = scene.vertex(t, 2) - a, d = target - a;
            const float det = ab.x * ac.z - ab.z * ac.x;
            const float u = (d.x * ac.z - d.z * ac.x) / det, v = (ab.x * d.z - ab.z * d.x) / det;
            if (u >= 0 && v >= 0 && u + v <= 1) set_point(batch, i, scene, t, u, v);
        }
    }
    face_lights(batch, scene);
    return batch;
}

TEST(ExactArea, MeetsTheClosedFormOfAHalfPlaneOverRectangles) {
    Scene scene = half_plane_scene();
    // Squares, long and wide ones, and a rectangle that is tilted about x, which does not change the way across.
    scene.lights.push_back(rectangle(vec3(0, 4, 0), vec3(1.5f, 0, 0), vec3(0, 0, -1)));
    scene.lights.push_back(rectangle(vec3(0, 4, 0), vec3(0.25f, 0, 0), vec3(0, 0, -4)));
    scene.lights.push_back(rectangle(vec3(0, 4, 0), vec3(3, 0, 0), vec3(0, 0, 0.125f)));
    for (const char* choice : {"exact", "exact:arithmetic=rational"}) {
        const PointBatch points = floor_points(scene);
        MethodCase run(choice, scene);
        run.build();
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            run.aim(j);
            const VisibilityPlane got = run.visibility(points, j);
            const double a            = double(scene.lights[j].edge_u.x) / 2;
            std::size_t penumbra      = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                ASSERT_NE(points.triangle[i], kNoTriangle);
                const TriangleId t = points.triangle[i];
                const double x     = double(scene.vertex(t, 0).x) +
                                 double(points.u[i]) * double(scene.vertex(t, 1).x - scene.vertex(t, 0).x) +
                                 double(points.v[i]) * double(scene.vertex(t, 2).x - scene.vertex(t, 0).x);
                const double right = std::clamp((-x + a) / (2 * a), 0.0, 1.0);
                EXPECT_NEAR(got.s[i], right, 0x1p-24 * right + 1e-12) << choice << " light " << j << " x " << x;
                penumbra += right > 0 && right < 1;
            }
            EXPECT_GT(penumbra, 30u);
            EXPECT_EQ(std::ranges::count(got.half_width, 0.0f), std::ssize(got.half_width));
        }
    }
}

TEST(ExactArea, BracketsTheClosedFormOfAHalfPlaneOverADisk) {
    Scene scene             = half_plane_scene();
    Light& light            = scene.lights.emplace_back();
    light.kind              = LightKind::disk;
    light.position          = vec3(0, 4, 0);
    light.radius            = 0.75f;
    light.direction         = vec3(0, -1, 0);
    const PointBatch points = floor_points(scene);
    for (const char* choice : {"exact", "exact:arithmetic=rational"}) {
        MethodCase run(choice, scene);
        run.prepare(0);
        const VisibilityPlane got      = run.visibility(points, 0);
        const std::vector<float>& half = got.half_width;
        std::size_t penumbra           = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double x     = double(points.px[i]);
            const double t     = std::clamp(-x / 0.75, -1.0, 1.0);
            const double right = 1 - (std::acos(t) - t * std::sqrt(1 - t * t)) / kPi;
            EXPECT_NEAR(got.s[i], right, double(half[i]) + 1e-9) << choice << " x " << x;
            EXPECT_LE(half[i], choice == std::string_view("exact") ? 0x1p-24f : 1e-4f);
            penumbra += right > 0 && right < 1;
        }
        EXPECT_GT(penumbra, 100u);
    }
}

/// The two arithmetics, on points in penumbrae, curved meshes whose own plane cuts the light among them.
TEST(ExactArea, ItsTwoArithmeticsAgree) {
    for (const LightKind kind : {LightKind::rectangle, LightKind::disk, LightKind::sphere}) {
        Scene scene      = random_scene(11);
        scene.camera.eye = vec3(1, 9, 3);
        add(scene, moved(make_sphere(0.5f, 10, 5), vec3(-1.5f, 0.75f, 0.5f)));
        Light light             = rectangle(vec3(0.25f, 2.75f, 0.5f), vec3(1.5f, 0.25f, 0), vec3(0, 0.25f, -1));
        light.kind              = kind;
        light.radius            = 0.5f;
        scene.lights            = {light};
        const PointBatch points = random_points(scene, 30000, 3);
        MethodCase fast("exact", scene), slow("exact:arithmetic=rational", scene);
        fast.prepare(0), slow.prepare(0);
        const VisibilityPlane quick = fast.visibility(points, 0);
        PointBatch chosen;
        chosen.eye = points.eye;
        std::vector<std::size_t> from;
        for (std::size_t i = 0; i < points.size() && from.size() < (kind == LightKind::rectangle ? 2000 : 100); ++i)
            if (is_open(points, 0, i) && quick.s[i] > 0 && quick.s[i] < 1) from.push_back(i);
        EXPECT_GE(from.size(), kind == LightKind::rectangle ? 2000u : 100u);
        chosen.resize(from.size());
        for (std::size_t k = 0; k < from.size(); ++k)
            set_point(chosen, k, scene, points.triangle[from[k]], points.u[from[k]], points.v[from[k]]);
        face_lights(chosen, scene);
        const VisibilityPlane right = slow.visibility(chosen, 0);
        double worst                = 0;
        // Rationals leave open a part of what an edge cuts off a round light, doubles do not.
        for (std::size_t k = 0; k < from.size(); ++k)
            worst = std::max(worst, std::abs(double(right.s[k]) - double(quick.s[from[k]])) - right.half_width[k]);
        EXPECT_LE(worst, 0x1p-24 + 4e-9);
        RecordProperty(std::string(to_string(kind)), fmt::format("{}", worst));
    }
}

TEST(ExactArea, SaysWhereThePointLiesInTheLightsPlane) {
    Scene scene = half_plane_scene();
    add(scene, Mesh{{{-1, 3, -1}, {1, 5, -1}, {1, 3, -1.5f}}, {}, {{0, 1, 2}}});
    scene.lights.push_back(rectangle(vec3(0, 4, 0), vec3(1, 0, 0), vec3(0, 0, -1)));
    PointBatch one;
    one.eye = vec3(0, 4, 9);
    one.resize(1);
    set_point(one, 0, scene, 4, 0.5f, 0);  // at height 4
    face_lights(one, scene);
    if (!is_open(one, 0, 0)) {
        one.eye = vec3(0, 4, -9);
        set_point(one, 0, scene, 4, 0.5f, 0);
        face_lights(one, scene);
    }
    ASSERT_TRUE(is_open(one, 0, 0));
    MethodCase run("exact", scene);
    run.prepare(0);
    EXPECT_EQ(run.visibility(one, 0).answer[0], Answer::on_boundary);
}

}  // namespace
}  // namespace umbra
