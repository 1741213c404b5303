#include "umbra/bench/sweep/limit_text.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "umbra/core/base/error.h"

namespace umbra {

LimitText parse_limit_text(const std::string& text, std::string_view expected) {
    const std::size_t eq = text.find('=');
    if (eq == std::string::npos) throw UsageError(fmt::format("--max {}: expected {}", text, expected));
    LimitText limit{text.substr(0, eq), 0};
    const char* end        = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data() + eq + 1, end, limit.most);
    if (error != std::errc() || at != end || !std::isfinite(limit.most) || limit.most < 0)
        throw UsageError(fmt::format("--max {}: found the limit \"{}\", expected a finite number of at least 0", text,
                                     text.substr(eq + 1)));
    return limit;
}

}  // namespace umbra
