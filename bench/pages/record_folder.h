// A folder of pictures with their results.json and the page that shows both.
#pragma once

#include <filesystem>
#include <functional>

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// Writes the folder `out` whole or not at all: `make` writes pictures into the folder that it is given and returns the
/// record, which becomes results.json; `add_page` writes the page of the record into the same folder. Returns the
/// record. Throws InputError, and what the two throw.
Json write_record_folder(
    const std::filesystem::path& out, const std::function<Json(const std::filesystem::path& folder)>& make,
    const std::function<void(const Json& record, const std::filesystem::path& folder, StagedFiles& staged)>& add_page);

}  // namespace umbra
