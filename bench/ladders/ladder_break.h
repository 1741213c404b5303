// A break shown again: a small scene with it, and what it looks like.
#pragma once

#include <filesystem>

#include "umbra/bench/ladders/ladder_run.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

/// Reduces the scene of the rung where the method broke, and writes NAME.json (a native scene), and the S of the
/// method, of the truth, and the classes of the errors as PNGs into `folder`. Returns what results.json says of them:
/// file names seen from `folder`, the size of the scene, and the errors on it.
Json write_break(const std::filesystem::path& folder, const std::string& name, const Ladder& ladder, double value,
                 const MethodChoice& method);

}  // namespace umbra
