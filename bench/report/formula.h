// Formulas as text, for data that states what is expected: "if(c < cos(40), 0, c^8)".
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace umbra {

/// What names stand for, and "pi".
using NamedNumbers = std::map<std::string, double, std::less<>>;

/// As muParser reads them: numbers, names, + - * / and ^ (which binds to the right, and before a sign), < and > (1 where
/// they hold, else 0), brackets; abs, sqrt, exp, floor, min, max, if(condition, then, else); sin, cos, tan, asin, acos
/// and atan of angles in degrees. Throws InputError that names the formula and what is wrong.
[[nodiscard]] double formula_value(std::string_view formula, const NamedNumbers& names);

/// "NAME = FORMULA": sets the name to what the formula gives with those before.
void define(NamedNumbers& names, std::string_view definition);

}  // namespace umbra
