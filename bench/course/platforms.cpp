#include "umbra/bench/course/platforms.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

bool full(const GradedItemRecord& item) { return item.points >= item.max; }

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
    for (const GradedItemRecord& item : grade.items) {
        const auto points = static_cast<std::int64_t>(std::floor(item.points)),
                   max    = static_cast<std::int64_t>(std::floor(item.max));
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
    int lost = 0;
    for (const GradedItemRecord& item : grade.items) lost += full(item) ? 0 : 1;
    std::string text = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n"
        "<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\">\n",
        xml_text(grade.rubric), grade.items.size(), lost);
    for (const GradedItemRecord& item : grade.items) {
        text += fmt::format("<testcase classname=\"{}\" name=\"{}\"", xml_text(grade.handed_in), xml_text(item.name));
        text += full(item) ? "/>\n"
                           : fmt::format(
                                 ">\n<failure type=\"points\" message=\"{:g} of {:g} points\">{}</failure>\n"
                                 "</testcase>\n",
                                 item.points, item.max, xml_text(item.sentence));
    }
    return text + "</testsuite>\n</testsuites>\n";
}

}  // namespace umbra
