#include "umbra/bench/record/strict_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "umbra/core/base/suggest.h"

namespace umbra::record_parts {

void require_members_among(const Field& field, const std::vector<std::string>& known) {
    for (const auto& [key, member] : field.members())
        if (std::find(known.begin(), known.end(), key) == known.end())
            member.refuse(
                fmt::format("no member of this name but {}{}", fmt::join(known, ", "), did_you_mean(key, known)));
}

}  // namespace umbra::record_parts
