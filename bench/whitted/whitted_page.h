// The page of `umbra whitted`: the picture by depth, rays by kind, times, and what ray tracing does not see.
#pragma once

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/describe.h"
#include "umbra/bench/whitted/whitted_study.h"

namespace umbra {

/// Traces, and writes the folder `out` whole: pictures, results.json and the page. Returns the record. Throws as
/// trace_whitted.
Json write_whitted_study(const PreparedScene& prepared, const WhittedOptions& options,
                         const std::filesystem::path& out);

/// FOLDER/index.html and its style, from the record of trace_whitted alone.
void write_whitted_page(const Json& record, const std::filesystem::path& folder, StagedFiles& staged);

}  // namespace umbra
