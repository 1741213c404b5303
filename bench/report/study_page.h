// Folders that `umbra shading`, `umbra whitted` and `umbra radiosity` wrote, as parts of a report.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "umbra/bench/pages/report_page.h"

namespace umbra {

struct StudyPage {
    std::string command;  ///< "shading", "whitted" or "radiosity"
    ScenePage scene;      ///< its results, pictures and page
};

/// Nothing where the results.json is of another command. Throws InputError.
[[nodiscard]] std::optional<StudyPage> read_study(const Field& root, const std::filesystem::path& file);

/// Where the study lies outside of the report's folder `out`, its files are copied to out/COMMAND-SCENE.
void take_study(StudyPage& study, const std::filesystem::path& out, StagedFiles& staged);

}  // namespace umbra
