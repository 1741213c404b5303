#include "umbra/bench/report/course/grade.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/sweep/metrics.h"

namespace umbra {
namespace {

std::optional<double> part(std::optional<double> of, std::uint64_t all) {
    return of && all > 0 ? std::optional(*of / static_cast<double>(all)) : std::nullopt;
}

const Cause& cause_of(const std::string& of) { return *std::ranges::find(causes(), of, &Cause::name); }

/// At one light.
std::optional<double> figure_at(const ErrorRecord& e, const std::string& of) {
    const std::uint64_t points = e.points.value_or(0);
    if (of == "undefined") return part(static_cast<double>(e.undefined), points + e.undefined);
    if (of == "terminator") return part(static_cast<double>(e.terminator.wrong), e.terminator.normal_away);
    if (of == "displacement")
        return e.edge_displacement_px ? known(e.edge_displacement_px->p95) : std::optional<double>();
    if (of == "penumbra_width") {
        if (!e.penumbra_width_px || !(e.penumbra_width_px->reference > 0)) return std::nullopt;
        return known(std::abs(e.penumbra_width_px->method / e.penumbra_width_px->reference - 1));
    }
    if (of == "bias") return e.bias ? std::optional(std::abs(*e.bias)) : std::nullopt;
    const Metric& metric              = find_metric(cause_of(of).metric);
    const std::optional<double> value = metric.of_light(e);
    return metric.kind == Metric::Kind::share ? part(value, points) : value;
}

/// The nearest multiple of a step; of a tenth as a decimal has it.
double stepped(double points, double step) {
    const double parts = std::round(1 / step);
    const bool whole   = std::abs(parts * step - 1) < 1e-9;
    return whole ? std::round(points * parts) / parts : std::round(points / step) * step;
}

/// A sum of decimals as decimals have it.
double without_noise(double sum) { return std::round(sum * 1e9) / 1e9; }

/// A figure that others have on the scene, or that cannot be had of it, is no merit. Empty: nothing there asks for it.
std::string why_without(const RubricItemRecord& item, const Results& results, const MethodRecord& method) {
    if (item.of == "time") return method.times ? "" : "it has no time";
    if (std::ranges::all_of(method.errors,
                            [](const ErrorRecord& e) { return e.points.value_or(0) == 0 && e.undefined > 0; }))
        return "none of its points is answered";
    for (const MethodRecord& other : results.methods)
        if (figure_of(results, other, item.of, ""))
            return "its answers have no edge or penumbra to measure, and others' have";
    return "";
}

/// One item on one scene.
GradedSceneRecord graded(const RubricItemRecord& item, const Compared& scene) {
    GradedSceneRecord found{.scene = scene.folder};
    const MethodRecord* method = scene.record();
    const bool failed = method == nullptr || method->failed, refused = !failed && method->serves.how == "not";
    found.unanswered = failed;
    if (failed || refused) found.why = scene.why_not();
    if (item.of == "failed" || item.of == "refused") {
        found.figure = (item.of == "failed" ? failed : refused) ? 1 : 0;
    } else if (failed || refused) {
        found.credit = 0;
        return found;
    } else if (const auto figure = figure_of(scene.results, *method, item.of, item.against)) {
        found.figure = figure->value, found.light = figure->light;
    } else {
        found.why = why_without(item, scene.results, *method);
        if (!found.why.empty()) found.credit = 0;
        return found;
    }
    found.credit = std::clamp((item.none - *found.figure) / (item.none - item.full), 0.0, 1.0);
    return found;
}

std::string cause_in_words(const std::string& of, const GradedSceneRecord& found, const std::string& against) {
    if (of == "failed") return *found.figure > 0 ? "it failed: " + found.why : "it did not fail";
    if (of == "refused") return *found.figure > 0 ? "it is not served: " + found.why : "it is served";
    std::string text = fmt::format(fmt::runtime(cause_of(of).says), figure_in_words(of, *found.figure));
    if (!against.empty()) text += fmt::format(" ({})", against);
    return found.light.empty() ? text : text + fmt::format(", light {}", found.light);
}

/// The scene that tells most: of the least credit, the first.
const GradedSceneRecord* worst_of(const std::vector<GradedSceneRecord>& scenes) {
    const GradedSceneRecord* worst = nullptr;
    for (const GradedSceneRecord& scene : scenes)
        if (std::isfinite(scene.credit) && (worst == nullptr || scene.credit < worst->credit)) worst = &scene;
    return worst;
}

std::size_t counting(const std::vector<GradedSceneRecord>& scenes) {
    return static_cast<std::size_t>(
        std::ranges::count_if(scenes, [](const GradedSceneRecord& scene) { return std::isfinite(scene.credit); }));
}

std::string sentence_of(const GradedItemRecord& item, const RubricItemRecord& asked, const std::string& failed) {
    if (!failed.empty()) return fmt::format("0 of {:g} points: {}", item.max, failed);
    const GradedSceneRecord* worst = worst_of(item.scenes);
    const std::string points       = fmt::format("{:g} of {:g} points", item.points, item.max);
    if (worst == nullptr) return points + ": nothing on the scenes asks for this.";
    const std::size_t scenes = counting(item.scenes);
    const std::string where  = fmt::format("{}{}", scenes > 1 && worst->credit < 1 ? "worst on " : "on ", worst->scene);
    const std::string mean   = scenes > 1 && worst->credit < 1 ? fmt::format(" Mean of {} scenes.", scenes) : "";
    if (!worst->figure) return fmt::format("{}: {}, {}.{}", points, where, worst->why, mean);
    std::string text = fmt::format("{}: {}, {}.", points, where, cause_in_words(item.of, *worst, asked.against));
    if (worst->credit < 1 && item.of != "failed" && item.of != "refused")
        text += fmt::format(" All points are given up to {}, none from {}.", figure_in_words(item.of, asked.full),
                            figure_in_words(item.of, asked.none));
    return text + mean;
}

}  // namespace

const MethodRecord* Compared::record() const {
    const auto found = std::ranges::find(results.methods, method, &MethodRecord::id);
    return found == results.methods.end() ? nullptr : &*found;
}

std::string Compared::why_not() const {
    const MethodRecord* answers = record();
    if (answers == nullptr) return why;
    return answers->failed ? answers->failed->message : answers->serves.why;
}

std::optional<Figure> figure_of(const Results& results, const MethodRecord& method, const std::string& of,
                                const std::string& against) {
    if (of == "time") {
        const auto other = std::ranges::find(results.methods, against, &MethodRecord::text);
        if (other == results.methods.end()) return std::nullopt;
        const auto ms = totals(method).object_ms, than = totals(*other).object_ms;
        if (!ms || !than || !(*than > 0)) return std::nullopt;
        return Figure{*ms / *than};
    }
    std::optional<Figure> most;
    for (const ErrorRecord& error : method.errors)
        if (const auto value = figure_at(error, of); value && (!most || *value > most->value))
            most = {*value, error.light};
    return most;
}

std::string figure_in_words(const std::string& of, double figure) {
    const std::string_view unit = cause_of(of).unit;
    if (unit == "%") return percent(figure) + " %";
    if (unit == "px") return fmt::format("{} px", score(figure));
    return unit == "x" ? fmt::format("{} times", score(figure)) : score(figure);
}

void grade(GradeRecord& record, const RubricRecord& rubric, const std::vector<Compared>& scenes) {
    record.rubric = rubric.title, record.points = 0, record.max = 0;
    for (const RubricItemRecord& asked : rubric.items) {
        GradedItemRecord item{.name = asked.name, .about = asked.about, .of = asked.of, .max = asked.points};
        double credit = 0;
        int telling   = 0;
        for (const Compared& scene : scenes) {
            if (!asked.scenes.empty() && std::ranges::find(asked.scenes, scene.asked) == asked.scenes.end()) continue;
            item.scenes.push_back(graded(asked, scene));
            if (!std::isfinite(item.scenes.back().credit)) continue;
            credit += item.scenes.back().credit;
            ++telling;
        }
        const bool compared = record.failed.empty() && !item.scenes.empty();
        const double exact  = telling > 0 ? asked.points * credit / telling : compared ? asked.points : 0;
        item.points         = std::min(asked.points, stepped(exact, rubric.step));
        item.sentence       = sentence_of(item, asked, record.failed);
        record.points = without_noise(record.points + item.points), record.max = without_noise(record.max + item.max);
        record.items.push_back(std::move(item));
    }
}

}  // namespace umbra
