#include "umbra/core/base/suggest.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "umbra/core/base/error.h"

namespace umbra {

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // Rows of the table of distances between the first i bytes of a and the first k bytes of b: i - 2, i - 1 and i.
    std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
    for (std::size_t k = 0; k <= b.size(); ++k) row[k] = k;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::swap(before, above);
        std::swap(above, row);
        row[0] = i;
        for (std::size_t k = 1; k <= b.size(); ++k) {
            row[k] = std::min({above[k] + 1, row[k - 1] + 1, above[k - 1] + (a[i - 1] != b[k - 1])});
            if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
                row[k] = std::min(row[k], before[k - 2] + 1);
        }
    }
    return row[b.size()];
}

std::vector<std::string> near_matches(std::string_view name, std::span<const std::string> candidates,
                                      std::size_t most) {
    const std::size_t limit = std::max<std::size_t>(1, name.size() / 3);
    std::vector<std::pair<std::size_t, std::string>> near;
    for (const std::string& candidate : candidates) {
        const std::size_t distance = edit_distance(name, candidate);
        // One short name is within one edit of any other of one byte: at least one byte must be right.
        if (distance <= limit && distance < std::max(name.size(), candidate.size()))
            near.emplace_back(distance, candidate);
        else if (!name.empty() && candidate.starts_with(name))
            near.emplace_back(limit + 1, candidate);
    }
    std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::string> names;
    for (auto& [distance, candidate] : near)
        if (names.size() < most) names.push_back(std::move(candidate));
    return names;
}

std::string closest(std::string_view name, std::span<const std::string> candidates) {
    const std::vector<std::string> near = near_matches(name, candidates, 1);
    return near.empty() ? "" : near.front();
}

std::string did_you_mean(std::string_view name, std::span<const std::string> candidates) {
    const std::vector<std::string> near = near_matches(name, candidates);
    return near.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(near, " or "));
}

void refuse_unknown_name(std::string_view what, std::string_view name, std::span<const std::string> known) {
    const std::string all = known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "));
    throw UsageError(fmt::format("{} \"{}\" (known: {}){}", what, name, all, did_you_mean(name, known)));
}

}  // namespace umbra
