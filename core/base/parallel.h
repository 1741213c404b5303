// Threads: TBB behind two functions. Results never depend on how work was split.
#pragma once

#include <cstddef>
#include <memory>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

namespace umbra {

/// Limits all parallel work of this process to `threads` (0: as many as the machine has) while it lives. Of several at
/// a time, the least counts.
class ThreadLimit {
public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&)            = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    std::unique_ptr<tbb::global_control> control_;
};
[[nodiscard]] int thread_count();

/// Calls body(begin, end) on disjoint ranges that cover [0, n), of about `grain` each, from many threads.
template <class Body>
void parallel_ranges(std::size_t n, std::size_t grain, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain),
                      [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); });
}

}  // namespace umbra
