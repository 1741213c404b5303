#include "umbra/bench/lab/antialias.h"

#include <fmt/format.h>

#include <cmath>

#include "umbra/core/base/error.h"
#include "umbra/core/render/ask_visibility.h"

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

namespace {

constexpr float kStraight = 1.0f / 32;  ///< how far S_j may bend and still be taken for straight

/// Pixels of a raster whose S_j may be interpolated.
class SmoothPixels {
public:
    SmoothPixels(const Scene& scene, const PointBatch& points, const VisibilityPlane& plane, LightId light)
        : scene_(scene),
          points_(points),
          plane_(plane),
          light_(light),
          width_(points.raster->width),
          height_(points.raster->height) {}

    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    [[nodiscard]] bool is_smooth(int x, int y) const {
        if (x < 1 || y < 1 || x + 1 >= width_ || y + 1 >= height_) return false;
        for (int v = -1; v <= 1; ++v)
            for (int u = -1; u <= 1; ++u)
                if (!is_like(index(x, y), index(x + u, y + v))) return false;
        for (int v = -1; v <= 1; ++v)
            if (bend(index(x - 1, y + v), index(x, y + v), index(x + 1, y + v)) > kStraight ||
                bend(index(x + v, y - 1), index(x + v, y), index(x + v, y + 1)) > kStraight)
                return false;
        return true;
    }

private:
    [[nodiscard]] bool is_like(std::size_t i, std::size_t k) const {
        return points_.asks(light_, i) && points_.facing[light_][i] == points_.facing[light_][k] &&
               plane_.answer[i] == Answer::given && plane_.answer[k] == Answer::given &&
               scene_.triangle_object[points_.triangle[i]] == scene_.triangle_object[points_.triangle[k]];
    }
    [[nodiscard]] float bend(std::size_t a, std::size_t b, std::size_t c) const {
        return std::abs(plane_.s[a] - 2 * plane_.s[b] + plane_.s[c]);
    }

    const Scene& scene_;
    const PointBatch& points_;
    const VisibilityPlane& plane_;
    LightId light_;
    int width_, height_;
};

}  // namespace

VisibilityPlane between_centres(const Scene& scene, const PointBatch& centres, const VisibilityPlane& at_centres,
                                const PointBatch& subpixels, int side, LightId light, std::vector<std::uint32_t>& ask) {
    VisibilityPlane plane(subpixels.size(), !at_centres.colour.empty());
    write_decided(scene, subpixels, light, plane.out());
    ask.clear();
    const SmoothPixels smooth(scene, centres, at_centres, light);
    const int width = centres.raster->width, height = centres.raster->height;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const bool is_smooth     = smooth.is_smooth(x, y);
            const std::size_t centre = smooth.index(x, y);
            for (int v = 0; v < side; ++v)
                for (int u = 0; u < side; ++u) {
                    const auto i = static_cast<std::uint32_t>((y * side + v) * width * side + x * side + u);
                    if (!subpixels.asks(light, i)) continue;
                    if (!is_smooth || subpixels.facing[light][i] != centres.facing[light][centre] ||
                        scene.triangle_object[subpixels.triangle[i]] !=
                            scene.triangle_object[centres.triangle[centre]]) {
                        ask.push_back(i);
                        continue;
                    }
                    // From the middle of the pixel, in pixels.
                    const float right = (static_cast<float>(u) + 0.5f) / static_cast<float>(side) - 0.5f,
                                down  = (static_cast<float>(v) + 0.5f) / static_cast<float>(side) - 0.5f;
                    const int dx = right < 0 ? -1 : 1, dy = down < 0 ? -1 : 1;
                    const float across = std::abs(right), along = std::abs(down);
                    const auto mixed = [&](const auto& of) {
                        return (1 - along) * ((1 - across) * of[centre] + across * of[smooth.index(x + dx, y)]) +
                               along * ((1 - across) * of[smooth.index(x, y + dy)] +
                                        across * of[smooth.index(x + dx, y + dy)]);
                    };
                    plane.s[i] = mixed(at_centres.s);
                    if (!plane.colour.empty()) plane.colour[i] = mixed(at_centres.colour);
                }
        }
    return plane;
}

}  // namespace umbra
