// The list of ladders, and finding one by name.
#include "umbra/bench/ladders/ladder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "umbra/core/base/error.h"
#include "umbra/core/base/suggest.h"

namespace umbra {
namespace {

const std::vector<const Ladder*> kLadders = {
#define LADDER(name) &name##_ladder,
#include "umbra/bench/ladders/ladders.def"
#undef LADDER
};

}  // namespace

std::span<const Ladder* const> ladders() { return kLadders; }

const Ladder& find_ladder(std::string_view name) {
    std::vector<std::string> known;
    for (const Ladder* ladder : kLadders) {
        if (ladder->name == name) return *ladder;
        known.emplace_back(ladder->name);
    }
    throw UsageError(
        fmt::format("unknown ladder \"{}\"{} (known: {})", name, did_you_mean(name, known), fmt::join(known, ", ")));
}

}  // namespace umbra
