// Alias-free shadows against `exact`, where bins, cube faces, filters and predicates matter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/bins/light_image.h"
#include "umbra/shadows/bins/point_bins.h"
#include "umbra/shadows/bins/shadow_planes.h"
#include "umbra/shadows/geometry/triangle_tree.h"
#include "umbra/tests/support/adversarial_scenes.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

struct Compared {
    std::size_t lit = 0, umbra = 0, on_boundary = 0, different = 0;
};

/// Of all points that the light can reach: also what is said to lie on a boundary must be the same.
Compared against_exact(const Scene& scene, const PointBatch& points) {
    Compared compared;
    MethodCase binned("alias_free", scene), exact("exact:hard_lights=segments", scene), either("exact", scene);
    EXPECT_EQ(binned.verdict().how, How::exactly);
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

Compared against_exact(const Scene& scene) { return against_exact(scene, primary(scene)); }

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

/// A corner of the seen triangle lies so far away that a double has no digits left for where on it a point is.
TEST(AliasFree, AgreesWhereTheirOwnCornersAreFarAway) {
    Scene empty     = seen_from({0.1f, 40, 0}, {0.1f, 0, 0});
    empty.camera.up = {1, 0, 0}, empty.camera.projection = Projection::orthographic, empty.camera.height = 0.4f;
    empty.width = 120, empty.height = 3;
    for (const int power : {20, 40, 48, 52, 55, 58}) {
        std::mt19937 random(static_cast<unsigned>(power));
        const auto between = [&](float low, float high) {
            return std::uniform_real_distribution<float>(low, high)(random);
        };
        const auto third = [&](float most) { return std::round(3 * between(-most, most)) / 3; };
        Scene scene      = empty;
        add_object(scene, "seen",
                   {{-1.3f * std::ldexp(1.0f, power), 0, 1.0f / 3}, {0.3f, 0.1f, -7.7f}, {0.4f, -0.1f, 8.3f}}, {},
                   {{0, 1, 2}}, 0);
        // So that the middle of the scene is near: blocks are placed from there.
        add_object(scene, "other side", {{1.3f * std::ldexp(1.0f, power), -9, 0}, {0.3f, -9, -8}, {0.4f, -9, 8}}, {},
                   {{0, 1, 2}}, 0);
        for (int n = 0; n < 10; ++n) {
            const vec3 middle(third(1), between(0.5f, 2.5f), between(-5, 5));
            std::vector<vec3> corners;
            for (int k = 0; k < 4; ++k)
                corners.push_back(middle + vec3(between(-1.5f, 1.5f), between(-1.5f, 1.5f), between(-1.5f, 1.5f)));
            add_object(scene, "quad", corners, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
        }
        for (int n = 0; n < 8; ++n) {
            scene.lights.push_back(lamp_at({third(2), std::round(between(3, 9)), third(4)}));
            scene.lights.push_back(sun_from({third(1), -1, third(1)}));
        }
        const Compared compared = against_exact(scene);
        EXPECT_EQ(compared.different, 0u) << power;
        EXPECT_GT(compared.umbra, 100u) << power;
        PointBatch across;  // the side that is near, where no point of the batch is far away
        across.eye = scene.camera.eye;
        across.resize(257);
        for (std::size_t i = 0; i < across.size(); ++i) {
            const float u = static_cast<float>(i) / 256;
            set_point(across, i, scene, 0, u, 1 - u);
        }
        face_lights(across, scene);
        EXPECT_EQ(against_exact(scene, across).different, 0u) << power;
    }
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
    using namespace bins;
    const std::array<dvec3, 3> corners{dvec3(0, 1, 0), dvec3(1, 1, 0), dvec3(0, 1, 1)};  // seen from below: clockwise
    const dvec3 down(0, -1, 0);
    // The winding's normal is (b - a) x (c - a) = (0, -1, 0): away from a light above. The last triangle holds the
    // light in its plane, the others are the first.
    LightImage::Corners eight, travel;
    double turn[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) {
        turn[k] = k == 7 ? 0 : 1;
        for (std::size_t c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis) {
                eight[c][axis][k]  = k == 7 ? corners[c][(axis + 1) % 3] : corners[c][axis];
                travel[c][axis][k] = down[axis];
            }
    }
    const ShadowPlanes planes(eight, travel, turn, dvec3(1));
    Block block{};
    const vec3 points[kLanes] = {{0.25f, 0, 0.25f}, {0.25f, 2, 0.25f}, {-0.1f, 0, 0.5f},  {0.6f, 0, 0.6f},
                                 {0.5f, 0, 0.5f},   {0, 0.5f, 0.5f},   {0.25f, 1, 0.25f}, {0.3f, 0.999f, 0.3f}};
    for (std::size_t k = 0; k < kLanes; ++k)
        block.x[k] = points[k].x, block.y[k] = points[k].y, block.z[k] = points[k].z;
    ShadowPlanes::InShadow lanes[kLanes]{};
    EXPECT_EQ(planes.test(0b11000001, block, lanes), 0b01000001u) << "of the last, whose plane is x = 1, no lane";
    for (const std::size_t triangle : {0u, 6u}) {
        EXPECT_EQ(lanes[triangle].inside, 0b10000001);
        EXPECT_EQ(lanes[triangle].unsure, 0b01110000);
    }
    EXPECT_EQ(lanes[7].inside | lanes[7].unsure, 0);
    EXPECT_EQ(lanes[1].inside | lanes[1].unsure, 0) << "was not asked";
}

/// Eight points in a row from a position, each its own triangle's first corner.
bins::LightImage::Places places_of(const bins::LightImage& image, dvec3 from, dvec3 step) {
    using namespace bins;
    LightImage::Corners corners;
    const float zero[kLanes]{};
    for (std::size_t k = 0; k < kLanes; ++k)
        for (int c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis)
                corners[c][axis][k] = from[axis] + static_cast<double>(k) * step[axis] + (c == axis ? 0.5 * c : 0.0);
    LightImage::Places places;
    image.places(corners, zero, zero, places);
    return places;
}

/// Directions to all sides have places, opposite ones on opposite faces; a point has none where rounding of positions
/// could move it to any side of the light.
TEST(LightImage, PlacesWhatRoundingCannotMoveAroundTheLight) {
    using namespace bins;
    Light lamp;
    lamp.position = {1000, 0, 0};
    const LightImage image(lamp, dvec3(0), 1000);
    for (int k = 0; k < 3; ++k)
        for (const double sign : {1.0, -1.0}) {
            dvec3 along(0.1, 0.2, -0.3);
            along[k]         = 2;
            const auto there = places_of(image, dvec3(lamp.position) + sign * along, sign * along);
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const double times = static_cast<double>(lane) + 1;
                EXPECT_EQ(there.face[lane], 2 * k + (sign < 0 ? 1 : 0));
                EXPECT_NEAR(there.depth[lane], 2 * times, 1e-5);
                EXPECT_NEAR(there.u[lane], 4.0 * there.face[lane] + sign * along[(k + 1) % 3] / 2, 1e-5);
                EXPECT_NEAR(there.v[lane], sign * along[(k + 2) % 3] / 2, 1e-6);
                EXPECT_DOUBLE_EQ(there.y[lane], sign * along.y * times);
            }
            const auto near = places_of(image, dvec3(lamp.position) + 5e-4 * sign * along, dvec3(0)),
                       far  = places_of(image, dvec3(lamp.position) + 5e-3 * sign * along, dvec3(0));
            EXPECT_EQ(near.face[0], -1) << "0.001 beside coordinates of 1000";
            EXPECT_EQ(far.face[0], there.face[0]);
        }
}

/// The extents of eight triangles hold what the triangles do, and no face has anything of those that say to lie in
/// another; those that pass over a border are left to extent().
TEST(LightImage, ExtentsOfEightHoldTheirTriangles) {
    using namespace bins;
    std::mt19937 random(17);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto anywhere = [&] { return dvec3(uniform(random), uniform(random), uniform(random)); };
    Light lamp          = lamp_at({0.1f, -0.2f, 0.05f});
    std::size_t within = 0, over_a_border = 0;
    for (const Light& light : {lamp, sun_from({0.3f, -1, 0.2f})})
        for (int trial = 0; trial < 500; ++trial) {
            const LightImage image(light, dvec3(0), 10);
            LightImage::Corners corners;
            std::array<std::array<dvec3, 3>, kLanes> triangles;
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const dvec3 middle = 5.0 * anywhere();
                for (int c = 0; c < 3; ++c) {
                    const auto k       = static_cast<std::size_t>(c);
                    triangles[lane][k] = dvec3(vec3(middle + 0.8 * anywhere()));
                    for (int axis = 0; axis < 3; ++axis) corners[c][axis][lane] = triangles[lane][k][axis];
                }
            }
            Extents extents;
            const unsigned ones = image.extents(corners, extents);
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                if ((ones >> lane & 1u) == 0) {
                    EXPECT_TRUE(extents.empty(lane));
                    ++over_a_border;
                    continue;
                }
                ++within;
                int faces = 0;
                for (int face = 0; face < 6 && image.faces() == 6; ++face)
                    if (const auto alone = image.extent(face, triangles[lane])) {
                        ++faces;
                        EXPECT_NEAR(alone->low_u, extents.low_u[lane], 1e-5);
                        EXPECT_NEAR(alone->high_u, extents.high_u[lane], 1e-5);
                        EXPECT_NEAR(alone->low_v, extents.low_v[lane], 1e-5);
                        EXPECT_NEAR(alone->high_v, extents.high_v[lane], 1e-5);
                        EXPECT_NEAR(alone->depth, extents.depth[lane], 1e-5);
                    }
                EXPECT_TRUE(image.faces() == 1 || faces == 1);
                for (int point = 0; point < 8; ++point) {
                    dvec3 weights = glm::abs(anywhere());
                    weights /= weights.x + weights.y + weights.z;
                    const auto at = places_of(image,
                                              weights.x * triangles[lane][0] + weights.y * triangles[lane][1] +
                                                  weights.z * triangles[lane][2],
                                              dvec3(0));
                    EXPECT_TRUE(at.u[0] >= extents.low_u[lane] && at.u[0] <= extents.high_u[lane]);
                    EXPECT_TRUE(at.v[0] >= extents.low_v[lane] && at.v[0] <= extents.high_v[lane]);
                    EXPECT_TRUE(at.depth[0] >= extents.depth[lane]);
                }
            }
        }
    EXPECT_GT(within, 5000u);
    EXPECT_GT(over_a_border, 300u);
}

/// Calls visit(b) for what is found behind one triangle.
template <class Visit>
void visit(const bins::PointBins& bins, const bins::Extent& extent, const Visit& visit) {
    using namespace bins;
    Extents triangles;
    for (std::size_t lane = 0; lane < kLanes; ++lane) triangles.clear(lane);
    triangles.set(3, extent);
    std::vector<PointBins::Found> found;
    bins.find(triangles, 1u << 3, found);
    for (const PointBins::Found& f : found) {
        EXPECT_EQ(f.triangles, 1u << 3);
        visit(f.block);
    }
}

/// Calls visit(b) for every block.
template <class Visit>
void each_block(const bins::PointBins& bins, const Visit& visit) {
    std::size_t blocks = 0;
    for (std::size_t tile = 0; tile < bins.tiles(); ++tile)
        for (std::size_t b = bins.first(tile); b < bins.last(tile); ++b, ++blocks) visit(b);
    EXPECT_EQ(blocks, bins.blocks());
}

/// Whatever an extent covers is visited, however points are spread; what it does not, mostly not.
TEST(PointBins, FindEveryPointOfAnExtent) {
    using namespace bins;
    std::mt19937 random(3);
    std::exponential_distribution<double> crowded(8);  // most in a corner
    std::vector<PointBins::Entry> places;
    for (std::uint32_t i = 0; i < 100000; ++i) {
        double x = crowded(random), y = crowded(random);
        if (i % 2 == 0) x *= 1e-4, y *= 1e-4;                // half of them in a far corner of it
        if (i % 100 == 0) x = y = 0.5;                       // and some in one place
        const auto face = static_cast<std::int32_t>(i % 3);  // beside one another
        places.push_back({.x        = static_cast<float>(x),
                          .y        = static_cast<float>(y),
                          .z        = 0,
                          .u        = static_cast<float>(x) + 4.0f * static_cast<float>(face),
                          .v        = static_cast<float>(y),
                          .depth    = static_cast<float>(x + y),
                          .index    = i,
                          .triangle = 7 * i,
                          .face     = face});
    }
    PointBins::Box all;
    for (const PointBins::Entry& e : places) all.add(e.u, e.u, e.v, e.v, e.depth);
    const CurveOver curve(all);
    std::ranges::sort(places, {}, [&](const PointBins::Entry& e) { return curve.at(e.u, e.v); });
    for (std::uint32_t i = 0; i < places.size(); ++i) places[i].index = i;
    const std::size_t tiles = (places.size() + PointBins::kTile - 1) / PointBins::kTile + 1;  // the last one is empty
    const PointBins bins(tiles, [&](std::size_t tile, PointBins::Tile& to) {
        const std::size_t first = std::min(places.size(), tile * PointBins::kTile),
                          last  = std::min(places.size(), first + PointBins::kTile);
        for (std::size_t k = first; k < last; ++k) to.add(places[k]);
    });
    std::vector<int> binned(places.size());
    each_block(bins, [&](std::size_t b) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const Block& block          = bins.block(b);
            const PointBins::Entry& own = places[block.index[lane]];
            binned[block.index[lane]] += lane == 0 || block.index[lane] != block.index[lane - 1] ? 1 : 0;
            EXPECT_TRUE(block.x[lane] == own.x && block.y[lane] == own.y && block.triangle[lane] == own.triangle);
            EXPECT_EQ(own.face, places[block.index[0]].face);
        }
    });
    EXPECT_EQ(std::ranges::count(binned, 1), 100000) << "each once";
    EXPECT_LT(bins.blocks(), 100000u / kLanes + 64 * tiles);
    for (int trial = 0; trial < 300; ++trial) {
        const double size = trial % 3 == 0 ? 1e-5 : 0.3;
        const dvec2 low =
            dvec2(trial % 3 * 4, 0) + (trial % 2 == 0 ? dvec2(crowded(random), crowded(random)) * size : dvec2(0.4));
        const Extent extent(low, low + dvec2(crowded(random), crowded(random)) * size, crowded(random) * size);
        std::vector<bool> found(places.size());
        visit(bins, extent, [&](std::size_t b) {
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
        const auto visited = static_cast<std::size_t>(std::ranges::count(found, true));
        if (trial % 2 == 0 && size < 1) {
            EXPECT_LT(visited, 3 * wanted + 2000) << trial;
        }
    }
    EXPECT_LT(bins.overlap(), 1.5);
}

/// Pixels next to one another need not be sorted; where each of them is somewhere else, points are, and the answers are
/// the same.
TEST(PointBins, SortsWhatTilesHaveStrewnAbout) {
    using namespace bins;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-1, 1);
    Scene confetti = seen_from({0, 0, 9}, {0, 0, 0});
    confetti.width = 640, confetti.height = 512;
    std::vector<vec3> corners;
    std::vector<uvec3> triangles;
    for (std::uint32_t k = 0; k < 20000; ++k) {
        const vec3 middle(4 * uniform(random), 3 * uniform(random), 4 * uniform(random));
        for (int c = 0; c < 3; ++c)
            corners.push_back(middle + 0.04f * vec3(uniform(random), uniform(random), uniform(random)));
        triangles.emplace_back(3 * k, 3 * k + 1, 3 * k + 2);
    }
    add_object(confetti, "confetti", corners, {}, triangles, 0);
    confetti.lights   = {lamp_at({12, 1, 0.5f})};
    const auto binned = [](const Scene& scene) {
        return bin_points(scene, primary(scene), 0, LightImage(scene.lights[0], dvec3(0), 20), dvec3(0));
    };
    EXPECT_TRUE(binned(confetti).sorted);
    EXPECT_LT(binned(confetti).bins.overlap(), 3);
    Scene floor = seen_from({0, 3, 3}, {0, 0, 0});
    floor.width = 640, floor.height = 512, floor.lights = confetti.lights;
    const Mesh plane = make_plane(30, 30);
    add_object(floor, "floor", plane.positions, plane.normals, plane.triangles, 0);
    EXPECT_FALSE(binned(floor).sorted);
    EXPECT_LT(binned(floor).bins.overlap(), 3);
    const Compared compared = against_exact(confetti);
    EXPECT_EQ(compared.different, 0u);
    EXPECT_GT(compared.umbra, 1000u);
    EXPECT_GT(compared.lit, 1000u);
}

/// A ball of 4000 triangles; `strewn`: in an order in which none is next to the one before.
Scene ball_of_triangles(bool strewn, bool inside_out) {
    Scene scene = seen_from({3, 3, 4}, {0, 0, 0});
    Mesh ball   = make_sphere(1, 64, 33);
    std::mt19937 random(7);
    if (strewn) std::ranges::shuffle(ball.triangles, random);
    if (inside_out)
        for (uvec3& t : ball.triangles) std::swap(t.y, t.z);
    add_object(scene, "ball", ball.positions, {}, ball.triangles, 0);
    const Mesh plane        = make_plane(8, 8);
    std::vector<vec3> below = plane.positions;
    for (vec3& p : below) p.y -= 1;
    add_object(scene, "floor", below, {}, plane.triangles, 0);
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {-0.4f, -1, 0.1f}, sun.name = "sun";
    scene.lights = {lamp_at({2, 3, 1}), sun};
    return scene;
}

TEST(CoherentOrder, HasEachTriangleThatCastsNextToTheOneBefore) {
    using namespace bins;
    for (const bool strewn : {false, true}) {
        const Scene scene = ball_of_triangles(strewn, false);
        std::vector<std::uint8_t> casts(scene.triangles.size(), 1);
        casts[5] = casts[700]               = 0;
        const std::vector<TriangleId> order = coherent_order(scene, casts);
        ASSERT_EQ(order.size(), casts.size() - 2);
        EXPECT_EQ(std::ranges::is_sorted(order), !strewn);
        std::vector<int> times(casts.size());
        double step = 0;
        for (std::size_t k = 0; k < order.size(); ++k) {
            ++times[order[k]];
            if (k > 0) step += glm::distance(scene.vertex(order[k], 0), scene.vertex(order[k - 1], 0));
        }
        for (std::size_t t = 0; t < times.size(); ++t) EXPECT_EQ(times[t], casts[t]) << t;
        EXPECT_LT(step / static_cast<double>(order.size()), 0.15) << "a triangle's side is 0.1, the ball is 2 wide";
    }
}

/// Triangles that face the light go first, wherever their windings point; what they hide is not looked at again.
TEST(AliasFree, IsExactInAnyOrderOfTrianglesAndWithAnyWinding) {
    for (const bool strewn : {false, true})
        for (const bool inside_out : {false, true}) {
            const Compared compared = against_exact(ball_of_triangles(strewn, inside_out));
            EXPECT_EQ(compared.different, 0u) << strewn << inside_out;
            EXPECT_GT(compared.umbra, 500u);
            EXPECT_GT(compared.lit, 500u);
        }
}

/// The signs of eight windings; none where the light lies in the triangle's plane, or rounding could have put it there.
TEST(LightImage, KnowsWindingsThatRoundingDoesNotHide) {
    using namespace bins;
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {-0.3f, -1, 0.7f};
    for (const Light& light : {lamp_at({0.1f, 5, 0.7f}), sun}) {
        const LightImage image(light, dvec3(0), 10);
        LightImage::Corners corners{};
        const bool at_once = light.kind == LightKind::directional;
        for (std::size_t k = 0; k < kLanes; ++k) {
            // Lanes 0 to 3: a floor's, seen from above anticlockwise or clockwise; 4 to 7: planes that hold the light.
            const dvec3 to_light = at_once ? -dvec3(light.direction) : dvec3(light.position);
            dvec3 of[3]{{0, 0, 0}, {0, 0, 0.1 * static_cast<double>(k + 1)}, {0.3, 0, 0}};
            if (k >= 4) of[1] = to_light * 0.7, of[2] = {0.1 * static_cast<double>(k), 0.2, -0.3};
            if (k % 2 == 1) std::swap(of[1], of[2]);
            for (std::size_t c = 0; c < 3; ++c)
                for (int axis = 0; axis < 3; ++axis) corners[c][axis][k] = of[c][axis];
        }
        const LightImage::Windings windings = image.windings(corners);
        EXPECT_EQ(windings.towards, 0b0101u);
        EXPECT_EQ(windings.away, 0b1010u);
    }
}

/// 64 x 64 points, the first at (from, 0), row by row.
void add_square(float from, bins::PointBins::Tile& to) {
    for (std::uint32_t i = 0; i < bins::PointBins::kTile; ++i) {
        const auto x = static_cast<float>(i % 64) + from, y = std::floor(static_cast<float>(i) / 64);
        to.add({.x = x, .y = y, .z = 0, .u = x, .v = y, .depth = 1, .index = i, .triangle = i, .face = 0});
    }
}

/// Eight triangles that look for points together, wherever they are and wherever their search begins, find what each
/// of them finds alone, and each block once for each triangle.
TEST(PointBins, FindForEightTrianglesWhatEachFinds) {
    using namespace bins;
    constexpr std::size_t across = 8;  // tiles: so many that searches need not begin at the root
    const PointBins bins(across,
                         [](std::size_t t, PointBins::Tile& to) { add_square(static_cast<float>(64 * t), to); });
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::size_t together = 0, alone = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const float spread = trial % 3 == 0 ? 400.0f : trial % 3 == 1 ? 40.0f : 2.0f;  // near one another, or not
        const vec2 place(uniform(random) * 450, uniform(random) * 60);
        Extents triangles;
        const unsigned which = trial % 5 == 0 ? 0b10010110u : 0xffu;
        Extent around        = Extent::nothing();
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const vec2 low = place + spread * vec2(uniform(random), uniform(random) / 8);
            const Extent e(dvec2(low), dvec2(low + 3.0f * vec2(uniform(random), uniform(random))),
                           lane == 4 ? 2.0 : 0.5);  // one of them is behind all points
            triangles.set(lane, e);
            if ((which >> lane & 1u) != 0) around.add(e);
        }
        const auto sorted = [&](std::vector<PointBins::Found> found) {
            std::vector<std::pair<std::uint32_t, unsigned>> pairs;
            for (const PointBins::Found& f : found)
                for (unsigned rest = f.triangles; rest != 0; rest &= rest - 1)
                    pairs.emplace_back(f.block, static_cast<unsigned>(std::countr_zero(rest)));
            std::ranges::sort(pairs);
            return pairs;
        };
        std::vector<PointBins::Found> each, from_root, from_start;
        for (unsigned rest = which; rest != 0; rest &= rest - 1) bins.find(triangles, rest & -rest, each);
        bins.find(triangles, which, from_root);
        PointBins::Start start;
        bins.start(around, start);
        bins.find(triangles, which, start, from_start);
        EXPECT_EQ(sorted(from_root), sorted(each));
        EXPECT_EQ(sorted(from_start), sorted(each));
        for (const PointBins::Found& f : each) EXPECT_EQ(f.triangles & 1u << 4, 0u);
        together += from_root.size(), alone += each.size();
    }
    EXPECT_GT(alone, 2000u);
    EXPECT_LT(together, alone - 100) << "blocks that several triangles find come once";
}

/// Blocks whose points are all crossed are found no more, others are, though seven of their points are crossed.
TEST(PointBins, DropWhatIsHidden) {
    using namespace bins;
    PointBins bins(2, [](std::size_t tile, PointBins::Tile& to) { add_square(static_cast<float>(64 * tile), to); });
    std::vector<std::uint8_t> expected(bins.last(1));
    each_block(bins, [&](std::size_t b) {
        expected[b]           = b % 3 == 0 || b > 1000 ? 0 : 1;
        bins.marks(b).crossed = expected[b] == 0 ? 0xff : 0x7f;
    });
    bins.drop_hidden();
    std::vector<std::uint8_t> found(bins.last(1));
    Extent all;
    all.low_u = all.low_v = -1, all.high_u = all.high_v = 200;
    visit(bins, all, [&](std::size_t b) { found[b] = 1; });
    EXPECT_EQ(found, expected);
    // Where all is hidden, nothing is found.
    each_block(bins, [&](std::size_t b) { bins.marks(b).crossed = 0xff; });
    bins.drop_hidden();
    visit(bins, all, [&](std::size_t b) { ADD_FAILURE() << b; });
}

/// Whatever the order in which a tile gives its points, those of a block are next to one another.
TEST(PointBins, HaveSmallBlocksInAnyOrderOfPoints) {
    using namespace bins;
    for (const bool strewn : {false, true}) {
        std::vector<std::uint32_t> order(PointBins::kTile);
        for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = k;
        std::mt19937 random(3);
        if (strewn) std::ranges::shuffle(order, random);
        const PointBins bins(1, [&](std::size_t, PointBins::Tile& to) {
            for (const std::uint32_t k : order) {
                std::uint32_t x = 0, y = 0;
                for (unsigned bit = 0; bit < 6; ++bit)
                    x |= (k >> 2 * bit & 1u) << bit, y |= (k >> (2 * bit + 1) & 1u) << bit;
                const auto u = static_cast<float>(x), v = static_cast<float>(y);
                to.add({.x = u, .y = v, .z = 0, .u = u, .v = v, .depth = 1, .index = k, .triangle = k, .face = 0});
            }
        });
        Extent all;
        all.low_u = all.low_v = -1, all.high_u = all.high_v = 100;
        double sum = 0;
        visit(bins, all, [&](std::size_t b) {
            const auto [low_x, high_x] = std::ranges::minmax(bins.block(b).x);
            const auto [low_y, high_y] = std::ranges::minmax(bins.block(b).y);
            sum += static_cast<double>(high_x - low_x + (high_y - low_y));
        });
        EXPECT_LT(sum / static_cast<double>(bins.blocks()), 5) << "4 x 2 points: half of the perimeter is 4";
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
