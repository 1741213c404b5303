// Images in memory: scene-linear floats with named channels.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/base/math.h"

namespace umbra {

/// Pixels row by row from the top, channels interleaved.
struct Image {
    int width = 0, height = 0;
    std::vector<std::string> channels;            ///< "R", "G", "B", "S.key", ...
    std::vector<float> data;                      ///< width * height * channels.size()
    std::map<std::string, std::string> metadata;  ///< "umbra:scene", "umbra:method", ...; written to EXR and PNG

    /// Channels of whole numbers that float cannot hold exactly, one value a pixel. EXR alone has them.
    std::map<std::string, std::vector<std::uint32_t>> integers;
    /// 4 x 4 matrices of row vectors, p' = (p, 1) M, row by row: "worldToCamera", "worldToNDC". EXR alone has them.
    std::map<std::string, std::array<float, 16>> matrices;

    Image() = default;
    Image(int w, int h, std::vector<std::string> names)
        : width(w), height(h), channels(std::move(names)), data(std::size_t(w) * std::size_t(h) * channels.size()) {}
    [[nodiscard]] std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
    [[nodiscard]] float& at(std::size_t pixel, std::size_t c) { return data[pixel * channels.size() + c]; }
    [[nodiscard]] float at(std::size_t pixel, std::size_t c) const { return data[pixel * channels.size() + c]; }
};

/// Gives an image of integers alone, which cannot be shown, floats of the same names, scaled to [0, 1].
void spread_integers(Image& image);

/// Channels that make one picture.
struct Layer {
    std::string name;                     ///< "" of R, G, B; "spec" of spec.R, spec.G, spec.B; the channel's, if grey
    std::array<std::size_t, 3> channels;  ///< where its R, G and B are; one channel three times, as grey
};

/// Every R, G, B of the image, that without a name first. If there is none, every channel is a layer.
[[nodiscard]] std::vector<Layer> layers(const Image& image);

/// Those of the first layer.
[[nodiscard]] std::array<std::size_t, 3> colour_channels(const Image& image);

/// Throws std::logic_error, which names `who`, where the images differ in size or one of them is empty.
void check_same_size(const Image& a, const Image& b, std::string_view who);

/// Encodes one linear value to sRGB (IEC 61966-2-1) and back; both for [0, 1], odd beyond.
[[nodiscard]] float srgb_from_linear(float x);
[[nodiscard]] float linear_from_srgb(float x);

}  // namespace umbra
