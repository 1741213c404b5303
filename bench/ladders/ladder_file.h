// Ladders that people write: a scene, numbers in it that change from rung to rung, and their values (docs/report.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "umbra/bench/base/record.h"
#include "umbra/bench/lab/chosen.h"
#include "umbra/bench/ladders/ladder.h"

namespace umbra {

struct LadderFileRecord {
    std::string title{}, about{}, unit{};
    FileName scene{};
    std::vector<std::string> set{};
    std::vector<double> rungs{};
};
DESCRIBE(LadderFileRecord) {
    of.name("ladder_file", "a ladder of your own, called as its file is");
    of(MEMBER(title), "default: its name in words");
    of(MEMBER(about), "one or two sentences: what grows, and what it hurts");
    of(MEMBER(unit), "of a rung's value, as read after the number");
    of(MEMBER(scene), "a native scene beside the file, or of ours by name");
    of(MEMBER(set), "JSON Pointers to numbers in the scene; each gets the rung's value");
    of(MEMBER(rungs), "growing or shrinking, harmless first");
}

/// Whether a word of a command line is the file of a ladder, not a ladder's name.
[[nodiscard]] bool is_ladder_file(const std::string& word);

/// The ladder stays to the program's end, as the canonical ones do. Throws InputError.
[[nodiscard]] const Ladder& read_ladder(const std::filesystem::path& file, const FindScene& find);

}  // namespace umbra
