// Threads that stay on their processors while times are measured.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <vector>

namespace umbra {

/// While it lives, each thread that works in parallel, the calling one included, stays on one processor of those that
/// the process may use; afterwards all may move again. A system that refuses leaves them as they are. One at a time.
class PinnedThreads {
public:
    PinnedThreads();
    ~PinnedThreads();
    PinnedThreads(const PinnedThreads&)            = delete;
    PinnedThreads& operator=(const PinnedThreads&) = delete;
    /// Whether every thread is on one processor.
    [[nodiscard]] bool pinned() const { return !threads_.empty(); }

private:
    void release();

    cpu_set_t allowed_{};
    std::vector<pid_t> threads_{};  ///< those that were pinned
};

}  // namespace umbra
