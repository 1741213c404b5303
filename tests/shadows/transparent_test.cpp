// What surfaces that let light through do to S_j: every method, by each of the three rules.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "umbra/core/io/scene_io.h"
#include "umbra/core/io/scene_writer.h"
#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/method_case.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

constexpr float kThin = 0.4f, kThick = 0.75f;  // opacities

/// A floor, a post, an opaque sheet and two that light passes, under a light that is small enough to see both.
Scene sheets(LightKind kind, TransparentOccluders rule, bool with_transparent = true) {
    Scene scene;
    scene.transparent = rule;
    scene.materials.resize(3);
    scene.materials[1].opacity = kThin;
    scene.materials[2].opacity = kThick;
    const Mesh post            = make_box({0.4f, 1.5f, 0.4f});
    add_object(scene, "floor", {{-5, 0, -5}, {5, 0, -5}, {5, 0, 5}, {-5, 0, 5}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    add_object(scene, "post", post.positions, {}, post.triangles, 0);
    const auto sheet = [&](const char* name, float x, float z, float y, std::uint32_t material) {
        add_object(scene, name, {{x - 1, y, z - 1}, {x + 1, y, z - 1}, {x + 1, y, z + 1}, {x - 1, y, z + 1}}, {},
                   {{0, 2, 1}, {0, 3, 2}}, material);
    };
    sheet("opaque", 2, 2, 0.5f, 0);
    if (with_transparent) {
        sheet("thin", -2, 0.3f, 1.0f, 1);
        sheet("thick", -1.2f, 0.9f, 0.7f, 2);
        sheet("over_the_opaque", 2.5f, 2.5f, 0.8f, 1);
    }
    Light light;
    light.name      = "light";
    light.kind      = kind;
    light.direction = {0.3f, -1, 0.2f};
    light.position  = {-1, 5, 0.5f};
    light.edge_u = {0.6f, 0, 0}, light.edge_v = {0, 0, 0.6f};
    light.radius = 0.3f;
    if (kind == LightKind::rectangle || kind == LightKind::disk) light.direction = {0, -1, 0};
    if (kind == LightKind::rectangle) light.edge_v = {0, 0, -0.6f};
    scene.lights     = {light};
    scene.camera.eye = {0, 9, 7};
    scene.width = 96, scene.height = 80;
    return scene;
}

constexpr LightKind kKinds[] = {LightKind::directional, LightKind::point, LightKind::rectangle, LightKind::sphere};

class EveryMethod : public testing::TestWithParam<const MethodInfo*> {};

/// "ignore": what lets light through throws no shadow, and gets S_j as all do.
TEST_P(EveryMethod, IgnoresWhatLetsLightThrough) {
    for (const LightKind kind : kKinds) {
        const Scene with = sheets(kind, TransparentOccluders::ignore), without = sheets(kind, {}, false);
        MethodCase run(*GetParam(), with), bare(*GetParam(), without);
        if (!run.verdict()) continue;
        const PointBatch points = primary(with);
        // The floor below a sheet is not seen: the points of the scene without sheets, whose triangles come first.
        const PointBatch below = primary(without);
        run.prepare(0), bare.prepare(0);
        const VisibilityPlane got = run.visibility(below, 0), right = bare.visibility(below, 0);
        std::size_t asked = 0, different = 0, dark = 0;
        for (std::size_t i = 0; i < below.size(); ++i) {
            if (!is_open(below, 0, i) || !right.defined(i) || !got.defined(i)) continue;
            ++asked;
            different += std::abs(got.s[i] - right.s[i]) > 0.02f;
            dark += right.s[i] == 0;
        }
        EXPECT_GT(asked, 3000u) << to_string(kind);
        EXPECT_GT(dark, 50u) << to_string(kind);
        // A map may fit the scene otherwise, and a mesh of patches begins elsewhere.
        const bool approximates = run.serves().how == How::approximately;
        EXPECT_LE(different, approximates ? asked / 100 : 0) << to_string(kind);

        const VisibilityPlane all = run.visibility(points, 0);
        std::size_t on_sheets     = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (is_open(points, 0, i) && !with.blocks(points.triangle[i]) && all.defined(i)) on_sheets += all.s[i] == 1;
        if (GetParam()->name != "planar_projection" || on_sheets > 0) {
            EXPECT_GT(on_sheets, 300u) << to_string(kind);
        }
    }
}

/// "block": the answers of a scene whose materials are opaque, to the same bits.
TEST_P(EveryMethod, BlocksAsAnOpaqueSurfaceWhereTheSceneSaysSo) {
    for (const LightKind kind : kKinds) {
        const Scene with = sheets(kind, TransparentOccluders::block);
        Scene opaque     = with;
        for (Material& m : opaque.materials) m.opacity = 1;
        MethodCase run(*GetParam(), with), plain(*GetParam(), opaque);
        ASSERT_EQ(run.verdict().how, plain.verdict().how);
        if (!run.verdict()) continue;
        const PointBatch points = primary(with);
        run.prepare(0), plain.prepare(0);
        EXPECT_EQ(run.visibility(points, 0).s, plain.visibility(points, 0).s) << to_string(kind);
    }
}

/// Whole surfaces in the place of leaves: what is computed of them may be exact, but the scene has others.
TEST_P(EveryMethod, IsApproximateWhereOutlinesAreMissing) {
    for (const LightKind kind : kKinds) {
        Scene scene               = sheets(kind, TransparentOccluders::ignore, false);
        scene.materials[0].cutout = true;
        const MethodCase run(*GetParam(), scene);
        if (!run.serves()) continue;
        EXPECT_EQ(run.verdict().how, How::approximately) << to_string(kind);
        EXPECT_NE(run.verdict().why.find("outlines that a texture cuts"), std::string::npos) << run.verdict().why;
        scene.materials[0].cutout = false;
        EXPECT_EQ(MethodCase(*GetParam(), scene).verdict().how, run.serves().how) << to_string(kind);
    }
}

TEST_P(EveryMethod, MultipliesOrSaysThatItCannot) {
    for (const LightKind kind : kKinds) {
        const Scene scene = sheets(kind, TransparentOccluders::multiply);
        MethodCase run(*GetParam(), scene);
        const Service service = run.verdict();
        if (!run.method().multiplies()) {
            EXPECT_EQ(service.how, How::not_at_all);
            if (!run.serves()) continue;  // for another reason
            EXPECT_NE(service.why.find("let a part of the light through"), std::string::npos) << service.why;
        }
        if (!service) continue;
        const PointBatch below = primary(sheets(kind, {}, false));
        run.prepare(0);
        const VisibilityPlane got = run.visibility(below, 0);
        // What each segment passes, by the sheets' outlines on its way.
        const auto meets = [&](dvec3 p, std::size_t object) {
            const vec3 low = scene.vertex(scene.objects[object].first_triangle, 0);
            const dvec3 to = kind == LightKind::directional ? -dvec3(scene.lights[0].direction)
                                                            : dvec3(scene.lights[0].position) - p;
            const double t = (double(low.y) - p.y) / to.y;
            const dvec3 q  = p + t * to - dvec3(low);
            const double d = std::min({std::abs(q.x), std::abs(q.x - 2), std::abs(q.z), std::abs(q.z - 2)});
            return std::pair{t > 0 && q.x > 0 && q.x < 2 && q.z > 0 && q.z < 2, d};
        };
        std::array<std::size_t, 4> of_kind{};
        for (std::size_t i = 0; i < below.size(); ++i) {
            if (!is_open(below, 0, i) || scene.triangle_object[below.triangle[i]] != 0) continue;
            const dvec3 p              = exact_position(scene, below, i);
            const auto [thin, at_thin] = meets(p, 3);
            const auto [thick, near]   = meets(p, 4);
            const auto [over, at_over] = meets(p, 5);
            const auto [opaque, edge]  = meets(p, 2);
            const double margin        = is_area(kind) ? 0.6 : 1e-4;
            if (opaque || over || std::min({at_thin, near, at_over, edge}) < margin || got.s[i] == 0) continue;
            const double expected = (thin ? 1 - double(kThin) : 1) * (thick ? 1 - double(kThick) : 1);
            EXPECT_NEAR(double(got.s[i]), expected, 1e-6) << to_string(kind) << " " << p.x << " " << p.z;
            ++of_kind[static_cast<std::size_t>(thin) + 2 * static_cast<std::size_t>(thick)];
        }
        EXPECT_GT(of_kind[0], 50u) << to_string(kind);
        if (is_area(kind)) continue;  // whose sheets have little but penumbra
        for (const std::size_t n : of_kind) EXPECT_GT(n, 20u) << to_string(kind);
    }
}

INSTANTIATE_TEST_SUITE_P(Transparent, EveryMethod, testing::ValuesIn(methods().begin(), methods().end()),
                         [](const auto& of) { return std::string(of.param->name); });

/// Hard lights: two methods of their own arithmetic, at every pixel.
TEST(Transparent, ExactIsBruteForceWhereTransmittancesMultiply) {
    for (const LightKind kind : {LightKind::directional, LightKind::point}) {
        const Scene scene = sheets(kind, TransparentOccluders::multiply);
        MethodCase exact("exact", scene), force("brute_force", scene);
        EXPECT_EQ(exact.verdict().how, How::exactly);
        exact.prepare(0), force.prepare(0);
        const PointBatch points = primary(scene);
        const VisibilityPlane a = exact.visibility(points, 0), b = force.visibility(points, 0);
        std::size_t between = 0, different = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!is_open(points, 0, i) || a.answer[i] != Answer::given) continue;
            between += a.s[i] > 0 && a.s[i] < 1;
            different += std::abs(a.s[i] - b.s[i]) > 1e-6f;
        }
        EXPECT_GT(between, 200u);
        EXPECT_EQ(different, 0u);
    }
    const Scene area = sheets(LightKind::sphere, TransparentOccluders::multiply);
    const MethodCase exact("exact", area);
    EXPECT_EQ(exact.verdict().how, How::not_at_all);
}

/// The picture behind coloured sheets is that of the open floor times their colour; methods agree on it.
TEST(Transparent, ColouredSheetsThrowColouredLight) {
    const vec3 colour(1, 0.25f, 0.5f);
    Scene scene                        = sheets(LightKind::directional, TransparentOccluders::multiply);
    scene.materials[1].transmit_colour = colour;
    scene.ambient                      = vec3(0);
    const SceneFacts facts             = find_facts(scene);
    ASSERT_TRUE(facts.has_coloured_filters);
    EXPECT_FALSE(find_facts(sheets(LightKind::directional, TransparentOccluders::multiply)).has_coloured_filters);
    const PointBatch points = primary(scene);
    std::vector<VisibilityPlane> planes;
    for (const char* name : {"exact", "brute_force"}) {
        MethodCase run(name, scene);
        run.prepare(0);
        VisibilityPlane& plane = planes.emplace_back(points.size(), true);
        run.visibility(points, 0, plane.out());
    }
    const Image picture     = shade(scene, points, std::span(planes).first(1)),
                open        = shade(scene, points, lit_everywhere(scene, points));
    const vec3 thin         = (1 - kThin) * colour;
    std::size_t behind_thin = 0, different = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i) || planes[0].answer[i] != Answer::given) continue;
        different += glm::distance(planes[0].colour[i], planes[1].colour[i]) > 1e-6f ? 1 : 0;
        EXPECT_EQ(planes[0].s[i], mean_of(planes[0].colour[i]));
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(picture.at(i, c), planes[0].colour[i][static_cast<int>(c)] * open.at(i, c), 1e-6);
        behind_thin += glm::distance(planes[0].colour[i], thin) < 1e-6f ? 1 : 0;
    }
    EXPECT_EQ(different, 0u);
    EXPECT_GT(behind_thin, 100u);
}

/// The scene that the lectures' page shows: 60 % pass one sheet, 30 % the other, 18 % both.
TEST(Transparent, TwoSheetsLetTheirProductThrough) {
    const Scene scene = load_scene(std::string(UMBRA_SCENES) + "/two_sheets.json");
    MethodCase exact("exact", scene);
    ASSERT_EQ(exact.verdict().how, How::exactly);
    exact.prepare(0);
    const PointBatch points     = primary(scene);
    const VisibilityPlane plane = exact.visibility(points, 0);
    std::array<std::size_t, 5> found{};
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, 0, i)) continue;
        const double s[] = {1, 0.6, 0.3, 0.18, 0};
        for (std::size_t k = 0; k < 5; ++k)
            if (std::abs(double(plane.s[i]) - s[k]) < 1e-6) {
                ++found[k];
                break;
            }
    }
    for (std::size_t k = 0; k < 5; ++k) EXPECT_GT(found[k], 300u) << k;
    std::size_t open = 0;
    for (std::size_t i = 0; i < points.size(); ++i) open += is_open(points, 0, i);
    EXPECT_EQ(found[0] + found[1] + found[2] + found[3] + found[4], open) << "S_j of another value";
}

TEST(Transparent, TheRuleIsReadAndWritten) {
    const TemporaryFolder folder;
    const auto read = [&](const std::string& rule) {
        return load_scene(folder.write("scene.json", R"({)" + rule + R"("objects": [{"type": "box"}]})"));
    };
    EXPECT_EQ(read("").transparent, TransparentOccluders::ignore);
    for (const auto& [name, rule] : {std::pair{"ignore", TransparentOccluders::ignore},
                                     {"block", TransparentOccluders::block},
                                     {"multiply", TransparentOccluders::multiply}}) {
        const Scene scene = read(std::string(R"("transparent_occluders": ")") + name + R"(", )");
        EXPECT_EQ(scene.transparent, rule);
        EXPECT_EQ(load_scene(folder.write("again.json", native_text(scene))).transparent, rule);
    }
    EXPECT_THROW((void)read(R"("transparent_occluders": "some", )"), std::exception);

    const auto coloured = [&](const std::string& colour) {
        return load_scene(folder.write("scene.json", R"({"materials": {"m": {"opacity": 0.5, "transmit_colour": )" +
                                                         colour +
                                                         R"(}}, "objects": [{"type": "box", "material": "m"}]})"));
    };
    const Scene scene = coloured("[1, 0.5, 0.25]");
    EXPECT_EQ(scene.material(0).transmit_colour, vec3(1, 0.5f, 0.25f));
    EXPECT_EQ(load_scene(folder.write("again.json", native_text(scene))).material(0).transmit_colour,
              vec3(1, 0.5f, 0.25f));
    EXPECT_THROW((void)coloured("[1, 1.5, 0]"), std::exception);
}

}  // namespace
}  // namespace umbra
