#include "umbra/core/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace umbra {

ThreadLimit::ThreadLimit(int threads)
    : control_(std::make_unique<tbb::global_control>(
          tbb::global_control::max_allowed_parallelism,
          static_cast<std::size_t>(threads > 0 ? threads : tbb::this_task_arena::max_concurrency()))) {}

ThreadLimit::~ThreadLimit() = default;

const WorkLimit*& WorkLimit::current() {
    static thread_local const WorkLimit* limit = nullptr;
    return limit;
}

int thread_count() {
    return static_cast<int>(
        std::min<std::size_t>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
                              static_cast<std::size_t>(tbb::this_task_arena::max_concurrency())));
}

}  // namespace umbra
