#include "umbra/bench/lab/pinned_threads.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <thread>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

/// In increasing order, but beginning with the one that this thread runs on, so that two programs do not both crowd the
/// first processor.
std::vector<int> processors_from_here(const cpu_set_t& allowed) {
    std::vector<int> processors;
    for (int p = 0; p < CPU_SETSIZE; ++p)
        if (CPU_ISSET(p, &allowed)) processors.push_back(p);
    const auto here = std::ranges::find(processors, sched_getcpu());
    if (here != processors.end()) std::rotate(processors.begin(), here, processors.end());
    return processors;
}

/// Calls body(k), k < threads, on that many threads, one call each: every call waits for the others to begin. False if
/// they did not all begin within a second, because the system gave fewer threads.
template <class Body>
bool once_on_each_thread(std::size_t threads, const Body& body) {
    using Clock         = std::chrono::steady_clock;
    const auto deadline = Clock::now() + std::chrono::seconds(1);
    std::atomic<std::size_t> begun{0};
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, threads, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            ++begun;
            while (begun < threads && Clock::now() < deadline) std::this_thread::yield();
            body(range.begin());
        },
        tbb::simple_partitioner{});
    return Clock::now() < deadline;
}

}  // namespace

PinnedThreads::PinnedThreads() {
    const auto threads = static_cast<std::size_t>(thread_count());  // before this thread has one processor alone
    CPU_ZERO(&allowed_);
    if (sched_getaffinity(0, sizeof(allowed_), &allowed_) != 0) return;
    const std::vector<int> processors = processors_from_here(allowed_);
    threads_.resize(threads);
    std::atomic<bool> refused = false;
    const bool all            = once_on_each_thread(threads, [&](std::size_t k) {
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(processors[k % processors.size()], &one);
        threads_[k] = gettid();
        if (sched_setaffinity(0, sizeof(one), &one) != 0) refused = true;
    });
    if (!all || refused) release();
}

PinnedThreads::~PinnedThreads() { release(); }

void PinnedThreads::release() {
    for (const pid_t thread : threads_) sched_setaffinity(thread, sizeof(allowed_), &allowed_);
    threads_.clear();
}

}  // namespace umbra
