// At how many points a reference answers.
#include "umbra/bench/lab/reference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "umbra/bench/lab/prepare.h"
#include "umbra/tests/support/asked.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

constexpr std::size_t kFew = 100;

TEST(AffordablePoints, AreAllUnlessTrianglesOrStepsPromiseMinutes) {
    EXPECT_EQ(affordable_points(300000, kFew, 0), 300000u);
    EXPECT_EQ(affordable_points(300000, 10000, 400), 300000u) << "3e9 points times triangles, 1.2e8 steps";
    EXPECT_EQ(affordable_points(300000, 10001, 0), 16384u) << "of 1e9 over the triangles no more";
    EXPECT_EQ(affordable_points(300000, 100000, 0), 10000u);
    EXPECT_EQ(affordable_points(300000, 10000000, 0), 2048u) << "no fewer";
    EXPECT_EQ(affordable_points(1000, 10000000, 0), 1000u) << "not more than there are";
    EXPECT_EQ(affordable_points(300000, kFew, 501), 16384u) << "of 5e7 over the steps no more";
    EXPECT_EQ(affordable_points(300000, kFew, 5000), 10000u);
    EXPECT_EQ(affordable_points(300000, kFew, 1e6), 2048u);
    EXPECT_EQ(affordable_points(300000, 100000, 10000), 5000u) << "the smaller sample of the two";
    EXPECT_EQ(affordable_points(0, kFew, 1e6), 0u);
}

/// Answers 1, counts steps as a test says.
class CountingMethod final : public Method {
public:
    static inline std::uint64_t steps_of_a_point = 0;

    explicit CountingMethod(const Settings&) {}
    [[nodiscard]] Service serves(const SceneFacts&) const override { return {How::exactly, "It is planted."}; }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const PointBatch& points = looked.points;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (points.asks(aimed.light, i)) out.s[i] = 1;
        if (out.steps != nullptr) *out.steps += steps_of_a_point * points.size();
    }
};

constexpr const char* kLampOverFloor = R"({
    "camera": {"eye": [0, 4, 4], "target": [0, 0, 0]},
    "lights": [{"type": "point", "position": [1, 3, 0]}, {"type": "disk", "position": [0, 3, 0], "radius": 0.5}],
    "objects": [{"type": "plane", "size": 40}]})";

class ReferenceOf : public testing::Test {
protected:
    ReferenceRun run(const PreparedScene& p, std::uint64_t steps_of_a_point, bool reference = true) {
        CountingMethod::steps_of_a_point = steps_of_a_point;
        MethodInfo info;
        info.name        = "counting";
        info.title       = "Counting";
        info.reference   = reference;
        info.create      = create<CountingMethod>;
        ReferenceRun ran = run_reference({MethodChoice(info), true, ""}, p.scene, p.facts, p.points, std::nullopt);
        EXPECT_EQ(ran.of, p.points.size());
        EXPECT_EQ(ran.judged == ran.of, ran.stand_in.empty());
        return ran;
    }
    std::uint64_t judged(std::uint64_t steps_of_a_point, bool reference = true) {
        return run(p_, steps_of_a_point, reference).judged;
    }

    TemporaryFolder folder_;
    PreparedScene p_ = prepare_scene(folder_.write("scene.json", kLampOverFloor), {128, 96});
};

TEST_F(ReferenceOf, AScenesAnswersAtEveryPointIsSampledWhereItsStepsAreMany) {
    EXPECT_EQ(judged(0), 12288u);
    EXPECT_EQ(judged(12000), 12288u) << "1.47e8 steps";
    EXPECT_EQ(judged(13000), 128u * 96 / 4) << "1.6e8 steps: 3846 points, one of each tile of 2 x 2";
    EXPECT_EQ(judged(13000, false), 12288u) << "no method of the list that may be a reference";
}

/// A bulb that is as large as the ball in it: the triangles of the ball pass through the plane of the light's disk.
TEST(StepsOfExact, AreManyInRationalsAndWhereTrianglesPassThroughASphereLight) {
    const TemporaryFolder folder;
    const auto steps = [&](const char* scene, const char* method_text = "exact") {
        const PreparedScene p = prepare_scene(folder.write("scene.json", scene), {64, 48});
        Asked method(method_text);
        method.build(p.scene, p.facts);
        method.aim(0);
        const PointBatch points = pick(p.points, stratified_sample(p.points, 64));
        std::uint64_t counted   = 0;
        for (int run = 0; run < 2; ++run) {
            std::atomic<std::uint64_t> now = 0;
            VisibilityPlane plane(points.size());
            Visibility out = plane.out();
            out.steps      = &now;
            method.visibility(points, 0, out);
            EXPECT_EQ(run == 0 ? now.load() : counted, now);
            counted = now;
        }
        return static_cast<double>(counted) / static_cast<double>(points.size());
    };
    const double lamp = steps(kLampOverFloor);
    EXPECT_EQ(lamp, 0) << "a light without an area";
    const char* over_ball   = R"({
        "camera": {"eye": [0, 3, 4], "target": [0, 0, 0]},
        "lights": [{"type": "sphere", "position": [0, 3, 0], "radius": 0.5}],
        "objects": [{"type": "plane", "size": 40},
                    {"type": "sphere", "radius": 0.5, "transform": [{"translate": [0, 0.5, 0]}]}]})";
    const char* behind_pane = R"({
        "camera": {"eye": [0, 4, 4], "target": [0, 0, 0]}, "transparent_occluders": "multiply",
        "materials": {"pane": {"opacity": 0.5}},
        "lights": [{"type": "rectangle", "position": [0, 9, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]}],
        "objects": [{"type": "plane", "size": 40}, {"type": "plane", "size": 30, "divisions": DIVISIONS,
                     "material": "pane", "transform": [{"translate": [0, 8, 0]}]}]})";
    const auto panes        = [&](const std::string& divisions) {
        std::string scene = behind_pane;
        scene.replace(scene.find("DIVISIONS"), 9, divisions);
        return steps(scene.c_str());
    };
    EXPECT_GT(panes("1"), 150) << "a triangle of the pane is before the light, at least";
    EXPECT_GT(panes("200"), 10 * panes("1")) << "and there dozens, which cut the light";
    const double ball = steps(over_ball);
    EXPECT_GT(ball, 10);
    EXPECT_LT(ball, 200);
    EXPECT_GT(steps(over_ball, "exact:arithmetic=rational"), 100 * ball);
    const double bulb = steps(R"({
        "camera": {"eye": [0, 3, 4], "target": [0, 0, 0]},
        "lights": [{"type": "sphere", "position": [0, 0.5, 0], "radius": 0.5}],
        "objects": [{"type": "plane", "size": 40},
                    {"type": "sphere", "radius": 0.5, "transform": [{"translate": [0, 0.5, 0]}]}]})");
    EXPECT_GT(bulb, 2000);
}

}  // namespace
}  // namespace umbra
