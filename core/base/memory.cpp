#include "umbra/core/base/memory.h"

#include <unistd.h>

namespace umbra {

double machine_memory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace umbra
