#include "umbra/bench/whitted/whitted_page.h"

#include <fmt/format.h>

#include <map>

#include "report_assets.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/record_folder.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

/// What a phase or a way is, for readers.
std::string about(const std::string& name) {
    static const std::map<std::string, std::string> sentences{
        {"eye_rays", "What each eye ray meets, in packets of neighbouring rays: the raster"},
        {"secondary_rays", "What mirrored and refracted rays meet"},
        {"shadows", "S_j of all these points, and which lights are in front of them"},
        {"sums", "The sum at these points"},
        {"directions", "Where mirrored and refracted rays go"},
        {"gathering", "Adding intensities, from the last depth to the first"}};
    const auto found = sentences.find(name);
    return found == sentences.end() ? name : found->second;
}

std::string about_way(const std::string& name) {
    static const std::map<std::string, std::string> sentences{
        {"raster", "Eye rays from the raster, other rays from mirrors and glass alone"},
        {"eye_rays", "Each eye ray by itself, other rays from mirrors and glass alone"},
        {"everywhere", "Each eye ray by itself, mirrored rays from every surface"},
        {"any_weight", "Eye rays from the raster, no ray too light"}};
    const auto found = sentences.find(name);
    return found == sentences.end() ? name : found->second;
}

std::string figure(const Json& value, const char* format) {
    return value.is_null() ? kNone : fmt::format(fmt::runtime(format), value.get<double>());
}

std::string digits(const Json& value) { return value.is_null() ? kNone : score(value.get<double>()); }

json depth_view(const Json& d) {
    const auto number = [&](const char* key) { return count(d[key].get<double>()); };
    return {{"depth", number("depth")},
            {"reflected", number("reflected")},
            {"refracted", number("refracted")},
            {"met", number("met")},
            {"left", number("left")},
            {"shadow", number("shadow")},
            {"total", number("total_reflections")},
            {"too_light", number("too_light")},
            {"too_deep", number("too_deep")},
            {"rmse", figure(d["rmse"], "{:.5f}")},
            {"flip", figure(d["flip"], "{:.4f}")},
            {"picture", d["picture"]}};
}

/// Rays of all depths by kind.
json rays_view(const Json& depths) {
    const auto sum = [&](const char* key) {
        double all = 0;
        for (const Json& d : depths) all += d[key].get<double>();
        return all;
    };
    return {{"eye", counted(sum("eye"), "eye ray")},
            {"reflected", counted(sum("reflected"), "reflected ray")},
            {"refracted", counted(sum("refracted"), "refracted ray")},
            {"shadow", counted(sum("shadow"), "shadow ray")}};
}

json search_view(const Json& search) {
    json view = json::array();
    if (search.is_null()) return view;
    view.push_back({{"rays", count(search["rays"].get<double>())},
                    {"of", count(search["of"].get<double>())},
                    {"triangles", count(search["triangles"].get<double>())},
                    {"tree", digits(search["tree_us"])},
                    {"search", digits(search["search_us"])},
                    {"ratio", digits(search["ratio"])},
                    {"seconds", score(search["all_by_search_ms"].get<double>() / 1000)},
                    {"different", count(search["different"].get<double>())}});
    return view;
}

json blind_view(const Json& blind) {
    json view = json::array();
    if (blind.is_null()) return view;
    view.push_back({{"points", counted(blind["points"].get<double>(), "pixel")},
                    {"dark", count(blind["points_in_shadow"].get<double>())},
                    {"picture", blind["picture"]}});
    return view;
}

json screen_door_view(const Json& door) {
    json view = json::array();
    if (door.is_null()) return view;
    view.push_back({{"rmse", figure(door["rmse"], "{:.5f}")},
                    {"flip", figure(door["flip"], "{:.4f}")},
                    {"rays", counted(door["rays"].get<double>(), "ray")},
                    {"picture", door["picture"]}});
    return view;
}

json single_view(const Json& single) {
    json view = json::array();
    if (single.is_null()) return view;
    view.push_back({{"rmse", figure(single["rmse"], "{:.5f}")},
                    {"flip", figure(single["flip"], "{:.4f}")},
                    {"picture", single["picture"]}});
    return view;
}

std::string places_in_words(const std::string& places) {
    if (places == "jittered") return ", each anywhere in its part of the pixel";
    return places == "random" ? ", anywhere in it" : "";
}

std::string about_kind(const std::string& kind) {
    static const std::map<std::string, std::string> names{{"met", "rays that met a surface"},
                                                          {"total_reflections", "total reflections"}};
    const auto found = names.find(kind);
    return found == names.end() ? kind + " rays" : found->second;
}

json formula_view(const Json& formula) {
    json view = json::array();
    if (formula.is_null()) return view;
    json kinds = json::array();
    for (const auto& [kind, rays] : formula["totals"].items())
        kinds.push_back({{"kind", about_kind(kind)},
                         {"triangles", count(formula["totals_of_triangles"][kind].get<double>())},
                         {"formula", count(rays.get<double>())}});
    const double boxes  = formula["bodies"]["boxes"].get<double>();
    const Json& samples = formula["light_samples"];
    view.push_back({{"spheres", counted(formula["bodies"]["spheres"].get<double>(), "sphere")},
                    {"boxes", count(boxes) + (boxes == 1 ? " box" : " boxes")},
                    {"replaced", counted(formula["triangles_replaced"].get<double>(), "triangle")},
                    {"left", counted(formula["triangles_left"].get<double>(), "triangle")},
                    {"rays", counted(formula["rays"].get<double>(), "ray")},
                    {"ms", figure(formula["ms"], "{:.1f}")},
                    {"rmse", figure(formula["rmse"], "{:.5f}")},
                    {"flip", figure(formula["flip"], "{:.4f}")},
                    {"largest", digits(formula["max_difference"])},
                    {"samples", samples.is_null() ? std::string() : count(samples.get<double>())},
                    {"kinds", std::move(kinds)},
                    {"picture", formula["picture"]}});
    return view;
}

}  // namespace

void write_whitted_page(const Json& record, const std::filesystem::path& folder, StagedFiles& staged) {
    json depths = json::array(), phases = json::array(), ways = json::array(), warnings = json::array();
    for (const Json& d : record["depths"]) depths.push_back(depth_view(d));
    for (const Json& p : record["phases"])
        phases.push_back({{"about", about(p["name"].get<std::string>())},
                          {"ms", figure(p["ms"], "{:.1f}")},
                          {"percent", fmt::format("{:.1f}", 100 * p["fraction"].get<double>())}});
    for (const Json& w : record["ways"])
        ways.push_back({{"about", about_way(w["name"].get<std::string>())},
                        {"rays", count(w["rays"].get<double>())},
                        {"ms", figure(w["ms"], "{:.1f}")},
                        {"different", count(w["different_pixels"].get<double>())},
                        {"largest", score(w["max_difference"].get<double>())}});
    for (const Json& w : record["scene"]["warnings"]) warnings.push_back(w.get<std::string>());
    const double undefined = record["undefined"].get<double>();
    const json view        = {{"title", record["scene"]["title"]},
                              {"command", without_folders(record["command"].get<std::string>())},
                              {"version", record["version"]},
                              {"method", record["method"].is_null() ? "none" : record["method"].get<std::string>()},
                              {"whole", record["picture"]},
                              {"rays_picture", record["rays_picture"]},
                              {"most_rays", figure(record["most_rays_a_pixel"], "{:.3g}")},
                              {"depth", count(record["depth"].get<double>())},
                              {"least_weight", figure(record["least_weight"], "{:g}")},
                              {"pixel_samples", counted(record["pixel_samples"].get<double>(), "eye ray")},
                              {"places", places_in_words(record["pixel_places"].get<std::string>())},
                              {"rays", rays_view(record["depths"])},
                              {"total_ms", figure(record["total_ms"], "{:.1f}")},
                              {"glossy", record["glossy"]},
                              {"undefined", undefined > 0 ? count(undefined) : std::string()},
                              {"warnings", std::move(warnings)},
                              {"depths", std::move(depths)},
                              {"phases", std::move(phases)},
                              {"ways", std::move(ways)},
                              {"search", search_view(record["search"])},
                              {"blind", blind_view(record["blind"])},
                              {"screen_door", screen_door_view(record["screen_door"])},
                              {"single", single_view(record["single"])},
                              {"formula", formula_view(record["formula"])}};
    const PageHead head    = {fmt::format("Ray tracing: {}", record["scene"]["title"].get<std::string>()), "", {}};
    staged.write(folder / "index.html", render_page(assets::whitted_html, head, view));
    write_page_assets(folder, head.scripts, staged);
}

Json write_whitted_study(const PreparedScene& prepared, const WhittedOptions& options,
                         const std::filesystem::path& out) {
    return write_record_folder(
        out, [&](const std::filesystem::path& folder) { return trace_whitted(prepared, options, folder); },
        write_whitted_page);
}

}  // namespace umbra
