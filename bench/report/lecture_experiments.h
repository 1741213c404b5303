// The experiments of the lectures, of bench/report/lectures/experiments.json: small scenes that differ by the one thing
// that a topic is about, drawn, and measured along a line of the picture beside the topic's formula.
//
// An experiment has a `scene` (merged into that of `base`, or the name of a scene file) and `variants`: what each `set`s
// in it, by JSON pointers. Of each variant `value` is measured at the pixels (i, j) along `line`, which are R, G, B of
// the sum, r, g, b as displayed, made linear again, and S of the first light; `formula` is what is expected there, and
// nan (0/0) where it leaves the value open. Names in both are those of `let`. Where a variant has `frames`, the mean
// along the line is measured, frame by frame, k. `also` has formulas that nothing is measured beside. What an
// experiment lacks is that of `base`, what a variant lacks that of the experiment.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/describe.h"

namespace umbra {

struct ExperimentPicture {
    std::string name{};
    FileName file{}, scene{};
};
DESCRIBE(ExperimentPicture) {
    of.name("experiment_picture", "one variant of an experiment's scene");
    of(MEMBER(name), "in English");
    of(MEMBER(file), "the picture");
    of(MEMBER(scene), "the scene file");
}

struct ExperimentCurve {
    std::string name{};
    std::vector<double> x{}, measured{}, formula{};
    std::optional<double> deviation{}, limit{};
};
DESCRIBE(ExperimentCurve) {
    of.name("experiment_curve", "values along a line of a picture");
    of(MEMBER(name), "in English");
    MEMBERS(x);
    of(MEMBER(measured), "empty: a formula alone");
    of(MEMBER(formula), "null where it leaves the value open");
    of(MEMBER(deviation), "the largest of |measured - formula|");
    of(MEMBER(limit), "that the deviation must stay below");
}

/// How far two pictures are from one another that differ by one thing.
struct ExperimentPair {
    std::string one{}, other{};
    double rmse = kUnknown;
};
DESCRIBE(ExperimentPair) {
    of.name("experiment_pair", "two pictures of an experiment");
    of(MEMBER(one), "its name");
    of(MEMBER(other), "its name");
    of(MEMBER(rmse), "of the sum, scene-linear");
}

struct ExperimentRecord {
    std::string name{}, law{}, x{}, y{};
    std::vector<ExperimentPicture> pictures{};
    std::vector<ExperimentCurve> curves{};
    std::vector<ExperimentPair> pairs{};
};
DESCRIBE(ExperimentRecord) {
    of.name("experiment", "of one topic");
    of(MEMBER(name), "the topic's id");
    of(MEMBER(law), "the formula, as people write it");
    of(MEMBER(x), "what is measured over");
    of(MEMBER(y), "what is measured");
    MEMBERS(pictures, curves, pairs);
}

struct ExperimentsRecord {
    HeadRecord head{};
    std::vector<ExperimentRecord> experiments{};
    std::vector<ListedFailureRecord> failed{};
};
DESCRIBE(ExperimentsRecord) {
    of.all(&R::head);
    MEMBERS(experiments);
    of(MEMBER(failed), "experiments that are not among these; `scene` is the topic's id");
}

/// {base, experiments: {A1: ...}}.
[[nodiscard]] const nlohmann::json& lecture_experiments();

/// Draws and measures one, with what it lacks from `base`. Pictures and scene files are written into `folder`; scenes
/// that it names are NAME.json of `scenes`. Throws InputError, also where a formula cannot be read.
[[nodiscard]] ExperimentRecord run_experiment(const std::string& id, const nlohmann::json& experiment,
                                              const nlohmann::json& base, const std::filesystem::path& folder,
                                              const std::filesystem::path& scenes);

/// All of them, into the folder `out`, which appears whole or not at all, with a results.json. Returns those that failed.
std::vector<ListedFailureRecord> draw_experiments(const std::filesystem::path& out, const std::filesystem::path& scenes,
                                                  const std::string& command);

}  // namespace umbra
