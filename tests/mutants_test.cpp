// The lists of tests/mutants: every change still has its place in the sources, and tests that should notice it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

namespace umbra {
namespace {

namespace fs = std::filesystem;

struct Mutant {
    std::string where, id, file, breaks, tests, kind = "expression";
    std::string context, before, after;
};

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void add_line(std::string& text, const std::string& line) { text += (text.empty() ? "" : "\n") + line; }

std::vector<Mutant> read_list(const fs::path& file) {
    std::vector<Mutant> mutants;
    std::ifstream in(file);
    int number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        const std::string where = file.filename().string() + ":" + std::to_string(number);
        const auto rest         = [&](std::string_view key) { return line.substr(key.size()); };
        if (line.starts_with("[")) {
            const std::size_t end = line.find("] ");
            Mutant& added         = mutants.emplace_back();
            added.where           = where;
            added.id              = line.substr(1, end - 1);
            added.file            = line.substr(end + 2);
        } else if (line.empty() || line.starts_with("#")) {
            continue;
        } else if (mutants.empty()) {
            ADD_FAILURE() << where << ": expected [ID] FILE";
        } else if (line.starts_with("breaks: ")) {
            mutants.back().breaks = rest("breaks: ");
        } else if (line.starts_with("tests: ")) {
            mutants.back().tests = rest("tests: ");
        } else if (line.starts_with("as: ")) {
            mutants.back().kind = rest("as: ");
        } else if (line.starts_with("in ")) {
            add_line(mutants.back().context, rest("in "));
        } else if (line.starts_with("- ")) {
            add_line(mutants.back().before, rest("- "));
        } else if (line.starts_with("+ ")) {
            add_line(mutants.back().after, rest("+ "));
        } else {
            ADD_FAILURE() << where << ": unknown line: " << line;
        }
    }
    return mutants;
}

std::vector<Mutant> all_mutants() {
    std::vector<Mutant> all;
    for (const auto& entry : fs::directory_iterator(fs::path(UMBRA_TOP) / "tests/mutants"))
        if (entry.path().extension() == ".txt") std::ranges::move(read_list(entry.path()), std::back_inserter(all));
    return all;
}

std::size_t times(const std::string& part, const std::string& text) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
}

TEST(Mutants, EachChangesExactlyOnePlace) {
    for (const Mutant& m : all_mutants()) {
        const std::string text = text_of(fs::path(UMBRA_TOP) / m.file);
        const std::string& in  = m.context.empty() ? m.before : m.context;
        ASSERT_FALSE(m.before.empty()) << m.where;
        EXPECT_NE(m.before, m.after) << m.where;
        EXPECT_EQ(times(in, text), 1u) << m.where << ": " << m.id << " is to be found once in " << m.file << ":\n"
                                       << in;
        EXPECT_EQ(times(m.before, in), 1u) << m.where << ": " << m.id << " is to be found once in its context";
    }
}

TEST(Mutants, AreAsManyAsTheChecksPageSays) {
    const std::string said = "changes the program in one of " + std::to_string(all_mutants().size()) + " places";
    EXPECT_EQ(times(said, text_of(fs::path(UMBRA_TOP) / "docs/checks.md")), 1u) << said;
}

TEST(Mutants, EachSaysWhatItBreaksAndWhichTestsNotice) {
    std::set<std::string> programs, ids;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(UMBRA_TOP) / "tests"))
        if (entry.path().extension() == ".cpp") programs.insert(entry.path().stem().string());
    for (const Mutant& m : all_mutants()) {
        EXPECT_TRUE(ids.insert(m.id).second) << m.where << ": " << m.id << " is there already";
        EXPECT_FALSE(m.breaks.empty()) << m.where;
        EXPECT_TRUE(m.kind == "expression" || m.kind == "statement" || m.kind == "alone") << m.where << ": " << m.kind;
        ASSERT_FALSE(m.tests.empty()) << m.where;
        for (std::size_t at = 0; at < m.tests.size();) {
            const std::size_t end     = std::min(m.tests.find(' ', at), m.tests.size());
            const std::string program = m.tests.substr(at, std::min(m.tests.find(':', at), end) - at);
            EXPECT_TRUE(programs.contains(program)) << m.where << ": " << program;
            at = end + 1;
        }
    }
    EXPECT_GE(ids.size(), 80u);
}

}  // namespace
}  // namespace umbra
