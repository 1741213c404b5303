#include "umbra/bench/lab/pinned_threads.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <thread>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

/// Processors that this thread may use.
std::set<int> here() {
    cpu_set_t mask;
    CPU_ZERO(&mask);
    EXPECT_EQ(sched_getaffinity(0, sizeof(mask), &mask), 0);
    std::set<int> all;
    for (int p = 0; p < CPU_SETSIZE; ++p)
        if (CPU_ISSET(p, &mask)) all.insert(p);
    return all;
}

/// Of each thread that takes part in parallel work: as many tasks as it takes that several threads are there.
std::set<std::set<int>> of_all_threads() {
    std::mutex mutex;
    std::set<std::set<int>> all;
    parallel_ranges(64, 1, [&](std::size_t, std::size_t) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const std::lock_guard lock(mutex);
        all.insert(here());
    });
    return all;
}

TEST(PinnedThreads, StayOnAProcessorEachAndMayMoveAfterwards) {
    const std::set<int> allowed              = here();
    const std::set<std::set<int>> any_of_all = {allowed};
    EXPECT_EQ(of_all_threads(), any_of_all);
    {
        const PinnedThreads pinned;
        EXPECT_TRUE(pinned.pinned());
        EXPECT_EQ(here().size(), 1u);
        const std::size_t threads = std::min(allowed.size(), static_cast<std::size_t>(thread_count()));
        std::set<std::set<int>> masks;
        for (int k = 0; k < 100 && masks.size() < threads; ++k) masks.merge(of_all_threads());  // some may come late
        EXPECT_EQ(masks.size(), threads);
        for (const auto& mask : masks) EXPECT_EQ(mask.size(), 1u);
    }
    EXPECT_EQ(here(), allowed);
    EXPECT_EQ(of_all_threads(), any_of_all);
}

}  // namespace
}  // namespace umbra
