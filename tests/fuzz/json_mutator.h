// Changes to JSON files that know what a scene is made of.
#pragma once

#include <optional>
#include <random>
#include <string>
#include <string_view>

namespace umbra {

/// One to four changes: numbers become extremes, zero, or another number of the file; three numbers become three
/// others, as a light moves into a corner or an eye into a light; all lengths are scaled or moved; lights become
/// others; parts are doubled, dropped or swapped. The same for the same state of `random`. Nothing where `text` is no
/// JSON.
[[nodiscard]] std::optional<std::string> mutated_json(std::string_view text, std::mt19937& random);

}  // namespace umbra
