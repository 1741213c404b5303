// What shafts know of rays is what the rays would have said: by hand where it is clear, and by tracing all rays
// everywhere else, bit for bit.
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include <fmt/format.h>

#include "umbra/core/base/geometry.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/shadows/light_rays/light_shafts.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

using namespace rays;

constexpr LightKind kAreaKinds[] = {LightKind::rectangle, LightKind::disk, LightKind::sphere};

Light area_light(LightKind kind, vec3 position, float size = 1) {
    Light light;
    light.name      = "light";
    light.kind      = kind;
    light.position  = position;
    light.direction = {0, -1, 0};
    light.edge_u    = {size, 0, 0};
    light.edge_v    = {0, 0, -size};
    light.radius    = 0.5f * size;
    return light;
}

void add(Scene& scene, const std::vector<vec3>& positions, const std::vector<uvec3>& triangles) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    add_object(scene, "object", positions, {}, triangles, 0);
}

void add_sheet(Scene& scene, float half, float y, vec3 by = vec3(0)) {
    add(scene,
        {by + vec3(-half, y, half), by + vec3(half, y, half), by + vec3(half, y, -half), by + vec3(-half, y, -half)},
        {{0, 1, 2}, {0, 2, 3}});
}

/// 16 x 8 points of the first sheet, half a unit wide, around (x, z).
PointBatch tile_at(const Scene& scene, double half, double x, double z) {
    PointBatch points;
    points.eye = {0, 1e3f, 0};
    points.resize(PointTile::kPoints);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t row = i / 16;
        const double px = x + 0.5 * ((double(i % 16) + 0.5) / 16 - 0.5), pz = z + 0.5 * ((double(row) + 0.5) / 8 - 0.5);
        const double s = (px + half) / (2 * half), t = (half - pz) / (2 * half);  // along the sheet's edges
        if (s > t)
            set_point(points, i, scene, 0, float(s - t), float(t));
        else
            set_point(points, i, scene, 1, float(s), float(t - s));
    }
    face_lights(points, scene);
    return points;
}

/// How many of the tile's runs are lit, in umbra, not known.
struct Count {
    std::size_t lit = 0, umbra = 0, nothing = 0;
    bool operator==(const Count&) const = default;
};
void PrintTo(const Count& c, std::ostream* out) { *out << c.lit << " lit, " << c.umbra << " umbra, " << c.nothing; }

Count ask(const Scene& scene, const PointBatch& points) {
    constexpr LightId light = 0;
    const RayScene rays(scene, Met::blocking);
    const StartPlaces places(scene, rays.space(), OffsetPolicy::skip_triangle, 0);
    const ShaftTree tree(scene, rays.space());
    const LightShafts shafts(scene, rays.space(), tree, make_target(scene.lights[light], rays.space()));
    const PointTile tile{0, 0, PointTile::kWidth, PointTile::kHeight, points.size()};
    TileStarts starts;
    std::size_t run = 0;
    tile.for_each_run([&](std::size_t first, std::size_t count) { places.load(points, first, count, starts[run++]); });
    Count found;
    for (const Known known : shafts.known(points, light, tile, starts))
        ++(known == Known::lit ? found.lit : known == Known::umbra ? found.umbra : found.nothing);
    return found;
}

constexpr Count kLit{16, 0, 0}, kUmbra{0, 16, 0}, kNothing{0, 0, 16};

/// A floor, a light of size 1 at height 4, and a sheet 1 wide at height 2: above the middle of the floor it hides all
/// of the light from |x|, |z| < 0.5, and some of it to 1.5.
Scene sheet_scene(LightKind kind, float half = 0.5f) {
    Scene scene;
    add_sheet(scene, 8, 0);
    add(scene, {{-half, 2, half}, {3 * half, 2, half}, {-half, 2, -3 * half}}, {{0, 1, 2}});
    scene.lights = {area_light(kind, {0, 4, 0}, 0.5f)};
    return scene;
}

TEST(LightShafts, KnowWhatOneTriangleHides) {
    for (const LightKind kind : kAreaKinds) {
        SCOPED_TRACE(to_string(kind));
        const Scene scene = sheet_scene(kind, 1.5f);
        EXPECT_EQ(ask(scene, tile_at(scene, 8, 0, 0)), kUmbra);
        EXPECT_EQ(ask(scene, tile_at(scene, 8, -6, 5)), kLit);
        EXPECT_EQ(ask(scene, tile_at(scene, 8, -3, 0)), kNothing);  // 1.5 at half height: the middle of the penumbra
        // Where the penumbra ends, at x = -3.25, and a bit farther out for the box around a sphere.
        EXPECT_EQ(ask(scene, tile_at(scene, 8, kind == LightKind::sphere ? -3.6 : -3.3, 0)), (Count{8, 0, 8}));
        EXPECT_EQ(ask(scene, tile_at(scene, 8, -3.9, 0)), kLit);
    }
}

TEST(LightShafts, KnowNothingUnderTwoTrianglesThatHideTheLightTogether) {
    Scene scene;
    add_sheet(scene, 8, 0);
    add_sheet(scene, 1.5f, 2);
    scene.lights            = {area_light(LightKind::rectangle, {0, 4, 0}, 0.5f)};
    const PointBatch points = tile_at(scene, 8, 0, 0);
    EXPECT_EQ(ask(scene, points), kNothing);
    MethodCase rays("ray_traced", scene);
    rays.prepare(0);
    for (const float s : rays.visibility(points, 0).s) EXPECT_EQ(s, 0);
}

TEST(LightShafts, TakeTrianglesInThePlaneOfThePointsForNoOccluders) {
    Scene scene;
    add_sheet(scene, 8, 0);
    add_sheet(scene, 1, 0);   // on the floor
    add_sheet(scene, 1, -1);  // below it
    scene.lights = {area_light(LightKind::rectangle, {0, 4, 0})};
    EXPECT_EQ(ask(scene, tile_at(scene, 8, 0, 0)), kLit);
    // A millionth of the scene above it is no floor.
    add_sheet(scene, 1, 16e-6f);
    EXPECT_EQ(ask(scene, tile_at(scene, 8, 0, 0)), kNothing);
    EXPECT_EQ(ask(scene, tile_at(scene, 8, 1, 0)), (Count{8, 0, 8}));
}

/// A light that leans to one side, a sheet of its slope behind it, and one across.
TEST(LightShafts, EndAtTheLight) {
    const vec3 u = glm::normalize(vec3(1, 1, 0)), v(0, 0, -1), up = glm::cross(u, v), centre(0, 4, 0);
    for (const LightKind kind : {LightKind::rectangle, LightKind::disk}) {
        Scene scene;
        add_sheet(scene, 8, 0);
        const auto add_shade = [&](vec3 at) {
            add(scene, {at - 2.0f * u, at + 2.0f * u - 2.0f * v, at + 2.0f * u + 2.0f * v}, {{0, 1, 2}});
        };
        Light light     = area_light(kind, centre);
        light.direction = -up;
        light.edge_u = u, light.edge_v = v;
        scene.lights = {light};
        add_shade(centre + 0.001f * up);
        const vec3 back = centre + 0.001f * up;  // a fin
        add(scene, {back - v, back + v, back + up}, {{0, 1, 2}});
        EXPECT_EQ(ask(scene, tile_at(scene, 8, 2, 0)), kLit);
        add_shade(centre - 0.01f * up);
        EXPECT_NE(ask(scene, tile_at(scene, 8, 2, 0)), kLit);
    }
}

TEST(LightShafts, KnowNothingOfLightsWithoutAnAreaOrCloseToThePlane) {
    Scene scene;
    add_sheet(scene, 8, 0);
    for (const LightKind kind : {LightKind::point, LightKind::directional, LightKind::spot}) {
        scene.lights = {area_light(kind, {0, 4, 0})};
        EXPECT_EQ(ask(scene, tile_at(scene, 8, 0, 0)), kNothing);
    }
    Light low    = area_light(LightKind::sphere, {30, 1, 0}, 2);  // it touches the plane
    scene.lights = {low};
    EXPECT_EQ(ask(scene, tile_at(scene, 8, 0, 0)), kNothing);
    scene.lights = {area_light(LightKind::sphere, {1e12f, 1e12f, 0})};
    EXPECT_EQ(ask(scene, tile_at(scene, 8, 0, 0)), kNothing);
}

TEST(LightShafts, KnowNothingOfPointsInSeveralPlanes) {
    Scene scene;
    add(scene, {{-8, 0, 8}, {8, 0, 8}, {8, 1e-3f, -8}, {-8, 0, -8}}, {{0, 1, 2}, {0, 2, 3}});  // folded
    scene.lights      = {area_light(LightKind::rectangle, {0, 4, 0})};
    const Count found = ask(scene, tile_at(scene, 8, 0, 0));
    EXPECT_GT(found.nothing, 3u);  // runs across the fold
    EXPECT_EQ(found.umbra, 0u);
}

/// A sheet of 2 side^2 triangles at height 1.
Scene fine_sheet_scene(std::uint32_t side) {
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (std::uint32_t i = 0; i <= side; ++i)
        for (std::uint32_t j = 0; j <= side; ++j)
            positions.emplace_back(float(i) / float(side), 1, float(j) / float(side));
    for (std::uint32_t i = 0; i < side; ++i)
        for (std::uint32_t j = 0; j < side; ++j) {
            const std::uint32_t a = i * (side + 1) + j, b = a + side + 1;
            triangles.emplace_back(a, a + 1, b), triangles.emplace_back(b, a + 1, b + 1);
        }
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(1));
    Scene scene;
    add_sheet(scene, 8, 0);
    add(scene, positions, triangles);
    scene.lights = {area_light(LightKind::rectangle, {0, 4, 0})};
    return scene;
}

TEST(LightShafts, KnowLargeMeshesInAnyOrder) {
    for (const std::uint32_t side : {150u, 400u}) {
        const Scene scene       = fine_sheet_scene(side);
        const PointBatch points = tile_at(scene, 8, -5, 0);
        EXPECT_EQ(ask(scene, points), kLit) << side;
    }
}

// ---- all rays ------------------------------------------------------------------------------------------------------

/// S_j with and without shafts; how many points are decided without rays is what the second takes fewer of.
std::size_t differences(const Scene& scene, const PointBatch& points, LightId light, const std::string& more = "") {
    MethodCase all("ray_traced:cull=none" + more, scene), culled("ray_traced:cull=shafts" + more, scene);
    all.prepare(light), culled.prepare(light);
    const VisibilityPlane a = all.visibility(points, light), b = culled.visibility(points, light);
    std::size_t differ = 0;
    for (std::size_t i = 0; i < points.size(); ++i) differ += a.s[i] != b.s[i] || a.answer[i] != b.answer[i];
    return differ;
}

TEST(LightShafts, ChangeNoBitInCanonicalScenes) {
    std::size_t lights = 0;
    for (const auto& file : std::filesystem::directory_iterator(UMBRA_SCENES)) {
        if (file.path().extension() != ".json") continue;
        Scene scene;
        try {
            scene = load_scene(file.path());
        } catch (const std::exception&) {
            continue;  // a mesh that was not fetched
        }
        if (scene.triangles.size() > 100000) continue;  // seconds
        const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 320, 180);
        for (LightId j = 0; j < scene.lights.size(); ++j) {
            if (!is_area(scene.lights[j].kind)) continue;
            for (const char* more :
                 {"", ",measure=irradiance", ",offset=epsilon,epsilon=0", ",samples=5,sampler=random"})
                EXPECT_EQ(differences(scene, points, j, more), 0u) << scene.name << " light " << j << more;
            ++lights;
        }
    }
    EXPECT_GE(lights, 6u);  // of the scenes that need no fetched mesh
}

/// A floor, tilted, and triangles anywhere above it, some of them large, some in its plane.
Scene soup(unsigned seed, LightKind kind, vec3 centre = vec3(0), float scale = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-1, 1), size(-0.3f, 0.3f);
    Scene scene;
    const float slope = 0.3f * place(random);
    const auto to     = [&](vec3 p) { return centre + scale * (p + vec3(0, slope * p.x, 0)); };
    add(scene, {to({-3, 0, 3}), to({3, 0, 3}), to({3, 0, -3}), to({-3, 0, -3})}, {{0, 1, 2}, {0, 2, 3}});
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
    for (std::uint32_t t = 0; t < 40; ++t) {
        const float large = t % 5 == 0 ? 5.0f : 1.0f;
        vec3 middle(2 * place(random), 0.9f + 0.8f * place(random), 2 * place(random));
        if (t % 7 == 0) middle.y = 0;
        for (int k = 0; k < 3; ++k) {
            const vec3 by(size(random), t % 7 == 0 ? 0.0f : size(random), size(random));
            positions.push_back(to(middle + large * by));
        }
        triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
    }
    add(scene, positions, triangles);
    Light light      = area_light(kind, centre + scale * vec3(place(random), 2.5f + place(random), place(random)),
                                  scale * (0.6f + 0.5f * place(random)));
    light.edge_u     = scale * vec3(place(random), 0.3f * place(random), place(random));
    light.edge_v     = glm::cross(light.edge_u, vec3(0.2f, 1, 0.1f));
    light.direction  = glm::normalize(vec3(place(random), -2, place(random)));
    scene.lights     = {light};
    scene.camera.eye = to({0, 2, 4}), scene.camera.target = to({0, 0, 0});
    scene.width = 96, scene.height = 64;
    return scene;
}

TEST(LightShafts, ChangeNoBitInAnySoup) {
    for (unsigned seed = 1; seed <= 40; ++seed)
        for (const LightKind kind : kAreaKinds) {
            Scene scene             = soup(seed, kind);
            const PointBatch points = primary(scene);
            EXPECT_EQ(differences(scene, points, 0), 0u) << seed << " " << to_string(kind);
        }
}

TEST(LightShafts, ChangeNoBitFarFromTheOriginOrInTinyScenes) {
    for (unsigned seed = 1; seed <= 10; ++seed)
        for (const LightKind kind : kAreaKinds) {
            EXPECT_EQ(
                differences(soup(seed, kind, vec3(3000, 0, -5000)), primary(soup(seed, kind, vec3(3000, 0, -5000))), 0),
                0u);
            EXPECT_EQ(differences(soup(seed, kind, vec3(0), 1e-9f), primary(soup(seed, kind, vec3(0), 1e-9f)), 0), 0u);
            EXPECT_EQ(differences(soup(seed, kind, vec3(0), 1e9f), primary(soup(seed, kind, vec3(0), 1e9f)), 0), 0u);
        }
}

TEST(LightShafts, AreThereForAreaLightsAlone) {
    Scene scene       = soup(1, LightKind::disk);
    const auto memory = [&](const char* settings) {
        MethodCase rays(settings, scene);
        rays.prepare(0);
        return rays.memory_bytes();
    };
    EXPECT_GT(memory("ray_traced"), memory("ray_traced:cull=none"));
    scene.lights[0].kind = LightKind::point;
    EXPECT_EQ(memory("ray_traced"), memory("ray_traced:cull=none"));
}

TEST(LightShafts, LeaveOutWhatLetsLightThrough) {
    Scene scene = sheet_scene(LightKind::rectangle, 1.5f);
    scene.materials.resize(2);
    scene.materials[1].opacity = 0.5f;
    scene.objects[1].material  = 1;
    EXPECT_EQ(ask(scene, tile_at(scene, 8, 0, 0)), kLit);
    scene.transparent = TransparentOccluders::block;
    EXPECT_EQ(ask(scene, tile_at(scene, 8, 0, 0)), kUmbra);
}

}  // namespace
}  // namespace umbra
