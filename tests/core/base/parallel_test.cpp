#include "umbra/core/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "umbra/core/base/parallel_sort.h"
#include "umbra/core/render/ray.h"

namespace umbra {
namespace {

/// 0 while denormals are flushed.
double half_of_the_least_normal() {
    volatile float least = std::numeric_limits<float>::min();
    volatile float half  = least * 0.5f;
    return static_cast<double>(half);
}

/// In each of 64 ranges.
std::vector<double> halves() {
    std::vector<double> found(64);
    parallel_ranges(found.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) found[i] = half_of_the_least_normal();
    });
    return found;
}

/// TBB takes the mode of a thread's first parallel loop for all later ones: this is a thread of its own.
template <class Body>
void on_new_thread(const Body& body) {
    std::thread(body).join();
}

TEST(ParallelRanges, ComputeInTheModeOfTheirCaller) {
    const std::vector<double> kept(64, 0x1p-127), flushed(64, 0.0);
    on_new_thread([&] {
        {
            const FlushDenormals flush;
            EXPECT_EQ(halves(), flushed);
        }
        EXPECT_EQ(halves(), kept);
        parallel_pair([] { EXPECT_GT(half_of_the_least_normal(), 0); }, [] { EXPECT_EQ(halves()[0], 0x1p-127); });
        std::vector<double> places{3 * 0x1p-1074, 2 * 0x1p-1074, 0x1p-1074};
        parallel_sort(places.begin(), places.end());
        EXPECT_EQ(places, (std::vector<double>{0x1p-1074, 2 * 0x1p-1074, 3 * 0x1p-1074}));
    });
    on_new_thread([&] {
        EXPECT_EQ(halves(), kept);
        const FlushDenormals flush;
        EXPECT_EQ(halves(), flushed);
    });
}

/// Ends the work when it is asked for the tenth time.
struct TenRanges final : WorkLimit {
    mutable std::atomic<int> asked = 0;
    void check() const override {
        if (++asked >= 10) throw std::runtime_error("ten ranges");
    }
};

TEST(WorkLimit, EndsTheLoopsOfItsScopeAndNoOther) {
    const TenRanges limit;
    int ranges       = 0;
    const auto loops = [&] {
        for (int k = 0; k < 20; ++k) parallel_ranges(1, 1, [&](std::size_t, std::size_t) { ++ranges; });
    };
    {
        const WorkLimit::Scope scope(&limit);
        EXPECT_THROW(loops(), std::runtime_error);
        EXPECT_EQ(ranges, 9);
        EXPECT_THROW(parallel_pair([] {}, [] {}), std::runtime_error);
        const WorkLimit::Scope free(nullptr);
        EXPECT_NO_THROW(loops());
    }
    EXPECT_EQ(WorkLimit::current(), nullptr);
    const int asked = limit.asked;
    EXPECT_NO_THROW(loops());
    EXPECT_EQ(limit.asked, asked) << "no loop outside asks it";
}

/// A loop within a range of a loop is work of the same limit, on whichever thread.
TEST(WorkLimit, HoldsForLoopsWithinLoops) {
    const TenRanges limit;
    const WorkLimit::Scope scope(&limit);
    EXPECT_THROW(parallel_ranges(4, 1,
                                 [](std::size_t begin, std::size_t end) {
                                     for (std::size_t k = 3 * begin; k < 3 * end; ++k)
                                         parallel_ranges(1, 1, [](std::size_t, std::size_t) {});
                                 }),
                 std::runtime_error);
}

/// TBB's own ranges are large where nobody waits for work, as on one thread.
TEST(WorkLimit, IsAskedWithinLargeRanges) {
    struct Asked final : WorkLimit {
        mutable std::atomic<int> times = 0;
        void check() const override { ++times; }
    };
    constexpr std::size_t kCount = 100003;
    const ThreadLimit one(1);
    const Asked limit;
    const WorkLimit::Scope scope(&limit);
    std::vector<int> met(kCount);
    std::size_t largest = 0;
    parallel_ranges(kCount, 7, [&](std::size_t begin, std::size_t end) {
        largest = std::max(largest, end - begin);
        for (std::size_t i = begin; i < end; ++i) ++met[i];
    });
    EXPECT_EQ(met, std::vector<int>(kCount, 1));
    EXPECT_LE(largest, kCount / 16);
    EXPECT_GE(limit.times, 16);
}

}  // namespace
}  // namespace umbra
