// What failed during a run, in words for a page.
#pragma once

#include <string>
#include <vector>

#include "umbra/bench/lab/results.h"

namespace umbra {

/// A line for the reference and for each method of a compared scene that failed: "METHOD failed at light L: message".
[[nodiscard]] std::vector<std::string> scene_failures(const Results& results);

/// A line for each entry of `failed` of ladders or of a bias study, which names what failed by ladder or scene.
[[nodiscard]] std::vector<std::string> listed_failures(const std::vector<ListedFailureRecord>& failed);

}  // namespace umbra
