// Outlines against triangles one by one: any difference is a fault, since both answer to rounding.
#include "umbra/shadows/planar/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <string>

#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/planar/darkening_tree.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

void add(Scene& scene, const std::string& name, const Mesh& mesh, const mat4& m = mat4(1)) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    const Mesh placed = transformed(mesh, m);
    add_object(scene, name, placed.positions, {}, placed.triangles, 0);
}

struct Compared {
    std::size_t lit = 0, dark = 0, differ = 0;
};

Compared compare(const Scene& scene, const PointBatch& points, const std::string& more = "") {
    Compared result;
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        VisibilityPlane plane[2];
        for (const int k : {0, 1}) {
            MethodCase run(std::string("planar_projection:edges=") + (k == 0 ? "weighted" : "per_triangle") + more,
                           scene);
            run.prepare(light);
            plane[k] = run.visibility(points, light);
        }
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_open(points, light, i) || !plane[1].defined(i)) continue;
            result.lit += plane[1].s[i] == 1;
            result.dark += plane[1].s[i] == 0;
            result.differ += plane[0].s[i] != plane[1].s[i] || plane[0].answer[i] != plane[1].answer[i];
        }
    }
    return result;
}

class Random {
public:
    explicit Random(unsigned seed) : random_(seed) {}
    float operator()(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
    bool chance(float p) { return (*this)(0, 1) < p; }
    unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }

private:
    std::mt19937 random_;
};

/// Triangles of any size, wound either way, with shared corners and without, over, under and across the floor, and
/// about the height of the light. `grid`: coordinates are multiples of a half, so that edges lie over one another and
/// over points.
Scene soup(unsigned seed, bool grid) {
    Random random(seed);
    const auto place = [&] {
        const vec3 p(random(-4, 4), random(-0.4f, 3.2f), random(-4, 4));
        return grid ? glm::round(2.0f * p) * 0.5f : p;
    };
    Scene scene;
    mat4 tilt(1);
    if (!grid) tilt = glm::rotate(glm::translate(mat4(1), vec3(random(-9, 9))), random(0, 3), vec3(0.6f, 0, 0.8f));
    add(scene, "floor", make_plane(12, 12), tilt);
    Mesh mesh;
    for (int i = 0; i < 30; ++i) mesh.positions.push_back(place());
    const auto corner = [&] { return random.below(static_cast<unsigned>(mesh.positions.size())); };
    for (int i = 0; i < 40; ++i) mesh.triangles.emplace_back(corner(), corner(), corner());
    add(scene, "soup", mesh, tilt);
    add(scene, "box", make_box({1, 1, 1}), glm::translate(tilt, grid ? vec3(1, 1, 1) : vec3(1.3f, 0.9f, 0.7f)));
    add(scene, "ball", make_sphere(0.6f, 16, 8), glm::translate(tilt, vec3(-2, 1, 1)));
    Light lamp;
    lamp.position = vec3(tilt * vec4(grid ? vec3(0, 3, 0) : vec3(random(-2, 2), random(1, 4), random(-2, 2)), 1));
    scene.lights.push_back(lamp);
    Light sun;
    sun.kind      = LightKind::directional;
    sun.direction = vec3(tilt * vec4(grid ? vec3(0, -1, 0) : vec3(random(-1, 1), -1, random(-1, 1)), 0));
    scene.lights.push_back(sun);
    sun.direction = vec3(tilt * vec4(grid ? vec3(1, -1, 0) : vec3(random(-9, 9), -1, random(-9, 9)), 0));
    scene.lights.push_back(sun);
    scene.camera.eye    = vec3(tilt * vec4(0.5f, 9, 5, 1));
    scene.camera.target = vec3(tilt * vec4(0, 0, 0, 1));
    scene.width = 160, scene.height = 100;
    return scene;
}

TEST(Outline, AnswersAsEveryTriangleForItself) {
    Compared all;
    for (unsigned seed = 0; seed < 60; ++seed) {
        const Scene scene       = soup(seed, false);
        const Compared compared = compare(scene, primary(scene));
        EXPECT_EQ(compared.differ, 0u) << seed;
        all.lit += compared.lit, all.dark += compared.dark;
    }
    EXPECT_GT(all.lit, 100000u);
    EXPECT_GT(all.dark, 100000u);
}

/// Corners, edges and points lie over one another everywhere, walls are seen edge-on: what rounding leaves open is
/// asked of the triangles.
TEST(Outline, AnswersAsTrianglesOnAGrid) {
    Compared all;
    for (unsigned seed = 0; seed < 40; ++seed) {
        const Scene scene = soup(seed, true);
        PointBatch points;
        points.eye = scene.camera.eye;
        points.resize(2 * 49 * 49);
        // The floor is two triangles of 12 x 12: points at multiples of a quarter.
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::size_t column = i / 2 % 49, row = i / 2 / 49;
            const auto x = static_cast<float>(column) / 48, y = static_cast<float>(row) / 48;
            if (x + y <= 1) set_point(points, i, scene, static_cast<TriangleId>(i % 2), x, y);
        }
        face_lights(points, scene);
        const Compared compared = compare(scene, points);
        EXPECT_EQ(compared.differ, 0u) << seed;
        all.lit += compared.lit, all.dark += compared.dark;
    }
    EXPECT_GT(all.lit, 10000u);
    EXPECT_GT(all.dark, 10000u);
}

TEST(Outline, AnswersAsTrianglesUnderAreaLights) {
    for (unsigned seed = 0; seed < 8; ++seed) {
        Scene scene             = soup(seed, false);
        scene.lights[0].kind    = seed % 2 == 0 ? LightKind::sphere : LightKind::rectangle;
        scene.lights[0].radius  = 0.4f;
        scene.lights[0].edge_u  = {0.7f, 0.2f, 0};
        scene.lights[0].edge_v  = {0, 0.1f, 0.5f};
        const Compared compared = compare(scene, primary(scene), ",light_samples=9");
        EXPECT_EQ(compared.differ, 0u) << seed;
    }
}

/// At 1e-12, at 1e12 and far from the origin.
TEST(Outline, AnswersAsTrianglesAtEveryScale) {
    for (const float scale : {1e-12f, 1e-3f, 1e5f, 1e12f})
        for (const float offset : {0.0f, 1000.0f}) {
            Scene scene      = soup(5, false);
            const auto moved = [&](vec3 p) { return (p + offset) * scale; };
            for (vec3& p : scene.positions) p = moved(p);
            scene.lights[0].position = moved(scene.lights[0].position);
            scene.camera.eye = moved(scene.camera.eye), scene.camera.target = moved(scene.camera.target);
            const Compared compared = compare(scene, primary(scene));
            EXPECT_EQ(compared.differ, 0u) << scale << ", " << offset;
            EXPECT_GT(compared.lit, 500u);
            EXPECT_GT(compared.dark, 500u);
        }
}

/// A box of 2 x 2 x 2 whose lid is at height 3 and whose bottom is at 1, a light at height 4 over its middle: the
/// shadow is that of the lid, 8 x 8, which its sides and the bottom, 2.67 wide, do not leave.
struct BoxOverFloor {
    Scene scene;
    planar::Occluders occluders;
    std::vector<planar::Receiver> receivers;

    BoxOverFloor() {
        add(scene, "floor", make_plane(20, 20));
        add(scene, "box", make_box({2, 2, 2}), glm::translate(mat4(1), vec3(0, 2, 0)));
        const SceneFacts facts = find_facts(scene);
        for (const PlanarReceiver& plane : facts.planes)
            if (scene.triangle_object[plane.triangles[0]] == 0)
                receivers.push_back(planar::make_receiver(scene, plane, 0, +1));
        occluders = {&scene, {}, std::vector(scene.triangles.size(), planar::Occluders::kNoPlane)};
        for (TriangleId t = 0; t < scene.triangles.size(); ++t) {
            occluders.triangles.push_back(t);
            if (scene.triangle_object[t] == 0) occluders.plane_of[t] = 0;
        }
    }
    [[nodiscard]] planar::Outline outline(vec3 lamp) const {
        const OccluderMesh mesh(scene);
        return planar::project(occluders, &mesh, receivers, std::vector<planar::Source>{{false, lamp}}, 0)[0][0];
    }
};

TEST(Outline, OfABoxIsItsSilhouette) {
    const BoxOverFloor box;
    ASSERT_EQ(box.receivers.size(), 1u);
    const planar::Outline outline = box.outline({0, 4, 0});
    EXPECT_TRUE(outline.rest.empty());
    ASSERT_EQ(outline.edges.size(), 4u);  // all triangles face the light or away from it, the lid's border is left
    for (const planar::OutlineEdge& e : outline.edges) {
        EXPECT_EQ(std::abs(e.change), 2) << "a triangle of the lid and one of a side";
        EXPECT_NEAR(glm::length(e.to - e.from), 8, 1e-12);
    }
    // Over the middle there are lid and bottom; over a point beside it, within the lid's shadow alone, lid and side.
    const auto count_at = [&](double x, double z) {
        const dvec3 at = box.receivers[0].local({x, 0, z});
        const double to_x[]{at.x}, to_y[]{at.y};
        double count[]{outline.count}, doubt[]{0};
        for (const planar::OutlineEdge& e : outline.edges) add_changes(e, outline.reference, to_x, to_y, count, doubt);
        EXPECT_EQ(doubt[0], 0);
        return count[0];
    };
    EXPECT_EQ(count_at(0.01, 0.02), 2);
    EXPECT_EQ(count_at(3.9, -3.8), 2);
    EXPECT_EQ(count_at(4.1, 0.3), 0);
    EXPECT_EQ(count_at(-3, 4.2), 0);
}

/// What the floor cuts and what reaches the height of the light has no place in an outline.
TEST(Outline, LeavesOutWhatThePlaneCutsAndWhatReachesTheLight) {
    BoxOverFloor box;
    const auto in_rest = [](const planar::Outline& outline) {
        std::size_t n = 0;
        for (const planar::Shadows& run : outline.rest) n += run.shadows.size();
        return n;
    };
    EXPECT_EQ(in_rest(box.outline({5, 4, 0})), 0u);
    EXPECT_GT(in_rest(box.outline({5, 3, 0})), 0u) << "the lid's height";
    EXPECT_GT(in_rest(box.outline({5, 2, 0})), 0u) << "below the lid";
    for (std::size_t i = 0; i < box.scene.positions.size(); ++i)
        if (box.scene.positions[i].y > 0) box.scene.positions[i].y -= 2;
    EXPECT_GT(in_rest(box.outline({5, 4, 0})), 0u) << "cut by the floor";
}

/// `slack` and `doubt` bound what rounding did to ends and sides, compared with long doubles, and are no larger than a
/// few hundred roundings.
TEST(Outline, BoundsItsRounding) {
    using Long = glm::vec<3, long double>;
    Random random(7);
    double most_slack = 0, most_doubt = 0;  // shares of the bounds that were used
    for (int i = 0; i < 400; ++i) {
        const mat4 tilt  = glm::rotate(glm::translate(mat4(1), vec3(random(-9, 9))), random(0, 3), vec3(0.6f, 0, 0.8f));
        const auto place = [&](float low, float high) {
            return vec3(tilt * vec4(random(-4, 4), random(low, high), random(-4, 4), 1));
        };
        Scene scene;
        add(scene, "floor", make_plane(12, 12), tilt);
        const Mesh triangle{{place(0.5f, 2), place(0.5f, 2), place(0.5f, 2)}, {}, {{0, 1, 2}}};
        add(scene, "triangle", triangle);
        const SceneFacts facts = find_facts(scene);
        ASSERT_FALSE(facts.planes.empty());
        const planar::Receiver r = planar::make_receiver(scene, facts.planes[0], 0, +1);
        planar::Occluders occluders{&scene, {2}, {0, 0, planar::Occluders::kNoPlane}};
        const planar::Source lamp{false, place(3, 5)};
        const planar::LocalSource local(r, lamp);
        if (!local.is_above()) continue;  // the plane's other side is up
        const OccluderMesh mesh(scene);
        const planar::Outline outline = planar::project(occluders, &mesh, std::vector{r}, std::vector{lamp}, 0)[0][0];

        const auto in_plane = [&](Long world) {
            const Long d = world - Long(r.origin);
            return Long(glm::dot(Long(r.e1), d), glm::dot(Long(r.e2), d), glm::dot(Long(r.normal), d));
        };
        const Long light = in_plane(Long(lamp.at));
        Long corner[3], shadow[3];
        for (int k = 0; k < 3; ++k) {
            corner[k] = in_plane(Long(triangle.positions[static_cast<std::size_t>(k)]));
            shadow[k] = corner[k] + (corner[k] - light) * (corner[k].z / (light.z - corner[k].z));
        }
        for (const planar::OutlineEdge& e : outline.edges) {
            const auto which = [&](dvec2 end) {
                int nearest = 0;
                for (int k = 1; k < 3; ++k)
                    if (glm::length(dvec2(shadow[k]) - end) < glm::length(dvec2(shadow[nearest]) - end)) nearest = k;
                return nearest;
            };
            const int from = which(e.from), to = which(e.to);
            ASSERT_NE(from, to);
            const auto off = [&](dvec2 end, Long truth) {
                return static_cast<double>(std::max(std::abs(truth.x - static_cast<long double>(end.x)),
                                                    std::abs(truth.y - static_cast<long double>(end.y))));
            };
            const double ends = std::max(off(e.from, shadow[from]), off(e.to, shadow[to]));
            EXPECT_LE(ends, e.slack);
            most_slack = std::max(most_slack, ends / e.slack);
            for (int k = 0; k < 20; ++k) {
                const dvec2 p(random(-8, 8), random(-8, 8));
                const Long at(p.x, p.y, 0);
                const long double side =
                    glm::dot(-glm::cross(corner[from] - light, corner[to] - corner[from]), at - corner[from]);
                const auto error = static_cast<double>(std::abs(side - static_cast<long double>(e.side.at(p.x, p.y))));
                EXPECT_LE(error, e.doubt);
                most_doubt = std::max(most_doubt, error / e.doubt);
            }
        }
    }
    EXPECT_GT(most_slack, 0.0005);
    EXPECT_GT(most_doubt, 0.001);
}

/// A point on an edge is in doubt, one an ulp of a float beside it is not.
TEST(Outline, NamesPointsOnEdges) {
    const BoxOverFloor box;
    const planar::Outline outline = box.outline({0, 4, 0});
    const auto doubtful           = [&](double x, double z) {
        const planar::PlaneTree points(20, [&](auto& to, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const dvec3 at = box.receivers[0].local({x + (i == 7 ? 0 : 0.1 * static_cast<double>(i) + 1), 0, z});
                to[0][i] = at.x, to[1][i] = at.y;
            }
        });
        planar::DarkeningTree tree(points);
        tree.darken(outline);
        const auto which = tree.doubtful();
        EXPECT_LE(which.size(), 1u);
        return which.size() == 1 && which[0] == 7;
    };
    EXPECT_TRUE(doubtful(4, 0.3));
    EXPECT_FALSE(doubtful(4.000001, 0.3));
    EXPECT_FALSE(doubtful(3.999999, 0.3));
}

/// A side of a box that is turned anyhow has corners at rounding's distance from its plane, and so have the triangles
/// of its neighbours, which are below: they leave points along the edge in doubt at most, and not the side.
TEST(Projection, NeighboursOfABoxesSideLeaveNoneOfItInDoubt) {
    std::size_t sides = 0, near_edges = 0, doubtful = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        Random random(seed);
        Scene scene;
        add(scene, "box", make_box({1, 2, 3}),
            glm::rotate(glm::translate(mat4(1), vec3(random(-9, 9), random(-9, 9), random(-9, 9))), random(0, 3),
                        glm::normalize(vec3(0.6f, random(-1, 1), 0.8f))));
        const SceneFacts facts = find_facts(scene);
        for (const PlanarReceiver& plane : facts.planes) {
            planar::Occluders occluders{&scene, {}, std::vector(scene.triangles.size(), planar::Occluders::kNoPlane)};
            for (TriangleId t = 0; t < scene.triangles.size(); ++t) occluders.triangles.push_back(t);
            for (const TriangleId t : plane.triangles) occluders.plane_of[t] = 0;
            // The outer side: the corners that are not its own are below.
            planar::Receiver receiver = planar::make_receiver(scene, plane, 0, +1);
            const auto lowest         = [&] {
                double low = 0;
                for (const vec3 p : scene.positions) low = std::min(low, receiver.local(dvec3(p)).z);
                return low;
            };
            if (lowest() > -0.5) receiver = planar::make_receiver(scene, plane, 0, -1);
            ASSERT_LT(lowest(), -0.5);
            const dvec2 middle = 0.5 * (receiver.low + receiver.high);
            const planar::Source lamp{
                false, vec3(receiver.origin + middle.x * receiver.e1 + middle.y * receiver.e2 + 2.0 * receiver.normal)};
            constexpr std::size_t side = 32;
            const planar::PlaneTree points(side * side, [&](auto& to, std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    const dvec2 share = (dvec2(i % side, i / side) + 0.5) / double(side);
                    const dvec2 at    = receiver.low + share * (receiver.high - receiver.low);
                    to[0][i] = at.x, to[1][i] = at.y;
                }
            });
            planar::DarkeningTree tree(points);
            const planar::LocalSource source(receiver, lamp);
            const double far = farthest(reach_of(receiver, source));
            for (const planar::Shadows& run : project(occluders, occluders.triangles, receiver, lamp))
                for (const planar::Shadow& shadow : run.shadows) {
                    near_edges += shadow.may_be_none;
                    tree.darken(shadow, sides_of(scene, receiver, source, run, shadow, far));
                }
            doubtful += tree.doubtful().size();
            for (std::size_t i = 0; i < points.size; ++i) EXPECT_FALSE(tree.is_dark(i)) << seed;
            ++sides;
        }
    }
    EXPECT_EQ(sides, 120u);
    EXPECT_GT(near_edges, 500u);
    EXPECT_LT(doubtful, sides / 4)
        << "of 1024 points a side, of which some 1e-4 are in the band of rounding at an edge";
}

/// A sheet that lies on a turned floor is above it or below: rounding hides which, and darkens no point.
TEST(Projection, OfASheetOnATurnedFloorIsInDoubt) {
    std::size_t sheets = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
        Random random(seed);
        Scene scene;
        const mat4 turned = glm::rotate(mat4(1), random(0, 3), glm::normalize(vec3(0.6f, random(-1, 1), 0.8f)));
        add(scene, "floor", make_plane(20, 20), turned);
        const planar::Receiver receiver = planar::make_receiver(scene, find_facts(scene).planes.at(0), 0, +1);
        add(scene, "sheet", make_plane(20, 20), turned);
        planar::Occluders occluders{&scene, {2, 3}, {0, 0, planar::Occluders::kNoPlane, planar::Occluders::kNoPlane}};
        const planar::Source lamp{false, vec3(receiver.origin + 8.0 * receiver.normal)};
        const dvec3 within = (receiver.local(dvec3(scene.vertex(2, 0))) + receiver.local(dvec3(scene.vertex(2, 1))) +
                              receiver.local(dvec3(scene.vertex(2, 2)))) /
                             3.0;
        const planar::PlaneTree point(1, [&](auto& to, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) to[0][i] = within.x, to[1][i] = within.y;
        });
        planar::DarkeningTree tree(point);
        const planar::LocalSource source(receiver, lamp);
        for (const planar::Shadows& run : project(occluders, occluders.triangles, receiver, lamp))
            for (const planar::Shadow& shadow : run.shadows) {
                if (!shadow.may_be_none || run.caster(shadow) != 2) continue;
                ++sheets;
                tree.darken(shadow,
                            sides_of(scene, receiver, source, run, shadow, farthest(reach_of(receiver, source))));
                EXPECT_FALSE(tree.is_dark(0)) << seed;
                EXPECT_EQ(tree.doubtful().size(), 1u) << seed;
                break;
            }
    }
    EXPECT_GT(sheets, 5u);
}

}  // namespace
}  // namespace umbra
