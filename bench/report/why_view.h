// Why single points are wrong: the section of a scene's page.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "umbra/bench/pages/report_page.h"

namespace umbra {

/// An entry for each light and each method with wrong interior points at it: its points, each with a piece of the class
/// picture around it, the reasons and their difference in words.
[[nodiscard]] nlohmann::json why_view(const SceneFiles& scene);

}  // namespace umbra
