#include "umbra/core/image/image_headers.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>

#include "umbra/core/base/bytes.h"

namespace umbra {
namespace {

/// A file read in order, with its size known.
class HeaderFile {
public:
    explicit HeaderFile(const std::filesystem::path& file)
        : in_(file, std::ios::binary), left_(std::filesystem::file_size(file)) {}

    [[nodiscard]] std::uint64_t left() const { return left_; }
    bool skip(std::uint64_t n) {
        if (n > left_) return false;
        in_.seekg(std::streamoff(n), std::ios::cur);
        left_ -= n;
        return bool(in_);
    }
    bool read(char* to, std::size_t n) {
        if (n > left_) return false;
        in_.read(to, std::streamsize(n));
        left_ -= n;
        return bool(in_);
    }
    /// Up to and without the next 0. False at the end of the file, or if there is none near.
    bool read_text(std::string& text) {
        text.clear();
        for (char c = 0; text.size() < 256 && read(&c, 1);) {
            if (c == 0) return true;
            text += c;
        }
        return false;
    }

private:
    std::ifstream in_;
    std::uint64_t left_;
};

std::uint32_t big_endian(const char* bytes) { return load_number<std::uint32_t>(bytes, std::endian::big); }
std::uint32_t little_endian(const char* bytes) { return load_number<std::uint32_t>(bytes); }

constexpr const char* kEndsInHeader = "the file ends in its header";

/// After the signature: length, four letters, data, CRC; IHDR first.
std::string check_png(HeaderFile& bytes) {
    const std::uint64_t size = bytes.left();
    while (bytes.left() > 0) {
        std::array<char, 8> head{};
        if (!bytes.read(head.data(), head.size())) return kEndsInHeader;
        const std::uint32_t length = big_endian(head.data());
        const std::string_view kind(head.data() + 4, 4);
        if (std::uint64_t(length) + 4 > bytes.left())
            return fmt::format("a chunk claims {} bytes, and {} are left in the file", length, bytes.left());
        if (kind == "IEND") break;
        if (kind != "IHDR" || length != 13) {
            if (!bytes.skip(std::uint64_t(length) + 4)) return kEndsInHeader;
            continue;
        }
        std::array<char, 17> header{};  // width, height, bits, colour type, compression, filter, interlace; CRC
        if (!bytes.read(header.data(), header.size())) return kEndsInHeader;
        const double width    = big_endian(header.data());
        const double height   = big_endian(header.data() + 4);
        const double channels = header[9] == 2 ? 3 : header[9] == 4 ? 2 : header[9] == 6 ? 4 : 1;
        // Deflate shrinks by at most 1032.
        if (width * height * channels * header[8] / 8 > 1032.0 * double(size))
            return fmt::format("claims {}x{} pixels, more than its {} bytes can hold", width, height, size);
    }
    return {};
}

/// After the magic number: version and flags, then attributes (name 0, type 0, length, data) up to an empty name.
std::string check_exr(HeaderFile& bytes) {
    if (!bytes.skip(4)) return kEndsInHeader;
    std::string name, type;
    for (;;) {
        if (!bytes.read_text(name)) return kEndsInHeader;
        if (name.empty())
            return {};  // of several parts the first is read, and the library checks that the rest are there
        std::array<char, 4> word{};
        if (!bytes.read_text(type) || !bytes.read(word.data(), word.size())) return kEndsInHeader;
        const std::uint32_t length = little_endian(word.data());
        if (length > bytes.left())
            return fmt::format("attribute {} claims {} bytes, and {} are left in the file", name, length, bytes.left());
        if (type == "box2i" && length == 16) {
            std::array<char, 16> box{};
            if (!bytes.read(box.data(), box.size())) return kEndsInHeader;
            for (int k = 0; k < 2; ++k) {
                const auto min = std::int32_t(little_endian(box.data() + 4 * k));
                const auto max = std::int32_t(little_endian(box.data() + 8 + 4 * k));
                if (std::int64_t(max) - min >= kMaxFileSide)
                    return fmt::format("{} claims {} pixels along a side (at most {})", name,
                                       std::int64_t(max) - min + 1, kMaxFileSide);
            }
        } else if (type == "tiledesc" && length == 9) {
            std::array<char, 9> tile{};
            if (!bytes.read(tile.data(), tile.size())) return kEndsInHeader;
            const std::uint32_t width  = little_endian(tile.data());
            const std::uint32_t height = little_endian(tile.data() + 4);
            if (std::uint64_t(width) * height > 1u << 24)
                return fmt::format("claims tiles of {}x{} pixels (at most 16 million)", width, height);
        } else if (!bytes.skip(length)) {
            return kEndsInHeader;
        }
    }
}

}  // namespace

std::string find_false_claim(const std::filesystem::path& file) {
    HeaderFile bytes(file);
    std::array<char, 8> magic{};
    if (!bytes.read(magic.data(), 4)) return {};
    if (std::string_view(magic.data(), 4) == "\x76\x2f\x31\x01") return check_exr(bytes);
    if (std::string_view(magic.data(), 4) == "\x89PNG" && bytes.skip(4)) return check_png(bytes);
    return {};
}

}  // namespace umbra
