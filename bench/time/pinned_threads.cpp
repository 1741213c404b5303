#include "umbra/bench/time/pinned_threads.h"

#include <sched.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <vector>

namespace umbra {

class PinnedThreads::Observer final : public tbb::task_scheduler_observer {
public:
    Observer() {
        static_cast<void>(
            tbb::this_task_arena::max_concurrency());  // counts processors once, before this thread has one
        CPU_ZERO(&allowed_);
        if (sched_getaffinity(0, sizeof(allowed_), &allowed_) != 0) return;
        for (int p = 0; p < CPU_SETSIZE; ++p)
            if (CPU_ISSET(p, &allowed_)) processors_.push_back(p);
        // It begins where it is now, so that two programs do not both crowd the first processor.
        const auto here = std::ranges::find(processors_, sched_getcpu());
        if (here != processors_.end()) std::ranges::rotate(processors_, here);
        pinned_ = pin(0);
        observe(true);
    }

    ~Observer() override {
        observe(false);
        const std::lock_guard lock(mutex_);
        for (const pid_t thread : threads_) sched_setaffinity(thread, sizeof(allowed_), &allowed_);
    }
    Observer(const Observer&)            = delete;
    Observer& operator=(const Observer&) = delete;

    void on_scheduler_entry(bool) override {
        if (const int slot = tbb::this_task_arena::current_thread_index(); slot > 0)
            pin(static_cast<std::size_t>(slot));
    }
    void on_scheduler_exit(bool worker) override {
        if (!worker) return;
        const std::lock_guard lock(mutex_);
        std::erase(threads_, gettid());
        sched_setaffinity(0, sizeof(allowed_), &allowed_);
    }
    [[nodiscard]] bool pinned() const { return pinned_; }

private:
    bool pin(std::size_t slot) {
        if (processors_.empty()) return false;
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(processors_[slot % processors_.size()], &one);
        if (sched_setaffinity(0, sizeof(one), &one) != 0) return false;
        const std::lock_guard lock(mutex_);
        threads_.push_back(gettid());
        return true;
    }

    cpu_set_t allowed_{};
    std::vector<int> processors_;
    std::mutex mutex_;
    std::vector<pid_t> threads_;
    bool pinned_ = false;
};

PinnedThreads::PinnedThreads() : observer_(std::make_unique<Observer>()) {}
PinnedThreads::~PinnedThreads() = default;
bool PinnedThreads::pinned() const { return observer_->pinned(); }

}  // namespace umbra
