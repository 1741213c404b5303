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

/// Lines end as ends_line() says, and a byte order mark at the beginning of the file is skipped. Tokens are separated
/// by blanks, and by commas where `commas` is set; `#` begins a comment up to the end of its line, but in 1.#IND and
/// its kin; a backslash at the end of a line joins the next one to it.
class Tokens {
public:
    /// `source` must outlive this object.
    explicit Tokens(const SourceText& source, std::size_t begin = 0, bool commas = false);

    Token next();                 ///< across lines; empty at the end of the file
    Token next_on_line();         ///< empty at the end of the line
    Token rest_of_line();         ///< trimmed, with any #, as names have it; stays at the end of the line
    void skip_line();             ///< to the beginning of the next line
    [[nodiscard]] bool at_end();  ///< nothing but blanks and comments follows
    [[nodiscard]] std::size_t offset() const { return at_; }
    [[nodiscard]] std::size_t line();  ///< of offset(), counted from 1; cheap while tokens are read in order

    /// The next token as a number. `what` names it in messages: "the x coordinate". Refused: text that is not a number,
    /// NaN, infinity, and numbers outside kAnyNumber.
    float real(std::string_view what);
    float real_on_line(std::string_view what);
    dvec3 point(std::string_view what);  ///< three numbers, across lines; not rounded to float
    dvec3 point_on_line(std::string_view what);
    /// The same, but NaN, infinity and any magnitude pass, as in normals of triangles without area (see FileNormals).
    float any_real(std::string_view what);
    [[nodiscard]] float as_any_real(Token token, std::string_view what) const;
    vec3 normal();  ///< three numbers, across lines
    vec3 normal_on_line();
    std::int64_t integer(std::string_view what);  ///< across lines
    [[nodiscard]] float as_real(Token token, std::string_view what) const;
    [[nodiscard]] double as_number(Token token, std::string_view what) const;  ///< as_real() before it is rounded
    [[nodiscard]] std::int64_t as_integer(Token token, std::string_view what) const;

    /// Refuses a line on which blanks separate numbers, and a comma lies between two digits of one: a decimal comma.
    void refuse_decimal_commas(std::string_view what) const;

    [[noreturn]] void fail(Token at, std::string_view message) const { source_.fail(at.offset, message); }

private:
    Token read(bool across_lines);
    [[nodiscard]] bool is_blank(char c) const;
    [[nodiscard]] double as_double(Token token, std::string_view what) const;

    const SourceText& source_;
    std::size_t at_;
    bool commas_;
    std::size_t counted_to_ = 0;
    std::size_t line_       = 1;
};

/// A token as messages show it: in quotes, cut where it is long, control characters replaced.
[[nodiscard]] std::string in_quotes(std::string_view token);
/// Letters of ASCII as small ones.
[[nodiscard]] std::string lowered(std::string_view text);

}  // namespace umbra
