// What moves: which phases a frame repeats and what they cost, that stale answers show as errors, who wins which mix.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <sstream>
#include <tuple>

#include "umbra/bench/lab/run.h"
#include "umbra/bench/studies/motion/frame_errors.h"
#include "umbra/bench/studies/motion/mix_triangle.h"
#include "umbra/bench/studies/motion/motion.h"
#include "umbra/bench/studies/motion/motion_summary.h"
#include "umbra/core/base/error.h"
#include "umbra/core/errors/error_causes.h"
#include "umbra/core/errors/visibility_error.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/core/scene/view_facts.h"
#include "umbra/tests/support/json_schema.h"
#include "umbra/tests/support/lazy_method.h"
#include "umbra/tests/support/planted_method.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

void add(Scene& scene, const char* name, const Mesh& mesh, vec3 at) {
    const Mesh placed = transformed(mesh, glm::translate(mat4(1), at));
    add_object(scene, name, placed.positions, placed.normals, placed.triangles, 0);
}

/// A floor, a box and a smaller ball on it, under the sun and a lamp.
Scene stage() {
    Scene scene;
    scene.name = "stage";
    scene.materials.push_back({.name = "grey"});
    add(scene, "ball", make_sphere(0.5f, 16, 8), {1.5f, 0.5f, 0.5f});
    add(scene, "floor", make_plane(12, 12), vec3(0));
    add(scene, "box", make_box({1, 2, 1}), {-1, 1, 0});
    Light lamp, sun;
    lamp.name = "lamp", lamp.position = {2, 5, 1};
    sun.name = "sun", sun.kind = LightKind::directional, sun.direction = {0.6f, -1, -0.3f};
    scene.lights     = {lamp, sun};
    scene.camera.eye = {1, 4, 8};
    scene.width = 64, scene.height = 48;
    return scene;
}

PreparedScene prepared(Scene scene) {
    PreparedScene p;
    p.scene  = std::move(scene);
    p.facts  = find_facts(p.scene);
    p.points = primary_points(RayScene(p.scene), p.scene, p.scene.camera, p.scene.width, p.scene.height);
    return p;
}

// ---- Animations

TEST(Animation, StartsWhereTheSceneIsBitForBitAndMovesOneThing) {
    const Scene start      = stage();
    const SceneFacts facts = find_facts(start);
    for (const Movement movement : kMovements) {
        const Animation animation(start, facts, movement);
        ASSERT_EQ(animation.cannot(), "");
        EXPECT_FALSE(animation.what().empty());
        Scene scene = start;
        animation.pose(scene, 0.7);
        EXPECT_EQ(scene.camera.eye != start.camera.eye, movement == Movement::camera);
        EXPECT_EQ(scene.lights[0].position != start.lights[0].position, movement == Movement::light);
        EXPECT_EQ(scene.lights[1].direction, start.lights[1].direction);
        EXPECT_EQ(scene.positions != start.positions, movement == Movement::object);
        animation.pose(scene, 0);
        EXPECT_EQ(scene.camera.eye, start.camera.eye);
        EXPECT_EQ(scene.lights[0].position, start.lights[0].position);
        EXPECT_EQ(scene.positions, start.positions);
        EXPECT_EQ(scene.normals, start.normals);
    }
}

TEST(Animation, IsRigid) {
    const Scene start      = stage();
    const SceneFacts facts = find_facts(start);
    Scene scene            = start;
    Animation(start, facts, Movement::camera).pose(scene, 1);
    EXPECT_NEAR(glm::distance(scene.camera.eye, start.camera.target),
                glm::distance(start.camera.eye, start.camera.target), 1e-5);
    EXPECT_EQ(scene.camera.eye.y, start.camera.eye.y) << "the eye keeps its height";
    const vec3 before = start.camera.eye - start.camera.target, after = scene.camera.eye - start.camera.target;
    EXPECT_NEAR(glm::degrees(std::acos(
                    glm::dot(glm::normalize(vec2(before.x, before.z)), glm::normalize(vec2(after.x, after.z))))),
                kArc, 1e-3);

    Animation(start, facts, Movement::object).pose(scene, 0.5);
    const Object& box = start.objects[2];
    for (TriangleId t = 0; t < start.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const bool moves = t >= box.first_triangle && t < box.first_triangle + box.triangle_count;
            EXPECT_EQ(scene.vertex(t, k) != start.vertex(t, k), moves) << "the box, the larger of the two bodies";
            EXPECT_EQ(scene.vertex(t, k).y, start.vertex(t, k).y) << "heights keep their bits";
            EXPECT_NEAR(glm::distance(scene.vertex(t, k), scene.vertex(t, (k + 1) % 3)),
                        glm::distance(start.vertex(t, k), start.vertex(t, (k + 1) % 3)), 1e-5);
        }
}

TEST(Animation, ALightAboveTheTargetMovesToo) {
    Scene scene              = stage();
    scene.lights[0].position = {0, 6, 0};
    const Scene start        = scene;
    const Animation animation(start, find_facts(start), Movement::light);
    animation.pose(scene, 1);
    EXPECT_GT(glm::distance(scene.lights[0].position, start.lights[0].position), 4.0f);
    EXPECT_NEAR(glm::length(scene.lights[0].position), 6, 1e-5);
}

TEST(Animation, ARectangleStaysARectangle) {
    Scene scene       = stage();
    Light& light      = scene.lights[0];
    light.kind        = LightKind::rectangle;
    light.edge_u      = {0, 0, 2};
    light.edge_v      = {1, 0, 0};
    light.direction   = {0, 1, 0};
    const Scene start = scene;
    Animation(start, find_facts(start), Movement::light).pose(scene, 1);
    EXPECT_NEAR(glm::length(light.edge_u), 2, 1e-6);
    EXPECT_NEAR(glm::length(light.edge_v), 1, 1e-6);
    EXPECT_NEAR(glm::dot(light.edge_u, light.edge_v), 0, 1e-6);
    EXPECT_NEAR(glm::dot(light.direction, glm::normalize(glm::cross(light.edge_u, light.edge_v))), 1, 1e-6);
    EXPECT_NE(light.edge_u, start.lights[0].edge_u);
}

TEST(Animation, SaysWhyASceneCannotHaveIt) {
    Scene one;
    one.materials.push_back({.name = "grey"});
    add(one, "floor", make_plane(4, 4), vec3(0));
    const Animation lone(one, find_facts(one), Movement::object);
    EXPECT_NE(lone.cannot().find("one object"), std::string::npos) << lone.cannot();
    EXPECT_NE(Animation(one, find_facts(one), Movement::light).cannot().find("no light"), std::string::npos);

    // Two objects that share an edge cannot move apart.
    Scene shared = one;
    shared.triangles.push_back({0, 1, std::uint32_t(shared.positions.size())});
    shared.positions.emplace_back(0, 1, 0);
    shared.normals.emplace_back(0);
    shared.triangle_object.push_back(1);
    shared.objects.push_back({"flap", 2, 1, 0});
    const Animation flap(shared, find_facts(shared), Movement::object);
    EXPECT_NE(flap.cannot().find("shares vertices"), std::string::npos) << flap.cannot();

    // A light that is fixed to the camera moves with it: not a movement of the camera alone.
    Scene fixed                 = stage();
    fixed.lights[0].camera_pose = LightPose{};
    const Animation camera(fixed, find_facts(fixed), Movement::camera);
    EXPECT_NE(camera.cannot().find("is fixed to the camera"), std::string::npos) << camera.cannot();
    Scene posed = fixed;
    Animation(fixed, find_facts(fixed), Movement::light).pose(posed, 0.5);
    EXPECT_FALSE(posed.lights[0].camera_pose) << "it leaves the camera";
}

TEST(ViewFacts, AreThoseOfTheSceneAsItIs) {
    Scene scene      = stage();
    SceneFacts facts = find_facts(scene);
    EXPECT_FALSE(facts.eye_inside_closed_object);
    scene.camera.eye = {-1, 1, 0};  // inside the box
    update_view_facts(scene, facts);
    EXPECT_TRUE(facts.eye_inside_closed_object);
    scene.camera.eye = scene.lights[0].position;
    update_view_facts(scene, facts);
    EXPECT_FALSE(facts.eye_inside_closed_object);
    EXPECT_EQ(facts.lights[0].place, LightPlace::at_eye);
    EXPECT_EQ(facts.lights[1].place, LightPlace::at_infinity);
}

// ---- Frames

/// Runs with a planted method whose phases take known times by a clock of the test's own.
class PlantedMotion : public testing::Test {
protected:
    static constexpr double kBuild = 7, kAim[2] = {3, 5}, kLook = 6, kVisibility[2] = {2, 4};
    using Calls = std::vector<std::pair<Phase, LightId>>;

    PlantedMotion() {
        planted_behaviour        = {};
        planted_behaviour.answer = [](LightId, std::size_t, std::size_t, int) { return PlantedAnswer{0.5f}; };
        planted_behaviour.work   = [this](Phase phase, LightId light) {
            calls_[where_].emplace_back(phase, light);
            now_ += phase == Phase::build  ? kBuild
                      : phase == Phase::aim  ? kAim[light]
                      : phase == Phase::look ? kLook
                                             : kVisibility[light];
        };
        options_.frames       = 3;
        options_.still.rounds = 3;
        options_.still.clock  = [this] { return now_; };
        options_.progress     = [this](const std::string& what) { where_ = what; };
    }
    ~PlantedMotion() override { planted_behaviour = {}; }

    [[nodiscard]] SceneMotion run() const { return run_motion(prepared(stage()), {MethodChoice(info_)}, options_); }

    MethodInfo info_ = planted_method();
    MotionOptions options_;
    double now_ = 0;
    std::string where_;
    std::map<std::string, Calls> calls_;  ///< by line of progress
};

TEST_F(PlantedMotion, EachMovementRepeatsItsPhasesAndNoOther) {
    (void)run();
    const Calls camera{{Phase::look, 0}, {Phase::visibility, 0}, {Phase::visibility, 1}};
    const Calls light{{Phase::aim, 0}, {Phase::visibility, 0}, {Phase::visibility, 1}};
    const Calls object{{Phase::build, 0},      {Phase::look, 0}, {Phase::aim, 0},
                       {Phase::visibility, 0}, {Phase::aim, 1},  {Phase::visibility, 1}};
    for (int frame = 1; frame <= 3; ++frame) {
        // What precedes the next movement is run under the last line of the one before.
        if (frame < 3) {
            EXPECT_EQ(calls_[fmt::format("stage: camera, frame {} of 3", frame)], camera);
            EXPECT_EQ(calls_[fmt::format("stage: light, frame {} of 3", frame)], light);
        }
        EXPECT_EQ(calls_[fmt::format("stage: object, frame {} of 3", frame)], object);
    }
}

/// Of aims that are too large to be kept together, each runs once in a frame, and not within the time of visibility.
TEST_F(PlantedMotion, LargeAimsRunOnceAFrame) {
    planted_behaviour.memory_bytes = std::size_t{1} << 30;
    (void)run();
    const Calls object{{Phase::build, 0},      {Phase::look, 0}, {Phase::aim, 0},
                       {Phase::visibility, 0}, {Phase::aim, 1},  {Phase::visibility, 1}};
    EXPECT_EQ(calls_["stage: object, frame 2 of 3"], object);
}

TEST_F(PlantedMotion, FramesCostWhatTheirPhasesCostAndTheModelAgrees) {
    const SceneMotion motion   = run();
    const MethodMotion& method = motion.methods[0];
    ASSERT_FALSE(method.failed) << *method.failed;
    const double visibility = kVisibility[0] + kVisibility[1];
    const std::map<Movement, double> expected{{Movement::camera, kLook + visibility},
                                              {Movement::light, kAim[0] + visibility},
                                              {Movement::object, kBuild + kAim[0] + kAim[1] + kLook + visibility}};
    for (const auto& [movement, ms] : expected) {
        EXPECT_EQ(frame_times(method, movement), std::vector<double>(3, ms)) << to_string(movement);
        EXPECT_EQ(model_ms(motion, method, movement), ms) << to_string(movement);
    }
    const Json json = to_record(scene_motion_record(motion, 0.02));
    for (const char* movement : {"camera", "light", "object"})
        EXPECT_EQ(json["methods"][0]["movements"][movement]["measured_over_model"], 1.0);
    EXPECT_EQ(json["methods"][0]["incremental"], false);
}

TEST_F(PlantedMotion, AMethodThatIsAlwaysWrongIsSoInEveryFrame) {
    const SceneMotion motion = run();
    for (const Movement movement : kMovements) {
        ASSERT_EQ(motion.methods[0].of(movement).size(), 3u);
        for (const MotionFrame& frame : motion.methods[0].of(movement)) {
            EXPECT_GT(frame.errors.points, 500u);
            EXPECT_EQ(frame.errors.rmse, 0.5) << "half of every hard light, everywhere";
            EXPECT_EQ(frame.errors.max, 0.5);
        }
    }
    EXPECT_TRUE(within(motion, 0.49).empty());
    EXPECT_EQ(within(motion, 0.5).size(), 1u);
}

TEST_F(PlantedMotion, PointsLeftOpenAreCountedAndDisqualify) {
    planted_behaviour.answer = [](LightId light, std::size_t x, std::size_t, int) {
        return PlantedAnswer{1, light == 1 || x >= 8};
    };
    const SceneMotion motion = run();
    EXPECT_TRUE(motion.methods[0].ran());
    EXPECT_GT(motion.methods[0].of(Movement::camera)[0].errors.undefined, 0u);
    EXPECT_TRUE(complete(motion).empty());
    EXPECT_FALSE(scene_motion_record(motion, 1).winners[0].complete.has_value());
}

/// Half of every light, but no answer for the first: what is left open is neither wrong nor right.
TEST_F(PlantedMotion, PointsLeftOpenAreNoErrors) {
    const FrameErrors all    = run().methods[0].of(Movement::camera)[0].errors;
    planted_behaviour.answer = [](LightId light, std::size_t, std::size_t, int) {
        return PlantedAnswer{0.5f, light == 1};
    };
    const FrameErrors part = run().methods[0].of(Movement::camera)[0].errors;
    EXPECT_GT(part.undefined, 0u);
    EXPECT_GT(part.points, 0u);
    EXPECT_EQ(part.points + part.undefined, all.points);
    EXPECT_EQ(part.wrong, 0u) << "0.5 is the tolerance";
    EXPECT_EQ(part.rmse, 0.5);
}

/// Who says that all is lit has false light alone, who says that nothing is has false shadow alone: each is in
/// `interior`, and together they are wrong once at every point but the two at the torus's terminator.
TEST_F(PlantedMotion, ErrorsOfBothKindsCount) {
    const auto errors = [&](float s) {
        planted_behaviour.answer = [=](LightId, std::size_t, std::size_t, int) { return PlantedAnswer{s}; };
        return run().methods[0].of(Movement::camera)[0].errors;
    };
    const FrameErrors light = errors(1), shadow = errors(0);
    EXPECT_GT(light.interior.value(), 0u);
    EXPECT_GT(shadow.interior.value(), 0u);
    EXPECT_LE(light.interior.value(), light.wrong);
    EXPECT_LE(shadow.interior.value(), shadow.wrong);
    EXPECT_EQ(light.wrong + shadow.wrong, light.points - 2);
    EXPECT_EQ(light.points, shadow.points);
}

/// On smooth bodies of few triangles: nothing is wrong where the sum multiplies S_j by 0, as in `umbra compare`.
TEST(FrameTruth, CountsWhatCompareCounts) {
    const PreparedScene self_shadow = prepare_scene(std::filesystem::path(UMBRA_SCENES) / "self_shadow.json", {96, 54});
    const auto& [scene, facts, points] = std::tie(self_shadow.scene, self_shadow.facts, self_shadow.points);
    const Reference reference          = default_reference(facts);
    const MethodRun truth              = run_method(reference.choice, scene, facts, points);
    VisibilityPlane turned(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        turned.s[i]      = 1 - truth.planes[0].s[i];
        turned.answer[i] = truth.planes[0].answer[i];
    }
    ClassPlane classes = error_classes(points, 0, turned, truth.planes[0], kHardTolerance);
    mark_terminator(classes, scene, points, 0);
    const VisibilityError e  = count_errors(points, classes, turned, truth.planes[0]);
    const FrameErrors errors = FrameTruth(reference, scene, facts, points, 100).errors({turned});
    EXPECT_GT(e.terminator.wrong, 0u);
    EXPECT_EQ(errors.points, e.points);
    EXPECT_EQ(errors.wrong, e.points - e.terminator.wrong);
    EXPECT_EQ(errors.interior.value(), e.false_shadow.interior + e.false_light.interior);
    EXPECT_EQ(errors.rmse, 1);
}

TEST_F(PlantedMotion, OneFrameHasNoInterval) {
    options_.frames = 1;
    const Json json =
        to_record(scene_motion_record(run(), 0.02))["methods"][0]["movements"]["light"]["frame_over_model"];
    EXPECT_EQ(json["pairs"], 1);
    EXPECT_TRUE(json["interval"][0].is_null());
    EXPECT_TRUE(json["interval"][1].is_null());
}

TEST_F(PlantedMotion, AMethodThatThrowsEndsThereAndTheOthersGoOn) {
    const auto work        = planted_behaviour.work;
    planted_behaviour.work = [&](Phase phase, LightId light) {
        work(phase, light);
        if (where_ == "stage: light, frame 2 of 3" && phase == Phase::aim) throw std::runtime_error("a planted defect");
    };
    const SceneMotion motion =
        run_motion(prepared(stage()), {MethodChoice(info_), parse_method("ray_traced")}, options_);
    ASSERT_TRUE(motion.methods[0].failed);
    EXPECT_EQ(*motion.methods[0].failed, "light, frame 2: a planted defect");
    EXPECT_EQ(motion.methods[0].of(Movement::light).size(), 1u);
    EXPECT_FALSE(motion.methods[1].failed);
    EXPECT_EQ(motion.methods[1].of(Movement::object).size(), 3u);
    EXPECT_EQ(complete(motion), (std::vector<std::size_t>{1}));
}

// ---- Stale answers

/// Wrong points by movement, over all frames and lights, of `what` under lazy_behaviour.
std::map<Movement, std::uint64_t> wrong_points(const LazyBehaviour& behaviour) {
    lazy_behaviour        = behaviour;
    const MethodInfo info = lazy_method();
    MotionOptions options;
    options.frames           = 3;
    options.still.rounds     = 1;
    const SceneMotion motion = run_motion(prepared(stage()), {MethodChoice(info)}, options);
    EXPECT_FALSE(motion.methods[0].failed);
    std::map<Movement, std::uint64_t> wrong;
    for (const Movement movement : kMovements)
        for (const MotionFrame& frame : motion.methods[0].of(movement)) wrong[movement] += frame.errors.wrong;
    lazy_behaviour = {};
    return wrong;
}

TEST(Motion, WhoeverRepeatsItsPhasesIsRightInEveryFrame) {
    const auto wrong = wrong_points({});
    for (const Movement movement : kMovements) EXPECT_EQ(wrong.at(movement), 0u) << to_string(movement);
}

TEST(Motion, ASkippedAimShowsWhereTheLightMoves) {
    const auto wrong = wrong_points({.method = "shadow_zbuffer:resolution=512", .aims_once = true});
    const auto right = wrong_points({.method = "shadow_zbuffer:resolution=512"});
    EXPECT_EQ(wrong.at(Movement::camera), right.at(Movement::camera));
    EXPECT_GT(wrong.at(Movement::light), 10 * right.at(Movement::light));
}

TEST(Motion, ASkippedBuildShowsWhereTheObjectMoves) {
    const auto wrong = wrong_points({.method = "ray_traced", .builds_once = true});
    EXPECT_EQ(wrong.at(Movement::camera), 0u);
    EXPECT_EQ(wrong.at(Movement::light), 0u);
    EXPECT_GT(wrong.at(Movement::object), 100u);
}

TEST(Motion, AreaLightsAreComparedAtASampleOfEachFrame) {
    Scene scene  = stage();
    Light& light = scene.lights[0];
    light.kind   = LightKind::sphere;
    light.radius = 1;
    scene.lights.resize(1);
    MotionOptions options;
    options.frames       = 2;
    options.area_points  = 256;
    options.still.rounds = 1;
    const SceneMotion motion =
        run_motion(prepared(std::move(scene)), {parse_method("exact"), parse_method("ray_traced:samples=1")}, options);
    EXPECT_TRUE(motion.record.reference.sampled);
    for (const Movement movement : kMovements)
        for (std::size_t k = 0; k < 2; ++k) {
            const FrameErrors &exact = motion.methods[0].of(movement)[k].errors,
                              &rays  = motion.methods[1].of(movement)[k].errors;
            EXPECT_GT(exact.points, 100u);
            EXPECT_LT(exact.points, 600u);
            EXPECT_LT(exact.max, 1e-3) << "the same method, kept and from nothing";
            EXPECT_GT(rays.rmse, 0.02);
            EXPECT_FALSE(exact.interior);
        }
}

// ---- Winners

/// Methods "planted", "planted:seed=1", ... with these times of build, aim, look, visibility at rest and a frame, always
/// the same.
SceneMotion made_up(const std::vector<std::array<double, 4>>& phases) {
    static const MethodInfo info = planted_method();
    SceneMotion motion{.record = {.lights    = {{.name = "lamp", .kind = "point"}},
                                  .reference = {.method = "planted", .exact = true},
                                  .noise_bar = 0.05,
                                  .movements = std::vector<MovementRecord>(kMovements.size())}};
    for (const auto& [build, aim, look, visibility] : phases) {
        MethodMotion method{.still = {.choice = MethodChoice(info)}};
        method.still.choice.settings.set("seed", double(motion.methods.size()));
        method.still.build = std::vector<double>(4, build);
        method.still.aim = std::vector<double>(4, aim), method.still.light_aim = {method.still.aim};
        method.still.look       = std::vector<double>(4, look);
        method.still.visibility = std::vector<double>(4, visibility);
        method.frames[0].assign(6, {{0, {0}, look, {visibility}}, {}});
        method.frames[1].assign(6, {{0, {aim}, 0, {visibility}}, {}});
        method.frames[2].assign(6, {{build, {aim}, look, {visibility}}, {}});
        motion.methods.push_back(std::move(method));
    }
    return motion;
}

TEST(MotionSummary, WinnersFollowWhatMoves) {
    const SceneMotion motion = made_up({{10, 0, 0.5, 0.5}, {0, 4, 0, 2}, {0, 0, 1, 2}});
    const auto first         = [&](const std::array<double, 3>& share) {
        const std::optional<WinnerRecord> won = winner(motion, complete(motion), {"", share});
        return std::pair(won->method, won->ms);
    };
    const std::string one = "planted", three = "planted:seed=2";
    EXPECT_EQ(first({1, 0, 0}), std::pair(one, 1.0));
    EXPECT_EQ(first({0, 1, 0}), std::pair(one, 0.5)) << "a light that moves repeats no look";
    EXPECT_EQ(first({0, 0, 1}), std::pair(three, 3.0));
    EXPECT_EQ(first({0.5, 0, 0.5}), std::pair(three, 3.0));
    EXPECT_EQ(first({0.9, 0, 0.1}), std::pair(one, 2.0));
    const std::optional<WinnerRecord> won = winner(motion, complete(motion), {"", {1, 0, 0}});
    EXPECT_EQ(won->runner_up, "planted:seed=1");
    EXPECT_EQ(won->runner_up_over_winner->median, 2);
    EXPECT_TRUE(won->ties.empty());
    EXPECT_FALSE(winner(motion, {}, {"", {1, 0, 0}}));
}

/// One slow frame of sixteen: the mean of the first is 45 / 16, its median 1, and the model says 1.
TEST(MotionSummary, OneStatisticSaysWhoWinsAndByHowMuch) {
    SceneMotion motion = made_up({{10, 0, 0.5, 0.5}, {0, 4, 0, 2}});
    MethodInfo other   = planted_method();
    other.name         = "other";

    motion.methods[1].still.choice = MethodChoice(other);
    for (MethodMotion& method : motion.methods)
        for (auto& frames : method.frames) frames.resize(16, frames.front());
    motion.methods[0].frames[0].back().times.visibility = {29.5};
    const std::optional<WinnerRecord> won               = winner(motion, complete(motion), {"", {1, 0, 0}});
    const RatioRecord& behind                           = won->runner_up_over_winner.value();
    EXPECT_EQ(won->method, "planted");
    EXPECT_EQ(won->ms, 1);
    EXPECT_EQ(won->runner_up, "other");
    EXPECT_EQ(behind.median, 2) << "its time over the winner's";
    EXPECT_LE(behind.interval[0], 2);
    EXPECT_GE(behind.interval[1], 2);
    EXPECT_EQ(behind.pairs, 16u);
    // Half of the frames move the light: 0.5 * 1 + 0.5 * 0.5 against 0.5 * 2 + 0.5 * 6.
    const std::optional<WinnerRecord> mixed = winner(motion, complete(motion), {"", {0.5, 0.5, 0}});
    EXPECT_EQ(mixed->ms, 0.75);
    EXPECT_NEAR(mixed->runner_up_over_winner->median, 4 / 0.75, 1e-12);
    // One in ten: 0.9 * 1 + 0.1 * 0.5 against 0.9 * 2 + 0.1 * 6, frame by frame.
    EXPECT_NEAR(winner(motion, complete(motion), {"", {0.9, 0.1, 0}})->runner_up_over_winner->median, 2.4 / 0.95,
                1e-12);
    EXPECT_NEAR(behind.coverage, 1 - 2 * (1 + 16 + 120 + 560) / 65536.0, 1e-12) << "the fourth least of 16";

    const Json json    = to_record(scene_motion_record(motion, 0.02));
    const Json &camera = json["methods"][0]["movements"]["camera"], &ratio = camera["frame_over_model"];
    EXPECT_EQ(camera["median_ms"], 1.0);
    EXPECT_NEAR(camera["mean_ms"].get<double>(), 45.0 / 16, 1e-12);
    EXPECT_EQ(ratio["median"], 1.0);
    EXPECT_LE(ratio["interval"][0], 1.0);
    EXPECT_GE(ratio["interval"][1], 1.0);
    EXPECT_EQ(json["winners"][0]["complete"]["ms"], 1.0);
    EXPECT_EQ(json["winners"][0]["complete"]["runner_up_over_winner"]["median"], 2.0);
    const MotionRecord record{.machine      = {.cpu = "A CPU", .threads = 2},
                              .load_average = {1, 1},
                              .frames       = 16,
                              .max_rmse     = 0.02,
                              .motion       = {scene_motion_record(motion, 0.02)}};
    MotionRecord unknown = record;
    for (SceneMotionRecord& scene : unknown.motion) scene.noise_bar = kUnknown;
    EXPECT_NE(motion_table(unknown).find("| not ranked"), std::string::npos);
    const std::string table = motion_table(record);
    EXPECT_NE(table.find("camera         1.00       1.00     1.00"), std::string::npos) << table;
    EXPECT_NE(table.find("times that differ by less than 5 % are equal"), std::string::npos) << table;
    const auto row = [](const char* mix, const char* first) {
        return fmt::format("  {:28} {:60} | {}\n", mix, first, first);
    };
    // Objects: 10 + 0.5 + 0.5 against 4 + 2.
    EXPECT_NE(table.find(row("camera", "planted 1.00 ms (next: other, x 2.00)")), std::string::npos) << table;
    EXPECT_NE(table.find(row("camera and light in turns", "planted 0.75 ms (next: other, x 5.33)")), std::string::npos);
    EXPECT_NE(table.find(row("object", "other 6.00 ms (next: planted, x 1.83)")), std::string::npos) << table;

    motion.record.noise_bar = 1.5;
    MotionRecord noisy      = record;
    noisy.motion[0]         = scene_motion_record(motion, 0.02);
    const std::string equal = motion_table(noisy);
    EXPECT_NE(equal.find(row("camera", "not ranked")), std::string::npos) << equal;
}

TEST(MotionSummary, TheModelIsOfTheMediansAtRest) {
    SceneMotion motion                 = made_up({{10, 3, 0.5, 2}});
    motion.methods[0].still.visibility = {2, 4, 90};
    motion.methods[0].still.look       = {70, 6, 5};
    motion.methods[0].still.light_aim  = {{8, 1, 2}};
    EXPECT_EQ(model_ms(motion, motion.methods[0], Movement::camera), 6 + 4);
    EXPECT_EQ(model_ms(motion, motion.methods[0], Movement::light), 2 + 4);
}

/// The worst frame is in the middle.
TEST(MotionSummary, ErrorsAreTheMeanAndTheWorstOfTheFrames) {
    SceneMotion motion               = made_up({{1, 1, 1, 1}});
    std::vector<MotionFrame>& frames = motion.methods[0].frames[0];
    frames.resize(3);
    frames[0].errors = {.points = 10, .undefined = 1, .wrong = 2, .interior = 3, .rmse = 0.1, .max = 0.2};
    frames[1].errors = {.points = 10, .undefined = 2, .wrong = 2, .interior = 4, .rmse = 0.4, .max = 0.5};
    frames[2].errors = {.points = 10, .undefined = 4, .wrong = 2, .interior = 5, .rmse = 0.1, .max = 0.2};
    const Json json  = to_record(scene_motion_record(motion, 0.02))["methods"][0]["movements"]["camera"];
    EXPECT_NEAR(json["mean_rmse"].get<double>(), 0.2, 1e-15);
    EXPECT_EQ(json["worst_rmse"], 0.4);
    EXPECT_EQ(json["undefined"], 7);
    EXPECT_EQ(json["interior"], 12);
    EXPECT_EQ(json["frames"][1]["rmse"], 0.4);
    EXPECT_EQ(json["frames"][1]["wrong"], 2);

    for (MotionFrame& frame : frames) frame.errors.undefined = 0;
    EXPECT_TRUE(within(motion, 0.39).empty()) << "one frame is enough";
    EXPECT_EQ(within(motion, 0.4).size(), 1u);
}

/// Two frames of six have an answer at a quarter of their points, four have none anywhere.
TEST(MotionSummary, ErrorsOfAPartAreLabelledSo) {
    SceneMotion motion               = made_up({{1, 1, 1, 1}});
    std::vector<MotionFrame>& frames = motion.methods[0].frames[0];
    for (MotionFrame& frame : frames) frame.errors = {.points = 0, .undefined = 40, .interior = 0};
    frames[1].errors = frames[4].errors = {.points = 30, .undefined = 90, .wrong = 2, .interior = 1, .rmse = 0.3};
    Json json                           = to_record(scene_motion_record(motion, 0.02));
    const Json& part                    = json["methods"][0]["movements"]["camera"];
    EXPECT_NEAR(part["mean_rmse"].get<double>(), 0.3, 1e-15);
    EXPECT_NEAR(part["worst_rmse"].get<double>(), 0.3, 1e-15);
    EXPECT_TRUE(part["frames"][0]["rmse"].is_null());
    EXPECT_EQ(part["frames"][1]["rmse"], 0.3);

    for (MotionFrame& frame : motion.methods[0].frames[1])
        frame.errors = {.points = 0, .undefined = 40, .interior = {}};
    json             = to_record(scene_motion_record(motion, 0.02));
    const Json& none = json["methods"][0]["movements"]["light"];
    EXPECT_TRUE(none["mean_rmse"].is_null());
    EXPECT_TRUE(none["worst_rmse"].is_null());
    const MotionRecord record{.head         = {.version = "0", .command = "umbra motion"},
                              .machine      = {.cpu = "A CPU", .threads = 1},
                              .load_average = {1, 1},
                              .frames       = 6,
                              .arc_degrees  = 45,
                              .max_rmse     = 0.02,
                              .motion       = {scene_motion_record(motion, 0.02)}};
    const std::string table = motion_table(record);
    // 60 of 60 + 180 + 160.
    EXPECT_NE(table.find("15 %\n"), std::string::npos) << table;
    EXPECT_NE(table.find("0 %\n"), std::string::npos) << table;
    EXPECT_NE(table.find("A CPU, 1 thread, load"), std::string::npos) << table;
    const TemporaryFolder folder;
    StagedFiles staged;
    write_motion_page(record, folder.path(), staged);
    staged.commit();
    std::ifstream in(folder.path() / "index.html");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    EXPECT_NE(page.find("<td>0.300<small>of 15 % of the points</small></td>"), std::string::npos);
    EXPECT_NE(page.find("<td>–<small>of 0 % of the points</small></td>"), std::string::npos);
    EXPECT_NE(page.find("with 1 thread, load"), std::string::npos);
}

TEST(MotionSummary, WhatTheNoiseBarCoversIsATie) {
    const auto ties = [](double other) {
        const SceneMotion motion = made_up({{1, 1, 0.25, 0.75}, {1, 1, 0.25, other - 0.25}});
        return winner(motion, complete(motion), {"", {1, 0, 0}})->ties.size();
    };
    EXPECT_EQ(ties(1.04), 1u);
    EXPECT_EQ(ties(1.06), 0u);
}

TEST(MotionSummary, ABuildPaysOffAfterItsFrames) {
    const SceneMotion motion                 = made_up({{10, 1, 0.5, 0.5}, {0, 1, 1.5, 2}, {20, 0, 0, 4}});
    const std::vector<BreakEvenRecord> pairs = break_evens(motion, complete(motion));
    ASSERT_EQ(pairs.size(), 1u) << "the third is behind the others in both";
    EXPECT_EQ(pairs[0].method, "planted");
    EXPECT_EQ(pairs[0].over, "planted:seed=1");
    EXPECT_EQ(pairs[0].setup_ms, 10);
    EXPECT_EQ(pairs[0].saves_ms, 2.5);
    EXPECT_EQ(pairs[0].frames, 4);
    EXPECT_EQ(pairs[0].rounds, (std::vector<double>{4, 4}));
}

/// 11 against 9.2 until the first frame: 1.196 times as long.
TEST(MotionSummary, NothingPaysOffInNoise) {
    SceneMotion motion      = made_up({{10, 1, 0.5, 0.5}, {8.2, 1, 1.5, 2}});
    motion.record.noise_bar = 0.19;
    EXPECT_EQ(break_evens(motion, complete(motion)).size(), 1u);
    motion.record.noise_bar = 0.2;
    EXPECT_TRUE(break_evens(motion, complete(motion)).empty());
    motion                  = made_up({{10, 1, 0.5, 0.5}, {0, 1, 1.5, 2}});
    motion.record.noise_bar = 0.31;
    EXPECT_TRUE(break_evens(motion, complete(motion)).empty()) << "nothing is ranked there";
}

TEST(MotionSummary, MixesOfAMovementThatCannotBeAreLeftOut) {
    SceneMotion motion                = made_up({{1, 1, 0, 1}});
    motion.record.movements[2].cannot = "no";
    std::size_t left                  = 0;
    for (const Mix& mix : canonical_mixes()) {
        EXPECT_NEAR(mix.share[0] + mix.share[1] + mix.share[2], 1, 1e-15);
        EXPECT_EQ(has(motion, mix), mix.share[2] == 0) << mix.name;
        left += has(motion, mix);
    }
    EXPECT_EQ(left, 4u);
}

TEST(MixTriangle, RegionsAreWhereNobodyIsFaster) {
    // Of 1 + 2 w and 2 the second is less from w = 1/2 on: a quarter of the triangle.
    const std::vector<MixRegion> two = mix_regions({{1, 1, 3}, {2, 2, 2}});
    ASSERT_EQ(two.size(), 2u);
    EXPECT_NEAR(two[0].area, 0.75, 1e-12);
    EXPECT_NEAR(two[1].area, 0.25, 1e-12);
    EXPECT_EQ(two[0].corners.size(), 4u);
    EXPECT_EQ(two[1].corners.size(), 3u);

    const std::vector<CornerTimes> many{{1, 9, 9}, {9, 1, 9}, {9, 9, 1}, {4, 4, 4}, {5, 5, 5}, {4, 4, 4}};
    double area = 0;
    for (const MixRegion& region : mix_regions(many)) {
        EXPECT_LT(region.method, 4u) << "one is slower everywhere, one the same as another";
        area += region.area;
        const auto time = [&](std::size_t m, const Shares& at) {
            return many[m][0] * at[0] + many[m][1] * at[1] + many[m][2] * at[2];
        };
        for (const Shares& corner : region.corners)
            for (std::size_t m = 0; m < many.size(); ++m)
                EXPECT_LE(time(region.method, corner), time(m, corner) + 1e-12);
    }
    EXPECT_NEAR(area, 1, 1e-12);
    EXPECT_TRUE(mix_regions({}).empty());
}

// ---- The command

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// Whether a record fits the schema of motion.
testing::AssertionResult fits_motion(const std::string& text) { return fits(schema_of<MotionRecord>("").dump(), text); }

class MotionFiles : public testing::Test {
protected:
    MotionFiles() {
        command_.methods              = {"shadow_zbuffer:resolution=256", "shadow_volumes", "planar_projection"};
        command_.size                 = {64, 36};
        command_.out                  = folder_.path() / "out";
        command_.command              = "umbra motion";
        command_.options.frames       = 2;
        command_.options.still.rounds = 2;
    }
    [[nodiscard]] static fs::path scene(const char* name) {
        return fs::path(UMBRA_SCENES) / (std::string(name) + ".json");
    }
    TemporaryFolder folder_;
    MotionCommand command_;
};

TEST_F(MotionFiles, WriteWhatTheSchemaSaysAndAPage) {
    std::vector<std::string> unreadable;
    const MotionRecord measured = measure_motion(
        {scene("sun_on_plane"), folder_.path() / "none.json", scene("six_lights")}, command_, unreadable);
    const Json record = to_record(measured);
    EXPECT_EQ(unreadable.size(), 1u);
    ASSERT_EQ(record["motion"].size(), 2u);
    EXPECT_TRUE(record["failed"].empty());
    const std::string written = text_of(command_.out / "results.json");
    EXPECT_EQ(Json::parse(written), record);
    EXPECT_TRUE(fits_motion(written));
    for (const Json& method : record["motion"][0]["methods"])
        for (const char* movement : {"camera", "light", "object"})
            EXPECT_EQ(method["movements"][movement]["frames"].size(), 2u);
    EXPECT_EQ(record["motion"][1]["methods"][0]["movements"]["light"]["frames"][0]["aim_ms"].size(), 6u);
    // Planar projection leaves bodies open: it does not compete.
    for (const Json& row : record["motion"][0]["winners"])
        EXPECT_NE(row["complete"]["method"], "planar_projection") << row;

    const auto page_at = [&](double noise_bar) {
        MotionRecord other = measured;
        for (SceneMotionRecord& scene : other.motion) scene.noise_bar = noise_bar;
        StagedFiles staged;
        write_motion_page(other, command_.out, staged);
        staged.commit();
        return text_of(command_.out / "index.html");
    };
    const std::string loud = page_at(0.4), page = page_at(0.05);
    EXPECT_EQ(loud.find("<svg viewBox=\"0 0 440 340\""), std::string::npos) << "nothing is ranked below the noise";
    EXPECT_NE(loud.find("too much to say which method is fastest"), std::string::npos);
    EXPECT_NE(loud.find(">not ranked</td>"), std::string::npos);
    EXPECT_EQ(page.find(">not ranked</td>"), std::string::npos);
    EXPECT_NE(page.find("<svg viewBox=\"0 0 440 340\""), std::string::npos);
    EXPECT_NE(page.find("A light at infinity over one plane"), std::string::npos);
    EXPECT_EQ(page.find("{{"), std::string::npos);
    EXPECT_EQ(page.find("<script"), std::string::npos);
    // A narrow page may break a row's head between the words of its method.
    EXPECT_NE(page.find("<th scope=\"row\"><code>shadow_<wbr>volumes</code>"), std::string::npos);
    EXPECT_EQ(page.find("<td><code>shadow_<wbr>"), std::string::npos);
    EXPECT_TRUE(fs::exists(command_.out / "report.css"));
    MotionRecord unknown = measured;
    for (SceneMotionRecord& scene : unknown.motion) scene.noise_bar = kUnknown;
    EXPECT_NE(motion_table(unknown).find("| not ranked"), std::string::npos);
    const std::string table = motion_table(measured);
    EXPECT_NE(table.find("camera and light in turns"), std::string::npos);
    EXPECT_NE(table.find("shadow_volumes"), std::string::npos);
}

TEST_F(MotionFiles, SchemaRefusesWhatItShould) {
    std::vector<std::string> unreadable;
    command_.methods        = {"shadow_volumes"};
    const Json record       = to_record(measure_motion({scene("sun_on_plane")}, command_, unreadable));
    const auto fits_without = [&](const char* pointer) {
        Json changed = record;
        Json::json_pointer at(pointer);
        const std::string key = at.back();
        at.pop_back();
        EXPECT_TRUE(changed.at(at).contains(key)) << pointer;
        changed.at(at).erase(key);
        return fits_motion(changed.dump());
    };
    EXPECT_FALSE(fits_without("/motion/0/methods/0/incremental"));
    EXPECT_FALSE(fits_without("/motion/0/methods/0/movements/light/frames/1/rmse"));
    Json changed                   = record;
    changed["motion"][0]["winner"] = 1;
    EXPECT_FALSE(fits_motion(changed.dump()));
}

TEST_F(MotionFiles, RecordWhatFailsAndRefuseWhatCannotBe) {
    std::vector<std::string> unreadable;
    planted_behaviour        = {};
    planted_behaviour.answer = [](LightId, std::size_t, std::size_t, int) { return PlantedAnswer{2}; };
    const MethodInfo broken  = planted_method();
    command_.choices         = {MethodChoice(broken)};
    const Json record        = to_record(measure_motion({scene("sun_on_plane")}, command_, unreadable));
    planted_behaviour        = {};
    ASSERT_EQ(record["failed"].size(), 1u);
    EXPECT_EQ(record["failed"][0]["method"], "planted");
    EXPECT_NE(record["failed"][0]["message"].get<std::string>().find("contract"), std::string::npos);
    EXPECT_EQ(record["motion"][0]["methods"].size(), 4u);
    EXPECT_TRUE(fits_motion(record.dump()));
    EXPECT_NE(text_of(command_.out / "index.html").find("breaks its contract"), std::string::npos);

    command_.choices.clear();
    command_.methods = {"ray_traced:measure=irradiance"};
    EXPECT_THROW((void)measure_motion({scene("umbra_penumbra")}, command_, unreadable), UsageError);
    command_.methods = {"ray_traced:samples=none"};
    EXPECT_THROW((void)measure_motion({scene("sun_on_plane")}, command_, unreadable), UsageError);
}

}  // namespace
}  // namespace umbra
