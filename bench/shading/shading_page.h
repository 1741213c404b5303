// The page of `umbra shading`: every model beside its difference from Phong shading, and the table.
#pragma once

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// FOLDER/index.html and its style, from the record of compare_shading alone.
void write_shading_page(const Json& record, const std::filesystem::path& folder, StagedFiles& staged);

}  // namespace umbra
