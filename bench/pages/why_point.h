// Why one point is wrong, for the template why_point: a piece of a class picture, what was looked at, and the reasons.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "umbra/bench/lab/results.h"

namespace umbra {

/// The picture that a point is shown on, whose width and height are known, and whose answers are compared.
struct WhyPicture {
    std::string address, label, reference;
    SizeRecord size;
};

/// The point has a pixel.
[[nodiscard]] nlohmann::json why_point(const ExplainedPointRecord& point, const WhyPicture& picture);

}  // namespace umbra
