#include "umbra/core/base/suggest.h"

#include <gtest/gtest.h>

#include "umbra/core/base/error.h"

namespace umbra {
namespace {

const std::vector<std::string> kCommands = {"list", "inspect", "render", "compare", "diff", "ladder"};

TEST(Suggest, DistanceCountsEditsAndSwaps) {
    EXPECT_EQ(edit_distance("", ""), 0u);
    EXPECT_EQ(edit_distance("", "diff"), 4u);
    EXPECT_EQ(edit_distance("compar", "compare"), 1u);
    EXPECT_EQ(edit_distance("comparre", "compare"), 1u);
    EXPECT_EQ(edit_distance("conpare", "compare"), 1u);
    EXPECT_EQ(edit_distance("copmare", "compare"), 1u);  // a swap is one edit
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
    EXPECT_EQ(edit_distance("ca", "abc"), 3u);  // 2 where a byte may be edited twice
    EXPECT_EQ(edit_distance("compare", "copmare"), edit_distance("copmare", "compare"));
}

TEST(Suggest, ClosestIsNearOrNothing) {
    EXPECT_EQ(closest("compar", kCommands), "compare");
    EXPECT_EQ(closest("rneder", kCommands), "render");
    EXPECT_EQ(closest("insp", kCommands), "inspect");  // begins with it
    EXPECT_EQ(closest("xyz", kCommands), "");
    EXPECT_EQ(closest("", kCommands), "");
    EXPECT_EQ(closest("a", std::vector<std::string>{"b"}), "");
}

TEST(Suggest, BestFirstAndNoMoreThanAsked) {
    const std::vector<std::string> names = {"cracks_b", "cracks_a", "cracks"};
    EXPECT_EQ(near_matches("cracks", names), (std::vector<std::string>{"cracks", "cracks_b", "cracks_a"}));
    EXPECT_EQ(near_matches("cracks", names, 1), std::vector<std::string>{"cracks"});
    EXPECT_EQ(did_you_mean("crakcs", names), "; did you mean cracks?");
    EXPECT_EQ(did_you_mean("nothing_like_it", names), "");
}

TEST(Suggest, AnUnknownNameIsRefusedWithThoseThatAreKnown) {
    const auto refusal = [](const std::vector<std::string>& known) -> std::string {
        try {
            return entry_named("unknown command", "lits", known, std::identity());
        } catch (const UsageError& e) {
            return e.what();
        }
    };
    EXPECT_EQ(refusal({"lits"}), "lits");
    EXPECT_EQ(refusal({"list", "diff"}), "unknown command \"lits\" (known: list, diff); did you mean list?");
    EXPECT_EQ(refusal({}), "unknown command \"lits\" (known: none)");
}

}  // namespace
}  // namespace umbra
