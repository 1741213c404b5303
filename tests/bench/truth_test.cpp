#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <tuple>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/npy.h"
#include "umbra/bench/contenders/truth_set.h"
#include "umbra/bench/lab/prepare.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

class Truth : public testing::Test {
protected:
    [[nodiscard]] TruthOrder order() const {
        TruthOrder order;
        order.scenes = {scene("umbra_penumbra"), scene("light_inside_view")};
        order.size   = {64, 36};
        order.out    = set_;
        return order;
    }
    static fs::path scene(const std::string& name) { return fs::path(UMBRA_SCENES) / (name + ".json"); }

    /// What a method answers, as answers to the set.
    void answer(const std::string& method) const {
        fs::create_directories(answers_);
        for (const fs::path& file : order().scenes) {
            const PreparedScene p = prepare_scene(file, order().size);
            const MethodRun run   = run_method(parse_method(method), p.scene, p.facts, p.points);
            std::vector<float> all;
            for (LightId j = 0; j < p.scene.lights.size(); ++j)
                for (std::size_t i = 0; i < p.points.size(); ++i)
                    all.push_back(run.planes[j].defined(i) ? run.planes[j].s[i] : std::nanf(""));
            write_npy(answers_ / (file.stem().string() + ".npy"), all, {p.scene.lights.size(), 36, 64});
        }
    }
    [[nodiscard]] std::vector<ScoreRecord> scores(const std::string& measure = "area") const {
        const std::vector<NamedAnswers> answers{
            parse_answers(fmt::format("mine={}:measure={}", answers_.string(), measure))};
        return score(set_, answers);
    }

    TemporaryFolder folder_;
    fs::path set_ = folder_.path() / "set", answers_ = folder_.path() / "answers";
};

TEST_F(Truth, JudgesItselfRightAndOthersByTheirErrors) {
    write_truth(order());
    answer("exact");
    for (const ScoreRecord& s : scores()) {
        EXPECT_GT(s.points, 100u);
        EXPECT_EQ(s.false_shadow + s.false_light + s.edge, 0u);
        EXPECT_EQ(s.max, 0) << "the same answers";
    }
    EXPECT_GT(scores("irradiance")[0].rmse, 0.005) << "another measure";
    EXPECT_EQ(scores("irradiance")[1].rmse, 0) << "lights without an area have one truth";
    answer("shadow_zbuffer:resolution=64");
    const ScoreRecord map = scores()[1];
    EXPECT_GT(map.false_shadow + map.false_light + map.edge, 10u);
    EXPECT_GT(map.rmse, 0.01);
    answer("planar_projection");
    EXPECT_GT(scores()[1].undefined, 10u) << "off its planes";
}

TEST_F(Truth, ScorerInNumPyGivesTheSameFigures) {
    if (std::system("/usr/bin/python3 -c 'import numpy' 2> /dev/null") != 0)
        GTEST_SKIP() << "python3-numpy is not installed";
    const std::string page  = bytes_of(std::string(UMBRA_TOP) + "/docs/truth.md");
    const std::size_t begin = page.find("```python\n") + 10, end = page.find("```", begin);
    write_text(folder_.path() / "score.py", page.substr(begin, end - begin));
    write_truth(order());
    for (const std::string method : {"shadow_zbuffer:resolution=64", "ray_traced:samples=4", "planar_projection"})
        for (const std::string measure : {"area", "irradiance"}) {
            answer(method);
            const fs::path out = folder_.path() / "scores.json";
            ASSERT_EQ(
                std::system(fmt::format("/usr/bin/python3 {} {} {} {} > {}", (folder_.path() / "score.py").string(),
                                        set_.string(), answers_.string(), measure, out.string())
                                .c_str()),
                0);
            const auto theirs = nlohmann::json::parse(bytes_of(out));
            const auto ours   = scores(measure);
            ASSERT_EQ(theirs.size(), ours.size());
            for (std::size_t k = 0; k < ours.size(); ++k) {
                const ScoreRecord& s = ours[k];
                const auto& t        = theirs[k];
                EXPECT_EQ(t["light"], s.light);
                EXPECT_EQ(t["measure"], s.measure);
                EXPECT_EQ(t["points"], s.points) << method;
                EXPECT_EQ(t["undefined"], s.undefined);
                EXPECT_EQ(t["boundary"], s.boundary);
                EXPECT_EQ(t["false_shadow"], s.false_shadow);
                EXPECT_EQ(t["false_light"], s.false_light);
                EXPECT_EQ(t["edge"], s.edge);
                EXPECT_NEAR(t["mae"], s.mae, 1e-12);
                EXPECT_NEAR(t["rmse"], s.rmse, 1e-12);
                EXPECT_NEAR(t["bias"], s.bias, 1e-12);
                EXPECT_NEAR(t["max"], s.max, 1e-12);
            }
        }
}

TEST_F(Truth, CountsWhatIsPlanted) {
    write_truth(order());
    answer("exact");
    const fs::path there = set_ / "light_inside_view", mine = answers_ / "light_inside_view.npy";
    const auto truth = read_npy(there / "area.npy").values, edge = read_npy(there / "area_edge.npy").values,
               boundary = read_npy(there / "area_boundary.npy").values;
    Numbers given       = read_npy(mine);
    int darkened = 0, lit = 0, at_edge = 0, left = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        float& s = given.values[i];
        if (std::isnan(truth[i]) || boundary[i] != 0) continue;
        if (edge[i] == 0 && truth[i] == 1 && darkened < 5)
            s = 0, ++darkened;
        else if (edge[i] == 0 && truth[i] == 0 && lit < 3)
            s = 1, ++lit;
        else if (edge[i] != 0 && truth[i] == 1 && at_edge < 2)
            s = 0, ++at_edge;
        else if (left < 4)
            s = std::nanf(""), ++left;
    }
    ASSERT_EQ(darkened + lit + at_edge + left, 14);
    write_npy(mine, given.values, given.shape);
    const ScoreRecord s = scores()[1];
    EXPECT_EQ(s.false_shadow, 5u);
    EXPECT_EQ(s.false_light, 3u);
    EXPECT_EQ(s.edge, 2u);
    EXPECT_EQ(s.undefined, 4u);
    EXPECT_NEAR(s.bias, -4.0 / static_cast<double>(s.points), 1e-12);
    EXPECT_NEAR(s.mae, 10.0 / static_cast<double>(s.points), 1e-12);
    EXPECT_NEAR(s.rmse, std::sqrt(10.0 / static_cast<double>(s.points)), 1e-12);
    EXPECT_EQ(s.max, 1);
}

TEST_F(Truth, MayBeGivenAwayWithoutItsAnswers) {
    TruthOrder withheld = order();
    withheld.withhold   = folder_.path() / "held";
    write_truth(withheld);
    for (const fs::directory_entry& file : fs::recursive_directory_iterator(set_))
        EXPECT_TRUE(!file.path().filename().string().starts_with("area") &&
                    !file.path().filename().string().starts_with("irradiance"))
            << file.path();
    EXPECT_EQ(bytes_of(set_ / "results.json").find("area.npy"), std::string::npos);
    EXPECT_EQ(bytes_of(set_ / "croissant.json").find("area.npy"), std::string::npos);
    answer("exact");
    EXPECT_THROW(static_cast<void>(scores()), InputError);
    const std::vector<NamedAnswers> answers{{"mine", answers_}};
    EXPECT_EQ(score(folder_.path() / "held", answers).at(0).max, 0);
    write_truth(withheld);  // both folders are ours: they are replaced
}

TEST_F(Truth, RefusesWhatDoesNotFit) {
    write_truth(order());
    answer("exact");
    const auto message = [&] {
        try {
            static_cast<void>(scores());
        } catch (const InputError& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_EQ(message(), "");
    write_npy(answers_ / "umbra_penumbra.npy", std::vector<float>(6), {6});
    EXPECT_NE(message().find("umbra_penumbra.npy: holds 6 values, expected 1 (lights) x 36 x 64"), std::string::npos);
    answer("exact");
    std::string bytes = bytes_of(set_ / "umbra_penumbra/area.npy");
    bytes.back()      = static_cast<char>(bytes.back() ^ 1);
    std::ofstream(set_ / "umbra_penumbra/area.npy", std::ios::binary) << bytes;
    EXPECT_NE(message().find("differs from its checksum"), std::string::npos);
    const std::string whole = bytes_of(set_ / "results.json");
    for (const auto& [what, becomes, why] : std::vector<std::tuple<std::string, std::string, std::string>>{
             {R"("folder": "umbra_penumbra")", R"("folder": "../umbra_penumbra")", "/scenes/0: folder"},
             {R"("folder": "umbra_penumbra")", R"("folder": "..")", "/scenes/0: folder"},
             {R"("tolerance": )", R"("tolerance": -)", "/scenes/0: tolerance of"}}) {
        std::string changed    = whole;
        const std::size_t from = changed.find(what);
        ASSERT_NE(from, std::string::npos) << what;
        write_text(set_ / "results.json", changed.replace(from, what.size(), becomes));
        EXPECT_NE(message().find(why), std::string::npos) << message();
    }
    EXPECT_THROW(static_cast<void>(parse_answers("mine")), UsageError);
    EXPECT_THROW(static_cast<void>(parse_answers("mine=x:measure=light")), UsageError);
}

}  // namespace
}  // namespace umbra
