#include <fmt/format.h>

#include <map>

#include "report_assets.h"
#include "umbra/bench/studies/shading/shading_study.h"

namespace umbra {
namespace {

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

}  // namespace

StudyReport shading_report(const ShadingRecord& record) {
    const std::string& title = record.scene.title;
    StudyReport report{.title  = "Shading: " + title,
                       .page   = assets::shading_html,
                       .tables = {{"models",
                                   "Cost, and difference from phong",
                                   {{"name", "model", kCode},
                                    {"evaluations", "sums", kCount},
                                    {"asked", "S_j asked", kCount},
                                    {"ms", "time", decimals(2), "ms"},
                                    {"rmse", "RMSE", decimals(5)},
                                    {"flip", "FLIP", decimals(5)},
                                    {"perceived", "perceived", decimals(5)},
                                    {"highlight", "highlight", decimals(3)},
                                    {"kink", "kinks", decimals(2)}},
                                   to_record(record.models)}}};
    for (const ShadingStageRecord& stage : record.stages)
        report.pictures["stages"].push_back({stage.picture, "The scene, stage " + stage.name, stage.about});
    for (std::string& finding : shading_findings(record)) report.sentences.push_back({std::move(finding)});
    report.words = {{"title", title}, {"method", record.method.value_or("none")}, {"models", Json::array()}};
    for (const ShadingModelRecord& m : record.models)
        report.words["models"].push_back(
            {{"name", m.name}, {"about", about(m.name)}, {"picture", m.picture}, {"difference", m.difference}});
    return report;
}

}  // namespace umbra
