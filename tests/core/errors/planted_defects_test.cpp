// Every class of errors against a defect planted to raise it: that class rises, and no other.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "umbra/bench/lab/outcome.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/method_case.h"

namespace umbra {
namespace {

Mesh moved(const Mesh& mesh, vec3 by) { return transformed(mesh, glm::translate(mat4(1), by)); }

std::uint32_t add(Scene& scene, std::string_view name, const Mesh& mesh, bool smooth = false) {
    return add_object(scene, std::string(name), mesh.positions, smooth ? mesh.normals : std::vector<vec3>{},
                      mesh.triangles, 0);
}

constexpr std::size_t kLeftHalf = 2, kRightHalf = 3, kMole = 4;  // objects

/// A thin wall on a floor, and a board of two halves that hangs high over it, under a sun.
Scene wall_and_board() {
    Scene scene;
    scene.materials.emplace_back();
    add(scene, "floor", make_plane(12, 12));
    add(scene, "wall", moved(make_box({0.03f, 1.6f, 1.8f}), {-1.5f, 0.8f, 0.4f}));
    add(scene, "left half", moved(make_plane(1.5f, 2), {0.75f, 2.5f, -0.5f}));
    add(scene, "right half", moved(make_plane(1.5f, 2), {2.25f, 2.5f, -0.5f}));
    add(scene, "mole", moved(make_plane(0.6f, 0.6f), {-1, -2, 2}));  // under the floor
    Light& sun          = scene.lights.emplace_back();
    sun.name            = "sun";
    sun.kind            = LightKind::directional;
    sun.direction       = {0.5f, -1, -0.12f};
    scene.camera.eye    = {0.5f, 6.5f, 8};
    scene.camera.target = {0.5f, 0.3f, 0};
    scene.width         = 320;
    scene.height        = 200;
    return scene;
}

void move_object(Scene& scene, std::size_t object, vec3 by) {
    const Object& o = scene.objects[object];
    std::vector<std::uint8_t> done(scene.positions.size(), 0);
    for (std::uint32_t t = 0; t < o.triangle_count; ++t)
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t p = scene.triangles[o.first_triangle + t][k];
            if (!std::exchange(done[p], 1)) scene.positions[p] += by;
        }
}

/// A scene with its exact answer. Methods run on it, or on a scene with the same triangles of which some were moved.
struct Stage {
    Scene scene;
    SceneFacts facts  = find_facts(scene);
    PointBatch points = primary(scene);
    MethodRun truth   = run_method(parse_method("exact"), scene, facts, points);

    explicit Stage(Scene s) : scene(std::move(s)) {}
    [[nodiscard]] MethodRun run(std::string_view method, const Scene& on) const {
        return run_method(parse_method(method), on, find_facts(on), points);
    }
    [[nodiscard]] Explained explained(const MethodRun& run) const { return explain(scene, points, 0, run, truth); }
    [[nodiscard]] Explained explained(std::string_view method) const { return explained(run(method, scene)); }
    [[nodiscard]] std::size_t pixel(int x, int y) const { return static_cast<std::size_t>(y * scene.width + x); }
};

/// The interior classes, each of which a defect may raise.
struct Interior {
    std::uint64_t acne, other_shadow, detachment, leak, at_terminator, penumbra;
};
Interior interior(const VisibilityError& e) {
    return {e.acne, e.other_shadow(),   e.detachment,
            e.leak, e.terminator.wrong, e.penumbra_error.false_shadow + e.penumbra_error.false_light};
}
void expect_none(const Interior& i, std::string_view but) {
    EXPECT_TRUE(but == "acne" || i.acne == 0) << i.acne;
    EXPECT_TRUE(but == "other_shadow" || i.other_shadow == 0) << i.other_shadow;
    EXPECT_TRUE(but == "detachment" || i.detachment == 0) << i.detachment;
    EXPECT_TRUE(but == "leak" || i.leak == 0) << i.leak;
    EXPECT_TRUE(but == "at_terminator" || i.at_terminator == 0) << i.at_terminator;
    EXPECT_TRUE(but == "penumbra" || i.penumbra == 0) << i.penumbra;
}

TEST(PlantedDefects, NoneNoErrors) {
    const Stage stage(wall_and_board());
    const Explained e = stage.explained("ray_traced");
    expect_none(interior(e.error), "");
    EXPECT_EQ(e.error.false_shadow.edge + e.error.false_light.edge, 0u);
    ASSERT_TRUE(e.displacement);
    EXPECT_EQ(e.displacement->max, 0);
    EXPECT_GT(e.displacement->pieces, 200u);
    EXPECT_EQ(e.displacement->unmatched, 0u);
}

TEST(PlantedDefects, TooLittleBiasIsAcne) {
    const Stage stage(wall_and_board());
    const Interior good = interior(stage.explained("shadow_zbuffer:resolution=1024").error);
    const Interior bad  = interior(stage.explained("shadow_zbuffer:resolution=1024,bias=manual,constant=0").error);
    expect_none(good, "");
    EXPECT_GT(bad.acne, 200u);
    // At the wall's foot a sample may show the other of the two that touch there, which have no corner in common.
    EXPECT_LT(bad.other_shadow, bad.acne / 50);
    EXPECT_EQ(bad.detachment + bad.leak + bad.at_terminator, 0u);
}

TEST(PlantedDefects, AnOffsetOfNothingIsAcne) {
    const Stage stage(wall_and_board());
    const Interior bad = interior(stage.explained("ray_traced:offset=epsilon,epsilon=0").error);
    expect_none(bad, "acne");
    EXPECT_GT(bad.acne, 200u);
}

TEST(PlantedDefects, TooMuchBiasIsDetachment) {
    const Stage stage(wall_and_board());
    std::uint64_t before = 0;
    for (const char* constant : {"30", "60", "90"}) {
        const Interior bad = interior(
            stage.explained(std::string("shadow_zbuffer:resolution=1024,bias=manual,constant=") + constant).error);
        expect_none(bad, "detachment");
        EXPECT_GT(bad.detachment, before) << constant;
        before = bad.detachment;
    }
    EXPECT_GT(before, 50u);
}

TEST(PlantedDefects, DetachmentIsTheFirstHalfOfAShadowAtEverySize) {
    // All shadow is lost. The wall is 1.6 high and ends at x = -1.485; the sun moves 0.5 to the side on 1 down, so that
    // shadow of the lower half of the wall is within 0.4. A segment may enter the wall, 0.03 thick, at its end.
    for (const int width : {160, 320, 1280}) {
        Scene scene  = wall_and_board();
        scene.width  = width;
        scene.height = width * 5 / 8;
        const Stage stage(scene);
        MethodRun run = stage.truth;
        for (float& s : run.planes[0].s) s = 1;
        const Explained e = stage.explained(run);
        for (std::size_t i = 0; i < e.classes.size(); ++i) {
            const double from_wall = stage.points.position(i).x + 1.485;
            if (e.classes[i] == ErrorClass::detachment) {
                EXPECT_LE(from_wall, 0.4 + 1e-5) << width;
            } else if (e.classes[i] == ErrorClass::leak) {
                EXPECT_GE(from_wall, 0.4 - 0.03 - 1e-5) << width << ": the board is in the air, far to the right";
            }
        }
        const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(width);
        EXPECT_GT(e.error.detachment, pixels / 2000) << width;
        EXPECT_GT(e.error.leak, 3 * e.error.detachment) << width;
        EXPECT_EQ(e.error.unnamed, 0u) << width;
    }
}

TEST(PlantedDefects, ALeakingSeamIsALeak) {
    const Stage stage(wall_and_board());
    Scene cracked = stage.scene;
    for (std::uint32_t t = 0; t < 2; ++t)
        for (int k = 0; k < 3; ++k) {
            float& x = cracked.positions[cracked.triangles[cracked.objects[kRightHalf].first_triangle + t][k]].x;
            if (x == 1.5f) x = 1.7f;
        }
    const Interior bad = interior(stage.explained(stage.run("ray_traced", cracked)).error);
    expect_none(bad, "leak");
    EXPECT_GT(bad.leak, 50u);
}

TEST(PlantedDefects, TheShadowOfWhatIsNotThereIsNoAcne) {
    const Stage stage(wall_and_board());
    Scene haunted = stage.scene;
    move_object(haunted, kMole, {0, 4, 0});
    const Interior bad = interior(stage.explained(stage.run("ray_traced", haunted)).error);
    expect_none(bad, "other_shadow");
    EXPECT_GT(bad.other_shadow, 100u);
}

TEST(PlantedDefects, AMethodThatNamesNobodyHasAcne) {
    const Stage stage(wall_and_board());
    MethodRun run = stage.run("ray_traced", stage.scene);
    // A blot on the lit floor, which the method, asked again, has no culprit for.
    std::uint64_t blot = 0;
    for (int y = 150; y < 170; ++y)
        for (int x = 40; x < 60; ++x) blot += std::exchange(run.planes[0].s[stage.pixel(x, y)], 0.0f) == 1;
    const Interior bad = interior(stage.explained(run).error);
    expect_none(bad, "acne");
    EXPECT_EQ(bad.acne, blot);
    EXPECT_EQ(blot, 400u);
}

TEST(PlantedDefects, ABoundaryMovedByThreePixelsIsThreePixelsOff) {
    const Stage stage(wall_and_board());
    // A shadow with edges along the pixels, since a slanted one that moves to the right moves less across itself.
    MethodRun truth = stage.truth, run = stage.truth;
    const auto draw = [&](VisibilityPlane& plane, int left) {
        for (int y = 0; y < stage.scene.height; ++y)
            for (int x = 0; x < stage.scene.width; ++x) {
                const std::size_t i = stage.pixel(x, y);
                plane.s[i] =
                    stage.points.facing[0][i] == Facing::front && (x < left || x >= left + 60 || y < 120) ? 1.0f : 0.0f;
                plane.answer[i] = Answer::given;
            }
    };
    for (const int shift : {0, 1, 2, 3, 5}) {
        draw(truth.planes[0], 170);
        draw(run.planes[0], 170 + shift);
        const Explained e = explain(stage.scene, stage.points, 0, run, truth);
        ASSERT_TRUE(e.displacement);
        const int edge = std::min(shift, 2), inner = shift - edge, rows = stage.scene.height - 120;
        // The two sides of the shadow are `shift` off, its upper end is not.
        EXPECT_EQ(e.displacement->pieces, 2u * rows + 60) << shift;
        EXPECT_EQ(e.displacement->max, shift);
        EXPECT_EQ(e.displacement->p95, shift);
        EXPECT_GE(e.displacement->mean, shift * 0.72);  // 160 of 220, and more where the upper end ends
        EXPECT_LE(e.displacement->mean, shift * 0.8);
        // Points beyond the band count as interior: a strip on either side.
        const std::uint64_t strip = static_cast<std::uint64_t>(inner) * static_cast<std::uint64_t>(rows);
        EXPECT_NEAR(static_cast<double>(e.error.false_light.interior), static_cast<double>(strip), 3.0 * inner);
        EXPECT_NEAR(static_cast<double>(e.error.false_shadow.interior), static_cast<double>(strip), 3.0 * inner);
    }
}

TEST(PlantedDefects, AcneAndHolesMoveNoBoundary) {
    const Stage stage(wall_and_board());
    MethodRun run = stage.truth;
    // One in 37 points flipped, except for those near a boundary, whose pieces it would touch.
    const auto band      = edge_band(stage.points, 0, stage.truth.planes[0], kHardTolerance);
    std::uint64_t turned = 0;
    for (std::size_t i = 0; i < run.planes[0].s.size(); i += 37)
        if (is_open(stage.points, 0, i) && !band[i]) run.planes[0].s[i] = 1 - run.planes[0].s[i], ++turned;
    const Explained e = stage.explained(run);
    EXPECT_GT(turned, 500u);
    EXPECT_EQ(e.error.false_shadow.interior + e.error.false_light.interior, turned);
    ASSERT_TRUE(e.displacement);
    EXPECT_EQ(e.displacement->max, 0);
    EXPECT_EQ(e.displacement->unmatched, 0u);
}

TEST(PlantedDefects, AShadowThatIsNotThereIsNoDisplacedOne) {
    const Stage stage(wall_and_board());
    Scene gone = stage.scene;
    move_object(gone, kLeftHalf, {0, 0, 400});
    move_object(gone, kRightHalf, {0, 0, 400});
    const Explained e = stage.explained(stage.run("ray_traced", gone));
    ASSERT_TRUE(e.displacement);
    EXPECT_EQ(e.displacement->max, 0);  // the wall's
    EXPECT_GT(e.displacement->unmatched, 200u);
    EXPECT_LT(e.displacement->unmatched, e.displacement->pieces);
}

/// A ball of few facets that pretends to be smooth.
Scene ball(bool smooth) {
    Scene scene = wall_and_board();
    add(scene, "ball", moved(make_sphere(0.9f, 12, 8), {-1.5f, 1, 3}), smooth);
    return scene;
}

TEST(PlantedDefects, AShadowFromTheNextFacetIsAcneToo) {
    // Facets of a few pixels: a sample of the map mostly shows the neighbour of the point's own.
    Scene scene = wall_and_board();
    add(scene, "ball", moved(make_sphere(0.9f, 64, 48), {-1.5f, 1, 3}));
    const Stage stage(scene);
    const Interior bad = interior(stage.explained("shadow_zbuffer:resolution=512,bias=manual,constant=0").error);
    EXPECT_GT(bad.acne, 500u);
    EXPECT_LT(bad.other_shadow, bad.acne / 50);
    EXPECT_EQ(bad.detachment + bad.leak + bad.at_terminator, 0u);
}

TEST(PlantedDefects, TheTerminatorIsCountedApart) {
    const Stage flat(ball(false)), smooth(ball(true));
    EXPECT_EQ(flat.explained("ray_traced").error.terminator.facet_away, 0u);
    EXPECT_EQ(flat.explained("ray_traced").error.terminator.normal_away, 0u);
    MethodRun run = smooth.run("ray_traced", smooth.scene);
    Explained e   = smooth.explained(run);
    EXPECT_GT(e.error.terminator.facet_away, 50u);
    EXPECT_GT(e.error.terminator.normal_away, 50u);
    EXPECT_EQ(e.error.terminator.wrong, 0u);

    // All wrong where the facet faces the sun and the normal does not: no other class takes notice.
    std::uint64_t planted = 0;
    for (std::size_t i = 0; i < e.classes.size(); ++i)
        if (e.classes[i] == ErrorClass::terminator) run.planes[0].s[i] = 1 - run.planes[0].s[i], ++planted;
    e = smooth.explained(run);
    expect_none(interior(e.error), "at_terminator");
    EXPECT_EQ(e.error.terminator.wrong, planted);
    EXPECT_EQ(e.error.terminator.normal_away, planted);
    EXPECT_EQ(e.error.false_shadow.edge + e.error.false_light.edge, 0u);
}

/// The wall and the board under a window, in a small picture, since exact area fractions are slow.
Scene under_a_window() {
    Scene scene      = wall_and_board();
    Light& window    = scene.lights[0];
    window.kind      = LightKind::rectangle;
    window.position  = {0.5f, 6, -0.5f};
    window.edge_u    = {1.6f, 0, 0};
    window.edge_v    = {0, 0, 1.6f};
    window.direction = {0, -1, 0};
    scene.width      = 200;
    scene.height     = 125;
    return scene;
}
const Stage& window_stage() {
    static const Stage stage(under_a_window());
    return stage;
}

TEST(PlantedDefects, AMissingPenumbraIsThatAlone) {
    const Stage& stage  = window_stage();
    Scene hard          = stage.scene;
    hard.lights[0].kind = LightKind::point;  // at the centre
    const Explained e   = stage.explained(stage.run("ray_traced", hard));
    expect_none(interior(e.error), "penumbra");
    EXPECT_EQ(e.error.unnamed, 0u);
    EXPECT_GT(e.error.penumbra_error.false_shadow, 100u);
    EXPECT_GT(e.error.penumbra_error.false_light, 100u);
    EXPECT_EQ(e.error.false_shadow.interior, e.error.penumbra_error.false_shadow);
    EXPECT_EQ(e.error.false_light.interior, e.error.penumbra_error.false_light);
    EXPECT_EQ(e.error.interior.penumbra, e.error.false_shadow.interior + e.error.false_light.interior);
}

TEST(PlantedDefects, NoiseIsNeitherLeakNorAcne) {
    const Stage& stage   = window_stage();
    const auto method    = parse_method("ray_traced:samples=4,sampler=random");
    const MethodRun run  = run_method(method, stage.scene, stage.facts, stage.points);
    const Explained once = stage.explained(run);
    expect_none(interior(once.error), "penumbra");
    EXPECT_EQ(once.error.noise_error.false_shadow + once.error.noise_error.false_light, 0u) << "nobody asked";

    const auto meters  = noise_runs(*run.work, stage.scene, stage.points);
    const Explained e  = explain(stage.scene, stage.points, 0, run, stage.truth, &*meters[0]);
    const Interior bad = interior(e.error);
    expect_none(bad, "penumbra");
    EXPECT_GT(e.error.noise_error.false_shadow, 100u);
    EXPECT_GT(e.error.noise_error.false_light, 100u);
    EXPECT_LT(bad.penumbra, e.error.noise_error.false_shadow + e.error.noise_error.false_light);
    EXPECT_EQ(e.error.false_shadow.interior, once.error.false_shadow.interior);
    EXPECT_EQ(e.error.false_light.interior, once.error.false_light.interior);
    ASSERT_TRUE(e.noise);
    EXPECT_GT(e.noise->rms, 0.02);
}

TEST(PlantedDefects, RandomNumbersDoNotExplainAMissingPenumbra) {
    // A method whose runs all lack the penumbra: their mean lacks it, too.
    const Stage& stage  = window_stage();
    Scene hard          = stage.scene;
    hard.lights[0].kind = LightKind::point;
    const MethodRun run = stage.run("ray_traced", hard);
    NoiseMeter meter(stage.points.size());
    for (int k = 0; k < 3; ++k) meter.add(run.planes[0].s);
    const Explained e = explain(stage.scene, stage.points, 0, run, stage.truth, &meter);
    EXPECT_EQ(e.error.noise_error.false_shadow + e.error.noise_error.false_light, 0u);
    expect_none(interior(e.error), "penumbra");
    EXPECT_GT(interior(e.error).penumbra, 200u);
}

TEST(PlantedDefects, ALeakIntoTheUmbraOfAnAreaLightIsALeak) {
    const Stage& stage = window_stage();
    Scene cracked      = stage.scene;
    for (std::uint32_t t = 0; t < 2; ++t)
        for (int k = 0; k < 3; ++k) {
            float& x = cracked.positions[cracked.triangles[cracked.objects[kRightHalf].first_triangle + t][k]].x;
            if (x == 1.5f) x = 2;
        }
    const Explained e  = stage.explained(stage.run("ray_traced:samples=256", cracked));
    const Interior bad = interior(e.error);
    EXPECT_GT(bad.leak, 50u);
    EXPECT_EQ(bad.leak, e.error.interior.umbra);
    EXPECT_EQ(bad.acne + bad.other_shadow + bad.detachment + bad.at_terminator, 0u);
}

TEST(PlantedDefects, WithinItsBracketNoPointIsWrong) {
    const Stage stage(wall_and_board());
    MethodRun truth = stage.truth, run = stage.truth;
    truth.planes[0].half_width.assign(stage.points.size(), 0.25f);
    const std::size_t a = stage.pixel(50, 150), b = stage.pixel(60, 150);
    ASSERT_EQ(truth.planes[0].s[a] + truth.planes[0].s[b], 2);
    run.planes[0].s[a] = 0.26f;
    run.planes[0].s[b] = 0.24f;
    const Explained e  = explain(stage.scene, stage.points, 0, run, truth);
    EXPECT_EQ(e.error.false_shadow.interior, 1u);
    EXPECT_EQ(e.error.max_half_width, 0.25);
}

}  // namespace
}  // namespace umbra
