// The page of `umbra growth`: curves, exponents beside theory, crossings.
#pragma once

#include "umbra/bench/motion/growth_record.h"
#include "umbra/bench/out/staged_files.h"

namespace umbra {

/// OUT/index.html and its style, from the record of `umbra growth` alone.
void write_growth_page(const GrowthRecord& record, const std::filesystem::path& out, StagedFiles& staged);

}  // namespace umbra
