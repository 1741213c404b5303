// The page of `umbra whitted`: the picture by depth, rays by kind, times, and what ray tracing does not see.
#pragma once

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// FOLDER/index.html and its style, from the record of trace_whitted alone.
void write_whitted_page(const Json& record, const std::filesystem::path& folder, StagedFiles& staged);

}  // namespace umbra
