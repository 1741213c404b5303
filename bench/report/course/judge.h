// What was handed in, compared on the scenes of a rubric and graded: a folder with a page, the comparisons, the record,
// and what the platforms of courses read.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "umbra/bench/report/course/grade.h"
#include "umbra/bench/report/course/rubric.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// A method that this process has, or a folder: with a program (every file that the rubric's `run` names), or with
/// answers (SCENE.npy or SCENE.exr).
struct Submission {
    std::string name;
    std::filesystem::path folder{};  ///< absolute; empty: the method
    std::optional<MethodChoice> method{};
};

struct JudgeOptions {
    std::filesystem::path out;  ///< of this submission
    std::string command{};
    int threads  = 0;
    bool protect = true;   ///< run programs apart (apart.h)
    bool embed   = false;  ///< write OUT/page.html, too: the page as one file
    std::string key{};     ///< rubric_key(); a record of an equal key in `out` is kept. Empty: none is
    std::function<void(const std::string&)> progress{};
};

/// Of all that points depend on besides what was handed in: rubric, scenes, code. Throws InputError where a scene cannot be
/// read.
[[nodiscard]] std::string rubric_key(const Rubric& rubric);

/// Writes OUT/index.html, results.json, a folder a scene, and gradescope.json, autolab.json, prairielearn.json,
/// classroom50.json, junit.xml. What the submission does wrong is in the record. Throws InputError where `out` cannot be
/// written.
GradeRecord judge(const Submission& handed_in, const Rubric& rubric, const JudgeOptions& options);

}  // namespace umbra
