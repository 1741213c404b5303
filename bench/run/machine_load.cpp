#include "umbra/bench/run/machine_load.h"

#include <sched.h>

#include <cstdlib>
#include <limits>
#include <thread>

namespace umbra {

double load_average() {
    double minute = 0;
    return getloadavg(&minute, 1) == 1 ? minute : std::numeric_limits<double>::quiet_NaN();
}

int usable_processors() {
    cpu_set_t set;
    CPU_ZERO(&set);
    return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set)
                                                       : static_cast<int>(std::thread::hardware_concurrency());
}

}  // namespace umbra
