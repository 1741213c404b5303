#include "umbra/bench/report/scene_tables.h"

#include <fmt/format.h>

#include <cctype>
#include <functional>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/error_palette.h"
#include "umbra/bench/pages/mesh_faults.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/time_ratios.h"
#include "umbra/bench/run/edge_figure.h"

namespace umbra {
namespace {

using nlohmann::json;

json timing(const Field& time) {
    const auto median = time["median"].number(), min = time["min"].number(), max = time["max"].number();
    json view = {{"median", milliseconds(median)}, {"range", false}};
    if (median && min && max && *min != *max)
        view["range"] = fmt::format("{}–{}", milliseconds(min), milliseconds(max));
    return view;
}

/// Rows by light: `row` of every `errors` entry, that is of each method that was compared, in the methods' order.
json rows_by_light(const Field& root, const std::vector<Field>& methods,
                   const std::function<json(const Field& method, const Field& error)>& row) {
    json groups = json::array();
    for (const Field& light : root["lights"].items()) {
        const std::string name = light["name"].required_text();
        json rows              = json::array();
        for (const Field& method : methods) {
            if (is_reference(root, method)) continue;
            for (const Field& error : method["errors"].items()) {
                if (error["light"].required_text() != name) continue;
                json view     = row(method, error);
                view["label"] = method_label(method, methods);
                rows.push_back(std::move(view));
            }
        }
        if (!rows.empty()) groups.push_back({{"light", name}, {"rows", std::move(rows)}});
    }
    return groups;
}

/// A count of the table of errors: a column of a group of columns.
struct Column {
    std::string group, member, title;
};

/// "false_shadow" as "False shadow".
std::string heading(std::string_view key) {
    std::string words = in_words(std::string(key));
    words[0]          = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
    return words;
}

/// The counts that any method has, interior and edge before the special classes.
std::vector<Column> counted_columns(const std::vector<Field>& methods) {
    const auto is_counted = [&](std::string_view group, std::string_view member) {
        for (const Field& method : methods)
            for (const Field& error : method["errors"].items())
                if (error[group][member].present()) return true;
        return false;
    };
    std::vector<Column> columns;
    const auto add = [&](const std::string& group, std::string_view member, std::string title) {
        if (is_counted(group, member)) columns.push_back({group, std::string(member), std::move(title)});
    };
    for (const std::string& group : error_groups()) {
        add(group, "interior", "Interior");
        add(group, "edge", "Edge band");
        for (const ErrorColour& entry : kErrorPalette)
            if (entry.group == group && !entry.member.empty()) add(group, entry.member, heading(entry.key));
    }
    return columns;
}

json column_groups(const std::vector<Column>& columns) {
    json groups = json::array();
    for (const std::string& group : error_groups()) {
        json titles = json::array();
        for (const Column& column : columns)
            if (column.group == group) titles.push_back(column.title);
        std::string colour;
        for (const ErrorColour& entry : kErrorPalette)
            if (entry.group == group && entry.member.empty() && entry.interior) colour = entry.srgb;
        if (!titles.empty())
            groups.push_back({{"title", heading(group)},
                              {"colour", colour},
                              {"span", std::to_string(titles.size())},
                              {"columns", std::move(titles)}});
    }
    return groups;
}

}  // namespace

json error_view(const Field& root, const std::vector<Field>& methods) {
    const std::vector<Column> columns = counted_columns(methods);
    bool unshadowed                   = false;  // some object receives no shadows
    json groups                       = rows_by_light(root, methods, [&](const Field& method, const Field& e) {
        unshadowed  = unshadowed || e["unshadowed"].present();
        json counts = json::array();
        for (const Column& column : columns) {
            const auto n = e[column.group][column.member].number();
            counts.push_back({{"n", count(n)}, {"wrong", column.member == "interior" && n && *n > 0}});
        }
        return json{{"coverage", percent(method["coverage"].number())},
                    {"points", count(e["points"].number())},
                    {"undefined", count(e["undefined"].number())},
                    {"on_boundary", count(e["on_boundary"].number())},
                    {"not_judged", count(e["not_judged"].number())},
                    {"away", count(e["away"].number())},
                    {"unshadowed", count(e["unshadowed"].number().value_or(0))},
                    {"lit", count(e["lit"].number())},
                    {"umbra", count(e["umbra"].number())},
                    {"penumbra", count(e["penumbra"].number())},
                    {"counts", std::move(counts)},
                    {"mae", score(e["mae"].number())},
                    {"rmse", score(e["rmse"].number())},
                    {"max", score(e["max"].number())},
                    {"bias", score(e["bias"].number())}};
    });
    return {{"groups", std::move(groups)},
            {"any_unshadowed", unshadowed},
            {"region_columns", unshadowed ? "10" : "9"},
            {"column_groups", column_groups(columns)},
            {"all_columns", std::to_string(7 + columns.size())}};
}

std::string edge_figure(const std::optional<EdgeFigure>& figure) {
    if (!figure) return kNone;
    return (figure->at_least ? "≥ " : "") + score(figure->value);
}

json cause_view(const Field& root, const std::vector<Field>& methods) {
    return {{"groups", rows_by_light(root, methods, [](const Field& method, const Field& e) {
                 const Field edges = e["edge_displacement_px"], width = e["penumbra_width_px"], noise = e["noise"],
                             interior = e["interior"], terminator = e["terminator"];
                 const EdgeRecord off{edges["mean"].number(),
                                      edges["p95"].number(),
                                      edges["max"].number(),
                                      edges["pieces"].number().value_or(0),
                                      edges["unmatched"].number().value_or(0),
                                      edges["reach"].number().value_or(0)};
                 return json{{"coverage", percent(method["coverage"].number())},
                             {"wrong_lit", count(interior["lit"].number())},
                             {"wrong_penumbra", count(interior["penumbra"].number())},
                             {"wrong_umbra", count(interior["umbra"].number())},
                             {"terminator_facet", count(terminator["facet_away"].number())},
                             {"terminator_normal", count(terminator["normal_away"].number())},
                             {"terminator_wrong", count(terminator["wrong"].number())},
                             {"off_mean", edge_figure(off.whole_mean())},
                             {"off_p95", edge_figure(off.whole_p95())},
                             {"off_max", edge_figure(off.whole_max())},
                             {"off_lost", count(edges["unmatched"].number())},
                             {"width", score(width["method"].number())},
                             {"width_reference", score(width["reference"].number())},
                             {"noise", score(noise["noise_rmse"].number())},
                             {"noise_bias", score(noise["bias_rmse"].number())},
                             {"bracket", score(e["bracket"]["max_half_width"].number())}};
             })}};
}

json time_view(const Field& root, const std::vector<Field>& methods) {
    json rows = json::array(), by_light = json::array(), shared = json::array();
    for (const Field& method : methods) {
        if (!serves(method)) continue;
        const Totals t    = totals(method);
        const Field times = method["times"];
        rows.push_back({{"label", method_label(method, methods)},
                        {"coverage", percent(method["coverage"].number())},
                        {"build", timing(times["build_ms"])},
                        {"aim", timing(times["aim_ms"])},
                        {"look", timing(times["look_ms"])},
                        {"visibility", timing(times["visibility_ms"])},
                        {"object", milliseconds(t.object_ms)},
                        {"light", milliseconds(t.light_ms)},
                        {"camera", milliseconds(t.camera_ms)},
                        {"memory", mebibytes(method["memory_bytes"].number())}});
        for (const Field& light : method["light_times"].items())
            by_light.push_back({{"label", method_label(method, methods)},
                                {"light", light["light"].required_text()},
                                {"aim", timing(light["aim_ms"])},
                                {"visibility", timing(light["visibility_ms"])}});
    }
    for (const auto& [key, name] : {std::pair{"load_ms", "reading the scene"},
                                    {"facts_ms", "analysing the scene"},
                                    {"rays_build_ms", "building the ray tracer's tree"},
                                    {"gbuffer_ms", "tracing the camera rays"},
                                    {"shade_ms", "shading"}})
        if (const auto ms = root["times"][key].number()) shared.push_back({{"name", name}, {"ms", score(ms)}});
    const bool several = root["lights"].items().size() > 1 && !by_light.empty();
    return {{"rows", std::move(rows)},
            {"ratios", time_ratio_view(root, methods)},
            {"several_lights", several},
            {"by_light", std::move(by_light)},
            {"shared", std::move(shared)}};
}

json fact_view(const Field& root) {
    const Field facts = root["facts"];
    json requirements = json::array(), not_required = json::array(), objects = json::array();
    for (const Field& f : facts["requires"].items()) requirements.push_back(f.required_text());
    for (const Field& f : facts["not_required"].items()) not_required.push_back(f.required_text());
    for (const Field& o : facts["objects"].items()) {
        json faults = json::array();
        for (const MeshFault& fault : kMeshFaults)
            if (const auto n = o[fault.key].number(); n && *n > 0)
                faults.push_back(fmt::format("{} {}", count(n), *n == 1 ? fault.one : fault.many));
        const bool closed = o["closed"].flag(), outward = o["outward"].flag(), planar = o["planar"].flag();
        objects.push_back({{"name", o["name"].text()},
                           {"triangles", count(o["triangles"].number())},
                           {"vertices", count(o["vertices"].number())},
                           {"components", count(o["components"].number())},
                           {"shape", fmt::format("{}{}", closed ? (outward ? "closed" : "closed, inside out") : "open",
                                                 planar ? ", planar" : "")},
                           {"area", score(o["area"].number())},
                           {"volume", closed ? score(o["volume"].number()) : kNone},
                           {"faults", std::move(faults)}});
    }
    return {{"triangles", count(facts["triangles"].number())},
            {"requires", std::move(requirements)},
            {"not_required", std::move(not_required)},
            {"has_objects", !objects.empty()},
            {"objects", std::move(objects)}};
}

}  // namespace umbra
