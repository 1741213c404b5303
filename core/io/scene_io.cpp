// Reading any scene: the reader that the ending names, then the checks and defaults that all formats share.
#include "umbra/core/io/scene_io.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/scene/names.h"

namespace umbra {
namespace {

using std::filesystem::path;

struct Format {
    std::string_view ending;
    SceneFile (*read)(const path& file, const Reading& reading);
    bool is_mesh = false;  ///< says nothing of which axis points up
};
constexpr std::array<Format, 8> kFormats{{{".json", read_native},
                                          {".gltf", read_gltf},
                                          {".glb", read_gltf},
                                          {".obj", read_obj, true},
                                          {".nff", read_nff},
                                          {".ply", read_ply, true},
                                          {".off", read_off, true},
                                          {".stl", read_stl, true}}};

std::string lower_ending(const path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending;
}

std::string origin_words(const Scene& scene) {
    const dvec3 o = scene.origin;
    return fmt::format(
        "The scene lies so far from the file's origin that floats would blur it: all numbers here are relative to "
        "({}, {}, {}) of the file.",
        o.x, o.y, o.z);
}

/// `text` as Reading has it.
Scene load(const path& name, const std::string* text) {
    std::vector<std::string_view> endings;
    for (const Format& format : kFormats) endings.push_back(format.ending);
    const auto [file_name, tail] = split_frame(name.string());
    const path file(file_name);
    Reading reading{.text = text};
    const std::optional<UpAxis> up = tail.empty() ? std::nullopt : up_axis(tail.substr(1));
    const bool is_frame            = !tail.empty() && !up;
    if (is_frame && lower_ending(file) != ".json")
        throw InputError(fmt::format("{}: only native scenes (.json) have frames", name.string()));
    if (up) reading.up = *up;
    if (is_frame) reading.frame = std::stoi(tail.substr(1));
    SceneFile read = read_by_ending(file, endings, reading);
    check_scene(read, file);
    if (read.scene.origin != dvec3(0) && !read.has_origin) read.scene.warnings.push_back(origin_words(read.scene));
    Scene scene = complete_scene(std::move(read), file);
    if (is_frame) scene.name += tail;
    if (scene.frames > 0 && is_frame) scene.title += fmt::format(", frame {}", scene.frame);
    scene.source += tail;
    return scene;
}

}  // namespace

SceneFile read_by_ending(const path& file, const std::vector<std::string_view>& endings, Reading reading) {
    const std::string ending = lower_ending(file);
    if (std::find(endings.begin(), endings.end(), ending) == endings.end())
        throw InputError(fmt::format(
            "{}: {} (known: {})", file.string(),
            ending.empty() ? "no ending, so the format is not known" : fmt::format("unknown ending \"{}\"", ending),
            fmt::join(endings, " ")));
    const auto format =
        std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& f) { return f.ending == ending; });
    if (reading.up != UpAxis::y && !format->is_mesh)
        throw InputError(fmt::format("{}: {} files say which way is up, expected a mesh file ({})", file.string(),
                                     ending, mesh_endings()));
    // The first reading finds the extent; where floats squeeze it to a point, the second does.
    constexpr int kMostReadings = 4;
    SceneFile read              = format->read(file, reading);
    for (int n = 1; n < kMostReadings && !read.has_origin; ++n) {
        const dvec3 farther = local_origin(read.at_rest.empty() ? bounds(read.scene) : read.at_rest);
        if (farther == dvec3(0)) break;
        reading.origin += farther;
        read              = {};  // its memory first
        read              = format->read(file, reading);
        read.scene.origin = reading.origin;
    }
    return read;
}

std::string mesh_endings() {
    std::vector<std::string_view> endings;
    for (const Format& format : kFormats)
        if (format.is_mesh) endings.push_back(format.ending);
    return fmt::format("{}", fmt::join(endings, " "));
}

bool is_mesh_file(const path& file) {
    return std::ranges::any_of(kFormats, [&](const Format& f) { return f.is_mesh && f.ending == lower_ending(file); });
}

FrameOfFile split_frame(const std::string& file) {
    std::error_code ignored;
    const std::size_t at = file.find_last_of('@');
    if (at == std::string::npos || at + 1 == file.size() || std::filesystem::exists(file, ignored)) return {file, ""};
    const std::string tail = file.substr(at + 1);
    const bool is_frame    = tail.find_first_not_of("0123456789") == std::string::npos && tail.size() <= 6;
    if (!is_frame && !up_axis(tail)) return {file, ""};
    return {file.substr(0, at), file.substr(at)};
}

std::optional<UpAxis> up_axis(std::string_view name) {
    for (const UpAxis up : values_of<UpAxis>())
        if (name_of(up) == name) return up;
    return std::nullopt;
}

std::string scene_name(const path& file) {
    const auto [base, frame] = split_frame(file.string());
    return path(base).stem().string() + (!frame.empty() && up_axis(frame.substr(1)) ? "" : frame);
}

Scene load_scene(const path& file) { return load(file, nullptr); }
Scene load_scene(const path& file, const std::string& text) { return load(file, &text); }

}  // namespace umbra
