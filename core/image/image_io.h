// Image files through OpenImageIO, which costs a process 0.4 s when it is loaded (image_library.h).
#pragma once

#include <filesystem>
#include <string>

#include "umbra/core/image/image.h"

namespace umbra {

/// How the numbers of a file represent light.
enum class Encoding : std::uint8_t { linear, srgb };

struct LoadedImage {
    Image image;                           ///< values as the file stores them, scaled to [0, 1] for integer formats
    Encoding encoding = Encoding::linear;  ///< srgb for 8- and 16-bit integer files, linear for all others
    int x = 0, y = 0;                      ///< where the stored pixels begin (an EXR's data window)
    /// The file's statements about how its pixels are shown, by subject ("colours", "display windows", "orientations",
    /// "pixel aspect ratios"). Defaults are left out: sRGB's colours, the upright picture of its pixels.
    std::map<std::string, std::string> shown_as{};
};

/// Why pixels of the two do not belong together: sizes, windows, and the files' statements about showing them.
[[nodiscard]] std::vector<std::string> layout_differences(const LoadedImage& a, const LoadedImage& b);

/// Reads any image that OpenImageIO reads, without conversion. Unsigned channels of 32 bits become Image::integers; if
/// all are, they are floats of [0, 1] as well. The channels of further parts (of an EXR; pages, frames) are called
/// "PART.CHANNEL", by the part's name or its number from 1; parts that differ in layout or encoding are refused, as are
/// mip levels. Throws InputError. Files that claim more pixels than `kMaxPixels`, or 4 times as many values, are
/// refused before memory is taken. Alpha is not multiplied in.
inline constexpr std::size_t kMaxPixels = 1u << 28;
[[nodiscard]] LoadedImage read_image(const std::filesystem::path& file);

/// Writes .exr (float and 32-bit unsigned channels, ZIPS) as is, or .png (8 bit): the first one or three channels (four
/// where the fourth is A), which must be display values in [0, 1] already encoded; values are clamped and rounded, NaN
/// is written as 0. Written beside and moved into place, so that a file that was there stays whole if this fails.
/// Throws InputError.
void write_image(const std::filesystem::path& file, const Image& image);

/// The bytes of the .png that write_image writes. Throws std::runtime_error.
[[nodiscard]] std::string png_bytes(const Image& image);

}  // namespace umbra
