#include "umbra/bench/lab/steps.h"

#include <gtest/gtest.h>

#include <vector>

namespace umbra {
namespace {

TEST(Steps, LineEstimatesFromFinishedSteps) {
    EXPECT_EQ(step_line(0, 22, "sun_on_plane: exact", 0, 7), "[1/22] sun_on_plane: exact");
    EXPECT_EQ(step_line(2, 22, "stairs: exact", 4, 0), "[3/22] stairs: exact, 40 s left");
    EXPECT_EQ(step_line(2, 22, "stairs: exact", 4, 0.5), "[3/22] stairs: exact, 40 s left");  // rounded up
    EXPECT_EQ(step_line(2, 22, "stairs: exact", 4, 1), "[3/22] stairs: exact, 39 s left");
    EXPECT_EQ(step_line(2, 22, "stairs: exact", 4, 100), "[3/22] stairs: exact, 38 s left");  // never negative
    EXPECT_EQ(step_line(1, 11, "stairs", 60, 0), "[2/11] stairs, 10 min left");
    EXPECT_EQ(step_line(1, 11, "stairs", 3600, 0), "[2/11] stairs, 10.0 h left");
    EXPECT_EQ(step_line(0, 1, "stairs", 0, 3), "stairs");
}

TEST(Steps, CountsFromOne) {
    std::vector<std::string> lines;
    Steps steps(3, [&](const std::string& line) { lines.push_back(line); });
    steps.next();
    steps.show("a");
    steps.next();
    steps.show("b");
    EXPECT_EQ(lines[0], "[1/3] a");
    EXPECT_TRUE(lines[1].starts_with("[2/3] b, ")) << lines[1];
    Steps(3, {}).show("nobody listens");
}

}  // namespace
}  // namespace umbra
