#include "umbra/core/base/memory.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace umbra {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// The number in a file; no limit where there is none ("max").
double limit_in(const std::string& file) {
    double bytes = 0;
    std::ifstream in(file);
    return in >> bytes ? bytes : kNoLimit;
}

/// The least limit of this process's control group and those above it, versions 1 and 2.
double control_group_limit() {
    double least = kNoLimit;
    std::ifstream groups("/proc/self/cgroup");  // "0::/a/b" or "5:memory:/a/b"
    for (std::string line; std::getline(groups, line);) {
        const bool second = line.starts_with("0::"), memory = line.find(":memory:") != std::string::npos;
        if (!second && !memory) continue;
        const std::string root = second ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
        const char* name       = second ? "/memory.max" : "/memory.limit_in_bytes";
        for (std::string group = line.substr(line.rfind(':') + 1);; group.resize(group.rfind('/'))) {
            least = std::min(least, limit_in(root + group + name));
            if (group.find('/') == std::string::npos) break;
        }
    }
    return least;
}

}  // namespace

double machine_memory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double address_space_limit() {
    rlimit limit{};
    return getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY ? static_cast<double>(limit.rlim_cur)
                                                                                : kNoLimit;
}

void keep_freed_memory() {
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 256 << 20);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

double usable_memory() { return std::min({machine_memory(), control_group_limit(), address_space_limit()}); }

}  // namespace umbra
