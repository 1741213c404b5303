// Shadow volumes against every triangle asked one by one, on small random scenes of every kind of mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "umbra/core/base/parallel.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/points.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/asked.h"

namespace umbra {
namespace {

using Random = std::mt19937;

float uniform(Random& random, float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
}
vec3 uniform3(Random& random, float low, float high) {
    return {uniform(random, low, high), uniform(random, low, high), uniform(random, low, high)};
}

// ---- the truth ------------------------------------------------------------------------------------------------------

struct Truth {
    bool lit = true;
    bool boundary =
        false;  ///< within rounding of a shadow boundary, or of the plane of some other triangle at the point
};

/// The segment from the point, as it is named, to the light against every triangle but its own, in long double.
/// What cannot be decided beyond the rounding of doubles is `boundary`.
Truth truth_at(const Scene& scene, const PointBatch& points, std::size_t i, const Light& light) {
    using Real           = long double;
    using dvec3l         = glm::vec<3, Real>;
    const auto of        = [&](TriangleId t, int k) { return dvec3l(scene.vertex(t, k)); };
    const TriangleId own = points.triangle[i];
    const Real w[3]      = {1 - Real(points.u[i]) - Real(points.v[i]), points.u[i], points.v[i]};
    const bool at_border = std::min({w[0], w[1], w[2]}) == 0;
    const dvec3l p       = w[0] * of(own, 0) + w[1] * of(own, 1) + w[2] * of(own, 2);
    const bool far       = light.kind == LightKind::directional;
    const dvec3l ray     = far ? -dvec3l(light.direction) : dvec3l(light.position) - p;
    Truth truth;
    bool doubtful = false;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
        if (t == own) continue;
        const dvec3l a = of(t, 0) - p, b = of(t, 1) - p, c = of(t, 2) - p;
        // Signed volumes: the ray passes within where all three have one sign.
        const Real ab = glm::dot(ray, glm::cross(a, b)), bc = glm::dot(ray, glm::cross(b, c)),
                   ca   = glm::dot(ray, glm::cross(c, a));
        const Real size = glm::length(ray) * glm::max(glm::dot(a, a), glm::max(glm::dot(b, b), glm::dot(c, c)));
        const Real tiny = 1e-12L * size;
        if (glm::min(ab, glm::min(bc, ca)) < -tiny && glm::max(ab, glm::max(bc, ca)) > tiny) continue;
        const dvec3l n   = glm::cross(b - a, c - a);
        const Real along = glm::dot(n, ray), height = glm::dot(n, a);  // crosses at height / along
        const Real small = 1e-12L * glm::length(n) * glm::length(a);
        // Behind the start, beyond the light, or in the plane of a triangle that has the point on it: no occluder. A
        // point on its triangle's border may lie on others too, which is a boundary.
        if (std::abs(height) <= small) {
            doubtful |= at_border;
            continue;
        }
        if ((height > 0) != (along > 0)) continue;
        if (!far && std::abs(height) > std::abs(along) * (1 + 1e-12L)) continue;
        const bool within = (ab > tiny && bc > tiny && ca > tiny) || (ab < -tiny && bc < -tiny && ca < -tiny);
        const bool before = far || std::abs(height) < std::abs(along) * (1 - 1e-12L);
        if (within && before)
            truth.lit = false;
        else
            doubtful = true;
    }
    truth.boundary = truth.lit && doubtful;
    return truth;
}

// ---- scenes ---------------------------------------------------------------------------------------------------------

mat4 placed(Random& random, float spread) {
    const vec3 axis  = glm::normalize(uniform3(random, -1, 1) + vec3(0, 1e-3f, 0));
    const float turn = uniform(random, 0, 6);
    const float c = std::cos(turn), s = std::sin(turn);
    mat4 m(1);
    for (int k = 0; k < 3; ++k) {
        vec3 e(0);
        e[k]           = 1;
        const vec3 out = c * e + s * glm::cross(axis, e) + (1 - c) * glm::dot(axis, e) * axis;
        m[k]           = vec4(out * uniform(random, 0.5f, 1.5f), 0);
    }
    m[3] = vec4(uniform3(random, -spread, spread), 1);
    return m;
}

void add(Scene& scene, const Mesh& mesh) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    add_object(scene, "object" + std::to_string(scene.objects.size()), mesh.positions, {}, mesh.triangles, 0);
}

Mesh random_body(Random& random) {
    switch (random() % 4) {
        case 0: return make_box({1, 1, 1});
        case 1: return make_sphere(0.7f, 8, 5);
        case 2: return make_cone(0.6f, 1.2f, 7);
        default: return make_torus(0.6f, 0.25f, 9, 6);
    }
}

/// What else happens to meshes in the wild.
enum class Fault : std::uint8_t { none, open, flipped, fans, soup, twice, inward };

Mesh with_fault(Mesh mesh, Fault fault, Random& random) {
    auto& triangles = mesh.triangles;
    switch (fault) {
        case Fault::none: break;
        case Fault::open:
            for (std::size_t n = triangles.size() / 3; n > 0; --n)
                triangles.erase(triangles.begin() + static_cast<std::ptrdiff_t>(random() % triangles.size()));
            break;
        case Fault::flipped:
            for (uvec3& t : triangles)
                if (random() % 2) std::swap(t[1], t[2]);
            break;
        case Fault::fans:
            for (std::size_t n = triangles.size() / 2; n > 0; --n) {
                const uvec3 t = triangles[random() % triangles.size()];
                mesh.positions.push_back(uniform3(random, -1, 1));
                triangles.push_back({t[0], t[1], mesh.positions.size() - 1});
            }
            break;
        case Fault::soup:
            for (uvec3& t : triangles)
                for (int k = 0; k < 3; ++k) t[k] = static_cast<std::uint32_t>(random() % mesh.positions.size());
            break;
        case Fault::twice:
            for (std::size_t n = triangles.size(), k = 0; k < n; ++k)
                triangles.push_back(random() % 2 ? triangles[k]
                                                 : uvec3(triangles[k][1], triangles[k][0], triangles[k][2]));
            break;
        case Fault::inward:
            for (uvec3& t : triangles) std::swap(t[1], t[2]);
            break;
    }
    return mesh;
}

Scene random_scene(Random& random, Fault fault, bool floor) {
    Scene scene;
    scene.name = "random";
    for (int k = 0; k < 4; ++k)
        add(scene, transformed(with_fault(random_body(random), fault, random), placed(random, 1.5f)));
    if (floor) {
        Mesh plane = make_plane(8, 8, 3);
        for (vec3& p : plane.positions) p.y = -1.5f;
        add(scene, plane);
    }
    return scene;
}

Light directional(vec3 direction) {
    Light light;
    light.kind      = LightKind::directional;
    light.direction = direction;
    return light;
}
Light point(vec3 position) {
    Light light;
    light.position = position;
    return light;
}

/// Points anywhere on the surface; some on edges and corners too.
PointBatch scattered_points(const Scene& scene, std::size_t n, Random& random, vec3 eye) {
    PointBatch points;
    points.eye = eye;
    points.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        float u = uniform(random, 0, 1), v = uniform(random, 0, 1);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        set_point(points, i, scene, static_cast<TriangleId>(random() % scene.triangles.size()), u, v);
    }
    face_lights(points, scene);
    return points;
}

// ---- checking -------------------------------------------------------------------------------------------------------

const char* const kSettings[] = {"counting=depth_pass,edges=silhouette",   "counting=depth_pass,edges=weighted",
                                 "counting=depth_pass,edges=per_triangle", "counting=depth_fail,edges=silhouette",
                                 "counting=depth_fail,edges=weighted",     "counting=depth_fail,edges=per_triangle"};

struct Checked {
    std::size_t points = 0, umbra = 0, boundary = 0;
};

Checked check(const Scene& scene, const PointBatch& points, const std::string& what) {
    Checked checked;
    const SceneFacts facts = find_facts(scene);
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        std::vector<Truth> truth(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points.facing[j][i] != Facing::front) continue;
            truth[i] = truth_at(scene, points, i, scene.lights[j]);
            ++checked.points;
            checked.boundary += truth[i].boundary;
            checked.umbra += !truth[i].lit;
        }
        for (const char* settings : kSettings) {
            const MethodChoice choice = parse_method(std::string("shadow_volumes:") + settings);
            Asked method(choice);
            const bool proven =
                choice.text().find("edges=silhouette") == std::string::npos || facts.closed_objects == 0;
            EXPECT_EQ(method.serves(facts).how, proven ? How::to_rounding : How::approximately);
            method.build(scene, facts);
            method.aim(j);
            const std::vector<float> s = method.visibility(points, j).s;
            std::size_t wrong = 0, first = 0;
            for (std::size_t i = points.size(); i-- > 0;) {
                if (points.facing[j][i] != Facing::front) {
                    EXPECT_EQ(s[i], 0);
                } else if (!truth[i].boundary && (s[i] == 1) != truth[i].lit) {
                    ++wrong, first = i;
                }
            }
            EXPECT_EQ(wrong, 0u) << what << ", light " << j << ", " << settings << ": first point " << first
                                 << " of triangle " << points.triangle[first] << " at " << points.px[first] << ' '
                                 << points.py[first] << ' ' << points.pz[first] << ", s = " << s[first];
        }
    }
    return checked;
}

class EveryMesh : public testing::TestWithParam<Fault> {};

TEST_P(EveryMesh, ScatteredPointsAgreeWithEveryTriangleAsked) {
    Random random(1);
    Checked sum;
    for (int round = 0; round < 12; ++round) {
        Scene scene  = random_scene(random, GetParam(), round % 2 == 0);
        scene.lights = {directional(uniform3(random, -1, 1)), directional({0, -1, 0}), point(uniform3(random, -3, 3)),
                        point(uniform3(random, -0.5f, 0.5f)), point({0, 3, 0})};
        const Checked c = check(scene, scattered_points(scene, 400, random, uniform3(random, -3, 3)),
                                "round " + std::to_string(round));
        sum.points += c.points, sum.umbra += c.umbra, sum.boundary += c.boundary;
    }
    EXPECT_GT(sum.umbra, sum.points / 10);
    EXPECT_LT(sum.umbra, sum.points * 9 / 10);
    EXPECT_LT(sum.boundary, sum.points / 1000);
}

TEST_P(EveryMesh, RastersAgreeWithEveryTriangleAsked) {
    Random random(2);
    Checked sum;
    for (int round = 0; round < 8; ++round) {
        Scene scene         = random_scene(random, GetParam(), true);
        scene.camera.eye    = round % 2 ? uniform3(random, -1.2f, 1.2f) : uniform3(random, 3, 4);  // inside volumes too
        scene.camera.target = uniform3(random, -0.2f, 0.2f);
        scene.camera.fov_y  = round % 4 < 2 ? 50.0f : 110.0f;
        if (round == 6) scene.camera.projection = Projection::orthographic, scene.camera.height = 4;
        scene.lights = {directional(uniform3(random, -1, 1)), point(uniform3(random, -3, 3)), point(scene.camera.eye)};
        const RayScene rays(scene);
        const PointBatch points = primary_points(rays, scene, scene.camera, 48, 27);
        const Checked c         = check(scene, points, "round " + std::to_string(round));
        sum.points += c.points, sum.umbra += c.umbra, sum.boundary += c.boundary;
    }
    EXPECT_GT(sum.umbra, sum.points / 20);
    EXPECT_LT(sum.boundary, sum.points / 1000);
}

/// Boxes on a grid: lights, eyes and edges in the planes of faces, faces that coincide, points on edges and at corners.
TEST(ShadowVolumes, PlanesThatCoincideAreNoSpecialCase) {
    Random random(3);
    const auto on_grid = [&] { return vec3(random() % 5, random() % 5, random() % 5) - 2.0f; };
    Checked sum;
    for (int round = 0; round < 12; ++round) {
        Scene scene;
        for (int k = 0; k < 6; ++k) {
            mat4 m(1);
            m[3] = vec4(on_grid(), 1);
            add(scene, transformed(make_box({2, 2, 2}), m));
        }
        scene.lights = {directional({0, -1, 0}), directional({1, -1, 0}), directional({-1, -1, 1}),
                        point(2.0f * on_grid()), point(on_grid())};
        for (const bool corners : {false, true}) {
            PointBatch points = scattered_points(scene, 300, random, 2.0f * on_grid());
            for (std::size_t i = 0; corners && i < points.size(); ++i)
                set_point(points, i, scene, points.triangle[i], i % 3 == 1, i % 3 == 2);
            face_lights(points, scene);
            const Checked c = check(scene, points, "round " + std::to_string(round));
            if (!corners) sum.points += c.points, sum.umbra += c.umbra, sum.boundary += c.boundary;
        }
    }
    EXPECT_GT(sum.umbra, sum.points / 5);
    EXPECT_LT(sum.boundary, sum.points / 20);  // lights that lie on a face
}

TEST(ShadowVolumes, TheSameForAnyNumberOfThreads) {
    Random random(4);
    Scene scene             = random_scene(random, Fault::soup, true);
    scene.lights            = {point({1, 3, 2})};
    const PointBatch points = scattered_points(scene, 20000, random, {3, 3, 3});
    const SceneFacts facts  = find_facts(scene);
    const auto visibility   = [&] {
        Asked method("shadow_volumes");
        method.build(scene, facts);
        method.aim(0);
        return method.visibility(points, 0).s;
    };
    const auto many = visibility();
    const ThreadLimit one(1);
    EXPECT_EQ(many, visibility());
}

TEST(ShadowVolumes, AreaLightsAreServedThroughTheirCentres) {
    Random random(5);
    Scene scene            = random_scene(random, Fault::none, true);
    scene.lights           = {point({0, 4, 0}), point({0, 4, 0})};
    scene.lights[1].kind   = LightKind::sphere;
    scene.lights[1].radius = 0.5f;
    const SceneFacts facts = find_facts(scene);
    Asked method("shadow_volumes");
    EXPECT_EQ(method.serves(facts).how, How::approximately);
    const PointBatch points = scattered_points(scene, 2000, random, {3, 3, 3});
    std::vector<std::vector<float>> s(2);
    method.build(scene, facts);
    for (LightId j = 0; j < 2; ++j) {
        method.aim(j);
        s[j] = method.visibility(points, j).s;
    }
    std::size_t both = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.facing[0][i] != Facing::front || points.facing[1][i] != Facing::front) continue;
        EXPECT_EQ(s[0][i], s[1][i]);
        ++both;
    }
    EXPECT_GT(both, 200u);
}

std::string fault_name(const testing::TestParamInfo<Fault>& info) {
    constexpr const char* kNames[] = {"closed", "open", "flipped", "fans", "soup", "twice", "inward"};
    return kNames[static_cast<std::size_t>(info.param)];
}
INSTANTIATE_TEST_SUITE_P(All, EveryMesh,
                         testing::Values(Fault::none, Fault::open, Fault::flipped, Fault::fans, Fault::soup,
                                         Fault::twice, Fault::inward),
                         fault_name);

/// S is the same by either of them: a box has 18 edges, its triangles have 36 sides, and no view of it shows as many as
/// 12 silhouette edges.
TEST(ShadowVolumes, EdgesAreThoseThatTheSettingNames) {
    Scene scene;
    scene.materials.emplace_back();
    const Mesh box = make_box(vec3(1));
    add_object(scene, "box", box.positions, {}, box.triangles, 0);
    Light light;
    light.kind             = LightKind::point;
    light.position         = {3, 4, 5};
    scene.lights           = {light};
    const SceneFacts facts = find_facts(scene);
    const auto held        = [&](const char* settings) {
        Asked method(std::string("shadow_volumes:") + settings);
        method.build(scene, facts);
        method.aim(0);
        return method.memory_bytes();
    };
    EXPECT_GT(held("edges=per_triangle"), held("edges=weighted"));
    EXPECT_GT(held("edges=per_triangle"), held("edges=silhouette"));
}

/// An area light is seen from its centre alone: where that is behind the point's plane, nothing of the light is seen.
TEST(ShadowVolumes, ACentreBehindThePointsPlaneIsNotSeen) {
    Scene scene;
    scene.materials.emplace_back();
    add_object(scene, "floor", {{-4, 0, -4}, {0, 0, 8}, {4, 0, -4}}, {}, {{0, 1, 2}}, 0);
    Light light;
    light.kind   = LightKind::sphere;
    light.radius = 1;
    scene.lights.assign(2, light);
    scene.lights[0].position = {0, -0.25f, 0};
    scene.lights[1].position = {0, 0.25f, 0};
    PointBatch points;
    points.eye = vec3(0, 4, 1);
    points.resize(1);
    set_point(points, 0, scene, 0, 0.25f, 0.25f);
    face_lights(points, scene);
    Asked method("shadow_volumes");
    method.build(scene);
    for (const LightId j : {0u, 1u}) {
        ASSERT_EQ(points.facing[j][0], Facing::partly);
        method.aim(j);
        EXPECT_EQ(method.visibility(points, j).s[0], j == 0 ? 0.0f : 1.0f);
    }
}

}  // namespace
}  // namespace umbra
