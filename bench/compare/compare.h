// `umbra compare` and `umbra render`: runs methods on a scene, compares them with a reference and writes files.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/reference.h"
#include "umbra/bench/lab/results.h"
#include "umbra/bench/lab/run.h"

namespace umbra {

/// How many rounds of times there are: until `max_runs`, or `budget_ms` for each phase of each method, at least one.
struct Repeats {
    int max_runs     = 6;  // the fewest that a ratio has an interval of
    double budget_ms = 100;
};
inline constexpr Repeats kOnce{1, 0};

struct CompareOptions {
    std::vector<std::string> methods;      ///< as typed
    std::vector<MethodChoice> choices;     ///< after those; where both are empty: all methods with their defaults
    std::vector<MethodChoice> with;        ///< after all of these
    std::optional<std::string> reference;  ///< as typed; none: `default_reference`
    int pixel_samples = 1;                 ///< surface points a pixel in pictures; planes and errors stay at centres
    std::optional<std::uint64_t> points;   ///< at which area lights are scored; none: all, if affordable
    Size size;
    std::filesystem::path out;
    std::string folder;   ///< of the scene, in `out`; empty: the scene's name, made fit for a folder
    std::string command;  ///< for the records
    int threads = 0;
    Budget budget{};  ///< of each method on each scene, and of a reference that nobody names
    Repeats repeats;  ///< of the times
    std::function<void(const std::string&)> progress;  ///< receives status messages; may be empty
    std::function<void(const std::string&)> warn;      ///< receives "SCENE: warning" of loading; may be empty
    /// Adds a page to a folder that is complete except for it, before the folder is moved into place; may be empty.
    std::function<void(const std::filesystem::path&)> add_page{};
    std::function<void()> scene_done{};  ///< after each folder; may be empty
};

/// Compares on one scene and writes OUT/<scene>/: results.json, EXRs and PNGs. The folder is written beside and moved
/// into place; an older result stays whole until then. Each method runs once for its answers, and then all of them in
/// turns for their times (bench/lab/turns.h), of which that run is the first. A method that throws or breaks its
/// contract has an entry that says so (`failed`), and the others go on; a reference that throws is replaced, unless the
/// options name it. Returns the record that it wrote. Throws InputError, UsageError, and what a reference throws that
/// cannot be replaced.
Results compare_scene(const std::filesystem::path& file, const CompareOptions& options);

/// All scenes one after the other, each in a folder of its own name; scenes of one name, in any case, get -2, -3 and so
/// on behind it in the order of `files`. Where there is one only, OUT/results.json is a copy with paths that hold
/// there. Scenes that cannot be read, or on which a method throws, are added to `failed` and skipped; their older
/// results stay. Throws UsageError before the first scene where the methods or the reference are wrong, or a file is
/// given twice.
struct ScenesDone {
    std::vector<std::string> names;    ///< folders below OUT, in order
    std::vector<std::string> failed;   ///< messages
    std::vector<std::string> missing;  ///< messages: scenes whose meshes are not there
    bool internal = false;             ///< at least one of `failed` is no fault of the input: something threw
    std::vector<std::string> stopped;  ///< messages: methods that failed, or were cut short, on a scene, which has
                                       ///< results all the same
};
ScenesDone compare_scenes(const std::vector<std::filesystem::path>& files, const CompareOptions& options);

/// One method's picture of one scene: .exr (docs/exr.md; with geometry where asked) or .png (as displayed).
/// Returns false and the reason where the method does not serve the scene; nothing is written then. Throws InputError,
/// UsageError, and MethodError where the method fails.
struct RenderOptions {
    std::string method = "ray_traced";
    Size size;
    int pixel_samples = 1;  ///< of a PNG; an EXR has pixel centres
    std::filesystem::path out;
    std::string command;
    bool with_geometry = false;
    std::function<void(const std::string&)> warn{};  ///< receives "SCENE: warning" of loading; may be empty
};
[[nodiscard]] Service render_scene(const std::filesystem::path& file, const RenderOptions& options);

}  // namespace umbra
