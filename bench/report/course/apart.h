// A program that was handed in runs apart: it sees its own folder and the system's programs, and has limits.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "umbra/bench/report/course/grade.h"
#include "umbra/bench/report/course/rubric.h"

namespace umbra {

/// Whether bubblewrap (bwrap) is there and may make namespaces. Starts it once.
[[nodiscard]] bool can_keep_apart();

/// The command that runs `command`, started in `folder` (absolute), with the limits. `protect`: by bwrap, which shows it
/// the folders of the system and `folder`, all read-only, empty home and temporary folders, and {run}, the folder of
/// files that is exchanged; and no network, unless the limits allow it. Otherwise it runs with the rights of this process.
[[nodiscard]] std::vector<std::string> apart_command(const std::vector<std::string>& command,
                                                     const std::filesystem::path& folder, const LimitsRecord& limits,
                                                     bool protect);
[[nodiscard]] ApartRecord apart_record(const LimitsRecord& limits, bool protect);

}  // namespace umbra
