// The points that a report explains, and the first difference from the truth in words.
#include "umbra/bench/compare/explained_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/pages/error_palette.h"
#include "umbra/core/io/scene_io.h"

namespace umbra {
namespace {

/// A method on a scene, compared with the truth, and what is said of its points at each light.
class ExplainedPoints : public testing::Test {
protected:
    void run(const std::string& scene_name, const std::string& method) {
        prepared_ = prepare_scene(std::string(UMBRA_SCENES) + "/" + scene_name + ".json", {96, 54});
        truths_.emplace(prepared_->scene, prepared_->facts, prepared_->points, TruthOptions{});
        const MethodRun* truth = nullptr;
        made_.emplace(outcome(parse_method(method), prepared_->scene, prepared_->facts, prepared_->points,
                              {.truth = [&](const MethodRun& ran) -> const MethodRun& {
                                   truth = &truths_->of(ran.work->method()).ran.run;
                                   return *truth;
                               },
                               .noise_runs = 0}));
        ASSERT_FALSE(found().failed) << found().failed->message;
        truth_ = truth;
    }
    [[nodiscard]] const Outcome& found() const { return made_.value(); }
    [[nodiscard]] std::vector<ExplainedPointRecord> at(LightId light) const {
        return explained_points(prepared_->scene, prepared_->points, light, found().run, *truth_,
                                found().explained[light].classes);
    }
    [[nodiscard]] std::size_t point(const ExplainedPointRecord& record) const {
        return static_cast<std::size_t>(record.pixel.at(1)) * 96 + static_cast<std::size_t>(record.pixel.at(0));
    }
    [[nodiscard]] float error(LightId light, std::size_t i) const {
        return std::abs(found().run.planes[light].s[i] - truth_->planes[light].s[i]);
    }

    std::optional<PreparedScene> prepared_;
    std::optional<Truths> truths_;
    const MethodRun* truth_ = nullptr;
    std::optional<Outcome> made_;
};

/// How many points of point i's class there are up to three pixels from it.
std::ptrdiff_t alike(const ClassPlane& classes, std::size_t i) {
    std::ptrdiff_t count = 0;
    for (std::size_t k = 0; k < classes.size(); ++k) {
        const auto column = [](std::size_t of) { return static_cast<int>(of % 96); };
        const auto row    = [](std::size_t of) { return static_cast<int>(of / 96); };
        count += std::abs(column(k) - column(i)) <= 3 && std::abs(row(k) - row(i)) <= 3 && classes[k] == classes[i];
    }
    return count;
}

TEST_F(ExplainedPoints, AreTheWorstOfEachInteriorClassAndAmongTheirLike) {
    // Errors at a hard light are all of size 1; in a penumbra they differ.
    for (const auto& [scene, method] :
         {std::pair{"stairs", "shadow_zbuffer:bias=manual,resolution=64"},
          std::pair{"stairs", "shadow_zbuffer:resolution=32"}, std::pair{"umbra_penumbra", "ray_traced:samples=1"}}) {
        run(scene, method);
        const ClassPlane& classes = found().explained[0].classes;
        std::set<std::string> expected, got;
        for (const ErrorColour& row : kErrorPalette)
            if (row.interior && std::ranges::count(classes, row.error_class) > 0) expected.emplace(row.key);
        EXPECT_FALSE(expected.empty()) << method;
        for (const ExplainedPointRecord& record : at(0)) {
            got.insert(record.error_class);
            const std::size_t i = point(record);
            const auto row      = std::ranges::find(kErrorPalette, classes[i], &ErrorColour::error_class);
            EXPECT_EQ(record.error_class, row->key);
            for (std::size_t k = 0; k < classes.size(); ++k) {
                if (classes[k] != classes[i]) continue;
                EXPECT_LE(error(0, k), error(0, i)) << record.error_class;
                if (error(0, k) == error(0, i)) {
                    EXPECT_LE(alike(classes, k), alike(classes, i)) << record.error_class;
                }
            }
            EXPECT_EQ(record.method.visibility, std::optional(found().run.planes[0].s[i]));
            EXPECT_EQ(record.truth.visibility, std::optional(truth_->planes[0].s[i]));
            EXPECT_EQ(record.on.triangle, prepared_->points.triangle[i]);
            EXPECT_FALSE(record.method.difference.empty());
            EXPECT_TRUE(record.truth.difference.empty());
        }
        EXPECT_EQ(got, expected) << method;
    }
}

/// Whether the polygon, convex, has the place in it or within a hundredth of a pixel of it.
bool holds(const std::vector<std::vector<double>>& polygon, double x, double y) {
    int sides = 0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const auto &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        const double dx = b[0] - a[0], dy = b[1] - a[1], away = dx * (y - a[1]) - dy * (x - a[0]);
        const double hair = 0.02 * std::hypot(dx, dy);
        sides |= away > hair ? 1 : away < -hair ? 2 : 0;
    }
    return sides != 3;
}

TEST_F(ExplainedPoints, AreDrawnWhereThePictureHasThem) {
    run("stairs", "shadow_zbuffer:bias=manual,resolution=64");
    const std::vector<ExplainedPointRecord> all = at(0);
    ASSERT_FALSE(all.empty());
    std::size_t texels = 0;
    for (const ExplainedPointRecord& record : all) {
        const double x = record.pixel[0] + 0.5, y = record.pixel[1] + 0.5;
        ASSERT_GE(record.segment.size(), 2u);
        EXPECT_TRUE(std::ranges::any_of(record.segment, [&](const std::vector<double>& end) {
            return std::abs(end[0] - x) < 0.02 && std::abs(end[1] - y) < 0.02;
        })) << "the segment ends at the point";
        EXPECT_EQ(record.method_blocker.size() >= 3, record.method.blocker.has_value());
        EXPECT_EQ(record.truth_blocker.size() >= 3, record.truth.blocker.has_value());
        if (record.texel.empty()) continue;
        ++texels;
        EXPECT_TRUE(holds(record.texel, x, y)) << record.error_class;
        // The map blames the point's own triangle, which the picture shows there.
        if (record.method.blocker && record.method.blocker->triangle == record.on.triangle) {
            EXPECT_TRUE(holds(record.method_blocker, x, y)) << record.error_class;
        }
    }
    EXPECT_GE(texels, 1u);
}

/// One point of a plane, and answers for it that are made up.
class Difference : public testing::Test {
protected:
    Difference() : prepared_(prepare_scene(std::string(UMBRA_SCENES) + "/sun_on_plane.json", {16, 9})) {
        while (!prepared_.points.asks(0, i_)) ++i_;
        const dvec3 p = exact_position(prepared_.scene, prepared_.points, i_);
        truth_        = {.visibility = 0,
                         .blocker    = TriangleRecord{.triangle = 3, .object = "box"},
                         .at         = 0.25,
                         .towards    = {p.x, p.y + 4, p.z},
                         .margin     = -0.02,
                         .unit       = "world",
                         .answered   = true};
        method_       = {.visibility = 1,
                         .evidence   = {{.name = "width of the texel", .value = 0.01, .unit = "world"},
                                        {.name = "stored depth", .value = 5.0, .unit = "world"},
                                        {.name = "depth of the point", .value = 5.5, .unit = "world"},
                                        {.name = "bias towards the light", .value = 0.125, .unit = "world"}},
                         .answered   = true};
    }
    [[nodiscard]] std::string words() {
        add_difference(method_, truth_, prepared_.scene, prepared_.points, i_, light_);
        return method_.difference;
    }
    [[nodiscard]] bool says(const std::string& part) { return words().find(part) != std::string::npos; }
    void evidence(std::string_view name, double value) {
        std::ranges::find(method_.evidence, name, &EvidenceRecord::name)->value = value;
    }

    PreparedScene prepared_;
    std::size_t i_ = 0;
    LightId light_ = 0;
    AnswerRecord method_, truth_;
};

TEST_F(Difference, IsNoneWhereTheAnswersAreTheSame) {
    method_.visibility = 0;
    EXPECT_EQ(words(), "");
    method_.visibility.reset();
    EXPECT_EQ(words(), "") << "the method gave no answer";
    method_.visibility = 1;
    truth_.towards.clear();
    truth_.answered = false;
    EXPECT_EQ(words(), "") << "the truth threw when it was asked for its reason";
}

TEST_F(Difference, HasTheOccluderTheTexelAndTheBias) {
    EXPECT_TRUE(says("Triangle 3 of box is in the way, 1 from the point, 0.02 from its nearest edge.")) << words();
    EXPECT_TRUE(
        says("The map's texel is 0.01 wide here and stores depth 5; the point is at 5.5, less a bias of 0.125."));
    EXPECT_FALSE(says("One depth stands for the whole texel"));
    EXPECT_FALSE(says("The bias lifts"));
    evidence("bias towards the light", 1.5);
    EXPECT_TRUE(says("The bias lifts the point past the occluder.")) << "1.5 of bias, 1 to the occluder";
    evidence("width of the texel", 0.03);
    EXPECT_TRUE(says("One depth stands for the whole texel, and the edge passes within its width."));
}

TEST_F(Difference, HasTheDistanceFromALightThatHasAPlace) {
    EXPECT_FALSE(says("from the light")) << words();
    prepared_.scene.lights[light_].kind = LightKind::point;
    EXPECT_TRUE(says("Triangle 3 of box is in the way, 1 from the point and 3 from the light, 0.02 from its"))
        << words();
}

TEST_F(Difference, TellsAcneFromAnotherOccluder) {
    truth_.visibility = 1;
    truth_.blocker.reset();
    truth_.margin      = 0.3;
    method_.visibility = 0;
    method_.blocker    = TriangleRecord{.triangle = prepared_.points.triangle[i_], .object = "plane"};
    EXPECT_TRUE(says("Nothing is in the way: the nearest occluder is 0.3 from the segment.")) << words();
    EXPECT_TRUE(says("The method takes the point's own triangle for an occluder."));
    truth_.margin.reset();
    EXPECT_TRUE(says("The point sees all of the light.")) << words();
    truth_.visibility = 0.9375;
    EXPECT_TRUE(says("The point sees 0.938 of the light.")) << words();
    method_.blocker = TriangleRecord{.triangle = prepared_.points.triangle[i_] + 1, .object = "fence"};
    EXPECT_FALSE(says("own triangle"));
    EXPECT_TRUE(says("of fence."));
    EXPECT_FALSE(says("The bias lifts"));
}

TEST_F(Difference, HasWhatAnyOtherMethodLookedAt) {
    method_.evidence = {{.name = "count", .value = -1.0, .unit = "volumes"}};
    EXPECT_TRUE(says("Its count: -1 volumes.")) << words();
}

}  // namespace
}  // namespace umbra
