// Large arrays lie in huge pages: a page is counted in by the kernel when it is first touched, and there are 512 times
// fewer. `umbra ladder near_to_far gap sliver_receiver crack --methods shadow_zbuffer` takes 0.8 of the time.
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kHugePage = std::size_t{1} << 21;

/// Null where there is no memory.
void* allocated(std::size_t bytes) {
    void* const memory = std::malloc(bytes > 0 ? bytes : 1);
    if (memory == nullptr || bytes < kHugePage) return memory;
    const auto address      = reinterpret_cast<std::uintptr_t>(memory);
    const std::size_t ahead = (kHugePage - address % kHugePage) % kHugePage;
    // A wish: kernels without them have small pages.
    madvise(static_cast<char*>(memory) + ahead, (bytes - ahead) / kHugePage * kHugePage, MADV_HUGEPAGE);
    return memory;
}

}  // namespace

void* operator new(std::size_t bytes) {
    for (;;) {
        if (void* const memory = allocated(bytes)) return memory;
        const std::new_handler handler = std::get_new_handler();
        if (handler == nullptr) throw std::bad_alloc();
        handler();
    }
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
