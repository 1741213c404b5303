// `umbra bias`: false shadow (acne) of the shadow z-buffer against its false light (detachment) over what bias can be,
// as a record of counts of wrong points.
//
// Settings of the visibility phase alone reuse the maps that are there; the truth is the default reference.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/studies/study_report.h"
#include "umbra/core/errors/visibility_error.h"

namespace umbra {

/// Wrong points over all lights of a scene.
struct BiasErrors {
    VisibilityError::Kind false_shadow, false_light;
    [[nodiscard]] std::uint64_t interior() const { return false_shadow.interior + false_light.interior; }
    [[nodiscard]] std::uint64_t edge() const { return false_shadow.edge + false_light.edge; }
    BiasErrors& operator+=(const BiasErrors& other);
};
DESCRIBE(BiasErrors) { MEMBERS(false_shadow, false_light); }

/// One setting of bias=manual, and what it costs.
struct BiasCell {
    double constant = 0, slope = 0, normal_offset = 0;
    BiasErrors errors;
};
DESCRIBE(BiasCell) {
    of.all(&R::errors);
    MEMBERS(constant, slope, normal_offset);
}

struct BiasSliceRecord {
    double normal_offset = 0;
    std::vector<std::vector<BiasErrors>> rows{};
};
DESCRIBE(BiasSliceRecord) {
    MEMBERS(normal_offset);
    of(MEMBER(rows), "one a slope, with an entry a constant");
}

struct BiasSceneRecord {
    std::string scene{}, title{};
    std::vector<std::string> lights{};
    std::uint64_t points = 0;
    BiasErrors automatic{}, receiver_plane{};
    BiasCell best_manual{};  ///< of equal ones with the fewest wrong points at edges, then with the smaller bias
    std::uint64_t settings = 0, settings_better_than_automatic = 0;  ///< the latter: fewer wrong interior points
    std::vector<BiasSliceRecord> slices{};
};
DESCRIBE(BiasSceneRecord) {
    MEMBERS(scene, title, lights);
    of(MEMBER(points), "judged, over all lights");
    of(MEMBER(automatic), "bias=auto");
    of(MEMBER(receiver_plane), "bias=receiver_plane");
    of(MEMBER(best_manual), "bias=manual with the fewest wrong interior points");
    MEMBERS(settings, settings_better_than_automatic);
    of(MEMBER(slices), "one a normal offset");
}

struct BiasGrid {
    /// 0, then twice as much each time: widths of a sample, depth gradients a sample, widths of a sample.
    std::vector<double> constants, slopes, normal_offsets;
};
DESCRIBE(BiasGrid) {
    of(MEMBER(constants), "widths of a sample");
    of(MEMBER(slopes), "depth gradients a sample");
    of(MEMBER(normal_offsets), "widths of a sample");
}
/// The settings that are studied.
[[nodiscard]] BiasGrid bias_grid();

struct BiasRecord {
    HeadRecord head{};
    MachineRecord machine{};
    SizeRecord size{};
    std::string map{};
    BiasGrid grid{};
    std::vector<BiasSceneRecord> bias{};
    std::vector<ListedFailureRecord> failed{};
    std::vector<std::string> csv{};
};
DESCRIBE(BiasRecord) {
    of.all(&R::head);
    MEMBERS(machine, size);
    of(MEMBER(map), "settings of shadow_zbuffer, as typed");
    of.all(&R::grid);
    of(MEMBER(bias), "all scenes added up, where there are several, and each of them");
    MEMBERS(failed, csv);
}

struct BiasOptions {
    Size size{320, 180};
    std::string map;  ///< settings of shadow_zbuffer other than bias, "k=v,k=v"; may be empty
    std::filesystem::path out;
    std::string command;  ///< for the record
    int threads = 0;
    std::function<void(const std::string&)> progress;  ///< receives status messages
};

/// Throws UsageError where the settings are wrong, set a bias, or exclude one of the grid.
void check_bias_map(const std::string& settings);

/// Studies the scenes and writes OUT/results.json, OUT/bias.csv and the page OUT/index.html. Returns the record. The
/// messages of unreadable scenes, or scenes whose meshes are missing, are appended to `failed`; these are skipped.
/// Scenes on which a method threw are in the record's `failed`; without any study nothing is written. Area lights are
/// taken for points in their centres, as the method takes them: the study is of bias, not of penumbrae. Throws
/// UsageError, InputError.
BiasRecord study_biases(const std::vector<std::filesystem::path>& files, const BiasOptions& options,
                        std::vector<std::string>& failed);

/// Of the record of `umbra bias` alone.
[[nodiscard]] StudyReport bias_report(const BiasRecord& record);

}  // namespace umbra
