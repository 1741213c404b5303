// How busy the machine is while something is timed.
#pragma once

namespace umbra {

[[nodiscard]] double load_average();    ///< of the last minute: programs that run or want to; NaN where unknown
[[nodiscard]] int usable_processors();  ///< those that this process may run on (its CPU affinity)

}  // namespace umbra
