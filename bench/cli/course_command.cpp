#include "umbra/bench/cli/course_command.h"

namespace umbra {

void add_course_options(CLI::App& app, CourseLine& line) {
    app.add_option("--rubric", line.rubric, "Scenes, limits and points by cause of error (docs/course.md)")
        ->type_name("FILE");
    add_output(app, line.out);
    app.add_flag("--embed", line.embed, "Write the page also as one file, its pictures inside: page.html");
    add_json(app, line.as_json, "the points");
}

Rubric rubric_on_line(const CourseLine& line) {
    return read_rubric(line.rubric, [](const std::string& name) { return scene_file(name); });
}

Submission folder_handed_in(const std::string& folder) {
    const fs::path whole = fs::weakly_canonical(fs::absolute(folder));
    return {.name = whole.filename().string(), .folder = whole};
}

GradeRecord judge_on_terminal(const Submission& handed_in, const Rubric& rubric, JudgeOptions options,
                              const Common& common) {
    return on_terminal(common, options, [&] { return judge(handed_in, rubric, options); });
}

}  // namespace umbra
