#include "umbra/core/io/source_text.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/utf8.h"

namespace umbra {
namespace {

constexpr std::size_t kShown = 100;  // columns of a line that a message shows; a line may be megabytes long

// Meshes that no package of the project holds are obtained at set-up. Their absence has one usual reason.
std::string_view hint_for_missing(const std::filesystem::path& file) {
    std::error_code error;
    const auto folder = std::filesystem::absolute(file, error).lexically_normal().parent_path();
    return folder.filename() == "real" && folder.parent_path().filename() == "scenes"
               ? " (real meshes are obtained at set-up: run `./umbra setup`)"
               : "";
}

std::string_view name_of_kind(std::filesystem::file_type type) {
    switch (type) {
        case std::filesystem::file_type::directory: return "a folder";
        case std::filesystem::file_type::fifo: return "a pipe";
        case std::filesystem::file_type::socket: return "a socket";
        case std::filesystem::file_type::block:
        case std::filesystem::file_type::character: return "a device";
        default: return "no file with bytes of its own";
    }
}

// Text for a terminal and a JSON file: a blank for each control character, a question mark for each byte that is not
// UTF-8.
std::string printable(std::string_view text) {
    std::string shown;
    for (std::size_t k = 0; k < text.size();) {
        const std::size_t bytes = utf8_length(text, k);
        const auto c            = static_cast<unsigned char>(text[k]);
        const bool is_control =
            c < 0x20 || c == 0x7f || (c == 0xc2 && bytes == 2 && static_cast<unsigned char>(text[k + 1]) < 0xa0);
        shown += bytes == 0 ? "?" : is_control ? " " : text.substr(k, bytes);
        k += std::max<std::size_t>(bytes, 1);
    }
    return shown;
}

}  // namespace

void SourceText::fail(std::size_t offset, std::string_view message) const {
    offset            = std::min(offset, text.size());
    std::size_t begin = offset;
    while (begin > 0 && !ends_line(text, begin - 1)) --begin;
    const std::size_t end = line_end(text, offset);
    std::size_t line      = 1;
    for (std::size_t k = 0; k < begin; ++k) line += ends_line(text, k);

    // Columns count characters, not bytes: continuation bytes of UTF-8 begin with the bits 10.
    const auto starts_character = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
    const auto column = 1 + std::count_if(text.begin() + std::ptrdiff_t(begin), text.begin() + std::ptrdiff_t(offset),
                                          starts_character);

    // A long line is shown in part, around the position, from a whole character to a whole one.
    std::size_t first = offset - begin > kShown - 30 ? offset - (kShown - 30) : begin;
    while (first < offset && !starts_character(text[first])) ++first;
    std::size_t last = std::min(end, first + kShown);
    while (last < end && last > offset && !starts_character(text[last])) --last;
    std::string shown = printable(std::string_view(text).substr(first, last - first));
    while (!shown.empty() && shown.back() == ' ') shown.pop_back();
    const std::string ahead  = printable(std::string_view(text).substr(first, offset - first));
    const auto before        = std::count_if(ahead.begin(), ahead.end(), starts_character);
    const std::string number = std::to_string(line);
    throw InputError(fmt::format("{}:{}:{}: {}\n  {} | {}\n  {:{}} | {:{}}^", file, line, column, message, number,
                                 shown, "", number.size(), "", before));
}

SourceText read_text(const std::filesystem::path& file, std::size_t max_bytes) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status))
        throw InputError(fmt::format("{}: no such file{}", file.string(), hint_for_missing(file)));
    // Reading from a pipe or a device may have no end, and opening a pipe waits for whoever writes to it.
    if (!std::filesystem::is_regular_file(status))
        throw InputError(fmt::format("{}: is {}, expected a file", file.string(), name_of_kind(status.type())));
    const auto refuse_size = [&] {
        throw InputError(
            fmt::format("{}: larger than {} MB (no file of this kind should be)", file.string(), max_bytes >> 20));
    };
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error && size > max_bytes) refuse_size();

    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(fmt::format("{}: cannot open: {}", file.string(), std::strerror(errno)));
    SourceText source{file.string(), {}};
    if (!error) source.text.reserve(static_cast<std::size_t>(size));
    // In pieces, since some files of the system have no size to ask for, and others grow.
    std::string piece(std::size_t{1} << 16, '\0');
    while (stream) {
        stream.read(piece.data(), std::streamsize(piece.size()));
        source.text.append(piece, 0, std::size_t(stream.gcount()));
        if (source.text.size() > max_bytes) refuse_size();
    }
    if (stream.bad()) throw InputError(fmt::format("{}: cannot read: {}", file.string(), std::strerror(errno)));
    return source;
}

}  // namespace umbra
