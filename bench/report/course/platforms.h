// A grade as the platforms of courses read it: one file each, all of the same record.
#pragma once

#include <string>

#include "umbra/bench/report/course/grade.h"

namespace umbra {

/// results.json of Gradescope: a test an item.
[[nodiscard]] std::string gradescope_text(const GradeRecord& grade);
/// The last line of an Autolab grader's output: the points of the problems that are called as the items.
[[nodiscard]] std::string autolab_text(const GradeRecord& grade);
/// results.json of PrairieLearn's external graders: a score of 0 to 1, a test an item.
[[nodiscard]] std::string prairielearn_text(const GradeRecord& grade);
/// result.json of Classroom 50 (classroom50/result/v1), whose points are whole numbers: where some are not, all are
/// multiplied by the least factor that makes them so. Names
/// and addresses are those of its runner's environment; `now`: seconds since 1970, UTC.
[[nodiscard]] std::string classroom50_text(const GradeRecord& grade, std::int64_t now);
/// JUnit XML: a test case an item; a failure where points are lost, an error where nothing could be asked.
[[nodiscard]] std::string grade_junit(const GradeRecord& grade);

}  // namespace umbra
