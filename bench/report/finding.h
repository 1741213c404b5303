// One sentence on what a comparison found, from its figures alone.
#pragma once

#include <string>

#include "umbra/bench/lab/results.h"

namespace umbra {

/// Which methods have wrong interior points, the most first, and which have none: "Shadow z-buffer: 9 wrong interior
/// points of 684 compared with the exact reference (6 acne, 3 other false shadow); all 3 other methods: none." Empty
/// where no method was compared.
[[nodiscard]] std::string finding(const Results& results);

/// The same of one method, for those who see it for the first time: how many points away from shadow edges are wrong,
/// and the most frequent fault among them.
[[nodiscard]] std::string first_finding(const Results& results, const MethodRecord& method);

/// One method, all lights: "Right at all 12 871 points.", "2 of 13 728 points are wrong, all of them at edges of shadows.",
/// "61 of 12 342 points are wrong away from the edges of shadows (40 acne, 21 leak), 200 at edges."; and how many points it
/// leaves without an answer.
[[nodiscard]] std::string finding_of(const MethodRecord& method);

}  // namespace umbra
