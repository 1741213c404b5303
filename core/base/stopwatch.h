// How long something took.
#pragma once

#include <chrono>

namespace umbra {

/// Runs from its construction on.
class Stopwatch {
public:
    /// Wall clock, milliseconds.
    [[nodiscard]] double ms() const {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }
    [[nodiscard]] double seconds() const { return ms() / 1000; }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace umbra
