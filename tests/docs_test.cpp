// The pages: each is reached from docs/README.md, each link leads somewhere, and the lists of methods and commands are
// whole.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> lines_of(const fs::path& file) {
    std::vector<std::string> lines;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

/// The lines of a page outside code blocks, fenced or indented.
std::vector<std::string> prose_of(const fs::path& page) {
    std::vector<std::string> prose;
    bool fenced = false;
    for (const std::string& line : lines_of(page)) {
        if (line.starts_with("```")) fenced = !fenced;
        if (!fenced && !line.starts_with("    ")) prose.push_back(line);
    }
    return prose;
}

struct Link {
    std::string file, anchor;  ///< file: relative to the top folder; anchor: without '#', may be empty
};

/// The links of a page to files of this repository.
std::vector<Link> links_of(const fs::path& top, const std::string& page) {
    static const std::regex link(R"(\]\(([^()\s#]*)(?:#([^()\s]*))?\))");
    std::vector<Link> links;
    for (const std::string& line : prose_of(top / page))
        for (std::sregex_iterator at(line.begin(), line.end(), link), end; at != end; ++at) {
            const std::string target = (*at)[1].str();
            if (target.find("://") != std::string::npos) continue;
            const fs::path file =
                target.empty() ? fs::path(page) : (fs::path(page).parent_path() / target).lexically_normal();
            links.push_back({file.generic_string(), (*at)[2].str()});
        }
    return links;
}

/// The anchor that GitHub gives a heading: lower case, blanks become hyphens, other punctuation is dropped.
std::string anchor_of(std::string_view heading) {
    std::string anchor;
    for (const char c : heading) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == ' ' || c == '-')
            anchor += '-';
        else if (std::isalnum(byte) || c == '_' || byte >= 0x80)
            anchor += static_cast<char>(byte < 0x80 ? std::tolower(byte) : byte);
    }
    return anchor;
}

bool has_anchor(const fs::path& page, const std::string& anchor) {
    const std::vector<std::string> prose = prose_of(page);
    return std::ranges::any_of(prose, [&](const std::string& line) {
        if (line.find("<a id=\"" + anchor + "\"") != std::string::npos) return true;
        const std::size_t level = line.find_first_not_of('#');
        return level > 0 && level != std::string::npos && line[level] == ' ' &&
               anchor_of(std::string_view(line).substr(level + 1)) == anchor;
    });
}

/// Pages below `top`, relative to it: of the top folder, docs/, results/ and scenes/, and the README of each folder of
/// tests/.
std::vector<std::string> pages(const fs::path& top) {
    std::vector<fs::path> folders{"", "docs", "results", "scenes"};
    if (fs::exists(top / "tests"))
        for (const auto& entry : fs::directory_iterator(top / "tests"))
            if (entry.is_directory()) folders.push_back(fs::path("tests") / entry.path().filename());
    std::vector<std::string> found;
    for (const fs::path& folder : folders)
        if (fs::exists(top / folder))
            for (const auto& entry : fs::directory_iterator(top / folder))
                if (entry.path().extension() == ".md")
                    found.push_back((folder / entry.path().filename()).generic_string());
    std::ranges::sort(found);
    return found;
}

/// A line for each page that no chain of links from docs/README.md reaches, and for each link that leads nowhere.
std::vector<std::string> faults_of_links(const fs::path& top) {
    std::vector<std::string> faults;
    std::set<std::string> reached{"docs/README.md"};
    std::vector<std::string> open{"docs/README.md"};
    while (!open.empty()) {
        const std::string page = open.back();
        open.pop_back();
        for (const Link& link : links_of(top, page))
            if (link.file.ends_with(".md") && fs::exists(top / link.file) && reached.insert(link.file).second)
                open.push_back(link.file);
    }
    for (const std::string& page : pages(top)) {
        if (!reached.contains(page)) faults.push_back(page + ": no chain of links from docs/README.md leads here");
        for (const Link& link : links_of(top, page)) {
            if (!fs::exists(top / link.file))
                faults.push_back(fmt::format("{}: link to {}, which does not exist", page, link.file));
            else if (!link.anchor.empty() && link.file.ends_with(".md") && !has_anchor(top / link.file, link.anchor))
                faults.push_back(
                    fmt::format("{}: link to {}#{}, a heading that is missing there", page, link.file, link.anchor));
        }
    }
    return faults;
}

/// The names that `row` captures, in the order of the page.
std::vector<std::string> names_in(const std::vector<std::string>& lines, const std::regex& row) {
    std::vector<std::string> names;
    std::smatch found;
    for (const std::string& line : lines)
        if (std::regex_search(line, found, row)) names.push_back(found[1].str());
    return names;
}

TEST(Docs, EveryPageIsReachedAndEveryLinkLeadsSomewhere) {
    ASSERT_GT(pages(UMBRA_TOP).size(), 25u);
    EXPECT_EQ(fmt::format("{}", fmt::join(faults_of_links(UMBRA_TOP), "\n")), "");
}

TEST(Docs, TheReadmeIsAScreenAndAHalf) {
    const std::vector<std::string> lines = lines_of(fs::path(UMBRA_TOP) / "README.md");
    EXPECT_LE(lines.size(), 60u);
    for (const std::string& line : lines)
        EXPECT_TRUE(line.size() <= 140 || line.starts_with("![")) << line;  // what a long line hides is length too
}

TEST(Docs, TheMethodsPageHasEveryMethodInTheOrderOfTheReport) {
    const auto listed =
        names_in(lines_of(fs::path(UMBRA_TOP) / "shadows/methods.def"), std::regex(R"(^METHOD\((\w+)\))"));
    ASSERT_GT(listed.size(), 10u);
    EXPECT_EQ(names_in(prose_of(fs::path(UMBRA_TOP) / "docs/methods.md"), std::regex(R"(^\| `(\w+)` \|)")), listed);
}

TEST(Docs, TheCommandsPageHasEveryCommand) {
    auto listed =
        names_in(lines_of(fs::path(UMBRA_TOP) / "bench/cli/commands.def"), std::regex(R"(^COMMAND\((\w+), )"));
    auto shown = names_in(lines_of(fs::path(UMBRA_TOP) / "docs/commands.md"), std::regex(R"(^    umbra (\w+))"));
    ASSERT_GT(listed.size(), 15u);
    std::ranges::sort(listed);
    std::ranges::sort(shown);
    EXPECT_EQ(shown, listed);
}

/// "FILE: PATH" for each path below core, shadows or bench that a comment names and that does not exist.
std::vector<std::string> lost_paths(const fs::path& top) {
    static const std::regex path(R"((?:^|[^\w/])((?:core|shadows|bench)/[a-z0-9_/]+\.(?:h|cpp|def)))");
    std::vector<std::string> lost;
    for (const char* folder : {"core", "shadows", "bench"})
        for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
            if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
            for (const std::string& line : lines_of(entry.path())) {
                const std::size_t comment = line.find("//");
                if (comment == std::string::npos) continue;
                const std::string words = line.substr(comment + 2);
                for (std::sregex_iterator at(words.begin(), words.end(), path), end; at != end; ++at)
                    if (const std::string named = (*at)[1].str(); !fs::exists(top / named))
                        lost.push_back(fmt::format("{}: {}", fs::relative(entry.path(), top).generic_string(), named));
            }
        }
    std::ranges::sort(lost);
    return lost;
}

TEST(Docs, FilesThatCommentsNameExist) { EXPECT_EQ(lost_paths(UMBRA_TOP), std::vector<std::string>()); }

TEST(Docs, PlantedFaultsAreFound) {
    const TemporaryFolder top;
    (void)top.write("README.md", "# Top\n");
    (void)top.write(
        "docs/README.md",
        "# Index\n[a](a.md), [its heading](a.md#what-the-times-are-and-whom-they-favour), [top](../README.md)\n"
        "[out](https://example.org/x.md#y)\n```cpp\n[&](int)\n```\n    [&](long)\n");
    (void)top.write("docs/a.md", "# What the times are, and whom they favour\n[gone](b.md), [`c`](../core/c.h)\n");
    (void)top.write("docs/lost.md", "[none](a.md#none)\n");
    (void)top.write("core/c.h", "// As core/c.h says, and bench/a.h.\n#include \"core/d.h\"\n");
    (void)top.write("bench/e.cpp", "int x;  ///< (core/c.h)\n");
    fs::create_directories(top.path() / "shadows");
    EXPECT_EQ(lost_paths(top.path()), (std::vector<std::string>{"core/c.h: bench/a.h"}));
    EXPECT_EQ(faults_of_links(top.path()),
              (std::vector<std::string>{"docs/a.md: link to docs/b.md, which does not exist",
                                        "docs/lost.md: no chain of links from docs/README.md leads here",
                                        "docs/lost.md: link to docs/a.md#none, a heading that is missing there"}));
}

}  // namespace
}  // namespace umbra
