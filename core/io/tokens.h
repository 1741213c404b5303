// The tokens of a text file one after another, each with its offset, and the numbers among them. Internal to core.
#pragma once

#include <cstdint>
#include <string_view>

#include "umbra/core/base/math.h"
#include "umbra/core/io/source_text.h"

namespace umbra {

struct Token {
    std::string_view text;   ///< empty: there was none
    std::size_t offset = 0;  ///< where it begins in the file; where one was missed, if empty
    explicit operator bool() const { return !text.empty(); }
};

/// Tokens are separated by blanks; `#` begins a comment up to the end of its line; a backslash at the end of a line
/// joins the next one to it.
class Tokens {
public:
    /// `source` must outlive this object.
    explicit Tokens(const SourceText& source, std::size_t begin = 0) : source_(source), at_(begin) {}

    Token next();                 ///< across lines; empty at the end of the file
    Token next_on_line();         ///< empty at the end of the line
    Token rest_of_line();         ///< trimmed; stays at the end of the line
    void skip_line();             ///< to the beginning of the next line
    [[nodiscard]] bool at_end();  ///< nothing but blanks and comments follows
    [[nodiscard]] std::size_t offset() const { return at_; }
    [[nodiscard]] std::size_t line();  ///< of offset(), counted from 1; cheap while tokens are read in order

    /// The next token as a number. `what` names it in messages: "the x coordinate". Refused: what is not a number, NaN,
    /// infinity, what lies outside kAnyNumber.
    float real(std::string_view what);
    float real_on_line(std::string_view what);
    vec3 point(std::string_view what);  ///< three numbers, across lines
    vec3 point_on_line(std::string_view what);
    /// The same, but NaN, infinity and any magnitude pass, as in normals of triangles without area (see FileNormals).
    float any_real(std::string_view what);
    vec3 normal();  ///< three numbers, across lines
    vec3 normal_on_line();
    std::int64_t integer(std::string_view what);  ///< across lines
    [[nodiscard]] float as_real(Token token, std::string_view what) const;
    [[nodiscard]] std::int64_t as_integer(Token token, std::string_view what) const;

    [[noreturn]] void fail(Token at, std::string_view message) const { source_.fail(at.offset, message); }

private:
    Token read(bool across_lines);
    [[nodiscard]] double as_double(Token token, std::string_view what) const;

    const SourceText& source_;
    std::size_t at_;
    std::size_t counted_to_ = 0;
    std::size_t line_       = 1;
};

/// A token as messages show it: in quotes, cut where it is long, control characters replaced.
[[nodiscard]] std::string in_quotes(std::string_view token);

}  // namespace umbra
