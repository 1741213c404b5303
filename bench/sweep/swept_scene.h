// A sweep over one scene as the page of sweeps reads it from results.json: settings with their errors and their cost.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/sweep/sweep_results.h"

namespace umbra {

/// A column of the sweep's errors; less is better.
struct SweptMetric {
    std::string name;   ///< as in results.json: "edge_displacement_px.p95"
    std::string title;  ///< "Edge displacement (95 %), pixels"
    std::string doc;    ///< one sentence; may be empty
};

/// Milliseconds a frame of the workload: from the medians of the phases, and the quartiles over the rounds.
struct FrameCost {
    double median = 0, low = 0, high = 0;
};

/// One metric of one setting over the views. Not negative.
struct SweptError {
    double least = 0, worst = 0;
    std::optional<double> bound{};  ///< at least `worst`; nothing where no bound is known
    bool at_least = false;          ///< in a view it may be more than is known: `worst` is the least that it may be
};

/// A setting's record, where `title` and a reason in `excluded` are never empty, and what follows from it.
struct SweptSetting : SweptSettingRecord {
    std::string label{};              ///< what differs from the defaults: "resolution=512", or "defaults"
    std::string note{};               ///< why it has no figures: not served, or it failed; empty where it has
    std::optional<FrameCost> cost{};  ///< nothing where it was not timed
    std::vector<std::optional<SweptError>> errors{};  ///< [metric]
};

struct SweptScene {
    HeadRecord head;
    MachineRecord machine;
    std::filesystem::path file;  ///< the results.json
    std::string name, title;
    double triangles = 0;
    int views        = 1;
    std::optional<double> noise_bar{};  ///< of a ratio of two times, as a fraction
    Workload workload{};
    std::vector<SweptMetric> metrics{};
    std::vector<SweptSetting> settings{};
};

/// Reads a results.json with a member `sweep`. Of the metrics, those that pages show: rmse, interior,
/// edge_displacement_px.p95, flip; all, where none of these is there. Throws InputError naming file and position.
[[nodiscard]] SweptScene read_swept_scene(const std::filesystem::path& file);

/// Methods of all scenes, by name: those that were timed on more scenes first, and of equals the one that appears
/// first. An index is a method's mark on all charts.
struct SweptMethod {
    std::string name, title;
};
[[nodiscard]] std::vector<SweptMethod> swept_methods(const std::vector<SweptScene>& scenes);
[[nodiscard]] bool is_timed_on(const SweptScene& scene, const SweptMethod& method);
/// The number of methods where none has the name.
[[nodiscard]] std::size_t index_of(const std::vector<SweptMethod>& methods, const std::string& name);

}  // namespace umbra
