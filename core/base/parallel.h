// Threads: TBB behind few functions. Results never depend on how work was split, nor on earlier work: tasks
// compute in the floating-point mode of their caller. TBB's own default is the mode in which a thread first used it,
// and within Embree's build that is one without denormals.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

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

/// A condition that may end work early: it is asked before each range of a parallel loop.
class WorkLimit {
public:
    virtual ~WorkLimit() = default;
    /// Throws where the work has to end. From many threads.
    virtual void check() const = 0;

    /// While it lives, the limit is that of this thread, and of the loops that this thread begins; nullptr: none.
    class Scope {
    public:
        explicit Scope(const WorkLimit* limit) : outer_(current()) { current() = limit; }
        ~Scope() { current() = outer_; }
        Scope(const Scope&)            = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        const WorkLimit* outer_;
    };
    [[nodiscard]] static const WorkLimit*& current();
};

/// Runs `work` as a part of the work that `limit` limits, on whichever thread.
template <class Work>
void run_within(const WorkLimit* limit, const Work& work) {
    const WorkLimit::Scope scope(limit);
    if (limit != nullptr) limit->check();
    work();
}

/// Calls body(begin, end) on disjoint ranges that cover [0, n), of about `grain` or more, from many threads.
template <class Body>
void parallel_ranges(std::size_t n, std::size_t grain, const Body& body) {
    tbb::task_group_context context(tbb::task_group_context::bound, tbb::task_group_context::fp_settings);
    const WorkLimit* const limit = WorkLimit::current();
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, n, grain),
        [&](const tbb::blocked_range<std::size_t>& r) {
            // TBB's ranges may be a large part of the loop, for which a limit must not have to wait.
            const std::size_t step = limit == nullptr ? r.size() : std::max(grain, r.size() / 16);
            for (std::size_t begin = r.begin(); begin < r.end(); begin += step)
                run_within(limit, [&] { body(begin, std::min(begin + step, r.end())); });
        },
        context);
}

/// Calls both, perhaps at one time.
template <class First, class Second>
void parallel_pair(const First& first, const Second& second) {
    tbb::task_group_context context(tbb::task_group_context::bound, tbb::task_group_context::fp_settings);
    const WorkLimit* const limit = WorkLimit::current();
    tbb::parallel_invoke([&] { run_within(limit, first); }, [&] { run_within(limit, second); }, context);
}

}  // namespace umbra
