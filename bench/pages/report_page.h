// What the pages of a report share: a scene's results and where they lie, names of methods, and their totals.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/lab/results.h"
#include "umbra/core/image/image.h"

namespace umbra {

struct ScenePage {
    Field root;                  ///< the whole record, also what only studies have
    Results results{};           ///< of a comparison
    std::filesystem::path data;  ///< the folder that the paths in results.json are relative to
    std::filesystem::path page;  ///< the folder of the page; in the report's folder
    std::string name, title;
    double triangles = 0;
    bool with_exr    = true;  ///< EXRs are copied where the page lies in another folder than the data
};

/// A comparison whose page and files are in one folder.
[[nodiscard]] ScenePage page_in(const std::filesystem::path& folder, const Results& results);

/// Links to the files that one results.json names. They must be there and lie in its folder; where the page is
/// in another folder, they are copied to it. Both arguments must outlive this.
class SceneFiles {
public:
    SceneFiles(const ScenePage& scene, StagedFiles& staged);

    /// The address of a file seen from the folder `from`.
    [[nodiscard]] std::string link(const FileName& file, const std::filesystem::path& from) const;

    /// A picture: whose it is, what it shows, and its description; false where there is none. `from` is the folder
    /// of the page that shows it, by default the scene's own.
    [[nodiscard]] nlohmann::json figure(const FileName& file, const std::string& who, const std::string& what,
                                        const std::string& alt, const std::filesystem::path& from = {}) const;

    /// Rings around wrong interior points that are hard to see on a small class picture, for the template of a picture
    /// (`shapes`) and in words; false where there are none. Throws InputError where the picture cannot be read.
    [[nodiscard]] nlohmann::json rings(const FileName& classes) const;

    /// The entries of the legend that a class picture needs: the classes with a point on it. Throws InputError.
    [[nodiscard]] nlohmann::json legend(const FileName& classes) const;

    /// The address of an EXR; false where it is not there or not to be copied: EXRs are large and may be left out of a
    /// folder that is handed out.
    [[nodiscard]] nlohmann::json exr(const std::optional<FilesRecord>& files) const;

    /// The address of the script of values; false where there is none. Refuses one that calls anything else.
    [[nodiscard]] nlohmann::json values(const FileName& script) const;

    [[nodiscard]] const ScenePage& scene() const { return scene_; }

private:
    /// A file of the record, below its folder; refuses any other.
    [[nodiscard]] std::filesystem::path found(const FileName& file) const;
    [[nodiscard]] std::filesystem::path placed(const FileName& file) const;  ///< beside the page
    [[nodiscard]] Image picture(const FileName& file) const;

    const ScenePage& scene_;
    StagedFiles& staged_;
    nlohmann::json size_ = nlohmann::json::object();  ///< width, height, where the results say them
};

[[nodiscard]] bool serves(const MethodRecord& method);

/// Null where it has none.
[[nodiscard]] const LightFilesRecord* files_of(const std::optional<FilesRecord>& files, const std::string& light);
/// Nothing where it has none.
[[nodiscard]] FileName picture_of(const std::optional<FilesRecord>& files);

/// A method with its settings, as typed; of a record without, its id, which tells apart the runs of one record alone.
[[nodiscard]] std::string setting_text(const MethodRecord& method);

/// Whether entries of `methods`, of any two records, are one method with the same settings: as typed, and in every
/// parameter that both records know.
[[nodiscard]] bool same_setting(const MethodRecord& a, const MethodRecord& b);

/// The entry of `methods` with that setting; null where it was not run.
[[nodiscard]] const MethodRecord* find_setting(const std::vector<MethodRecord>& methods, const MethodRecord& setting);

/// What a method is called on a page: its title, with the settings that are not the defaults.
[[nodiscard]] std::string method_label(const MethodRecord& method, const std::vector<MethodRecord>& methods);

/// The settings of all scenes, an entry of `methods` of each: those that answer on more scenes first, and of equals the
/// one that appears first.
[[nodiscard]] std::vector<MethodRecord> settings_of(const std::vector<ScenePage>& scenes);

/// Sums over the lights of one method on one scene. Interior and edge are never summed.
struct Totals {
    double interior = 0, edge = 0;
    double points = 0;                                     ///< compared; where it is 0, the counts say nothing
    std::optional<double> mae;                             ///< mean over all points of all lights
    std::optional<double> object_ms, light_ms, camera_ms;  ///< time when an object, a light, the camera moves
};
[[nodiscard]] Totals totals(const MethodRecord& method);

/// The objects of an `errors` entry that count wrong points, {interior, edge, and special classes}, in the order of the
/// class table.
inline constexpr std::array<std::string_view, 2> kErrorGroups = {"false_shadow", "false_light"};
/// A count of such an object: interior, edge, acne, detachment, leak; nothing where it is not known.
[[nodiscard]] std::optional<double> wrong_points(const ErrorRecord& error, std::string_view group,
                                                 std::string_view member);

/// The method with the most wrong interior points, of those with a picture that are not the reference; of equals
/// the one with the most at edges, and then the first. Null where there is none.
[[nodiscard]] const MethodRecord* worst_method(const Results& results);

/// A reference may be among the methods of its comparison; it is not compared with itself.
[[nodiscard]] bool is_reference(const Results& results, const MethodRecord& method);

/// Name, colour and meaning of every class of wrong points, as the class pictures have them.
[[nodiscard]] nlohmann::json class_legend();

/// The slider's first pair: a method's picture on the left, the reference's on the right; false where one is missing.
[[nodiscard]] nlohmann::json slider_view(const SceneFiles& files, const MethodRecord* method,
                                         const std::filesystem::path& from = {});

/// The class picture of the light under which the method, called `label`, has the most wrong points in the interior, with its
/// caption, rings and legend; false where there is none. `from` is the folder of the page that shows it.
[[nodiscard]] nlohmann::json class_picture_view(const SceneFiles& files, const MethodRecord& method,
                                                const std::string& label, const std::filesystem::path& from);

/// Commands (one here), machine and version; title, text, exact and note of the reference. Of absolute paths the
/// command shows only the last part.
[[nodiscard]] nlohmann::json run_view(const HeadRecord& head, const MachineRecord& machine);
/// Adds that to a list in which runs of one machine and version share an entry, which lists their commands.
void add_run(nlohmann::json& runs, const HeadRecord& head, const MachineRecord& machine);
[[nodiscard]] nlohmann::json reference_view(const ReferenceRecord& reference);

}  // namespace umbra
