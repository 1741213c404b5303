#include "umbra/bench/lab/point_answer.h"

#include <fmt/format.h>

#include <cmath>

#include "umbra/core/base/error.h"

namespace umbra {

TriangleRecord triangle_record(const Scene& scene, TriangleId t) {
    return {t, scene.objects[scene.triangle_object[t]].name};
}

namespace {

void add_reason(AnswerRecord& record, const Scene& scene, const Reason& reason) {
    record.answered = true;
    record.verdict  = to_string(reason.verdict);
    if (reason.blocker != kNoTriangle) record.blocker = triangle_record(scene, reason.blocker);
    if (reason.at) record.at = *reason.at;
    record.towards = {reason.towards.x, reason.towards.y, reason.towards.z};
    if (std::isfinite(reason.margin)) record.margin = reason.margin;
    record.unit = reason.unit;
    for (const dvec3& corner : reason.texel) record.texel.push_back({corner.x, corner.y, corner.z});
    for (const LightSample& s : reason.samples) record.samples.push_back({s.at.x, s.at.y, s.at.z, s.seen ? 1.0 : 0.0});
    for (const auto& [a, b] : reason.silhouette) record.silhouette.push_back({a.x, a.y, a.z, b.x, b.y, b.z});
    for (const Evidence& e : reason.evidence) {
        EvidenceRecord entry{.name = std::string(e.name), .unit = std::string(e.unit)};
        std::visit([&](const auto& value) { entry.value = value; }, e.value);
        record.evidence.push_back(std::move(entry));
    }
}

}  // namespace

AnswerRecord answer_record(MethodAtWork& work, const PointBatch& picture, std::size_t i, LightId light) {
    const Scene& scene = work.built().scene;
    AnswerRecord record{.method = work.choice().text()};
    try {
        const bool whole = work.choice().info->needs_raster;
        const auto which = static_cast<std::uint32_t>(i);
        PointBatch point = pick(picture, {&which, 1});
        if (!whole) point.raster.reset();
        const PointBatch& asked = whole ? picture : point;
        const std::size_t k     = whole ? i : 0;
        work.look(asked);
        VisibilityPlane plane(asked.size(), work.built().facts.has_coloured_filters);
        work.visibility(light, plane.out());
        const Given given{plane.s[k], plane.answer[k]};
        if (plane.defined(k)) record.visibility = given.s;
        add_reason(record, scene, work.method().explain(work.aimed(light), work.looked(), k, given));
        work.forget_look();
    } catch (...) {
        record.failed = current_message();
    }
    return record;
}

std::string decided_in_words(const Scene& scene, const PointBatch& points, LightId light, std::size_t i) {
    if (points.asks(light, i)) return "";
    if (!points.faces(light, i)) return "The light is behind the surface: S is 0 for every method.";
    return scene.switches(points.triangle[i]).receives_shadows
               ? "The point lies in the light: S is 1 for every method."
               : "The object receives no shadows: S is 1 for every method.";
}

std::optional<double> AnswerRecord::number(std::string_view name) const {
    for (const EvidenceRecord& e : evidence)
        if (const double* value = std::get_if<double>(&e.value); value && e.name == name) return *value;
    return std::nullopt;
}

namespace {

/// The margin, where it is a length.
std::optional<double> length_of_margin(const AnswerRecord& a) {
    return a.margin && a.unit == "world" ? std::optional(std::abs(*a.margin)) : std::nullopt;
}

std::string in_words(const EvidenceRecord& e) {
    const double* number = std::get_if<double>(&e.value);
    return fmt::format("{}: {}{}{}", e.name, number ? fmt::format("{:.6g}", *number) : text_of(e.value),
                       e.unit.empty() ? "" : " ", e.unit);
}

/// Of the segment that the answer's reason is about, world.
double length_of_segment(const AnswerRecord& a, const Scene& scene, const PointBatch& points, std::size_t i) {
    return glm::length(dvec3(a.towards[0], a.towards[1], a.towards[2]) - exact_position(scene, points, i));
}

/// What the method had before it when it answered otherwise than the truth. `own`: the point's triangle; `length`: of
/// the truth's segment.
std::string method_in_words(const AnswerRecord& method, const AnswerRecord& truth, TriangleId own, double length) {
    const bool too_dark = *method.visibility < *truth.visibility;
    std::string text;
    if (too_dark && method.blocker && method.blocker->triangle == own)
        text += " The method takes the point's own triangle for an occluder.";
    else if (too_dark && method.blocker && !(truth.blocker && truth.blocker->triangle == method.blocker->triangle))
        text += fmt::format(" The method names triangle {} of {}.", method.blocker->triangle, method.blocker->object);
    const auto stored = method.number("stored depth"), own_depth = method.number("depth of the point"),
               bias = method.number("bias towards the light"), width = method.number("width of the texel");
    if (!stored || !own_depth || !bias || !width) {
        for (const EvidenceRecord& e : method.evidence) text += fmt::format(" Its {}.", in_words(e));
        return text;
    }
    text += fmt::format(
        " The map's texel is {:.3g} wide here and stores depth {:.6g}; the point is at {:.6g}, less a bias of {:.3g}.",
        *width, *stored, *own_depth, *bias);
    if (const auto edge = length_of_margin(truth); edge && *edge < *width)
        text += " One depth stands for the whole texel, and the edge passes within its width.";
    else if (!too_dark && truth.blocker && truth.at && *bias > *truth.at * length)
        text += " The bias lifts the point past the occluder.";
    return text;
}

}  // namespace

std::string truth_in_words(const AnswerRecord& truth, const Scene& scene, const PointBatch& points, std::size_t i,
                           LightId light) {
    if (!truth.blocker) {
        const auto room = length_of_margin(truth);
        return room ? fmt::format("Nothing is in the way: the nearest occluder is {:.3g} from the segment.", *room)
               : *truth.visibility == 1 ? "The point sees all of the light."
                                        : fmt::format("The point sees {:.3g} of the light.", *truth.visibility);
    }
    const double length = length_of_segment(truth, scene, points, i);
    std::string text = fmt::format("Triangle {} of {} is in the way", truth.blocker->triangle, truth.blocker->object);
    if (truth.at) text += fmt::format(", {:.3g} from the point", *truth.at * length);
    if (truth.at && scene.lights[light].kind != LightKind::directional)
        text += fmt::format(" and {:.3g} from the light", (1 - *truth.at) * length);
    if (const auto edge = length_of_margin(truth)) text += fmt::format(", {:.3g} from its nearest edge", *edge);
    if (*truth.visibility > 0) text += fmt::format("; the point sees {:.3g} of the light", *truth.visibility);
    return text + ".";
}

void add_difference(AnswerRecord& method, const AnswerRecord& truth, const Scene& scene, const PointBatch& points,
                    std::size_t i, LightId light) {
    if (!method.visibility || !truth.visibility || *method.visibility == *truth.visibility) return;
    if (!method.answered || !truth.answered) return;  // the method of one threw when it was asked for its reason
    method.difference = truth_in_words(truth, scene, points, i, light) +
                        method_in_words(method, truth, points.triangle[i], length_of_segment(truth, scene, points, i));
}

std::string sentence(const AnswerRecord& a) {
    if (!a.failed.empty()) return a.failed;
    if (!a.not_served.empty()) return "does not serve this scene: " + a.not_served;
    std::string text = a.verdict;
    if (a.visibility) text += fmt::format(", S {:.4g}", *a.visibility);
    if (a.blocker) {
        text += fmt::format("; triangle {} of {} blocks", a.blocker->triangle, a.blocker->object);
        if (a.at) text += fmt::format(" at {:.4g} of the way to the light", *a.at);
    }
    if (a.margin) text += fmt::format("; margin {:.4g} {}", *a.margin, a.unit);
    for (const EvidenceRecord& e : a.evidence) text += "; " + in_words(e);
    return text;
}

}  // namespace umbra
