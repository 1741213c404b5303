// What the pages of a report share: a scene's results and where they lie, what methods are called, and their totals.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/out/staged_files.h"
#include "umbra/bench/run/results_file.h"

namespace umbra {

struct ScenePage {
    Field root;
    std::filesystem::path data;  ///< the folder that the paths in results.json are relative to
    std::filesystem::path page;  ///< the folder of the page; in the report's folder
    std::string name, title;
    double triangles = 0;
};

/// Links to the files that one results.json names. They must be there and lie in its folder; where the page stands
/// elsewhere they are copied to it. Both arguments must outlive this.
class SceneFiles {
public:
    SceneFiles(const ScenePage& scene, StagedFiles& staged);

    /// The address of a file seen from the folder `from`.
    [[nodiscard]] std::string link(const Field& file, const std::filesystem::path& from) const;

    /// A picture with what it is of, what it shows, and what is seen on it; false where there is none.
    [[nodiscard]] nlohmann::json figure(const Field& file, const std::string& who, const std::string& what,
                                        const std::string& alt) const;

    /// The address of `files/exr`; false where it is not there. EXRs are large and may have been left out of a folder
    /// that is handed out.
    [[nodiscard]] nlohmann::json exr(const Field& files) const;

    [[nodiscard]] const ScenePage& scene() const { return scene_; }

private:
    const ScenePage& scene_;
    StagedFiles& staged_;
    nlohmann::json size_ = nlohmann::json::object();  ///< width, height, where the results say them
};

[[nodiscard]] bool serves(const Field& method);
[[nodiscard]] std::string method_id(const Field& method);

/// What a method is called on a page. Where one method runs with several settings, these tell the runs apart.
[[nodiscard]] std::string method_label(const Field& method, const std::vector<Field>& methods);

/// The methods of all scenes in the order in which they first appear, by their ids.
[[nodiscard]] std::vector<std::string> method_ids(const std::vector<ScenePage>& scenes);

/// Sums over the lights of one method on one scene. Interior and edge are never added up.
struct Totals {
    double interior = 0, edge = 0;
    std::optional<double> mae;                             ///< mean over all points of all lights
    std::optional<double> object_ms, light_ms, camera_ms;  ///< what it costs when an object, a light, the camera moves
};
[[nodiscard]] Totals totals(const Field& method);

/// The reference of a comparison may be among its methods, too; it is not held against itself.
[[nodiscard]] bool is_reference(const Field& root, const Field& method);

/// Name and colour of every class of errors, as the class pictures have them.
[[nodiscard]] nlohmann::json class_legend();

/// Command, machine and version; title, text, exact and note of the reference.
[[nodiscard]] nlohmann::json run_view(const Field& root);
[[nodiscard]] nlohmann::json reference_view(const Field& root);

}  // namespace umbra
