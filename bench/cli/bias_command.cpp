#include "umbra/bench/cli/bias_command.h"

#include <fmt/format.h>

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/record/field.h"
#include "umbra/bench/run/chosen.h"
#include "umbra/bench/studies/bias/bias_study.h"
#include "umbra/core/base/error.h"

namespace umbra {

BiasRecord study_biases(const std::vector<std::filesystem::path>& files, const BiasOptions& options,
                        std::vector<std::string>& failed) {
    check_bias_map(options.map);
    BiasRecord record{
        .head    = head_record(options.command),
        .machine = machine_record(options.threads),
        .size    = {static_cast<std::uint64_t>(options.size.width), static_cast<std::uint64_t>(options.size.height)},
        .map     = options.map,
        .grid    = bias_grid()};
    for (const auto& [file, name, folder] : chosen_scenes(files)) {
        try {
            PreparedScene prepared = prepare_scene(file, options.size);
            prepared.scene.name    = name;
            BiasSceneRecord study  = study_bias(std::move(prepared), options.map, options.progress);
            if (study.points > 0)
                record.bias.push_back(std::move(study));
            else
                failed.push_back(fmt::format("{}: no point is judged: no lit surface is in view", file.string()));
        } catch (const InputError& e) {
            failed.emplace_back(e.what());
        } catch (...) {
            record.failed.push_back({.scene = name, .method = "the study", .failure = {.message = current_message()}});
        }
    }
    if (record.bias.empty()) return record;
    if (record.bias.size() > 1) record.bias.insert(record.bias.begin(), add_up(record.bias));

    StagedFiles staged;
    write_study_files(bias_report(record), record, options.out, staged);
    staged.commit();
    return record;
}

}  // namespace umbra
