// The page of `umbra shading`: every model beside its difference from Phong shading, and the table.
#pragma once

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/describe.h"
#include "umbra/bench/shading/shading_study.h"

namespace umbra {

/// Compares, and writes the folder `out` whole: pictures, results.json and the page. Returns the record. Throws as
/// compare_shading.
Json write_shading_study(const PreparedScene& prepared, const ShadingOptions& options,
                         const std::filesystem::path& out);

/// FOLDER/index.html and its style, from the record of compare_shading alone.
void write_shading_page(const Json& record, const std::filesystem::path& folder, StagedFiles& staged);

}  // namespace umbra
