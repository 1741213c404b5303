// docs/language.md, as far as a program can tell: comments begin with a noun and use the field's words.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// Folders whose comments obey. Others are added when they do.
constexpr std::array kFolders{"core", "tests/core"};

struct Comment {
    std::size_t line = 0, last = 0;  ///< its lines, counted from 1
    std::size_t column = 0;          ///< of its slashes
    std::size_t width  = 0;          ///< of its longest line, in characters
    std::string text;                ///< without slashes, its lines joined by blanks
};

/// The end of what begins at `at` and is not a comment: a literal, or one character.
std::size_t end_of_code(std::string_view text, std::size_t at) {
    const auto word = [&](std::size_t i) {
        return std::isalnum(static_cast<unsigned char>(text[i])) != 0 || text[i] == '_';
    };
    const bool in_word = at > 0 && word(at - 1);
    if (text.substr(at, 2) == "R\"" && !in_word) {
        const std::size_t open    = text.find('(', at);
        const std::string closing = ")" + std::string(text.substr(at + 2, open - at - 2)) + "\"";
        const std::size_t close   = text.find(closing, open);
        return close == std::string_view::npos ? text.size() : close + closing.size();
    }
    const char quote = text[at];
    if (quote != '"' && (quote != '\'' || in_word)) return at + 1;  // 1'000 has no literal in it
    for (++at; at < text.size() && text[at] != quote; ++at)
        if (text[at] == '\\') ++at;
    return at + 1;
}

/// The comments after // of a source, those of lines below one another in one column as one.
std::vector<Comment> comments_of(std::string_view text) {
    std::vector<Comment> comments;
    std::size_t line = 1, begin = 0;  // of the line
    for (std::size_t at = 0; at < text.size();) {
        if (text.substr(at, 2) != "//") {
            const std::size_t next = std::min(end_of_code(text, at), text.size());
            for (; at < next; ++at)
                if (text[at] == '\n') {
                    ++line;
                    begin = at + 1;
                }
            continue;
        }
        const std::size_t end = std::min(text.find('\n', at), text.size()), column = at - begin;
        const bool alone       = text.substr(begin, column).find_first_not_of(' ') == std::string_view::npos;
        const auto width       = static_cast<std::size_t>(std::ranges::count_if(
                  text.substr(begin, end - begin), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
        std::string_view words = text.substr(at, end - at);
        words.remove_prefix(std::min(words.find_first_not_of("/<! "), words.size()));
        if (alone && !comments.empty() && comments.back().last + 1 == line && comments.back().column == column) {
            comments.back().last  = line;
            comments.back().width = std::max(comments.back().width, width);
            comments.back().text += " ";
            comments.back().text += words;
        } else {
            comments.push_back({line, line, column, width, std::string(words)});
        }
        at = end;
    }
    return comments;
}

struct Rule {
    std::regex found;
    std::string_view instead;
};

/// The rows of docs/language.md that a pattern finds in a comment.
const std::vector<Rule>& rules() {
    static const std::vector<Rule> all = [] {
        std::vector<Rule> made;
        const auto add = [&](const char* pattern, std::string_view instead) {
            made.push_back({std::regex(pattern), instead});
        };
        add("^Of ", "begin with the noun: \"Position of ...\"");
        add(R"((?:^|[.:] )What )", "begin with a noun: \"The points that ...\"");
        add(R"(\b(?:of|by|for|from|with|in|on|at|than|beside|behind|besides|beyond|before|after|to|into|as|and|)"
            R"(or|but) what\b)",
            "name the thing: \"of the points that ...\"");
        add(R"(\b(?:is|are|was|were|be|becomes?) no (?!(?:longer|more|less|other|nearer|farther|larger|smaller|)"
            R"(greater|lower|higher|better|worse|slower|faster|wider|shorter)\b)[a-z])",
            "\"is not a ...\", \"expected a ...\"");
        add(R"(\b(?:a|an|the|its|this|what|smallest|largest|least|greatest|their|same|small|large|\w+'s|of|as|)"
            R"(than) shares?\b)",
            "\"fraction\"");
        return made;
    }();
    return all;
}

/// A line for each sentence of a source that breaks a rule.
std::vector<std::string> faults_of(std::string_view text) {
    static const std::regex there(
        R"([Tt]here (?:\w+ )?(?:is|are|was|were|be|been) no )");  // "no" is a part of this phrase
    std::vector<std::string> faults;
    for (const Comment& comment : comments_of(text)) {
        if (comment.width > 120)
            faults.push_back(fmt::format("{}: {} columns, expected at most 120", comment.line, comment.width));
        const std::string words = std::regex_replace(comment.text, there, "");
        for (const Rule& rule : rules()) {
            std::smatch found;
            if (std::regex_search(words, found, rule.found))
                faults.push_back(fmt::format("{}: \"{}\", expected {}", comment.line, found.str(), rule.instead));
        }
    }
    return faults;
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> faults_below(const fs::path& top, const std::string& folder) {
    std::vector<std::string> faults;
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
        if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
        for (const std::string& fault : faults_of(text_of(entry.path())))
            faults.push_back(fs::relative(entry.path(), top).generic_string() + ":" + fault);
    }
    std::ranges::sort(faults);
    return faults;
}

TEST(Language, CommentsFollowThePage) {
    for (const char* folder : kFolders)
        EXPECT_EQ(fmt::format("{}", fmt::join(faults_below(UMBRA_TOP, folder), "\n")), "");
}

TEST(Language, CommentsAreFoundAsBlocksOutsideLiterals) {
    const auto comments = comments_of(
        "/// A point\n/// of the plane.\nint n = 1'000;  ///< a count,\n                ///< at least 1\n"
        "const char* a = \"// none\";\nconst char* b = R\"x(\n// none)\")x\";\nchar c = '\"';  // a quote\n");
    ASSERT_EQ(comments.size(), 3u);
    EXPECT_EQ(comments[0].text, "A point of the plane.");
    EXPECT_EQ(comments[0].line, 1u);
    EXPECT_EQ(comments[0].width, 17u);
    EXPECT_EQ(comments[1].text, "a count, at least 1");
    EXPECT_EQ(comments[1].line, 3u);
    EXPECT_EQ(comments[2].text, "a quote");
    EXPECT_EQ(comments[2].line, 8u);
}

TEST(Language, PlantedFaultsAreFound) {
    const auto first = [](std::string_view comment) {
        const auto faults = faults_of(comment);
        return faults.empty() ? "" : faults.front().substr(0, faults.front().find(", expected"));
    };
    EXPECT_EQ(first("/// Of the next number, or of the end.\n"), "1: \"Of \"");
    EXPECT_EQ(first("/// Position of the next number.\n"), "");
    EXPECT_EQ(first("int a;\n// What a method writes.\n"), "2: \"What \"");
    EXPECT_EQ(first("// A plane. What it holds is written once.\n"), "1: \". What \"");
    EXPECT_EQ(first("// The sum of\n// what arrives.\n"), "1: \"of what\"");
    EXPECT_EQ(first("// Says what is wrong.\n"), "");
    EXPECT_EQ(first("// The index is no\n// whole number.\n"), "1: \"is no w\"");
    EXPECT_EQ(first("// There is no number; there must be no number; the end is no nearer than the light.\n"), "");
    EXPECT_EQ(first("// The largest share of the area.\n"), "1: \"largest share\"");
    EXPECT_EQ(first("// Threads that share a tree.\n"), "");
    EXPECT_EQ(first("// " + std::string(118, 'x') + "\n"), "1: 121 columns");
    EXPECT_EQ(first("// " + std::string(116, 'x') + "\xc3\xa9\n"), "");  // one character of two bytes

    const TemporaryFolder top;
    (void)top.write("core/a/b.h", "// Of a.\n");
    EXPECT_EQ(faults_below(top.path(), "core").size(), 1u);
}

}  // namespace
}  // namespace umbra
