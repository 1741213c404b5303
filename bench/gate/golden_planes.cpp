#include "umbra/bench/gate/golden_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "umbra/bench/compare/pictures.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

constexpr float kOnBoundaryCode = -1;

std::optional<std::size_t> channel_named(const Image& image, const std::string& name) {
    const auto at = std::ranges::find(image.channels, name);
    if (at == image.channels.end()) return std::nullopt;
    return static_cast<std::size_t>(at - image.channels.begin());
}

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

bool is_sampled(const MethodChoice& choice, const Light& light) {
    const auto is_seed = [](const Parameter& p) { return p.name == "seed"; };
    return is_area(light.kind) && std::ranges::any_of(choice.info->parameters, is_seed);
}

MethodRun run_once(const MethodChoice& choice, const PreparedScene& prepared) {
    return run_method(choice, prepared.scene, prepared.facts, prepared.points);
}

Image coded_planes(const PreparedScene& prepared, const MethodRun& run, bool sampled_too) {
    std::vector<std::string> channels;
    std::vector<const VisibilityPlane*> planes;
    for (LightId j = 0; j < run.planes.size(); ++j) {
        const Light& light = prepared.scene.lights[j];
        if (!sampled_too && is_sampled(run.choice, light)) continue;
        channels.push_back("S." + light.name);
        planes.push_back(&run.planes[j]);
    }
    Image image(prepared.points.raster->width, prepared.points.raster->height, std::move(channels));
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (std::size_t c = 0; c < planes.size(); ++c)
            image.at(i, c) = planes[c]->answer[i] == Answer::undefined     ? std::numeric_limits<float>::quiet_NaN()
                             : planes[c]->answer[i] == Answer::on_boundary ? kOnBoundaryCode
                                                                           : planes[c]->s[i];
    image.metadata = {{"umbra:scene", prepared.scene.name}, {"umbra:method", std::string(run.choice.info->name)}};
    return image;
}

VisibilityPlane decoded_plane(const Image& image, std::size_t channel) {
    VisibilityPlane plane(image.pixels());
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const float x   = image.at(i, channel);
        plane.answer[i] = std::isnan(x)          ? Answer::undefined
                          : x == kOnBoundaryCode ? Answer::on_boundary
                                                 : Answer::given;
        plane.s[i]      = std::isnan(x) ? 0 : std::abs(x);  // a point on the boundary is shown as lit
    }
    return plane;
}

bool same_value(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

Changes plane_changes(const Image& before, const Image& now, const PreparedScene& prepared) {
    Changes changes;
    if (before.width != now.width || before.height != now.height) {
        changes.add(fmt::format("size of the planes: {}x{} -> {}x{} points", before.width, before.height, now.width,
                                now.height),
                    false);
        return changes;
    }
    for (const std::string& name : before.channels)
        if (!channel_named(now, name)) changes.add(name + " is no longer stored", false);
    const auto width = static_cast<std::size_t>(now.width);
    for (LightId j = 0; j < prepared.scene.lights.size(); ++j) {
        const Light& light     = prepared.scene.lights[j];
        const std::string name = "S." + light.name;
        const auto old_channel = channel_named(before, name), new_channel = channel_named(now, name);
        if (!new_channel) continue;
        if (!old_channel) {
            changes.add(name + " is new", false);
            continue;
        }
        // In both planes' bands, so that a point which is wrong amid its likes makes no edge of its own.
        const auto band_of = [&](const Image& image, std::size_t channel) {
            return edge_band(prepared.points, j, decoded_plane(image, channel), visibility_tolerance(light.kind));
        };
        const auto old_band = band_of(before, *old_channel), new_band = band_of(now, *new_channel);
        std::size_t changed = 0, in_band = 0, first = 0;
        float largest = 0;
        for (std::size_t i = 0; i < now.pixels(); ++i) {
            const float a = before.at(i, *old_channel), b = now.at(i, *new_channel);
            if (same_value(a, b)) continue;
            if (changed++ == 0) first = i;
            in_band += old_band[i] && new_band[i];
            largest = std::max(largest, std::isnan(a) || std::isnan(b) ? 1 : std::abs(a - b));
        }
        if (changed == 0) continue;
        changes.planes.push_back({j, *old_channel, *new_channel});
        changes.add(fmt::format("{}: {} of {} points changed, {} of them in the edge band, the first at pixel {}, {}; "
                                "largest change {:.6g}",
                                name, changed, now.pixels(), in_band, first % width, first / width, largest),
                    in_band == changed);
    }
    return changes;
}

fs::path leave_pictures(const fs::path& pictures, const std::string& golden, const PreparedScene& prepared,
                        const Image& before, const Image& now, const std::vector<ChangedPlane>& changed) {
    if (pictures.empty() || changed.empty()) return {};
    fs::path folder = pictures / fmt::format("{}.{}", prepared.scene.name, golden);
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
    return folder;
}

}  // namespace umbra
