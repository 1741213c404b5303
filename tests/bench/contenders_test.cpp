#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/npy.h"
#include "umbra/bench/base/scene_files.h"
#include "umbra/bench/compare/compare.h"
#include "umbra/bench/contenders/answers_file.h"
#include "umbra/bench/contenders/contender.h"
#include "umbra/bench/contenders/gate.h"
#include "umbra/bench/contenders/program_session.h"
#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/run.h"
#include "umbra/bench/report/course/grade.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// The planted contender as a method, which is given a minute for an answer, and two seconds where it hangs.
const MethodInfo& planted(const std::string& fault) {
    const std::vector<std::string> command{UMBRA_PLANTED_CONTENDER, fault};
    const double timeout_s = fault == "hangs" ? 2 : 60;
    return program_method("planted",
                          {.command = command, .timeout_s = timeout_s, .says = introduction(command, ".", 60)}, ".");
}

/// What fails of the gate.
std::string failures_of(const std::string& fault) {
    std::string text;
    for (const GateRow& row : gate(planted(fault)))
        if (!row.passed) text += row.question + ": " + row.found + "\n";
    return text;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Gate, IsPassedByTheRight) {
    EXPECT_EQ(failures_of("none"), "");
    EXPECT_EQ(failures_of("raster"), "");
    const std::vector<GateRow> rows = gate(planted("none"));
    EXPECT_EQ(rows.size(), 6u) << "two kinds of hard lights, again, a floor alone, two lights, a rectangle";
    for (const GateRow& row : rows) EXPECT_NE(row.found, "");
}

TEST(Gate, SaysWhatIsWrong) {
    for (const auto& [fault, why] : std::vector<std::pair<std::string, std::string>>{
             {"lit", "every point is lit"},
             {"exchanged", "0 and 1 are exchanged"},
             {"srgb", "encoded as sRGB"},
             {"irradiance", "\"measure\": \"irradiance\""},
             {"upside_down", "upside down"},
             {"mirrored", "left and right"},
             {"beside", "a pixel beside"},
             {"other_light", "of the other light"},
             {"both_lights", "of both lights together"},
             {"self_shadow", "does the surface that a point lies on"},
             {"random", "no parameter is named as its \"seed\""},
             {"first_points", "in another order"},
             {"keeps_the_scene", "wrong away from edges"},
             {"nan", "too few are answered"},
             {"beyond", "expected 0 (in shadow) to 1 (lit)"},
             {"few", "holds 3072 values, expected 6144"},
             {"no_file", "wrote no file answers.npy"},
             {"another_folder", "expected one in its folder"},
             {"link", "wrote no file answers.npy"},
             {"error", "no such light here"},
             {"not_json", "one line of JSON is expected"},
             {"negative_time", "milliseconds, 0 or more"},
             {"crashes", "Its last lines on stderr: out of luck"},
             {"ends", "ended with exit code 3 before it answered. Its last lines on stderr: bye"},
             {"floods", "without the end of a line"},
         })
        EXPECT_TRUE(contains(failures_of(fault), why)) << fault << "\n" << failures_of(fault);
    EXPECT_THROW(static_cast<void>(planted("no_measure")), MethodError);
    EXPECT_THROW(static_cast<void>(planted("no_lights")), MethodError);
    EXPECT_THROW(static_cast<void>(planted("two_lines")), MethodError);
}

class Contenders : public testing::Test {
protected:
    [[nodiscard]] PreparedScene prepared(Size size = {64, 36}) const {
        return prepare_scene(std::string(UMBRA_SCENES) + "/light_inside_view.json", size);
    }
    TemporaryFolder folder_;
};

TEST(Gate, HasNoWordOfLightWhereNothingIsAnswered) {
    const std::string found = failures_of("silent");
    EXPECT_TRUE(contains(found, "0 points answered, 0 % wrong away from edges")) << found;
    EXPECT_FALSE(contains(found, "lit")) << found;
    EXPECT_TRUE(contains(found, "again: no answers to compare")) << found;
}

TEST_F(Contenders, AnswerAsBruteForce) {
    const PreparedScene p     = prepared();
    const MethodChoice choice = MethodChoice(planted("none"));
    const MethodRun run       = run_method(choice, p.scene, p.facts, p.points);
    const MethodRun force     = run_method(parse_method("brute_force"), p.scene, p.facts, p.points);
    std::size_t asked = 0, differ = 0;
    for (LightId j = 0; j < p.scene.lights.size(); ++j)
        for (std::size_t i = 0; i < p.points.size(); ++i) {
            asked += p.points.asks(j, i);
            differ += p.points.asks(j, i) && run.planes[j].s[i] != force.planes[j].s[i];
        }
    EXPECT_GT(asked, 500u);
    EXPECT_EQ(differ, 0u);
    // All once more, other points in between, and back.
    run.work->build();
    run.work->look(p.points);
    const std::vector<std::uint32_t> some{5, 900, 17};
    const PointBatch few = pick(p.points, some);
    static_cast<void>(run.work->ask(few, 0));
    VisibilityPlane again(p.points.size());
    run.work->visibility(0, again.out());
    EXPECT_EQ(again.s, run.planes[0].s);
    const OwnTimes own = run.work->method().own_times(p.scene).value();
    EXPECT_EQ(own.build, (std::vector<double>{2.5, 2.5}));
    EXPECT_EQ(own.aim.at(0), (std::vector<double>{2.5, 2.5}));
    EXPECT_EQ(own.visibility.at(0), std::vector<double>(2, 2.5)) << "without that of a few points";
}

TEST_F(Contenders, AreAimedAnewWhereTheirLastAimWasAnother) {
    const PreparedScene p = prepare_scene(std::string(UMBRA_SCENES) + "/three_reasons.json", {64, 36});
    Scene scene           = p.scene;
    Light other           = scene.lights[0];
    other.name = "other", other.kind = LightKind::point, other.position = {-3, 4, 2};
    scene.lights             = {other, other};
    scene.lights[1].position = {3, 4, 2}, scene.lights[1].name = "another";
    const SceneFacts facts = find_facts(scene);
    PointBatch points      = p.points;
    face_lights(points, scene);
    MethodAtWork work(MethodChoice(planted("none")), scene, facts);
    MethodAtWork force(parse_method("brute_force"), scene, facts);
    for (MethodAtWork* each : {&work, &force}) each->look(points), each->aim(0), each->aim(1);
    VisibilityPlane ours(points.size()), theirs(points.size());
    for (const LightId light : {0u, 1u, 0u}) {
        ours.clear(), theirs.clear();
        work.visibility(light, ours.out()), force.visibility(light, theirs.out());
        EXPECT_EQ(ours.s, theirs.s) << light;
    }
}

TEST_F(Contenders, AreOthersWhereAScriptBesideTheirsIs) {
    const fs::path script = folder_.path() / "mine.py", module = folder_.path() / "shared.py";
    write_text(script, "import shared");
    write_text(module, "pass");
    ContenderRecord record{.command = {UMBRA_PLANTED_CONTENDER, "none", "mine.py"}};
    record.says              = introduction(record.command, folder_.path());
    const MethodInfo& method = program_method("scripted", record, folder_.path());
    const std::string before = text_of_outside(method);
    EXPECT_EQ(text_of_outside(method), before);
    write_text(folder_.path() / "notes.txt", "of no matter");
    EXPECT_EQ(text_of_outside(method), before);
    write_text(module, "print()");
    EXPECT_NE(text_of_outside(method), before);
}

TEST(Seeds, StayWithinTheRangeOfTheMethod) {
    MethodInfo info{.name = "noisy", .title = "", .paper = "", .summary = ""};
    info.parameters = {{.name = "seed", .min = 3, .max = 10, .type = Parameter::Type::integer, .fallback = 9}};
    info.seed       = "seed";
    const MethodChoice choice(info);
    std::set<double> seeds;
    for (int run = 0; run < 8; ++run) {
        const double seed = with_seed(choice, 1000003LL * (run + 1)).settings.value("seed");
        EXPECT_TRUE(seed >= 3 && seed <= 10) << seed;
        seeds.insert(seed);
    }
    EXPECT_EQ(seeds.size(), 8u);
    EXPECT_EQ(with_seed(parse_method("ray_traced:seed=5"), 1000003).settings.value("seed"), 1000008);
}

TEST_F(Contenders, ThatHangAreEndedWithAllThatTheyStarted) {
    const PreparedScene p = prepared({16, 9});
    const auto start      = std::chrono::steady_clock::now();
    EXPECT_THROW(static_cast<void>(run_method(MethodChoice(planted("hangs")), p.scene, p.facts, p.points)),
                 MethodError);
    const std::string running = std::string("pgrep -f '[p]lanted_contender children' > /dev/null");
    {
        const LineProcess process({UMBRA_PLANTED_CONTENDER, "children"}, ".");
        EXPECT_EQ(std::system(running.c_str()), 0);
    }
    EXPECT_NE(std::system(running.c_str()), 0);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
    EXPECT_THROW(LineProcess({"/no/such/program"}, "."), MethodError);
}

TEST_F(Contenders, LeaveNothingBehindInTheFolderForTemporaryFiles) {
    static_cast<void>(planted("litters"));
    EXPECT_FALSE(fs::exists(fs::temp_directory_path() / "umbra-litter"));
}

TEST_F(Contenders, CostTheirOwnCellOnly) {
    const fs::path scene = folder_.path() / "two.json";
    std::ofstream(scene) << R"({"camera": {"eye": [0, 4, 6], "target": [0, 0, 0]},
        "lights": [{"type": "point", "name": "a", "position": [2, 5, 0]},
                   {"type": "directional", "name": "b", "direction": [1, -2, 0]}],
        "objects": [{"type": "plane", "size": 9},
                    {"type": "box", "transform": [{"translate": [0, 1, 0]}]}]})";
    CompareOptions options;
    options.size          = {32, 18};
    options.out           = folder_.path() / "out";
    options.methods       = {"ray_traced"};
    options.choices       = {MethodChoice(planted("none")), MethodChoice(planted("crashes"))};
    const Results results = compare_scene(scene, options);
    ASSERT_EQ(results.methods.size(), 3u);
    EXPECT_TRUE(results.methods[0].ran);
    EXPECT_EQ(results.methods[0].outside, "");
    const MethodRecord& right = results.methods[1];
    EXPECT_TRUE(right.ran);
    EXPECT_EQ(right.outside, "program");
    EXPECT_EQ(right.title, "Planted 1");
    EXPECT_FALSE(right.memory_bytes) << "not known, which is not 0";
    const double lights = static_cast<double>(results.lights.size());
    ASSERT_TRUE(right.own_times);
    EXPECT_EQ(right.own_times->build_ms, 2.5);
    EXPECT_EQ(right.own_times->aim_ms, 2.5 * lights);
    EXPECT_EQ(right.own_times->visibility_ms, 2.5 * lights);
    EXPECT_EQ(right.own_times->look_ms, 2.5);
    ASSERT_TRUE(right.times);
    ASSERT_TRUE(results.methods[2].failed);
    EXPECT_TRUE(contains(results.methods[2].failed->message, "out of luck"));
}

TEST_F(Contenders, AnswersInAFileAreJudged) {
    const std::string file_of_scene = std::string(UMBRA_SCENES) + "/six_lights.json";
    const PreparedScene p           = prepare_scene(file_of_scene, {32, 18});
    const MethodRun force           = run_method(parse_method("brute_force"), p.scene, p.facts, p.points);
    const std::size_t n = p.points.size(), lights = p.scene.lights.size();
    std::vector<float> values;
    for (const VisibilityPlane& plane : force.planes) values.insert(values.end(), plane.s.begin(), plane.s.end());
    std::size_t undefined = 0;
    while (!p.points.asks(0, undefined)) ++undefined;
    values[undefined]   = std::nanf("");
    const fs::path file = folder_.path() / "mine.npy";
    write_npy(file, values, {lights, 18, 32});
    CompareOptions options;
    options.size             = {32, 18};
    options.out              = folder_.path() / "out";
    options.pixel_samples    = 4;  // of which a file has one
    options.choices          = {add_answers("mine=" + file.string() + ":measure=irradiance")};
    const Results results    = compare_scene(file_of_scene, options);
    const MethodRecord& mine = results.methods.at(0);
    EXPECT_EQ(mine.outside, "file of answers");
    EXPECT_EQ(mine.measures, "irradiance");
    EXPECT_FALSE(mine.times) << "copying a file is no time of a method";
    EXPECT_EQ(mine.errors[0].undefined, 1u);
    for (const ErrorRecord& error : mine.errors)
        EXPECT_EQ(*error.false_light->interior + *error.false_shadow->interior, 0u) << error.light;
    EXPECT_THROW(static_cast<void>(add_answers("mine=" + file.string())), UsageError) << "the name is taken";
    for (const std::string& text :
         std::vector<std::string>{"mine", "=x", "a b=" + file.string(), "b=" + file.string() + ":measure=colour"})
        EXPECT_THROW(static_cast<void>(add_answers(text)), UsageError) << text;
    EXPECT_THROW(static_cast<void>(add_answers("c=/no/such.npy")), InputError);

    VisibilityPlane plane(n);
    const auto refused = [&](const std::vector<float>& all, const Shape& shape) -> std::string {
        write_npy(file, all, shape);
        try {
            read_answers(file, p.scene, p.points, 0, false, plane.out());
        } catch (const InputError& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_TRUE(
        contains(refused(std::vector<float>(n / 2), {n / 2}), fmt::format("holds {} values, expected {}", n / 2, n)));
    EXPECT_TRUE(contains(refused(std::vector<float>(lights * n, 1.5f), {lights, n}), "is 1.5, expected 0"));
    EXPECT_EQ(refused(std::vector<float>(lights * n, 1.0005f), {lights, n}), "");
    EXPECT_EQ(plane.s[undefined], 1.0f) << "clamped";
}

TEST(Messages, SayWhereALightIsInTheWorld) {
    const PreparedScene p = prepare_scene(std::string(UMBRA_SCENES) + "/warnock.json", {16, 9});
    ASSERT_TRUE(p.scene.lights[0].camera_pose);
    const Json light = aim_message(p.scene, 0, Json::object())["description"];
    EXPECT_FALSE(light.contains("fixed_to"));
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(light["position"][axis].get<float>(), p.scene.lights[0].position[axis]);
}

TEST(Npy, ReadsWhatNumPyWrites) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.npy";
    const auto write    = [&](const std::string& header, const std::string& bytes) {
        std::ofstream out(file, std::ios::binary);
        out << std::string("\x93NUMPY\x01\x00", 8) << static_cast<char>(header.size()) << '\0' << header << bytes;
    };
    write("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }", [] {
        const double values[]{0, 3, 1, 4, 2, 5};
        return std::string(reinterpret_cast<const char*>(values), sizeof values);
    }());
    EXPECT_EQ(read_npy(file).values, (std::vector<float>{0, 1, 2, 3, 4, 5})) << "columns first";
    write("{'descr': '>i2', 'fortran_order': False, 'shape': (2,), }", std::string("\x01\x00\xff\xff", 4));
    EXPECT_EQ(read_npy(file).values, (std::vector<float>{256, -1}));
    write("{'shape': (3,), 'fortran_order': False, 'descr': '<f2'}", std::string("\x00\x3c\x00\xb8\x01\x00", 6));
    EXPECT_EQ(read_npy(file).values, (std::vector<float>{1, -0.5f, 0x1p-24f}));
    write("{'descr': '|b1', 'fortran_order': False, 'shape': (), }", std::string("\x01", 1));
    EXPECT_EQ(read_npy(file).shape, Shape{});
    for (const auto& [header, bytes] : std::vector<std::pair<std::string, std::string>>{
             {"{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }", "1234567"},
             {"{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }", "123456789"},
             {"{'descr': '<f4', 'fortran_order': False, 'shape': (999999999999, 999999999999), }", "1234"},
             {"{'descr': '<c8', 'fortran_order': False, 'shape': (1,), }", "12345678"},
             {"{'descr': [('u', '<f4')], 'fortran_order': False, 'shape': (1,), }", "1234"},
             {"{'descr': '<f4', 'shape': (1,), }", "1234"},
             {"", "1234"}}) {
        write(header, bytes);
        EXPECT_THROW(static_cast<void>(read_npy(file)), InputError) << header;
    }
    const std::string long_header =
        "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::string(60000, ' ') + "1,), }";
    std::ofstream(file, std::ios::binary)
        << std::string("\x93NUMPY\x01\x00", 8) << static_cast<char>(long_header.size() & 255)
        << static_cast<char>(long_header.size() >> 8) << long_header << "1234";
    EXPECT_THROW(static_cast<void>(read_npy(file)), InputError) << "a header without end";
    EXPECT_THROW(static_cast<void>(read_npy("/dev/zero")), InputError);
}

TEST(SceneFiles, HoldPointsInDouble) {
    const TemporaryFolder folder;
    const PreparedScene p = prepare_scene(std::string(UMBRA_SCENES) + "/spot_stage.json", {32, 18});
    write_points(folder.path() / "points.npy", p.scene, p.points);
    const std::string bytes = bytes_of(folder.path() / "points.npy");
    ASSERT_EQ(bytes.size() % 64, (56 * p.points.size()) % 64) << "a header of a multiple of 64 bytes";
    const char* const begin = bytes.data() + bytes.size() - 56 * p.points.size();
    std::size_t finer       = 0;
    for (std::size_t i = 0; i < p.points.size(); ++i) {
        dvec3 position;
        std::int32_t pixel[2];
        std::uint32_t triangle = 0;
        std::memcpy(&position, begin + 56 * i, sizeof position);
        std::memcpy(&triangle, begin + 56 * i + 36, sizeof triangle);
        std::memcpy(pixel, begin + 56 * i + 48, sizeof pixel);
        EXPECT_EQ(triangle, p.points.triangle[i]);
        EXPECT_EQ(pixel[0], static_cast<int>(i % 32));
        EXPECT_EQ(pixel[1], static_cast<int>(i / 32));
        if (triangle == kNoTriangle) continue;
        EXPECT_EQ(position, exact_position(p.scene, p.points, i));
        finer += position != dvec3(p.points.position(i));
    }
    EXPECT_GT(finer, 100u);
}

TEST(SceneFiles, HoldTheSceneInThreeForms) {
    const TemporaryFolder folder;
    const PreparedScene p = prepare_scene(std::string(UMBRA_SCENES) + "/spot_stage.json", {32, 18});
    write_scene_files(folder.path(), p.scene);
    const Numbers corners = read_npy(folder.path() / "triangles.npy");
    ASSERT_EQ(corners.shape, (Shape{p.scene.triangles.size(), 3, 3}));
    for (TriangleId t = 0; t < p.scene.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_EQ(corners.values[9 * t + 3 * static_cast<std::size_t>(k) + static_cast<std::size_t>(axis)],
                          p.scene.vertex(t, k)[axis]);
    for (const char* name : {"scene.json", "scene.glb"}) {
        const Scene again = load_scene(folder.path() / name);
        ASSERT_EQ(again.triangles.size(), p.scene.triangles.size()) << name;
        for (TriangleId t = 0; t < again.triangles.size(); ++t)
            for (int k = 0; k < 3; ++k) EXPECT_EQ(again.vertex(t, k), p.scene.vertex(t, k)) << name;
        EXPECT_EQ(again.lights.size(), p.scene.lights.size()) << name;
        for (std::size_t j = 0; j < again.lights.size(); ++j) {
            EXPECT_EQ(again.lights[j].kind, p.scene.lights[j].kind) << name;
            EXPECT_EQ(again.lights[j].position, p.scene.lights[j].position) << name;
            if (again.lights[j].kind != LightKind::point) {
                EXPECT_LT(glm::length(glm::normalize(again.lights[j].direction) -
                                      glm::normalize(p.scene.lights[j].direction)),
                          1e-6f)
                    << name;
            }
        }
        EXPECT_EQ(again.camera.eye, p.scene.camera.eye) << name;
        EXPECT_NEAR(again.camera.fov_y, p.scene.camera.fov_y, 1e-4) << name;
    }
}

/// Compiles a source in C to a shared library; empty where there is no such compiler.
fs::path compiled(const std::string& compiler, const fs::path& source, const fs::path& folder) {
    fs::path library = folder / (source.stem().string() + "-" + compiler + ".so");
    if (std::system(("command -v " + compiler + " > /dev/null").c_str()) != 0) return {};
    const std::string command = fmt::format(
        "{} -std=c11 -O2 -Wall -Wpedantic -Werror -shared -fPIC -I {}/bench/contenders/include {} -lm -o {}", compiler,
        UMBRA_SOURCE, source.string(), library.string());
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return library;
}

TEST_F(Contenders, LibrariesInCOfAnyCompilerPassTheGate) {
    const fs::path source = fs::path(UMBRA_SOURCE) / "bench/contenders/libraries/rays.c";
    std::size_t tried     = 0;
    for (const char* const compiler : {"gcc", "clang"}) {
        const fs::path file = compiled(compiler, source, folder_.path());
        if (file.empty()) continue;
        ++tried;
        const MethodInfo& info = library_method(file);
        EXPECT_EQ(info.outside, "library");
        for (const GateRow& row : gate(info))
            EXPECT_TRUE(row.passed) << compiler << ", " << row.question << ": " << row.found;
        const PreparedScene p = prepared();
        const MethodRun ours  = run_method(MethodChoice(info), p.scene, p.facts, p.points);
        const MethodRun force = run_method(parse_method("brute_force"), p.scene, p.facts, p.points);
        EXPECT_EQ(ours.planes[0].s, force.planes[0].s);
        ours.work->build();
        EXPECT_EQ(ours.work->ask(p.points, 0).s, force.planes[0].s) << "once more";
        EXPECT_EQ(text_of_outside(info), bytes_of(file));
        const PreparedScene area = prepare_scene(std::string(UMBRA_SCENES) + "/umbra_penumbra.json", {32, 18});
        const auto seeded        = [&](long long seed) {
            return run_method(with_seed(MethodChoice(info), seed), area.scene, area.facts, area.points).planes[0].s;
        };
        EXPECT_NE(seeded(1), seeded(2)) << "the second setting is its own";
    }
    if (tried == 0) GTEST_SKIP() << "there is neither gcc nor clang";
}

/// Figures of the ten exercises (docs/exercises_solutions.md) on three scenes, by number.
TEST_F(Contenders, ExercisesShowWhatTheSolutionsSay) {
    const fs::path file =
        compiled("gcc", fs::path(UMBRA_SOURCE) / "bench/contenders/libraries/exercises.c", folder_.path());
    if (file.empty()) GTEST_SKIP() << "there is no gcc";
    for (const GateRow& row : gate(library_method(file)))
        EXPECT_TRUE(row.passed) << "without a fault, " << row.question << ": " << row.found;
    add_library_method(file);
    CompareOptions options;
    options.size = {96, 54}, options.repeats = kOnce;
    for (int number = 0; number <= 10; ++number) options.methods.push_back(fmt::format("exercise:number={}", number));
    std::map<std::string, Results> found;
    for (const char* scene : {"stairs", "closed_room", "eye_in_shadow"}) {
        options.out  = folder_.path() / scene;
        found[scene] = compare_scene(fmt::format("{}/{}.json", UMBRA_SCENES, scene), options);
    }
    const auto figure = [&](int number, const std::string& scene, const std::string& of) {
        const Results& results = found.at(scene);
        return figure_of(results, results.methods.at(static_cast<std::size_t>(number)), of, "")
            .value_or(Figure{})
            .value;
    };
    const auto wrong = [&](int number, const std::string& scene) {
        return figure(number, scene, "false_shadow") + figure(number, scene, "false_light") +
               figure(number, scene, "edge");
    };
    const auto width = [&](int number) {
        const ErrorRecord& error = found.at("closed_room").methods.at(static_cast<std::size_t>(number)).errors.at(0);
        return error.penumbra_width_px->method / error.penumbra_width_px->reference;
    };
    for (const char* scene : {"stairs", "closed_room", "eye_in_shadow"})
        EXPECT_LT(wrong(0, scene), 0.002) << "without a fault, " << scene;
    EXPECT_GT(figure(1, "closed_room", "false_shadow"), 0.8) << "there is a ceiling behind the light";
    EXPECT_EQ(wrong(1, "stairs"), 0);
    const PreparedScene room    = prepare_scene(std::string(UMBRA_SCENES) + "/closed_room.json", {96, 54});
    const auto equal_neighbours = [&](int number) {
        const MethodRun run =
            run_method(parse_method(fmt::format("exercise:number={}", number)), room.scene, room.facts, room.points);
        const std::vector<float>& s = run.planes[0].s;
        int equal                   = 0;
        for (std::size_t i = 1; i < s.size(); ++i) equal += s[i] > 0 && s[i] < 1 && s[i] == s[i - 1] ? 1 : 0;
        return equal;
    };
    EXPECT_GT(equal_neighbours(2), 1.4 * equal_neighbours(0)) << "steps instead of grain";
    EXPECT_LT(wrong(2, "closed_room"), 0.02);
    EXPECT_EQ(wrong(2, "stairs"), 0);
    for (const char* scene : {"stairs", "closed_room", "eye_in_shadow"})
        EXPECT_GT(figure(3, scene, "acne"), 0.6) << scene;
    EXPECT_GT(figure(4, "stairs", "edge"), 0.01);
    EXPECT_GT(figure(4, "eye_in_shadow", "acne"), 0.01);
    EXPECT_GT(figure(4, "eye_in_shadow", "detachment"), 0.005);
    EXPECT_GT(figure(5, "eye_in_shadow", "leak"), 0.003);
    EXPECT_LT(figure(5, "eye_in_shadow", "detachment"), 0.02);
    EXPECT_EQ(figure(5, "eye_in_shadow", "acne"), 0);
    EXPECT_GT(figure(6, "stairs", "acne"), 0.2);
    EXPECT_LT(wrong(6, "eye_in_shadow"), 0.01) << "only walls that face z are wrong";
    EXPECT_EQ(wrong(7, "stairs"), 0);
    EXPECT_EQ(width(7), 0);
    EXPECT_GT(figure(8, "eye_in_shadow", "detachment"), 0.025);
    EXPECT_EQ(wrong(9, "stairs"), 0);
    EXPECT_GT(width(9), 0.1);
    EXPECT_LT(width(9), 0.6);
    EXPECT_GT(figure(10, "stairs", "edge"), 0.02);
    EXPECT_EQ(wrong(10, "eye_in_shadow"), 0) << "under the sun nothing is that far";
}

TEST_F(Contenders, TheLibraryOfTheGuideCompilesAndIsRefusedAsItSays) {
    const std::string page  = bytes_of(fs::path(UMBRA_SOURCE) / "docs/contenders.md");
    const std::size_t begin = page.find("```c\n") + 5, end = page.find("```", begin);
    write_text(folder_.path() / "mine.c", page.substr(begin, end - begin));
    const fs::path file = compiled("gcc", folder_.path() / "mine.c", folder_.path());
    if (file.empty()) GTEST_SKIP() << "there is no gcc";
    const std::vector<GateRow> rows = gate(library_method(file));
    EXPECT_TRUE(std::ranges::any_of(
        rows, [](const GateRow& row) { return !row.passed && contains(row.found, "every point is lit"); }));
}

TEST_F(Contenders, LibrariesThatCannotBeMethodsAreRefused) {
    const std::string begin = R"(#include "umbra/contender.h"
static int answer(const umbra_question* q, size_t begin, size_t end, float* s, char* why) {
    for (size_t i = begin; i < end; ++i) s[i] = q->points->count > 0 ? 2 : 0;
    return FAILS ? umbra_fail(why, "no luck") : 1;
}
const umbra_contender_info* umbra_contender(void) {
    static const umbra_contender_info info = {.version = UMBRA_CONTENDER_VERSION, .lights = UMBRA_HARD, .name = "mine",
        .title = "Mine", .release = "1", .visibility = answer, )";
    const auto library      = [&](const std::string& name, const std::string& members, bool fails = false) {
        const fs::path source = folder_.path() / (name + ".c");
        write_text(source,
                        fmt::format("#define FAILS {}\n{}{}}};\n    return &info;\n}}\n", fails ? 1 : 0, begin, members));
        return compiled("gcc", source, folder_.path());
    };
    if (library("fine", "").empty()) GTEST_SKIP() << "there is no gcc";
    const auto refused = [&](const std::string& name, const std::string& members) -> std::string {
        try {
            static_cast<void>(library_method(library(name, "." + members)));
        } catch (const std::exception& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_TRUE(contains(refused("later", "version = 7"), "for version 7"));
    EXPECT_TRUE(contains(refused("nameless", "name = NULL"), "name is missing"));
    EXPECT_TRUE(contains(refused("blind", "visibility = NULL"), "visibility is NULL"));
    EXPECT_TRUE(contains(refused("dark", "lights = 0"), "\"lights\" is missing"));
    EXPECT_TRUE(contains(refused("other", "lights = 64"), "expected bits"));
    EXPECT_TRUE(contains(refused("short", "parameter_count = 2"), "parameters is NULL"));
    const PreparedScene p = prepared();
    const auto fault_of   = [&](const fs::path& file) -> std::string {
        try {
            static_cast<void>(run_method(MethodChoice(library_method(file)), p.scene, p.facts, p.points));
        } catch (const MethodError& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_TRUE(contains(fault_of(library("beyond", "")), "the answer at point"));
    EXPECT_TRUE(contains(fault_of(library("fails", "", true)), "visibility: no luck"));
    EXPECT_THROW(static_cast<void>(library_method("/nowhere.so")), InputError);
    write_text(folder_.path() / "text.so", "no library");
    EXPECT_THROW(static_cast<void>(library_method(folder_.path() / "text.so")), InputError);
}

}  // namespace
}  // namespace umbra
