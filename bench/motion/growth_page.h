// The page of `umbra growth`: curves, exponents beside theory, crossings.
#pragma once

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// OUT/index.html and its style, from the record of `umbra growth` alone.
void write_growth_page(const Json& record, const std::filesystem::path& out, StagedFiles& staged);

}  // namespace umbra
