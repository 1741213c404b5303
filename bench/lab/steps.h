// Progress of a run of several steps: "[3/22] what, 40 s left".
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace umbra {

/// `finished` of `count` steps took `finished_seconds` together; the current one has lasted `current_seconds`. The
/// estimate takes the remaining steps to last as long as the finished ones on average; there is none before the first
/// has finished. Without a number where there is only one step.
[[nodiscard]] std::string step_line(std::size_t finished, std::size_t count, const std::string& what,
                                    double finished_seconds, double current_seconds);

/// Counts steps, measures wall-clock time and passes lines on. One thread.
class Steps {
public:
    /// `receive` may be empty.
    Steps(std::size_t count, std::function<void(const std::string&)> receive);
    void next();  ///< before each step, the first included
    void show(const std::string& what) const;

private:
    using Clock = std::chrono::steady_clock;
    std::size_t count_, begun_ = 0;
    std::function<void(const std::string&)> receive_;
    Clock::time_point start_, step_start_;
};

}  // namespace umbra
