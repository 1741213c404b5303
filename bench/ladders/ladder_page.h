// The page of what `umbra ladder` wrote, from its results.json and the pictures beside it only.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/ladders/ladder_record.h"

namespace umbra {

/// Writes folder/index.html with its style and script, from folder/results.json. Throws InputError naming the file
/// and the position in it.
void write_ladder_page(const std::filesystem::path& folder);

/// The same from a record that was read already, as a part of a report: `report` is the address of its first page, seen
/// from `folder`; empty where there is none. Replaces files that are staged already.
void write_ladder_page(const LaddersRecord& record, const std::filesystem::path& folder, const std::string& report,
                       StagedFiles& staged);

/// The table of ladders by methods for a template (ladder_table.html); links lead to `page`, the address
/// of the ladders' page seen from the one that shows the table.
[[nodiscard]] nlohmann::json ladder_table_view(const LaddersRecord& record, const std::string& page);

/// Up to three instructive breaks, each with its pictures and an explanation. Addresses as above.
[[nodiscard]] nlohmann::json ladder_showcase_view(const LaddersRecord& record, const std::string& page);

}  // namespace umbra
