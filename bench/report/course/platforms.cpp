#include "umbra/bench/report/course/platforms.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

bool full(const GradedItemRecord& item) { return item.points >= item.max; }

/// The least factor, up to 100, that makes all points whole numbers; 100 where none does.
int scale_to_whole(const GradeRecord& grade) {
    const auto whole = [](double points) { return std::abs(points - std::round(points)) < 1e-6; };
    for (int scale = 1; scale < 100; ++scale)
        if (std::ranges::all_of(grade.items, [&](const GradedItemRecord& item) {
                return whole(item.points * scale) && whole(item.max * scale);
            }))
            return scale;
    return 100;
}

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

}  // namespace

// https://gradescope-autograders.readthedocs.io/en/latest/specs/
std::string gradescope_text(const GradeRecord& grade) {
    Json json{
        {"score", grade.points},
        {"execution_time", std::ceil(grade.seconds)},
        {"output", grade.failed.empty() ? fmt::format("{}: {:g} of {:g} points", grade.rubric, grade.points, grade.max)
                                        : grade.failed},
        {"output_format", "text"},
        {"stdout_visibility", "hidden"},
        {"tests", Json::array()}};
    for (const GradedItemRecord& item : grade.items)
        json["tests"].push_back({{"name", item.name},
                                 {"score", item.points},
                                 {"max_score", item.max},
                                 {"status", full(item) ? "passed" : "failed"},
                                 {"output", item.sentence},
                                 {"visibility", "visible"}});
    return json_text(json);
}

// https://docs.autolabproject.com/lab/: {"scores": {PROBLEM: POINTS}, "scoreboard": [...]}
std::string autolab_text(const GradeRecord& grade) {
    Json json{{"scores", Json::object()}, {"scoreboard", {grade.points}}};
    for (const GradedItemRecord& item : grade.items) json["scores"][item.name] = item.points;
    return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

// https://docs.prairielearn.com/externalGrading/: what is wrong with a program is a result, too, not a submission that
// cannot be graded.
std::string prairielearn_text(const GradeRecord& grade) {
    Json json{{"gradable", true},
              {"score", grade.max > 0 ? grade.points / grade.max : 0},
              {"message", grade.failed.empty() ? grade.rubric : grade.failed},
              {"tests", Json::array()}};
    for (const GradedItemRecord& item : grade.items)
        json["tests"].push_back({{"name", item.name},
                                 {"description", item.about},
                                 {"points", item.points},
                                 {"max_points", item.max},
                                 {"message", item.sentence}});
    return json_text(json);
}

// https://github.com/foundation50/classroom50/wiki/Advanced-Autograding
std::string classroom50_text(const GradeRecord& grade, std::int64_t now) {
    const std::string commit = environment("COMMIT_URL"), review = environment("REVIEW_URL");
    const auto seconds = static_cast<std::time_t>(now);
    Json json{{"schema", "classroom50/result/v1"},
              {"classroom", environment("CLASSROOM")},
              {"assignment", environment("ASSIGNMENT")},
              {"submission", environment("SUBMISSION_TAG")},
              {"commit", commit},
              {"release", environment("RELEASE_URL")},
              {"review", review.empty() ? commit : review},
              {"datetime", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(seconds))},
              {"score", 0},
              {"max-score", 0},
              {"tests", Json::array()}};
    std::int64_t score = 0, most = 0;
    const int scale = scale_to_whole(grade);
    for (const GradedItemRecord& item : grade.items) {
        const auto points = static_cast<std::int64_t>(std::floor(item.points * scale + 1e-6)),
                   max    = static_cast<std::int64_t>(std::floor(item.max * scale + 1e-6));
        score += points, most += max;
        json["tests"].push_back({{"test-name", item.name},
                                 {"passed", full(item)},
                                 {"score", points},
                                 {"max-score", max},
                                 {"message", item.sentence}});
    }
    json["score"] = score, json["max-score"] = most;
    return json_text(json);
}

std::string grade_junit(const GradeRecord& grade) {
    const std::string lost = grade.failed.empty() ? "failure" : "error";
    std::vector<JunitCase> cases;
    for (const GradedItemRecord& item : grade.items)
        cases.push_back({.classname = grade.handed_in,
                         .name      = item.name,
                         .problem   = full(item) ? "" : lost,
                         .type      = "points",
                         .message   = fmt::format("{:g} of {:g} points", item.points, item.max),
                         .text      = item.sentence});
    return junit_text(grade.rubric, cases);
}

}  // namespace umbra
