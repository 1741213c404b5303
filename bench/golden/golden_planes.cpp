#include "umbra/bench/golden/golden_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace umbra {
namespace {

constexpr float kOnBoundaryCode = -1;

std::optional<std::size_t> channel_named(const Image& image, const std::string& name) {
    const auto at = std::find(image.channels.begin(), image.channels.end(), name);
    if (at == image.channels.end()) return std::nullopt;
    return static_cast<std::size_t>(at - image.channels.begin());
}

}  // namespace

bool is_sampled(const MethodChoice& choice, const Light& light) {
    const auto is_seed = [](const Parameter& p) { return p.name == "seed"; };
    return is_area(light.kind) && std::any_of(choice.info->parameters.begin(), choice.info->parameters.end(), is_seed);
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

}  // namespace umbra
