// The fuzz targets without libFuzzer: every seed, every file that once broke something, and changes of both that are
// the same every time. `./umbra fuzz` searches farther.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "umbra/core/base/error.h"
#include "umbra/tests/fuzz/json_mutator.h"
#include "umbra/tests/fuzz/targets.h"
#include "umbra/tests/support/mutant.h"
#include "umbra/tests/support/scene_files.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

struct Seed {
    std::string name, bytes;
};

/// In the order of their names.
std::vector<Seed> seeds(std::string_view target) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path(UMBRA_TOP) / "tests/fuzz/corpus" / target))
        files.push_back(entry.path());
    std::ranges::sort(files);
    std::vector<Seed> all;
    for (const fs::path& file : files) {
        std::ifstream stream(file, std::ios::binary);
        all.push_back({file.filename().string(), {std::istreambuf_iterator<char>(stream), {}}});
    }
    return all;
}

/// What is wrong with the target's answer to these bytes; nothing where it reads or refuses them.
std::string fault(const FuzzTarget& target, const std::string& bytes) {
    try {
        target.run({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
        return "";
    } catch (const std::exception& e) {
        return e.what();
    }
}

/// How many changes of each seed: `usual`, or what UMBRA_MUTANTS says.
unsigned long rounds(unsigned long usual) {
    const char* said = std::getenv("UMBRA_MUTANTS");
    return said != nullptr ? std::strtoul(said, nullptr, 10) : usual;
}

class Fuzz : public ::testing::TestWithParam<FuzzTarget> {};

TEST_P(Fuzz, SurvivesItsSeedsAndChangesOfThem) {
    const FuzzTarget& target = GetParam();
    // A scene goes through all methods in about five milliseconds, and a report is written in about as many.
    const bool slow =
        target.name == "pipeline" || target.name == "report" || target.name == "image" || target.name == "view";
    const auto all = seeds(target.name);
    ASSERT_GE(all.size(), 2u) << "tests/fuzz/corpus/" << target.name;
    for (std::size_t s = 0; s < all.size(); ++s) {
        EXPECT_EQ(fault(target, all[s].bytes), "") << all[s].name;
        std::mt19937 random(static_cast<unsigned>(s + 1));
        const unsigned long last = rounds(slow ? 40 : 500);
        for (unsigned long round = 0; round < last; ++round) {
            std::optional<std::string> changed;
            if (target.json && round % 8 != 0) changed = mutated_json(all[s].bytes, random);
            if (!changed) changed = mutant(all[s].bytes, random);
            const std::string message = fault(target, *changed);
            EXPECT_EQ(message, "") << "change " << round << " of " << all[s].name << ":\n"
                                   << (target.json ? *changed : "");
        }
    }
}

std::string name_of(const ::testing::TestParamInfo<FuzzTarget>& of) { return std::string(of.param.name); }
INSTANTIATE_TEST_SUITE_P(Readers, Fuzz, ::testing::ValuesIn(reader_targets().begin(), reader_targets().end()), name_of);
INSTANTIATE_TEST_SUITE_P(Programs, Fuzz, ::testing::ValuesIn(program_targets().begin(), program_targets().end()),
                         name_of);

// Otherwise most would be refused by the reader, and no method be tried.
TEST(JsonMutator, MakesScenesOfWhichHalfAreRead) {
    const TemporaryFolder folder;
    int made = 0, same = 0, read = 0;
    std::mt19937 random(1);
    for (const Seed& seed : seeds("pipeline"))
        for (int i = 0; i < 50; ++i) {
            const auto changed = mutated_json(seed.bytes, random);
            ASSERT_TRUE(changed);
            ++made;
            same += *changed == seed.bytes;
            read += refusal(folder.write("scene.json", *changed)).empty();
        }
    EXPECT_LT(same, made / 20);
    EXPECT_GT(read, made / 2);
    EXPECT_FALSE(mutated_json("{", random));
}

}  // namespace
}  // namespace umbra
