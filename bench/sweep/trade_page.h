// "The trade": the page of what `umbra sweep` wrote, error against frame cost, from the results.json files alone.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "umbra/bench/base/staged_files.h"

namespace umbra {

/// What was found on one scene: a line for the report's first page.
struct TradeLine {
    std::string scene, anchor, finding;
};

/// Writes folder/index.html and its style from the results.json of each swept scene, in this order. `report` is the
/// address of the report's first page seen from `folder`; empty where there is none. Of results.json files outside
/// the report's folder (outside `folder` where there is no report), `folder` gets copies to link to. Paths are
/// absolute. Throws InputError naming the file and the position in it.
std::vector<TradeLine> write_trade_page(const std::vector<std::filesystem::path>& results_json,
                                        const std::filesystem::path& folder, const std::string& report,
                                        StagedFiles& staged);

}  // namespace umbra
