// The page of `umbra motion`: winners over the triangle of mixes, times against the model, break-even points.
#pragma once

#include "umbra/bench/motion/motion_record.h"
#include "umbra/bench/out/staged_files.h"

namespace umbra {

/// OUT/index.html and its style, from the record of `umbra motion` alone.
void write_motion_page(const MotionRecord& record, const std::filesystem::path& out, StagedFiles& staged);

}  // namespace umbra
