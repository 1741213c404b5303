#include "umbra/bench/contenders/answers_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "umbra/bench/base/npy.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace fs = std::filesystem;
namespace {

std::string expected(const Scene& scene, const PointBatch& points, bool only) {
    std::string shapes = fmt::format("{}", points.size());
    if (points.raster) shapes += fmt::format(" or {} x {}", points.raster->height, points.raster->width);
    if (!only && scene.lights.size() > 1) shapes += fmt::format(", or {} (lights) of these", scene.lights.size());
    return shapes;
}

/// The values of one light of an array.
std::vector<float> of_array(const fs::path& file, const Scene& scene, const PointBatch& points, LightId light,
                            bool only) {
    Numbers numbers = read_npy(file);
    Shape shape     = numbers.shape;
    std::erase(shape, 1u);
    const std::size_t n = points.size(), lights = scene.lights.size();
    Shape flat{n}, picture;
    if (points.raster)
        picture = {static_cast<std::size_t>(points.raster->height), static_cast<std::size_t>(points.raster->width)};
    std::erase(flat, 1u), std::erase(picture, 1u);
    if (shape == flat || (points.raster && shape == picture)) {
        if (lights == 1 || only) return std::move(numbers.values);
        throw InputError(
            fmt::format("{}: holds the answers of one light, expected those of {} (the scene has {} lights)",
                        file.string(), lights, lights));
    }
    if (!only && lights > 1) {
        flat.insert(flat.begin(), lights), picture.insert(picture.begin(), lights);
        if (shape == flat || (points.raster && shape == picture)) {
            const auto begin = numbers.values.begin() + static_cast<std::ptrdiff_t>(light * n);
            return {begin, begin + static_cast<std::ptrdiff_t>(n)};
        }
    }
    throw InputError(fmt::format("{}: holds {} values, expected {}", file.string(), in_words(numbers.shape),
                                 expected(scene, points, only)));
}

std::vector<float> of_picture(const fs::path& file, const Scene& scene, const PointBatch& points, LightId light,
                              bool only) {
    const LoadedImage loaded = read_image(file);
    const Image& image       = loaded.image;
    if (!points.raster || image.width != points.raster->width || image.height != points.raster->height)
        throw InputError(fmt::format("{}: has {}x{} pixels, expected {}", file.string(), image.width, image.height,
                                     points.raster ? fmt::format("{}x{}, the size of the comparison",
                                                                 points.raster->width, points.raster->height)
                                                   : "one value a point in a .npy file"));
    if (loaded.encoding == Encoding::srgb)
        throw InputError(
            fmt::format("{}: holds 8- or 16-bit values as a screen shows them, expected floats (.exr, .npy), "
                        "whose values are S_j itself",
                        file.string()));
    const std::string own = "S." + scene.lights[light].name;
    const auto channel    = [&](std::string_view name) {
        return std::ranges::find(image.channels, name) - image.channels.begin();
    };
    std::ptrdiff_t at = channel(own);
    const auto none   = static_cast<std::ptrdiff_t>(image.channels.size());
    const bool named  = std::ranges::any_of(image.channels, [](const std::string& c) { return c.starts_with("S."); });
    if (at == none && !named && (only || scene.lights.size() == 1)) at = none == 1 ? 0 : channel("R");
    if (at == none)
        throw InputError(fmt::format("{}: has no channel {}{}", file.string(), own,
                                     scene.lights.size() == 1 && !named ? ", and no R" : ""));
    std::vector<float> values(points.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = image.at(i, static_cast<std::size_t>(at));
    return values;
}

}  // namespace

NamedAnswers parse_answers(const std::string& text) {
    constexpr std::string_view kMeasured = ":measure=";
    const std::size_t eq                 = text.find('=');
    if (eq == std::string::npos || eq == 0 || eq + 1 == text.size())
        throw UsageError(fmt::format("{}: expected NAME=PATH, or NAME=PATH:measure=irradiance", text));
    const std::string where    = text.substr(eq + 1);
    const std::size_t measured = where.rfind(kMeasured);
    if (measured == std::string::npos) return {text.substr(0, eq), where};
    const std::string measure = where.substr(measured + kMeasured.size());
    for (const Measure known : {Measure::area, Measure::irradiance})
        if (measure == to_string(known)) return {text.substr(0, eq), where.substr(0, measured), known};
    throw UsageError(fmt::format("{}: measure={}, expected area or irradiance", text, measure));
}

void take_answers(std::span<const float> values, const PointBatch& points, LightId light, const std::string& from,
                  const Visibility& out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points.asks(light, i)) continue;
        const float s = values[i];
        if (std::isnan(s)) {
            out.answer[i] = Answer::undefined;
            continue;
        }
        if (!(s >= -kAnswerSlack && s <= 1 + kAnswerSlack))
            throw InputError(
                fmt::format("{}: the answer at point {} is {}, expected 0 (in shadow) to 1 (lit), or NaN for "
                            "undefined",
                            from, i, s));
        out.s[i] = std::clamp(s, 0.0f, 1.0f);
        if (!out.colour.empty()) out.colour[i] = vec3(out.s[i]);
    }
}

void read_answers(const fs::path& file, const Scene& scene, const PointBatch& points, LightId light, bool only,
                  const Visibility& out) {
    const std::vector<float> values = file.extension() == ".npy" ? of_array(file, scene, points, light, only)
                                                                 : of_picture(file, scene, points, light, only);
    take_answers(values, points, light, file.string(), out);
}

}  // namespace umbra
