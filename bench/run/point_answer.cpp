#include "umbra/bench/run/point_answer.h"

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
    for (const EvidenceRecord& e : a.evidence) {
        const double* number = std::get_if<double>(&e.value);
        text += fmt::format("; {}: {}{}{}", e.name, number ? fmt::format("{:.6g}", *number) : text_of(e.value),
                            e.unit.empty() ? "" : " ", e.unit);
    }
    return text;
}

}  // namespace umbra
