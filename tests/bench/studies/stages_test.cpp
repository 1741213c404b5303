// One scene through all stages: what each adds, in pixels.
#include "umbra/bench/studies/shading/stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

/// Two squares across the view, one behind the other, 4 and 6 from the eye, which looks along -z.
Scene two_squares(Projection projection) {
    Scene scene;
    scene.materials.resize(1);
    scene.camera.eye = {0, 0, 4}, scene.camera.target = {0, 0, 0};
    scene.camera.projection = projection, scene.camera.height = 8, scene.camera.fov_y = 90;
    scene.width = scene.height = 80;
    const auto square          = [&](float half, float z) {
        add_object(scene, "square", {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}}, {},
                            {{0, 1, 2}, {0, 2, 3}}, 0);
    };
    square(2, 0), square(1, -2);
    return scene;
}

bool is_drawn(const Image& image, int x, int y) {
    return image.at(static_cast<std::size_t>(y * image.width + x), 0) < 0.9f;
}

/// Borders are drawn and diagonals, between two triangles of one plane, are not; hidden lines leave out what is behind.
TEST(Lines, AreEdgesAndHiddenWhereASurfaceIsInFront) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        const Scene scene = two_squares(projection);
        const RayScene rays(scene);
        const Image all  = draw_lines(rays, scene, 80, 80, Lines::all),
                    seen = draw_lines(rays, scene, 80, 80, Lines::seen);
        // Half sides in pixels, of 80 across 8 units at the distance of the first square.
        const double near = 20, far = projection == Projection::perspective ? 10 / 1.5 : 10;
        std::array<int, 2> near_pixels{}, far_pixels{}, others{};
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 80; ++x) {
                const double r = std::max(std::abs(x + 0.5 - 40), std::abs(y + 0.5 - 40));
                const int k[]{is_drawn(all, x, y), is_drawn(seen, x, y)};
                for (std::size_t i = 0; i < 2; ++i) {
                    auto& count = std::abs(r - near) <= 1 ? near_pixels : std::abs(r - far) <= 1 ? far_pixels : others;
                    count[i] += k[i];
                }
            }
        EXPECT_GT(near_pixels[0], 150);
        EXPECT_EQ(near_pixels[1], near_pixels[0]);
        EXPECT_GT(far_pixels[0], 45);
        EXPECT_EQ(far_pixels[1], 0);
        EXPECT_EQ(others[0] + others[1], 0) << "a diagonal, or a line in the wrong place";
    }
}

TEST(Lines, AreOfWhatTheCameraSees) {
    Scene scene = two_squares(Projection::perspective), far = scene;
    scene.objects[0].switches.seen_by_camera = false;
    far.triangles.erase(far.triangles.begin(), far.triangles.begin() + 2);
    far.triangle_object = {0, 0};
    far.objects.erase(far.objects.begin());
    far.objects[0].first_triangle = 0;
    for (const Lines lines : {Lines::all, Lines::seen})
        EXPECT_EQ(draw_lines(RayScene(scene), scene, 80, 80, lines).data,
                  draw_lines(RayScene(far), far, 80, 80, lines).data);
}

/// An edge that passes the eye is cut, and one behind it is not drawn.
TEST(Lines, BehindTheEyeAreNotDrawn) {
    Scene scene = two_squares(Projection::perspective);
    add_object(scene, "behind", {{-1, -1, 9}, {1, -1, 9}, {0, 1, 9}}, {}, {{0, 1, 2}}, 0);
    const RayScene rays(scene);
    const Image without = draw_lines(RayScene(two_squares(Projection::perspective)),
                                     two_squares(Projection::perspective), 80, 80, Lines::all);
    EXPECT_EQ(draw_lines(rays, scene, 80, 80, Lines::all).data, without.data);
    add_object(scene, "through", {{0.5f, 0, -20}, {0.5f, 0, 30}, {0.6f, 0, 30}}, {}, {{0, 1, 2}}, 0);
    const Image with = draw_lines(RayScene(scene), scene, 80, 80, Lines::all);
    int added        = 0;
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 80; ++x) added += is_drawn(with, x, y) && !is_drawn(without, x, y);
    EXPECT_GT(added, 20);
    EXPECT_LT(added, 120);
}

double difference(const Stage& a, const Stage& b) {
    double most = 0;
    for (std::size_t k = 0; k < a.picture.data.size(); ++k)
        most = std::max(most, double(std::abs(a.picture.data[k] - b.picture.data[k])));
    return most;
}

TEST(Stages, EachAddsWhatItSays) {
    Scene scene;
    scene.materials.resize(2);
    scene.materials[0].k_a = vec3(0.25f), scene.materials[0].k_s = vec3(0.5f), scene.materials[0].shininess = 40;
    scene.materials[1] = scene.materials[0];
    const Mesh ball    = make_sphere(1, 16, 8);
    add_object(scene, "floor", {{-4, -1, -4}, {4, -1, -4}, {4, -1, 4}, {-4, -1, 4}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    add_object(scene, "ball", ball.positions, ball.normals, ball.triangles, 1);
    Light sun;
    sun.kind         = LightKind::directional;
    sun.direction    = {1, -1, -0.5f};
    scene.lights     = {sun};
    scene.camera.eye = {0, 3, 6};
    scene.width = 64, scene.height = 48;
    const auto draw = [](const Scene& of) {
        const PreparedScene prepared = prepare_scene(of, "memory", {});
        return draw_stages(prepared, [](const PointBatch& points) {
            return std::vector<VisibilityPlane>(1, [&] {
                VisibilityPlane dark(points.size());
                std::ranges::fill(dark.s, 0.0f);
                return dark;
            }());
        });
    };
    const std::vector<Stage> stages = draw(scene);
    ASSERT_EQ(stages.size(), 9u);
    const std::array<std::string_view, 9> names{"wireframe", "hidden_lines", "ambient", "flat",   "gouraud_diffuse",
                                                "gouraud",   "phong",        "shadows", "whitted"};
    for (std::size_t k = 0; k < 9; ++k) {
        EXPECT_EQ(stages[k].name, names[k]);
        EXPECT_EQ(stages[k].picture.width, 64);
        if (k > 0 && k < 8) {
            EXPECT_GT(difference(stages[k], stages[k - 1]), 0.02) << names[k];
        }
    }
    // In the umbra of a method that says 0 everywhere, the ambient term is left. Without mirrors, rays add nothing.
    EXPECT_EQ(difference(stages[7], stages[2]), 0);
    EXPECT_EQ(difference(stages[8], stages[7]), 0);
    std::set<float> values(stages[2].picture.data.begin(), stages[2].picture.data.end());
    EXPECT_EQ(values.size(), 2u) << "the ambient term is one value, and the background another";
    scene.materials[1].reflect        = 0.5f;
    const std::vector<Stage> mirrored = draw(scene);
    EXPECT_GT(difference(mirrored[8], mirrored[7]), 0.02);
    EXPECT_EQ(difference(mirrored[7], stages[7]), 0);
}

}  // namespace
}  // namespace umbra
