#include "umbra/bench/compare/record.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/run/describe.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

Json parameters_json(const Settings& settings) {
    Json values = Json::object();
    for (const Parameter& p : settings.parameters())
        values[std::string(p.name)] =
            p.type == Parameter::Type::text ? Json(settings.text(p)) : setting_json(p, settings.value(p.name));
    return values;
}

Json displacement_json(const std::optional<EdgeDisplacement>& d) {
    if (!d) return {};
    const auto of_matched = [&](double value) { return d->unmatched < d->pieces ? number(value) : Json(); };
    return {{"mean", of_matched(d->mean)}, {"p95", of_matched(d->p95)}, {"max", of_matched(d->max)},
            {"pieces", d->pieces},         {"unmatched", d->unmatched}, {"reach", kFarthest}};
}

Json penumbra_json(const std::optional<PenumbraWidth>& w) {
    if (!w) return {};
    return {{"method", number(w->method)}, {"reference", number(w->reference)}};
}

Json noise_json(const std::optional<Noise>& n) {
    if (!n) return {};
    return {{"runs", n->runs}, {"noise_rmse", number(n->rms)}, {"bias_rmse", number(n->bias)}};
}

Json direction_json(const VisibilityError::Direction& d) {
    return {{"false_shadow", d.false_shadow}, {"false_light", d.false_light}};
}

Json error_json(const std::string& light, const Explained& explained) {
    const VisibilityError& e = explained.error;
    // Detachment and leak are distinguished by the occluder: null where the reference names none.
    const bool named = e.unnamed == 0;
    // Where no point is compared, nothing is known to be right: null, not 0.
    const auto counted  = [&](std::uint64_t n) { return e.points == 0 ? Json() : Json(n); };
    const auto measured = [&](double x) { return e.points == 0 ? Json() : number(x); };
    return {{"light", light},
            {"points", e.points},
            {"undefined", e.undefined},
            {"away", e.away},
            {"on_boundary", e.on_boundary},
            {"not_judged", e.not_judged},
            {"lit", e.lit},
            {"umbra", e.umbra},
            {"penumbra", e.penumbra},
            {"false_shadow",
             {{"interior", counted(e.false_shadow.interior)},
              {"edge", counted(e.false_shadow.edge)},
              {"acne", counted(e.acne)}}},
            {"false_light",
             {{"interior", counted(e.false_light.interior)},
              {"edge", counted(e.false_light.edge)},
              {"detachment", named ? counted(e.detachment) : Json()},
              {"leak", named ? counted(e.leak) : Json()}}},
            {"interior", {{"lit", e.interior.lit}, {"umbra", e.interior.umbra}, {"penumbra", e.interior.penumbra}}},
            {"penumbra_error", direction_json(e.penumbra_error)},
            {"noise_error", direction_json(e.noise_error)},
            {"terminator",
             {{"facet_away", e.terminator.facet_away},
              {"normal_away", e.terminator.normal_away},
              {"wrong", e.terminator.wrong}}},
            {"bracket", e.max_half_width > 0 ? Json{{"max_half_width", number(e.max_half_width)}} : Json()},
            {"mae", measured(e.mae)},
            {"rmse", measured(e.rmse)},
            {"max", measured(e.max)},
            {"bias", measured(e.bias)},
            {"noise", noise_json(explained.noise)},
            {"edge_displacement_px", displacement_json(explained.displacement)},
            {"penumbra_width_px", penumbra_json(explained.penumbra_width)}};
}

Json judged_json(const ReferenceRun& reference) {
    if (reference.stand_in.empty()) return nullptr;
    return {{"points", reference.judged}, {"of", reference.of}, {"guess", reference.stand_in}};
}

/// What is known of a method before it runs.
Json head_json(const std::string& id, const MethodChoice& choice, const Service& service) {
    const MethodInfo& info = *choice.info;
    return {{"id", id},
            {"name", info.name},
            {"title", info.title},
            {"paper", info.paper},
            {"summary", info.summary},
            {"text", choice.text()},
            {"parameters", parameters_json(choice.settings)},
            {"serves", service_json(service)}};
}

/// `cut`: true where it was, and otherwise not there.
Json failure_json(const Failure& failure, const Scene& scene) {
    Json failed = {{"light", failure.light ? Json(scene.lights[*failure.light].name) : Json()},
                   {"message", failure.message}};
    if (failure.cut) failed["cut"] = true;
    return failed;
}

std::string failed_in_words(const Json& failed) {
    return fmt::format("It failed{}: {}",
                       failed["light"].is_string() ? " at light " + failed["light"].get<std::string>() : "",
                       failed["message"].get<std::string>());
}

Json times_json(const MethodRun& run) {
    return {{"build_ms", timing_json(run.build)},
            {"aim_ms", timing_json(total(run.aim))},
            {"look_ms", timing_json(run.look)},
            {"visibility_ms", timing_json(total(run.visibility))}};
}

}  // namespace

Json reference_json(const Truth& truth, const Scene& scene) {
    const auto& [reference, ran, failed] = truth;
    Json record                          = {{"name", reference.choice.info->name},
                                            {"title", reference.choice.info->title},
                                            {"text", reference.choice.text()},
                                            {"parameters", parameters_json(reference.choice.settings)},
                                            {"exact", reference.exact},
                                            {"note", reference.note},
                                            {"judged", judged_json(ran)},
                                            {"times", times_json(ran.run)}};
    if (failed) {
        record["failed"]           = failure_json(*failed, scene);
        record["failed"]["method"] = failed->method;
    }
    return record;
}

Json served_json(const std::string& id, const PreparedScene& prepared, const Outcome& found,
                 const std::string& reference) {
    const MethodRun& run  = found.run;
    Json entry            = head_json(id, run.choice, run.service);
    entry["times"]        = nullptr;
    entry["light_times"]  = nullptr;
    entry["memory_bytes"] = run.memory_bytes;
    entry["points_bytes"] = run.points_bytes;
    if (run.device_bytes > 0) entry["device_bytes"] = run.device_bytes;
    const auto covered     = run.coverage(prepared.points);
    entry["coverage"]      = covered ? Json(*covered) : Json();
    entry["measures"]      = to_string(run.work->method().measures());
    entry["compared_with"] = reference;
    Json& errors = entry["errors"] = Json::array();
    for (LightId j = 0; j < prepared.scene.lights.size(); ++j) {
        errors.push_back(error_json(prepared.scene.lights[j].name, found.explained[j]));
        if (const auto unshadowed = found.explained[j].error.unshadowed; unshadowed > 0)
            errors.back()["unshadowed"] = unshadowed;
    }
    return entry;
}

void set_times(Json& entry, const Scene& scene, const TurnTimes& times) {
    entry["times"]    = turn_times_json(times);
    Json& light_times = entry["light_times"] = Json::array();
    for (LightId j = 0; j < scene.lights.size(); ++j)
        light_times.push_back({{"light", scene.lights[j].name},
                               {"aim_ms", timing_json(timing_of(times.light_aim[j]))},
                               {"visibility_ms", timing_json(timing_of(times.light_visibility[j]))}});
}

Json turns_json(const Turns& turns, const TurnOptions& options, std::pair<double, double> load) {
    Json record = {{"rounds", turns.calibration.size()},
                   {"seed", options.seed},
                   {"threads", thread_count()},
                   {"processors", usable_processors()},
                   {"pinned", turns.pinned},
                   {"load_average", {{"before", number(load.first)}, {"after", number(load.second)}}},
                   {"calibration_ms", turns.calibration},
                   {"noise_bar", number(turns.noise_bar)},
                   {"control", nullptr}};
    if (turns.control && !turns.twin->build.empty())
        record["control"] = {{"text", turns.twin->choice.text()}, {"again", turn_times_json(*turns.twin)}};
    return record;
}

Json unserved_json(const std::string& id, const MethodChoice& choice, const Service& service) {
    return head_json(id, choice, service);
}

Json failed_json(const std::string& id, const MethodChoice& choice, const Scene& scene, const Failure& failure) {
    const Json failed = failure_json(failure, scene);
    Json entry        = head_json(id, choice, {How::not_at_all, failed_in_words(failed)});
    entry["failed"]   = failed;
    return entry;
}

std::string failure_in_words(const std::string& scene, const std::string& method, const Json& failed) {
    return fmt::format("{}: {}: {}", scene, method, failed_in_words(failed));
}

std::vector<std::string> failures(const Json& record) {
    std::vector<std::string> messages;
    const auto add = [&](const std::string& method, const Json& failed) {
        messages.push_back(failure_in_words(record["scene"]["name"], method, failed));
    };
    if (const Json& reference = record["reference"]; reference.contains("failed"))
        add(reference["failed"]["method"], reference["failed"]);
    for (const Json& method : record["methods"])
        if (method.contains("failed")) add(method["text"], method["failed"]);
    // The reference may also be one of the methods.
    std::vector<std::string> once;
    for (std::string& message : messages)
        if (std::ranges::find(once, message) == once.end()) once.push_back(std::move(message));
    return once;
}

/// The record with every file name set behind `prefix`.
Json with_prefix(Json record, const std::string& prefix) {
    const auto visit = [&](auto&& self, Json& node) -> void {
        for (auto& item : node.items()) {
            if (item.value().is_string())
                item.value() = prefix + item.value().get<std::string>();
            else
                self(self, item.value());
        }
    };
    if (record["reference"].contains("files")) visit(visit, record["reference"]["files"]);
    for (Json& method : record["methods"])
        if (method.contains("files")) visit(visit, method["files"]);
    return record;
}

}  // namespace umbra
