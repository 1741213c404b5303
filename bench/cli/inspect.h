// `umbra inspect`: what a scene requires, and which method serves it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/run/describe.h"

namespace umbra {

struct SilhouetteOptions {
    std::uint64_t directions = 0;  ///< 0: not asked for
    std::uint64_t seed       = 1;
};

/// {schema, scene, facts, lights, methods: [{name, serves}], silhouettes?}
[[nodiscard]] Json inspect_json(const Scene& scene, const SceneFacts& facts, const SilhouetteOptions& silhouettes);

/// The same for people.
[[nodiscard]] std::string inspect_text(const Json& record);

}  // namespace umbra
