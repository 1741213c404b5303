#include "umbra/bench/ladders/ladder_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <iterator>

#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/bench/lab/turns.h"
#include "umbra/core/base/error.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"

namespace umbra {
namespace {

/// What most of the interior errors are; of equals the first.
std::string kind_of(const VisibilityError& e) {
    const std::pair<std::uint64_t, const char*> kinds[] = {
        {e.acne, "acne"},           {e.other_shadow(), "false shadow"},
        {e.leak, "leak"},           {e.detachment, "detachment"},
        {e.unnamed, "false light"}, {e.penumbra_error.false_shadow + e.penumbra_error.false_light, "penumbra"},
    };
    const auto* most = std::max_element(std::begin(kinds), std::end(kinds),
                                        [](const auto& a, const auto& b) { return a.first < b.first; });
    return most->first > 0 ? most->second : "";
}

/// What the processor has spent on this thread, which neither other processes nor other ladders lengthen.
double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The sum with the true S_j, where the ladder is over that.
std::string wrong_sum(const Ladder& ladder, double value, const RungStage& stage) {
    return ladder.wrong_sum(value, stage.scene, shade(stage.scene, stage.points, stage.truth.planes));
}

std::uint64_t count_surface(const PointBatch& points) {
    return static_cast<std::uint64_t>(
        std::count_if(points.triangle.begin(), points.triangle.end(), [](TriangleId t) { return t != kNoTriangle; }));
}

void describe_truth(const RungStage& stage, Rung& rung) {
    rung.truth          = stage.truth.choice.text();
    rung.surface_points = count_surface(stage.points);
    for (LightId j = 0; j < stage.scene.lights.size(); ++j) {
        const VisibilityPlane& truth = stage.truth.planes[j];
        const VisibilityError e =
            visibility_error(stage.points, j, truth, truth, visibility_tolerance(stage.scene.lights[j].kind));
        rung.lit += e.lit, rung.umbra += e.umbra, rung.penumbra += e.penumbra, rung.on_boundary += e.on_boundary;
        rung.can_show += interior_points(stage.scene, stage.points, j, truth, truth);
    }
}

}  // namespace

bool RungOutcome::broken() const {
    if (!ran()) return false;
    return service.how >= How::to_rounding ? interior() > 0 : interior_share() > kBreakingShare;
}

Climb climb(const LadderRun& run, std::size_t method) {
    Climb c;
    // Only what lasts to the last rung is said to be so "from here on".
    const auto lasts = [](bool now, std::size_t r, std::optional<std::size_t>& from) {
        if (!now)
            from.reset();
        else if (!from)
            from = r;
    };
    for (std::size_t r = 0; r < run.rungs.size(); ++r) {
        if (!run.rungs[r].unjudged.empty()) {
            lasts(true, r, c.not_judged_from);
            if (!c.breaks_at && c.not_judged_from == r) c.why = run.rungs[r].unjudged;
            continue;
        }
        const RungOutcome& o = run.rungs[r].outcomes[method];
        if (!c.breaks_at && (o.broken() || !o.stopped.empty())) {
            c.breaks_at = r;
            if (!o.stopped.empty()) c.why = o.stopped;
        }
        const bool counted = run.ladder->wrong_sum == nullptr;  // the sum has no lit and shadow points
        if (o.ran() && !o.silent() && !(counted && o.unjudged())) {
            ++c.judged;
            c.least_coverage = std::min(c.least_coverage, o.coverage());
        }
        lasts(o.silent(), r, c.silent_from);
        lasts(!o.service, r, c.not_served_from);
        lasts(counted && o.unjudged() && !o.silent(), r, c.not_judged_from);
        if (!o.service && !c.breaks_at) c.why = o.service.why;
        if (!c.breaks_at && c.not_judged_from == r) c.why = o.can_show.lacking();
    }
    if (c.breaks_at) c.not_judged_from.reset();  // it is known how the climb ended
    return c;
}

std::unique_ptr<RungStage> set_stage(Scene scene) {
    SceneFacts facts          = find_facts(scene);
    const Reference reference = default_reference(facts);
    MethodRun truth{reference.choice};
    auto stage =
        std::make_unique<RungStage>(RungStage{std::move(scene), std::move(facts), PointBatch{}, std::move(truth)});
    stage->points = primary_points(RayScene(stage->scene), stage->scene, stage->scene.camera, stage->scene.width,
                                   stage->scene.height);
    stage->truth  = run_reference(reference, stage->scene, stage->facts, stage->points, stage->points.size()).run;
    return stage;
}

RungOutcome outcome(const RungStage& stage, const MethodChoice& method, std::vector<Explained>* explained,
                    MethodRun* run, const Budget& budget) {
    RungOutcome o;
    Outcome found = outcome(method, stage.scene, stage.facts, stage.points,
                            {.truth      = [&](const MethodRun&) -> const MethodRun& { return stage.truth; },
                             .noise_runs = 0,
                             .budget     = budget});
    o.service     = found.run.service;
    if (found.failed && found.failed->cut) {
        o.service = {How::not_at_all, fmt::format("It was {}.", found.failed->message)};
        o.cut     = true;
        return o;
    }
    if (found.failed) {
        o.service = {How::approximately, "it stopped"};
        o.stopped = found.failed->message;
        if (found.failed->light) o.light = stage.scene.lights[*found.failed->light].name;
        return o;
    }
    VisibilityError sum;  // only what kinds are made of
    double absolute = 0;
    for (LightId j = 0; j < found.explained.size(); ++j) {
        const VisibilityError& e = found.explained[j].error;
        o.points += e.points, o.undefined += e.undefined;
        o.false_shadow.interior += e.false_shadow.interior, o.false_shadow.edge += e.false_shadow.edge;
        o.false_light.interior += e.false_light.interior, o.false_light.edge += e.false_light.edge;
        sum.false_shadow.interior += e.false_shadow.interior, sum.acne += e.acne;
        sum.penumbra_error.false_shadow += e.penumbra_error.false_shadow;
        sum.penumbra_error.false_light += e.penumbra_error.false_light;
        sum.leak += e.leak, sum.detachment += e.detachment, sum.unnamed += e.unnamed;
        absolute += e.mae * double(e.points);
        o.can_show += interior_points(stage.scene, stage.points, j, stage.truth.planes[j], found.run.planes[j]);
    }
    if (o.points > 0) o.mae = absolute / double(o.points);
    o.kind = kind_of(sum);
    if (explained != nullptr) std::ranges::move(found.explained, std::back_inserter(*explained));
    if (run != nullptr && o.service) *run = std::move(found.run);
    return o;
}

LadderRun climb_ladder(const Ladder& ladder, const std::vector<MethodChoice>& methods,
                       const std::function<void(const std::string&)>& progress, double patience_s,
                       const Budget& budget) {
    LadderRun run{&ladder, ladder.wrong_sum ? std::vector<MethodChoice>{} : methods, {}};
    std::vector<std::string> too_slow(run.methods.size());  // why; empty where it is not
    for (const double value : ladder.rungs) {
        if (progress) progress(fmt::format("{}: {:g}", ladder.name, value));
        Rung& rung = run.rungs.emplace_back();
        rung.value = value;
        std::unique_ptr<RungStage> set;
        try {
            set = set_stage(ladder.scene(value));
        } catch (...) {
            rung.failed   = current_message();
            rung.unjudged = fmt::format("no reference: {}", rung.failed);
            break;
        }
        const RungStage& stage = *set;
        describe_truth(stage, rung);
        if (double(rung.surface_points) < kLeastPoints * double(run.rungs[0].surface_points)) {
            rung.unjudged = fmt::format("the eye sees {} surface points, on the first rung {}", rung.surface_points,
                                        run.rungs[0].surface_points);
            break;
        }
        if (!ladder.wrong_sum && !rung.can_show.enough()) {
            rung.unjudged = rung.can_show.lacking();
            continue;
        }
        if (ladder.wrong_sum) {
            RungOutcome o;
            o.service = {How::exactly, "the sum itself, with the true visibility"};
            o.stopped = wrong_sum(ladder, value, stage);
            o.points  = rung.surface_points;
            rung.outcomes.push_back(std::move(o));
        }
        for (std::size_t m = 0; m < run.methods.size(); ++m) {
            RungOutcome& o = rung.outcomes.emplace_back();
            if (!too_slow[m].empty()) {
                o.service = {How::not_at_all, too_slow[m]};
                continue;
            }
            const double start   = thread_seconds();
            o                    = outcome(stage, run.methods[m], nullptr, nullptr, budget);
            const double seconds = thread_seconds() - start;
            if (o.cut) too_slow[m] = fmt::format("On rung {:g}: {}", value, o.service.why);
            if (!o.cut && seconds > patience_s)
                too_slow[m] = fmt::format(
                    "It took {:.3g} s of a thread's processor time on rung {:g}, and {:g} s are allowed (--patience).",
                    seconds, value, patience_s);
        }
    }
    return run;
}

std::vector<std::vector<double>> time_first_rung(const Ladder& ladder, const std::vector<MethodChoice>& methods,
                                                 const Budget& budget) {
    const PreparedScene scene = prepare_scene(ladder.scene(ladder.rungs.front()), ladder.name, {});
    TurnOptions options{.rounds = 6, .budget_ms = 600, .share_builds = false, .most = budget};
    options.calibration_loop = [] {};  // ratios within one run need none
    std::vector<std::vector<double>> times;
    for (const TurnTimes& t : time_in_turns(scene, methods, options).settings)
        times.push_back(t.failed.empty() && !t.only_cold ? totals(t) : std::vector<double>{});
    return times;
}

}  // namespace umbra
