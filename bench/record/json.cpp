#include "umbra/bench/record/json.h"

#include <cmath>

namespace umbra {

std::string json_text(const Json& record) { return record.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace umbra
