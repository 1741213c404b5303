#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "umbra/bench/base/files.h"
#include "umbra/bench/contenders/contender.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/course/apart.h"
#include "umbra/bench/report/course/course_report.h"
#include "umbra/bench/report/course/grade_page.h"
#include "umbra/bench/report/course/judge.h"
#include "umbra/bench/report/course/platforms.h"
#include "umbra/bench/report/report.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/json_schema.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// A board above a floor, under a lamp.
constexpr const char* kScene = R"({"size": [48, 32], "camera": {"eye": [0, 5, 6], "target": [0, 0, 0], "fov": 50},
 "materials": {"white": {"k_d": 0.8}}, "lights": [{"type": "point", "name": "lamp", "position": [0.6, 4, 0.3]}],
 "objects": [{"name": "floor", "type": "plane", "size": [12, 12], "material": "white"},
             {"name": "board", "type": "box", "size": [2, 0.1, 2], "material": "white", "transform": [{"translate": [0, 1, 0]}]}]})";

constexpr const char* kItems = R"([
 {"name": "Dark where it should be", "of": "false_light", "points": 3, "full": 0.001, "none": 0.01},
 {"name": "Lit where it should be", "about": "Look at the floor.", "of": "false_shadow", "points": 3, "full": 0.001, "none": 0.2},
 {"name": "Edges", "of": "displacement", "points": 1, "full": 1, "none": 3},
 {"name": "Answers everything", "of": "undefined", "points": 1, "none": 0.5},
 {"name": "Holds", "of": "failed", "points": 2}])";

std::string rubric_text(const std::string& items = kItems, const std::string& more = "") {
    return fmt::format(
        R"({{"title": "Exercise 1", "scenes": ["board.json"], "methods": ["ray_traced"], {}"items": {}}})", more,
        items);
}

/// A folder with the scene, a rubric, and what students handed in.
class Classroom {
public:
    Classroom() {
        write_text(folder_.path() / "board.json", kScene);
        write_text(folder_.path() / "rubric.json", rubric_text());
    }
    [[nodiscard]] fs::path path(const std::string& name) const { return folder_.path() / name; }
    [[nodiscard]] Rubric rubric() const {
        return read_rubric(path("rubric.json"),
                           [](const std::string& name) -> fs::path { throw UsageError("there is no scene " + name); });
    }
    /// A program that is started by a script of this text.
    [[nodiscard]] Submission script(const std::string& name, const std::string& text) const {
        make_folder(path(name));
        write_text(path(name) / "run", "#!/bin/sh\n" + text + "\n");
        fs::permissions(path(name) / "run", fs::perms::owner_all);
        return {.name = name, .folder = fs::canonical(path(name))};
    }
    /// The planted contender with a fault.
    [[nodiscard]] Submission planted(const std::string& name, const std::string& fault) const {
        Submission made = script(name, "exec ./planted " + fault);
        fs::copy_file(UMBRA_PLANTED_CONTENDER, made.folder / "planted", fs::copy_options::overwrite_existing);
        return made;
    }
    [[nodiscard]] GradeRecord graded(const Submission& one, bool protect = false, const std::string& key = "") const {
        return judge(one, rubric(),
                     {.out = path("grades") / one.name, .command = "umbra grade", .protect = protect, .key = key});
    }

private:
    TemporaryFolder folder_;
};

std::vector<double> points_of(const GradeRecord& grade) {
    std::vector<double> points;
    for (const GradedItemRecord& item : grade.items) points.push_back(item.points);
    return points;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

using Points = std::vector<double>;

TEST(Course, GivesPointsByCause) {
    const Classroom course;
    EXPECT_EQ(points_of(course.graded(course.planted("right", "none"))), (Points{3, 3, 1, 1, 2}));
    const GradeRecord lit = course.graded(course.planted("lit", "lit"));
    EXPECT_EQ(lit.items[0].points, 0) << "no shadow at all";
    EXPECT_EQ(lit.items[1].points, 3) << "nothing is too dark";
    EXPECT_EQ(lit.items[2].points, 0) << "rays have edges there";
    EXPECT_TRUE(contains(lit.items[0].sentence, "0 of 3 points: on board, ")) << lit.items[0].sentence;
    EXPECT_TRUE(contains(lit.items[0].sentence, "% of the points are too bright, away from edges, light lamp."))
        << lit.items[0].sentence;
    const GradeRecord dark = course.graded(course.planted("dark", "self_shadow"));
    EXPECT_EQ(dark.items[0].points, 3);
    EXPECT_EQ(dark.items[1].points, 0);
    const GradeRecord holes = course.graded(course.planted("holes", "nan"));
    EXPECT_EQ(holes.items[0].points, 3);
    EXPECT_EQ(holes.items[3].points, 0) << "three of four are not answered";
    const GradeRecord crash = course.graded(course.planted("crash", "crashes"));
    EXPECT_EQ(points_of(crash), (Points{0, 0, 0, 0, 0}));
    EXPECT_TRUE(contains(crash.items[4].sentence, "out of luck")) << crash.items[4].sentence;
}

TEST(Course, CreditFallsEvenlyBetweenTheBounds) {
    RubricRecord rubric{.step = 0.5};
    rubric.items     = {{.name = "a", .of = "acne", .points = 4, .full = 0.1, .none = 0.3},
                        {.name = "b", .of = "displacement", .points = 1, .full = 0, .none = 1},
                        {.name = "c", .of = "acne", .points = 10, .full = 0, .none = 1, .scenes = {"second"}}};
    const auto scene = [](const std::string& name, std::uint64_t acne) {
        MethodRecord method{.id = "mine"};
        method.serves.how = "exactly";
        ErrorRecord error;
        error.light = "lamp", error.points = 1000, error.false_shadow.emplace().acne = acne;
        ErrorRecord dim = error;
        dim.light = "dim", dim.false_shadow->acne = acne / 2;
        method.errors = {dim, error};
        Compared one{.asked = name, .folder = name, .method = "mine"};
        one.results.methods = {method};
        return one;
    };
    const auto graded = [&](std::uint64_t first, std::uint64_t second) {
        GradeRecord record;
        grade(record, rubric, {scene("first", first), scene("second", second)});
        return record;
    };
    const GradeRecord at = graded(200, 100);
    EXPECT_EQ(at.items[0].points, 3) << "half of the first scene, all of the second";
    EXPECT_EQ(at.items[0].scenes[0].light, "lamp") << "the worst light counts";
    EXPECT_EQ(at.items[0].scenes[0].figure, 0.2);
    EXPECT_EQ(at.items[1].points, 1) << "nothing to measure";
    EXPECT_EQ(at.items[1].sentence, "1 of 1 points: nothing on the scenes asks for this.");
    EXPECT_EQ(at.items[2].points, 9) << "of the second scene alone";
    EXPECT_EQ(at.points, 13);
    EXPECT_EQ(at.max, 15);
    EXPECT_EQ(graded(300, 300).items[0].points, 0);
    EXPECT_EQ(graded(210, 100).items[0].points, 3) << "3.9 / 2 + 2 in steps of a half";
}

TEST(Course, ThePointsAreTheSumOfTheItems) {
    RubricRecord rubric{.step = 0.5};
    rubric.items = {{.name = "a", .of = "acne", .points = 1, .full = 0, .none = 1},
                    {.name = "b", .of = "acne", .points = 1.25, .full = 0, .none = 1}};
    MethodRecord method{.id = "mine"};
    method.serves.how = "exactly";
    ErrorRecord error;
    error.points = 1000, error.false_shadow.emplace().acne = 0;
    method.errors = {error};
    Compared one{.asked = "s", .folder = "s", .method = "mine"};
    one.results.methods = {method};
    GradeRecord record;
    grade(record, rubric, {one});
    EXPECT_EQ(record.points, 2.25);
    EXPECT_EQ(record.points, record.max);
}

TEST(Course, AnswersAreTakenSceneByScene) {
    const Classroom course;
    make_folder(course.path("files"));
    const Submission files{.name = "files", .folder = fs::canonical(course.path("files"))};
    EXPECT_TRUE(contains(course.graded(files).failed, "no file ./run, and no board.npy or board.exr"));
    const Submission right       = course.planted("right", "none");
    const GradeRecord by_program = course.graded(right);
    fs::copy_file(course.path("grades") / "right/board/handed_in.exr", files.folder / "board.exr");
    const GradeRecord by_file = course.graded(files);
    EXPECT_EQ(by_file.failed, "");
    EXPECT_EQ(points_of(by_file), points_of(by_program));
    make_folder(course.path("thief"));
    fs::create_symlink(files.folder / "board.exr", course.path("thief") / "board.exr");
    EXPECT_NE(course.graded({.name = "thief", .folder = fs::canonical(course.path("thief"))}).failed, "")
        << "a link to what somebody else handed in";
    write_text(files.folder / "board.exr", "no picture");
    const GradeRecord broken = course.graded(files);
    EXPECT_EQ(broken.points, 0);
    EXPECT_TRUE(contains(broken.items[4].sentence, "board.exr")) << broken.items[4].sentence;
    EXPECT_FALSE(contains(broken.items[4].sentence, course.path("").string())) << "students are not told where";
    const ClassRecord rows =
        write_class(course.rubric().record, {by_file, broken}, {"a", "b"}, "umbra grade", course.path("class"));
    EXPECT_EQ(rows.rows[0].failed, "");
    EXPECT_EQ(rows.rows[1].failed, "no answers on board");
    const Submission locked = course.script("locked", "exit 0");
    fs::permissions(locked.folder / "run", fs::perms::owner_read);
    EXPECT_EQ(course.graded(locked).failed, "./run is not executable, expected chmod +x ./run");
}

TEST(Course, WhatIsKeptIsNotGradedAgain) {
    const Classroom course;
    const Submission one    = course.planted("one", "lit");
    const std::string key   = rubric_key(course.rubric());
    const GradeRecord first = course.graded(one, false, key);
    const auto written      = fs::last_write_time(course.path("grades") / "one/results.json");
    EXPECT_TRUE(fits(schema_of<GradeRecord>("").dump(), bytes_of(course.path("grades") / "one/results.json")));
    EXPECT_EQ(course.graded(one, false, key).points, first.points);
    EXPECT_EQ(fs::last_write_time(course.path("grades") / "one/results.json"), written);
    EXPECT_EQ(course.graded(course.planted("one", "none"), false, key).points, 10) << "another program is graded";
    write_text(course.path("rubric.json"), rubric_text(kItems, R"("step": 1, )"));
    EXPECT_NE(rubric_key(course.rubric()), key);
    write_text(course.path("rubric.json"), rubric_text());
    std::string scene = kScene;
    scene.replace(scene.find("0.6"), 3, "0.7");
    write_text(course.path("board.json"), scene);
    EXPECT_NE(rubric_key(course.rubric()), key);
}

TEST(Course, ProgramsAreKeptApart) {
    if (!can_keep_apart()) GTEST_SKIP() << "bubblewrap is not there or may not make namespaces";
    const Classroom course;
    write_text(course.path("secret.txt"), "the solution");
    const auto words = [&](const std::string& name, const std::string& text) {
        return course.graded(course.script(name, text + " >&2; exit 3"), true).failed;
    };
    EXPECT_TRUE(contains(words("peeks", "cat ../secret.txt"), "No such file"));
    EXPECT_TRUE(contains(words("lists", fmt::format("ls {}", course.path("").string())), "lists"));
    EXPECT_FALSE(contains(words("lists", fmt::format("ls {}", course.path("").string())), "secret"));
    const std::string network = words("network", "cat /proc/net/dev");
    EXPECT_TRUE(contains(network, "lo:")) << network;
    EXPECT_FALSE(contains(network, "eth")) << network;
    EXPECT_TRUE(contains(words("memory", "ulimit -v"), "4194304"));
    EXPECT_TRUE(contains(words("writes", "touch mine"), "Read-only"));
    const GradeRecord right = course.graded(course.planted("right", "none"), true);
    EXPECT_EQ(right.points, 10) << grade_text(right);
    EXPECT_EQ(right.apart->by, "bwrap");
    EXPECT_FALSE(right.apart->network);
}

TEST(Course, TimeAndSilenceCostPoints) {
    const Classroom course;
    write_text(course.path("rubric.json"), rubric_text(kItems, R"("limits": {"answer_s": 1}, )"));
    const GradeRecord hangs = course.graded(course.planted("hangs", "hangs"));
    EXPECT_EQ(hangs.points, 0);
    EXPECT_TRUE(contains(hangs.items[4].sentence, "did not answer within 1 s")) << hangs.items[4].sentence;
    EXPECT_TRUE(contains(course.graded(course.script("mute", "sleep 60")).failed, "did not answer within 1 s"));
    EXPECT_TRUE(contains(course.graded(course.script("none", "exit 0")).failed, "ended with exit code 0"));
}

TEST(Course, RubricsAreRefusedWithTheirPlace) {
    const Classroom course;
    const auto message = [&](const std::string& items, const std::string& more = "") -> std::string {
        write_text(course.path("rubric.json"), rubric_text(items, more));
        try {
            static_cast<void>(course.rubric());
        } catch (const std::exception& e) {
            return e.what();
        }
        return "accepted";
    };
    EXPECT_EQ(message(R"([{"name": "a", "of": "acne", "points": 1, "none": 1}])"), "accepted");
    EXPECT_TRUE(contains(message("[]"), "/items")) << message("[]");
    for (const auto& [item, why] : std::vector<std::pair<std::string, std::string>>{
             {R"({"name": "a", "of": "acme", "points": 1, "none": 1})", "/items/0/of"},
             {R"({"name": "a", "of": "acne", "points": 1})", "\"none\""},
             {R"({"name": "a", "of": "acne", "points": 1, "full": 1, "none": 0.5})", "/items/0/none"},
             {R"({"name": "a", "of": "acne", "none": 0.5})", "/items/0/points"},
             {R"({"name": "a", "of": "acne", "points": -1, "none": 0.5})", "/items/0/points"},
             {R"({"name": "a", "of": "time", "points": 1, "none": 2})", "\"against\""},
             {R"({"name": "a", "of": "time", "against": "rays", "points": 1, "none": 2})", "/items/0/against"},
             {R"({"name": "a", "of": "acne", "against": "ray_traced", "points": 1, "none": 2})", "\"against\""},
             {R"({"name": "a", "of": "acne", "points": 1, "none": 1, "scenes": ["stairs"]})", "/items/0/scenes/0"},
             {R"({"of": "acne", "points": 1, "none": 1})", "/items/0/name"}})
        EXPECT_TRUE(contains(message("[" + item + "]"), why)) << item << ": " << message("[" + item + "]");
    const std::string twice = R"({"name": "a", "of": "acne", "points": 1, "none": 1})";
    EXPECT_TRUE(contains(message("[" + twice + "," + twice + "]"), "/items/1/name"));
    EXPECT_TRUE(contains(message(kItems, R"("step": 0, )"), "/step"));
    EXPECT_TRUE(contains(message(kItems, R"("size": "big", )"), "/size"));
    EXPECT_TRUE(contains(message(kItems, R"("sise": "8x8", )"), "sise"));
    EXPECT_TRUE(contains(message(kItems, R"("limits": {"answer_s": -1}, )"), "/limits/answer_s"));
}

GradeRecord a_grade() {
    GradeRecord grade{.rubric = "Exercise <1>", .handed_in = "ann", .points = 4.5, .max = 7, .seconds = 2.2};
    grade.items = {{.name = "Acne", .about = "a", .of = "acne", .sentence = "none & none", .points = 3, .max = 3},
                   {.name = "Leaks", .of = "leak", .sentence = "1.5 of 4 points: <leaks>", .points = 1.5, .max = 4}};
    return grade;
}

TEST(Platforms, GetTheFieldsThatTheyDescribe) {
    const GradeRecord grade = a_grade();
    const auto of           = [](const std::string& text) { return Json::parse(text); };
    const Json gradescope   = of(gradescope_text(grade));
    EXPECT_EQ(gradescope["score"], 4.5);
    EXPECT_EQ(gradescope["execution_time"], 3);
    EXPECT_EQ(gradescope["tests"][0]["status"], "passed");
    EXPECT_EQ(gradescope["tests"][1]["status"], "failed");
    EXPECT_EQ(gradescope["tests"][1]["score"], 1.5);
    EXPECT_EQ(gradescope["tests"][1]["max_score"], 4);
    EXPECT_EQ(gradescope["tests"][1]["name"], "Leaks");
    EXPECT_EQ(gradescope["tests"][1]["output"], "1.5 of 4 points: <leaks>");
    EXPECT_EQ(gradescope["stdout_visibility"], "hidden");

    const std::string autolab = autolab_text(grade);
    EXPECT_EQ(autolab.find('\n'), autolab.size() - 1) << "one line";
    EXPECT_EQ(of(autolab)["scores"], (Json{{"Acne", 3.0}, {"Leaks", 1.5}}));
    EXPECT_EQ(of(autolab)["scoreboard"], (Json{4.5}));

    const Json prairie = of(prairielearn_text(grade));
    EXPECT_EQ(prairie["gradable"], true);
    EXPECT_NEAR(prairie["score"].get<double>(), 4.5 / 7, 1e-12);
    EXPECT_EQ(prairie["tests"][1]["points"], 1.5);
    EXPECT_EQ(prairie["tests"][1]["max_points"], 4);
    EXPECT_EQ(prairie["tests"][0]["description"], "a");

    setenv("CLASSROOM", "shadows", 1), setenv("COMMIT_URL", "https://example.org/c", 1), unsetenv("REVIEW_URL");
    const Json classroom = of(classroom50_text(grade, 1'700'000'000));
    EXPECT_EQ(classroom["schema"], "classroom50/result/v1");
    EXPECT_EQ(classroom["classroom"], "shadows");
    EXPECT_EQ(classroom["review"], "https://example.org/c");
    EXPECT_EQ(classroom["datetime"], "2023-11-14T22:13:20Z");
    EXPECT_EQ(classroom["score"], 9) << "4.5, and all are twice as many, so that 1.5 is whole";
    EXPECT_EQ(classroom["max-score"], 14);
    EXPECT_EQ(classroom["tests"][1]["test-name"], "Leaks");
    EXPECT_EQ(classroom["tests"][1]["score"], 3);
    EXPECT_EQ(classroom["tests"][1]["passed"], false);

    const std::string junit = grade_junit(grade);
    EXPECT_TRUE(contains(junit, R"(<testsuite name="Exercise &lt;1&gt;" tests="2" failures="1" errors="0">)")) << junit;
    EXPECT_TRUE(contains(junit, R"(<testcase classname="ann" name="Acne"/>)")) << junit;
    EXPECT_TRUE(contains(junit, R"(message="1.5 of 4 points">1.5 of 4 points: &lt;leaks&gt;</failure>)")) << junit;
}

TEST(Platforms, OfWhatFailedSayWhy) {
    GradeRecord grade = a_grade();
    grade.failed = "it ended", grade.points = 0;
    EXPECT_TRUE(contains(grade_junit(grade), "failures=\"0\" errors=\"1\""));
    EXPECT_TRUE(contains(grade_junit(grade), "</error>"));
    EXPECT_EQ(Json::parse(gradescope_text(grade))["output"], "it ended");
    EXPECT_EQ(Json::parse(prairielearn_text(grade))["message"], "it ended");
    EXPECT_EQ(Json::parse(prairielearn_text(grade))["gradable"], true);
}

TEST(CoursePages, ShowPointsAndPictures) {
    const Classroom course;
    const Submission one = course.planted("one", "lit");
    const std::vector<GradeRecord> grades{course.graded(one), course.graded(course.planted("two", "none"))};
    const std::string page = bytes_of(course.path("grades") / "one/index.html");
    EXPECT_TRUE(contains(page, "<b>6 of 10 points</b>")) << page;
    EXPECT_TRUE(contains(page, "<td>0 of 3</td>"));
    EXPECT_TRUE(contains(page, "Look at the floor."));
    EXPECT_TRUE(contains(page, "<b>Dark where it should be</b>: Wrong points, light “lamp”."));
    EXPECT_TRUE(contains(page, "<a href=\"#scene-1\">Picture</a>"));
    EXPECT_TRUE(contains(page, "board/index.html"));
    for (const char* file : {"slider.js", "pictures.js", "report.css", "gradescope.json", "autolab.json",
                             "prairielearn.json", "classroom50.json", "junit.xml"})
        EXPECT_TRUE(fs::exists(course.path("grades") / "one" / file)) << file;
    const ClassRecord all =
        write_class(course.rubric().record, grades, {"one", "two"}, "umbra grade", course.path("grades"));
    EXPECT_TRUE(contains(class_text(all), "two            10")) << class_text(all);
    const std::string csv = bytes_of(course.path("grades") / "grades.csv");
    EXPECT_TRUE(contains(csv, "handed_in,points,item Dark where it should be,")) << csv;
    EXPECT_TRUE(contains(csv, "\none,6.0,0.0,3.0,")) << csv;
    EXPECT_TRUE(contains(bytes_of(course.path("grades") / "index.html"), R"(<a href="two/index.html">two</a>)"));
}

TEST(CourseReport, HasChaptersInALanguageOfAFolder) {
    const Classroom course;
    make_folder(course.path("it"));
    write_text(course.path("it") / "texts.json", R"({"decimal_comma": true, "course": {"exercises": "Esercizi"}})");
    const auto with = [&](const std::string& more) {
        write_text(
            course.path("course.json"),
            R"({"title": "Ombre", "language": "it", "methods": ["ray_traced", "shadow_zbuffer:resolution=16"], )" +
                more + R"("chapters": [{"title": "Uno", "text": "A.\n\nB.", "scenes": ["board.json"],
 "exercises": [{"question": "Why?", "answer": "Texels."}]}, {"title": "Due", "scenes": ["board.json"]}]})");
        return read_course(course.path("course.json"),
                           [](const std::string& name) -> fs::path { throw UsageError("there is no scene " + name); });
    };
    CompareOptions options;
    options.out = course.path("out"), options.repeats = kOnce;
    make_folder(course.path("out"));
    write_text(course.path("out/course.pdf"), "of an earlier page");
    write_text(course.path("out/results.json"), R"({"schema": 2, "version": "0", "files": ["course.pdf"]})");
    EXPECT_EQ(write_course(with(""), options), std::vector<std::string>());
    EXPECT_FALSE(fs::exists(course.path("out/course.pdf"))) << "of an earlier page";
    const std::string page = bytes_of(course.path("out/index.html"));
    EXPECT_TRUE(contains(page, "<html lang=\"it\">"));
    EXPECT_TRUE(contains(page, "<h3>Esercizi</h3>"));
    EXPECT_TRUE(contains(page, ">Method</th>")) << "what the folder does not translate is English";
    EXPECT_TRUE(contains(page, "<p>A.</p>\n<p>B.</p>"));
    EXPECT_TRUE(contains(page, "Why?"));
    EXPECT_FALSE(contains(page, "Texels.")) << "answers are not asked for";
    EXPECT_FALSE(contains(bytes_of(course.path("out/results.json")), "Texels."));
    EXPECT_TRUE(contains(page, "Wrong points: Shadow z-buffer")) << "all of them at edges";
    EXPECT_TRUE(links_hold(course.path("out/index.html")));
    EXPECT_FALSE(fs::exists(course.path("out/board-2"))) << "two chapters share a comparison";
    const auto results = from_record<Results>(read_results(course.path("out/board/results.json")));
    EXPECT_GT(totals(results.methods.at(1)).interior + totals(results.methods.at(1)).edge, 0);
    EXPECT_TRUE(contains(page, fmt::format("<td>{}</td><td>{}</td>", count(totals(results.methods.at(1)).interior),
                                           count(totals(results.methods.at(1)).edge))))
        << page;
    EXPECT_EQ(write_course(with("\"answers\": true, "), options), std::vector<std::string>());
    EXPECT_TRUE(contains(bytes_of(course.path("out/index.html")), "Texels."));
    for (const char* wrong : {"\"answer\": true, ", "\"size\": \"big\", ", "\"methods\": [\"rays\"], "})
        EXPECT_THROW(with(wrong), InputError) << wrong;
    write_text(course.path("it") / "texts.json", R"({"course": {"esercizi": "Esercizi"}})");
    EXPECT_THROW(with(""), InputError) << "English has no such text";
}

}  // namespace
}  // namespace umbra
