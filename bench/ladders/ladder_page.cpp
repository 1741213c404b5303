#include "umbra/bench/ladders/ladder_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "report_assets.h"
#include "umbra/bench/ladders/interior_points.h"
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

/// A rung's value: 1, 3.2, 0.01, and beyond that 10⁻⁵ or 3.2·10⁻⁵.
std::string rung_value(double value) {
    if (value == 0 || (value >= 0.999e-3 && value < 1e4)) return fmt::format("{:g}", value);
    const std::string text   = fmt::format("{:.2e}", value);  // 3.20e-05
    const std::size_t e      = text.find('e');
    const std::string factor = fmt::format("{:g}", std::stod(text.substr(0, e)));
    return (factor == "1" ? "" : factor + "·") + "10" + superscript(std::stoi(text.substr(e + 1)));
}

/// The methods of all ladders, as typed, in the order in which they first appear; the sum is not one of them.
std::vector<Field> methods_of(const Field& root) {
    std::vector<Field> all;
    for (const Field& ladder : root["ladders"].items())
        for (const Field& method : ladder["methods"].items()) {
            const std::string text = method["text"].required_text();
            if (std::none_of(all.begin(), all.end(), [&](const Field& m) { return m["text"].text() == text; }))
                all.push_back(method);
        }
    return all;
}

/// What a method is called: its title, or as typed where it runs with other than its default settings.
std::string label_of(const Field& method) {
    return method["text"].text() == method["name"].text() ? method["title"].text() : method["text"].text();
}

std::optional<std::size_t> rung_of(const Field& ladder, const Field& value) {
    if (!value.present()) return std::nullopt;
    const auto rungs = ladder["rungs"].items();
    for (std::size_t r = 0; r < rungs.size(); ++r)
        if (rungs[r]["value"].number() == value.number()) return r;
    value.refuse("the value of a rung");
}

/// How a method fared, in three strings: the cell's main words, a note beneath them, and whether it is a break.
json fared(const Field& ladder, const Field& method) {
    const std::string unit = ladder["unit"].text();
    std::string note;
    const auto from = [&](const char* key, const char* words) {
        if (const auto r = rung_of(ladder, method[key])) {
            if (!note.empty()) note += ", ";
            note += *r == 0 ? std::string(words) : fmt::format("{} from {}", words, rung_value(*method[key].number()));
        }
    };
    from("not_served_from", "not served");
    from("silent_from", "mostly undefined");
    from("not_judged_from", "not judged");
    const bool breaks = method["breaks_at"].present();
    std::string words = breaks ? rung_value(*method["breaks_at"].number()) : note.empty() ? "holds" : "";
    return {{"words", words},   {"kind", method["kind"].text()},   {"note", note}, {"why", method["why"].text()},
            {"breaks", breaks}, {"holds", !breaks && note.empty()}};
}

json chart_of(const Field& ladder, double limit) {
    std::vector<std::string> rungs;
    std::vector<double> judged;
    for (const Field& rung : ladder["rungs"].items()) {
        if (rung["unjudged"].present()) continue;
        judged.push_back(rung["value"].number().value_or(0));
        rungs.push_back(rung_value(judged.back()));
    }
    std::vector<RungSeries> series;
    for (const Field& method : ladder["methods"].items()) {
        RungSeries s;
        s.label = label_of(method);
        for (const Field& rung : method["rungs"].items()) s.shares.push_back(rung["interior_share"].number());
        if (rung_of(ladder, method["breaks_at"]))
            s.breaks_at = std::find(judged.begin(), judged.end(), *method["breaks_at"].number()) - judged.begin();
        s.style = series.size();
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
        if (method["break"].present()) view["breaks"].push_back(break_view(ladder, method));
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
    const double limit = root["breaking_share"].number().value_or(0);
    json view          = {{"report", report},
                          {"table", ladder_table_view(root, "")},
                          {"run", run_view(root)},
                          {"share", fmt::format("{:g}", 100 * limit)},
                          {"least", count(double(kLeastOfAKind))},
                          {"least_share", fmt::format("{:g}", 100 * kLeastShareOfAKind)},
                          {"legend", class_legend()},
                          {"ladders", json::array()}};
    int broken         = 0;
    for (const Field& ladder : root["ladders"].items()) {
        view["ladders"].push_back(ladder_view(ladder, limit));
        for (const Field& method : ladder["methods"].items()) broken += method["breaks_at"].present();
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
