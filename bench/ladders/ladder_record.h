// What a climb found, as the record that results.json holds, and as the table that the terminal shows.
#pragma once

#include <span>
#include <string>

#include "umbra/bench/ladders/ladder_run.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// The entry of one ladder in `ladders` of results.json (bench/ladders/ladders.schema.json).
[[nodiscard]] Json ladder_json(const LadderRun& run);

/// Entries of `failed` of results.json: methods and references that threw on a ladder, at their first such rung.
[[nodiscard]] Json failed_climbs_json(const LadderRun& run);
/// "LADDER: METHOD: It failed at RUNG, light LIGHT: message", of one such entry.
[[nodiscard]] std::string failed_climb_in_words(const Json& failed);

/// A ladder as `umbra list --json` names it: name, title, about, unit, rungs.
[[nodiscard]] Json ladder_info_json(const Ladder& ladder);

/// A row a ladder, a column a method: the rung that breaks and the kind of error, from the array of `ladder_json`s.
[[nodiscard]] std::string ladder_table(const Json& ladders);

/// One cell of that table.
[[nodiscard]] std::string climb_in_words(const Json& method, const Json& ladder);

}  // namespace umbra
