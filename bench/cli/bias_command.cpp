#include "umbra/bench/cli/bias_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/record/field.h"
#include "umbra/bench/run/chosen.h"
#include "umbra/bench/studies/bias/bias_report.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

Json errors_json(const BiasErrors& e) {
    return {{"false_shadow", {{"interior", e.false_shadow.interior}, {"edge", e.false_shadow.edge}}},
            {"false_light", {{"interior", e.false_light.interior}, {"edge", e.false_light.edge}}}};
}

/// Counts of a kind over the grid, a row a slope.
Json slices_json(const BiasStudy& study, const BiasGrid& grid) {
    Json slices = Json::array();
    auto cell   = study.cells.begin();
    for (double offset : grid.normal_offsets) {
        Json slice = {{"normal_offset", offset}, {"rows", Json::array()}};
        for (std::size_t row = 0; row < grid.slopes.size(); ++row) {
            slice["rows"].push_back(Json::array());
            for (std::size_t column = 0; column < grid.constants.size(); ++column)
                slice["rows"].back().push_back(errors_json((cell++)->errors));
        }
        slices.push_back(std::move(slice));
    }
    return slices;
}

Json study_json(const BiasStudy& study, const BiasGrid& grid) {
    const BiasCell& best  = best_cell(study);
    Json best_json        = errors_json(best.errors);
    best_json["constant"] = best.constant, best_json["slope"] = best.slope;
    best_json["normal_offset"] = best.normal_offset;
    return {{"scene", study.name},
            {"title", study.title},
            {"lights", study.lights},
            {"points", study.points},
            {"automatic", errors_json(study.automatic)},
            {"receiver_plane", errors_json(study.receiver_plane)},
            {"best_manual", std::move(best_json)},
            {"settings", study.cells.size()},
            {"settings_better_than_automatic", better_cells(study)},
            {"slices", slices_json(study, grid)}};
}

}  // namespace

Json study_biases(const std::vector<std::filesystem::path>& files, const BiasOptions& options,
                  std::vector<std::string>& failed) {
    const BiasGrid grid = default_bias_grid();
    check_bias_map(options.map, grid);
    std::vector<BiasStudy> studies;
    Json failures = Json::array();
    for (const auto& [file, name, folder] : chosen_scenes(files)) {
        try {
            PreparedScene prepared = prepare_scene(file, options.size);
            prepared.scene.name    = name;
            BiasStudy study        = study_bias(std::move(prepared), options.map, grid, options.progress);
            if (study.points > 0)
                studies.push_back(std::move(study));
            else
                failed.push_back(fmt::format("{}: no point is judged: no lit surface is in view", file.string()));
        } catch (const InputError& e) {
            failed.emplace_back(e.what());
        } catch (...) {
            failures.push_back({{"scene", name}, {"method", "the study"}, {"message", current_message()}});
        }
    }
    Json record = to_record(head_record(options.command));
    record.update({{"machine", to_record(machine_record(options.threads))},
                   {"size", {{"width", options.size.width}, {"height", options.size.height}}},
                   {"map", options.map},
                   {"constants", grid.constants},
                   {"slopes", grid.slopes},
                   {"normal_offsets", grid.normal_offsets},
                   {"bias", Json::array()},
                   {"failed", std::move(failures)}});
    if (studies.empty()) return record;
    if (studies.size() > 1) studies.insert(studies.begin(), add_up(studies));
    for (const BiasStudy& study : studies) record["bias"].push_back(study_json(study, grid));

    StagedFiles staged;
    write_study_files(bias_report(record), record, options.out, staged);
    staged.commit();
    return record;
}

}  // namespace umbra
