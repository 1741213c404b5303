// Names on the command line: scenes, what a list of methods swallowed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace umbra {

/// Folder of the canonical scenes: $UMBRA_SCENES, else that of the source tree this was built from.
[[nodiscard]] std::filesystem::path scenes_folder();
/// Folder of the goldens: $UMBRA_GOLDEN, else that of the source tree this was built from.
[[nodiscard]] std::filesystem::path golden_folder();

[[nodiscard]] std::vector<std::string> canonical_names();  ///< empty where the list of them cannot be read
/// All .json files of scenes_folder(): the canonical scenes in their order, then the others in the alphabet's.
[[nodiscard]] std::vector<std::string> scene_names();
/// The names of entries, such as those of methods(), or of what they point to.
template <class Entries>
[[nodiscard]] std::vector<std::string> names_of_entries(const Entries& entries) {
    std::vector<std::string> names;
    for (const auto& entry : entries)
        if constexpr (requires { entry->name; })
            names.emplace_back(entry->name);
        else
            names.emplace_back(entry.name);
    return names;
}

/// The file that SCENE names: itself where there is such a file; else the scene of that name in scenes_folder(); else,
/// where it looks like a file name (a separator or an extension), itself. Throws UsageError with near matches.
/// With another axis `up` than y it is FILE@up, and UsageError where it is no mesh file.
[[nodiscard]] std::filesystem::path scene_file(const std::string& scene, const std::string& up = "y");
/// SCENE@FIRST..LAST as SCENE@FIRST, SCENE@FIRST+1 and so on; anything else as itself. Throws UsageError.
[[nodiscard]] std::vector<std::string> frames_of(const std::string& scene);
/// The files of all of them, frames_of each. `up` is for the mesh files among them, of which there must be one.
[[nodiscard]] std::vector<std::filesystem::path> scene_files(const std::vector<std::string>& scenes,
                                                             const std::string& up = "y");

/// An option that takes a list also takes the positionals that follow it. Moves to `positionals` what is a scene (a
/// file, or a name in scenes_folder()) and no method.
void return_scenes(std::vector<std::string>& methods, std::vector<std::string>& positionals);
/// The same for ladders.
void return_ladders(std::vector<std::string>& methods, std::vector<std::string>& positionals);

}  // namespace umbra
