#include "umbra/bench/ladders/ladder_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <nlohmann/json.hpp>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/record.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Growing, or shrinking.
bool are_in_order(const std::vector<double>& rungs) {
    return rungs.size() > 1 && std::ranges::all_of(rungs, [](double rung) { return std::isfinite(rung); }) &&
           (std::ranges::adjacent_find(rungs, std::greater_equal()) == rungs.end() ||
            std::ranges::adjacent_find(rungs, std::less_equal()) == rungs.end());
}

/// Refuses a pointer that leads to no number in the scene.
void check_pointer(const Field& pointer, const json& scene, const fs::path& file) {
    const std::string expected = fmt::format("the JSON Pointer of a number in {}", file.string());
    try {
        if (!scene.at(json::json_pointer(pointer.required_text())).is_number()) pointer.refuse(expected);
    } catch (const json::exception&) {
        pointer.refuse(expected);
    }
}

}  // namespace

bool is_ladder_file(const std::string& word) { return fs::path(word).extension() == ".json"; }

const Ladder& read_ladder(const fs::path& file, const FindScene& find) {
    if (!fs::is_regular_file(file)) throw InputError(fmt::format("{}: is not there, or is no file", file.string()));
    static std::deque<Ladder> all;
    const Field root  = parse_json(bytes_of(file), file.string());
    const auto record = from_strict_record<LadderFileRecord>(root);
    const fs::path at = scene_beside(root["scene"], file, find);
    if (at.extension() != ".json") root["scene"].refuse("a native scene (.json), whose numbers \"set\" can name");
    static_cast<void>(load_scene(at));  // what is wrong with the scene has a line in its own file
    const json scene = json::parse(bytes_of(at));
    if (record.set.empty()) root["set"].refuse("a list with the JSON Pointer of at least one number of the scene");
    for (const Field& pointer : root["set"].items()) check_pointer(pointer, scene, at);
    if (!are_in_order(record.rungs)) root["rungs"].refuse("at least two numbers, growing or shrinking");
    Ladder ladder{.name  = folder_name(file.stem().string()),
                  .title = record.title,
                  .about = record.about,
                  .unit  = record.unit,
                  .rungs = record.rungs,
                  .scene = [at, scene, set = record.set](double rung) {
                      json changed = scene;
                      for (const std::string& pointer : set) changed[json::json_pointer(pointer)] = rung;
                      return load_scene(at, changed.dump(2));
                  }};
    if (ladder.title.empty()) ladder.title = in_words(ladder.name);
    if (ladder.about.empty())
        ladder.about = fmt::format("{} of {} changes.", fmt::join(record.set, ", "), at.filename().string());
    return all.emplace_back(std::move(ladder));
}

}  // namespace umbra
