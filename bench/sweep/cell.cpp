#include "umbra/bench/sweep/cell.h"

#include <fmt/format.h>

#include <utility>

#include "umbra/bench/base/field.h"
#include "umbra/bench/compare/record.h"
#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/sweep/content_key.h"
#include "umbra/bench/sweep/truth_file.h"
#include "umbra/bench/sweep/views.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

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
MethodChoice seeded(const MethodChoice& choice, int view) {
    return view == 0 || choice.info->seed.empty() ? choice : with_seed(choice, 7919LL * view);
}

}  // namespace

const SceneFacts& OwnScene::facts() {
    if (!facts_) facts_.emplace(find_facts(scene_));
    return *facts_;
}

const RayScene& OwnScene::rays() {
    if (!rays_) rays_.emplace(scene_);
    return *rays_;
}

void OwnScene::turn_to(std::uint64_t number, const PreparedScene& view) {
    if (number == turned_to_) return;
    if (!turned_) turned_ = view.scene;
    turned_->camera = view.scene.camera;
    turned_->lights = view.scene.lights;
    turned_->width  = view.scene.width;
    turned_->height = view.scene.height;
    turned_facts_   = view.facts;
    turned_to_      = number;
}

BuiltWork OwnScene::begin(const MethodChoice& choice) const {
    for (const auto& kept : {&reference_, &other_}) {
        if (!*kept || (*kept)->work.choice().info != choice.info) continue;
        BuiltWork begun = **kept;
        begun.work.set(choice);
        if (begun.work.is_built()) return begun;
    }
    return {MethodAtWork(choice, *turned_, turned_facts_)};
}

void OwnScene::keep(const MethodAtWork& work, std::optional<double> build_ms) {
    BuiltWork& kept = (work.choice().info->reference ? reference_ : other_).emplace(BuiltWork{work, build_ms});
    kept.work.lift_limit();
    kept.work.forget_aims();
    kept.work.forget_look();
}

CellView::CellView(std::shared_ptr<OwnScene> own, std::filesystem::path file, int view, CellOptions options,
                   std::filesystem::path folder)
    : own_(std::move(own)),
      file_(std::move(file)),
      view_(view),
      options_(std::move(options)),
      folder_(std::move(folder)),
      scene_key_(scene_key(own_->scene())) {
    if (options_.size.width == 0) options_.size = {own_->scene().width, own_->scene().height};
}

std::string CellView::what_truth_depends_on() const {
    return combined_key({fmt::format("{}", kResultsSchema), scene_key_,
                         fmt::format("{} {} {}", view_, options_.size.width, options_.size.height),
                         options_.reference.value_or(""), options_.points ? fmt::format("{}", *options_.points) : "",
                         code_of_truth(options_.reference)});
}

std::string CellView::key(const MethodChoice& choice, bool brief) const {
    return combined_key({"cell", what_truth_depends_on(), brief ? "brief" : fmt::format("{}", kCellNoiseRuns),
                         all_settings(choice), code_key(*choice.info)});
}

std::string CellView::reference_key() const { return combined_key({"reference", what_truth_depends_on()}); }

const PreparedScene& CellView::prepared() {
    if (!prepared_) {
        if (options_.progress) options_.progress(fmt::format("preparing view {}", view_));
        const KnownGeometry known{own_->facts(), own_->rays()};
        prepared_.emplace(prepare_scene(view_of(own_->scene(), view_, &known.rays), file_, options_.size, 1,
                                        Work::comparison, &known));
        number_ = own_->new_number();
    }
    return *prepared_;
}

Truths& CellView::truths() {
    if (truths_) return *truths_;
    const PreparedScene& p = prepared();
    const auto file_of     = [this](const Reference& reference) {
        return folder_ / fmt::format("truth-{}.exr",
                                         combined_key({"truth", what_truth_depends_on(), all_settings(reference.choice)}));
    };
    TruthOptions options{.reference = options_.reference, .points = options_.points, .budget = options_.budget};
    options.progress = [this](const std::string& what) {
        if (options_.progress) options_.progress(fmt::format("view {}: {}", view_, what));
    };
    options.find = [file_of, &p](const Reference& of, ReferenceRun& ran) {
        return read_truth(file_of(of), p.scene.lights.size(), p.points.size(), ran);
    };
    options.keep = [this, file_of, &p](const Reference& of, const ReferenceRun& ran) {
        if (shares(of.choice)) own_->keep(*ran.run.work);
        write_truth(file_of(of), ran, p.points.raster->width, p.points.raster->height);
    };
    options.at_work = [this](const MethodChoice& of) {
        return shares(of) ? std::make_shared<MethodAtWork>(begin(of).work) : nullptr;
    };
    return truths_.emplace(p.scene, p.facts, p.points, std::move(options));
}

const Rendered& CellView::rendered(const Truth& truth) {
    const auto known = rendered_.find(&truth);
    if (known != rendered_.end()) return known->second;
    const PreparedScene& p = prepared();
    return rendered_.emplace(&truth, render_planes(p.scene, p.points, truth.ran.run.planes)).first->second;
}

ReferenceRecord CellView::reference() {
    ReferenceRecord record = reference_record(truths().main(), prepared().scene);
    record.times.reset();  // of this machine
    return record;
}

BuiltWork CellView::begin(const MethodChoice& choice) {
    const PreparedScene& p = prepared();
    if (!shares(choice)) return {MethodAtWork(choice, p.scene, p.facts)};
    own_->turn_to(number_, p);
    return own_->begin(choice);
}

void CellView::build(const MethodChoice& choice) {
    if (work_ && work_->choice().info == choice.info) {
        if (shares(choice)) own_->turn_to(number_, prepared());
        work_->set(choice);
    } else {
        work_.reset();
        BuiltWork begun = begin(choice);
        build_ms_       = begun.build_ms;
        work_           = std::make_shared<MethodAtWork>(std::move(begun.work));
        aim_ms_.clear();
    }
    work_->limit(options_.budget);
    if (!work_->service() || work_->is_built()) return;
    aim_ms_.clear();
    build_ms_.reset();
    if (options_.brief) {
        work_->warm_up();
        build_ms_ = timed_ms([&] { work_->build(); });
        if (shares(choice)) own_->keep(*work_, build_ms_);
        return;
    }
    // How much memory Embree's tree takes depends on the threads that build it: one takes the same each time.
    const ThreadLimit one(1);
    work_->build();
}

/// On all threads, and by itself.
double CellView::time_of_build(const MethodChoice& choice) {
    const bool is_built = work_ && work_->choice().info == choice.info && work_->is_built() &&
                          first_changed_phase(work_->choice().settings, choice.settings) != Phase::build;
    if (is_built && build_ms_) return *build_ms_;
    MethodAtWork alone(choice, prepared().scene, prepared().facts);
    alone.limit(options_.budget);
    alone.warm_up();
    const double ms = timed_ms([&] { alone.build(); });
    if (is_built) build_ms_ = ms;
    return ms;
}

/// What the last run has built and aimed at is not made again.
MethodRun CellView::run(const MethodChoice& choice, std::optional<LightId>& at) {
    const PreparedScene& p = prepared();
    ran_.reset();
    build(seeded(choice, view_));
    MethodRun run{choice};
    run.is_coloured = p.facts.has_coloured_filters;
    run.work        = work_;
    run.service     = run.work->service();
    if (!run.service) return run;
    if (work_->looks_at(p.points)) {
        run.times.look = look_ms_;
    } else {
        look_at(run, p.points);
        look_ms_ = run.times.look;
    }
    for (LightId light = 0; light < p.scene.lights.size(); ++light) {
        at = light;
        if (work_->is_aimed_at(light)) {
            run.times.aim.push_back(aim_ms_.at(light));
            answer_light(run, p.points, light);
        } else {
            run_light(run, p.points, light);
            aim_ms_[light] = run.times.aim.back();
        }
    }
    at.reset();
    note_memory(run);
    times_.insert_or_assign(all_settings(choice), run.times);
    return run;
}

std::optional<RunTimes> CellView::times_of_one_run(const MethodChoice& choice, bool anew, double seconds) {
    struct Restored {
        Budget& now;
        Budget before = now;
        ~Restored() { now = before; }
    } budget{options_.budget};
    const bool is_less = seconds < budget.before.seconds;
    if (is_less) budget.now.seconds = seconds;
    const std::string which = all_settings(choice);
    std::optional<LightId> at;
    try {
        if (anew && work_) work_->forget_aims(), work_->forget_look(), build_ms_.reset();
        if (anew || !times_.contains(which)) ran_ = run(choice, at);
        const auto found = times_.find(which);
        if (found == times_.end()) return std::nullopt;
        RunTimes times = found->second;
        times.build    = time_of_build(choice);
        return times;
    } catch (const InputError&) {
        throw;
    } catch (const CutShort&) {
        work_.reset();
        if (is_less) throw;
        return std::nullopt;
    } catch (...) {
        work_.reset();
        return std::nullopt;
    }
}

Cell CellView::compute(const MethodChoice& choice) {
    const PreparedScene& p = prepared();
    const Scene& scene     = p.scene;
    const std::string id(choice.info->name);
    const Truth* against = nullptr;
    const bool brief     = options_.brief;
    Cell cell{.view = static_cast<std::uint64_t>(view_), .key = key(choice, brief), .brief = brief};
    Trial trial{.noise_runs = brief ? 0 : kCellNoiseRuns, .named = !brief, .budget = options_.budget};
    trial.run = [&](std::optional<LightId>& at) {
        const bool is_there = ran_ && all_settings(ran_->choice) == all_settings(choice);
        MethodRun made      = is_there ? std::move(*ran_) : run(choice, at);
        ran_.reset();
        return made;
    };
    trial.truth = [&](const MethodRun& run) -> const MethodRun& {
        against = &truths().of(run.work->method());
        return against->ran.run;
    };
    trial.then = [&](const Outcome& found) {
        cell.method = served_record(id, p, found, against->reference.choice.text());
        if (brief) cell.method.memory_bytes.reset();  // which depends on the threads that built
        cell.method.image =
            image_figures(found.run.planes, render_planes(scene, p.points, found.run.planes), rendered(*against))
                .figures;
        if (const auto covered = cell.method.coverage) cell.undefined = 1 - *covered;
    };
    const Outcome found = outcome(choice, scene, p.facts, p.points, trial);
    const auto whole    = [](const std::optional<Failure>& failed) { return !failed || !failed->cut; };
    is_whole_           = whole(found.failed) && (against == nullptr || whole(against->failed));
    if (found.failed) {
        work_.reset();
        cell.method = failed_record(id, choice, scene, *found.failed);
    } else if (!found.run.service) {
        cell.method = unserved_record(id, choice, found.run.service);
    }
    return cell;
}

}  // namespace umbra
