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

#include "umbra/bench/record/record.h"
#include "umbra/bench/run/describe.h"

namespace umbra {

struct ExperimentPicture {
    std::string name{};
    FileName file{}, scene{};
};
template <class Fields>
void describe(Fields& of, Is<ExperimentPicture>) {
    of.name("experiment_picture", "one variant of an experiment's scene");
    of("name", &ExperimentPicture::name, "in English");
    of("file", &ExperimentPicture::file, "the picture");
    of("scene", &ExperimentPicture::scene, "the scene file");
}

struct ExperimentCurve {
    std::string name{};
    std::vector<double> x{}, measured{}, formula{};
    std::optional<double> deviation{}, limit{};
};
template <class Fields>
void describe(Fields& of, Is<ExperimentCurve>) {
    of.name("experiment_curve", "values along a line of a picture");
    of("name", &ExperimentCurve::name, "in English");
    of("x", &ExperimentCurve::x, "");
    of("measured", &ExperimentCurve::measured, "empty: a formula alone");
    of("formula", &ExperimentCurve::formula, "null where it leaves the value open");
    of("deviation", &ExperimentCurve::deviation, "the largest of |measured - formula|");
    of("limit", &ExperimentCurve::limit, "that the deviation must stay below");
}

/// How far two pictures are from one another that differ by one thing.
struct ExperimentPair {
    std::string one{}, other{};
    double rmse = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<ExperimentPair>) {
    of.name("experiment_pair", "two pictures of an experiment");
    of("one", &ExperimentPair::one, "its name");
    of("other", &ExperimentPair::other, "its name");
    of("rmse", &ExperimentPair::rmse, "of the sum, scene-linear");
}

struct ExperimentRecord {
    std::string name{}, law{}, x{}, y{};
    std::vector<ExperimentPicture> pictures{};
    std::vector<ExperimentCurve> curves{};
    std::vector<ExperimentPair> pairs{};
};
template <class Fields>
void describe(Fields& of, Is<ExperimentRecord>) {
    of.name("experiment", "of one topic");
    of("name", &ExperimentRecord::name, "the topic's id");
    of("law", &ExperimentRecord::law, "the formula, as people write it");
    of("x", &ExperimentRecord::x, "what is measured over");
    of("y", &ExperimentRecord::y, "what is measured");
    of("pictures", &ExperimentRecord::pictures, "");
    of("curves", &ExperimentRecord::curves, "");
    of("pairs", &ExperimentRecord::pairs, "");
}

struct ExperimentsRecord {
    HeadRecord head{};
    std::vector<ExperimentRecord> experiments{};
    std::vector<ListedFailureRecord> failed{};
};
template <class Fields>
void describe(Fields& of, Is<ExperimentsRecord>) {
    of.all(&ExperimentsRecord::head);
    of("experiments", &ExperimentsRecord::experiments, "");
    of("failed", &ExperimentsRecord::failed, "experiments that are not among these; `scene` is the topic's id");
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
