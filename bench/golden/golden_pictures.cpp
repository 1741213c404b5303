#include "umbra/bench/golden/golden_pictures.h"

#include <fmt/format.h>

#include <cmath>

#include "umbra/bench/compare/pictures.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kPictureScale = 4;

/// Every pixel k x k pixels large.
Image enlarged(const Image& image, std::size_t k) {
    Image large(image.width * static_cast<int>(k), image.height * static_cast<int>(k), image.channels);
    const auto width = static_cast<std::size_t>(large.width);
    for (std::size_t i = 0; i < large.pixels(); ++i) {
        const std::size_t from = i / width / k * static_cast<std::size_t>(image.width) + i % width / k;
        for (std::size_t c = 0; c < image.channels.size(); ++c) large.at(i, c) = image.at(from, c);
    }
    return large;
}

/// Every point that changed, however little: blue darker, orange brighter, purple where only one of the two is defined;
/// the others show the reference in a faint grey.
Image change_picture(const Image& before, const Image& now, const ChangedPlane& changed) {
    constexpr vec3 darker(0, 0.45f, 0.70f), brighter(0.90f, 0.40f, 0), undefined(0.80f, 0.47f, 0.65f);
    Image picture(now.width, now.height, {"R", "G", "B"});
    for (std::size_t i = 0; i < now.pixels(); ++i) {
        const float a = before.at(i, changed.old_channel), b = now.at(i, changed.new_channel);
        vec3 colour(std::isnan(a) ? 0.6f : 0.7f + 0.25f * std::abs(a));
        if (!same_value(a, b)) colour = std::isnan(a) || std::isnan(b) ? undefined : b < a ? darker : brighter;
        for (int k = 0; k < 3; ++k) picture.at(i, static_cast<std::size_t>(k)) = colour[k];
    }
    return picture;
}

}  // namespace

void leave_pictures(const fs::path& folder, const PreparedScene& prepared, const Image& before, const Image& now,
                    const std::vector<ChangedPlane>& changed) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    const auto write = [&](const std::string& name, const Image& picture) {
        write_image(folder / name, enlarged(picture, kPictureScale));
    };
    for (const ChangedPlane& c : changed) {
        const VisibilityPlane reference = decoded_plane(before, c.old_channel),
                              result    = decoded_plane(now, c.new_channel);
        const std::string& light        = prepared.scene.lights[c.light].name;
        write(fmt::format("reference.S.{}.png", light), visibility_picture(prepared.points, reference));
        write(fmt::format("result.S.{}.png", light), visibility_picture(prepared.points, result));
        write(fmt::format("difference.S.{}.png", light), change_picture(before, now, c));
    }
    if (!before.channels.empty()) write_image(folder / "reference.exr", before);
    if (!now.channels.empty()) write_image(folder / "result.exr", now);
}

}  // namespace umbra
