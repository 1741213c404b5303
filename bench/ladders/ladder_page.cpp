#include "umbra/bench/ladders/ladder_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "report_assets.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/ladders/interior_points.h"
#include "umbra/bench/ladders/ladder_cells.h"
#include "umbra/bench/ladders/textbook_view.h"
#include "umbra/bench/pages/failures.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/pages/why_point.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The methods of all ladders, as typed, in the order in which they first appear; the sum is not one of them.
std::vector<const ClimbRecord*> methods_of(const LaddersRecord& record) {
    std::vector<const ClimbRecord*> all;
    for (const LadderRecord& ladder : record.ladders)
        for (const ClimbRecord& climbed : ladder.methods) {
            if (is_textbook_twin(ladder, climbed)) continue;  // it has a table of its own
            if (std::ranges::none_of(all, [&](const ClimbRecord* m) { return m->text == climbed.text; }))
                all.push_back(&climbed);
        }
    return all;
}

json chart_of(const LadderRecord& ladder, double limit) {
    std::vector<std::string> rungs;
    std::vector<double> judged;
    for (const Rung& rung : ladder.rungs) {
        if (!rung.unjudged.empty()) continue;
        judged.push_back(rung.value);
        rungs.push_back(rung_value(rung.value));
    }
    std::vector<std::string> styles;  // methods by name; a textbook form has its method's style
    for (const ClimbRecord& climbed : ladder.methods)
        if (!is_textbook_twin(ladder, climbed)) styles.push_back(climbed.name);
    std::vector<RungSeries> series;
    std::size_t own = 0;
    for (const ClimbRecord& climbed : ladder.methods) {
        RungSeries s;
        s.label  = label_of(climbed);
        s.dashed = is_textbook_twin(ladder, climbed);
        s.style  = s.dashed ? std::size_t(std::ranges::find(styles, climbed.name) - styles.begin()) : own++;
        for (const RungOutcomeRecord& rung : climbed.rungs) s.shares.push_back(rung.interior_share);
        if (climbed.breaks_at) s.breaks_at = std::ranges::find(judged, *climbed.breaks_at) - judged.begin();
        series.push_back(std::move(s));
    }
    return rung_chart(rungs, series, limit);
}

json break_view(const LadderRecord& ladder, const ClimbRecord& climbed, const BreakRecord& shown) {
    const auto picture = [&](const std::string& file, const std::string& what, const std::string& alt) {
        return json{{"src", url(fs::path("breaks") / file)},
                    {"alt", alt},
                    {"what", what},
                    {"width", std::to_string(shown.width)},
                    {"height", std::to_string(shown.height)}};
    };
    const std::string label = label_of(climbed);
    json points             = json::array();
    for (const ExplainedPointRecord& point : shown.explained)
        if (point.pixel.size() == 2)
            points.push_back(why_point(point, {url(fs::path("breaks") / shown.classes),
                                               label,
                                               shown.reference,
                                               {.width = shown.width, .height = shown.height}}));
    return {{"label", label},
            {"why", std::move(points)},
            {"at", climbed.breaks_at ? fmt::format("{} {}", rung_value(*climbed.breaks_at), ladder.unit) : ""},
            {"kind", climbed.kind.value_or("")},
            {"interior", count(double(shown.interior))},
            {"points", count(double(shown.points))},
            {"triangles", count(double(shown.triangles))},
            {"before", count(double(shown.triangles_before))},
            {"href", url(fs::path("breaks") / shown.scene)},
            {"command", fmt::format("umbra compare breaks/{} --methods {} -o again", shown.scene, climbed.text)},
            {"pictures",
             {picture(shown.truth, "reference", fmt::format("S of {}, computed by the reference", shown.light)),
              picture(shown.visibility, "method", fmt::format("S of {}, computed by {}", shown.light, label)),
              picture(shown.classes, "errors", "Classes of the wrong points")}}};
}

/// Breaks that show a property of their method, and the property. These sentences do not come from the run: they are
/// shown only where the run has that break.
struct Telling {
    const char *ladder, *method, *sees;
};
constexpr Telling kTelling[] = {
    {"beside_edges", "ray_traced",
     "Rays that pass an edge or a corner within the rounding error of the ray-triangle test slip between the two "
     "triangles that share it: light leaks through a closed sheet."},
    {"needles", "shadow_zbuffer",
     "The occluders are thinner than a texel of the map: their shadow breaks into pieces, and the thinnest occluders "
     "are hit by chance only."},
    {"growing_light", "shadow_volumes",
     "The light grows, and the method treats it as a point at its centre: it draws an umbra with a sharp edge where "
     "the reference has a wide penumbra."},
};

json ladder_view(const LadderRecord& ladder, double limit) {
    json view      = {{"name", ladder.name}, {"title", ladder.title}, {"about", ladder.about},
                      {"unit", ladder.unit}, {"rows", json::array()}, {"breaks", json::array()}};
    const bool sum = ladder.methods.size() == 1 && ladder.methods[0].name == "sum";
    view["chart"]  = sum ? json(false) : chart_of(ladder, limit);
    if (!sum) view["chart"]["unit_words"] = ladder.unit;
    view["rungs"] = json::array();
    std::string truth;
    for (const Rung& rung : ladder.rungs) {
        if (truth.find(rung.truth) == std::string::npos) truth += (truth.empty() ? "" : ", then ") + rung.truth;
        if (!sum)
            view["rungs"].push_back({{"value", rung_value(rung.value)},
                                     {"lit", count(double(rung.can_show.lit))},
                                     {"shadow", count(double(rung.can_show.shadow))},
                                     {"unjudged", rung.unjudged}});
    }
    view["truth"] = truth;
    for (const ClimbRecord& climbed : ladder.methods) {
        json row      = fared(ladder, climbed);
        row["label"]  = label_of(climbed);
        row["key"]    = sum ? "" : view["chart"]["lines"][view["rows"].size()]["key"].get<std::string>();
        row["colour"] = sum ? "" : view["chart"]["lines"][view["rows"].size()]["colour"].get<std::string>();
        view["rows"].push_back(std::move(row));
        if (climbed.shown && !is_textbook_twin(ladder, climbed))
            view["breaks"].push_back(break_view(ladder, climbed, *climbed.shown));
    }
    return view;
}

}  // namespace

json ladder_table_view(const LaddersRecord& record, const std::string& page) {
    const std::vector<const ClimbRecord*> methods = methods_of(record);
    json view                                     = {{"columns", json::array()}, {"rows", json::array()}};
    for (const ClimbRecord* column : methods) view["columns"].push_back(label_of(*column));
    for (const LadderRecord& ladder : record.ladders) {
        json row          = {{"title", ladder.title},
                             {"unit", ladder.unit},
                             {"href", page + "#" + ladder.name},
                             {"cells", json::array()}};
        std::string range = "not judged";
        std::optional<double> first, last;
        for (const Rung& rung : ladder.rungs)
            if (rung.unjudged.empty()) {
                last  = rung.value;
                first = first.value_or(rung.value);
            }
        if (first) range = fmt::format("{} to {}", rung_value(*first), rung_value(*last));
        row["range"] = range;
        for (const ClimbRecord* column : methods) {
            json cell = {{"absent", true}};
            for (const ClimbRecord& climbed : ladder.methods)
                if (climbed.text == column->text) cell = fared(ladder, climbed);
            row["cells"].push_back(std::move(cell));
        }
        view["rows"].push_back(std::move(row));
    }
    return view;
}

json ladder_showcase_view(const LaddersRecord& record, const std::string& page) {
    json all = json::array();
    for (const Telling& telling : kTelling)
        for (const LadderRecord& ladder : record.ladders)
            for (const ClimbRecord& climbed : ladder.methods) {
                if (ladder.name != telling.ladder || climbed.text != telling.method || !climbed.shown) continue;
                json view         = break_view(ladder, climbed, *climbed.shown);
                const auto folder = fs::path(page).parent_path();
                for (json& picture : view["pictures"])
                    picture["src"] = url(folder / "") + picture["src"].get<std::string>();
                view["sees"]  = telling.sees;
                view["title"] = ladder.title;
                view["href"]  = page + "#" + telling.ladder;
                all.push_back(std::move(view));
            }
    return all;
}

void write_ladder_page(const LaddersRecord& record, const fs::path& folder, const std::string& report,
                       StagedFiles& staged) {
    const double limit      = record.breaking_share.value_or(0);
    json view               = {{"report", report},
                               {"table", ladder_table_view(record, "")},
                               {"textbook", textbook_view(record, "")},
                               {"run", run_view(record.head, record.machine)},
                               {"share", fmt::format("{:g}", 100 * limit)},
                               {"least", count(double(kLeastOfAKind))},
                               {"least_share", fmt::format("{:g}", 100 * kLeastShareOfAKind)},
                               {"legend", class_legend()},
                               {"ladders", json::array()}};
    view["textbook_breaks"] = json::array();
    int broken              = 0;
    for (const LadderRecord& ladder : record.ladders) {
        view["ladders"].push_back(ladder_view(ladder, limit));
        for (const ClimbRecord& climbed : ladder.methods) {
            const bool textbook = is_textbook_twin(ladder, climbed);
            if (!textbook) broken += climbed.breaks_at.has_value();
            if (!textbook || !climbed.shown) continue;
            json one      = break_view(ladder, climbed, *climbed.shown);
            one["title"]  = ladder.title;
            one["anchor"] = fmt::format("#{}", ladder.name);
            view["textbook_breaks"].push_back(std::move(one));
        }
    }
    view["failures"]     = listed_failures(record.failed);
    view["ladder_count"] = counted(double(record.ladders.size()), "ladder");
    view["break_count"]  = counted(broken, "break");

    write_page(folder, assets::ladders_html, {"Stability: where each method breaks", {"pictures.js"}}, std::move(view),
               staged);
}

void write_ladder_page(const fs::path& folder) {
    StagedFiles staged;
    write_ladder_page(read_ladders(folder / "results.json"), folder, "", staged);
    staged.commit();
}

}  // namespace umbra
