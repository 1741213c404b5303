// Reading any scene: the reader that the ending names, then the checks and defaults that all formats share.
#include "umbra/core/io/scene_io.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_readers.h"

namespace umbra {
namespace {

using std::filesystem::path;

struct Format {
    std::string_view ending;
    SceneFile (*read)(const path& file);
};
constexpr std::array<Format, 8> kFormats{{{".json", read_native},
                                          {".gltf", read_gltf},
                                          {".glb", read_gltf},
                                          {".obj", read_obj},
                                          {".nff", read_nff},
                                          {".ply", read_ply},
                                          {".off", read_off},
                                          {".stl", read_stl}}};

std::string lower_ending(const path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending;
}

}  // namespace

SceneFile read_by_ending(const path& file, const std::vector<std::string_view>& endings) {
    const std::string ending = lower_ending(file);
    if (std::find(endings.begin(), endings.end(), ending) == endings.end())
        throw InputError(fmt::format(
            "{}: {} (known: {})", file.string(),
            ending.empty() ? "no ending, so the format is not known" : fmt::format("unknown ending \"{}\"", ending),
            fmt::join(endings, " ")));
    const auto format =
        std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& f) { return f.ending == ending; });
    return format->read(file);
}

Scene load_scene(const path& file) {
    std::vector<std::string_view> endings;
    for (const Format& format : kFormats) endings.push_back(format.ending);
    SceneFile read = read_by_ending(file, endings);
    check_scene(read, file);
    return complete_scene(std::move(read), file);
}

}  // namespace umbra
