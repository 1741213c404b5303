// "Did you mean": the known name that is nearest to a mistyped one.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace umbra {

/// Number of insertions, deletions, substitutions and swaps of neighbouring bytes that turn `a` into `b`; no byte is
/// edited twice (optimal string alignment).
/// [Frederick Damerau, A Technique for Computer Detection and Correction of Spelling Errors, 1964]
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidates that `name` was probably meant to be, best first, at most `most` of them: those within one edit for
/// every three bytes of `name` (at least one), and those that begin with it. Empty where none is near.
[[nodiscard]] std::vector<std::string> near_matches(std::string_view name, std::span<const std::string> candidates,
                                                    std::size_t most = 3);

/// The best of near_matches; empty where none is near.
[[nodiscard]] std::string closest(std::string_view name, std::span<const std::string> candidates);

/// "; did you mean NAME?", to be appended to a message; empty where no candidate is near.
[[nodiscard]] std::string did_you_mean(std::string_view name, std::span<const std::string> candidates);

/// Throws UsageError: `WHAT "NAME" (known: A, B); did you mean A?`, where `what` is as "unknown method".
[[noreturn]] void refuse_unknown_name(std::string_view what, std::string_view name, std::span<const std::string> known);

/// The entry of that name, by a projection or a member. Throws as refuse_unknown_name.
template <class Entries, class Name>
[[nodiscard]] const auto& entry_named(std::string_view what, std::string_view name, const Entries& entries,
                                      Name name_of) {
    const auto found = std::ranges::find(entries, name, name_of);
    if (found != std::ranges::end(entries)) return *found;
    std::vector<std::string> known;
    for (const auto& entry : entries) known.emplace_back(std::invoke(name_of, entry));
    refuse_unknown_name(what, name, known);
}

}  // namespace umbra
