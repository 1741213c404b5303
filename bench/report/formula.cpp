#include "umbra/bench/report/formula.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "umbra/core/base/error.h"

namespace umbra {
namespace {

using Arguments = std::vector<double>;

struct NamedFunction {
    std::string_view name;
    std::size_t arguments;
    double (*value)(const Arguments&);
};

constexpr double kDegree = std::numbers::pi / 180;

constexpr NamedFunction kNamedFunctions[] = {{"abs", 1, [](const Arguments& a) { return std::abs(a[0]); }},
                                             {"sqrt", 1, [](const Arguments& a) { return std::sqrt(a[0]); }},
                                             {"exp", 1, [](const Arguments& a) { return std::exp(a[0]); }},
                                             {"floor", 1, [](const Arguments& a) { return std::floor(a[0]); }},
                                             {"sin", 1, [](const Arguments& a) { return std::sin(a[0] * kDegree); }},
                                             {"cos", 1, [](const Arguments& a) { return std::cos(a[0] * kDegree); }},
                                             {"tan", 1, [](const Arguments& a) { return std::tan(a[0] * kDegree); }},
                                             {"asin", 1, [](const Arguments& a) { return std::asin(a[0]) / kDegree; }},
                                             {"acos", 1, [](const Arguments& a) { return std::acos(a[0]) / kDegree; }},
                                             {"atan", 1, [](const Arguments& a) { return std::atan(a[0]) / kDegree; }},
                                             {"min", 2, [](const Arguments& a) { return std::min(a[0], a[1]); }},
                                             {"max", 2, [](const Arguments& a) { return std::max(a[0], a[1]); }},
                                             {"if", 3, [](const Arguments& a) { return a[0] != 0 ? a[1] : a[2]; }}};

/// Recursive descent: comparison < sum < product < signed < power < operand.
class FormulaReader {
public:
    FormulaReader(std::string_view text, const NamedNumbers& names) : text_(text), names_(names) {}

    double whole() {
        const double value = comparison();
        if (next() != '\0') refuse("an operator or the end");
        return value;
    }

private:
    [[noreturn]] void refuse(std::string_view expected) const {
        throw InputError(fmt::format("formula \"{}\", position {}: expected {}", text_, at_ + 1, expected));
    }
    char next() {
        while (at_ < text_.size() && text_[at_] == ' ') ++at_;
        return at_ < text_.size() ? text_[at_] : '\0';
    }
    bool take(char c) {
        if (next() != c) return false;
        ++at_;
        return true;
    }
    double comparison() {
        const double left = sum();
        if (take('<')) return left < sum() ? 1 : 0;
        if (take('>')) return left > sum() ? 1 : 0;
        return left;
    }
    double sum() {
        double value = product();
        for (;;) {
            if (take('+'))
                value += product();
            else if (take('-'))
                value -= product();
            else
                return value;
        }
    }
    double product() {
        double value = with_sign();
        for (;;) {
            if (take('*'))
                value *= with_sign();
            else if (take('/'))
                value /= with_sign();
            else
                return value;
        }
    }
    double with_sign() { return take('-') ? -with_sign() : power(); }
    double power() {
        const double base = operand();
        return take('^') ? std::pow(base, with_sign()) : base;
    }
    double operand() {
        if (take('(')) {
            const double value = comparison();
            if (!take(')')) refuse("\")\"");
            return value;
        }
        if (std::isdigit(static_cast<unsigned char>(next())) != 0) {
            double value    = 0;
            const auto read = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
            at_             = static_cast<std::size_t>(read.ptr - text_.data());
            return value;
        }
        const std::size_t begin = at_;
        while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_'))
            ++at_;
        const std::string_view name = text_.substr(begin, at_ - begin);
        if (take('(')) return call(name);
        if (name == "pi") return std::numbers::pi;
        const auto found = names_.find(name);
        if (found == names_.end()) refuse("a number, a name that has a value, or a function");
        return found->second;
    }
    double call(std::string_view name) {
        const auto* const function = std::ranges::find(kNamedFunctions, name, &NamedFunction::name);
        if (function == std::end(kNamedFunctions)) refuse("the arguments of a known function");
        Arguments arguments;
        do arguments.push_back(comparison());
        while (take(','));
        if (!take(')') || arguments.size() != function->arguments)
            refuse(fmt::format("{} arguments and \")\"", function->arguments));
        return function->value(arguments);
    }

    std::string_view text_;
    const NamedNumbers& names_;
    std::size_t at_ = 0;
};

}  // namespace

double formula_value(std::string_view formula, const NamedNumbers& names) {
    return FormulaReader(formula, names).whole();
}

void define(NamedNumbers& names, std::string_view definition) {
    const std::size_t equals = definition.find(" = ");
    if (equals == std::string_view::npos)
        throw InputError(fmt::format("definition \"{}\": expected NAME = FORMULA", definition));
    names.insert_or_assign(std::string(definition.substr(0, equals)),
                           formula_value(definition.substr(equals + 3), names));
}

}  // namespace umbra
