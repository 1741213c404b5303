// One name, one definition: two types or inline constants of one name in one namespace, in files that are linked
// together, make a program whose meaning no compiler and no linker checks. This reads the sources as .clang-format lays
// them out.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// "NAMESPACE::NAME" of what the file defines with external linkage: types, inline constants, inline functions with
/// their parameters.
std::vector<std::string> definitions(const fs::path& file) {
    static const std::regex type(
        R"(^(?:struct|class|union|enum class|enum)\s+(?:alignas\(\d+\)\s+)?(\w+)\b(?!::)[^;]*\{.*)"),
        constant(R"(^inline (?:constexpr|const) [^=({]*?(\w+)\s*(?:\[[^\]]*\]\s*)?[={].*)"),
        function(R"(^inline [^=]*?(\w+\([^)]*\)?).*)"), opening(R"(^namespace(?: ([\w:]+))? \{.*)");
    std::vector<std::string> found, spaces;
    std::ifstream in(file);
    std::smatch match;
    bool in_template = false;  // of which several may have one name
    for (std::string line; std::getline(in, line);) {
        if (std::regex_match(line, match, opening)) {
            spaces.push_back(match[1].matched ? match[1].str() : "(none)");
        } else if (line.starts_with("}  // namespace") && !spaces.empty()) {
            spaces.pop_back();
        } else if (!in_template && std::ranges::find(spaces, "(none)") == spaces.end()) {
            for (const std::regex* kind : {&type, &constant, &function})
                if (std::regex_match(line, match, *kind)) {
                    found.push_back(fmt::format("{}::{}", fmt::join(spaces, "::"), match[1].str()));
                    break;
                }
        }
        in_template = line.starts_with("template <");
    }
    return found;
}

/// A line for each name that two files below `top` define. Test programs, of one file each, are not linked together.
std::vector<std::string> doubles(const fs::path& top) {
    const auto is_test = [](const std::string& file) { return file.ends_with("_test.cpp"); };
    std::vector<std::string> files, found;
    for (const char* folder : {"core", "shadows", "bench", "tests"})
        if (fs::exists(top / folder))
            for (const auto& entry : fs::recursive_directory_iterator(top / folder))
                if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
                    files.push_back(fs::relative(entry.path(), top).generic_string());
    std::ranges::sort(files);
    std::map<std::string, std::vector<std::string>> where;
    for (const std::string& file : files)
        for (const std::string& name : definitions(top / file)) {
            std::vector<std::string>& others = where[name];
            for (const std::string& other : others)
                if (file != other && !(is_test(file) && is_test(other)))
                    found.push_back(fmt::format("{}: {}, {}", name, other, file));
            others.push_back(file);
        }
    return found;
}

TEST(OneDefinition, NoNameIsDefinedInTwoFiles) {
    EXPECT_EQ(fmt::format("{}", fmt::join(doubles(UMBRA_TOP), "\n")), "");
}

TEST(OneDefinition, DefinitionsAreFound) {
    std::size_t found = 0;
    for (const char* header : {"core/scene/scene.h", "core/image/image_headers.h", "core/base/math.h"})
        found += definitions(fs::path(UMBRA_TOP) / header).size();
    EXPECT_GE(found, 9u);
}

TEST(OneDefinition, APlantedDoubleIsFound) {
    const TemporaryFolder top;
    (void)top.write(
        "core/a.h",
        "namespace umbra {\ninline constexpr int kMaxSide = 1;\nstruct View {\n};\n}  // namespace umbra\n");
    (void)top.write("core/b.cpp",
                    "namespace umbra {\nnamespace {\nstruct View {\n};\n}  // namespace\n"
                    "inline constexpr long kMaxSide = 2;\n}  // namespace umbra\n");
    (void)top.write("shadows/c.h",
                    "namespace umbra::c {\nclass View final : public A {\n};\n}  // namespace umbra::c\n");
    (void)top.write("tests/d_test.cpp", "namespace umbra {\nclass Folder {\n};\nclass View;\n}  // namespace umbra\n");
    (void)top.write("tests/e_test.cpp",
                    "namespace umbra {\nclass Folder {\n};\nenum class View : int { a };\n}  // namespace umbra\n");
    EXPECT_EQ(doubles(top.path()), (std::vector<std::string>{"umbra::kMaxSide: core/a.h, core/b.cpp",
                                                             "umbra::View: core/a.h, tests/e_test.cpp"}));
}

}  // namespace
}  // namespace umbra
