#include "umbra/bench/ladders/ladder_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "report_assets.h"
#include "umbra/bench/ladders/interior_points.h"
#include "umbra/bench/ladders/ladder_cells.h"
#include "umbra/bench/ladders/textbook_view.h"
#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/pages/failures.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The methods of all ladders, as typed, in the order in which they first appear; the sum is not one of them.
std::vector<Field> methods_of(const Field& root) {
    std::vector<Field> all;
    for (const Field& ladder : root["ladders"].items())
        for (const Field& method : ladder["methods"].items()) {
            const std::string text = method["text"].required_text();
            if (is_textbook_twin(ladder, method)) continue;  // it has a table of its own
            if (std::none_of(all.begin(), all.end(), [&](const Field& m) { return m["text"].text() == text; }))
                all.push_back(method);
        }
    return all;
}

json chart_of(const Field& ladder, double limit) {
    std::vector<std::string> rungs;
    std::vector<double> judged;
    for (const Field& rung : ladder["rungs"].items()) {
        if (rung["unjudged"].present()) continue;
        judged.push_back(rung["value"].number().value_or(0));
        rungs.push_back(rung_value(judged.back()));
    }
    std::vector<std::string> styles;  // methods by name; a textbook form has its method's style
    for (const Field& method : ladder["methods"].items())
        if (!is_textbook_twin(ladder, method)) styles.push_back(method["name"].text());
    std::vector<RungSeries> series;
    std::size_t own = 0;
    for (const Field& method : ladder["methods"].items()) {
        RungSeries s;
        s.label  = label_of(method);
        s.dashed = is_textbook_twin(ladder, method);
        s.style  = s.dashed
                       ? std::size_t(std::find(styles.begin(), styles.end(), method["name"].text()) - styles.begin())
                       : own++;
        for (const Field& rung : method["rungs"].items()) s.shares.push_back(rung["interior_share"].number());
        if (rung_of(ladder, method["breaks_at"]))
            s.breaks_at = std::find(judged.begin(), judged.end(), *method["breaks_at"].number()) - judged.begin();
        series.push_back(std::move(s));
    }
    return rung_chart(rungs, series, limit);
}

json break_view(const Field& ladder, const Field& method) {
    const Field b          = method["break"];
    const std::string name = b["scene"].required_text();
    const auto picture     = [&](const char* key, const std::string& what, const std::string& alt) {
        return json{{"src", url(fs::path("breaks") / b[key].required_text())},
                    {"alt", alt},
                    {"what", what},
                    {"width", fmt::format("{:g}", b["width"].number().value_or(0))},
                    {"height", fmt::format("{:g}", b["height"].number().value_or(0))}};
    };
    const std::string label = label_of(method);
    return {{"label", label},
            {"at", fmt::format("{} {}", rung_value(*method["breaks_at"].number()), ladder["unit"].text())},
            {"kind", method["kind"].text()},
            {"interior", count(b["interior"].number())},
            {"points", count(b["points"].number())},
            {"triangles", count(b["triangles"].number())},
            {"before", count(b["triangles_before"].number())},
            {"href", url(fs::path("breaks") / name)},
            {"command", fmt::format("umbra compare breaks/{} --methods {} -o again", name, method["text"].text())},
            {"pictures",
             {picture("truth", "reference", fmt::format("S of {}, computed by the reference", b["light"].text())),
              picture("visibility", "method", fmt::format("S of {}, computed by {}", b["light"].text(), label)),
              picture("classes", "errors", "Classes of the wrong points")}}};
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

json ladder_view(const Field& ladder, double limit) {
    json view      = {{"name", ladder["name"].required_text()},
                      {"title", ladder["title"].required_text()},
                      {"about", ladder["about"].text()},
                      {"unit", ladder["unit"].text()},
                      {"rows", json::array()},
                      {"breaks", json::array()}};
    const bool sum = ladder["methods"].items().size() == 1 && ladder["methods"].items()[0]["name"].text() == "sum";
    view["chart"]  = sum ? json(false) : chart_of(ladder, limit);
    if (!sum) view["chart"]["unit_words"] = ladder["unit"].text();
    view["rungs"] = json::array();
    std::string truth;
    for (const Field& rung : ladder["rungs"].items()) {
        if (const std::string by = rung["truth"].text(); truth.find(by) == std::string::npos)
            truth += (truth.empty() ? "" : ", then ") + by;
        if (!sum)
            view["rungs"].push_back({{"value", rung_value(rung["value"].number().value_or(0))},
                                     {"lit", count(rung["interior_lit"].number())},
                                     {"shadow", count(rung["interior_shadow"].number())},
                                     {"unjudged", rung["unjudged"].text()}});
    }
    view["truth"]     = truth;
    view["has_rungs"] = !view["rungs"].empty();
    for (const Field& method : ladder["methods"].items()) {
        json row      = fared(ladder, method);
        row["label"]  = label_of(method);
        row["key"]    = sum ? "" : view["chart"]["lines"][view["rows"].size()]["key"].get<std::string>();
        row["colour"] = sum ? "" : view["chart"]["lines"][view["rows"].size()]["colour"].get<std::string>();
        view["rows"].push_back(std::move(row));
        if (method["break"].present() && !is_textbook_twin(ladder, method))
            view["breaks"].push_back(break_view(ladder, method));
    }
    return view;
}

}  // namespace

json ladder_table_view(const Field& root, const std::string& page) {
    const std::vector<Field> methods = methods_of(root);
    json view                        = {{"columns", json::array()}, {"rows", json::array()}};
    for (const Field& method : methods) view["columns"].push_back(label_of(method));
    for (const Field& ladder : root["ladders"].items()) {
        json row          = {{"title", ladder["title"].required_text()},
                             {"unit", ladder["unit"].text()},
                             {"href", page + "#" + ladder["name"].required_text()},
                             {"cells", json::array()}};
        std::string range = "not judged";
        std::optional<double> first, last;
        for (const Field& rung : ladder["rungs"].items())
            if (!rung["unjudged"].present()) {
                last  = rung["value"].number().value_or(0);
                first = first.value_or(*last);
            }
        if (first) range = fmt::format("{} to {}", rung_value(*first), rung_value(*last));
        row["range"] = range;
        for (const Field& column : methods) {
            json cell = {{"absent", true}};
            for (const Field& method : ladder["methods"].items())
                if (method["text"].text() == column["text"].text()) cell = fared(ladder, method);
            row["cells"].push_back(std::move(cell));
        }
        view["rows"].push_back(std::move(row));
    }
    return view;
}

json ladder_showcase_view(const Field& root, const std::string& page) {
    json all = json::array();
    for (const Telling& telling : kTelling)
        for (const Field& ladder : root["ladders"].items())
            for (const Field& method : ladder["methods"].items()) {
                if (ladder["name"].text() != telling.ladder || method["text"].text() != telling.method ||
                    !method["break"].present())
                    continue;
                json view         = break_view(ladder, method);
                const auto folder = fs::path(page).parent_path();
                for (json& picture : view["pictures"])
                    picture["src"] = url(folder / "") + picture["src"].get<std::string>();
                view["sees"]  = telling.sees;
                view["title"] = ladder["title"].text();
                view["href"]  = page + "#" + telling.ladder;
                all.push_back(std::move(view));
            }
    return all;
}

void write_ladder_page(const Field& root, const fs::path& folder, const std::string& report, StagedFiles& staged) {
    const double limit      = root["breaking_share"].number().value_or(0);
    json view               = {{"report", report},
                               {"table", ladder_table_view(root, "")},
                               {"textbook", textbook_view(root, "")},
                               {"run", run_view(root)},
                               {"share", fmt::format("{:g}", 100 * limit)},
                               {"least", count(double(kLeastOfAKind))},
                               {"least_share", fmt::format("{:g}", 100 * kLeastShareOfAKind)},
                               {"legend", class_legend()},
                               {"ladders", json::array()}};
    view["textbook_breaks"] = json::array();
    int broken              = 0;
    for (const Field& ladder : root["ladders"].items()) {
        view["ladders"].push_back(ladder_view(ladder, limit));
        for (const Field& method : ladder["methods"].items()) {
            const bool textbook = is_textbook_twin(ladder, method);
            if (!textbook) broken += method["breaks_at"].present();
            if (!textbook || !method["break"].present()) continue;
            json one      = break_view(ladder, method);
            one["title"]  = ladder["title"].text();
            one["anchor"] = fmt::format("#{}", ladder["name"].text());
            view["textbook_breaks"].push_back(std::move(one));
        }
    }
    view["failures"]     = listed_failures(root);
    view["has_failures"] = !view["failures"].empty();
    view["ladder_count"] = counted(double(root["ladders"].items().size()), "ladder");
    view["break_count"]  = counted(broken, "break");

    const PageHead head = {"Stability: where each method breaks", "", {"pictures.js"}};
    staged.write(folder / "index.html", render_page(assets::ladders_html, head, std::move(view)));
    write_page_assets(folder, head.scripts, staged);
}

void write_ladder_page(const fs::path& folder) {
    StagedFiles staged;
    write_ladder_page(read_results(folder / "results.json"), folder, "", staged);
    staged.commit();
}

}  // namespace umbra
