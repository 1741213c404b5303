#include "umbra/bench/lab/calibration.h"

#include <atomic>
#include <cstdint>
#include <vector>

#include "umbra/core/base/parallel.h"
#include "umbra/core/base/random_bits.h"

namespace umbra {

void calibration_work() {
    constexpr std::size_t blocks = 32, words = std::size_t{1} << 16;  // 16 MiB in all: more than caches of cores hold
    static std::vector<std::uint64_t> memory(blocks * words, 1);
    static std::atomic<std::uint64_t> kept{0};  // keeps the compiler from leaving the loop out
    parallel_ranges(blocks, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            std::uint64_t sum = b;
            for (int pass = 0; pass < 4; ++pass)
                for (std::size_t i = 0; i < words; ++i) {
                    std::uint64_t& word = memory[b * words + i];
                    sum += mixed_bits(word ^ sum);
                    word = sum;
                }
            kept.fetch_add(sum, std::memory_order_relaxed);
        }
    });
}

}  // namespace umbra
