#include "umbra/core/io/ies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "umbra/core/base/paths.h"
#include "umbra/core/base/trimmed.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/source_text.h"
#include "umbra/core/io/tokens.h"

namespace umbra {
namespace {

constexpr std::size_t kMaxIesFile = std::size_t{4} << 20;  ///< bytes

/// The line TILT=..., in any case, with blanks anywhere.
struct TiltLine {
    std::size_t at = 0, end = 0;  ///< of the line
    std::string_view value;       ///< behind the =
};

TiltLine find_tilt(const SourceText& source) {
    for (std::size_t at = 0; at < source.text.size();) {
        const std::size_t end       = line_end(source.text, at);
        const std::string_view line = trimmed(std::string_view(source.text).substr(at, end - at));
        if (lowered(line.substr(0, 4)) == "tilt")
            if (const std::string_view rest = trimmed(line.substr(4)); rest.starts_with('='))
                return {at, end, trimmed(rest.substr(1))};
        at = end + 1;
    }
    source.fail(source.text.size(), "no line begins with TILT=, expected a photometric file after IES LM-63");
}

/// "IESNA:LM-63-2002", "IES:LM-63-2019": their 12th number is reserved. Files of 1986 have no line that says so.
bool reserves_a_factor(const SourceText& source) {
    return std::string_view(source.text).substr(0, line_end(source.text, 0)).find("LM-63-2") != std::string_view::npos;
}

/// The numbers behind the line TILT=.
class Numbers {
public:
    Numbers(const SourceText& source, std::size_t begin) : source_(source), tokens_(source, begin, true) {}

    float real(std::string_view what, const Range& range = kAnyNumber) {
        const Token token = tokens_.next();
        const float value = tokens_.as_real(token, what);
        if (!range.holds(value)) tokens_.fail(token, fmt::format("{} is {:g}, expected {}", what, value, range.words));
        return value;
    }
    /// 4.0 is 4.
    std::size_t integer(std::string_view what, std::int64_t min, std::int64_t max) {
        const Token token = tokens_.next();
        if (token.text.find('.') == token.text.npos)
            return in_range(token, tokens_.as_integer(token, what), what, min, max);
        const float value = tokens_.as_real(token, what);
        if (value != std::floor(value)) (void)tokens_.as_integer(token, what);  // says what is wrong
        return in_range(token, static_cast<std::int64_t>(value), what, min, max);
    }
    /// How many numbers follow, one or more: no more than the rest of the file has room for.
    std::size_t count(std::string_view what) {
        const auto room = static_cast<std::int64_t>(source_.text.size() - tokens_.offset()) / 2 + 1;
        return integer(what, 1, std::max<std::int64_t>(room, 1));
    }
    std::vector<float> list(std::size_t n, std::string_view what, const Range& range = kAnyNumber) {
        std::vector<float> numbers;
        for (std::size_t k = 0; k < n; ++k) numbers.push_back(real(what, range));
        return numbers;
    }
    [[noreturn]] void fail(std::size_t offset, std::string_view message) const { source_.fail(offset, message); }
    /// Position of the next number, or of the end of the file.
    [[nodiscard]] std::size_t offset() const {
        Tokens ahead = tokens_;
        return ahead.next().offset;
    }
    [[nodiscard]] Token ahead() const { return Tokens(tokens_).next(); }
    [[nodiscard]] bool on_this_line() const { return bool(Tokens(tokens_).next_on_line()); }  ///< anything follows
    /// Words that follow; on the next line that has any.
    [[nodiscard]] std::size_t words() const {
        Tokens ahead  = tokens_;
        std::size_t n = 0;
        for (Token word = ahead.next(); word && word.text != kEndUnderDos; word = ahead.next()) ++n;
        return n;
    }
    [[nodiscard]] std::size_t words_of_next_line() const {
        Tokens ahead  = tokens_;
        std::size_t n = bool(ahead.next());
        while (ahead.next_on_line()) ++n;
        return n;
    }
    void skip() { (void)tokens_.next(); }

private:
    std::size_t in_range(Token token, std::int64_t value, std::string_view what, std::int64_t min,
                         std::int64_t max) const {
        if (value < min || value > max)
            tokens_.fail(token, fmt::format("{} is {}, expected a whole number from {} to {}", what, value, min, max));
        return static_cast<std::size_t>(value);
    }

    static constexpr std::string_view kEndUnderDos = "\x1a";
    const SourceText& source_;
    Tokens tokens_;
};

/// The factor of TILT=INCLUDE for a luminaire that is not tilted.
double read_tilt(Numbers& numbers) {
    (void)numbers.integer("the lamp's position in the luminaire", 1, 3);
    const std::size_t n             = numbers.count("the number of tilt angles");
    const std::size_t at            = numbers.offset();
    const std::vector<float> angles = numbers.list(n, "a tilt angle", {0, 180, "an angle from 0 to 180 degrees"});
    if (angles[0] != 0 || !std::is_sorted(angles.begin(), angles.end()))
        numbers.fail(at, "the tilt angles do not increase from 0");
    return static_cast<double>(numbers.list(n, "a factor of a tilt angle", kNotNegative)[0]);
}

/// The factor of TILT=NONE, =INCLUDE, or of the file that it names, which lies beside `file`.
double read_tilt(const std::filesystem::path& file, const TiltLine& tilt, Numbers& numbers,
                 std::vector<std::string>& warnings) {
    const std::string value = lowered(tilt.value);
    if (value == "none") return 1;
    if (value == "include") return read_tilt(numbers);
    if (value.empty()) {
        warnings.push_back(fmt::format("{}: TILT= names nothing: TILT=NONE is assumed.", file.string()));
        return 1;
    }
    std::string name(tilt.value);
    std::replace(name.begin(), name.end(), '\\', '/');
    const auto factors = file.parent_path() / std::filesystem::path(name).filename();
    if (is_file(factors)) {
        const SourceText source = read_text(factors, kMaxIesFile);
        Numbers of_file(source, 0);
        return read_tilt(of_file);
    }
    warnings.push_back(fmt::format("{}: the file {} of lamp factors does not exist: 1 is assumed.", file.string(),
                                   in_quotes(tilt.value)));
    return 1;
}

PhotometricType read_type(Numbers& numbers) {
    const std::string letter = lowered(numbers.ahead().text);
    for (const auto& [name, type] :
         {std::pair{"a", PhotometricType::A}, {"b", PhotometricType::B}, {"c", PhotometricType::C}})
        if (letter == name) return numbers.skip(), type;
    constexpr std::array kTypes{PhotometricType::C, PhotometricType::B, PhotometricType::A};  // 1, 2, 3 in files
    return kTypes.at(numbers.integer("the photometric type", 1, kTypes.size()) - 1);
}

/// Whether the input watts are there, which some files leave out: on the line of the factors before them, or in front
/// of the angles and values.
bool has_watts(const Numbers& numbers, std::size_t vertical, std::size_t horizontal) {
    if (numbers.on_this_line()) return true;
    const bool is_row_of_angles = vertical > 1 && numbers.words_of_next_line() == vertical;
    return !is_row_of_angles && numbers.words() != vertical + horizontal + vertical * horizontal;
}

/// Planes that go round without closing are closed.
void close(Photometry& table) {
    if (table.type != PhotometricType::C || table.horizontal.front() != 0) return;
    if (!(table.horizontal.back() > 180 && table.horizontal.back() < 360)) return;
    table.horizontal.push_back(360);
    const std::vector<float> first(table.candela.begin(),
                                   table.candela.begin() + static_cast<std::ptrdiff_t>(table.vertical.size()));
    table.candela.insert(table.candela.end(), first.begin(), first.end());
}

}  // namespace

Photometry read_ies(const std::filesystem::path& file, std::vector<std::string>& warnings) {
    const SourceText source = read_text(file, kMaxIesFile);
    const TiltLine tilt     = find_tilt(source);
    Numbers numbers(source, tilt.end);
    const auto warn = [&](const std::string& sentence) {
        warnings.push_back(fmt::format("{}: {}", file.string(), sentence));
    };

    Photometry table;
    double factor = read_tilt(file, tilt, numbers, warnings);
    (void)numbers.real("the number of lamps", kNotNegative);
    (void)numbers.real("the lumens of a lamp");  // -1: the candela values are absolute
    factor *= static_cast<double>(numbers.real("the candela multiplier", kPositive));
    const std::size_t vertical   = numbers.count("the number of vertical angles");
    const std::size_t horizontal = numbers.count("the number of horizontal angles");
    table.type                   = read_type(numbers);
    (void)numbers.integer("the unit of lengths", 1, 2);
    for (const std::string_view side : {"width", "length", "height"})
        (void)numbers.real(fmt::format("the luminaire's {}", side));  // negative: round
    factor *= static_cast<double>(numbers.real("the ballast factor", kPositive));
    const auto reserved = static_cast<double>(numbers.real("the ballast-lamp photometric factor", kPositive));
    if (!reserves_a_factor(source)) factor *= reserved;
    if (has_watts(numbers, vertical, horizontal))
        (void)numbers.real("the input watts");
    else
        warn("the input watts are left out.");

    const std::size_t angles = numbers.offset();
    table.vertical           = numbers.list(vertical, "a vertical angle");
    table.horizontal         = numbers.list(horizontal, "a horizontal angle");
    std::size_t negative     = 0;
    for (std::size_t k = 0; k < vertical * horizontal; ++k) {
        const auto candela = static_cast<double>(numbers.real("a candela value"));
        negative += candela < 0;
        table.candela.push_back(static_cast<float>(factor * std::max(candela, 0.0)));
    }
    if (negative > 0) warn(fmt::format("{} candela values are negative: they are taken as 0.", negative));
    if (const std::size_t words = numbers.words(); words > 0)
        warn(fmt::format("{} words behind the {} candela values of {} vertical and {} horizontal angles are ignored.",
                         words, table.candela.size(), vertical, horizontal));
    if (table.type == PhotometricType::C && horizontal == 1 && table.horizontal[0] != 0) {
        warn(fmt::format("the only horizontal angle is {:g}: it is taken as 0, the same all around.",
                         table.horizontal[0]));
        table.horizontal[0] = 0;
    }
    close(table);
    if (const std::string fault = fault_of(table); !fault.empty()) numbers.fail(angles, fault);
    return table;
}

}  // namespace umbra
