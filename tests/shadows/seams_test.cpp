// Surfaces have no seams: in pictures whose eye, light and pixels lie in the planes of diagonals and through corners,
// no pixel of the floor differs from both of its neighbours, to the left and right or above and below.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

void add_floor(Scene& scene) {
    scene.materials.emplace_back();
    add_object(scene, "floor", {{-6, 0, -6}, {6, 0, -6}, {6, 0, 6}, {-6, 0, 6}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
}

void add_box_at(Scene& scene, vec3 centre, vec3 size) {
    Mesh box = make_box(size);
    for (vec3& p : box.positions) p += centre;
    add_object(scene, "box", box.positions, {}, box.triangles, 0);
}

/// Over the floor, each of its own kind.
std::vector<std::pair<std::string, Scene>> surfaces() {
    std::vector<std::pair<std::string, Scene>> made;
    const auto add = [&](const char* name) -> Scene& {
        made.emplace_back(name, Scene{});
        add_floor(made.back().second);
        return made.back().second;
    };
    add_box_at(add("box"), {0, 1, 0}, {1, 1, 1});
    Scene& boxes = add("boxes side by side");
    add_box_at(boxes, {-0.5f, 1, 0}, {1, 1, 1});
    add_box_at(boxes, {0.5f, 1, 0}, {1, 1, 1});
    Scene& sheets = add("two equal sheets");
    for (int k = 0; k < 2; ++k)
        add_object(sheets, "sheet", {{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    std::vector<vec3> rim{{0, 1.5f, 0}, {1, 1, 0},      {0.5f, 1, 1}, {-0.5f, 1, 1},
                          {-1, 1, 0},   {-0.5f, 1, -1}, {0.5f, 1, -1}};
    std::vector<uvec3> around;
    for (unsigned k = 0; k < 6; ++k) around.emplace_back(0, 1 + k, 1 + (k + 1) % 6);
    add_object(add("fan"), "fan", rim, {}, around, 0);
    std::vector<vec3> lattice;
    std::vector<uvec3> cells;
    for (int z = 0; z <= 4; ++z)
        for (int x = 0; x <= 4; ++x)
            lattice.emplace_back(0.5f * static_cast<float>(x) - 1, 1, 0.5f * static_cast<float>(z) - 1);
    for (unsigned z = 0; z < 4; ++z)
        for (unsigned x = 0; x < 4; ++x) {
            const unsigned a = 5 * z + x, b = a + 1, c = a + 6, d = a + 5;
            cells.insert(cells.end(), (x + z) % 2 == 0 ? std::initializer_list<uvec3>{{a, c, b}, {a, d, c}}
                                                       : std::initializer_list<uvec3>{{a, d, b}, {b, d, c}});
        }
    add_object(add("lattice"), "lattice", lattice, {}, cells, 0);
    return made;
}

std::vector<Light> lights() {
    std::vector<Light> made;
    for (const vec3 d : {vec3(0, -1, 0), vec3(-1, -2, -1), vec3(0, -2, -1)}) {
        Light& sun = made.emplace_back();
        sun.kind = LightKind::directional, sun.direction = d;
    }
    for (const vec3 p : {vec3(0, 4, 0), vec3(2, 4, 2), vec3(1, 4, 0)}) {
        Light& lamp = made.emplace_back();
        lamp.kind = LightKind::point, lamp.position = p;
    }
    return made;
}

/// Pixels of the floor in the middle of a line that is one pixel wide and five long: shorter ones may be the tips of
/// shadows.
std::size_t seams(const VisibilityPlane& plane, const PointBatch& points, const Scene& scene, LightId light) {
    const auto width = static_cast<std::size_t>(scene.width), height = static_cast<std::size_t>(scene.height);
    std::size_t found = 0;
    for (std::size_t y = 2; y + 2 < height; ++y)
        for (std::size_t x = 2; x + 2 < width; ++x)
            for (const auto& [across, along] : {std::pair(std::size_t{1}, width), std::pair(width, std::size_t{1})}) {
                const std::size_t i = y * width + x;
                bool is_line        = plane.s[i - across] == plane.s[i + across] && plane.s[i] != plane.s[i - across];
                for (const std::size_t k :
                     {i - 2 * along, i - along, i, i + along, i + 2 * along, i - across, i + across})
                    is_line = is_line && points.triangle[k] < 2 && points.asks(light, k) &&
                              (k == i - across || k == i + across || plane.s[k] == plane.s[i]);
                found += is_line;
            }
    return found;
}

TEST(Seams, NoLinesOfOnePixel) {
    std::size_t pictures = 0, shadowed = 0;
    for (auto& [name, scene] : surfaces()) {
        scene.lights = lights();
        scene.width = 101, scene.height = 75;
        for (const vec3 eye : {vec3(3, 3, 3), vec3(0, 3, 3), vec3(4, 6, 4)}) {
            scene.camera.eye = eye, scene.camera.target = vec3(0), scene.camera.up = vec3(0, 1, 0);
            const PointBatch points = primary(scene);
            for (const MethodInfo* info : methods()) {
                MethodCase method(*info, scene);
                if (method.serves().how < How::to_rounding) continue;
                method.build();
                for (LightId light = 0; light < scene.lights.size(); ++light) {
                    method.aim(light);
                    const VisibilityPlane plane = method.visibility(points, light);
                    EXPECT_EQ(seams(plane, points, scene, light), 0u)
                        << info->name << " of " << name << ", light " << light << ", eye at " << eye.x << ' ' << eye.y;
                    ++pictures;
                    for (std::size_t i = 0; i < plane.size(); ++i) shadowed += points.asks(light, i) && plane.s[i] == 0;
                }
            }
        }
    }
    EXPECT_GT(pictures, 600u);
    EXPECT_GT(shadowed, 100 * pictures);
}

/// A pane that multiplies counts once where its triangles meet.
TEST(Seams, APaneCountsOnceInItsDiagonal) {
    Scene scene;
    add_floor(scene);
    Material& glass   = scene.materials.emplace_back();
    glass.opacity     = 0.25f;
    scene.transparent = TransparentOccluders::multiply;
    add_object(scene, "pane", {{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, {}, {{0, 2, 1}, {0, 3, 2}}, 1);
    scene.lights = lights();
    scene.width = 101, scene.height = 75;
    scene.camera.eye = {3, 3, 3}, scene.camera.target = vec3(0), scene.camera.up = vec3(0, 1, 0);
    const PointBatch points = primary(scene);
    std::size_t passed      = 0;
    for (const MethodInfo* info : methods()) {
        MethodCase method(*info, scene);
        if (method.serves().how < How::to_rounding || !method.method().multiplies()) continue;
        method.build();
        for (LightId light = 0; light < scene.lights.size(); ++light) {
            method.aim(light);
            const VisibilityPlane plane = method.visibility(points, light);
            EXPECT_EQ(seams(plane, points, scene, light), 0u) << info->name << ", light " << light;
            for (std::size_t i = 0; i < plane.size(); ++i) passed += points.asks(light, i) && plane.s[i] == 0.75f;
        }
    }
    EXPECT_GT(passed, 1000u);
}

/// The point of triangle 0 at these barycentrics, under light 0.
struct At {
    VisibilityPlane plane;
    std::vector<TriangleId> blockers;
};
At at(const Scene& scene, std::string_view choice, float u, float v) {
    MethodCase method(choice, scene);
    PointBatch points;
    points.eye = {0, 9, 1};
    points.resize(1);
    set_point(points, 0, scene, 0, u, v);
    face_lights(points, scene);
    method.prepare(0);
    At found{method.visibility(points, 0), {kNoTriangle}};
    method.blame(points, 0, found.blockers);
    return found;
}

constexpr const char* kExact[] = {"exact:hard_lights=segments", "exact:hard_lights=bins"};

Scene triangle_under(vec3 light) {
    Scene scene;
    scene.materials.emplace_back();
    add_object(scene, "receiver", {{0, 0, 0}, {4, 0, 0}, {0, 0, 4}}, {}, {{0, 2, 1}}, 0);
    scene.lights.emplace_back().position = light;
    return scene;
}

TEST(Seams, WhoBlocksAtOneIsNamed) {
    Scene scene = triangle_under({1, 4, 1});
    add_object(scene, "sheet", {{0, 2, 0}, {2, 2, 0}, {2, 2, 2}, {0, 2, 2}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    for (const char* choice : kExact) {
        const At found = at(scene, choice, 0.25f, 0.25f);  // (1, 0, 1), below the middle of the diagonal
        EXPECT_EQ(found.plane.s[0], 0);
        EXPECT_EQ(found.plane.answer[0], Answer::given);
        EXPECT_TRUE(found.blockers[0] == 1 || found.blockers[0] == 2) << found.blockers[0];
    }
    scene.lights[0].position = {0, 4, 2};  // along the sheet's border, at its corner
    for (const char* choice : kExact) {
        const At found = at(scene, choice, 0.5f, 0);  // (0, 0, 2)
        EXPECT_EQ(found.plane.s[0], 1);
        EXPECT_EQ(found.plane.answer[0], Answer::on_boundary);
        EXPECT_EQ(found.blockers[0], kNoTriangle);
    }
}

/// On the edge of its own triangle a point is hidden by the neighbour behind which the light is, as next to the edge.
TEST(Seams, InAHollowPointsAreAsNextToTheirEdge) {
    for (const bool behind : {false, true}) {
        Scene scene = triangle_under({behind ? -1.0f : 1.0f, 3, 1});
        add_object(scene, "wall", {{0, 0, 0}, {0, 4, 0}, {0, 0, 4}}, {}, {{0, 1, 2}}, 0);
        for (const char* choice : kExact) {
            const At found = at(scene, choice, 0.25f, 0);  // (0, 0, 1)
            EXPECT_EQ(found.plane.s[0], behind ? 0 : 1) << choice;
            EXPECT_EQ(found.plane.answer[0], Answer::on_boundary);
        }
    }
}

/// Below the border of one pane and the middle of another.
TEST(Seams, ABoundaryBetweenPanesTakesTheBrighterSide) {
    for (const float x : {0.0f, 1.0f}) {  // the pane that ends begins there, or is there
        Scene scene                            = triangle_under({1, 4, 1});
        scene.materials.emplace_back().opacity = 0.25f;
        scene.transparent                      = TransparentOccluders::multiply;
        add_object(scene, "wide", {{-9, 1, -9}, {-9, 1, 30}, {30, 1, -9}}, {}, {{0, 1, 2}}, 1);
        add_object(scene, "ends", {{1, 2, -9}, {1, 2, 9}, {x == 0 ? -9.0f : 9.0f, 2, 0}}, {}, {{0, 1, 2}}, 1);
        const At found = at(scene, "exact", 0.25f, 0.25f);
        EXPECT_EQ(found.plane.s[0], 0.75f);
        EXPECT_EQ(found.plane.answer[0], Answer::on_boundary);
    }
}

/// Faces that files repeat, in either winding, hide nothing of one another.
TEST(Seams, CopiesOfATriangleDoNotHideIt) {
    Scene scene = triangle_under({1.3f, 4.1f, 0.7f});
    for (vec3& p : scene.positions) p = vec3(0.36f * p.x + 0.1f, 0.48f * p.x + 0.3f * p.z, 0.8f * p.z + 0.37f);
    const std::vector<vec3> corners{scene.vertex(0, 0), scene.vertex(0, 1), scene.vertex(0, 2)};
    add_object(scene, "same", corners, {}, {{0, 1, 2}}, 0);
    add_object(scene, "turned", corners, {}, {{0, 2, 1}}, 0);
    std::size_t tried = 0;
    for (const MethodInfo* info : methods()) {
        if (MethodCase(*info, scene).serves().how < How::to_rounding) continue;
        for (float u = 0.02f; u < 0.45f; u += 0.068f)
            for (float v = 0.03f; v < 0.45f; v += 0.067f) {
                const At found = at(scene, info->name, u, v);
                if (found.plane.answer[0] == Answer::undefined) continue;
                EXPECT_EQ(found.plane.s[0], 1) << info->name << ' ' << u << ' ' << v;
                ++tried;
            }
    }
    EXPECT_GT(tried, 300u);
}

}  // namespace
}  // namespace umbra
