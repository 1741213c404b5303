// Every method on every scene whose answer is known, and what the contract asks of all methods.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <thread>

#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/known_scenes.h"
#include "umbra/tests/support/method_case.h"
#include "umbra/tests/support/phase_values.h"

namespace umbra {
namespace {

/// Share of the points that a method may get wrong outside the edge band where it says that it only approximates.
constexpr double kApproximateShare = 0.01;

/// The first point that is wrong outside the edge band, in words.
std::string first_wrong(const Scene& scene, const PointBatch& points, LightId light, const VisibilityPlane& got,
                        const VisibilityPlane& known, float tolerance) {
    const auto band = edge_band(points, light, known, tolerance);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, light, i) || !got.defined(i) || !known.defined(i) || band[i]) continue;
        if (std::abs(got.s[i] - known.s[i]) <= tolerance) continue;
        const dvec3 p     = place(scene, points, i);
        const auto pixels = static_cast<std::size_t>(points.raster->width);
        return fmt::format("pixel {} {} at ({}, {}, {}) on {}: S {} instead of {}", i % pixels, i / pixels, p.x, p.y,
                           p.z, scene.objects[scene.triangle_object[points.triangle[i]]].name, got.s[i], known.s[i]);
    }
    return "none";
}

/// The point that is most wrong, in words, of those whose S lies further from what is known than the method states;
/// anywhere, on edges of penumbrae, too.
std::string worst_beyond_bracket(const PointBatch& points, LightId light, const VisibilityPlane& got,
                                 const VisibilityPlane& known) {
    std::string said  = "none";
    double worst      = 1e-6;
    std::size_t asked = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_open(points, light, i) || got.answer[i] != Answer::given || !known.defined(i)) continue;
        ++asked;
        const auto bracket  = double(got.half_width[i]);
        const double beyond = std::abs(double(got.s[i]) - double(known.s[i])) - bracket;
        if (beyond <= worst) continue;
        worst = beyond;
        said  = fmt::format("point {}: S {} -+ {} instead of {}", i, got.s[i], bracket, known.s[i]);
    }
    return asked > 0 ? said : "no point was asked";
}

TEST(KnownScenes, BruteForceAgreesWithTheFormulas) {
    for (const NamedScene& named : known_scenes()) {
        const KnownScene known = named.make();
        if (!known.closed_form) continue;
        const PointBatch points = primary(known.scene);
        for (LightId j = 0; j < known.scene.lights.size(); ++j) {
            if (is_area(known.scene.lights[j].kind)) continue;
            const VisibilityPlane formula = by_formula(known, points, j), force = brute_force(known.scene, points, j);
            std::size_t compared = 0, wrong = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (!is_open(points, j, i) || !formula.defined(i) || !force.defined(i)) continue;
                ++compared;
                wrong += formula.s[i] != force.s[i];
            }
            EXPECT_GT(compared, 1000u) << named.name;
            EXPECT_EQ(wrong, 0u) << named.name;
        }
    }
}

TEST(KnownScenes, ShowBothLightAndShadow) {
    // A scene in which a method that always says lit (or never) would pass proves little; few may be so on purpose.
    for (const NamedScene& named : known_scenes()) {
        const KnownScene known  = named.make();
        const PointBatch points = primary(known.scene);
        for (LightId j = 0; j < known.scene.lights.size(); ++j) {
            const VisibilityPlane plane = truth(known, points, j);
            std::size_t lit = 0, umbra = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                if (!is_open(points, j, i) || !plane.defined(i)) continue;
                lit += plane.s[i] == 1;
                umbra += plane.s[i] == 0;
            }
            EXPECT_GT(lit, 200u) << named.name;
            const bool all_lit = named.name == "light_at_eye" || named.name == "light_over_wall";
            if (!all_lit && named.name != "no_anti_shadows") {
                EXPECT_GT(umbra, 40u) << named.name;
            }
        }
    }
}

class Matrix : public testing::TestWithParam<std::tuple<const MethodInfo*, NamedScene>> {};

TEST_P(Matrix, IsRight) {
    const auto& [info, named] = GetParam();
    const KnownScene known    = named.make();
    MethodCase run(*info, known.scene);
    const Service service = run.serves();
    EXPECT_FALSE(service.why.empty());
    if (!service) GTEST_SKIP() << service.why;

    const PointBatch points = primary(known.scene);
    run.build();
    for (LightId j = 0; j < known.scene.lights.size(); ++j) {
        run.aim(j);
        const VisibilityPlane got = run.visibility(points, j), right = truth(known, points, j);
        const LightKind kind    = known.scene.lights[j].kind;
        const float tolerance   = visibility_tolerance(kind);
        const VisibilityError e = visibility_error(points, j, got, right, tolerance);
        EXPECT_GT(e.points, 500u);
        const std::uint64_t interior = e.false_shadow.interior + e.false_light.interior;
        if (service.how >= How::to_rounding) {
            EXPECT_EQ(interior, 0u) << first_wrong(known.scene, points, j, got, right, tolerance);
            if (is_area(kind)) {
                EXPECT_EQ(worst_beyond_bracket(points, j, got, right), "none");
                for (const float half : got.half_width) ASSERT_LE(half, 1e-4f);
            }
        } else if (is_area(kind)) {
            EXPECT_LE(e.mae, known.approximate_mae);
        } else {
            EXPECT_LE(static_cast<double>(interior), kApproximateShare * static_cast<double>(e.points))
                << first_wrong(known.scene, points, j, got, right, tolerance);
        }
    }
}

std::string name_of(const MethodInfo* info) { return std::string(info->name); }

INSTANTIATE_TEST_SUITE_P(All, Matrix,
                         testing::Combine(testing::ValuesIn(methods().begin(), methods().end()),
                                          testing::ValuesIn(known_scenes())),
                         [](const auto& param) {
                             return name_of(std::get<0>(param.param)) + "_" +
                                    std::string(std::get<1>(param.param).name);
                         });

/// A box and a ball on a floor under two lights without an area, and under two with one.
std::array<Scene, 2> scenes_of_two_lights() {
    std::array scenes{known_scene("two_lights").scene, known_scene("two_lights").scene};
    Light &panel = scenes[1].lights[0], &bulb = scenes[1].lights[1];
    panel.kind     = LightKind::rectangle;
    panel.position = {2.5f, 4, 1};
    panel.edge_u = {1, 0, 0}, panel.edge_v = {0, 0, 1};
    panel.direction = {0, -1, 0};
    bulb.kind       = LightKind::sphere;
    bulb.radius     = 0.4f;
    return scenes;
}

void move_last_object(Scene& scene) {
    const Object& object = scene.objects.back();
    std::set<std::uint32_t> vertices;
    for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
        for (int k = 0; k < 3; ++k) vertices.insert(scene.triangles[t][k]);
    for (const std::uint32_t v : vertices) scene.positions[v] += vec3(0.3f, 0, 0.2f);
}

std::unique_ptr<const Built> build(const Method& method, const Scene& scene, const SceneFacts& facts) {
    method.warm_up(scene, facts);
    return method.build(scene, facts);
}

VisibilityPlane ask(const Method& method, const Aimed& aimed, const Looked& looked) {
    VisibilityPlane plane(looked.points.size());
    method.visibility(aimed, looked, plane.out());
    return plane;
}

/// To the bit.
void expect_same(const VisibilityPlane& got, const VisibilityPlane& expected, const std::string& what) {
    EXPECT_EQ(got.s, expected.s) << what;
    EXPECT_EQ(got.answer, expected.answer) << what;
    EXPECT_EQ(got.half_width, expected.half_width) << what;
}

/// Calls work(0) to work(threads - 1), each in a thread of its own.
void in_threads(std::size_t threads, const std::function<void(std::size_t)>& work) {
    std::vector<std::thread> running;
    for (std::size_t k = 0; k < threads; ++k) running.emplace_back(work, k);
    for (std::thread& thread : running) thread.join();
}

/// Points of the batch that the plane calls dark, as a batch without a raster.
PointBatch dark_points(const Scene& scene, const PointBatch& from, LightId light, const VisibilityPlane& plane) {
    std::vector<std::size_t> dark;
    for (std::size_t i = 0; i < from.size(); ++i)
        if (is_open(from, light, i) && plane.answer[i] == Answer::given && plane.s[i] < 1) dark.push_back(i);
    PointBatch points;
    points.eye = from.eye;
    points.resize(dark.size());
    for (std::size_t k = 0; k < dark.size(); ++k)
        set_point(points, k, scene, from.triangle[dark[k]], from.u[dark[k]], from.v[dark[k]]);
    face_lights(points, scene);
    return points;
}

/// What shadows/method.h promises, by each method, on scenes that every kind of method serves somehow.
class Contract : public testing::TestWithParam<const MethodInfo*> {
protected:
    const MethodInfo& info() const { return *GetParam(); }
    /// The scenes of two lights that the method serves.
    [[nodiscard]] std::vector<Scene> served() const {
        std::vector<Scene> found;
        for (const Scene& scene : scenes_of_two_lights())
            if (MethodCase(info(), scene).verdict()) found.push_back(scene);
        return found;
    }
};

TEST_P(Contract, AnswersAreInRangeAndClosedPointsStayUntouched) {
    for (const char* name : {"two_lights", "open_meshes", "room", "penumbra_of_half_plane"}) {
        const KnownScene known = known_scene(name);
        MethodCase run(info(), known.scene);
        if (!run.serves()) continue;
        const PointBatch points = primary(known.scene);
        for (LightId j = 0; j < known.scene.lights.size(); ++j) {
            run.prepare(j);
            const VisibilityPlane got = run.visibility(points, j);
            std::size_t defined       = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                ASSERT_GE(got.s[i], 0);
                ASSERT_LE(got.s[i], 1);
                ASSERT_LE(got.answer[i], Answer::on_boundary);
                ASSERT_GE(got.half_width[i], 0);
                ASSERT_LE(got.half_width[i], 1);
                if (!is_open(points, j, i)) {
                    ASSERT_EQ(got.s[i], 0);
                    ASSERT_EQ(got.answer[i], Answer::given);
                    ASSERT_EQ(got.half_width[i], 0);
                }
                defined += is_open(points, j, i) && got.defined(i);
                if (!is_area(known.scene.lights[j].kind) && run.serves().how >= How::to_rounding && got.defined(i)) {
                    ASSERT_TRUE(got.s[i] == 0 || got.s[i] == 1);
                }
            }
            EXPECT_GT(defined, 1000u) << name;
        }
    }
}

TEST_P(Contract, SameBitsForAnyNumberOfThreads) {
    for (const char* name : {"two_lights", "badly_oriented", "penumbra_of_half_plane"}) {
        const KnownScene known  = known_scene(name);
        const PointBatch points = primary(known.scene);
        std::vector<VisibilityPlane> planes;
        for (const int threads : {1, 2, 5}) {
            const ThreadLimit limit(threads);
            MethodCase run(info(), known.scene);
            if (!run.serves()) break;
            run.prepare(0);
            planes.push_back(run.visibility(points, 0));
            EXPECT_EQ(planes.back().s, planes.front().s) << name << " with " << threads << " threads";
            EXPECT_EQ(planes.back().answer, planes.front().answer) << name << " with " << threads << " threads";
        }
    }
}

TEST_P(Contract, ABatchWithoutARasterGetsTheSameAnswers) {
    const KnownScene known = known_scene("two_lights");
    MethodCase run(info(), known.scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    const PointBatch raster = primary(known.scene);

    // Every second point, shuffled, with some entries that are no point.
    std::vector<std::size_t> from;
    for (std::size_t i = 0; i < raster.size(); i += 2) from.push_back(i);
    std::shuffle(from.begin(), from.end(), std::mt19937(7));
    PointBatch points;
    points.eye = raster.eye;
    points.resize(from.size());
    for (std::size_t i = 0; i < from.size(); ++i)
        if (raster.triangle[from[i]] != kNoTriangle)
            set_point(points, i, known.scene, raster.triangle[from[i]], raster.u[from[i]], raster.v[from[i]]);
    face_lights(points, known.scene);

    for (LightId j = 0; j < known.scene.lights.size(); ++j) {
        run.prepare(j);
        const VisibilityPlane all = run.visibility(raster, j), some = run.visibility(points, j);
        const auto band       = edge_band(raster, j, truth(known, raster, j), kHardTolerance);
        std::size_t differing = 0, compared = 0;
        for (std::size_t i = 0; i < from.size(); ++i) {
            if (!is_open(points, j, i) || band[from[i]]) continue;
            ++compared;
            differing += all.s[from[i]] != some.s[i] || all.answer[from[i]] != some.answer[i];
        }
        EXPECT_GT(compared, 500u);
        EXPECT_EQ(differing, 0u) << "of " << compared;
    }
}

TEST_P(Contract, APickedPointHasTheAnswerThatItHasAmongOthers) {
    if (info().needs_raster) GTEST_SKIP() << "answers for whole pictures only";
    const Scene scene       = load_scene(std::string(UMBRA_SCENES) + "/umbra_penumbra.json");
    const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 48, 27);
    MethodCase run(info(), scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    std::vector<std::uint32_t> some;
    for (std::uint32_t i = 5; i < points.size(); i += 7) some.push_back(i);
    const PointBatch picked = pick(points, some);
    std::size_t partly      = 0;
    for (LightId j = 0; j < scene.lights.size(); ++j) {
        run.prepare(j);
        const VisibilityPlane all = run.visibility(points, j), alone = run.visibility(picked, j);
        for (std::size_t k = 0; k < some.size(); ++k) {
            if (!picked.asks(j, k)) continue;
            partly += all.s[some[k]] < 1;
            EXPECT_EQ(alone.s[k], all.s[some[k]]) << "point " << some[k];
            EXPECT_EQ(alone.answer[k], all.answer[some[k]]) << "point " << some[k];
        }
    }
    EXPECT_GE(partly, 5u) << "points whose answers are not all of the light";
}

TEST_P(Contract, RepeatedPhasesGiveTheSameBitsAndMemory) {
    for (const Scene& scene : served()) {
        const PointBatch points = primary(scene);
        MethodCase run(info(), scene);
        run.prepare(1);
        const VisibilityPlane once = run.visibility(points, 1);
        const std::size_t memory   = run.memory_bytes();
        run.aim(0);
        run.build();
        run.aim(1);
        expect_same(run.visibility(points, 1), once, "built again");
        EXPECT_EQ(run.memory_bytes(), memory);
    }
}

/// An aim and a look do not know of others, and one look serves all lights: in any order and from any thread.
TEST_P(Contract, LightsAimedAtTogetherAnswerAsAlone) {
    for (const Scene& scene : served()) {
        const PointBatch points = primary(scene);
        std::array<VisibilityPlane, 2> alone;
        std::array<std::vector<TriangleId>, 2> blamed_alone;
        std::array<std::size_t, 2> memory{};
        std::array<PointBatch, 2> dark;
        for (LightId j = 0; j < 2; ++j) {
            MethodCase run(info(), scene);
            run.prepare(j);
            alone[j] = run.visibility(points, j);
            dark[j]  = dark_points(scene, points, j, alone[j]);
            blamed_alone[j].resize(dark[j].size());
            run.blame(dark[j], j, blamed_alone[j]);
            memory[j] = run.memory_bytes();
        }
        EXPECT_NE(alone[0].s, alone[1].s);

        const auto method      = info().make();
        const SceneFacts facts = find_facts(scene);
        const auto built       = build(*method, scene, facts);
        const auto looked      = method->look(*built, points);
        std::array<std::unique_ptr<const Aimed>, 2> aimed;
        in_threads(2, [&](std::size_t j) { aimed[j] = method->aim(*built, LightId(j)); });
        for (const LightId j : {1u, 0u, 1u}) {
            expect_same(ask(*method, *aimed[j], *looked), alone[j], "one after the other");
            EXPECT_EQ(built->memory_bytes() + aimed[j]->memory_bytes(), memory[j]);
        }
        std::array<VisibilityPlane, 4> together;
        std::array<std::vector<TriangleId>, 4> blamed;
        in_threads(4, [&](std::size_t k) {
            const std::size_t j = k % 2;
            together[k]         = ask(*method, *aimed[j], *looked);
            blamed[k].resize(dark[j].size());
            method->blame(*aimed[j], *method->look(*built, dark[j]), blamed[k]);
        });
        for (std::size_t k = 0; k < 4; ++k) {
            expect_same(together[k], alone[k % 2], "together");
            EXPECT_EQ(blamed[k], blamed_alone[k % 2]);
        }
    }
}

/// One method, two scenes, made in two threads and asked in turns.
TEST_P(Contract, ScenesLiveSideBySide) {
    for (const Scene& scene : served()) {
        Scene other = scene;
        move_last_object(other);
        const std::array<const Scene*, 2> scenes{&scene, &other};
        std::array<VisibilityPlane, 2> alone;
        std::array<PointBatch, 2> points;
        std::array<SceneFacts, 2> facts;
        for (std::size_t k = 0; k < 2; ++k) {
            points[k] = primary(*scenes[k]);
            facts[k]  = find_facts(*scenes[k]);
            MethodCase run(info(), *scenes[k]);
            run.prepare(1);
            alone[k] = run.visibility(points[k], 1);
        }
        EXPECT_NE(alone[0].s, alone[1].s);

        const auto method = info().make();
        std::array<PhaseValues, 2> values;
        in_threads(2, [&](std::size_t k) { values[k] = make_values(*method, {*scenes[k], facts[k], points[k], 1}); });
        for (const std::size_t k : {0u, 1u, 0u})
            expect_same(ask(*method, *values[k].aimed, *values[k].looked), alone[k], "in turns");
        values[0] = {};
        expect_same(ask(*method, *values[1].aimed, *values[1].looked), alone[1], "the other is gone");
    }
}

/// What moves in the scene repeats its phases: what the others made serves as it is.
TEST_P(Contract, MovementsRepeatNoMoreThanTheirPhases) {
    for (Scene scene : served()) {
        PointBatch points            = primary(scene);
        const SceneFacts facts       = find_facts(scene);
        const auto method            = info().make();
        const auto built             = build(*method, scene, facts);
        const auto still             = method->aim(*built, 0);
        auto aimed                   = method->aim(*built, 1);
        auto looked                  = method->look(*built, points);
        const VisibilityPlane once[] = {ask(*method, *still, *looked), ask(*method, *aimed, *looked)};
        const auto from_nothing      = [&](LightId j) {
            MethodCase run(info(), scene);
            run.prepare(j);
            return run.visibility(points, j);
        };

        // A light: its own aim. The points were looked at before they faced it as they do now.
        scene.lights[1].position += is_area(scene.lights[1].kind) ? vec3(0.5f, 0.5f, 0.2f) : vec3(4, 0.5f, 0);
        face_light(points, scene, 1);
        aimed                       = method->aim(*built, 1);
        const VisibilityPlane moved = ask(*method, *aimed, *looked);
        EXPECT_NE(moved.s, once[1].s);
        expect_same(moved, from_nothing(1), "the light moved");
        expect_same(ask(*method, *still, *looked), once[0], "the other light");

        // The camera: look.
        looked.reset();
        scene.camera.eye += vec3(0.5f, 0.2f, -0.3f);
        points = primary(scene);
        looked = method->look(*built, points);
        expect_same(ask(*method, *aimed, *looked), from_nothing(1), "the camera moved");
        expect_same(ask(*method, *still, *looked), from_nothing(0), "the camera moved");

        // An object: all.
        move_last_object(scene);
        points                 = primary(scene);
        const SceneFacts after = find_facts(scene);
        const PhaseValues all  = make_values(*method, {scene, after, points, 1});
        expect_same(ask(*method, *all.aimed, *all.looked), from_nothing(1), "an object moved");
    }
}

/// Other values of a parameter that are near to this one.
std::vector<double> others(const Parameter& p, double value) {
    std::vector<double> found;
    const auto add = [&](double other) {
        if (other != value && std::ranges::find(found, other) == found.end()) found.push_back(other);
    };
    switch (p.type) {
        case Parameter::Type::boolean: add(1 - value); break;
        case Parameter::Type::choice:
            for (double k = 0; k <= static_cast<double>(std::ranges::count(p.choices, '|')); ++k) add(k);
            break;
        case Parameter::Type::integer:
            add(value < p.max ? value + 1 : value - 1);
            add(std::max(p.min, std::floor(value / 2)));
            break;
        case Parameter::Type::real:
            add(value == 0 ? std::min(p.max, 0.5) : value / 2 >= p.min ? value / 2 : std::min(p.max, 2 * value));
            break;
        case Parameter::Type::text: break;
    }
    return found;
}

/// The default, the presets but the dearest, and the default with each other choice of one parameter. Maps are small
/// and patches large, since many are made.
std::vector<MethodChoice> settings_of(const MethodInfo& info) {
    std::vector<MethodChoice> found{MethodChoice(info)};
    for (const Preset& preset : info.presets)
        if (preset.name != "best") found.push_back(parse_method(fmt::format("{}@{}", info.name, preset.name)));
    for (const auto& [name, value] : {std::pair{"resolution", 128.0}, {"size", 0.25}})
        if (std::ranges::find(info.parameters, name, &Parameter::name) != info.parameters.end())
            for (MethodChoice& choice : found) choice.settings.set(name, value);
    for (const Parameter& p : info.parameters) {
        if (p.type != Parameter::Type::choice && p.type != Parameter::Type::boolean) continue;
        for (const double other : others(p, p.fallback)) {
            found.push_back(found.front());
            found.back().settings.set(p.name, other);
        }
    }
    return found;
}

/// Nothing where the settings contradict one another.
std::unique_ptr<const Method> made(const MethodChoice& choice) {
    try {
        return choice.make();
    } catch (const UsageError&) {
        return nullptr;
    }
}

/// A parameter names the first phase that depends on it: what the phases before it made serves every other value of it,
/// with the bits and the memory of a new start, and without the method that made it.
TEST_P(Contract, ParametersNameTheirFirstPhase) {
    const ThreadLimit one(1);  // on which the memory of Embree's trees depends
    for (const Scene& scene : served())
        for (const LightId light : {0u, 1u}) {
            if (light == 0 && is_area(scene.lights[0].kind)) continue;  // of its lights one is enough
            const SceneFacts facts = find_facts(scene);
            PointBatch points      = primary(scene);
            if (!info().needs_raster) {
                std::vector<std::uint32_t> some;
                for (std::uint32_t i = 0; i < points.size(); i += 37) some.push_back(i);
                points = pick(points, some);
                face_lights(points, scene);
            }
            const PhaseInput input{scene, facts, points, light};
            for (const MethodChoice& from : settings_of(info())) {
                auto method = made(from);
                if (!method || !verdict(*method, facts)) continue;
                const PhaseValues kept = make_values(*method, input);
                method.reset();
                for (const Parameter& p : info().parameters) {
                    if (p.phase == Phase::build) continue;
                    for (const double other : others(p, from.settings.value(p.name))) {
                        MethodChoice to = from;
                        to.settings.set(p.name, other);
                        ASSERT_EQ(first_changed_phase(from.settings, to.settings), p.phase);
                        const auto changed = made(to);
                        if (!changed || !verdict(*changed, facts)) continue;
                        const PhaseAnswer fresh = answer_from(to, input), again = answer_from(to, input, p.phase, kept);
                        const std::string what = fmt::format("{} from {}", to.text(), from.text());
                        expect_same(again.plane, fresh.plane, what);
                        EXPECT_EQ(again.memory_bytes, fresh.memory_bytes) << what;
                    }
                }
            }
        }
}

TEST_P(Contract, AnEmptyBatchIsServed) {
    const KnownScene known = known_scene("two_lights");
    MethodCase run(info(), known.scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    run.prepare(0);
    PointBatch none;
    face_lights(none, known.scene);
    EXPECT_TRUE(run.visibility(none, 0).s.empty());
    run.blame(none, 0, {});
}

/// How far the segment to the light passes outside the triangle, as a fraction of the scene: 0 where it crosses it.
double miss(const Scene& scene, const PointBatch& points, std::size_t i, const Light& light, TriangleId t) {
    const dvec3 p   = place(scene, points, i);
    const dvec3 way = light.kind == LightKind::directional ? -dvec3(light.direction) : dvec3(light.position) - p;
    const dvec3 a(scene.vertex(t, 0)), b(scene.vertex(t, 1)), c(scene.vertex(t, 2));
    const dvec3 n      = glm::cross(b - a, c - a);
    const double share = glm::dot(n, a - p) / glm::dot(n, way);
    const dvec3 q      = p + share * way;
    double outside = std::max({0.0, -share, light.kind == LightKind::directional ? 0.0 : share - 1}) * glm::length(way);
    for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}})
        outside = std::max(outside,
                           -glm::dot(glm::cross(to - from, q - from), n) / (glm::length(n) * glm::length(to - from)));
    return outside / static_cast<double>(bounds(scene).diagonal());
}

TEST_P(Contract, BlamesATriangleThatBlocks) {
    std::size_t named = 0, served = 0;
    for (const char* name : {"two_lights", "open_meshes", "room"}) {
        const KnownScene known = known_scene(name);
        MethodCase run(info(), known.scene);
        if (!run.serves()) continue;
        ++served;
        const PointBatch raster = primary(known.scene);
        // What a method samples, as texels of a map, may lie off the segment to the light. One that answers by
        // irradiance interpolates between patches: near a shadow's edge points are dark that nothing hides.
        const bool interpolates  = run.measures() == Measure::irradiance;
        const double allowed     = run.serves().how >= How::to_rounding ? 1e-9 : 5e-3;
        const double at_most     = interpolates ? 0.05 : allowed;
        const std::size_t one_in = interpolates ? 5 : 100;
        for (LightId j = 0; j < known.scene.lights.size(); ++j) {
            run.prepare(j);
            const PointBatch dark = dark_points(known.scene, raster, j, run.visibility(raster, j));
            std::vector<TriangleId> who(dark.size(), 12345);
            run.blame(dark, j, who);
            std::ptrdiff_t off = 0;
            for (std::size_t i = 0; i < who.size(); ++i) {
                ASSERT_TRUE(who[i] == kNoTriangle || who[i] < known.scene.triangles.size());
                if (who[i] == kNoTriangle) continue;
                ++named;
                const double by = miss(known.scene, dark, i, known.scene.lights[j], who[i]);
                ASSERT_LE(by, at_most) << name << ' ' << i;
                off += by > allowed ? 1 : 0;
            }
            EXPECT_LE(off + std::ranges::count(who, kNoTriangle), std::ptrdiff_t(who.size() / one_in)) << name;
        }
    }
    if (served == 0) GTEST_SKIP() << "it serves none of these scenes";
    EXPECT_GT(named, 500u);
}

TEST_P(Contract, BlamesSomeOccluderOfAnAreaLight) {
    const KnownScene known = known_scene("penumbra_of_half_plane");
    MethodCase run(info(), known.scene);
    if (!run.serves()) GTEST_SKIP() << run.serves().why;
    run.prepare(0);
    const PointBatch raster = primary(known.scene);
    const PointBatch dark   = dark_points(known.scene, raster, 0, run.visibility(raster, 0));
    std::vector<TriangleId> who(dark.size(), 12345);
    run.blame(dark, 0, who);
    std::size_t right = 0;
    for (std::size_t i = 0; i < who.size(); ++i) {
        ASSERT_TRUE(who[i] == kNoTriangle || who[i] < known.scene.triangles.size());
        right += who[i] != kNoTriangle && who[i] != dark.triangle[i];
    }
    EXPECT_GT(dark.size(), 300u);
    EXPECT_GE(right, dark.size() * 99 / 100);
}

INSTANTIATE_TEST_SUITE_P(All, Contract, testing::ValuesIn(methods().begin(), methods().end()),
                         [](const auto& param) { return name_of(param.param); });

}  // namespace
}  // namespace umbra
