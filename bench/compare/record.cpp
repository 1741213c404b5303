#include "umbra/bench/compare/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "umbra/bench/base/statistics.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

using Count = std::optional<std::uint64_t>;

std::optional<DisplacementRecord> displacement_record(const std::optional<EdgeDisplacement>& d) {
    if (!d) return {};
    const auto of_matched = [&](double value) { return d->unmatched < d->pieces ? value : kUnknown; };
    return DisplacementRecord{of_matched(d->mean), of_matched(d->p95), of_matched(d->max),
                              d->pieces,           d->unmatched,       kFarthest};
}

ErrorRecord error_record(const std::string& light, const Explained& explained) {
    const VisibilityError& e = explained.error;
    // Detachment and leak are distinguished by the occluder: null where the reference names none.
    const bool named = e.unnamed == 0;
    // Where no point is compared, nothing is known to be right: null, not 0.
    const auto counted  = [&](std::uint64_t n) { return e.points == 0 ? Count() : Count(n); };
    const auto measured = [&](double x) { return e.points == 0 ? std::nullopt : std::optional(x); };
    ErrorRecord record{.light                = light,
                       .points               = e.points,
                       .undefined            = e.undefined,
                       .away                 = e.away,
                       .on_boundary          = e.on_boundary,
                       .not_judged           = e.not_judged,
                       .lit                  = e.lit,
                       .umbra                = e.umbra,
                       .penumbra             = e.penumbra,
                       .interior             = {e.interior.lit, e.interior.umbra, e.interior.penumbra},
                       .penumbra_error       = {e.penumbra_error.false_shadow, e.penumbra_error.false_light},
                       .noise_error          = {e.noise_error.false_shadow, e.noise_error.false_light},
                       .terminator           = {e.terminator.facet_away, e.terminator.normal_away, e.terminator.wrong},
                       .mae                  = measured(e.mae),
                       .rmse                 = measured(e.rmse),
                       .max                  = measured(e.max),
                       .bias                 = measured(e.bias),
                       .edge_displacement_px = displacement_record(explained.displacement),
                       .unshadowed           = e.unshadowed};
    record.false_shadow = {{counted(e.false_shadow.interior), counted(e.false_shadow.edge)}, counted(e.acne)};
    const auto told     = [&](std::uint64_t n) { return named ? counted(n) : Count(); };
    record.false_light  = {
         {counted(e.false_light.interior), counted(e.false_light.edge)}, told(e.detachment), told(e.leak)};
    if (e.max_half_width > 0) record.bracket = {e.max_half_width};
    if (const auto& n = explained.noise) record.noise = {static_cast<std::uint64_t>(n->runs), n->rms, n->bias};
    if (const auto& w = explained.penumbra_width) record.penumbra_width_px = {w->method, w->reference};
    return record;
}

FailureRecord failure_record(const Failure& failure, const Scene& scene) {
    return {failure.light ? std::optional(scene.lights[*failure.light].name) : std::nullopt, failure.message,
            failure.cut};
}

std::string failed_in_words(const FailureRecord& failed) {
    return fmt::format("It failed{}: {}", failed.light ? " at light " + *failed.light : "", failed.message);
}

}  // namespace

ReferenceRecord reference_record(const Truth& truth, const Scene& scene) {
    const auto& [reference, ran, failed] = truth;
    const RunTimes& times                = ran.run.times;
    const std::uint64_t of_lights        = scene.lights.empty() ? 0 : 1;
    const auto timing                    = [](double ms, std::uint64_t runs) { return TimingRecord{ms, ms, ms, runs}; };
    ReferenceRecord record{.name       = std::string(reference.choice.info->name),
                           .title      = std::string(reference.choice.info->title),
                           .text       = reference.choice.text(),
                           .parameters = parameter_records(reference.choice.settings),
                           .exact      = reference.exact,
                           .note       = reference.note,
                           .times      = TimesRecord{timing(times.build, 1), timing(times.aims(), of_lights),
                                                timing(times.look, 1), timing(times.visibilities(), of_lights)}};
    if (!ran.stand_in.empty()) record.judged = {ran.judged, ran.of, ran.stand_in};
    if (failed) record.failed = {failure_record(*failed, scene), failed->method};
    return record;
}

MethodRecord unserved_record(const std::string& id, const MethodChoice& choice, const Service& service) {
    const MethodInfo& info = *choice.info;
    return {.id         = id,
            .name       = std::string(info.name),
            .title      = std::string(info.title),
            .paper      = std::string(info.paper),
            .summary    = std::string(info.summary),
            .text       = choice.text(),
            .parameters = parameter_records(choice.settings),
            .serves     = service_record(service),
            .outside    = info.outside};
}

MethodRecord served_record(const std::string& id, const PreparedScene& prepared, const Outcome& found,
                           const std::string& reference) {
    const MethodRun& run = found.run;
    MethodRecord record  = unserved_record(id, run.choice, run.service);
    record.ran           = true;
    if (run.choice.info->outside.empty()) {  // nobody knows what a program from outside holds
        record.memory_bytes = run.memory_bytes;
        record.points_bytes = run.points_bytes;
    }
    if (run.device_bytes > 0) record.device_bytes = run.device_bytes;
    record.coverage      = run.coverage(prepared.points);
    record.measures      = to_string(run.work->method().measures());
    record.compared_with = reference;
    for (LightId j = 0; j < prepared.scene.lights.size(); ++j)
        record.errors.push_back(error_record(prepared.scene.lights[j].name, found.explained[j]));
    return record;
}

OwnTimesRecord own_times_record(const OwnTimes& times, const OwnTimes& before) {
    const auto of = [](const std::vector<double>& all, std::size_t known) {
        const std::span samples = std::span(all).subspan(known < all.size() ? known : 0);
        return samples.empty() ? kUnknown : median(samples);
    };
    const auto sum_of = [&](const std::map<LightId, std::vector<double>> OwnTimes::*phase) {
        double sum = (times.*phase).empty() ? kUnknown : 0;
        for (const auto& [light, samples] : times.*phase) {
            const auto known = (before.*phase).find(light);
            sum              = sum + of(samples, known == (before.*phase).end() ? 0 : known->second.size());
        }
        return sum;
    };
    return {of(times.build, before.build.size()), sum_of(&OwnTimes::aim), of(times.look, before.look.size()),
            sum_of(&OwnTimes::visibility)};
}

void set_times(MethodRecord& record, const Scene& scene, const TurnTimes& times) {
    record.times = turn_times_record(times);
    for (LightId j = 0; j < scene.lights.size(); ++j)
        record.light_times.push_back(
            {scene.lights[j].name, timing_record(times.light_aim[j]), timing_record(times.light_visibility[j])});
}

TurnsRecord turns_record(const Turns& turns, const TurnOptions& options, std::pair<double, double> load) {
    TurnsRecord record{.rounds         = turns.calibration.size(),
                       .seed           = options.seed,
                       .threads        = static_cast<std::uint64_t>(thread_count()),
                       .processors     = static_cast<std::uint64_t>(usable_processors()),
                       .pinned         = turns.pinned,
                       .load_average   = {load.first, load.second},
                       .calibration_ms = turns.calibration};
    if (std::isfinite(turns.noise_bar)) record.noise_bar = turns.noise_bar;
    if (turns.control && !turns.twin->build.empty())
        record.control = {turns.twin->choice.text(), turn_times_record(*turns.twin)};
    return record;
}

MethodRecord failed_record(const std::string& id, const MethodChoice& choice, const Scene& scene,
                           const Failure& failure) {
    const FailureRecord failed = failure_record(failure, scene);
    MethodRecord record        = unserved_record(id, choice, {How::not_at_all, failed_in_words(failed)});
    record.failed              = failed;
    return record;
}

std::string failure_in_words(const std::string& scene, const std::string& method, const FailureRecord& failed) {
    return fmt::format("{}: {}: {}", scene, method, failed_in_words(failed));
}

std::vector<std::string> failures(const Results& results) {
    std::vector<std::string> messages;
    const auto add = [&](const std::string& method, const FailureRecord& failed) {
        messages.push_back(failure_in_words(results.scene.name, method, failed));
    };
    if (const auto& failed = results.reference.failed) add(failed->method, failed->failure);
    for (const MethodRecord& method : results.methods)
        if (method.failed) add(method.text, *method.failed);
    // The reference may also be one of the methods.
    std::vector<std::string> once;
    for (std::string& message : messages)
        if (std::ranges::find(once, message) == once.end()) once.push_back(std::move(message));
    return once;
}

Results with_prefix(Results results, const std::string& prefix) {
    const auto set = [&](FileName& file) {
        if (file) file.name = prefix + file.name;
    };
    const auto set_all = [&](std::optional<FilesRecord>& files) {
        if (!files) return;
        for (FileName* file : {&files->exr, &files->png, &files->flip}) set(*file);
        for (auto& [light, of] : files->lights)
            for (FileName* file : {&of.visibility, &of.difference, &of.classes}) set(*file);
    };
    set(results.values);
    set_all(results.reference.files);
    for (MethodRecord& method : results.methods) set_all(method.files);
    return results;
}

}  // namespace umbra
