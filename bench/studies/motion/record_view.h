// The parts that the tables and pages of motion and growth share. Internal to bench/studies/motion.
#pragma once

#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"

namespace umbra {

/// "1.07 to 1.20, 97.9 %" of an interval of two ends and its coverage; `none` where it is unknown.
[[nodiscard]] std::string interval_in_words(const std::vector<double>& interval, double coverage, const char* none);

/// "97.9 %"; "-" where an interval has no coverage.
[[nodiscard]] std::string coverage_text(double coverage);

/// With so many digits behind the point; "-" where it is unknown.
[[nodiscard]] std::string number_text(double value, int digits = 2);

/// "AMD EPYC, 2 threads, load average 0.10 to 2.00": the last line of a table.
[[nodiscard]] std::string machine_line(const MachineRecord& machine, const LoadRecord& load);

/// The terms of a page's template that say which program measured on what machine, and what failed.
[[nodiscard]] nlohmann::json record_view(const HeadRecord& head, const MachineRecord& machine, const LoadRecord& load,
                                         const std::vector<ListedFailureRecord>& failed);

}  // namespace umbra
