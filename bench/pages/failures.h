// What failed during a run, read from results.json, in words for a page.
#pragma once

#include <string>
#include <vector>

#include "umbra/bench/run/results_file.h"

namespace umbra {

/// The method threw or broke its contract; it has no results.
[[nodiscard]] bool failed(const Field& method);

/// A line for the reference and for each method of a compared scene that failed: "METHOD failed at light L: message".
[[nodiscard]] std::vector<std::string> scene_failures(const Field& root);

/// A line for each entry of `failed` of ladders or of a bias study, which names what failed by ladder or scene.
[[nodiscard]] std::vector<std::string> listed_failures(const Field& root);

}  // namespace umbra
