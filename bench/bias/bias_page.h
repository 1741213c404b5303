// The page of a bias study: a heat map per scene, and the errors of notable settings.
#pragma once

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// OUT/index.html and its style, from the record of `umbra bias` alone.
void write_bias_page(const Json& record, const std::filesystem::path& out, StagedFiles& staged);

}  // namespace umbra
