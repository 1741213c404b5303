// docs/lectures.md: every topic once and in order, and nothing named that does not exist.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

struct Row {
    std::string id, topic, source, scene, test, code, state;
};

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

/// What stands between blanks; empty for a dash.
std::string trimmed(std::string cell) {
    cell.erase(0, cell.find_first_not_of(' '));
    cell.erase(cell.find_last_not_of(' ') + 1);
    return cell == "–" ? "" : cell;
}

std::vector<Row> rows_of(const std::string& page) {
    std::vector<Row> rows;
    std::istringstream lines(page);
    for (std::string line; std::getline(lines, line);) {
        if (!std::regex_search(line, std::regex(R"(^\| [A-F]\d)"))) continue;
        std::vector<std::string> cells;
        std::istringstream in(line.substr(1));
        for (std::string cell; std::getline(in, cell, '|');) cells.push_back(trimmed(cell));
        EXPECT_EQ(cells.size(), 7u) << line;
        if (cells.size() == 7) rows.push_back({cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6]});
    }
    return rows;
}

/// `name` in backquotes, or of a link.
std::string name_in(const std::string& cell) {
    std::smatch found;
    return std::regex_search(cell, found, std::regex("`([^`]+)`")) ? found[1].str() : "";
}

std::set<std::string> all_tests() {
    std::set<std::string> tests;
    const std::regex test(R"(TEST(?:_P|_F)?\((\w+), (\w+)\))");
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(UMBRA_TOP) / "tests")) {
        if (entry.path().extension() != ".cpp") continue;
        std::istringstream lines(text_of(entry.path()));
        std::smatch found;
        for (std::string line; std::getline(lines, line);)
            if (line.starts_with("TEST") && std::regex_search(line, found, test))
                tests.insert(found[1].str() + "." + found[2].str());
    }
    return tests;
}

std::vector<std::string> faults_of(const std::vector<Row>& rows) {
    std::vector<std::string> faults, expected;
    for (const auto& [letter, count] : {std::pair{'A', 14}, {'B', 18}, {'C', 12}, {'D', 17}, {'E', 9}, {'F', 8}})
        for (int k = 1; k <= count; ++k) expected.push_back(letter + std::to_string(k));
    std::vector<std::string> ids;
    for (const Row& row : rows) ids.push_back(row.id);
    if (ids != expected) faults.emplace_back("rows are missing, twice, or out of order");
    const std::set<std::string> tests = all_tests();
    for (const Row& row : rows) {
        const bool not_yet = row.state.starts_with("not yet");
        if (!not_yet && row.state != "works" && !row.state.starts_with("in part: "))
            faults.push_back(row.id + ": a state of another name: " + row.state);
        if (!not_yet && (row.test.empty() || row.code.empty())) faults.push_back(row.id + ": no test, or no code");
        if (row.id[0] != 'F' && row.source.empty()) faults.push_back(row.id + ": no source");
        if (!row.test.empty() && !tests.contains(name_in(row.test))) faults.push_back(row.id + ": no such test");
        if (!row.code.empty() && (!fs::exists(fs::path(UMBRA_TOP) / name_in(row.code)) ||
                                  row.code != "[`" + name_in(row.code) + "`](../" + name_in(row.code) + ")"))
            faults.push_back(row.id + ": no such file, or a link elsewhere");
        if (!row.scene.empty() && !fs::exists(fs::path(UMBRA_SCENES) / (name_in(row.scene) + ".json")))
            faults.push_back(row.id + ": no such scene");
    }
    return faults;
}

TEST(LecturesPage, NamesWhatExists) {
    const std::vector<Row> rows = rows_of(text_of(fs::path(UMBRA_TOP) / "docs/lectures.md"));
    EXPECT_EQ(faults_of(rows), std::vector<std::string>());
    for (const Row& row : rows) {
        if (row.scene.empty()) continue;
        EXPECT_NO_THROW((void)load_scene((fs::path(UMBRA_SCENES) / (name_in(row.scene) + ".json")).string()));
    }
}

TEST(LecturesPage, PlantedFaultsAreFound) {
    const std::vector<Row> good = rows_of(text_of(fs::path(UMBRA_TOP) / "docs/lectures.md"));
    const std::vector<std::pair<void (*)(Row&), const char*>> plants{
        {[](Row& row) { row.test = "`Shade.IsNowhere`"; }, "no such test"},
        {[](Row& row) { row.scene = "`nowhere`"; }, "no such scene"},
        {[](Row& row) { row.code = "[`core/nowhere.cpp`](../core/nowhere.cpp)"; }, "no such file"},
        {[](Row& row) { row.state = "almost"; }, "state"},
        {[](Row& row) { row.test.clear(); }, "no test"},
        {[](Row& row) { row.source.clear(); }, "no source"},
        {[](Row& row) { row.id = "A2"; }, "twice"}};
    ASSERT_FALSE(good.empty());
    for (const auto& [plant, word] : plants) {
        std::vector<Row> rows = good;
        plant(rows[0]);
        const auto faults = faults_of(rows);
        ASSERT_EQ(faults.size(), 1u) << word;
        EXPECT_NE(faults[0].find(word), std::string::npos) << faults[0];
    }
}

}  // namespace
}  // namespace umbra
