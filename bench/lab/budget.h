// What one method may take on one scene, and how it is cut short where it takes more.
//
// Work is cut where it can be: before each phase, before each range of a parallel loop within one (core/base/parallel.h),
// and behind each phase where its values are too large. A loop that asks for no range is not cut, and neither is one
// that a plugin runs without parallel_ranges, until its phase ends.
#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "umbra/core/base/parallel.h"

namespace umbra {

struct Budget {
    double seconds = std::numeric_limits<double>::infinity();  ///< of wall clock, for one method on one scene
    double bytes   = std::numeric_limits<double>::infinity();  ///< that its values hold at one time

    [[nodiscard]] bool is_set() const { return std::isfinite(seconds) || std::isfinite(bytes); }
};

/// A method took more than its budget; what() says of which, and how it is asked for.
class CutShort : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A budget that is being spent from the construction on.
class Spending final : public WorkLimit {
public:
    explicit Spending(const Budget& budget) : budget_(budget) {}
    /// Throws CutShort where the time is spent.
    void check() const override;
    [[nodiscard]] bool bounds_memory() const { return std::isfinite(budget_.bytes); }
    /// Throws CutShort where this is more than there may be.
    void check_bytes(std::size_t bytes) const;

private:
    Budget budget_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace umbra
