// `umbra truth` and `umbra score`: S_j at named points with error bounds, as files that anybody can judge answers by
// (docs/truth.md).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/contenders/answers_file.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/bench/lab/prepare.h"

namespace umbra {

struct TruthFileRecord {
    std::string name{}, sha256{};
    std::uint64_t bytes = 0;
};
DESCRIBE(TruthFileRecord) {
    of.name("truth_file", "a file of the scene's folder");
    MEMBERS(name, sha256, bytes);
}

struct TruthLightRecord {
    std::string name{}, kind{};
    double tolerance = kUnknown;
};
DESCRIBE(TruthLightRecord) {
    of.name("truth_light");
    of.must(MEMBER(name));
    MEMBERS(kind);
    of(MEMBER(tolerance), "a point is wrong where it differs by more than this and the half width");
}

struct TruthSceneRecord {
    std::string folder{}, title{}, shows{}, reference{};
    bool exact          = false;
    std::uint64_t width = 0, height = 0, asked = 0;
    std::vector<TruthLightRecord> lights{};
    std::vector<std::string> measures{};
    std::vector<TruthFileRecord> files{};
};
DESCRIBE(TruthSceneRecord) {
    of.name("truth_scene");
    of.must(MEMBER(folder));
    MEMBERS(title, shows);
    of(MEMBER(reference), "the method that the answers are of");
    of(MEMBER(exact), "false: sampled, and the half widths are not bounds");
    MEMBERS(width, height);
    of(MEMBER(asked), "pairs of point and light");
    of(MEMBER(lights), "in the order of the arrays");
    of(MEMBER(measures), "area; irradiance too where a light has an area");
    MEMBERS(files);
}

struct TruthSetRecord {
    HeadRecord head{};
    std::string license{};
    bool withheld = false;
    std::vector<TruthSceneRecord> scenes{};
    std::vector<std::string> files{};
};
DESCRIBE(TruthSetRecord) {
    of.all(&R::head);
    of(MEMBER(license), "of the set, as its maker says");
    of(MEMBER(withheld), "true: the answers are in another folder");
    MEMBERS(scenes);
    of(MEMBER(files), "beside this record");
}

struct TruthOrder {
    std::vector<std::filesystem::path> scenes;
    Size size;
    std::filesystem::path out;
    std::filesystem::path withhold;  ///< where the answers go; empty: beside the questions
    std::string license = "not stated";
    std::string command;
    std::function<void(const std::string&)> progress;  ///< may be empty
};

/// Writes the set, whole or not at all. Throws InputError, UsageError, and what the reference throws.
TruthSetRecord write_truth(const TruthOrder& order);

/// What one contender's answers are worth at one light.
struct ScoreRecord {
    std::string contender{}, scene{}, light{}, measure{};
    std::uint64_t points = 0, undefined = 0, boundary = 0;
    std::uint64_t false_shadow = 0, false_light = 0, edge = 0;
    double mae = kUnknown, rmse = kUnknown, bias = kUnknown, max = kUnknown;
};
DESCRIBE(ScoreRecord) {
    of.name("score", "answers beside the truth, at one light");
    MEMBERS(contender, scene, light, measure);
    of(MEMBER(points), "that are judged");
    of(MEMBER(undefined), "NaN in the answers");
    of(MEMBER(boundary), "points on the boundary of a shadow, where nobody is judged");
    of(MEMBER(false_shadow), "wrong and too dark, outside of the edge band");
    of(MEMBER(false_light), "wrong and too bright, outside of the edge band");
    of(MEMBER(edge), "wrong, in the edge band");
    MEMBERS(mae, rmse);
    of(MEMBER(bias), "mean of the answer less the truth");
    MEMBERS(max);
}

/// One entry a contender, scene and light. Each names a folder with SCENE.npy for each scene, or one file where the set has
/// one scene. Throws InputError where files do not fit the set, or differ from its
/// checksums.
[[nodiscard]] std::vector<ScoreRecord> score(const std::filesystem::path& set, std::span<const NamedAnswers> answers);

}  // namespace umbra
