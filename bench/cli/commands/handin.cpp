#include <fmt/format.h>

#include "umbra/bench/cli/course_command.h"

namespace umbra {
namespace {

struct HandinLine {
    std::string what;
    std::vector<std::string> scenes;
    CourseLine course;
};

int handin(const HandinLine& line, const Common& common) {
    if (line.what.empty())
        throw UsageError("handin: a method, or a folder with a program or with answers, is required");
    if (!line.course.rubric.empty() && !line.scenes.empty())
        throw UsageError("handin: the scenes are those of the rubric, expected no SCENE beside --rubric");
    if (line.course.rubric.empty() && line.scenes.empty())
        throw UsageError("handin: --rubric FILE or a SCENE is required");
    const Rubric rubric =
        line.course.rubric.empty() ? rubric_of(scene_files(line.scenes, common.up)) : rubric_on_line(line.course);
    Submission handed_in = fs::is_directory(line.what) ? folder_handed_in(line.what) : Submission{line.what};
    if (handed_in.folder.empty()) try {
            handed_in.method = parse_method(line.what);
        } catch (const UsageError& e) {
            throw UsageError(fmt::format("handin {}: is no folder, and no method: {}", line.what, e.what()));
        }
    const GradeRecord grade = judge_on_terminal(
        handed_in, rubric, {.out = line.course.out, .protect = can_keep_apart(), .embed = line.course.embed}, common);
    print_record(line.course.as_json, common, to_record(grade),
                 [&] { return grade_text(grade) + (line.course.out / "index.html").string() + "\n"; });
    return grade.not_compared.empty() ? kDone : kUnreadable;
}

}  // namespace

Action handin_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<HandinLine>();
    app.add_option("METHOD|FOLDER", line->what,
                   "What is handed in: a method, or a folder with a program or with a file of answers a scene")
        ->type_name("");
    add_scenes(app, line->scenes, "Scenes, where no rubric names them");
    add_course_options(app, line->course);
    return [line, &common] { return handin(*line, common); };
}

}  // namespace umbra
