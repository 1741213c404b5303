#include "umbra/bench/lab/chosen.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <set>
#include <sstream>

#include "umbra/bench/base/files.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

/// Whether the method runs on a scene's file where nobody says which methods.
bool runs_by_itself(const MethodInfo& method, const std::filesystem::path& scene) {
    if (method.by_default || !method.shown) return method.by_default;
    std::ifstream in(scene.parent_path() / "canonical.txt");
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string word;
        if (!(words >> word) || word != scene.filename().string()) continue;
        while (words >> word)
            if (word == method.name) return true;
    }
    return false;
}

}  // namespace

std::vector<std::filesystem::path> canonical_scenes(const std::filesystem::path& folder) {
    const std::filesystem::path list = folder / "canonical.txt";
    std::ifstream in(list);
    if (!in)
        throw InputError(
            fmt::format("{}: cannot read the list of canonical scenes (set UMBRA_SCENES to the folder that holds it)",
                        list.string()));
    std::vector<std::filesystem::path> scenes;
    for (std::string line; std::getline(in, line);)
        if (!line.empty() && line[0] != '#') scenes.push_back(folder / line.substr(0, line.find(' ')));
    return scenes;
}

std::vector<std::filesystem::path> teaching_scenes(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> scenes = canonical_scenes(folder);
    std::erase_if(scenes, [](const auto& scene) { return scene.filename().string().starts_with("real_"); });
    return scenes;
}

std::vector<MethodChoice> chosen_methods(std::span<const std::string> typed, std::span<const MethodChoice> further,
                                         std::span<const std::filesystem::path> scenes) {
    std::vector<MethodChoice> chosen;
    for (const std::string& text : typed) chosen.push_back(parse_method(text));
    chosen.insert(chosen.end(), further.begin(), further.end());
    for (const MethodChoice& choice : chosen) static_cast<void>(choice.make());
    if (!chosen.empty()) return chosen;
    for (const MethodInfo* info : methods())
        if (info->is_shown() && std::ranges::all_of(scenes, [&](const auto& s) { return runs_by_itself(*info, s); }))
            chosen.emplace_back(*info);
    return chosen;
}

std::vector<ChosenScene> chosen_scenes(std::span<const std::filesystem::path> files) {
    std::set<std::filesystem::path> given;
    std::set<std::string> taken;  // in lower case: disks that do not tell cases apart have one folder for both
    std::vector<ChosenScene> named;
    for (const std::filesystem::path& file : files) {
        if (!given.insert(std::filesystem::weakly_canonical(file)).second)
            throw UsageError(fmt::format("{}: is given twice, expected each scene once", file.string()));
        const std::string name = scene_name(file), folder = folder_name(name);
        const auto is_free = [&](std::string text) {
            std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
            return taken.insert(std::move(text)).second;
        };
        std::string behind;
        for (int k = 2; !is_free(folder + behind); ++k) behind = fmt::format("-{}", k);
        named.push_back({file, name + behind, folder + behind});
    }
    return named;
}

std::filesystem::path scene_beside(const Field& name, const std::filesystem::path& file, const FindScene& find) {
    const std::filesystem::path beside = file.parent_path() / name.required_text();
    try {
        return std::filesystem::is_regular_file(beside) ? beside : find(name.text());
    } catch (const UsageError& e) {
        name.refuse(fmt::format("a scene, or a file beside this one ({})", e.what()));
    }
}

}  // namespace umbra
