#include "umbra/bench/sweep/cell.h"

#include <fmt/format.h>

#include <utility>

#include "umbra/bench/compare/record.h"
#include "umbra/bench/run/explain.h"
#include "umbra/bench/run/noise_runs.h"
#include "umbra/bench/run/results_file.h"
#include "umbra/bench/sweep/content_key.h"
#include "umbra/bench/sweep/truth_file.h"
#include "umbra/bench/sweep/views.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

constexpr Repeats kOnce{1, 0};

/// Every parameter with its value, so that a new default is a new key.
std::string all_settings(const MethodChoice& choice) {
    std::string text(choice.info->name);
    for (const Parameter& p : choice.settings.parameters())
        text += fmt::format(" {}={}", p.name, choice.settings.text(p));
    return text;
}

/// The sources of every method that may be the truth.
std::string code_of_truth(const std::optional<std::string>& reference) {
    std::string codes;
    if (reference) codes = code_key(*parse_method(*reference).info);
    for (const MethodInfo* info : methods())
        if (info->reference) codes += code_key(*info);
    codes += code_key(*parse_method(kStandIn).info);
    return codes;
}

/// The setting with another seed in views other than the scene's own.
MethodChoice seeded(MethodChoice choice, int view) {
    const std::string_view seed = choice.info->seed;
    if (view == 0 || seed.empty()) return choice;
    const double own = choice.settings.value(seed);
    choice.settings.set(seed, static_cast<double>((static_cast<std::int64_t>(own) + 7919LL * view) % 2147483647LL));
    return choice;
}

}  // namespace

CellView::CellView(std::shared_ptr<const Scene> own, std::filesystem::path file, int view, CellOptions options,
                   std::filesystem::path folder)
    : own_(std::move(own)),
      file_(std::move(file)),
      view_(view),
      options_(std::move(options)),
      folder_(std::move(folder)),
      scene_key_(scene_key(*own_)) {
    if (options_.size.width == 0) options_.size = {own_->width, own_->height};
}

std::string CellView::what_truth_depends_on() const {
    return combined_key({fmt::format("{}", kResultsSchema), scene_key_,
                         fmt::format("{} {} {}", view_, options_.size.width, options_.size.height),
                         options_.reference.value_or(""), options_.points ? fmt::format("{}", *options_.points) : "",
                         code_of_truth(options_.reference)});
}

std::string CellView::key(const MethodChoice& choice) const {
    return combined_key({"cell", what_truth_depends_on(), fmt::format("{}", kCellNoiseRuns), all_settings(choice),
                         code_key(*choice.info)});
}

std::string CellView::reference_key() const { return combined_key({"reference", what_truth_depends_on()}); }

const PreparedScene& CellView::prepared() {
    if (!prepared_) {
        if (options_.progress) options_.progress(fmt::format("preparing view {}", view_));
        prepared_.emplace(prepare_scene(view_of(*own_, view_), file_, options_.size));
    }
    return *prepared_;
}

const CellView::Truth& CellView::truth(Measure measure) {
    if (const auto found = truths_.find(measure); found != truths_.end()) return found->second;
    const PreparedScene& p = prepared();
    Reference reference    = default_reference(p.facts, measure);
    if (options_.reference && measure == Measure::area) {
        reference       = {parse_method(*options_.reference), false, "Chosen on the command line."};
        reference.exact = verdict(*reference.choice.make(), p.facts).how == How::exactly;
    }
    if (options_.progress) options_.progress(fmt::format("view {}: reference {}", view_, reference.choice.text()));
    const std::filesystem::path file =
        folder_ /
        fmt::format("truth-{}.exr", combined_key({"truth", what_truth_depends_on(), all_settings(reference.choice)}));
    Truth truth{reference, {MethodRun{reference.choice}, 0, 0, {}}, std::nullopt, {}};
    if (read_truth(file, p.scene.lights.size(), p.points.size(), truth.ran)) {
        MethodRun& run = truth.ran.run;
        run.work       = std::make_shared<MethodAtWork>(reference.choice, p.scene, p.facts);
        run.service    = run.work->service();
    } else if (options_.reference && measure == Measure::area) {
        truth.ran = run_reference(truth.reference, p.scene, p.facts, p.points, options_.points);
        write_truth(file, truth.ran, p.points.raster->width, p.points.raster->height);
    } else {
        TruthRun found = run_reference_or_substitute(truth.reference, p.scene, p.facts, p.points, options_.points);
        truth.ran      = std::move(found.ran);
        truth.failed   = std::move(found.failed);
        if (!truth.failed) write_truth(file, truth.ran, p.points.raster->width, p.points.raster->height);
    }
    truth.rendered = render_planes(p.scene, p.points, truth.ran.run.planes);
    return truths_.emplace(measure, std::move(truth)).first->second;
}

Json CellView::reference() {
    const Truth& t = truth(Measure::area);
    Json record    = reference_json(t.reference, t.ran, prepared().scene, t.failed);
    record.erase("times");
    return record;
}

const std::shared_ptr<MethodAtWork>& CellView::at_work(const MethodChoice& choice) {
    if (work_ && work_->choice().info == choice.info) {
        work_->set(choice);
    } else {
        work_.reset();
        work_ = std::make_shared<MethodAtWork>(choice, prepared().scene, prepared().facts);
    }
    // How much memory Embree's tree takes depends on the threads that build it: one takes the same each time.
    const ThreadLimit one(1);
    if (work_->service()) work_->built();
    return work_;
}

Json CellView::compute(const MethodChoice& choice) {
    const PreparedScene& p = prepared();
    const Scene& scene     = p.scene;
    const std::string id(choice.info->name);
    std::optional<LightId> at;
    Json cell;
    try {
        MethodRun run{seeded(choice, view_)};
        run.work    = at_work(run.choice);
        run.service = run.work->service();
        if (!run.service) {
            cell = unserved_json(id, choice, run.service);
        } else {
            for (LightId j = 0; j < scene.lights.size(); ++j) {
                at = j;
                run_light(run, p.points, j, kOnce);
            }
            note_memory(run);
            at.reset();
            const Measure measure = p.facts.hard_lights_only ? Measure::area : run.work->method().measures();
            const Truth& against  = truth(measure);
            const auto noise      = noise_runs(*run.work, scene, p.points, kCellNoiseRuns);
            std::vector<Explained> explained;
            for (LightId j = 0; j < scene.lights.size(); ++j) {
                at = j;
                explained.push_back(explain(scene, p.points, j, run, against.ran.run, noise[j] ? &*noise[j] : nullptr));
            }
            at.reset();
            run.choice = choice;  // the record names the setting as it was asked for
            cell       = served_json(id, p, run, explained, against.reference.choice.text());
            cell.erase("times");
            cell.erase("light_times");
            cell["image"] =
                image_figures(run.planes, render_planes(scene, p.points, run.planes), against.rendered).figures;
            const auto covered = run.coverage(p.points);
            cell["undefined"]  = covered ? Json(1 - *covered) : Json();
        }
    } catch (const InputError&) {  // a file that cannot be written is no fault of the method
        throw;
    } catch (...) {
        work_.reset();
        cell = failed_json(id, choice, scene, at, current_message());
    }
    cell["view"] = view_;
    cell["key"]  = key(choice);
    return cell;
}

}  // namespace umbra
