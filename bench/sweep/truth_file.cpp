#include "umbra/bench/sweep/truth_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "umbra/core/base/error.h"
#include "umbra/core/base/number_from.h"
#include "umbra/core/image/image_io.h"

namespace umbra {
namespace {

constexpr std::array kColour{"red", "green", "blue"};  ///< of planes that have one

std::string channel(const char* what, std::size_t light) { return fmt::format("{}.{}", what, light); }

std::size_t column(const Image& image, const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(image.channels, name) - image.channels.begin());
}

}  // namespace

void write_truth(const std::filesystem::path& file, const ReferenceRun& ran, int width, int height) {
    std::vector<std::string> channels;
    for (std::size_t j = 0; j < ran.run.planes.size(); ++j) {
        for (const char* what : {"s", "half_width"}) channels.push_back(channel(what, j));
        if (ran.run.planes[j].colour.empty()) continue;
        for (const char* what : kColour) channels.push_back(channel(what, j));
    }
    Image image(width, height, channels);
    for (std::size_t j = 0; j < ran.run.planes.size(); ++j) {
        const VisibilityPlane& plane = ran.run.planes[j];
        std::vector<std::uint32_t> answer(plane.size()), judged(plane.size(), 1);
        const auto judged_here = ran.run.judged_points(static_cast<LightId>(j));
        const std::size_t s    = column(image, channel("s", j));
        for (std::size_t i = 0; i < plane.size(); ++i) {
            image.at(i, s)     = plane.s[i];
            image.at(i, s + 1) = plane.half_width[i];
            for (std::size_t c = 0; c < 3 && !plane.colour.empty(); ++c)
                image.at(i, s + 2 + c) = plane.colour[i][static_cast<int>(c)];
            answer[i] = static_cast<std::uint32_t>(plane.answer[i]);
            if (!judged_here.empty()) judged[i] = judged_here[i];
        }
        image.integers[channel("answer", j)] = std::move(answer);
        if (!judged_here.empty()) image.integers[channel("judged", j)] = std::move(judged);
    }
    image.metadata = {{"umbra:judged", fmt::format("{}", ran.judged)},
                      {"umbra:of", fmt::format("{}", ran.of)},
                      {"umbra:stand_in", ran.stand_in}};
    // Under a name of this process: others may find the same truth at the same time.
    std::filesystem::path beside = file;
    beside.replace_extension(fmt::format("{}.exr", getpid()));
    write_image(beside, image);
    std::error_code error;
    std::filesystem::rename(beside, file, error);
    if (error) throw InputError(fmt::format("{}: {}, expected a place to write to", file.string(), error.message()));
}

bool read_truth(const std::filesystem::path& file, std::size_t lights, std::size_t points, ReferenceRun& ran) {
    if (lights == 0 || !std::filesystem::exists(file)) return false;
    Image image;
    try {
        image = read_image(file).image;
    } catch (const InputError&) {  // cut off, or of something else
        return false;
    }
    if (image.pixels() != points) return false;
    ran.run.planes.clear();
    std::vector<std::vector<std::uint8_t>> sampled(lights);  // none of a light that is judged at every point
    bool any_sampled = false;
    for (std::size_t j = 0; j < lights; ++j) {
        const std::size_t s = column(image, channel("s", j)), half = column(image, channel("half_width", j));
        const auto answer = image.integers.find(channel("answer", j)),
                   judged = image.integers.find(channel("judged", j));
        if (s == image.channels.size() || half == image.channels.size() || answer == image.integers.end()) return false;
        std::array<std::size_t, 3> colour{};  // a file may have them in any order
        for (std::size_t c = 0; c < 3; ++c) colour[c] = column(image, channel(kColour[c], j));
        const bool coloured = std::ranges::max(colour) < image.channels.size();
        VisibilityPlane plane(points, coloured);
        for (std::size_t i = 0; i < points; ++i) {
            plane.s[i]          = image.at(i, s);
            plane.half_width[i] = image.at(i, half);
            plane.answer[i]     = static_cast<Answer>(answer->second[i]);
            if (coloured) plane.colour[i] = {image.at(i, colour[0]), image.at(i, colour[1]), image.at(i, colour[2])};
        }
        ran.run.planes.push_back(std::move(plane));
        if (judged != image.integers.end()) {
            sampled[j].assign(judged->second.begin(), judged->second.end());
            any_sampled = true;
        }
    }
    ran.run.judged    = any_sampled ? std::move(sampled) : decltype(sampled){};
    const auto judged = number_from<std::uint64_t>(image.metadata["umbra:judged"]),
               of     = number_from<std::uint64_t>(image.metadata["umbra:of"]);
    ran.stand_in      = image.metadata["umbra:stand_in"];
    ran.judged = judged.value_or(0), ran.of = of.value_or(0);
    return judged && of;
}

}  // namespace umbra
