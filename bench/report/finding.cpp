#include "umbra/bench/report/finding.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "umbra/bench/pages/error_palette.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

struct Compared {
    const MethodRecord* method;
    std::string label;
    double wrong = 0;  ///< interior points, over all lights
    bool partial = false;
};

/// A count of one object of the `errors` entries, over all lights.
double sum_of(const MethodRecord& method, std::string_view group, std::string_view member) {
    double sum = 0;
    for (const ErrorRecord& error : method.errors) sum += wrong_points(error, group, member).value_or(0);
    return sum;
}

/// Wrong points of either kind, over all lights.
double sum_of(const MethodRecord& method, DirectionRecord ErrorRecord::*object, std::string_view group) {
    double sum = 0;
    for (const ErrorRecord& error : method.errors) {
        const DirectionRecord& wrong = error.*object;
        sum += static_cast<double>(group == "false_shadow" ? wrong.false_shadow : wrong.false_light);
    }
    return sum;
}

/// The classes of a method's wrong interior points: "6 acne, 3 other false shadow".
std::string classes_in_words(const MethodRecord& method) {
    std::vector<std::string> parts;
    for (const std::string& group : error_groups()) {
        double rest = sum_of(method, group, "interior") - sum_of(method, &ErrorRecord::penumbra_error, group) -
                      sum_of(method, &ErrorRecord::noise_error, group);
        bool any = false;
        for (const ErrorColour& entry : kErrorPalette) {
            if (entry.group != group || entry.member.empty()) continue;
            const double n = sum_of(method, group, entry.member);
            if (n > 0) parts.push_back(fmt::format("{} {}", count(n), in_words(std::string(entry.key))));
            any |= n > 0;
            rest -= n;
        }
        if (rest > 0) parts.push_back(fmt::format("{}{} {}", count(rest), any ? " other" : "", in_words(group)));
    }
    for (const auto& [object, name] :
         {std::pair{&ErrorRecord::penumbra_error, "in penumbrae"}, std::pair{&ErrorRecord::noise_error, "by noise"}}) {
        double n = 0;
        for (const std::string& group : error_groups()) n += sum_of(method, object, group);
        if (n > 0) parts.push_back(fmt::format("{} {}", count(n), name));
    }
    return fmt::format("{}", fmt::join(parts, ", "));
}

/// The methods that are correct everywhere: "all 3 other methods: none", "Planar projection: none where it answers".
std::string right_in_words(const std::vector<Compared>& right) {
    const bool partial = std::any_of(right.begin(), right.end(), [](const Compared& c) { return c.partial; });
    if (right.size() == 1) return fmt::format("{}: none{}", right[0].label, partial ? " where it answers" : "");
    return fmt::format("all {} other methods: none{}", right.size(), partial ? " where they answer" : "");
}

/// What most of a method's wrong interior points have in common; null where there is none.
const ErrorColour* most_frequent(const MethodRecord& method) {
    const ErrorColour* found = nullptr;
    double most              = 0;
    const auto take          = [&](const ErrorColour& entry, double n) {
        if (n > most) found = &entry, most = n;
    };
    for (const ErrorColour& entry : kErrorPalette) {
        if (!entry.interior) continue;
        double n = 0;
        for (const std::string& group : error_groups()) {
            if (entry.error_class == ErrorClass::penumbra) n += sum_of(method, &ErrorRecord::penumbra_error, group);
            if (entry.error_class == ErrorClass::noise) n += sum_of(method, &ErrorRecord::noise_error, group);
            if (entry.group != group) continue;
            n += sum_of(method, group, entry.member.empty() ? "interior" : entry.member);
            if (entry.member.empty())
                n -= sum_of(method, &ErrorRecord::penumbra_error, group) +
                     sum_of(method, &ErrorRecord::noise_error, group);
            for (const ErrorColour& named : kErrorPalette)
                if (entry.member.empty() && named.group == group && !named.member.empty())
                    n -= sum_of(method, group, named.member);
        }
        take(entry, n);
    }
    return found;
}

}  // namespace

std::string first_finding(const Results& results, const MethodRecord& method) {
    const std::string sides = fmt::format("left the shadows of “{}”, right {}. ", label_of(method),
                                          results.reference.exact ? "the exact ones" : "those of the reference");
    const Totals found      = totals(method);
    if (found.interior == 0)
        return fmt::format("{}Away from shadow edges, all of {} points are right.", sides, count(found.points));
    const ErrorColour* most = most_frequent(method);
    return fmt::format("{}Away from shadow edges, {} of {} points are wrong on the left. {}", sides,
                       count(found.interior), count(found.points),
                       most == nullptr ? "" : fmt::format("Most of them: {}.", most->in_short));
}

std::string finding(const Results& results) {
    const std::vector<MethodRecord>& methods = results.methods;
    std::vector<Compared> wrong, right;
    bool any = false;
    for (const MethodRecord& method : methods) {
        if (!serves(method) || is_reference(results, method) || method.errors.empty()) continue;
        any = true;
        if (totals(method).points == 0) continue;
        Compared c{&method, method_label(method, methods), totals(method).interior, method.coverage.value_or(1) < 1};
        (c.wrong > 0 ? wrong : right).push_back(std::move(c));
    }
    if (wrong.empty() && right.empty()) return any ? "No point is judged: no lit surface is in view." : "";
    const std::string reference = fmt::format("the {} reference", results.reference.exact ? "exact" : "inexact");
    if (wrong.empty()) {
        const bool partial = std::any_of(right.begin(), right.end(), [](const Compared& c) { return c.partial; });
        return fmt::format("{}: no wrong interior point against {}{}.",
                           right.size() == 1 ? right[0].label : fmt::format("All {} methods", right.size()), reference,
                           !partial            ? ""
                           : right.size() == 1 ? ", where it answers"
                                               : ", where they answer");
    }

    std::stable_sort(wrong.begin(), wrong.end(),
                     [](const Compared& a, const Compared& b) { return a.wrong > b.wrong; });
    std::string text = fmt::format(
        "{}: {} of {} compared with {} ({})", wrong[0].label, counted(wrong[0].wrong, "wrong interior point"),
        count(totals(*wrong[0].method).points), reference, classes_in_words(*wrong[0].method));
    constexpr std::size_t named = 4;  // more names than that are a table
    for (std::size_t i = 1; i < wrong.size(); ++i) {
        if (wrong.size() > named && i + 1 >= named) {
            text += fmt::format("; {} more methods: at most {} each", wrong.size() - i, count(wrong[i].wrong));
            break;
        }
        text += fmt::format("; {}: {}", wrong[i].label, count(wrong[i].wrong));
    }
    if (!right.empty()) text += "; " + right_in_words(right);
    return text + ".";
}

}  // namespace umbra
