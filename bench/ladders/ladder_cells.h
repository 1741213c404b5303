// How a method fared on a ladder, in the words that all tables of ladders share.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "umbra/bench/ladders/ladder_record.h"

namespace umbra {

/// A rung's value: 1, 3.2, 0.01, and beyond that 10⁻⁵ or 3.2·10⁻⁵.
[[nodiscard]] std::string rung_value(double value);

/// The index of the rung with this value; nothing where there is none.
[[nodiscard]] std::optional<std::size_t> rung_of(const LadderRecord& ladder, const std::optional<double>& value);

/// What a method is called: its title, with its preset or as typed where it runs with other than its default settings.
[[nodiscard]] std::string label_of(const ClimbRecord& climbed);

/// What a climb without a break leaves out, of rungs (where it "holds") and of points: "judged on 5 of 8 rungs, answers
/// 43 % of the points or more"; empty where it leaves out nothing, where it breaks, and where the record does not say.
[[nodiscard]] std::string left_out_in_words(const LadderRecord& ladder, const ClimbRecord& climbed);

/// How a method fared: the cell's main words, the class of its errors, a note beneath them, and whether it is a break.
[[nodiscard]] nlohmann::json fared(const LadderRecord& ladder, const ClimbRecord& climbed);

}  // namespace umbra
