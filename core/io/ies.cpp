#include "umbra/core/io/ies.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "umbra/core/io/limits.h"
#include "umbra/core/io/source_text.h"
#include "umbra/core/io/tokens.h"

namespace umbra {
namespace {

constexpr std::size_t kMaxIesFile = std::size_t{4} << 20;  ///< bytes

/// The line that begins at an offset, without what ends it.
std::string_view line_at(const std::string& text, std::size_t begin) {
    std::string_view line = std::string_view(text).substr(begin, text.find('\n', begin) - begin);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
    return line;
}

/// Where the line TILT=... begins.
std::size_t find_tilt(const SourceText& source) {
    for (std::size_t at = 0; at < source.text.size();) {
        if (source.text.compare(at, 5, "TILT=") == 0) return at;
        const std::size_t end = source.text.find('\n', at);
        at                    = end == source.text.npos ? source.text.size() : end + 1;
    }
    source.fail(source.text.size(), "no line begins with TILT=, expected a photometric file after IES LM-63");
}

/// "IESNA:LM-63-2002", "IES:LM-63-2019": their 12th number is reserved. Files of 1986 have no line that says so.
bool reserves_a_factor(const SourceText& source) {
    const std::string_view first = line_at(source.text, 0);
    return first.find("LM-63-2") != first.npos;
}

/// The numbers behind the line TILT=.
class Numbers {
public:
    Numbers(const SourceText& source, std::size_t begin) : source_(source), tokens_(source, begin) {}

    float real(std::string_view what, const Range& range = kAnyNumber) {
        const Token token = tokens_.next();
        const float value = tokens_.as_real(token, what);
        if (!range.holds(value)) tokens_.fail(token, fmt::format("{} is {:g}, expected {}", what, value, range.words));
        return value;
    }
    std::size_t integer(std::string_view what, std::int64_t min, std::int64_t max) {
        const Token token        = tokens_.next();
        const std::int64_t value = tokens_.as_integer(token, what);
        if (value < min || value > max)
            tokens_.fail(token, fmt::format("{} is {}, expected a whole number from {} to {}", what, value, min, max));
        return static_cast<std::size_t>(value);
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
    /// Of the next number, or of the end of the file.
    [[nodiscard]] std::size_t offset() const {
        Tokens ahead = tokens_;
        return ahead.next().offset;
    }
    /// Nothing follows but the mark that ended files under DOS.
    [[nodiscard]] bool at_end() const {
        Tokens ahead     = tokens_;
        const Token next = ahead.next();
        return !next || next.text == "\x1a";
    }

private:
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

/// "TILT=NONE", "TILT=INCLUDE", or refused.
double read_tilt(const SourceText& source, std::size_t at, Numbers& numbers) {
    const std::string_view tilt = line_at(source.text, at);
    if (tilt == "TILT=NONE") return 1;
    if (tilt == "TILT=INCLUDE") return read_tilt(numbers);
    source.fail(at,
                fmt::format("{} names a file of lamp factors, which is not read, expected TILT=NONE or TILT=INCLUDE",
                            in_quotes(tilt)));
}

PhotometricType read_type(Numbers& numbers) {
    constexpr std::array kTypes{PhotometricType::C, PhotometricType::B, PhotometricType::A};  // 1, 2, 3 in files
    return kTypes.at(numbers.integer("the photometric type", 1, kTypes.size()) - 1);
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

Photometry read_ies(const std::filesystem::path& file) {
    SourceText source      = read_text(file, kMaxIesFile);
    const std::size_t tilt = find_tilt(source);
    std::replace(source.text.begin() + static_cast<std::ptrdiff_t>(tilt), source.text.end(), ',', ' ');
    Numbers numbers(source, tilt + line_at(source.text, tilt).size());

    Photometry table;
    double factor = read_tilt(source, tilt, numbers);
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
    (void)numbers.real("the input watts");

    const std::size_t angles = numbers.offset();
    table.vertical           = numbers.list(vertical, "a vertical angle");
    table.horizontal         = numbers.list(horizontal, "a horizontal angle");
    for (std::size_t k = 0; k < vertical * horizontal; ++k)
        table.candela.push_back(
            static_cast<float>(factor * static_cast<double>(numbers.real("a candela value", kNotNegative))));
    if (!numbers.at_end())
        numbers.fail(numbers.offset(), fmt::format("there is more behind the {} candela values of {} vertical and {} "
                                                   "horizontal angles, expected the end of the file",
                                                   table.candela.size(), vertical, horizontal));
    close(table);
    if (const std::string fault = fault_of(table); !fault.empty()) numbers.fail(angles, fault);
    return table;
}

}  // namespace umbra
