#include "umbra/core/base/memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstddef>
#include <memory>

namespace umbra {
namespace {

TEST(Memory, OfThisMachineIsPlausible) {
    EXPECT_GT(machine_memory(), 0x1p26);
    EXPECT_LT(machine_memory(), 0x1p60);
    EXPECT_GT(usable_memory(), 0x1p26);
    EXPECT_LE(usable_memory(), std::min(machine_memory(), address_space_limit()));
}

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
/// Pages that the system has handed out to this process.
long pages_handed_out() {
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    return use.ru_minflt;
}

long pages_for_a_block(std::size_t bytes) {
    const long before = pages_handed_out();
    const std::unique_ptr<volatile char[]> block(new volatile char[bytes]);
    for (std::size_t i = 0; i < bytes; i += 4096) block[i] = 1;
    return pages_handed_out() - before;
}

TEST(Memory, WhatIsFreedIsKept) {
    constexpr std::size_t kBlock = std::size_t{64} << 20;
    EXPECT_GT(pages_for_a_block(kBlock), 16);  // of 4 KB or of 2 MB
    keep_freed_memory();
    pages_for_a_block(kBlock);
    EXPECT_LT(pages_for_a_block(kBlock), 16);
}
#endif

}  // namespace
}  // namespace umbra
