// Scenes and methods over commits: what became slower, faster or wrong, from kept records of `umbra compare`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace umbra {

/// One scene under one method at one commit, against the first commit whose cell has answers.
struct HistoryCell {
    enum class Kind : std::uint8_t {
        absent,   ///< the commit's folder has no such scene or method
        refused,  ///< not served
        wrong,    ///< failed, or a larger fraction of wrong points outside the edge band than the first
        slower,
        equal,  ///< in its time, as far as noise tells
        faster
    } kind       = Kind::absent;
    double ms    = 0;  ///< median of build, aim and visibility, all lights together, as on the first commit's machine
    double ratio = 1;  ///< over the first
    double wrong = 0;  ///< fraction of the compared points
    std::string says = {};  ///< why it is refused or wrong
};
struct HistoryRow {
    std::string scene, method;
    std::vector<HistoryCell> cells;  ///< one a commit
};
struct History {
    std::vector<std::string> commits;  ///< names of the folders, in the order in which they were given
    std::vector<HistoryRow> rows;      ///< in the order in which scenes and methods first appear
};

/// Reads FOLDER/results.json and FOLDER/SCENE/results.json of each folder; records of other commands are passed over.
/// Times are over the calibration of their own run, so that a slower machine is none in the code; a time differs where
/// the interval of its ratio excludes 1 and the ratio lies outside the noise bars of both runs. Throws InputError, also
/// where a folder has no record.
[[nodiscard]] History read_history(const std::vector<std::filesystem::path>& folders);

/// A page of its own: grey not served, blue the fastest of its row, white the slowest, red wrong.
[[nodiscard]] std::string history_page(const History& history);

/// A line a commit with its counts, then a line a cell that is wrong or slower.
[[nodiscard]] std::string history_text(const History& history);

}  // namespace umbra
