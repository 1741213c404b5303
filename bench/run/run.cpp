#include "umbra/bench/run/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "umbra/bench/statistics/statistics.h"

namespace umbra {
namespace {

double now_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void check_contract(std::string_view name, const VisibilityPlane& plane, const PointBatch& points, LightId light) {
    for (std::size_t i = 0; i < plane.s.size(); ++i) {
        const bool asked = points.asks(light, i);
        const bool in_range =
            plane.s[i] >= 0 && plane.s[i] <= 1 && plane.half_width[i] >= 0 && plane.half_width[i] <= 1;
        const bool is_mean = plane.colour.empty() || !plane.defined(i) || plane.s[i] == mean_of(plane.colour[i]);
        const bool untouched =
            plane.s[i] == points.decided(light, i) && plane.half_width[i] == 0 && plane.answer[i] == Answer::given;
        if (!in_range || !is_mean || plane.answer[i] > Answer::on_boundary || (!asked && !untouched))
            throw std::logic_error(fmt::format(
                "{} breaks its contract at point {}: visibility {}, half width {}, answer {}, {}", name, i, plane.s[i],
                plane.half_width[i], static_cast<int>(plane.answer[i]), asked ? "asked for" : "not asked for"));
    }
}

Timing timing_of(std::span<const double> samples) {
    const double middle         = median(samples);
    const auto [least, largest] = std::minmax_element(samples.begin(), samples.end());
    return {middle, *least, *largest, static_cast<int>(samples.size())};
}

Timing time_runs(const Repeats& repeats, const std::function<void()>& work, const std::function<void()>& before) {
    std::vector<double> times;
    double spent = 0;
    do {
        if (before) before();
        const double start = now_ms();
        work();
        times.push_back(now_ms() - start);
        spent += times.back();
    } while (static_cast<int>(times.size()) < repeats.max_runs && spent < repeats.budget_ms);
    return timing_of(times);
}

Timing total(const std::vector<Timing>& timings) {
    Timing sum;
    for (const Timing& t : timings) {
        sum.median += t.median;
        sum.min += t.min;
        sum.max += t.max;
        sum.runs = sum.runs == 0 ? t.runs : std::min(sum.runs, t.runs);
    }
    return sum;
}

std::optional<double> MethodRun::coverage(const PointBatch& points) const {
    std::size_t asked = 0, given = 0;
    for (std::size_t j = 0; j < planes.size(); ++j)
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!points.asks(static_cast<LightId>(j), i)) continue;
            ++asked;
            given += planes[j].defined(i);
        }
    if (asked == 0) return std::nullopt;
    return static_cast<double>(given) / static_cast<double>(asked);
}

MethodRun begin_run(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts, const Budget& budget,
                    std::shared_ptr<MethodAtWork> work) {
    MethodRun run{choice};
    run.work = work ? std::move(work) : std::make_shared<MethodAtWork>(choice, scene, facts);
    run.work->limit(budget);
    run.service     = run.work->service();
    run.is_coloured = facts.has_coloured_filters;
    return run;
}

void look_at(MethodRun& run, const PointBatch& points, const Repeats& repeats) {
    MethodAtWork& work = *run.work;
    if (work.looks_at(points)) return;
    const Timing look = time_runs(
        repeats, [&] { work.look(points); }, [&] { work.forget_look(); });
    run.look = run.look.runs == 0 ? look : total({run.look, look});
}

void run_light(MethodRun& run, const PointBatch& points, LightId light, const Repeats& repeats) {
    MethodAtWork& work = *run.work;
    run.aim.push_back(time_runs(
        repeats, [&] { work.aim(light); }, [&] { work.forget_aim(light); }));
    answer_light(run, points, light, repeats);
}

void answer_light(MethodRun& run, const PointBatch& points, LightId light, const Repeats& repeats) {
    MethodAtWork& work = *run.work;
    look_at(run, points, repeats);
    VisibilityPlane plane(points.size(), run.is_coloured);
    run.visibility.push_back(time_runs(
        repeats, [&] { work.visibility(light, plane.out()); }, [&] { plane.clear(); }));
    check_contract(run.choice.info->name, plane, points, light);
    run.planes.push_back(std::move(plane));
}

void note_memory(MethodRun& run) {
    run.memory_bytes = run.work->memory_bytes();
    run.points_bytes = run.work->points_bytes();
    run.device_bytes = run.work->device_bytes();
}

void run_lights(MethodRun& run, const PointBatch& points, std::size_t lights, const Repeats& repeats,
                std::optional<LightId>* at) {
    for (LightId light = 0; light < lights; ++light) {
        if (at != nullptr) *at = light;
        run_light(run, points, light, repeats);
    }
    if (at != nullptr) at->reset();
    note_memory(run);
}

void run_build(MethodRun& run, const Repeats& repeats) {
    MethodAtWork& work = *run.work;
    if (work.is_built()) return;
    run.build = time_runs(
        repeats, [&] { work.build(); }, [&] { work.forget_build(), work.warm_up(); });
}

void run_phases(MethodRun& run, const PointBatch& points, std::size_t lights, const Repeats& repeats,
                std::optional<LightId>* at) {
    run_build(run, repeats);
    look_at(run, points, repeats);
    run_lights(run, points, lights, repeats, at);
}

MethodRun run_method(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts, const PointBatch& points,
                     const Repeats& repeats, std::optional<LightId>* at, const Budget& budget) {
    MethodRun run = begin_run(choice, scene, facts, budget);
    if (run.service) run_phases(run, points, scene.lights.size(), repeats, at);
    return run;
}

}  // namespace umbra
