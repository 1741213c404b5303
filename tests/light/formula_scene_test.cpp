// Spheres and boxes by formula in ray tracing: closed forms of silhouettes, mirrors, lenses and shadows.
#include "umbra/bench/studies/light/formula_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "umbra/bench/studies/light/optics.h"
#include "umbra/bench/studies/light/whitted.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/asked.h"
#include "umbra/tests/support/lit_everywhere.h"

namespace umbra {
namespace {

void add_mesh(Scene& scene, const Mesh& mesh, vec3 at, const Material& material) {
    std::vector<vec3> positions = mesh.positions;
    for (vec3& p : positions) p += at;
    scene.materials.push_back(material);
    add_object(scene, "mesh", positions, mesh.normals, mesh.triangles,
               static_cast<std::uint32_t>(scene.materials.size() - 1));
}

Material glass(float index) {
    Material m;
    m.reflect = 0.1f, m.transmit = 0.9f, m.index_of_refraction = index;
    return m;
}

Material mirror() {
    Material m;
    m.reflect = 0.5f;
    return m;
}

void add_light(Scene& scene, vec3 position) {
    Light light;
    light.name     = "light" + std::to_string(scene.lights.size());
    light.position = position;
    scene.lights.push_back(light);
}

Scene seen_from(vec3 eye, vec3 target, int width = 60, int height = 40) {
    Scene scene;
    scene.camera.eye = eye, scene.camera.target = target;
    scene.camera.up = {0.1f, 1, 0.2f};
    scene.width = width, scene.height = height;
    return scene;
}

struct Traced {
    RayTree tree;
    std::vector<std::vector<VisibilityPlane>> visibility;
    Image image;
};

Traced traced(const Scene& scene, const TreeOptions& options = {}) {
    const FormulaScene formula(scene, find_bodies(scene));
    Traced done{formula.trace(frame(scene.camera, scene.width, scene.height), options), {}, {}};
    for (std::size_t level = 0; level < done.tree.levels.size(); ++level)
        done.visibility.push_back(formula.visibility(done.tree, level));
    done.image = gather(scene, done.tree, light_of_rays(scene, done.tree, done.visibility), options.depth);
    return done;
}

/// The eye ray of pixel i.
Ray eye_ray(const Scene& scene, std::size_t i) {
    const CameraFrame view = frame(scene.camera, scene.width, scene.height);
    const auto width       = static_cast<std::size_t>(scene.width);
    const std::size_t line = i / width;
    const double x = static_cast<double>(i % width) + 0.5, y = static_cast<double>(line) + 0.5;
    return {view.ray_origin(x, y), glm::normalize(view.ray_direction(x, y)), kNoTriangle, dvec3(0)};
}

/// A ball over a floor under a lamp, seen from the side: the floor shows its shadow and the eye sees no ball. One that
/// receives no shadows is lit wherever it faces the lamp, a board over it notwithstanding.
TEST(FormulaScene, BodiesTakePartInWhatTheirObjectsSay) {
    Scene scene = seen_from({0, 3, 7}, {0, 0.5f, 0}, 120, 80);
    add_mesh(scene, make_plane(12, 12), {0, 0, 0}, Material());
    add_mesh(scene, make_sphere(0.5f, 64, 32), {0, 1, 0}, Material());
    add_mesh(scene, make_plane(3, 3), {0, 2, 0}, Material());
    add_light(scene, {0, 5, 0});
    ASSERT_EQ(find_bodies(scene).list.size(), 1u);
    ASSERT_EQ(scene.objects.size(), 3u);
    const auto counted = [&](auto&& of) {
        const Traced done   = traced(scene);
        const RayLevel& eye = done.tree.levels[0];
        std::size_t count   = 0;
        for (std::size_t i = 0; i < eye.points.size(); ++i) count += of(eye, done.visibility[0][0], i) ? 1 : 0;
        return count;
    };
    const auto on_ball = [](const RayLevel& eye, const VisibilityPlane&, std::size_t i) {
        return eye.on_body[i].body != kNoBody;
    };
    const auto lit_ball = [&](const RayLevel& eye, const VisibilityPlane& plane, std::size_t i) {
        return on_ball(eye, plane, i) && plane.s[i] == 1;
    };
    const auto facing_ball = [&](const RayLevel& eye, const VisibilityPlane& plane, std::size_t i) {
        return on_ball(eye, plane, i) && eye.points.faces(0, i);
    };
    const auto dark_floor = [&](const RayLevel& eye, const VisibilityPlane& plane, std::size_t i) {
        const vec3 p = eye.points.position(i);
        return eye.points.triangle[i] != kNoTriangle && std::abs(p.y) < 1e-6f && std::hypot(p.x, p.z) < 0.6f &&
               plane.s[i] == 0;
    };
    EXPECT_GT(counted(on_ball), 20u);
    EXPECT_EQ(counted(lit_ball), 0u) << "all in the shadow of the board";
    scene.objects[1].switches.receives_shadows = false;
    EXPECT_GT(counted(lit_ball), 10u);
    EXPECT_EQ(counted(lit_ball), counted(facing_ball));
    scene.objects[2].switches.casts_shadows  = false;
    scene.objects[1].switches.seen_by_camera = false;
    EXPECT_EQ(counted(on_ball), 0u);
    EXPECT_GT(counted(dark_floor), 10u);
    scene.objects[1].switches.casts_shadows = false;
    EXPECT_EQ(counted(dark_floor), 0u);
}

/// A cone that mirrors and a torus that transmits, faceted, on a floor: no bodies.
TEST(FormulaScene, WithoutBodiesIsTheTreeOfTriangles) {
    Scene scene = seen_from({1, 3, 7}, {0, 0.5f, 0});
    add_mesh(scene, make_plane(12, 12), {0, 0, 0}, Material());
    Mesh cone = make_cone(1, 2, 16), torus = make_torus(1, 0.3f, 24, 12);
    cone.normals.clear(), torus.normals.clear();
    add_mesh(scene, cone, {-1.5f, 1, 0}, mirror());
    add_mesh(scene, torus, {1, 0.4f, 0}, glass(1.5f));
    add_light(scene, {2, 5, 3});
    ASSERT_TRUE(find_bodies(scene).list.empty());
    const RayScene rays(scene);
    const RayTree triangles = trace_rays(rays, scene, points_of(scene), {});
    const Traced formula    = traced(scene);
    ASSERT_EQ(formula.tree.levels.size(), triangles.levels.size());
    for (std::size_t level = 0; level < triangles.levels.size(); ++level) {
        const RayCounts &a = triangles.levels[level].counts, &b = formula.tree.levels[level].counts;
        EXPECT_EQ(a.eye, b.eye);
        EXPECT_EQ(a.reflected, b.reflected);
        EXPECT_EQ(a.refracted, b.refracted);
        EXPECT_EQ(a.met, b.met);
        EXPECT_EQ(a.shadow, b.shadow);
        EXPECT_EQ(a.total, b.total);
        EXPECT_EQ(a.too_deep, b.too_deep);
    }
    Asked method("brute_force");
    method.build(scene);
    method.aim(0);
    const Image expected =
        gather(scene, triangles,
               light_of_rays(scene, triangles,
                             [&](const PointBatch& points) { return std::vector{method.visibility(points, 0)}; }),
               5);
    std::size_t different = 0;
    for (std::size_t k = 0; k < expected.data.size(); ++k)
        different += std::abs(expected.data[k] - formula.image.data[k]) > 1e-5f ? 1 : 0;
    EXPECT_LE(different, 3u);  // a pixel where a shadow ray runs along an edge
}

/// A pixel sees a sphere where the angle of its ray from the centre is below asin(r / d), however coarse the mesh is,
/// from nearby and from afar, and in parallel projection where it passes by at less than r.
TEST(FormulaScene, SilhouetteIsTheCircleOfTheSphere) {
    const auto errors = [](const Scene& scene, dvec3 centre, double radius) {
        const RayLevel level = traced(scene).tree.levels[0];
        std::size_t wrong = 0, met = 0;
        for (std::size_t i = 0; i < level.points.size(); ++i) {
            const Ray ray         = eye_ray(scene, i);
            const double distance = glm::length(glm::cross(ray.direction, centre - ray.origin));
            met += level.on_body[i].body == 0 ? 1 : 0;
            if (std::abs(distance - radius) < 1e-6 * radius) continue;
            wrong += (level.on_body[i].body == 0) != (distance < radius) ? 1 : 0;
            if (level.on_body[i].body != 0) continue;
            EXPECT_NEAR(glm::length(level.on_body[i].position - centre), radius, 1e-6 * radius);
            EXPECT_LT(glm::dot(level.on_body[i].normal, ray.direction), 0);
        }
        EXPECT_GT(met, 500u);
        return wrong;
    };
    const vec3 centre(0.4f, 0.25f, -1);
    Scene scene = seen_from({2, 1, 4}, {0.3f, 0, -1}, 120, 80);
    add_mesh(scene, make_sphere(1.25f, 8, 4), centre, Material());
    EXPECT_EQ(errors(scene, dvec3(centre), 1.25), 0u);
    scene.camera.eye *= 1e5f, scene.camera.fov_y = 5e-4f;
    EXPECT_EQ(errors(scene, dvec3(centre), 1.25), 0u);
    scene.camera.projection = Projection::orthographic, scene.camera.height = 3;
    EXPECT_EQ(errors(scene, dvec3(centre), 1.25), 0u);
}

/// From a sphere at the angle of incidence, by the radius and not by a facet.
TEST(FormulaScene, MirroredRaysFollowTheSphere) {
    for (const vec3 eye : {vec3(0, 0.5f, 4), vec3(0.3f, 4, 0.4f)}) {
        Scene scene = seen_from(eye, {0, 0, 0});
        add_mesh(scene, make_sphere(1, 8, 4), {0, 0, 0}, mirror());
        const RayTree tree = traced(scene).tree;
        ASSERT_EQ(tree.levels.size(), 2u);
        EXPECT_EQ(tree.levels[1].counts.met, 0u) << "a convex body does not see itself";
        for (const SecondaryRay& ray : tree.levels[1].rays) {
            const Ray from    = eye_ray(scene, ray.parent);
            const double b    = glm::dot(from.origin, from.direction);
            const double root = std::sqrt(b * b - glm::dot(from.origin, from.origin) + 1);
            const dvec3 n     = from.origin + (-b - root) * from.direction;
            EXPECT_NEAR(glm::length(ray.direction - mirrored(from.direction, n)), 0, 2e-5 / std::max(root, 0.01));
        }
        EXPECT_GT(tree.levels[1].rays.size(), 300u);
    }
}

/// Lambert's cosine, of the sphere's normal and of the box's.
TEST(FormulaScene, TheSumHasTheNormalsOfTheBodies) {
    Scene scene = seen_from({1, 2, 5}, {0, 0, 0});
    Material white;
    white.k_a = vec3(0), white.k_d = vec3(1);
    add_mesh(scene, make_sphere(1, 8, 4), {-1.2f, 0, 0}, white);
    add_mesh(scene, make_box({1, 1, 1}), {1, 0, 0}, white);
    Light sun;
    sun.name = "sun", sun.kind = LightKind::directional, sun.direction = {0.2f, -2, -1};
    scene.lights.push_back(sun);
    const Traced done     = traced(scene);
    const RayLevel& level = done.tree.levels[0];
    const dvec3 to_sun    = glm::normalize(dvec3(-0.2, 2, 1));
    std::array<std::size_t, 2> compared{};
    for (std::size_t i = 0; i < level.points.size(); ++i) {
        const std::uint32_t body = level.on_body[i].body;
        if (body == kNoBody || done.visibility[0][0].s[i] == 0) continue;
        const dvec3 local     = dvec3(level.points.position(i)) - dvec3(body == 0 ? -1.2 : 1, 0, 0);
        const dvec3 far       = glm::abs(local);
        const dvec3 face      = far.x > far.y && far.x > far.z ? dvec3(1, 0, 0)
                                : far.y > far.z                ? dvec3(0, 1, 0)
                                                               : dvec3(0, 0, 1);
        const double expected = glm::dot(body == 0 ? local : face * glm::sign(local), to_sun);
        EXPECT_NEAR(done.image.at(i, 0), std::max(expected, 0.0), 1e-5) << i;
        ++compared[body];
    }
    EXPECT_GT(compared[0], 100u);
    EXPECT_GT(compared[1], 100u);
}

/// A ball lens of radius 1: a ray at height h is turned by 2 (asin h - asin(h / n)), and a ray close to the axis meets
/// the axis at n / (2 (n - 1)) from the centre. The smaller root above 0 never leaves the ball.
TEST(FormulaScene, ABallOfGlassIsALens) {
    for (const double index : {1.5, 1.8})
        for (const double h : {0.01, 0.3, 0.6, 0.9}) {
            Scene scene             = seen_from({-4, float(h), 0}, {0, float(h), 0}, 1, 1);
            scene.camera.projection = Projection::orthographic;
            add_mesh(scene, make_sphere(1, 8, 4), {0, 0, 0}, glass(float(index)));
            const RayTree tree = traced(scene, {.depth = 3}).tree;
            ASSERT_EQ(tree.levels.size(), 3u);
            const double height = static_cast<double>(float(h)), in = std::asin(height),
                         bent = std::asin(height / index);
            // Within the ball: the second ray of the point.
            const Ray inside = secondary_ray(scene, tree, 1, 1);
            EXPECT_NEAR(std::acos(inside.direction.x), in - bent, 1e-6);
            EXPECT_EQ(tree.levels[1].points.triangle[1], 0u) << "meets the far side";
            EXPECT_EQ(tree.levels[1].counts.met, 1u);
            const auto passage = through_sphere(inside.origin, inside.direction, dvec3(0), 1);
            ASSERT_TRUE(passage);
            EXPECT_LT(passage->enter, 1e-6) << "so that the lecture's rule finds nothing";
            EXPECT_NEAR(glm::length(tree.levels[1].on_body[1].position - inside.origin), 2 * std::cos(bent), 1e-6);
            // Out of it: the last ray, and its parent is that point.
            const auto& last = tree.levels[2].rays;
            ASSERT_EQ(last.size(), 2u);
            EXPECT_EQ(last[1].kind, RayKind::refracted);
            EXPECT_NEAR(std::atan2(-last[1].direction.y, last[1].direction.x), 2 * (in - bent), 2e-6);
            EXPECT_EQ(tree.levels[2].counts.met, 1u) << "the mirrored one stays in, the refracted one leaves";
            if (h > 0.02) continue;
            const dvec3 p      = tree.levels[1].on_body[1].position;
            const double focus = p.x - p.y * last[1].direction.x / last[1].direction.y;
            EXPECT_NEAR(focus, index / (2 * (index - 1)), 1e-3);
        }
}

/// An eye in a sphere sees it everywhere, from inside.
TEST(FormulaScene, TheEyeMayBeInsideASphere) {
    Scene scene = seen_from({0.3f, 0, 0}, {1, 1, 0});
    add_mesh(scene, make_sphere(2, 16, 8), {0, 0, 0}, Material());
    add_light(scene, {0, 1, 0});
    add_light(scene, {0, 5, 0});
    const Traced done     = traced(scene);
    const RayLevel& level = done.tree.levels[0];
    EXPECT_EQ(level.counts.met, level.points.size());
    std::size_t before_outside = 0;
    for (std::size_t i = 0; i < level.points.size(); ++i) {
        const Ray ray = eye_ray(scene, i);
        EXPECT_LT(through_sphere(ray.origin, ray.direction, dvec3(0), 2)->enter, 0) << "the lecture's rule finds none";
        EXPECT_EQ(level.points.flipped[i], 1);
        EXPECT_NEAR(glm::dot(level.on_body[i].position, level.on_body[i].normal), -2, 1e-6);
        EXPECT_EQ(done.visibility[0][0].s[i], 1);
        EXPECT_EQ(done.visibility[0][1].s[i], 0) << "the sphere is between";
        before_outside += -5 * level.on_body[i].normal.y < 2 ? 1 : 0;
    }
    EXPECT_GT(before_outside, 10u);
    EXPECT_EQ(level.counts.shadow, level.points.size() + before_outside);
}

/// From inside glass: beyond the critical angle of 41.8 degrees all is mirrored.
TEST(FormulaScene, ABoxOfGlassMirrorsTotally) {
    const auto counts = [](double degrees) {
        const double in = degrees * kPi / 180;
        Scene scene     = seen_from(vec3(0), vec3(float(std::sin(in)), float(std::cos(in)), 0), 1, 1);
        add_mesh(scene, make_box({40, 2, 40}), {0, 0, 0}, glass(1.5f));
        return traced(scene, {.depth = 2}).tree;
    };
    const RayTree leaves = counts(41), stays = counts(43);
    EXPECT_EQ(leaves.levels[0].counts.total, 0u);
    ASSERT_EQ(leaves.levels[1].rays.size(), 2u);
    EXPECT_NEAR(leaves.levels[1].rays[1].direction.x, 1.5 * std::sin(41 * kPi / 180), 1e-6);
    EXPECT_EQ(stays.levels[0].counts.total, 1u);
    ASSERT_EQ(stays.levels[1].rays.size(), 1u);
    EXPECT_NEAR(stays.levels[1].rays[0].factor, 1, 1e-6);
}

/// A ball of radius 1 at height 2 under a light at height 6: on the floor its shadow is a circle.
TEST(FormulaScene, ShadowOfABallIsACircle) {
    Scene scene = seen_from({0, 9, 0.1f}, {0, 0, 0}, 100, 100);
    add_mesh(scene, make_plane(20, 20), {0, 0, 0}, Material());
    add_mesh(scene, make_sphere(1, 8, 4), {0, 2, 0}, Material());
    add_light(scene, {0, 6, 0});
    const double rim = 6 * std::tan(std::asin(0.25));
    const auto check = [&](float in_shadow) {
        const Traced done     = traced(scene);
        const RayLevel& level = done.tree.levels[0];
        std::size_t dark      = 0;
        for (std::size_t i = 0; i < level.points.size(); ++i) {
            if (level.on_body[i].body != kNoBody || level.points.triangle[i] == kNoTriangle) continue;
            const vec3 p        = level.points.position(i);
            const double radius = std::hypot(double(p.x), double(p.z));
            if (std::abs(radius - rim) < 1e-5) continue;
            EXPECT_FLOAT_EQ(done.visibility[0][0].s[i], radius < rim ? in_shadow : 1) << radius;
            dark += radius < rim ? 1 : 0;
        }
        EXPECT_GT(dark, 20u);
    };
    check(0);
    scene.materials[1].transmit = 0.5f;
    check(1);
    scene.transparent = TransparentOccluders::block;
    check(0);
    scene.transparent = TransparentOccluders::multiply;
    check(0.25f);
    // A pane of triangles under the ball: the product of all three surfaces.
    Material pane;
    pane.opacity = 0.25f;
    add_mesh(scene, make_plane(20, 20), {0, 0.5f, 0}, pane);
    const Traced done     = traced(scene);
    const RayLevel& level = done.tree.levels[1];  // what is seen through the pane
    std::size_t dark      = 0;
    for (std::size_t i = 0; i < level.points.size(); ++i) {
        if (level.points.triangle[i] == kNoTriangle || level.on_body[i].body != kNoBody) continue;
        if (level.points.position(i).y != 0) continue;
        const float s = done.visibility[1][0].s[i];
        EXPECT_TRUE(std::abs(s - 0.75f) < 1e-6f || std::abs(s - 0.75f * 0.25f) < 1e-6f) << s;
        dark += s < 0.5f ? 1 : 0;
    }
    EXPECT_GT(dark, 20u);
}

/// On a ball, a light's point is in front of the tangent plane or not, and nothing else hides it.
TEST(FormulaScene, TheTerminatorOfABallIsItsTangentCone) {
    Scene scene = seen_from({0, 0, 5}, {0, 0, 0}, 80, 60);
    add_mesh(scene, make_sphere(1, 8, 4), {0, 0, 0}, Material());
    add_light(scene, {3, 1, 1});
    Light sun;
    sun.name = "sun", sun.kind = LightKind::directional, sun.direction = {-1, -2, 0.5f};
    scene.lights.push_back(sun);
    Light lamp;
    lamp.name = "lamp", lamp.kind = LightKind::rectangle, lamp.position = {0, 3, 0};
    lamp.edge_u = {0, 0, 2}, lamp.edge_v = {4, 0, 0}, lamp.direction = {0, 1, 0};
    scene.lights.push_back(lamp);
    const Traced done     = traced(scene);
    const RayLevel& level = done.tree.levels[0];
    std::size_t partly    = 0;
    for (std::size_t i = 0; i < level.points.size(); ++i) {
        if (level.on_body[i].body == kNoBody) continue;
        const dvec3 n        = level.on_body[i].normal;
        const double to_lamp = glm::dot(n, dvec3(3, 1, 1)) - 1, to_sun = glm::dot(n, dvec3(1, 2, -0.5));
        if (std::abs(to_lamp) > 1e-6) {
            EXPECT_EQ(done.visibility[0][0].s[i], to_lamp > 0 ? 1 : 0);
        }
        if (std::abs(to_sun) > 1e-6) {
            EXPECT_EQ(done.visibility[0][1].s[i], to_sun > 0 ? 1 : 0);
        }
        // Of the rectangle, the part in front of the plane n.x = 1: by a fine grid.
        int front = 0;
        for (int row = 0; row < 40; ++row)
            for (int k = 0; k < 40; ++k)
                front += glm::dot(n, dvec3((k + 0.5) / 10 - 2, 3, (row + 0.5) / 20 - 1)) > 1 ? 1 : 0;
        const double expected = front / 1600.0;
        EXPECT_NEAR(done.visibility[0][2].s[i], expected, expected == 0 || expected == 1 ? 0.01 : 0.25) << i;
        partly += level.points.facing[2][i] == Facing::partly ? 1 : 0;
    }
    EXPECT_GT(partly, 50u);
    EXPECT_LT(done.tree.levels[0].counts.shadow, 3 * level.counts.met);
}

/// Disks and spheres as lights: all of it is seen, or nothing where a box lies between.
TEST(FormulaScene, LightsWithAnAreaAreSampled) {
    for (const LightKind kind : {LightKind::disk, LightKind::sphere, LightKind::rectangle}) {
        Scene scene = seen_from({0, 2, 9}, {0, 0, 0}, 40, 30);
        add_mesh(scene, make_plane(20, 20), {0, 0, 0}, Material());
        add_mesh(scene, make_box({20, 0.5f, 20}), {10, 3, 0}, Material());  // above x > 0
        Light light;
        light.name = "light", light.kind = kind, light.position = {0, 6, 0}, light.radius = 1;
        light.edge_u = {2, 0, 0}, light.edge_v = {0, 0, 2}, light.direction = {0, -1, 0};
        scene.lights.push_back(light);
        const Traced done        = traced(scene);
        const PointBatch& points = done.tree.levels[0].points;
        std::size_t lit = 0, dark = 0, between = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points.triangle[i] > 1) continue;
            const float s = done.visibility[0][0].s[i], x = points.px[i];
            EXPECT_EQ(s * kFormulaLightSamples, std::round(s * kFormulaLightSamples));
            if (x < -1.4f) {
                EXPECT_EQ(s, 1) << x;
            }
            if (x > 1.4f) {
                EXPECT_EQ(s, 0) << x;
            }
            lit += s == 1, dark += s == 0, between += s > 0 && s < 1;
        }
        EXPECT_GT(lit, 50u);
        EXPECT_GT(dark, 50u);
        EXPECT_GT(between, 10u);
    }
}

/// Ball and box cut into one another: each ray meets what is nearer, and nothing has to be cut.
TEST(FormulaScene, BodiesMayInterpenetrate) {
    Scene scene = seen_from({1, 2, 5}, {0, 0, 0});
    add_mesh(scene, make_sphere(1, 8, 4), {0, 0, 0}, Material());
    add_mesh(scene, make_box({1.5f, 1.5f, 1.5f}), {0.5f, 0.2f, 0}, Material());
    const RayLevel level = traced(scene).tree.levels[0];
    std::array<std::size_t, 2> met{};
    for (std::size_t i = 0; i < level.points.size(); ++i) {
        const Ray ray   = eye_ray(scene, i);
        const auto ball = first_meeting(through_sphere(ray.origin, ray.direction, dvec3(0), 1)),
                   box  = first_meeting(
                        through_box(ray.origin, ray.direction, dvec3(-0.25, -0.55, -0.75), dvec3(1.25, 0.95, 0.75)));
        if (ball && box && std::abs(*ball - *box) < 1e-6) continue;
        const std::uint32_t expected = ball && (!box || *ball < *box) ? 0 : box ? 1 : kNoBody;
        EXPECT_EQ(level.on_body[i].body, expected) << i;
        if (expected != kNoBody) ++met[expected];
    }
    EXPECT_GT(met[0], 50u);
    EXPECT_GT(met[1], 50u);
}

/// A ball cut by a square of two triangles: of both, the nearer one is met, by eye rays and by mirrored ones.
TEST(FormulaScene, BodiesAndTrianglesHideOneAnother) {
    Scene scene = seen_from({1, 2, 5}, {0, 0, 0});
    add_mesh(scene, make_plane(4, 4), {0, 0.25f, 0}, mirror());
    add_mesh(scene, make_sphere(1, 8, 4), {0, 0, 0}, mirror());
    const RayTree tree = traced(scene, {.depth = 2}).tree;
    ASSERT_EQ(tree.levels.size(), 2u);
    std::array<std::size_t, 2> met{};
    const auto check = [&](const RayLevel& level, std::size_t i, const Ray& ray, bool on_ball, bool on_plane) {
        const auto ball   = first_meeting(through_sphere(ray.origin, ray.direction, dvec3(0), 1));
        const double t    = (0.25 - ray.origin.y) / ray.direction.y;
        const dvec3 p     = ray.origin + t * ray.direction;
        const double edge = std::max(std::abs(p.x), std::abs(p.z)) - 2;
        const bool plane  = !on_plane && t > 0 && edge < 0;
        const bool hits   = !on_ball && ball.has_value();
        if (std::abs(edge) < 1e-5 || (plane && hits && std::abs(*ball - t) < 1e-5)) return;
        const bool ball_first = hits && (!plane || *ball < t);
        EXPECT_EQ(level.on_body[i].body, ball_first ? 0 : kNoBody) << i;
        EXPECT_EQ(level.points.triangle[i] < 2, plane && !ball_first) << i;
        if (hits && plane) ++met[ball_first ? 0 : 1];
    };
    for (std::size_t i = 0; i < tree.levels[0].points.size(); ++i)
        check(tree.levels[0], i, eye_ray(scene, i), false, false);
    for (std::size_t i = 0; i < tree.levels[1].rays.size(); ++i) {
        const bool on_ball = tree.levels[0].on_body[tree.levels[1].rays[i].parent].body == 0;
        check(tree.levels[1], i, secondary_ray(scene, tree, 1, i), on_ball, !on_ball);
    }
    EXPECT_GT(met[0], 50u) << "the ball before the square";
    EXPECT_GT(met[1], 50u) << "the square before the ball";
}

/// Opposite windings: an inside-out ball is one from within, for glass and for one-sided materials.
TEST(FormulaScene, AnInsideOutBallIsABubble) {
    Scene scene = seen_from({-4, 0.5f, 0}, {0, 0.5f, 0}, 1, 1);
    Mesh bubble = make_sphere(1, 16, 8);
    for (vec3& n : bubble.normals) n = -n;
    for (uvec3& t : bubble.triangles) std::swap(t.y, t.z);
    scene.camera.projection = Projection::orthographic;
    add_mesh(scene, bubble, {0, 0, 0}, glass(1.5f));
    const RayTree tree = traced(scene, {.depth = 2}).tree;
    ASSERT_EQ(tree.levels[1].rays.size(), 2u);
    EXPECT_NEAR(tree.levels[1].rays[1].direction.y, std::sin(std::asin(0.75) - std::asin(0.5)), 1e-6)
        << "from glass into air: away from the axis";
}

TEST(FormulaScene, SameBitsForAnyNumberOfThreads) {
    Scene scene = seen_from({1, 3, 7}, {0, 0.5f, 0});
    add_mesh(scene, make_plane(12, 12), {0, 0, 0}, mirror());
    for (int row = 0; row < 4; ++row)
        for (int k = 0; k < 5; ++k)
            add_mesh(scene, make_sphere(0.5f, 8, 4), {0.6f * float(k) - 1, 0.5f, 0.7f * float(row) - 1}, glass(1.3f));
    add_light(scene, {2, 5, 3});
    scene.transparent    = TransparentOccluders::multiply;
    scene.lights[0].kind = LightKind::sphere, scene.lights[0].radius = 0.5f;
    const Traced many = traced(scene);
    const ThreadLimit one(1);
    const Traced alone = traced(scene);
    EXPECT_EQ(many.image.data, alone.image.data);
}

/// The tree of bounds finds what a test of every body finds.
TEST(BodyTree, FindsWhatASearchFinds) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    const auto point = [&] { return dvec3(any(random), any(random), any(random)); };
    std::vector<Body> bodies;
    for (int k = 0; k < 300; ++k) {
        Body body;
        body.centre = dvec3(1000, 0, 0) + 10.0 * point();
        if (k % 5 == 0) {
            body.radius = 0.5 + 0.4 * any(random);
        } else {
            body.kind      = static_cast<BodyKind>(k % 5);
            const dvec3 u  = glm::normalize(point());
            const dvec3 v  = glm::normalize(glm::cross(u, point()));
            body.axes      = dmat3(u, v, glm::cross(u, v));
            body.half_size = dvec3(0.6) + 0.5 * point();
            body.radius    = body.half_size.x;
            if (body.kind == BodyKind::torus) body.half_size.z *= 0.8 * body.radius;
            if (body.kind == BodyKind::torus) body.half_size.x += body.half_size.z;
            if (body.kind != BodyKind::box) body.half_size.y = body.half_size.x;
        }
        bodies.push_back(body);
    }
    const BodyTree tree(bodies, std::vector<vec3>(bodies.size(), vec3(0.5f)));
    std::size_t met = 0;
    for (int k = 0; k < 3000; ++k) {
        const bool afar    = k % 3 == 0;
        const dvec3 origin = dvec3(1000, 0, 0) + (afar ? 1e6 : 12.0) * point();
        const dvec3 d      = glm::normalize(dvec3(1000, 0, 0) + 10.0 * point() - origin);
        const double reach = afar || k % 2 == 0 ? double(kInfinity) : 6;
        BodyMeeting nearest;
        nearest.t   = reach;
        int crossed = 0;
        for (std::uint32_t b = 0; b < bodies.size(); ++b) {
            const Passages passages = through_body(bodies[b], origin, d);
            for (int p = 0; p < passages.count; ++p)
                for (const double t : {passages.list[static_cast<std::size_t>(p)].enter,
                                       passages.list[static_cast<std::size_t>(p)].leave}) {
                    if (!(t > 0 && t < reach)) continue;
                    ++crossed;
                    if (t < nearest.t) nearest = {b, t};
                }
        }
        const BodyMeeting found = tree.first({origin, d, kNoBody, reach});
        EXPECT_EQ(found.body, nearest.body) << k;
        if (nearest.body != kNoBody) {
            EXPECT_EQ(found.t, nearest.t) << k;
        }
        EXPECT_EQ(tree.lets_through({origin, d, kNoBody, reach}), dvec3(std::pow(0.5, crossed))) << k;
        met += nearest.body != kNoBody ? 1 : 0;
    }
    EXPECT_GT(met, 1000u);
    EXPECT_EQ(BodyTree({}, {}).first({}).body, kNoBody);
    EXPECT_EQ(BodyTree({}, {}).lets_through({}), dvec3(1));
}

/// From a point of a body, found to rounding: a convex one is not met outwards, and inwards at its far side, however near
/// that is; a torus may be met again on the other side of its hole.
TEST(BodyTree, ABodyIsLeftFromItsSurface) {
    Body ball, box, cylinder, cone, torus;
    ball.centre = {3, 1, 2}, ball.radius = 0.7;
    box.kind = BodyKind::box, box.centre = {-3, 1, 2}, box.half_size = {0.5, 1, 2};
    cylinder.kind = BodyKind::cylinder, cylinder.centre = {0, 5, 0}, cylinder.radius = 0.5,
    cylinder.half_size = {0.5, 0.5, 1};
    cone.kind = BodyKind::cone, cone.centre = {0, -5, 0}, cone.radius = 0.8, cone.half_size = {0.8, 0.8, 0.6};
    torus.kind = BodyKind::torus, torus.centre = {0, 0, -6}, torus.radius = 1, torus.half_size = {1.3, 1.3, 0.3};
    const std::vector<Body> bodies{ball, box, cylinder, cone, torus};
    const BodyTree tree(bodies, std::vector<vec3>(bodies.size(), vec3(0)));
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1, 1);
    std::size_t again = 0;
    for (int k = 0; k < 5000; ++k) {
        const dvec3 v(any(random), any(random), any(random)),
            d            = glm::normalize(dvec3(any(random), any(random), any(random)));
        const auto b     = static_cast<std::uint32_t>(k % 5);
        const Body& body = tree.body(b);
        const dvec3 size = b == 0 ? dvec3(1) : body.half_size;
        dvec3 near       = v * size;
        if (b == 2 || b == 3) near = dvec3(0.7, 0.7, 1) * near;  // not to the rim, where two normals are
        if (b == 1) near[k / 5 % 3] = (v.x < 0 ? -1.01 : 1.01) * size[k / 5 % 3];
        const OnSurface on    = onto_surface(body, body.centre + near);
        const BodyMeeting met = tree.first({on.position, d, b, double(kInfinity)});
        if (glm::dot(d, on.normal) > 0) {
            again += met.body == b ? 1 : 0;
            if (body.kind != BodyKind::torus) {
                EXPECT_NE(met.body, b) << k;
            }
            continue;
        }
        ASSERT_EQ(met.body, b) << k;
        const dvec3 far = on.position + met.t * d;
        EXPECT_NEAR(glm::length(onto_surface(body, far).position - far), 0, 1e-11) << k;
        EXPECT_GT(glm::dot(onto_surface(body, far).normal, d), -1e-9) << k;
        EXPECT_EQ(tree.lets_through({on.position, d, b, double(kInfinity)}), dvec3(0));
    }
    EXPECT_GT(again, 10u) << "through the hole";
    EXPECT_LT(again, 300u);
}

}  // namespace
}  // namespace umbra
