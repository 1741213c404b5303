#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/cli/course_command.h"

namespace umbra {
namespace {

struct GradeLine {
    std::vector<std::string> folders;
    bool unprotected = false;
    CourseLine course;
};

int grade_class(const GradeLine& line, const Common& common) {
    if (line.course.rubric.empty()) throw UsageError("grade: --rubric FILE is required");
    if (line.folders.empty()) throw UsageError("grade: a FOLDER that was handed in is required");
    const Rubric rubric = rubric_on_line(line.course);
    if (!line.unprotected && !can_keep_apart())
        throw UsageError(
            "grade: bubblewrap (bwrap) is not there or may not keep programs apart from files and network here, so what "
            "was handed in would run with your rights: install bubblewrap, or say --unprotected where something else, "
            "such as a container, keeps it apart");
    std::vector<Submission> all;
    std::vector<std::string> folders;  // theirs, below the output folder
    int code = kDone;
    for (const std::string& folder : line.folders) {
        if (!fs::is_directory(folder)) {
            print_error("{}: is no folder, and is left out\n", folder);
            code = kUnreadable;
            continue;
        }
        all.push_back(folder_handed_in(folder));
        folders.push_back(folder_name(all.back().name));
        if (std::ranges::count(folders, folders.back()) > 1)
            throw UsageError(fmt::format("{}: two folders are called {}", folder, all.back().name));
    }
    const std::string key = rubric_key(rubric);
    std::vector<GradeRecord> grades;
    for (std::size_t k = 0; k < all.size(); ++k)
        grades.push_back(judge_on_terminal(
            all[k], rubric,
            {.out = line.course.out / folders[k], .protect = !line.unprotected, .embed = line.course.embed, .key = key},
            common));
    const ClassRecord record = write_class(rubric.record, grades, folders, common.command, line.course.out);
    print_record(line.course.as_json, common, to_record(record), [&] {
        std::string text;
        for (const GradeRecord& grade : grades) text += grade_text(grade);
        return text + (grades.size() > 1 ? "\n" + class_text(record) : "") + (line.course.out / "index.html").string() +
               "\n";
    });
    for (const GradeRecord& grade : grades)
        if (!grade.not_compared.empty()) code = kUnreadable;
    return code;
}

}  // namespace

Action grade_command(CLI::App& app, const Common& common) {
    const auto line = std::make_shared<GradeLine>();
    app.add_option("FOLDER", line->folders, "Folders that were handed in: each with a program or with answers")
        ->type_name("");
    add_course_options(app, line->course);
    app.add_flag("--unprotected", line->unprotected,
                 "Run programs with the rights of this process: where something else keeps them apart");
    return [line, &common] { return grade_class(*line, common); };
}

}  // namespace umbra
