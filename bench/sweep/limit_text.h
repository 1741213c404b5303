// What is typed for a limit: "rmse=0.01".
#pragma once

#include <string>
#include <string_view>

namespace umbra {

struct LimitText {
    std::string metric;  ///< as typed; any word
    double most = 0;
};
/// "METRIC=E" as typed after --max, E finite and at least 0; `expected` ends the error where there is no "=", as
/// "METRIC=LIMIT, as rmse=0.01". Throws UsageError.
[[nodiscard]] LimitText parse_limit_text(const std::string& text, std::string_view expected);

}  // namespace umbra
