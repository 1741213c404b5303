// The page of the lectures: their topics in the lectures' order, with the pictures of a report.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/report/lecture_shows.h"

namespace umbra {

/// What a report has to show the topics with.
struct LectureSources {
    std::vector<std::pair<std::string, const SceneFiles*>> pages;  ///< "", of comparisons, or a study's command
    const SceneFiles* experiments = nullptr;  ///< whose results.json is an ExperimentsRecord; null: there are none
};

/// What the template lectures.html shows: each topic in the lectures' order, with the pictures of its scene where the
/// report has that comparison or that study, those of its experiment, what they prove, and what was measured: figures,
/// and values along a line beside their formula. Addresses are seen from `out`, the report's folder. False where the
/// report has no picture of any topic.
[[nodiscard]] nlohmann::json lectures_view(const LectureSources& sources, const std::filesystem::path& out,
                                           Language language);

}  // namespace umbra
