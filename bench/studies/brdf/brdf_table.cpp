#include "umbra/bench/studies/brdf/brdf_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "umbra/core/render/brdf.h"

namespace umbra {
namespace {

constexpr double kRounding = 1e-9;  ///< measure_brdf leaves 1e-12
constexpr double kGrid     = 5e-3;  ///< by which midpoints of 16 steps may miss an energy of 1

Json form_json(const char* form, const BrdfFigures& f) {
    return {{"form", form},
            {"largest", number(f.largest)},
            {"reciprocity", number(f.reciprocity)},
            {"anisotropy", number(f.anisotropy)},
            {"energy", number(f.energy)},
            {"without_cosine", number(f.without_cosine)}};
}

bool above(const Json& value, double limit) { return value.is_null() || value.get<double>() > limit; }

std::string verdict_of(const Json& form) {
    std::vector<std::string> breaks;
    if (above(form["reciprocity"], kRounding)) breaks.emplace_back("reciprocity");
    if (above(form["energy"], 1 + kGrid)) breaks.emplace_back("energy");
    std::string text = breaks.empty() ? "physical" : fmt::format("breaks {}", fmt::join(breaks, ", "));
    if (above(form["anisotropy"], kRounding)) text += "; anisotropic";
    return text;
}

}  // namespace

Json measure_materials(const Scene& scene, int steps, const std::string& command) {
    Json record = {{"schema", kResultsSchema},   {"version", version()}, {"command", command},
                   {"scene", scene_json(scene)}, {"steps", steps},       {"materials", Json::array()}};
    for (const Material& m : scene.materials)
        record["materials"].push_back({{"name", m.name},
                                       {"forms",
                                        {form_json("sum", measure_brdf(brdf_of_sum(m), steps)),
                                         form_json("with_cosine", measure_brdf(brdf_with_cosine(m), steps))}}});
    return record;
}

StudyReport brdf_report(const Json& record) {
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
    for (const Json& material : record["materials"])
        for (Json form : material["forms"]) {
            form["material"] = material["name"], form["verdict"] = verdict_of(form);
            table.rows.push_back(std::move(form));
        }
    return {.title  = "Reflectance: " + record["scene"]["title"].get<std::string>(),
            .page   = {},
            .tables = {std::move(table)}};
}

}  // namespace umbra
