#include "umbra/core/io/tokens.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/limits.h"

namespace umbra {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// from_chars accepts no leading plus, which C's printf writes with "%+g".
std::string_view without_plus(std::string_view s) {
    return s.size() > 1 && s[0] == '+' && s[1] != '-' ? s.substr(1) : s;
}

}  // namespace

std::string in_quotes(std::string_view token) {
    constexpr std::size_t kShown = 40;
    std::string shown(token.substr(0, kShown));
    for (char& c : shown)
        if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
    return fmt::format("\"{}{}\"", shown, token.size() > kShown ? "..." : "");
}

Token Tokens::read(bool across_lines) {
    const std::string& text = source_.text;
    while (at_ < text.size()) {
        const char c = text[at_];
        if (c == '\\') {
            std::size_t after = at_ + 1;
            if (after < text.size() && text[after] == '\r') ++after;
            if (after >= text.size() || text[after] != '\n') break;  // a backslash within a token, as in a path
            at_ = after + 1;
        } else if (c == '#') {
            at_ = std::min(text.find('\n', at_), text.size());
        } else if (is_blank(c) || (c == '\n' && across_lines)) {
            ++at_;
        } else {
            break;
        }
    }
    const std::size_t begin = at_;
    while (at_ < text.size() && !is_blank(text[at_]) && text[at_] != '\n' && text[at_] != '#') {
        if (text[at_] == '\\' && at_ + 1 < text.size() && (text[at_ + 1] == '\n' || text[at_ + 1] == '\r')) break;
        ++at_;
    }
    return {std::string_view(text).substr(begin, at_ - begin), begin};
}

Token Tokens::next() { return read(true); }
Token Tokens::next_on_line() { return read(false); }

Token Tokens::rest_of_line() {
    const Token first       = read(false);
    const std::string& text = source_.text;
    at_                     = std::min({text.find('\n', first.offset), text.find('#', first.offset), text.size()});
    std::size_t end         = at_;
    while (end > first.offset && is_blank(text[end - 1])) --end;
    return {std::string_view(text).substr(first.offset, end - first.offset), first.offset};
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
    const auto begin = source_.text.begin();
    if (counted_to_ > at_) counted_to_ = 0, line_ = 1;
    line_ += std::size_t(std::count(begin + std::ptrdiff_t(counted_to_), begin + std::ptrdiff_t(at_), '\n'));
    counted_to_ = at_;
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
    if (!whole || error != std::errc())
        fail(token, fmt::format("{} is {}, expected a number", what, in_quotes(token.text)));
    return value;
}

float Tokens::as_real(Token token, std::string_view what) const {
    const double value = as_double(token, what);
    if (!kAnyNumber.holds(value))
        fail(token, fmt::format("{} is {}, expected {}", what, in_quotes(token.text), kAnyNumber.words));
    return static_cast<float>(value);
}

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

vec3 Tokens::point(std::string_view what) {
    const float x = real(what), y = real(what), z = real(what);
    return {x, y, z};
}

vec3 Tokens::point_on_line(std::string_view what) {
    const float x = real_on_line(what), y = real_on_line(what), z = real_on_line(what);
    return {x, y, z};
}

float Tokens::any_real(std::string_view what) { return static_cast<float>(as_double(next(), what)); }

vec3 Tokens::normal() {
    constexpr std::string_view what = "a component of a normal";
    const float x = any_real(what), y = any_real(what), z = any_real(what);
    return {x, y, z};
}

vec3 Tokens::normal_on_line() {
    constexpr std::string_view what = "a component of a normal";
    const auto component            = [&] { return static_cast<float>(as_double(next_on_line(), what)); };
    const float x = component(), y = component(), z = component();
    return {x, y, z};
}

}  // namespace umbra
