// The page of `umbra radiosity`: its pictures, and how fast power was sent.
#pragma once

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/radiosity/light_exchange.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// Solves, and writes the folder `out` whole: pictures, results.json and the page. Returns the record. Throws as
/// exchange_light.
Json write_exchange_study(const PreparedScene& prepared, const ExchangeOptions& options,
                          const std::filesystem::path& out);

/// FOLDER/index.html and its style, from the record of exchange_light alone.
void write_exchange_page(const Json& record, const std::filesystem::path& folder, StagedFiles& staged);

}  // namespace umbra
