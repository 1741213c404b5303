#include "umbra/bench/report/formula.h"

#include <fmt/format.h>
#include <muParser.h>

#include <cmath>
#include <numbers>

#include "umbra/core/base/error.h"

namespace umbra {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// A parser that knows the functions of formula.h and no others.
mu::Parser parser_of_formulas() {
    mu::Parser parser;
    parser.ClearFun();
    parser.ClearConst();
    const auto add = [&](const char* name, double (*value)(double)) { parser.DefineFun(name, value); };
    add("abs", [](double a) { return std::abs(a); });
    add("sqrt", [](double a) { return std::sqrt(a); });
    add("exp", [](double a) { return std::exp(a); });
    add("floor", [](double a) { return std::floor(a); });
    add("sin", [](double a) { return std::sin(a * kDegree); });
    add("cos", [](double a) { return std::cos(a * kDegree); });
    add("tan", [](double a) { return std::tan(a * kDegree); });
    add("asin", [](double a) { return std::asin(a) / kDegree; });
    add("acos", [](double a) { return std::acos(a) / kDegree; });
    add("atan", [](double a) { return std::atan(a) / kDegree; });
    parser.DefineFun(
        "min", +[](double a, double b) { return std::fmin(a, b); });
    parser.DefineFun(
        "max", +[](double a, double b) { return std::fmax(a, b); });
    parser.DefineFun(
        "if", +[](double holds, double a, double b) { return holds != 0 ? a : b; });
    parser.DefineConst("pi", std::numbers::pi);
    return parser;
}

}  // namespace

double formula_value(std::string_view formula, const NamedNumbers& names) {
    static const mu::Parser functions = parser_of_formulas();
    try {
        mu::Parser parser = functions;
        for (const auto& [name, value] : names) parser.DefineConst(name, value);
        parser.SetExpr(std::string(formula));
        return parser.Eval();
    } catch (const mu::Parser::exception_type& e) {
        throw InputError(fmt::format("formula \"{}\": {}", formula, e.GetMsg()));
    }
}

void define(NamedNumbers& names, std::string_view definition) {
    const std::size_t equals = definition.find(" = ");
    if (equals == std::string_view::npos)
        throw InputError(fmt::format("definition \"{}\": expected NAME = FORMULA", definition));
    names.insert_or_assign(std::string(definition.substr(0, equals)),
                           formula_value(definition.substr(equals + 3), names));
}

}  // namespace umbra
