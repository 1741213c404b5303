#include "umbra/bench/run/antialias.h"

#include <fmt/format.h>

#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/render/shade.h"

namespace umbra {

int samples_along_side(int samples) {
    const int side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(samples))));
    if (samples < 1 || samples > 64 || side * side != samples)
        throw UsageError(fmt::format("--pixel-samples {}: expected 1, 4, 9, 16, 25, 36, 49 or 64", samples));
    return side;
}

PointBatch subpixel_points(const RayScene& rays, const Scene& scene, int width, int height, int side) {
    constexpr std::int64_t kMost = std::int64_t{1} << 26;
    if (std::int64_t{width} * height * side * side > kMost)
        throw UsageError(fmt::format("{} samples for each of {} x {} pixels: expected at most {} in all", side * side,
                                     width, height, kMost));
    return primary_points(rays, scene, scene.camera, width * side, height * side);
}

Image box_filtered(const Image& fine, int side) {
    Image image(fine.width / side, fine.height / side, fine.channels);
    const float weight = 1.0f / static_cast<float>(side * side);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (std::size_t c = 0; c < image.channels.size(); ++c) {
                float sum = 0;
                for (int v = 0; v < side; ++v)
                    for (int u = 0; u < side; ++u)
                        sum +=
                            fine.at(std::size_t(y * side + v) * std::size_t(fine.width) + std::size_t(x * side + u), c);
                image.at(std::size_t(y) * std::size_t(image.width) + std::size_t(x), c) = sum * weight;
            }
    return image;
}

Image antialiased(const Scene& scene, const PointBatch& subpixels, std::span<const VisibilityPlane> visibility,
                  int side) {
    return box_filtered(shade(scene, subpixels, visibility), side);
}

}  // namespace umbra
