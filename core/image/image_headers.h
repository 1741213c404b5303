// What an image file declares, compared with what it contains, before a decoder believes it.
#pragma once

#include <filesystem>
#include <string>

namespace umbra {

inline constexpr int kMaxFileSide = 1 << 17;

/// Walks the chunks of a PNG or the attributes of an OpenEXR file: decoders take memory for a chunk, an attribute or a
/// table of lines as long as the file says it is, gigabytes for a few flipped bits. Returns what is wrong, or nothing;
/// other formats, and what else may be wrong, are left to the decoder.
[[nodiscard]] std::string find_false_claim(const std::filesystem::path& file);

}  // namespace umbra
