// The sizes that an image file declares, compared with its contents before a decoder believes them.
#pragma once

#include <filesystem>
#include <string>

namespace umbra {

inline constexpr int kMaxFileSide = 1 << 17;

/// Walks the chunks of a PNG or the attributes of an OpenEXR file: decoders take memory for a chunk, an attribute or a
/// table of lines as long as the file says it is, gigabytes for a few flipped bits. Returns the fault, or nothing;
/// other formats and other faults are left to the decoder.
[[nodiscard]] std::string find_false_claim(const std::filesystem::path& file);

}  // namespace umbra
