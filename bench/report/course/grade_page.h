// The page of a grade, and the table of a class.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/report/course/grade.h"
#include "umbra/bench/report/course/rubric.h"

namespace umbra {

/// FOLDER/index.html, its style and scripts. The folders of the scenes lie in `folder`.
void write_grade_page(const GradeRecord& grade, const RubricRecord& rubric, const std::vector<Compared>& scenes,
                      const std::filesystem::path& folder, StagedFiles& staged);

/// Points and a sentence an item, as a terminal shows them.
[[nodiscard]] std::string grade_text(const GradeRecord& grade);

struct ClassRowRecord {
    std::string handed_in{}, folder{}, failed{};
    double points = kUnknown;
    std::vector<double> items{};
};
DESCRIBE(ClassRowRecord) {
    of.name("class_row", "one that was handed in");
    MEMBERS(handed_in);
    of(MEMBER(folder), "its results");
    of.may(MEMBER(failed), "why nothing could be asked of it");
    MEMBERS(points);
    of(MEMBER(items), "points of each, in the order of the record's `items`");
}

struct ClassRecord {
    HeadRecord head{};
    std::string rubric{};
    double max = kUnknown;
    std::vector<std::string> items{};
    std::vector<ClassRowRecord> rows{};
    std::vector<std::string> csv{};
};
DESCRIBE(ClassRecord) {
    of.all(&R::head);
    of(MEMBER(rubric), "its title");
    of(MEMBER(max), "points that there are");
    MEMBERS(items, rows, csv);
}

/// OUT/index.html, grades.csv, results.json. `folders`: of each grade, in `out`.
ClassRecord write_class(const RubricRecord& rubric, const std::vector<GradeRecord>& grades,
                        const std::vector<std::string>& folders, const std::string& command,
                        const std::filesystem::path& out);

/// The table, as a terminal shows it.
[[nodiscard]] std::string class_text(const ClassRecord& record);

}  // namespace umbra
