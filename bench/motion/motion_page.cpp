#include "umbra/bench/motion/motion_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "report_assets.h"
#include "umbra/bench/motion/animation.h"
#include "umbra/bench/motion/mix_triangle.h"
#include "umbra/bench/motion/record_view.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/statistics/statistics.h"

namespace umbra {
namespace {

using nlohmann::json;

/// Corners of the triangle in the units of its viewBox: camera, light, object.
constexpr std::array<std::array<double, 2>, 3> kCorners{{{40, 300}, {400, 300}, {220, 28}}};

std::array<double, 2> place(const Shares& shares) {
    std::array<double, 2> at{0, 0};
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t c = 0; c < 2; ++c) at[c] += shares[k] * kCorners[k][c];
    return at;
}

/// Methods that ran every movement and answered every point, in the order of the record. None where the scene lacks a
/// movement: there is no triangle then.
struct Competitor {
    std::string text;
    CornerTimes times;
    std::size_t style;
};
std::vector<Competitor> competitors(const Json& scene, double max_rmse) {
    std::vector<Competitor> all;
    std::size_t style = 0;
    for (const Json& method : scene["methods"]) {
        const std::size_t own = style++;
        if (!method.contains("movements") || method.contains("failed")) continue;
        Competitor c{text(method["text"]), {}, own};
        bool competes = true;
        for (std::size_t k = 0; k < kMovements.size(); ++k) {
            const std::string name(to_string(kMovements[k]));
            if (!method["movements"].contains(name)) return {};  // the scene has no such corner
            const Json& m = method["movements"][name];
            c.times[k]    = m["median_ms"].get<double>();
            competes =
                competes && m["undefined"].get<std::uint64_t>() == 0 && value(m["worst_rmse"]).value_or(0) <= max_rmse;
        }
        if (competes) all.push_back(std::move(c));
    }
    return all;
}

json triangle_view(const Json& scene, double max_rmse, const std::string& caption) {
    const std::vector<Competitor> all = competitors(scene, max_rmse);
    std::vector<CornerTimes> times;
    for (const Competitor& c : all) times.push_back(c.times);
    json regions = json::array();
    for (const MixRegion& region : mix_regions(times)) {
        std::string path;
        std::array<double, 2> middle{0, 0};
        for (const Shares& corner : region.corners) {
            const auto at = place(corner);
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", at[0], at[1]);
            for (std::size_t c = 0; c < 2; ++c) middle[c] += at[c] / static_cast<double>(region.corners.size());
        }
        const Competitor& c = all[region.method];
        regions.push_back({{"path", path + "z"},
                           {"colour", std::to_string(mark_style(c.style).colour)},
                           {"label", region.area > 0.08 ? c.text : ""},
                           {"x", fmt::format("{:.1f}", middle[0])},
                           {"y", fmt::format("{:.1f}", middle[1])},
                           {"method", c.text},
                           {"share", region.area < 0.001 ? "< 0.1" : percent(region.area)}});
    }
    return {{"caption", caption}, {"any", !regions.empty()}, {"regions", std::move(regions)}};
}

json winner_view(const Json& winner, bool ranked) {
    if (winner.is_null() || !ranked)
        return {
            {"none", winner.is_null() ? "none" : "not ranked"}, {"method", ""}, {"ms", ""}, {"ties", ""}, {"next", ""}};
    std::string ties, next;
    for (const Json& tie : winner["ties"]) ties += (ties.empty() ? "" : ", ") + text(tie);
    if (ties.empty() && !winner["runner_up"].is_null())
        next =
            fmt::format("{} × {}", text(winner["runner_up"]), score(value(winner["runner_up_over_winner"]["median"])));
    return {{"none", false},
            {"method", winner["method"]},
            {"ms", milliseconds(value(winner["ms"]))},
            {"ties", ties},
            {"next", next}};
}

/// "1.07 to 1.20, 97.9 %"; of fewer than six frames there is none.
std::string interval_in_words(const Json& ratio) {
    const Json& interval = ratio["interval"];
    if (interval[0].is_null()) return "fewer than six frames";
    return fmt::format("{} to {}, {}", score(value(interval[0])), score(value(interval[1])), coverage_text(ratio));
}

json movement_cells(const Json& method, const std::string& movement) {
    if (!method["movements"].contains(movement)) return {{"absent", true}};
    const Json& m = method["movements"][movement];
    return {{"absent", false},
            {"ms", milliseconds(value(m["median_ms"]))},
            {"ratio", score(value(m["frame_over_model"]["median"]))},
            {"interval", interval_in_words(m["frame_over_model"])},
            {"rmse", score(value(m["worst_rmse"]))},
            {"answered", answered_share(m).value_or(1) < 1 ? percent(answered_share(m)) : ""}};
}

json method_view(const Json& method) {
    json view = {{"text", method["text"]},
                 {"title", method["title"]},
                 {"ran", method.contains("movements")},
                 {"why", ""},
                 {"movements", json::array()}};
    if (method.contains("failed"))
        view["why"] = "failed: " + text(method["failed"]);
    else if (!method.contains("movements"))
        view["why"] = "does not serve: " + text(method["serves"]["why"]);
    if (!method.contains("movements")) return view;
    for (const char* phase : {"build", "aim", "look", "visibility"})
        view[phase] = milliseconds(value(method["at_rest"][fmt::format("{}_ms", phase)]["median"]));
    for (const Movement movement : kMovements)
        view["movements"].push_back(movement_cells(method, std::string(to_string(movement))));
    return view;
}

/// "Differences below ... are noise of this machine."
std::string noise_in_words(const Json& noise_bar) {
    if (noise_bar.is_null()) return "an unknown bar";
    const std::string bar = percent(value(noise_bar)) + " %";
    return is_ranked(noise_bar) ? bar : bar + " (too much to say which method is fastest where)";
}

json scene_view(const Json& record, const Json& scene, std::size_t number) {
    json movements = json::array(), methods = json::array(), winners = json::array(), pairs = json::array();
    for (const Json& m : scene["movements"])
        movements.push_back(
            {{"name", m["movement"]},
             {"what", m.contains("cannot") ? "This scene cannot have it: " + text(m["cannot"]) : text(m["what"])}});
    const bool ranked = is_ranked(scene["noise_bar"]);
    for (const Json& method : scene["methods"]) methods.push_back(method_view(method));
    for (const Json& row : scene["winners"])
        winners.push_back({{"mix", row["mix"]},
                           {"cells", {winner_view(row["complete"], ranked), winner_view(row["within"], ranked)}}});
    for (const Json& pair : scene["break_even"])
        pairs.push_back(
            {{"method", pair["method"]},
             {"over", pair["over"]},
             {"setup", milliseconds(value(pair["setup_ms"]))},
             {"saves", milliseconds(value(pair["saves_ms"]))},
             {"frames", count(value(pair["frames"]))},
             {"rounds", pair["rounds"][0] == pair["rounds"][1]
                            ? ""
                            : fmt::format("{} to {}", count(value(pair["rounds"][0])),
                                          pair["rounds"][1].is_null() ? "never" : count(value(pair["rounds"][1])))}});
    const double max_rmse = record["max_rmse"].get<double>();
    json triangles        = json::array();
    for (const auto& [bound, caption] :
         {std::pair{1e300, std::string("of all that answer every point")},
          {max_rmse, fmt::format("with an RMSE of at most {:g} in every frame", max_rmse)}})
        if (json triangle = triangle_view(scene, bound, caption); ranked && triangle["any"].get<bool>())
            triangles.push_back(std::move(triangle));
    std::string lights;
    for (const Json& light : scene["lights"]) lights += (lights.empty() ? "" : ", ") + text(light["name"]);
    return {{"id", fmt::format("scene-{}", number)},
            {"title", scene["title"]},
            {"facts", fmt::format("{} triangles, {} × {} pixels, {}: {}", count(scene["triangles"].get<double>()),
                                  scene["size"]["width"].get<int>(), scene["size"]["height"].get<int>(),
                                  scene["lights"].size() == 1 ? "light" : "lights", lights)},
            {"reference", fmt::format("{}{}", text(scene["reference"]["method"]),
                                      scene["reference"]["sampled"].get<bool>()
                                          ? fmt::format(", at about {} stratified points for lights with an area",
                                                        record["area_points"].get<std::uint64_t>())
                                          : ", at every point")},
            {"noise", noise_in_words(scene["noise_bar"])},
            {"movements", std::move(movements)},
            {"methods", std::move(methods)},
            {"winners", std::move(winners)},
            {"has_pairs", !pairs.empty()},
            {"pairs", std::move(pairs)},
            {"has_triangles", !triangles.empty()},
            {"triangles", std::move(triangles)}};
}

}  // namespace

void write_motion_page(const Json& record, const std::filesystem::path& out, StagedFiles& staged) {
    json view        = record_view(record, "scene");
    view["frames"]   = std::to_string(record["frames"].get<int>());
    view["arc"]      = fmt::format("{:g}", record["arc_degrees"].get<double>());
    view["max_rmse"] = fmt::format("{:g}", record["max_rmse"].get<double>());
    view["scenes"]   = json::array();
    for (const Json& scene : record["motion"])
        view["scenes"].push_back(scene_view(record, scene, view["scenes"].size() + 1));
    const PageHead head = {"What moves: the fastest shadow method by movement", "", {}};
    staged.write(out / "index.html", render_page(assets::motion_html, head, view));
    write_page_assets(out, head.scripts, staged);
}

}  // namespace umbra
