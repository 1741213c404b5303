#include "umbra/bench/lab/steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace umbra {
namespace {

std::string duration(double seconds) {
    if (seconds < 100) return fmt::format("{:.0f} s", std::ceil(seconds));
    if (seconds < 6000) return fmt::format("{:.0f} min", seconds / 60);
    return fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace

std::string step_line(std::size_t finished, std::size_t count, const std::string& what, double finished_seconds,
                      double current_seconds) {
    if (count <= 1) return what;
    std::string line = fmt::format("[{}/{}] {}", finished + 1, count, what);
    if (finished == 0) return line;
    const double mean  = finished_seconds / double(finished);
    const double after = mean * double(count - finished - 1);
    return line + fmt::format(", {} left", duration(after + std::max(mean - current_seconds, 0.0)));
}

Steps::Steps(std::size_t count, std::function<void(const std::string&)> receive)
    : count_(count), receive_(std::move(receive)), start_(Clock::now()), step_start_(start_) {}

void Steps::next() {
    ++begun_;
    step_start_ = Clock::now();
}

void Steps::show(const std::string& what) const {
    if (!receive_) return;
    const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
    receive_(step_line(std::max<std::size_t>(begun_, 1) - 1, count_, what, seconds(step_start_ - start_),
                       seconds(Clock::now() - step_start_)));
}

}  // namespace umbra
