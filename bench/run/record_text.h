// Records as text.
#pragma once

#include <string>

#include "umbra/bench/run/describe.h"

namespace umbra {

/// Indented, with a line end. Names that come from files and paths need not be UTF-8; what is not becomes U+FFFD.
[[nodiscard]] inline std::string record_text(const Json& record) {
    return record.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace umbra
