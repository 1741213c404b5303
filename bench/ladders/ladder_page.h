// The page over what `umbra ladder` wrote, made from its results.json and the pictures beside it, and nothing else.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "umbra/bench/run/results_file.h"

namespace umbra {

/// Writes folder/index.html, report.css and report.js. Throws InputError naming file and place.
void write_ladder_page(const std::filesystem::path& folder);

/// The table of ladders by methods for a template (bench/report/ladder_table.html); links lead to `page`, the address
/// of the ladders' page seen from the one that shows the table.
[[nodiscard]] nlohmann::json ladder_table_view(const Field& root, const std::string& page);

/// Three breaks worth seeing, of those that there are: each with its pictures and what one sees. Addresses as above.
[[nodiscard]] nlohmann::json ladder_showcase_view(const Field& root, const std::string& page);

}  // namespace umbra
