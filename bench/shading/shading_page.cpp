#include "umbra/bench/shading/shading_page.h"

#include <fmt/format.h>

#include <map>

#include "report_assets.h"
#include "umbra/bench/pages/page_template.h"
#include "umbra/bench/pages/record_folder.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

/// What a model is, for readers.
std::string about(const std::string& model) {
    static const std::map<std::string, std::string> sentences{
        {"constant", "One value a triangle, from the cosine to the view direction alone: no lights, no shadows."},
        {"flat", "The sum at the centre of each triangle, with its face normal. S_j is that of the centre."},
        {"gouraud", "The sum at vertices, interpolated. S_j is asked at vertices alone (Gouraud 1971)."},
        {"gouraud_screen", "The same, interpolated linearly in the picture, as rasterizers without division do."},
        {"every_second", "The sum at every second pixel of a row, the mean of its neighbours between."},
        {"highlight_test",
         "N.L interpolated between corners; highlights only on triangles that may have one (Bergman et al. 1986; "
         "Harrison et al. 1988)."},
        {"taylor", "Angles from a polynomial of second degree a triangle (Bishop and Weimer 1986)."},
        {"differences",
         "Directions of the triangle's middle, angles by additions along rows (Duff 1979): exact for suns seen from "
         "infinity."},
        {"phong", "Normals interpolated, the sum at each pixel (Phong 1975): what the others are compared with."},
        {"quadratic", "Normals interpolated quadratically (van Overveld and Wyvill 1997)."}};
    const auto found = sentences.find(model);
    return found == sentences.end() ? "" : found->second;
}

std::string figure(const Json& value, const char* format) {
    return value.is_null() ? "–" : fmt::format(fmt::runtime(format), value.get<double>());
}

}  // namespace

void write_shading_page(const Json& record, const std::filesystem::path& folder, StagedFiles& staged) {
    json models = json::array();
    for (const Json& m : record["models"])
        models.push_back({{"name", m["name"]},
                          {"about", about(m["name"].get<std::string>())},
                          {"evaluations", count(m["evaluations"].get<double>())},
                          {"asked", count(m["asked"].get<double>())},
                          {"ms", figure(m["ms"], "{:.1f}")},
                          {"rmse", figure(m["rmse"], "{:.5f}")},
                          {"flip", figure(m["flip"], "{:.4f}")},
                          {"perceived", figure(m["perceived"], "{:.5f}")},
                          {"highlight", figure(m["highlight"], "{:.2f}")},
                          {"kink", figure(m["kink"], "{:.2f}")},
                          {"picture", m["picture"]},
                          {"difference", m["difference"]}});
    json stages = json::array();
    for (const Json& s : record["stages"])
        stages.push_back({{"name", s["name"]}, {"about", s["about"]}, {"picture", s["picture"]}});
    json findings = json::array();
    for (std::string& finding : shading_findings(record)) findings.push_back({{"text", std::move(finding)}});
    const json view     = {{"title", record["scene"]["title"]},
                           {"command", without_folders(record["command"].get<std::string>())},
                           {"version", record["version"]},
                           {"method", record["method"].is_null() ? "none" : record["method"].get<std::string>()},
                           {"models", std::move(models)},
                           {"findings", std::move(findings)},
                           {"stages", std::move(stages)}};
    const PageHead head = {fmt::format("Shading: {}", record["scene"]["title"].get<std::string>()), "", {}};
    staged.write(folder / "index.html", render_page(assets::shading_html, head, view));
    write_page_assets(folder, head.scripts, staged);
}

Json write_shading_study(const PreparedScene& prepared, const ShadingOptions& options,
                         const std::filesystem::path& out) {
    return write_record_folder(
        out, [&](const std::filesystem::path& folder) { return compare_shading(prepared, options, folder); },
        write_shading_page);
}

}  // namespace umbra
