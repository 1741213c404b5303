#include "umbra/bench/run/canonical.h"

#include <fmt/format.h>

#include <fstream>

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
        if (!line.empty() && line[0] != '#') scenes.push_back(folder / line);
    return scenes;
}

std::vector<std::filesystem::path> teaching_scenes(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> scenes = canonical_scenes(folder);
    std::erase_if(scenes, [](const auto& scene) { return scene.filename().string().starts_with("real_"); });
    return scenes;
}

}  // namespace umbra
