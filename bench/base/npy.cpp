#include "umbra/bench/base/npy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <functional>
#include <glm/gtc/packing.hpp>
#include <numeric>
#include <regex>

#include "umbra/core/base/error.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic("\x93NUMPY", 6);
constexpr std::size_t kMaxHeader = 4096;  // NumPy's have 118; a pattern matches within a bounded stack
constexpr std::size_t kMaxItems  = std::size_t{1} << 32;

std::string shape_text(const Shape& shape) {
    return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

/// How one item of the file becomes a float.
struct Type {
    std::size_t size = 0;
    std::function<double(const char*)> read;
};

template <class T>
Type plain() {
    return {sizeof(T), [](const char* bytes) {
                T value;
                std::memcpy(&value, bytes, sizeof value);
                return static_cast<double>(value);
            }};
}

double half(const char* bytes) {
    std::uint16_t bits = 0;
    std::memcpy(&bits, bytes, sizeof bits);
    return static_cast<double>(glm::unpackHalf1x16(bits));
}

/// Nothing where the name is of no simple type.
Type type_of(const std::string& name) {
    static const std::vector<std::pair<std::string, Type>> kTypes{{"f2", {2, half}},
                                                                  {"f4", plain<float>()},
                                                                  {"f8", plain<double>()},
                                                                  {"b1", plain<std::uint8_t>()},
                                                                  {"u1", plain<std::uint8_t>()},
                                                                  {"i1", plain<std::int8_t>()},
                                                                  {"u2", plain<std::uint16_t>()},
                                                                  {"i2", plain<std::int16_t>()},
                                                                  {"u4", plain<std::uint32_t>()},
                                                                  {"i4", plain<std::int32_t>()},
                                                                  {"u8", plain<std::uint64_t>()},
                                                                  {"i8", plain<std::int64_t>()}};
    for (const auto& [known, type] : kTypes)
        if (name.substr(1) == known) {
            if (name[0] != '>' || type.size == 1) return type;
            return {type.size, [inner = type](const char* bytes) {
                        char turned[8];
                        std::reverse_copy(bytes, bytes + inner.size, turned);
                        return inner.read(turned);
                    }};
        }
    return {};
}

struct Header {
    std::string type;
    bool columns_first = false;
    Shape shape;
};

/// The dictionary of a header, as every writer has it: three keys in any order.
Header parse(const std::string& text, const fs::path& file) {
    const auto fail = [&](std::string_view what) {
        return InputError(
            fmt::format("{}: {}, expected a header as NumPy writes it: {{'descr': '<f4', "
                        "'fortran_order': False, 'shape': (360, 640), }}",
                        file.string(), what));
    };
    std::smatch found;
    Header header;
    if (!std::regex_search(text, found, std::regex(R"('descr'\s*:\s*'([<>|=][a-zA-Z]\d+)')")))
        throw fail(text.find("'descr': [") != std::string::npos ? "holds records, not numbers"
                                                                : "the header has no simple 'descr'");
    header.type = found[1];
    if (!std::regex_search(text, found, std::regex(R"('fortran_order'\s*:\s*(True|False))")))
        throw fail("the header has no 'fortran_order'");
    header.columns_first = found[1] == "True";
    if (!std::regex_search(text, found, std::regex(R"('shape'\s*:\s*\(([\d,\sL]*)\))")))
        throw fail("the header has no 'shape'");
    const std::string sides = found[1];
    const std::regex number(R"(\d+)");
    double items = 1;
    for (std::sregex_iterator it(sides.begin(), sides.end(), number), end; it != end; ++it) {
        if (it->length() > 12) throw fail("a side of the array is " + it->str());
        header.shape.push_back(std::stoull(it->str()));
        items *= static_cast<double>(header.shape.back());
    }
    if (items > static_cast<double>(kMaxItems)) throw fail(fmt::format("the array has {:.3g} items", items));
    return header;
}

std::size_t items_of(const Shape& shape) {
    return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

/// Values whose first index changes fastest, in the order in which the last one does.
std::vector<float> rows_first(const std::vector<float>& columns, const Shape& shape) {
    std::vector<float> rows(columns.size());
    Shape index(shape.size(), 0);
    for (float& value : rows) {
        std::size_t at = 0;
        for (std::size_t d = shape.size(); d-- > 0;) at = at * shape[d] + index[d];
        value = columns[at];
        for (std::size_t d = shape.size(); d-- > 0 && ++index[d] == shape[d];) index[d] = 0;
    }
    return rows;
}

}  // namespace

std::string in_words(const Shape& shape) {
    return shape.empty() ? "one number" : fmt::format("{}", fmt::join(shape, " x "));
}

void write_npy(const fs::path& file, std::string_view type, const Shape& shape, std::span<const std::byte> bytes) {
    const std::string quoted = type.starts_with('[') ? std::string(type) : fmt::format("'{}'", type);
    std::string header =
        fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': {}, }}", quoted, shape_text(shape));
    header.append((64 - (kMagic.size() + 4 + header.size() + 1) % 64) % 64, ' ');
    header += '\n';
    std::ofstream out(file, std::ios::binary);
    out << kMagic << '\x01' << '\x00' << static_cast<char>(header.size() & 255) << static_cast<char>(header.size() >> 8)
        << header;
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw InputError(fmt::format("{}: cannot be written", file.string()));
}

Numbers read_npy(const fs::path& file) {
    if (!fs::is_regular_file(file)) throw InputError(fmt::format("{}: is no regular file", file.string()));
    std::ifstream in(file, std::ios::binary);
    std::string start(10, '\0');
    if (!in.read(start.data(), 10) || !start.starts_with(kMagic))
        throw InputError(fmt::format("{}: is no .npy file, which begins with the letters NUMPY", file.string()));
    std::size_t length = static_cast<unsigned char>(start[8]) + 256u * static_cast<unsigned char>(start[9]);
    if (start[6] > 1) {  // versions 2 and 3 have a length of four bytes
        char more[2];
        in.read(more, 2);
        length += (std::size_t{static_cast<unsigned char>(more[0])} << 16) +
                  (std::size_t{static_cast<unsigned char>(more[1])} << 24);
    }
    if (length > kMaxHeader)
        throw InputError(
            fmt::format("{}: has a header of {} bytes, expected at most {}", file.string(), length, kMaxHeader));
    std::string text(length, '\0');
    if (!in.read(text.data(), static_cast<std::streamsize>(length)))
        throw InputError(fmt::format("{}: ends within its header", file.string()));
    const Header header = parse(text, file);
    const Type type     = type_of(header.type);
    if (type.size == 0)
        throw InputError(
            fmt::format("{}: holds items of type {}, expected floats of 2, 4 or 8 bytes, integers or "
                        "booleans",
                        file.string(), header.type));
    const std::size_t items = items_of(header.shape), begin = static_cast<std::size_t>(in.tellg());
    const std::size_t there = fs::file_size(file) - begin;
    if (there != items * type.size)
        throw InputError(fmt::format("{}: holds {} bytes of values, expected {}: {} of type {}", file.string(), there,
                                     items * type.size, in_words(header.shape), header.type));
    std::string bytes(there, '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(there));
    Numbers numbers{header.shape, std::vector<float>(items)};
    for (std::size_t i = 0; i < items; ++i)
        numbers.values[i] = static_cast<float>(type.read(bytes.data() + i * type.size));
    if (header.columns_first) numbers.values = rows_first(numbers.values, numbers.shape);
    return numbers;
}

}  // namespace umbra
