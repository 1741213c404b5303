// Alias-free shadows against `exact`, where bins, cube faces, filters and predicates matter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/shared/light_image.h"
#include "umbra/shadows/shared/point_bins.h"
#include "umbra/shadows/shared/shadow_planes.h"
#include "umbra/tests/support/adversarial_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

struct Compared {
    std::size_t lit = 0, umbra = 0, on_boundary = 0, different = 0;
};

/// Of all pixels that the light can reach: also what is said to lie on a boundary must be the same.
Compared against_exact(const Scene& scene) {
    const PointBatch points = primary(scene);
    Compared compared;
    MethodCase binned("alias_free", scene), exact("exact:hard_lights=segments", scene), either("exact", scene);
    EXPECT_EQ(verdict(*binned.method, binned.facts).how, How::exactly);
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        binned.prepare(light);
        exact.prepare(light), either.prepare(light);
        const VisibilityPlane found = binned.visibility(points, light), truth = exact.visibility(points, light),
                              chosen = either.visibility(points, light);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_open(points, light, i)) continue;
            ++(truth.s[i] > 0 ? compared.lit : compared.umbra);
            compared.on_boundary += truth.answer[i] == Answer::on_boundary ? 1 : 0;
            compared.different += found.s[i] != truth.s[i] || found.answer[i] != truth.answer[i] ||
                                  chosen.s[i] != truth.s[i] || chosen.answer[i] != truth.answer[i];
        }
    }
    return compared;
}

Scene seen_from(vec3 eye, vec3 target) {
    Scene scene;
    scene.materials.emplace_back();
    scene.camera.eye = eye, scene.camera.target = target;
    scene.width = 160, scene.height = 100;
    return scene;
}

Light lamp_at(vec3 position) {
    Light lamp;
    lamp.name = "lamp", lamp.position = position;
    return lamp;
}

Light sun_from(vec3 direction) {
    Light sun;
    sun.name = "sun", sun.kind = LightKind::directional, sun.direction = direction;
    return sun;
}

/// Triangles in all directions around a lamp in a room, large and small: each face of the cube has its own, and many
/// pass over its edges.
TEST(AliasFree, AgreesAroundALampInTheMiddle) {
    Scene scene = seen_from({3.1f, 2.7f, 3.4f}, {0, -0.2f, 0});
    std::mt19937 random(11);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> distance(0.3f, 2.5f), size(0.02f, 1.2f);
    for (int n = 0; n < 200; ++n) {
        const vec3 centre = glm::normalize(vec3(normal(random), normal(random), normal(random))) * distance(random);
        std::vector<vec3> corners;
        for (int k = 0; k < 3; ++k)
            corners.push_back(centre + size(random) * vec3(normal(random), normal(random), normal(random)));
        add_object(scene, "t" + std::to_string(n), corners, {}, {{0, 1, 2}}, 0);
    }
    const Mesh room = make_box({8, 8, 8});
    add_object(scene, "room", room.positions, {}, room.triangles, 0);
    scene.lights            = {lamp_at({0, 0, 0}), sun_from({0.3f, -1, 0.2f}), lamp_at({0.5f, 3.9f, -0.5f})};
    const Compared compared = against_exact(scene);
    EXPECT_EQ(compared.different, 0u);
    EXPECT_GT(compared.lit, 1000u);
    EXPECT_GT(compared.umbra, 5000u);
}

/// A lattice under a sun that shines along its cells: segments meet edges and corners exactly, which predicates alone
/// can tell.
TEST(AliasFree, AgreesWhereSegmentsMeetEdges) {
    Scene scene     = seen_from({0, 8, 0}, {0, 0, 0});
    scene.camera.up = {0, 0, -1}, scene.camera.projection = Projection::orthographic, scene.camera.height = 4;
    scene.width = scene.height = 64;
    add_object(scene, "floor", {{-4, 0, -4}, {4, 0, -4}, {4, 0, 4}, {-4, 0, 4}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    for (int x = -4; x < 4; ++x)  // every second square of half a unit, beside the camera's rays
        for (int z = -4; z < 4; ++z) {
            if ((x + z) % 2 != 0) continue;
            const vec3 a(0.5f * static_cast<float>(x), 9, 0.5f * static_cast<float>(z));
            add_object(scene, "square", {a, a + vec3(0.5f, 0, 0), a + vec3(0.5f, 0, 0.5f), a + vec3(0, 0, 0.5f)}, {},
                       {{0, 2, 1}, {0, 3, 2}}, 0);
        }
    scene.lights            = {sun_from({0, -1, 0})};
    const Compared straight = against_exact(scene);
    EXPECT_EQ(straight.different, 0u);
    EXPECT_GT(straight.umbra, 1000u);
    scene.camera.eye.x += 1.0f / 32, scene.camera.target.x += 1.0f / 32;  // pixel centres lie under edges
    const Compared shifted = against_exact(scene);
    EXPECT_EQ(shifted.different, 0u);
    EXPECT_GT(shifted.on_boundary, 100u);
}

/// What lies far away, near a point and at the horizon: where binned places crowd together and floats are worst.
TEST(AliasFree, AgreesFarFromTheOriginAndAtGrazingLight) {
    for (const vec3 shift : {vec3(0), vec3(20000, -30000, 10000)})
        for (const Light& light : {lamp_at(shift + vec3(0, 0.003f, 0)), lamp_at(shift + vec3(40, 0.5f, 3)),
                                   sun_from({1, -1e-4f, 0.3f}), lamp_at(shift + vec3(1e6f, 1e5f, 0))}) {
            Scene scene      = seen_from(shift + vec3(4, 3, 6), shift);
            const Mesh floor = make_plane(60, 60), ball = make_sphere(0.5f, 24, 12);
            const auto add = [&](const Mesh& mesh, vec3 at) {
                std::vector<vec3> moved = mesh.positions;
                for (vec3& p : moved) p += at;
                add_object(scene, "part", moved, mesh.normals, mesh.triangles, 0);
            };
            add(floor, shift);
            for (int k = 0; k < 6; ++k)
                add(ball, shift + vec3(static_cast<float>(k) - 2.5f, 0.4f, static_cast<float>(k % 3)));
            scene.lights            = {light};
            const Compared compared = against_exact(scene);
            EXPECT_EQ(compared.different, 0u);
            EXPECT_GT(compared.umbra, 100u);
        }
}

/// A block is inside or outside of a shadow where a point is by more than rounding, and unsure on its border.
TEST(ShadowPlanes, AreUnsureOnTheBorderAlone) {
    using namespace binned_shadows_detail;
    const std::array<dvec3, 3> corners{dvec3(0, 1, 0), dvec3(1, 1, 0), dvec3(0, 1, 1)};  // seen from below: clockwise
    const dvec3 down(0, -1, 0);
    // The winding's normal is (b - a) x (c - a) = (0, -1, 0): away from a light above.
    const ShadowPlanes planes(corners, {down, down, down}, 1, dvec3(1));
    Block block{};
    const vec3 points[kLanes] = {{0.25f, 0, 0.25f}, {0.25f, 2, 0.25f}, {-0.1f, 0, 0.5f},  {0.6f, 0, 0.6f},
                                 {0.5f, 0, 0.5f},   {0, 0.5f, 0.5f},   {0.25f, 1, 0.25f}, {0.3f, 0.999f, 0.3f}};
    for (std::size_t k = 0; k < kLanes; ++k)
        block.x[k] = points[k].x, block.y[k] = points[k].y, block.z[k] = points[k].z;
    const auto [inside, unsure] = planes.test(block);
    EXPECT_EQ(inside, 0b10000001);
    EXPECT_EQ(unsure, 0b01110000);
}

/// Directions to all sides have places, opposite ones on opposite faces; a point has none where rounding of positions
/// could move it to any side of the light.
TEST(LightImage, PlacesWhatRoundingCannotMoveAroundTheLight) {
    using namespace binned_shadows_detail;
    Light lamp;
    lamp.position = {1000, 0, 0};
    const LightImage image(lamp, dvec3(0), 1000);
    for (int k = 0; k < 3; ++k) {
        dvec3 along(0.1, 0.2, -0.3);
        along[k]         = 2;
        const auto there = image.place(dvec3(lamp.position) + along), back = image.place(dvec3(lamp.position) - along);
        ASSERT_TRUE(there && back);
        EXPECT_EQ(there->face, 2 * k);
        EXPECT_EQ(back->face, 2 * k + 1);
        EXPECT_DOUBLE_EQ(there->depth, 2);
        EXPECT_DOUBLE_EQ(back->depth, 2);
        EXPECT_FALSE(image.place(dvec3(lamp.position) + 5e-4 * along)) << "0.001 beside coordinates of 1000";
        EXPECT_TRUE(image.place(dvec3(lamp.position) + 5e-3 * along));
    }
}

/// Whatever an extent covers is visited, however points are spread.
TEST(PointBins, FindEveryPointOfAnExtent) {
    using namespace binned_shadows_detail;
    std::mt19937 random(3);
    std::exponential_distribution<double> crowded(8);  // most in a corner
    std::vector<PointBins::Entry> entries, places;
    std::vector<vec3> positions(100000);  // more than one chunk
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        double x = crowded(random), y = crowded(random);
        if (i % 2 == 0) x *= 1e-4, y *= 1e-4;  // half of them in one cell of the first grid
        if (i % 100 == 0) x = y = 0.5;         // and some in one place
        entries.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(x + y), i});
        positions[i] = vec3(x, y, 0);
    }
    places = entries;
    std::vector<PointBins::Entry> space(entries.size());
    const PointBins bins(entries, space, positions);
    for (int trial = 0; trial < 300; ++trial) {
        const double size = trial % 3 == 0 ? 1e-5 : 0.3;
        const dvec2 low   = trial % 2 == 0 ? dvec2(crowded(random), crowded(random)) * size : dvec2(0.4);
        const Extent extent(low, low + dvec2(crowded(random), crowded(random)) * size, crowded(random) * size);
        std::vector<bool> found(positions.size());
        bins.visit(extent, [&](std::size_t b) {
            for (const std::uint32_t i : bins.block(b).index) found[i] = true;
        });
        std::size_t wanted = 0;
        for (const PointBins::Entry& e : places) {
            if (e.u < extent.low_u || e.u > extent.high_u || e.v < extent.low_v || e.v > extent.high_v ||
                e.depth < extent.depth)
                continue;
            EXPECT_TRUE(found[e.index]);
            ++wanted;
        }
        // A cell holds at most 128 points, but for those in one place.
        const auto visited = static_cast<std::size_t>(std::ranges::count(found, true));
        if (trial % 2 == 0 && size < 1) {
            EXPECT_LT(visited, 3 * wanted + 2000) << trial;
        }
    }
}

/// Slivers, contacts, lights on edges, in corners and next to surfaces, far origins: what is said of a point,
/// boundaries included, is what its segment says. Counts what was compared.
Compared against_segments(std::uint64_t first_seed, std::uint64_t last_seed) {
    Compared compared;
    for (std::uint64_t seed = first_seed; seed <= last_seed; ++seed) {
        const AdversarialScene made = adversarial_scene(seed, LightsWanted::hard, 3, 60);
        MethodCase binned("alias_free", made.scene), exact("exact:hard_lights=segments", made.scene);
        for (LightId light = 0; light < made.scene.lights.size(); ++light) {
            binned.prepare(light), exact.prepare(light);
            const VisibilityPlane found = binned.visibility(made.points, light),
                                  truth = exact.visibility(made.points, light);
            for (std::size_t i = 0; i < made.points.size(); ++i) {
                if (made.points.triangle[i] == kNoTriangle || !made.points.asks(light, i)) continue;
                ++(truth.s[i] > 0 ? compared.lit : compared.umbra);
                compared.on_boundary += truth.answer[i] == Answer::on_boundary;
                if (found.s[i] == truth.s[i] && found.answer[i] == truth.answer[i]) continue;
                ++compared.different;
                ADD_FAILURE() << made.scene.name << " (" << made.pattern << "), light " << light << ", point " << i;
            }
        }
    }
    return compared;
}

TEST(AliasFree, AgreesWithSegmentsOnAdversarialScenes) {
    const Compared compared = against_segments(1, 60);
    EXPECT_EQ(compared.different, 0u);
    EXPECT_GT(compared.lit + compared.umbra, 3000u);
    EXPECT_GT(compared.umbra, 300u);
    EXPECT_GT(compared.on_boundary, 60u);
}

TEST(AliasFree, AgreesWithSegmentsOnThousandsOfScenes) {
    const Compared compared = against_segments(61, 3000);
    EXPECT_EQ(compared.different, 0u);
    EXPECT_GT(compared.lit + compared.umbra, 150000u);
    EXPECT_GT(compared.umbra, 15000u);
    EXPECT_GT(compared.on_boundary, 3000u);
}

}  // namespace
}  // namespace umbra
