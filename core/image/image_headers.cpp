#include "umbra/core/image/image_headers.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <utility>

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

/// Sizes of attribute types, bytes. OpenEXR reads that many, whatever length the file states: with another length it
/// reads on in the middle of an attribute and takes the bytes there for the next one's length.
constexpr std::array<std::pair<std::string_view, std::uint32_t>, 24> kSizes{{{"box2f", 16},
                                                                             {"box2i", 16},
                                                                             {"chromaticities", 32},
                                                                             {"compression", 1},
                                                                             {"deepImageState", 1},
                                                                             {"double", 8},
                                                                             {"envmap", 1},
                                                                             {"float", 4},
                                                                             {"int", 4},
                                                                             {"keycode", 28},
                                                                             {"lineOrder", 1},
                                                                             {"m33d", 72},
                                                                             {"m33f", 36},
                                                                             {"m44d", 128},
                                                                             {"m44f", 64},
                                                                             {"rational", 8},
                                                                             {"tiledesc", 9},
                                                                             {"timecode", 8},
                                                                             {"v2d", 16},
                                                                             {"v2f", 8},
                                                                             {"v2i", 8},
                                                                             {"v3d", 24},
                                                                             {"v3f", 12},
                                                                             {"v3i", 12}}};

/// The fault in the data of an attribute, which takes all of its `length` bytes; empty where there is none.
std::string check_exr_data(HeaderFile& bytes, const std::string& name, std::string_view type, std::uint32_t length) {
    const std::uint64_t end = bytes.left() - length;  // the bytes behind it
    const auto misfit       = [&] { return fmt::format("attribute {} is not a {} of {} bytes", name, type, length); };
    if (type == "box2i") {
        std::array<char, 16> box{};
        if (!bytes.read(box.data(), box.size())) return kEndsInHeader;
        for (int k = 0; k < 2; ++k) {
            const auto min = std::int32_t(little_endian(box.data() + 4 * k));
            const auto max = std::int32_t(little_endian(box.data() + 8 + 4 * k));
            if (std::int64_t(max) - min >= kMaxFileSide)
                return fmt::format("{} claims {} pixels along a side (at most {})", name, std::int64_t(max) - min + 1,
                                   kMaxFileSide);
        }
    } else if (type == "tiledesc") {
        std::array<char, 9> tile{};
        if (!bytes.read(tile.data(), tile.size())) return kEndsInHeader;
        const std::uint32_t width = little_endian(tile.data()), height = little_endian(tile.data() + 4);
        if (std::uint64_t(width) * height > 1u << 24)
            return fmt::format("claims tiles of {}x{} pixels (at most 16 million)", width, height);
    } else if (type == "chlist") {
        // Names, each with 16 bytes, up to an empty one: read to there, whatever the length.
        for (std::string channel = "-"; !channel.empty();)
            if (!bytes.read_text(channel) || (!channel.empty() && !bytes.skip(16))) return kEndsInHeader;
        if (bytes.left() != end) return misfit();
    } else if (type == "stringvector") {
        while (bytes.left() > end) {
            std::array<char, 4> size{};
            if (bytes.left() - end < size.size() || !bytes.read(size.data(), size.size())) return misfit();
            if (little_endian(size.data()) > bytes.left() - end) return misfit();
            if (!bytes.skip(little_endian(size.data()))) return kEndsInHeader;
        }
    } else if (type == "preview") {
        std::array<char, 8> size{};
        if (length < size.size() || !bytes.read(size.data(), size.size())) return misfit();
        const double pixels = double(little_endian(size.data())) * double(little_endian(size.data() + 4));
        if (4 * pixels + 8 != double(length)) return misfit();
    }
    return bytes.left() < end || !bytes.skip(bytes.left() - end) ? kEndsInHeader : "";
}

/// After the magic number: version and flags, then attributes (name 0, type 0, length, data) up to an empty name. Files
/// of several parts have several such headers, up to an empty one.
std::string check_exr(HeaderFile& bytes) {
    constexpr std::uint32_t several_parts = 0x1000;
    std::array<char, 4> word{};
    if (!bytes.read(word.data(), word.size())) return kEndsInHeader;
    const bool parts = (little_endian(word.data()) & several_parts) != 0;
    std::string name, type;
    for (bool begins = true;;) {
        if (!bytes.read_text(name)) return kEndsInHeader;
        if (name.empty() && (begins || !parts)) return {};
        begins = name.empty();
        if (begins) continue;
        if (!bytes.read_text(type) || !bytes.read(word.data(), word.size())) return kEndsInHeader;
        const std::uint32_t length = little_endian(word.data());
        if (length > bytes.left())
            return fmt::format("attribute {} claims {} bytes, and {} are left in the file", name, length, bytes.left());
        for (const auto& [of, size] : kSizes)
            if (type == of && length != size)
                return fmt::format("attribute {} claims {} bytes, and a {} has {}", name, length, type, size);
        if (std::string wrong = check_exr_data(bytes, name, type, length); !wrong.empty()) return wrong;
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
