#include "umbra/core/io/source_text.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include <fmt/format.h>

#include "umbra/core/base/error.h"

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

}  // namespace

void SourceText::fail(std::size_t offset, std::string_view message) const {
    offset                  = std::min(offset, text.size());
    const std::size_t begin = offset == 0 ? 0 : text.rfind('\n', offset - 1) + 1;  // npos + 1 == 0
    const std::size_t end   = std::min(text.find('\n', begin), text.size());
    const auto line         = 1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(begin), '\n');

    // Columns count characters, not bytes: continuation bytes of UTF-8 begin with the bits 10.
    const auto starts_character = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
    const auto column = 1 + std::count_if(text.begin() + std::ptrdiff_t(begin), text.begin() + std::ptrdiff_t(offset),
                                          starts_character);

    // Of a long line the part around the position is shown; control characters would garble a terminal.
    const std::size_t first = offset - begin > kShown - 30 ? offset - (kShown - 30) : begin;
    std::string shown       = text.substr(first, std::min(end - first, kShown));
    for (char& c : shown)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    while (!shown.empty() && shown.back() == ' ') shown.pop_back();
    const auto before =
        std::count_if(text.begin() + std::ptrdiff_t(first), text.begin() + std::ptrdiff_t(offset), starts_character);
    const std::string number = std::to_string(line);
    throw InputError(fmt::format("{}:{}:{}: {}\n  {} | {}\n  {:{}} | {:{}}^", file, line, column, message, number,
                                 shown, "", number.size(), "", before));
}

SourceText read_text(const std::filesystem::path& file, std::size_t max_bytes) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status))
        throw InputError(fmt::format("{}: no such file{}", file.string(), hint_for_missing(file)));
    if (std::filesystem::is_directory(status))
        throw InputError(fmt::format("{}: is a folder, expected a file", file.string()));

    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(fmt::format("{}: cannot open: {}", file.string(), std::strerror(errno)));
    SourceText source{file.string(), {}};
    // In pieces, since a pipe or a device has no size to ask for.
    std::string piece(std::size_t{1} << 16, '\0');
    while (stream) {
        stream.read(piece.data(), std::streamsize(piece.size()));
        source.text.append(piece, 0, std::size_t(stream.gcount()));
        if (source.text.size() > max_bytes)
            throw InputError(
                fmt::format("{}: larger than {} MB (no file of this kind should be)", file.string(), max_bytes >> 20));
    }
    if (stream.bad()) throw InputError(fmt::format("{}: cannot read: {}", file.string(), std::strerror(errno)));
    return source;
}

}  // namespace umbra
