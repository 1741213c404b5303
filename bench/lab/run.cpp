#include "umbra/bench/lab/run.h"

#include <fmt/format.h>

#include <numeric>
#include <stdexcept>

#include "umbra/bench/lab/prepare.h"

namespace umbra {

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

double RunTimes::aims() const { return std::accumulate(aim.begin(), aim.end(), 0.0); }
double RunTimes::visibilities() const { return std::accumulate(visibility.begin(), visibility.end(), 0.0); }
double RunTimes::all() const { return build + aims() + look + visibilities(); }

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

void look_at(MethodRun& run, const PointBatch& points) {
    MethodAtWork& work = *run.work;
    if (work.looks_at(points)) return;
    work.forget_look();
    run.times.look += timed_ms([&] { work.look(points); });
}

void run_light(MethodRun& run, const PointBatch& points, LightId light) {
    run.work->forget_aim(light);
    run.times.aim.push_back(timed_ms([&] { run.work->aim(light); }));
    answer_light(run, points, light);
}

void answer_light(MethodRun& run, const PointBatch& points, LightId light) {
    look_at(run, points);
    VisibilityPlane plane(points.size(), run.is_coloured);
    run.times.visibility.push_back(timed_ms([&] { run.work->visibility(light, plane.out()); }));
    check_contract(run.choice.info->name, plane, points, light);
    run.planes.push_back(std::move(plane));
}

void note_memory(MethodRun& run) {
    run.memory_bytes = run.work->memory_bytes();
    run.points_bytes = run.work->points_bytes();
    run.device_bytes = run.work->device_bytes();
}

void run_build(MethodRun& run) {
    MethodAtWork& work = *run.work;
    if (work.is_built()) return;
    work.forget_build();
    work.warm_up();
    run.times.build = timed_ms([&] { work.build(); });
}

void run_phases(MethodRun& run, const PointBatch& points, std::size_t lights, std::optional<LightId>* at) {
    run_build(run);
    look_at(run, points);
    for (LightId light = 0; light < lights; ++light) {
        if (at != nullptr) *at = light;
        run_light(run, points, light);
    }
    if (at != nullptr) at->reset();
    note_memory(run);
}

MethodRun run_method(const MethodChoice& choice, const Scene& scene, const SceneFacts& facts, const PointBatch& points,
                     std::optional<LightId>* at, const Budget& budget) {
    MethodRun run = begin_run(choice, scene, facts, budget);
    if (run.service) run_phases(run, points, scene.lights.size(), at);
    return run;
}

}  // namespace umbra
