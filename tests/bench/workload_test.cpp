#include "umbra/bench/lab/workload.h"

#include <gtest/gtest.h>

#include <limits>

#include "umbra/core/base/error.h"

namespace umbra {
namespace {

std::string message_of(const std::string& text) {
    try {
        (void)parse_workload(text);
    } catch (const UsageError& e) {
        return e.what();
    }
    return "no error";
}

TEST(Workload, IsReadInAnyOrder) {
    const Workload w = parse_workload("object=0.5,camera=60,light=2");
    EXPECT_EQ(w.camera, 60);
    EXPECT_EQ(w.light, 2);
    EXPECT_EQ(w.object, 0.5);
    EXPECT_EQ(to_text(w), "camera=60,light=2,object=0.5");
    EXPECT_EQ(parse_workload("light=3").camera, 0) << "what is not named does not move";
}

TEST(Workload, MessagesSayWhatWasFoundAndExpected) {
    EXPECT_EQ(message_of("camera"),
              "workload: found \"camera\", expected events a second, as in camera=60,light=1,object=0");
    EXPECT_EQ(message_of("camera=60,lihgt=1"),
              "workload: unknown event \"lihgt\" (known: camera, light, object); did you mean light?");
    EXPECT_EQ(message_of("camera=-1"), "workload: camera=-1: \"-1\" is not a rate, expected a number of 0 or more");
    EXPECT_EQ(message_of("camera=1,camera=2"), "workload: camera is set twice");
    EXPECT_EQ(message_of("camera=0"), "workload: nothing moves in \"camera=0\", expected a rate above 0");
    for (const char* text : {"", ",", "camera=", "camera=1,", "camera=1x", "camera=nan", "camera=inf", "camera=1e999"})
        EXPECT_NE(message_of(text), "no error") << text;
}

/// Build 100 ms, aim 10, look 4, visibility 1.
TEST(Workload, CostOfAFrameByHand) {
    const auto cost = [](const char* text) { return frame_cost_ms(parse_workload(text), {100, 10, 4, 1}); };
    EXPECT_DOUBLE_EQ(cost("camera=60"), 4 + 1) << "a moving camera repeats look and visibility in every frame";
    EXPECT_DOUBLE_EQ(cost("light=60"), 11) << "a moving light repeats aim and visibility";
    EXPECT_DOUBLE_EQ(cost("object=60"), 115) << "a moving object repeats all";
    EXPECT_DOUBLE_EQ(cost("camera=60,light=6"), 5 + 0.1 * 10);
    EXPECT_DOUBLE_EQ(cost("camera=60,object=6"), 5 + 0.1 * (10 + 100)) << "the light is aimed again as well";
    EXPECT_DOUBLE_EQ(cost("camera=60,light=30,object=6"), 5 + 0.5 * 10 + 0.1 * 100);
    EXPECT_DOUBLE_EQ(cost("camera=1,light=4,object=2"), 1 + 10 + 0.5 * (4 + 100))
        << "frames are as many as light events; objects move more often than the camera";
    EXPECT_EQ(frame_cost_ms(parse_workload("camera=60"), {std::numeric_limits<double>::infinity(), 10, 4, 1}), 5);
}

}  // namespace
}  // namespace umbra
