// What a command or a file works on: scenes and their names, methods.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/base/field.h"
#include "umbra/shadows/method.h"

namespace umbra {

/// The canonical scenes in the report's order, as FOLDER/canonical.txt lists them: a file name a line, and behind it
/// names of methods; # begins a comment. Throws InputError.
[[nodiscard]] std::vector<std::filesystem::path> canonical_scenes(const std::filesystem::path& folder);

/// Those of them that are complete in the repository: the teaching scenes. The others, real_NAME, need meshes that are
/// obtained at set-up.
[[nodiscard]] std::vector<std::filesystem::path> teaching_scenes(const std::filesystem::path& folder);

/// `typed` and then `further`. Where both are empty, those that run on each of the scenes that are looked at together:
/// by default, or because the list of canonical scenes beside the file names them there; without a scene all that
/// reports show. Throws UsageError, also where settings contradict one another.
[[nodiscard]] std::vector<MethodChoice> chosen_methods(std::span<const std::string> typed,
                                                       std::span<const MethodChoice> further,
                                                       std::span<const std::filesystem::path> scenes);

/// A scene of a command line, and how it is told from the others.
struct ChosenScene {
    std::filesystem::path file;
    std::string name;  ///< in messages and records: the file's, with -2, -3 and so on where others have it, in any case
    std::string folder;  ///< below the output folder: the same, made fit for a folder
};
/// In the order of `files`. Throws UsageError where one is given twice.
[[nodiscard]] std::vector<ChosenScene> chosen_scenes(std::span<const std::filesystem::path> files);

/// The file of a scene by its name; throws UsageError where there is none.
using FindScene = std::function<std::filesystem::path(const std::string& name)>;

/// The scene that a member of `file` names: a file beside it, or else by `find`. Refuses the member where neither is.
[[nodiscard]] std::filesystem::path scene_beside(const Field& name, const std::filesystem::path& file,
                                                 const FindScene& find);

}  // namespace umbra
