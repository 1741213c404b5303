// The page of `umbra radiosity`: its pictures, and how fast power was sent.
#pragma once

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// FOLDER/index.html and its style, from the record of exchange_light alone.
void write_exchange_page(const Json& record, const std::filesystem::path& folder, StagedFiles& staged);

}  // namespace umbra
