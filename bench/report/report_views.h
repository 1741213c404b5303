// What the pages of a report show: the first page, a scene with its tables, the methods from outside.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "umbra/bench/pages/report_page.h"

namespace umbra {

/// Everything that index.html shows; `files` one per scene, in the same order; `out` the folder of the page.
[[nodiscard]] nlohmann::json index_view(const std::vector<ScenePage>& scenes, const std::vector<SceneFiles>& files,
                                        const std::filesystem::path& out, const std::string& title);

/// Everything that renderers.html shows; `files` one per scene, in the same order; `out` the folder of the page. False where
/// no scene has a method from outside.
[[nodiscard]] nlohmann::json renderers_view(const std::vector<ScenePage>& scenes, const std::vector<SceneFiles>& files,
                                            const std::filesystem::path& out);

/// Everything that scene.html shows, except the links to its neighbours. The index of a method in `settings` gives it
/// the same mark in the charts of all pages.
[[nodiscard]] nlohmann::json scene_view(const SceneFiles& files, const std::vector<MethodRecord>& settings);

/// Counts and errors of S: a group of rows per light. Columns that no method fills are left out.
[[nodiscard]] nlohmann::json error_view(const Results& results);

/// Where errors occur and what causes them: a group of rows per light.
[[nodiscard]] nlohmann::json cause_view(const Results& results);

/// Phases, movements and memory; by light where there are several; what all methods share.
[[nodiscard]] nlohmann::json time_view(const Results& results);

/// Requirements of the scene, and its objects with the faults of their meshes.
[[nodiscard]] nlohmann::json fact_view(const FactsRecord& facts);

/// A row for each method with its ratio to the fastest for each kind of movement: "fastest", "no difference", the ratio
/// with its interval and what that covers, or the ratio alone, of fewer than six rounds; and the noise bars behind it.
/// false where the record has no times in turns.
[[nodiscard]] nlohmann::json time_ratio_view(const Results& results);

}  // namespace umbra
