// What `handin` and `grade` share.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "umbra/bench/base/files.h"
#include "umbra/bench/cli/command.h"
#include "umbra/bench/cli/names.h"
#include "umbra/bench/cli/options.h"
#include "umbra/bench/report/course/apart.h"
#include "umbra/bench/report/course/grade_page.h"
#include "umbra/bench/report/course/judge.h"
#include "umbra/core/base/error.h"

namespace umbra {

namespace fs = std::filesystem;

struct CourseLine {
    std::string rubric;
    fs::path out;
    bool embed = false, as_json = false;
};
/// --rubric FILE, -o DIR, --embed, --json.
void add_course_options(CLI::App& app, CourseLine& line);

/// Throws InputError.
[[nodiscard]] Rubric rubric_on_line(const CourseLine& line);

[[nodiscard]] Submission folder_handed_in(const std::string& folder);

/// judge() with its progress.
GradeRecord judge_on_terminal(const Submission& handed_in, const Rubric& rubric, JudgeOptions options,
                              const Common& common);

}  // namespace umbra
