// Reading any scene: the reader that the ending names, then the checks and defaults that all formats share.
#include "umbra/core/io/scene_io.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <system_error>

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

FrameOfFile split_frame(const std::string& file) {
    std::error_code ignored;
    const std::size_t at = file.find_last_of('@');
    if (at == std::string::npos || at + 1 == file.size() || std::filesystem::exists(file, ignored)) return {file, ""};
    if (file.find_first_not_of("0123456789", at + 1) != std::string::npos || file.size() - at > 7) return {file, ""};
    return {file.substr(0, at), file.substr(at)};
}

std::string scene_name(const path& file) {
    const auto [base, frame] = split_frame(file.string());
    return path(base).stem().string() + frame;
}

Scene load_scene(const path& name) {
    std::vector<std::string_view> endings;
    for (const Format& format : kFormats) endings.push_back(format.ending);
    const auto [file_name, frame] = split_frame(name.string());
    const path file(file_name);
    if (!frame.empty() && lower_ending(file) != ".json")
        throw InputError(fmt::format("{}: only native scenes (.json) have frames", name.string()));
    SceneFile read = frame.empty() ? read_by_ending(file, endings) : read_native(file, std::stoi(frame.substr(1)));
    check_scene(read, file);
    Scene scene = complete_scene(std::move(read), file);
    scene.name += frame;
    if (scene.frames > 0 && !frame.empty()) scene.title += fmt::format(", frame {}", scene.frame);
    scene.source += frame;
    return scene;
}

}  // namespace umbra
