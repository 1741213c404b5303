#include "umbra/bench/cli/bias_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/record/field.h"
#include "umbra/bench/run/chosen.h"
#include "umbra/bench/studies/bias/bias_record.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

/// Counts over the grid, a row a slope.
std::vector<BiasSliceRecord> slice_records(const BiasStudy& study, const BiasGrid& grid) {
    std::vector<BiasSliceRecord> slices;
    auto cell = study.cells.begin();
    for (const double offset : grid.normal_offsets) {
        BiasSliceRecord& slice = slices.emplace_back(BiasSliceRecord{offset});
        for (std::size_t row = 0; row < grid.slopes.size(); ++row) {
            std::vector<BiasErrors>& errors = slice.rows.emplace_back();
            for (std::size_t column = 0; column < grid.constants.size(); ++column) errors.push_back((cell++)->errors);
        }
    }
    return slices;
}

BiasSceneRecord study_record(const BiasStudy& study, const BiasGrid& grid) {
    return {.scene                          = study.name,
            .title                          = study.title,
            .lights                         = study.lights,
            .points                         = study.points,
            .automatic                      = study.automatic,
            .receiver_plane                 = study.receiver_plane,
            .best_manual                    = best_cell(study),
            .settings                       = study.cells.size(),
            .settings_better_than_automatic = better_cells(study),
            .slices                         = slice_records(study, grid)};
}

}  // namespace

BiasRecord study_biases(const std::vector<std::filesystem::path>& files, const BiasOptions& options,
                        std::vector<std::string>& failed) {
    const BiasGrid grid = default_bias_grid();
    check_bias_map(options.map, grid);
    BiasRecord record{
        .head    = head_record(options.command),
        .machine = machine_record(options.threads),
        .size    = {static_cast<std::uint64_t>(options.size.width), static_cast<std::uint64_t>(options.size.height)},
        .map     = options.map,
        .grid    = grid};
    std::vector<BiasStudy> studies;
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
            record.failed.push_back({.scene = name, .method = "the study", .failure = {.message = current_message()}});
        }
    }
    if (studies.empty()) return record;
    if (studies.size() > 1) studies.insert(studies.begin(), add_up(studies));
    for (const BiasStudy& study : studies) record.bias.push_back(study_record(study, grid));

    StagedFiles staged;
    write_study_files(bias_report(record), record, options.out, staged);
    staged.commit();
    return record;
}

}  // namespace umbra
