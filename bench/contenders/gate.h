// The gate that a program from outside passes before it stands in a table: small scenes whose answers are known, and
// the ways in which answers are usually wrong.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "umbra/shadows/method.h"

namespace umbra {

struct GateRow {
    std::string question;  ///< "a box under a point light"
    std::string found;     ///< in words and figures
    bool passed = true;
};

/// Every kind of light that the method says it serves, one scene after the other (and so in one process), two lights at
/// once, no occluder at all; the same question again, and other points than those of a raster where it takes them. A
/// scene is passed where it answers at half of the points or more, at most 1 % of them are wrong away from the edges of
/// shadows; under a light with an area 10 %, since few samples scatter by more than 0.1 in a penumbra, and there the mean
/// error is at most 0.05 and the bias, which scatter does not change, at most 0.02. A program that
/// fails has failed its row. `progress` receives each question before it is asked; may be empty.
[[nodiscard]] std::vector<GateRow> gate(const MethodInfo& method,
                                        const std::function<void(const std::string&)>& progress = {});

}  // namespace umbra
