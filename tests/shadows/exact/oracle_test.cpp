// `exact` compared with an oracle of other mathematics (tests/support/oracle.h), on random adversarial scenes: every
// decision about hard lights must agree, and every visible fraction of an area light within the half width that `exact`
// states. Also the facing of points, on which all methods build.
//
// UMBRA_ORACLE_HARD, UMBRA_ORACLE_SEAMS, UMBRA_ORACLE_AREA: how many decisions; UMBRA_ORACLE_SEED: where the scenes
// begin; UMBRA_ORACLE_OUT: a folder for the scenes of mismatches. `./umbra oracle` sets them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "umbra/core/io/scene_writer.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/adversarial_scenes.h"
#include "umbra/tests/support/method_case.h"
#include "umbra/tests/support/oracle.h"

namespace umbra {
namespace {

using oracle::Oracle;
using oracle::SurfacePoint;
using oracle::Verdict;

constexpr double kRectangleHalfWidth = 1e-9;     ///< as `exact` states it (Service::why)
constexpr double kFloatRounding      = 0x1p-25;  ///< half an ulp of an S_j in [0.5, 1)
constexpr double kOracleRounding     = 1e-12;

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text && *text ? std::strtoull(text, nullptr, 10) : otherwise;
}

SurfacePoint name_of(const PointBatch& points, std::size_t i) {
    return {points.triangle[i], points.u[i], points.v[i], points.flipped[i] != 0};
}

/// What became of the decisions.
struct Tally {
    std::uint64_t decisions = 0, lit = 0, umbra = 0, penumbra = 0, on_boundary = 0, away = 0, unknown = 0;
    std::uint64_t mismatches = 0;
    double beyond            = -1;  ///< the largest difference less the stated half width
    double widest            = 0;   ///< the largest half width below 0.5

    void mismatch(const AdversarialScene& made, LightId light, std::size_t i, const std::string& what) {
        ++mismatches;
        const SurfacePoint p = name_of(made.points, i);
        const std::string message =
            fmt::format("{} ({}), light {}, triangle {}, u {:a}, v {:a}{}: {}", made.scene.name, made.pattern,
                        made.scene.lights[light].name, p.triangle, p.u, p.v, p.flipped ? ", flipped" : "", what);
        if (mismatches <= 20) ADD_FAILURE() << message;
        if (const char* folder = std::getenv("UMBRA_ORACLE_OUT"); folder && *folder) {
            std::filesystem::create_directories(folder);
            Scene one = made.scene;
            one.shows = message;
            one.lights.assign(1, made.scene.lights[light]);
            std::ofstream(fmt::format("{}/{}_{}.json", folder, one.name, one.lights[0].name)) << native_text(one);
            std::ofstream(fmt::format("{}/mismatches.txt", folder), std::ios::app) << message << '\n';
        }
    }
    [[nodiscard]] std::string text() const {
        return fmt::format("{} decisions: {} lit, {} umbra, {} penumbra, {} on boundary; {} points away; {} mismatches",
                           decisions, lit, umbra, penumbra, on_boundary, away, mismatches);
    }
};

/// The facing of a point, and the side that sees. False where it is away.
bool judge_facing(const AdversarialScene& made, const Oracle& truth, LightId light, std::size_t i, Tally& tally) {
    const SurfacePoint point = name_of(made.points, i);
    const Facing facing = made.points.facing[light][i], right = truth.facing(point, made.scene.lights[light]);
    if (facing != right) tally.mismatch(made, light, i, fmt::format("facing {}, expected {}", int(facing), int(right)));
    const auto flipped = truth.flipped(point.triangle, made.points.eye);
    if (flipped && point.flipped != (*flipped && made.scene.materials[0].two_sided))
        tally.mismatch(made, light, i, "sees from the wrong side");
    if (facing == right && made.points.asks(light, i)) return true;
    ++tally.away;
    return false;
}

void judge_hard(const AdversarialScene& made, Tally& tally) {
    const Oracle truth(made.scene);
    MethodCase segments("exact:hard_lights=segments", made.scene), bins("exact:hard_lights=bins", made.scene);
    for (LightId light = 0; light < made.scene.lights.size(); ++light) {
        segments.prepare(light), bins.prepare(light);
        const std::array planes{segments.visibility(made.points, light), bins.visibility(made.points, light)};
        for (std::size_t i = 0; i < made.points.size(); ++i) {
            if (made.points.triangle[i] == kNoTriangle || !judge_facing(made, truth, light, i, tally)) continue;
            const Verdict right = truth.verdict(name_of(made.points, i), made.scene.lights[light]);
            ++tally.decisions;
            ++(right == Verdict::lit ? tally.lit : right == Verdict::umbra ? tally.umbra : tally.on_boundary);
            for (const VisibilityPlane& plane : planes) {  // both ways that `exact` has
                const Verdict found = plane.answer[i] == Answer::on_boundary ? Verdict::on_boundary
                                      : plane.s[i] == 0                      ? Verdict::umbra
                                                                             : Verdict::lit;
                if (found != right)
                    tally.mismatch(made, light, i, fmt::format("verdict {}, expected {}", int(found), int(right)));
            }
        }
    }
}

/// How all methods that claim to be right do where a segment meets edges and corners alone. Methods that round are
/// right there, too: doubles hold all that is computed from the lattice.
void judge_seams(const AdversarialScene& made, Tally& tally) {
    const Oracle truth(made.scene);
    std::vector<std::string> choices{"exact:hard_lights=segments", "shadow_volumes:counting=depth_fail"};
    for (const MethodInfo* info : methods()) choices.emplace_back(info->name);
    std::vector<std::unique_ptr<MethodCase>> cases;
    std::erase_if(choices, [&](const std::string& choice) {
        auto method       = std::make_unique<MethodCase>(std::string_view(choice), made.scene);
        const bool claims = method->serves().how >= How::to_rounding;
        if (claims) cases.push_back(std::move(method));
        return !claims;
    });
    for (const auto& method : cases) method->build();
    for (LightId light = 0; light < made.scene.lights.size(); ++light) {
        std::vector<VisibilityPlane> planes;
        for (const auto& method : cases) {
            method->aim(light);
            planes.push_back(method->visibility(made.points, light));
        }
        for (std::size_t i = 0; i < made.points.size(); ++i) {
            if (made.points.triangle[i] == kNoTriangle || !judge_facing(made, truth, light, i, tally)) continue;
            bool touched        = false;
            const Verdict right = truth.verdict(name_of(made.points, i), made.scene.lights[light], &touched);
            if (!touched) continue;
            ++tally.decisions;
            ++(right == Verdict::umbra ? tally.umbra : tally.on_boundary);
            for (std::size_t m = 0; m < cases.size(); ++m) {
                const std::string& name = choices[m];
                const Answer answer     = planes[m].answer[i];
                const bool says_where   = name.starts_with("exact") || name == "alias_free";
                if (says_where && (answer == Answer::on_boundary) != (right == Verdict::on_boundary))
                    tally.mismatch(made, light, i,
                                   fmt::format("{}: answer {}, expected {}", name, int(answer), int(right)));
                if (right == Verdict::umbra && answer == Answer::given && planes[m].s[i] != 0)
                    tally.mismatch(made, light, i, fmt::format("{}: light through a seam", name));
            }
        }
    }
}

void judge_area(const AdversarialScene& made, Tally& tally) {
    const Oracle truth(made.scene);
    MethodCase exact("exact", made.scene);
    for (LightId light = 0; light < made.scene.lights.size(); ++light) {
        exact.prepare(light);
        const VisibilityPlane plane = exact.visibility(made.points, light);
        const bool round            = made.scene.lights[light].kind != LightKind::rectangle;
        for (std::size_t i = 0; i < made.points.size(); ++i) {
            if (made.points.triangle[i] == kNoTriangle || !judge_facing(made, truth, light, i, tally)) continue;
            const oracle::Fraction right = truth.fraction(name_of(made.points, i), made.scene.lights[light]);
            ++tally.decisions;
            if (plane.answer[i] == Answer::on_boundary || right.undefined) {
                ++tally.on_boundary;
                const bool sphere = made.scene.lights[light].kind == LightKind::sphere;
                if (!sphere && (plane.answer[i] == Answer::on_boundary) != right.undefined)
                    tally.mismatch(made, light, i, right.undefined ? "edge-on, but judged" : "not edge-on");
                continue;
            }
            const double half = round ? double(plane.half_width[i]) : kRectangleHalfWidth;
            const double off  = std::abs(plane.s[i] - right.visible);
            ++(right.visible > 1 - 1e-6 ? tally.lit : right.visible < 1e-6 ? tally.umbra : tally.penumbra);
            tally.beyond = std::max(tally.beyond, off - half);
            if (half >= 0.5)
                ++tally.unknown;
            else
                tally.widest = std::max(tally.widest, half);
            if (!(off <= half + kFloatRounding + kOracleRounding))
                tally.mismatch(made, light, i,
                               fmt::format("{} within {:.3g}, expected {:.12g}{}", plane.s[i], half, right.visible,
                                           right.touched ? ", touched" : ""));
        }
    }
}

TEST(Oracle, AreaOfPolygonsInTheUnitDisk) {
    const auto square = [](double s) { return std::vector<dvec2>{{-s, -s}, {s, -s}, {s, s}, {-s, s}}; };
    EXPECT_NEAR(oracle::area_in_unit_disk(square(2)), kPi, 1e-14);
    EXPECT_NEAR(oracle::area_in_unit_disk(square(0.5)), 1, 1e-14);
    EXPECT_NEAR(oracle::area_in_unit_disk({{0, -2}, {2, -2}, {2, 2}, {0, 2}}), kPi / 2, 1e-14);
    EXPECT_NEAR(oracle::area_in_unit_disk({{0.5, -2}, {2, -2}, {2, 2}, {0.5, 2}}), kPi / 3 - std::sqrt(3.0) / 4, 1e-14);
    EXPECT_NEAR(oracle::area_in_unit_disk({{2, 2}, {3, 2}, {3, 3}}), 0, 1e-14);
}

/// A half plane between a point and lights: what is hidden is known.
TEST(Oracle, BehindHalfAPlane) {
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "floor", {{-4, 0, -4}, {0, 0, 8}, {4, 0, -4}}, {}, {{0, 1, 2}}, 0);
    add_object(scene, "sheet", {{0.25f, 1, -40}, {0.25f, 1, 40}, {60, 1, 0}}, {}, {{0, 1, 2}}, 0);
    const Oracle truth(scene);
    const SurfacePoint origin{0, 1.0f / 3, 1.0f / 3};  // nearly
    Light light;
    light.kind     = LightKind::rectangle;
    light.position = {0, 2, 0};
    light.edge_u   = {2, 0, 0};
    light.edge_v   = {0, 0, 2};
    EXPECT_NEAR(truth.fraction(origin, light).visible, 0.75, 1e-6);
    light.kind      = LightKind::disk;
    light.direction = {0, -1, 0};
    light.radius    = 1;
    EXPECT_NEAR(truth.fraction(origin, light).visible, 1 - (kPi / 3 - std::sqrt(3.0) / 4) / kPi, 1e-6);
    light.kind     = LightKind::point;
    light.position = {0.625f, 2, 0};
    EXPECT_EQ(truth.verdict(origin, light), Verdict::umbra);
    light.position = {0.375f, 2, 0};
    EXPECT_EQ(truth.verdict(origin, light), Verdict::lit);
}

constexpr int kLights = 4, kPoints = 24;

TEST(ExactAgainstOracle, HardLights) {
    const std::uint64_t wanted = from_environment("UMBRA_ORACLE_HARD", 6000);
    std::uint64_t seed         = from_environment("UMBRA_ORACLE_SEED", 1);
    Tally tally;
    for (; tally.decisions < wanted; ++seed)
        judge_hard(adversarial_scene(seed, LightsWanted::hard, kLights, kPoints), tally);
    fmt::print("hard lights, {}; next seed {}\n", tally.text(), seed);
    if (wanted == 0) return;
    EXPECT_EQ(tally.mismatches, 0u);
    EXPECT_GT(tally.lit, wanted / 20);
    EXPECT_GT(tally.umbra, wanted / 20);
    EXPECT_GT(tally.on_boundary, wanted / 200);
}

/// Compares the answers of a method that serves the scene to rounding. Returns how many: those off boundaries that it
/// does not leave undefined.
std::size_t judge(const char* choice, const Scene& scene, const PointBatch& points, const Oracle& truth,
                  std::size_t& umbra) {
    MethodCase method(choice, scene);
    if (method.serves().how != How::to_rounding) return 0;
    std::size_t decisions = 0;
    for (LightId light = 0; light < scene.lights.size(); ++light) {
        method.prepare(light);
        const VisibilityPlane plane = method.visibility(points, light);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points.triangle[i] == kNoTriangle || !points.asks(light, i) || !plane.defined(i)) continue;
            const Verdict right = truth.verdict(name_of(points, i), scene.lights[light]);
            if (right == Verdict::on_boundary) continue;
            EXPECT_EQ(plane.s[i], right == Verdict::lit ? 1.0f : 0.0f)
                << choice << ", " << scene.name << ", light " << light << ", point " << i << ", triangle "
                << points.triangle[i];
            ++decisions, umbra += right == Verdict::umbra;
        }
    }
    return decisions;
}

/// What serves hard lights to rounding decides exactly what rounding leaves open: by hair-thin triangles, at folds, on
/// edges, in any scale.
class AllToRounding : public testing::TestWithParam<const char*> {};

TEST_P(AllToRounding, AgreesOnAdversarialScenes) {
    std::size_t decisions = 0, umbra = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const AdversarialScene made = adversarial_scene(seed, LightsWanted::hard, kLights, kPoints);
        decisions += judge(GetParam(), made.scene, made.points, Oracle(made.scene), umbra);
    }
    EXPECT_GT(decisions, 500u);
    EXPECT_GT(umbra, 100u);
}

/// A wall that begins a hair above a floor, or below it: exporters write a foot at -1e-17. Points lie by the wall and
/// under it, and on lines through its foot.
TEST_P(AllToRounding, AgreesAtTheFootOfAWall) {
    std::size_t decisions = 0, umbra = 0;
    for (const float foot : {0.0f, -0x1p-149f, 0x1p-149f, -1e-20f, 1e-20f, -6e-17f, -1e-14f, -1e-9f, 1e-9f, -1e-3f}) {
        Scene scene;
        scene.materials.emplace_back();
        const auto add_quad = [&](const char* name, vec3 a, vec3 along, vec3 up) {
            add_object(scene, name, {a, a + along, a + along + up, a + up}, {}, {{0, 1, 2}, {0, 2, 3}}, 0);
        };
        add_quad("floor", {-4, 0, 4}, {8, 0, 0}, {0, 0, -8});
        add_quad("wall", {-1, foot, 0.25f}, {2, 0, 0}, {0, 1.5f, 0});
        add_quad("turned", {-2.1f, foot, -1.3f}, {1.1f, 0, 0.7f}, {0, 1.3f, 0});
        for (const vec3 at : {vec3(0, 3, 4), vec3(-3, 2, 1), vec3(0.3f, 5, 0.2501f), vec3(2, 1, -4)}) {
            Light light;
            light.kind     = LightKind::point;
            light.name     = std::to_string(scene.lights.size());
            light.position = at;
            scene.lights.push_back(light);
        }
        const std::array v{0.0f, 0x1p-149f, 0x1p-24f, 0.25f, 0.46875f, 0.469f, 0.5f, 0.53125f, 0.6f, 0.7f};
        PointBatch points;
        points.eye = {0, 5, 0};
        points.resize(2 * v.size() * v.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::size_t k = i / 2;
            set_point(points, i, scene, static_cast<TriangleId>(i % 2), v[k / v.size()], v[k % v.size()]);
        }
        face_lights(points, scene);
        decisions += judge(GetParam(), scene, points, Oracle(scene), umbra);
    }
    EXPECT_GT(decisions, 1000u);
    EXPECT_GT(umbra, 50u);
}

INSTANTIATE_TEST_SUITE_P(Methods, AllToRounding,
                         testing::Values("planar_projection", "planar_projection:edges=per_triangle", "scan_line",
                                         "shadow_volumes", "shadow_volumes:counting=depth_fail", "brute_force"));

TEST(ExactAgainstOracle, Seams) {
    const std::uint64_t wanted = from_environment("UMBRA_ORACLE_SEAMS", 3000);
    std::uint64_t seed         = from_environment("UMBRA_ORACLE_SEED", 1);
    Tally tally;
    for (; tally.decisions < wanted; ++seed) judge_seams(adversarial_scene(seed, LightsWanted::seams, 8, 8), tally);
    fmt::print("seams, {}; next seed {}\n", tally.text(), seed);
    if (wanted == 0) return;
    EXPECT_EQ(tally.mismatches, 0u);
    EXPECT_GT(tally.umbra, wanted / 5);
    EXPECT_GT(tally.on_boundary, wanted / 5);
}

TEST(ExactAgainstOracle, AreaLights) {
    const std::uint64_t wanted = from_environment("UMBRA_ORACLE_AREA", 600);
    std::uint64_t seed         = from_environment("UMBRA_ORACLE_SEED", 1);
    Tally tally;
    for (; tally.decisions < wanted; ++seed) judge_area(adversarial_scene(seed, LightsWanted::area, kLights, 8), tally);
    fmt::print(
        "area lights, {}; {} with nothing known; largest difference beyond the half width {:.3g}, largest half "
        "width {:.3g}; next seed {}\n",
        tally.text(), tally.unknown, tally.beyond, tally.widest, seed);
    if (wanted == 0) return;
    EXPECT_EQ(tally.mismatches, 0u);
    EXPECT_GT(tally.penumbra, wanted / 4);
}

/// A triangle in an oblique plane through the origin and a sliver at one of its edges, whose third corner lies beside
/// the origin by 1e-17 along each axis, or by nothing: it continues the triangle, is folded onto it or leaves its plane
/// by any angle. In doubles the differences of coordinates lose all of that.
TEST(ExactAgainstOracle, FoldsInEveryWay) {
    Tally tally;
    for (int way = 0; way < 3 * 3 * 3 * 8; ++way) {
        const vec3 d = 1e-17f * (vec3(way % 3, way / 3 % 3, way / 9 % 3) - 1.0f), a(1, 1, 0.5f);
        if (d == vec3(0)) continue;
        const int turned = way / 27;
        const vec3 c     = turned & 4 ? vec3(1, 1, -1) : vec3(-1, -1, 1);
        AdversarialScene made;
        made.pattern = fmt::format("fold {}", way);
        made.scene.materials.resize(1);
        add_object(made.scene, "floor", {{-16, -3, -16}, {0, -3, 32}, {16, -3, -16}}, {}, {{0, 1, 2}}, 0);
        add_object(made.scene, "fold", {a, -a, c, d}, {},
                   {turned & 1 ? uvec3(0, 1, 2) : uvec3(1, 0, 2), turned & 2 ? uvec3(0, 1, 3) : uvec3(1, 0, 3)}, 0);
        Light light;
        light.kind     = LightKind::rectangle;
        light.position = {0.25f, 3, 0.125f};
        light.edge_u   = {2, 0, 0};
        light.edge_v   = {0, 0, -2};
        made.scene.lights.push_back(light);
        made.points.eye = {1, 8, 2};
        made.points.resize(3);
        for (std::size_t i = 0; i < 3; ++i)
            set_point(made.points, i, made.scene, 0, 0.32f + 0.02f * static_cast<float>(i), 0.34f);
        face_lights(made.points, made.scene);
        judge_area(made, tally);
    }
    EXPECT_EQ(tally.mismatches, 0u);
    EXPECT_EQ(tally.penumbra, tally.decisions) << tally.text();
}

/// Disks and spheres of any size in bad positions: an answer for every point, whatever it is worth.
TEST(ExactAgainstOracle, RoundLightsInBadPositions) {
    const std::uint64_t wanted = from_environment("UMBRA_ORACLE_ROUND", 20);
    const std::uint64_t first  = from_environment("UMBRA_ORACLE_SEED", 1);
    Tally tally;
    for (std::uint64_t seed = first; seed < first + wanted; ++seed)
        judge_area(adversarial_scene(seed, LightsWanted::round, 2, 8), tally);
    fmt::print("round lights in {} scenes, {}; {} with nothing known; largest half width {:.3g}\n", wanted,
               tally.text(), tally.unknown, tally.widest);
    EXPECT_EQ(tally.mismatches, 0u);
}

}  // namespace
}  // namespace umbra
