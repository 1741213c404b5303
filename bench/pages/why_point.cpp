#include "umbra/bench/pages/why_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "umbra/bench/pages/error_palette.h"
#include "umbra/bench/pages/report_text.h"

namespace umbra {
namespace {

using nlohmann::json;

const ErrorColour* colour_of(const std::string& error_class) {
    const auto found = std::ranges::find(kErrorPalette, error_class, &ErrorColour::key);
    return found == kErrorPalette.end() ? nullptr : &*found;
}

/// "x,y x,y", for SVG; false where there is nothing to draw.
json corners(const std::vector<std::vector<double>>& polygon) {
    std::string text;
    for (const std::vector<double>& at : polygon)
        if (at.size() == 2) text += fmt::format("{}{},{}", text.empty() ? "" : " ", at[0], at[1]);
    return text.empty() ? json(false) : json(text);
}

/// A third of the picture, with the point in its middle, or as near to that as the picture's sides allow.
std::string window(const SizeRecord& size, const std::vector<int>& pixel) {
    const auto begin = [](double at, double of) { return std::clamp(at - of / 6, 0.0, of - of / 3); };
    const auto width = static_cast<double>(*size.width), height = static_cast<double>(*size.height);
    return fmt::format("{:.2f} {:.2f} {:.2f} {:.2f}", begin(pixel[0] + 0.5, width), begin(pixel[1] + 0.5, height),
                       width / 3, height / 3);
}

}  // namespace

json why_point(const ExplainedPointRecord& point, const WhyPicture& picture) {
    const SizeRecord& size    = picture.size;
    const ErrorColour* colour = colour_of(point.error_class);
    return {{"class", colour ? std::string(colour->name) : in_words(point.error_class)},
            {"colour", colour ? std::string(colour->srgb) : "#888888"},
            {"x", std::to_string(point.pixel[0])},
            {"y", std::to_string(point.pixel[1])},
            {"middle_x", fmt::format("{:.1f}", point.pixel[0] + 0.5)},
            {"middle_y", fmt::format("{:.1f}", point.pixel[1] + 0.5)},
            {"radius", fmt::format("{:.2f}", static_cast<double>(*size.width) / 120)},
            {"on", fmt::format("triangle {} of {}", point.on.triangle, point.on.object)},
            {"window", window(size, point.pixel)},
            {"method", sentence(point.method)},
            {"truth", sentence(point.truth)},
            {"difference", point.method.difference.empty() ? json(false) : json(point.method.difference)},
            {"segment", corners(point.segment)},
            {"truth_blocker", corners(point.truth_blocker)},
            {"method_blocker", corners(point.method_blocker)},
            {"texel", corners(point.texel)},
            {"label", picture.label},
            {"reference", picture.reference},
            {"src", picture.address},
            {"width", std::to_string(*size.width)},
            {"height", std::to_string(*size.height)}};
}

}  // namespace umbra
