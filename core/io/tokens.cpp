#include "umbra/core/io/tokens.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "umbra/core/io/limits.h"

namespace umbra {
namespace {

// from_chars accepts no leading plus, which C's printf writes with "%+g".
std::string_view without_plus(std::string_view s) {
    return s.size() > 1 && s[0] == '+' && s[1] != '-' ? s.substr(1) : s;
}

/// Infinity and NaN as older C libraries of Windows print them: 1.#INF, -1.#IND, 1.#QNAN0, with as many digits as were
/// asked for.
std::optional<double> not_finite(std::string_view s) {
    const bool negative = s.starts_with('-');
    if (negative || s.starts_with('+')) s.remove_prefix(1);
    if (s.starts_with("1.#INF")) return negative ? -HUGE_VAL : HUGE_VAL;
    if (s.starts_with("1.#IND") || s.starts_with("1.#QNAN") || s.starts_with("1.#SNAN")) return std::nan("");
    return std::nullopt;
}

}  // namespace

std::string in_quotes(std::string_view token) {
    constexpr std::size_t kShown = 40;
    std::string shown(token.substr(0, kShown));
    for (char& c : shown)
        if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
    return fmt::format("\"{}{}\"", shown, token.size() > kShown ? "..." : "");
}

std::string lowered(std::string_view text) {
    std::string small(text);
    for (char& c : small)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return small;
}

Tokens::Tokens(const SourceText& source, std::size_t begin, bool commas)
    : source_(source), at_(begin), commas_(commas && source.text.find(',') != source.text.npos) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (begin != 0) return;
    if (source.text.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
    if (source.text.starts_with("\xff\xfe") || source.text.starts_with("\xfe\xff"))
        source.fail(0, "the file is in UTF-16, expected UTF-8 or ASCII");
}

bool Tokens::is_blank(char c) const {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || (commas_ && c == ',');
}

Token Tokens::read(bool across_lines) {
    const std::string& text = source_.text;
    while (at_ < text.size()) {
        const char c = text[at_];
        if (c == '\\') {
            std::size_t after = at_ + 1;
            if (after < text.size() && text[after] == '\r' && !ends_line(text, after)) ++after;
            if (after >= text.size() || !ends_line(text, after)) break;  // a backslash within a token, as in a path
            at_ = after + 1;
        } else if (c == '#') {
            at_ = line_end(text, at_);
        } else if (ends_line(text, at_)) {
            if (!across_lines) break;
            ++at_;
        } else if (is_blank(c)) {
            ++at_;
        } else {
            break;
        }
    }
    const std::size_t begin = at_;
    while (at_ < text.size() && !is_blank(text[at_]) && text[at_] != '\n') {
        if (text[at_] == '#' && !not_finite(std::string_view(text).substr(begin, at_ + 5 - begin))) break;
        if (text[at_] == '\\' && at_ + 1 < text.size() && (text[at_ + 1] == '\n' || text[at_ + 1] == '\r')) break;
        ++at_;
    }
    return {std::string_view(text).substr(begin, at_ - begin), begin};
}

Token Tokens::next() { return read(true); }
Token Tokens::next_on_line() { return read(false); }

Token Tokens::rest_of_line() {
    const std::string& text = source_.text;
    const std::size_t stop  = line_end(text, at_);
    while (at_ < stop && is_blank(text[at_])) ++at_;
    const std::size_t begin = at_;
    std::size_t end         = stop;
    while (end > begin && is_blank(text[end - 1])) --end;
    at_ = stop;
    return {std::string_view(text).substr(begin, end - begin), begin};
}

void Tokens::skip_line() {
    while (read(false)) {
    }
    if (at_ < source_.text.size()) ++at_;
}

bool Tokens::at_end() {
    const std::size_t before = at_;
    const bool none          = !read(true);
    at_                      = before;
    return none;
}

std::size_t Tokens::line() {
    if (counted_to_ > at_) counted_to_ = 0, line_ = 1;
    for (; counted_to_ < at_; ++counted_to_) line_ += ends_line(source_.text, counted_to_);
    return line_;
}

double Tokens::as_double(Token token, std::string_view what) const {
    if (!token) fail(token, fmt::format("{} is missing, expected a number", what));
    const std::string_view s = without_plus(token.text);
    double value             = 0;
    const auto [end, error]  = std::from_chars(s.data(), s.data() + s.size(), value);
    const bool whole         = end == s.data() + s.size();
    if (whole && error == std::errc::result_out_of_range) {
        // Too large, or too near to zero? The library does not say, and leaves `value` as it was.
        const std::size_t digit    = s.find_first_not_of("+-");
        const std::size_t exponent = s.find_first_of("eE");
        const bool tiny =
            exponent != s.npos ? s.substr(exponent + 1).starts_with('-') : s[digit] == '0' || s[digit] == '.';
        return tiny ? 0.0 : HUGE_VAL;
    }
    if (whole && error == std::errc()) return value;
    if (const std::optional<double> odd = not_finite(token.text)) return *odd;
    fail(token, fmt::format("{} is {}, expected a number", what, in_quotes(token.text)));
}

double Tokens::as_number(Token token, std::string_view what) const {
    const double value = as_double(token, what);
    if (!kAnyNumber.holds(value))
        fail(token, fmt::format("{} is {}, expected {}", what, in_quotes(token.text), kAnyNumber.words));
    return value;
}
float Tokens::as_real(Token token, std::string_view what) const { return static_cast<float>(as_number(token, what)); }

std::int64_t Tokens::as_integer(Token token, std::string_view what) const {
    if (!token) fail(token, fmt::format("{} is missing, expected a whole number", what));
    const std::string_view s = without_plus(token.text);
    std::int64_t value       = 0;
    const auto [end, error]  = std::from_chars(s.data(), s.data() + s.size(), value);
    if (end != s.data() + s.size() || error != std::errc())
        fail(token, fmt::format("{} is {}, expected a whole number", what, in_quotes(token.text)));
    return value;
}

float Tokens::real(std::string_view what) { return as_real(next(), what); }
float Tokens::real_on_line(std::string_view what) { return as_real(next_on_line(), what); }
std::int64_t Tokens::integer(std::string_view what) { return as_integer(next(), what); }

dvec3 Tokens::point(std::string_view what) {
    const double x = as_number(next(), what), y = as_number(next(), what), z = as_number(next(), what);
    return {x, y, z};
}

dvec3 Tokens::point_on_line(std::string_view what) {
    const auto coordinate = [&] { return as_number(next_on_line(), what); };
    const double x = coordinate(), y = coordinate(), z = coordinate();
    return {x, y, z};
}

float Tokens::as_any_real(Token token, std::string_view what) const {
    return static_cast<float>(as_double(token, what));
}
float Tokens::any_real(std::string_view what) { return as_any_real(next(), what); }

vec3 Tokens::normal() {
    constexpr std::string_view what = "a component of a normal";
    const float x = any_real(what), y = any_real(what), z = any_real(what);
    return {x, y, z};
}

vec3 Tokens::normal_on_line() {
    constexpr std::string_view what = "a component of a normal";
    const auto component            = [&] { return as_any_real(next_on_line(), what); };
    const float x = component(), y = component(), z = component();
    return {x, y, z};
}

void Tokens::refuse_decimal_commas(std::string_view what) const {
    if (!commas_) return;
    const std::size_t end = line_end(source_.text, at_);
    if (std::string_view(source_.text).substr(at_, end - at_).find(',') == std::string_view::npos) return;
    Tokens words(source_, at_);
    Token decimal, before;
    bool by_blanks = false;  // some blank has no comma beside it
    while (const Token word = words.next_on_line()) {
        const std::size_t comma = word.text.find(',');
        const auto is_digit     = [&](std::size_t k) { return word.text[k] >= '0' && word.text[k] <= '9'; };
        if (comma != word.text.npos && comma > 0 && comma + 1 < word.text.size() && is_digit(comma - 1) &&
            is_digit(comma + 1) && !decimal)
            decimal = word;
        if (before && !before.text.ends_with(',') && !word.text.starts_with(',')) by_blanks = true;
        before = word;
    }
    if (decimal && by_blanks)
        fail(decimal, fmt::format("{} is {}, expected a number with a decimal point", what, in_quotes(decimal.text)));
}

}  // namespace umbra
