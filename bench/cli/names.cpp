#include "umbra/bench/cli/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/ladders/ladder_file.h"
#include "umbra/core/base/error.h"
#include "umbra/core/base/number_from.h"
#include "umbra/core/base/paths.h"
#include "umbra/core/base/suggest.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/shadows/method.h"

namespace umbra {

namespace fs = std::filesystem;

namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

void return_to(std::vector<std::string>& positionals, std::vector<std::string>& list,
               const std::function<bool(const std::string&)>& is_positional) {
    const std::vector<std::string> known = names_of_entries(methods());
    const auto taken = std::stable_partition(list.begin(), list.end(), [&](const std::string& word) {
        return contains(known, word.substr(0, word.find(':'))) || !is_positional(word);
    });
    positionals.insert(positionals.end(), taken, list.end());
    list.erase(taken, list.end());
}

}  // namespace

fs::path scenes_folder() {
    const char* set = std::getenv("UMBRA_SCENES");
    return set != nullptr ? set : UMBRA_SCENES_FOLDER;
}

fs::path golden_folder() {
    const char* set = std::getenv("UMBRA_GOLDEN");
    return set != nullptr ? set : UMBRA_GOLDEN_FOLDER;
}

std::vector<std::string> canonical_names() {
    std::vector<std::string> names;
    try {
        for (const fs::path& scene : canonical_scenes(scenes_folder())) names.push_back(scene.stem().string());
    } catch (const InputError&) {  // an installed program may have none
    }
    return names;
}

std::vector<std::string> scene_names() {
    std::vector<std::string> names = canonical_names(), others;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(scenes_folder(), error))
        if (const std::string name = entry.path().stem().string();
            entry.path().extension() == ".json" && !contains(names, name))
            others.push_back(name);
    std::ranges::sort(others);
    names.insert(names.end(), others.begin(), others.end());
    return names;
}

std::vector<std::string> frames_of(const std::string& scene) {
    const std::size_t at   = scene.find_last_of('@'),
                      dots = scene.find("..", at == std::string::npos ? scene.size() : at);
    if (is_file(scene) || at == std::string::npos || dots == std::string::npos ||
        scene.find_first_not_of("0123456789.", at + 1) != std::string::npos)
        return {scene};
    const auto [first, last] =
        two_numbers_from<int>(std::string_view(scene).substr(at + 1), "..").value_or(std::pair(-1, -1));
    if (first < 0 || last < first || last - first >= 10000)
        throw UsageError(fmt::format("{}: not frames of a scene, expected SCENE@FIRST..LAST", scene));
    std::vector<std::string> names;
    for (int frame = first; frame <= last; ++frame) names.push_back(fmt::format("{}@{}", scene.substr(0, at), frame));
    return names;
}

fs::path scene_file(const std::string& scene, const std::string& up) {
    if (up != "y") {
        const fs::path file     = scene_file(scene);
        const auto [base, tail] = split_frame(file.string());
        if (!is_mesh_file(base))
            throw UsageError(fmt::format("--up {}: {} says itself which way is up, expected a mesh file ({})", up,
                                         file.string(), mesh_endings()));
        return tail.empty() ? fs::path(base + "@" + up) : file;
    }
    if (is_file(scene)) return scene;
    const std::vector<std::string> known = scene_names();
    if (contains(canonical_names(), scene))
        for (const fs::path& file : canonical_scenes(scenes_folder()))
            if (file.stem() == scene) return file;
    if (contains(known, scene)) return scenes_folder() / (scene + ".json");
    if (split_frame(scene).frame.empty() && (scene.find('/') != std::string::npos || fs::path(scene).has_extension()))
        return scene;
    if (const auto [base, frame] = split_frame(scene); !frame.empty()) return scene_file(base).string() + frame;
    throw UsageError(fmt::format("unknown scene \"{}\": neither a file nor a scene of {}{}", scene,
                                 scenes_folder().string(), did_you_mean(scene, known)));
}

std::vector<fs::path> scene_files(const std::vector<std::string>& scenes, const std::string& up) {
    std::vector<fs::path> files;
    for (const std::string& scene : scenes)
        for (const std::string& frame : frames_of(scene)) files.push_back(scene_file(frame));
    const auto is_mesh = [](const fs::path& file) { return is_mesh_file(split_frame(file.string()).file); };
    // Where none is, the first says so.
    const bool all = std::ranges::none_of(files, is_mesh);
    for (fs::path& file : files)
        if (all || is_mesh(file)) file = scene_file(file.string(), up);
    return files;
}

void return_scenes(std::vector<std::string>& methods, std::vector<std::string>& positionals) {
    const std::vector<std::string> known = scene_names();
    return_to(positionals, methods, [&](const std::string& word) { return is_file(word) || contains(known, word); });
}

void return_ladders(std::vector<std::string>& methods, std::vector<std::string>& positionals) {
    const std::vector<std::string> known = names_of_entries(ladders());
    return_to(positionals, methods,
              [&](const std::string& word) { return is_ladder_file(word) || contains(known, word); });
}

}  // namespace umbra
