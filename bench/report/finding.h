// One sentence on what a comparison found, from its figures alone.
#pragma once

#include <string>

#include "umbra/bench/run/results.h"

namespace umbra {

/// Which methods have wrong interior points, the most first, and which have none: "Shadow z-buffer: 9 wrong interior
/// points of 684 compared with the exact reference (6 acne, 3 other false shadow); all 3 other methods: none." Empty
/// where no method was compared.
[[nodiscard]] std::string finding(const Results& results);

/// The same of one method, for those who see it for the first time: how many points away from shadow edges are wrong,
/// and the most frequent fault among them.
[[nodiscard]] std::string first_finding(const Results& results, const MethodRecord& method);

}  // namespace umbra
