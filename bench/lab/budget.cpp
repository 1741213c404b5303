#include "umbra/bench/lab/budget.h"

#include <fmt/format.h>

namespace umbra {

void Spending::check() const {
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (spent > budget_.seconds)
        throw CutShort(
            fmt::format("cut short after {:.3g} s, the budget is {:g} s (--budget)", spent, budget_.seconds));
}

void Spending::check_bytes(std::size_t bytes) const {
    constexpr double kMiB = 1 << 20;
    if (static_cast<double>(bytes) > budget_.bytes)
        throw CutShort(fmt::format("cut short at {:.3g} MiB of memory, the budget is {:g} MiB (--memory-budget)",
                                   static_cast<double>(bytes) / kMiB, budget_.bytes / kMiB));
}

}  // namespace umbra
