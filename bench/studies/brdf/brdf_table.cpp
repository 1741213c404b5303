#include "umbra/bench/studies/brdf/brdf_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace umbra {
namespace {

constexpr double kRounding = 1e-9;  ///< measure_brdf leaves 1e-12
constexpr double kGrid     = 5e-3;  ///< by which midpoints of 16 steps may miss an energy of 1

/// What is not finite is above every limit.
bool above(double value, double limit) { return !(value <= limit); }

std::string verdict_of(const BrdfFigures& figures) {
    std::vector<std::string> breaks;
    if (above(figures.reciprocity, kRounding)) breaks.emplace_back("reciprocity");
    if (above(figures.energy, 1 + kGrid)) breaks.emplace_back("energy");
    std::string text = breaks.empty() ? "physical" : fmt::format("breaks {}", fmt::join(breaks, ", "));
    if (above(figures.anisotropy, kRounding)) text += "; anisotropic";
    return text;
}

}  // namespace

BrdfRecord measure_materials(const Scene& scene, int steps, const std::string& command) {
    BrdfRecord record{head_record(command), scene_record(scene), steps, {}};
    for (const Material& m : scene.materials)
        record.materials.push_back({m.name,
                                    {{"sum", measure_brdf(brdf_of_sum(m), steps)},
                                     {"with_cosine", measure_brdf(brdf_with_cosine(m), steps)}}});
    return record;
}

StudyReport brdf_report(const BrdfRecord& record) {
    StudyTable table{.name    = "materials",
                     .caption = "Reflectance functions",
                     .columns = {{"material", "material"},
                                 {"form", "form"},
                                 {"largest", "largest", kSignificant},
                                 {"reciprocity", "reciprocity", kSignificant},
                                 {"anisotropy", "anisotropy", kSignificant},
                                 {"energy", "energy", decimals(4)},
                                 {"without_cosine", "without cosine", decimals(4)},
                                 {"verdict", "verdict"}},
                     .rows    = Json::array()};
    for (const MaterialFormsRecord& material : record.materials)
        for (const BrdfFormRecord& form : material.forms) {
            Json row        = to_record(form);
            row["material"] = material.name, row["verdict"] = verdict_of(form.figures);
            table.rows.push_back(std::move(row));
        }
    return {.title = "Reflectance: " + record.scene.title, .page = {}, .tables = {std::move(table)}};
}

}  // namespace umbra
