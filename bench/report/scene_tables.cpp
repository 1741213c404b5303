#include "umbra/bench/report/report_views.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "umbra/bench/lab/edge_figure.h"
#include "umbra/bench/pages/error_palette.h"
#include "umbra/bench/pages/mesh_faults.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

json timing(const std::optional<TimingRecord>& time) {
    if (!time) return {{"median", kNone}, {"range", false}};
    json view = {{"median", milliseconds(time->median)}, {"range", false}};
    if (time->min != time->max) view["range"] = fmt::format("{}–{}", milliseconds(time->min), milliseconds(time->max));
    return view;
}

/// Rows by light: `row` of every `errors` entry, that is of each method that was compared, in the methods' order.
json rows_by_light(const Results& results,
                   const std::function<json(const MethodRecord& method, const ErrorRecord& error)>& row) {
    json groups = json::array();
    for (const LightRecord& light : results.lights) {
        json rows = json::array();
        for (const MethodRecord& method : results.methods) {
            if (is_reference(results, method)) continue;
            for (const ErrorRecord& error : method.errors) {
                if (error.light != light.name) continue;
                json view     = row(method, error);
                view["label"] = method_label(method, results.methods);
                rows.push_back(std::move(view));
            }
        }
        if (!rows.empty()) groups.push_back({{"light", light.name}, {"rows", std::move(rows)}});
    }
    return groups;
}

/// A count of the table of errors: a column of a group of columns.
struct Column {
    std::string_view group, member;
    std::string title;
};

/// "false_shadow" as "False shadow".
std::string heading(std::string_view key) {
    std::string words = in_words(key);
    words[0]          = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
    return words;
}

/// The counts that any method has, interior and edge before the special classes.
std::vector<Column> counted_columns(const std::vector<MethodRecord>& methods) {
    const auto is_counted = [&](std::string_view group, std::string_view member) {
        for (const MethodRecord& method : methods)
            for (const ErrorRecord& error : method.errors)
                if (wrong_points(error, group, member)) return true;
        return false;
    };
    std::vector<Column> columns;
    const auto add = [&](std::string_view group, std::string_view member, std::string title) {
        if (is_counted(group, member)) columns.push_back({group, member, std::move(title)});
    };
    for (const std::string_view group : kErrorGroups) {
        add(group, "interior", "Interior");
        add(group, "edge", "Edge band");
        for (const ErrorColour& entry : kErrorPalette)
            if (entry.group == group && !entry.member.empty()) add(group, entry.member, heading(entry.key));
    }
    return columns;
}

json column_groups(const std::vector<Column>& columns) {
    json groups = json::array();
    for (const std::string_view group : kErrorGroups) {
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

/// "8 × 3 × 8 units, diagonal 11.7", of the box around all objects.
std::string size_in_words(const ExtentRecord& box) {
    if (box.min.size() != 3 || box.max.size() != 3) return kNone;
    const dvec3 size(box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]);
    return fmt::format("{:.4g} × {:.4g} × {:.4g} units, diagonal {:.4g}", size.x, size.y, size.z, glm::length(size));
}

}  // namespace

json error_view(const Results& results) {
    const std::vector<Column> columns = counted_columns(results.methods);
    bool unshadowed                   = false;
    json groups                       = rows_by_light(results, [&](const MethodRecord& method, const ErrorRecord& e) {
        unshadowed  = unshadowed || e.unshadowed > 0;
        json counts = json::array();
        for (const Column& column : columns) {
            const auto n = wrong_points(e, column.group, column.member);
            counts.push_back({{"n", count(n)}, {"wrong", column.member == "interior" && n && *n > 0}});
        }
        return json{{"coverage", percent(method.coverage)},
                    {"points", count(e.points)},
                    {"undefined", count(e.undefined)},
                    {"on_boundary", count(e.on_boundary)},
                    {"not_judged", count(e.not_judged)},
                    {"away", count(e.away)},
                    {"unshadowed", count(e.unshadowed)},
                    {"lit", count(e.lit)},
                    {"umbra", count(e.umbra)},
                    {"penumbra", count(e.penumbra)},
                    {"counts", std::move(counts)},
                    {"mae", score(e.mae)},
                    {"rmse", score(e.rmse)},
                    {"max", score(e.max)},
                    {"bias", score(e.bias)}};
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

json cause_view(const Results& results) {
    return {{"groups", rows_by_light(results, [](const MethodRecord& method, const ErrorRecord& e) {
                 const auto edges = e.edge_displacement_px.value_or(DisplacementRecord{});
                 const WholeEdge off(edges);
                 const auto width = e.penumbra_width_px.value_or(PenumbraRecord{});
                 const auto noise = e.noise.value_or(NoiseRecord{});
                 return json{{"coverage", percent(method.coverage)},
                             {"wrong_lit", count(e.interior.lit)},
                             {"wrong_penumbra", count(e.interior.penumbra)},
                             {"wrong_umbra", count(e.interior.umbra)},
                             {"terminator_facet", count(e.terminator.facet_away)},
                             {"terminator_normal", count(e.terminator.normal_away)},
                             {"terminator_wrong", count(e.terminator.wrong)},
                             {"off_mean", edge_figure(off.mean())},
                             {"off_p95", edge_figure(off.p95())},
                             {"off_max", edge_figure(off.max())},
                             {"off_lost", e.edge_displacement_px ? count(e.edge_displacement_px->unmatched) : kNone},
                             {"width", score(known(width.method))},
                             {"width_reference", score(known(width.reference))},
                             {"noise", score(known(noise.noise_rmse))},
                             {"noise_bias", score(known(noise.bias_rmse))},
                             {"bracket", score(e.bracket ? known(e.bracket->max_half_width) : std::nullopt)}};
             })}};
}

json time_view(const Results& results) {
    json rows = json::array(), by_light = json::array(), shared = json::array(), outside = json::array();
    for (const MethodRecord& method : results.methods) {
        if (!serves(method)) continue;
        const Totals t          = totals(method);
        const std::string label = method_label(method, results.methods);
        if (const auto& own = method.own_times)
            outside.push_back({{"label", label},
                               {"own",
                                {{"build", milliseconds(known(own->build_ms))},
                                 {"aim", milliseconds(known(own->aim_ms))},
                                 {"look", milliseconds(known(own->look_ms))},
                                 {"visibility", milliseconds(known(own->visibility_ms))}}}});
        else if (!method.outside.empty())
            outside.push_back({{"label", label}, {"file", method.outside == "file of answers"}});
        const TimesRecord times = method.times ? method.times->phases : TimesRecord{};
        rows.push_back({{"label", label},
                        {"coverage", percent(method.coverage)},
                        {"build", timing(times.build_ms)},
                        {"aim", timing(times.aim_ms)},
                        {"look", timing(times.look_ms)},
                        {"visibility", timing(times.visibility_ms)},
                        {"object", milliseconds(t.object_ms)},
                        {"light", milliseconds(t.light_ms)},
                        {"camera", milliseconds(t.camera_ms)},
                        {"memory", mebibytes(method.memory_bytes)}});
        for (const LightTimesRecord& light : method.light_times)
            by_light.push_back({{"label", label},
                                {"light", light.light},
                                {"aim", timing(light.aim_ms)},
                                {"visibility", timing(light.visibility_ms)}});
    }
    for (const auto& [key, name] : {std::pair{"load_ms", "reading the scene"},
                                    {"facts_ms", "analysing the scene"},
                                    {"rays_build_ms", "building the ray tracer's tree"},
                                    {"gbuffer_ms", "tracing the camera rays"},
                                    {"shade_ms", "shading"}})
        if (const double* ms = results.times.find(key)) shared.push_back({{"name", name}, {"ms", score(known(*ms))}});
    const bool several = results.lights.size() > 1 && !by_light.empty();
    return {{"rows", std::move(rows)},       {"ratios", time_ratio_view(results)}, {"several_lights", several},
            {"outside", std::move(outside)}, {"by_light", std::move(by_light)},    {"shared", std::move(shared)}};
}

json fact_view(const FactsRecord& facts) {
    json objects = json::array();
    for (const ObjectRecord& o : facts.objects) {
        json faults = json::array();
        for (const MeshFault& fault : kMeshFaults)
            if (const std::uint64_t n = o.*fault.count; n > 0)
                faults.push_back(fmt::format("{} {}", count(n), n == 1 ? fault.one : fault.many));
        objects.push_back(
            {{"name", o.name},
             {"triangles", count(o.triangles)},
             {"vertices", count(o.vertices)},
             {"components", count(o.components)},
             {"shape", fmt::format("{}{}", o.closed ? (o.outward ? "closed" : "closed, inside out") : "open",
                                   o.planar ? ", planar" : "")},
             {"area", score(known(o.area))},
             {"volume", o.closed ? score(known(o.volume)) : kNone},
             {"faults", std::move(faults)}});
    }
    return {{"triangles", count(facts.triangles)},
            {"size", size_in_words(facts.extent)},
            {"requires", facts.required},
            {"not_required", facts.not_required},
            {"objects", std::move(objects)}};
}

}  // namespace umbra
