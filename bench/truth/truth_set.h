// `umbra truth` and `umbra score`: S_j at named points with error bounds, as files that anybody can judge answers by
// (docs/truth.md).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "umbra/bench/contenders/answers_file.h"
#include "umbra/bench/record/record.h"
#include "umbra/bench/run/describe.h"
#include "umbra/bench/run/prepare.h"

namespace umbra {

struct TruthFileRecord {
    std::string name{}, sha256{};
    std::uint64_t bytes = 0;
};
template <class Fields>
void describe(Fields& of, Is<TruthFileRecord>) {
    of.name("truth_file", "a file of the scene's folder");
    of("name", &TruthFileRecord::name, "");
    of("sha256", &TruthFileRecord::sha256, "");
    of("bytes", &TruthFileRecord::bytes, "");
}

struct TruthLightRecord {
    std::string name{}, kind{};
    double tolerance = kUnknown;
};
template <class Fields>
void describe(Fields& of, Is<TruthLightRecord>) {
    of.name("truth_light", "");
    of.must("name", &TruthLightRecord::name, "");
    of("kind", &TruthLightRecord::kind, "");
    of("tolerance", &TruthLightRecord::tolerance,
       "a point is wrong where it differs by more than this and the half width");
}

struct TruthSceneRecord {
    std::string folder{}, title{}, shows{}, reference{};
    bool exact          = false;
    std::uint64_t width = 0, height = 0, asked = 0;
    std::vector<TruthLightRecord> lights{};
    std::vector<std::string> measures{};
    std::vector<TruthFileRecord> files{};
};
template <class Fields>
void describe(Fields& of, Is<TruthSceneRecord>) {
    of.name("truth_scene", "");
    of.must("folder", &TruthSceneRecord::folder, "");
    of("title", &TruthSceneRecord::title, "");
    of("shows", &TruthSceneRecord::shows, "");
    of("reference", &TruthSceneRecord::reference, "the method that the answers are of");
    of("exact", &TruthSceneRecord::exact, "false: sampled, and the half widths are not bounds");
    of("width", &TruthSceneRecord::width, "");
    of("height", &TruthSceneRecord::height, "");
    of("asked", &TruthSceneRecord::asked, "pairs of point and light");
    of("lights", &TruthSceneRecord::lights, "in the order of the arrays");
    of("measures", &TruthSceneRecord::measures, "area; irradiance too where a light has an area");
    of("files", &TruthSceneRecord::files, "");
}

struct TruthSetRecord {
    HeadRecord head{};
    std::string license{};
    bool withheld = false;
    std::vector<TruthSceneRecord> scenes{};
    std::vector<std::string> files{};
};
template <class Fields>
void describe(Fields& of, Is<TruthSetRecord>) {
    of.all(&TruthSetRecord::head);
    of("license", &TruthSetRecord::license, "of the set, as its maker says");
    of("withheld", &TruthSetRecord::withheld, "true: the answers are in another folder");
    of("scenes", &TruthSetRecord::scenes, "");
    of("files", &TruthSetRecord::files, "beside this record");
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
template <class Fields>
void describe(Fields& of, Is<ScoreRecord>) {
    of.name("score", "answers beside the truth, at one light");
    of("contender", &ScoreRecord::contender, "");
    of("scene", &ScoreRecord::scene, "");
    of("light", &ScoreRecord::light, "");
    of("measure", &ScoreRecord::measure, "");
    of("points", &ScoreRecord::points, "that are judged");
    of("undefined", &ScoreRecord::undefined, "NaN in the answers");
    of("boundary", &ScoreRecord::boundary, "points on the boundary of a shadow, where nobody is judged");
    of("false_shadow", &ScoreRecord::false_shadow, "wrong and too dark, outside of the edge band");
    of("false_light", &ScoreRecord::false_light, "wrong and too bright, outside of the edge band");
    of("edge", &ScoreRecord::edge, "wrong, in the edge band");
    of("mae", &ScoreRecord::mae, "");
    of("rmse", &ScoreRecord::rmse, "");
    of("bias", &ScoreRecord::bias, "mean of the answer less the truth");
    of("max", &ScoreRecord::max, "");
}

/// One entry a contender, scene and light. Each names a folder with SCENE.npy for each scene, or one file where the set has
/// one scene. Throws InputError where files do not fit the set, or differ from its
/// checksums.
[[nodiscard]] std::vector<ScoreRecord> score(const std::filesystem::path& set, std::span<const NamedAnswers> answers);

}  // namespace umbra
