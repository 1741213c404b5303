#include "umbra/bench/report/finding.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>
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

/// How many of a method's wrong interior points are of a class, in the order of the palette; classes without any are
/// left out.
std::vector<std::pair<const ErrorColour*, double>> interior_classes(const MethodRecord& method) {
    std::vector<std::pair<const ErrorColour*, double>> counts;
    for (const ErrorColour& entry : kErrorPalette) {
        if (!entry.interior) continue;
        double n = 0;
        if (!entry.member.empty()) {
            n = sum_of(method, entry.group, entry.member);
        } else if (!entry.group.empty()) {  // the rest of its group
            n = sum_of(method, entry.group, "interior") - sum_of(method, &ErrorRecord::penumbra_error, entry.group) -
                sum_of(method, &ErrorRecord::noise_error, entry.group);
            for (const ErrorColour& named : kErrorPalette)
                if (named.group == entry.group && !named.member.empty()) n -= sum_of(method, named.group, named.member);
        } else {
            for (const std::string_view group : kErrorGroups)
                n += sum_of(
                    method,
                    entry.error_class == ErrorClass::noise ? &ErrorRecord::noise_error : &ErrorRecord::penumbra_error,
                    group);
        }
        if (n > 0) counts.emplace_back(&entry, n);
    }
    return counts;
}

/// "6 acne, 3 other false shadow".
std::string classes_in_words(const MethodRecord& method) {
    const auto counts = interior_classes(method);
    std::vector<std::string> parts;
    for (const auto& [entry, n] : counts) {
        const bool any = std::ranges::any_of(counts, [&, &of = entry](const auto& other) {
            return other.first->group == of->group && !other.first->member.empty();
        });
        parts.push_back(fmt::format("{} {}", count(n),
                                    !entry->member.empty()  ? in_words(entry->key)
                                    : !entry->group.empty() ? (any ? "other " : "") + in_words(entry->group)
                                    : entry->error_class == ErrorClass::noise ? "by noise"
                                                                              : "in penumbrae"));
    }
    return fmt::format("{}", fmt::join(parts, ", "));
}

/// The methods that are correct everywhere: "all 3 other methods: none", "Planar projection: none where it answers".
std::string right_in_words(const std::vector<Compared>& right) {
    const bool partial = std::any_of(right.begin(), right.end(), [](const Compared& c) { return c.partial; });
    if (right.size() == 1) return fmt::format("{}: none{}", right[0].label, partial ? " where it answers" : "");
    return fmt::format("all {} other methods: none{}", right.size(), partial ? " where they answer" : "");
}

}  // namespace

std::string first_finding(const Results& results, const MethodRecord& method) {
    const std::string sides = fmt::format("left the shadows of “{}”, right {}. ", label_of(method),
                                          results.reference.exact ? "the exact ones" : "those of the reference");
    const Totals found      = totals(method);
    if (found.interior == 0)
        return fmt::format("{}Away from shadow edges, all of {} points are right.", sides, count(found.points));
    const auto classes = interior_classes(method);
    const auto most    = std::ranges::max_element(classes, {}, [](const auto& c) { return c.second; });
    return fmt::format("{}Away from shadow edges, {} of {} points are wrong on the left.{}", sides,
                       count(found.interior), count(found.points),
                       most == classes.end() ? "" : fmt::format(" Most often: {}.", most->first->in_short));
}

std::string finding_of(const MethodRecord& method) {
    const Totals found = totals(method);
    double undefined   = 0;
    for (const ErrorRecord& error : method.errors) undefined += static_cast<double>(error.undefined);
    const std::string gaps =
        undefined > 0 ? fmt::format(" It leaves {} without an answer.", counted(undefined, "point")) : "";
    if (found.points == 0) return "No point is judged." + gaps;
    const std::string of = counted(found.points, "point");
    if (found.interior == 0 && found.edge == 0) return fmt::format("Right at all {}.{}", of, gaps);
    const auto are = [](double n) { return n == 1 ? "is" : "are"; };
    if (found.interior == 0)
        return fmt::format("{} of {} {} wrong, all at edges of shadows.{}", count(found.edge), of, are(found.edge),
                           gaps);
    return fmt::format("{} of {} {} wrong away from the edges of shadows ({}), {} at edges.{}", count(found.interior),
                       of, are(found.interior), classes_in_words(method), count(found.edge), gaps);
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
