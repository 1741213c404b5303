#include "umbra/bench/studies/motion/motion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "report_assets.h"
#include "umbra/bench/base/statistics.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/studies/motion/animation.h"
#include "umbra/bench/studies/motion/mix_triangle.h"
#include "umbra/bench/studies/motion/record_view.h"

namespace umbra {
namespace {

using nlohmann::json;

/// Corners of the triangle in the units of its viewBox: camera, light, object.
constexpr dvec2 kCamera{40, 300}, kLight{400, 300}, kObject{220, 28};

/// Methods that ran every movement and answered every point, in the order of the record. None where the scene lacks a
/// movement: there is no triangle then.
struct Competitor {
    std::string text;
    CornerTimes times;
    std::size_t style;  ///< its index among the methods
};
std::vector<Competitor> competitors(const SceneMotionRecord& scene, double max_rmse) {
    std::vector<Competitor> all;
    for (std::size_t own = 0; own < scene.methods.size(); ++own) {
        const MovedMethodRecord& method = scene.methods[own];
        if (method.movements.empty() || !method.failed.empty()) continue;
        Competitor c{method.text, {}, own};
        bool competes = true;
        for (int k = 0; const Movement movement : kMovements) {
            const MovedRecord* m = method.movements.find(to_string(movement));
            if (m == nullptr) return {};  // the scene has no such corner
            c.times[k++] = m->median_ms;
            competes     = competes && m->undefined == 0 && known(m->worst_rmse).value_or(0) <= max_rmse;
        }
        if (competes) all.push_back(std::move(c));
    }
    return all;
}

json triangle_view(const SceneMotionRecord& scene, double max_rmse, const std::string& caption) {
    const std::vector<Competitor> all = competitors(scene, max_rmse);
    std::vector<CornerTimes> times;
    for (const Competitor& c : all) times.push_back(c.times);
    json regions = json::array();
    for (const MixRegion& region : mix_regions(times)) {
        std::string path;
        dvec2 middle(0);
        for (const Shares& corner : region.corners) {
            const dvec2 at = corner.x * kCamera + corner.y * kLight + corner.z * kObject;
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", at.x, at.y);
            middle += at / static_cast<double>(region.corners.size());
        }
        const Competitor& c = all[region.method];
        regions.push_back({{"path", path + "z"},
                           {"colour", std::to_string(mark_style(c.style).colour)},
                           {"label", region.area > 0.08 ? c.text : ""},
                           {"x", fmt::format("{:.1f}", middle.x)},
                           {"y", fmt::format("{:.1f}", middle.y)},
                           {"method", c.text},
                           {"share", region.area < 0.001 ? "< 0.1" : percent(region.area)}});
    }
    return {{"caption", caption}, {"any", !regions.empty()}, {"regions", std::move(regions)}};
}

json winner_view(const std::optional<WinnerRecord>& winner, bool ranked) {
    if (!winner || !ranked)
        return {{"none", winner ? "not ranked" : "none"}, {"method", ""}, {"ms", ""}, {"ties", ""}, {"next", ""}};
    const std::string ties = fmt::format("{}", fmt::join(winner->ties, ", "));
    std::string next;
    if (ties.empty() && winner->runner_up)
        next = fmt::format("{} × {}", *winner->runner_up, score(known(winner->runner_up_over_winner->median)));
    return {{"none", false},
            {"method", winner->method},
            {"ms", milliseconds(known(winner->ms))},
            {"ties", ties},
            {"next", next}};
}

json movement_cells(const MovedMethodRecord& method, Movement movement) {
    const MovedRecord* const m = method.movements.find(to_string(movement));
    if (m == nullptr) return {{"absent", true}};
    const RatioRecord& ratio = m->frame_over_model;
    return {{"absent", false},
            {"ms", milliseconds(known(m->median_ms))},
            {"ratio", score(known(ratio.median))},
            {"interval", interval_in_words(ratio.interval, ratio.coverage, "fewer than six frames")},
            {"rmse", score(known(m->worst_rmse))},
            {"answered", m->answered().value_or(1) < 1 ? percent(m->answered()) : ""}};
}

json method_view(const MovedMethodRecord& method) {
    json view = {{"text", method.text},
                 {"title", method.title},
                 {"ran", !method.movements.empty()},
                 {"why", ""},
                 {"movements", json::array()}};
    if (!method.failed.empty())
        view["why"] = "failed: " + method.failed;
    else if (method.movements.empty())
        view["why"] = "does not serve: " + method.serves.why;
    if (method.movements.empty()) return view;
    const TimesRecord& rest = method.at_rest->phases;
    view["build"]           = milliseconds(known(rest.build_ms->median));
    view["aim"]             = milliseconds(known(rest.aim_ms->median));
    view["look"]            = milliseconds(known(rest.look_ms->median));
    view["visibility"]      = milliseconds(known(rest.visibility_ms->median));
    for (const Movement movement : kMovements) view["movements"].push_back(movement_cells(method, movement));
    return view;
}

/// "Differences below ... are noise of this machine."
std::string noise_in_words(double noise_bar) {
    if (!known(noise_bar)) return "an unknown bar";
    const std::string bar = percent(noise_bar) + " %";
    return is_too_noisy(noise_bar) ? bar + " (too much to say which method is fastest where)" : bar;
}

json scene_view(const MotionRecord& record, const SceneMotionRecord& scene, std::size_t number) {
    json movements = json::array(), methods = json::array(), winners = json::array(), pairs = json::array();
    for (const MovementRecord& m : scene.movements)
        movements.push_back(
            {{"name", m.movement}, {"what", m.cannot.empty() ? m.what : "This scene cannot have it: " + m.cannot}});
    const bool ranked = !is_too_noisy(scene.noise_bar);
    for (const MovedMethodRecord& method : scene.methods) methods.push_back(method_view(method));
    for (const MixRecord& row : scene.winners)
        winners.push_back(
            {{"mix", row.mix}, {"cells", {winner_view(row.complete, ranked), winner_view(row.within, ranked)}}});
    for (const BreakEvenRecord& pair : scene.break_even)
        pairs.push_back({{"method", pair.method},
                         {"over", pair.over},
                         {"setup", milliseconds(known(pair.setup_ms))},
                         {"saves", milliseconds(known(pair.saves_ms))},
                         {"frames", count(known(pair.frames))},
                         {"rounds", pair.rounds[0] == pair.rounds[1]
                                        ? ""
                                        : fmt::format("{} to {}", count(known(pair.rounds[0])),
                                                      known(pair.rounds[1]) ? count(pair.rounds[1]) : "never")}});
    const double max_rmse = record.max_rmse;
    json triangles        = json::array();
    for (const auto& [bound, caption] :
         {std::pair{1e300, std::string("of all that answer every point")},
          {max_rmse, fmt::format("with an RMSE of at most {:g} in every frame", max_rmse)}})
        if (json triangle = triangle_view(scene, bound, caption); ranked && triangle["any"].get<bool>())
            triangles.push_back(std::move(triangle));
    std::string lights;
    for (const MovedLightRecord& light : scene.lights) lights += (lights.empty() ? "" : ", ") + light.name;
    return {{"id", fmt::format("scene-{}", number)},
            {"title", scene.title},
            {"facts",
             fmt::format("{} triangles, {} × {} pixels, {}: {}", count(static_cast<double>(scene.triangles)),
                         *scene.size.width, *scene.size.height, scene.lights.size() == 1 ? "light" : "lights", lights)},
            {"reference",
             scene.reference.method +
                 (scene.reference.sampled
                      ? fmt::format(", at about {} stratified points for lights with an area", record.area_points)
                      : ", at every point")},
            {"noise", noise_in_words(scene.noise_bar)},
            {"movements", std::move(movements)},
            {"methods", std::move(methods)},
            {"winners", std::move(winners)},
            {"pairs", std::move(pairs)},
            {"triangles", std::move(triangles)}};
}

}  // namespace

void write_motion_page(const MotionRecord& record, const std::filesystem::path& out, StagedFiles& staged) {
    json view        = record_view(record.head, record.machine, record.load_average, record.failed);
    view["frames"]   = std::to_string(record.frames);
    view["arc"]      = fmt::format("{:g}", record.arc_degrees);
    view["max_rmse"] = fmt::format("{:g}", record.max_rmse);
    view["scenes"]   = json::array();
    for (const SceneMotionRecord& scene : record.motion)
        view["scenes"].push_back(scene_view(record, scene, view["scenes"].size() + 1));
    write_page(out, assets::motion_html, {"What moves: the fastest shadow method by movement"}, std::move(view),
               staged);
}

}  // namespace umbra
