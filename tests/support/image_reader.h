// Images as others read them: by OpenImageIO itself, without a line of our own readers and writers.
#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace umbra::other_readers {

/// One value a pixel, row by row from the top, by channel name.
struct Exr {
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> floats;
    std::map<std::string, std::vector<std::uint32_t>> integers;
};

inline std::unique_ptr<OIIO::ImageInput> opened(const std::filesystem::path& file) {
    auto input = OIIO::ImageInput::open(file.string());
    if (!input) throw std::runtime_error(file.string() + ": " + OIIO::geterror());
    return input;
}

inline Exr read_exr(const std::filesystem::path& file) {
    const auto input = opened(file);
    const OIIO::ImageSpec spec(input->spec());
    Exr exr{spec.width, spec.height, {}, {}};
    const auto pixels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
    for (int c = 0; c < spec.nchannels; ++c) {
        const std::string& name = spec.channelnames[static_cast<std::size_t>(c)];
        const bool whole        = spec.channelformat(c) == OIIO::TypeDesc::UINT32;
        auto* const into = whole ? static_cast<void*>((exr.integers[name].resize(pixels), exr.integers[name].data()))
                                 : static_cast<void*>((exr.floats[name].resize(pixels), exr.floats[name].data()));
        if (!input->read_image(0, 0, c, c + 1, whole ? OIIO::TypeDesc::UINT32 : OIIO::TypeDesc::FLOAT, into))
            throw std::runtime_error(file.string() + ": " + input->geterror());
    }
    return exr;
}

using Rgb = std::array<int, 3>;  ///< 0 to 255

inline std::vector<Rgb> read_png(const std::filesystem::path& file) {
    const auto input = opened(file);
    const OIIO::ImageSpec spec(input->spec());
    const auto pixels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
    std::vector<unsigned char> bytes(3 * pixels);
    if (spec.nchannels != 3 || !input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()))
        throw std::runtime_error(file.string() + ": expected 3 channels, " + input->geterror());
    std::vector<Rgb> image(pixels);
    for (std::size_t i = 0; i < pixels; ++i) image[i] = {bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]};
    return image;
}

inline std::string read_text(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw std::runtime_error(file.string() + ": cannot be read");
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace umbra::other_readers
