#include "umbra/bench/run/canonical.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "umbra/core/base/error.h"

namespace umbra {

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

std::vector<std::filesystem::path> teaching_scenes(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> scenes = canonical_scenes(folder);
    std::erase_if(scenes, [](const auto& scene) { return scene.filename().string().starts_with("real_"); });
    return scenes;
}

}  // namespace umbra
