#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>

#include "umbra/bench/recommend/recommend.h"
#include "umbra/bench/sweep/grid.h"
#include "umbra/core/base/error.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

std::vector<std::string> texts(std::span<const MethodChoice> choices) {
    std::vector<std::string> all;
    for (const MethodChoice& c : choices) all.push_back(c.text());
    return all;
}

SceneFacts facts_of(const char* scene) {
    return find_facts(load_scene(fmt::format("{}/{}.json", UMBRA_SCENES, scene)));
}

template <class Work>
std::string usage_error(const Work& work) {
    try {
        work();
    } catch (const UsageError& e) {
        return e.what();
    }
    return "no error";
}

using Texts = std::vector<std::string>;

TEST(Grid, ExpandsEveryCombinationTheLastParameterFastest) {
    EXPECT_EQ(texts(expand_settings("shadow_zbuffer:resolution=256|512,filter=nearest|pcf")),
              (Texts{"shadow_zbuffer:resolution=256", "shadow_zbuffer:resolution=256,filter=pcf",
                     "shadow_zbuffer:resolution=512", "shadow_zbuffer:resolution=512,filter=pcf"}));
    EXPECT_EQ(texts(expand_settings("ray_traced@fast:offset=epsilon")), (Texts{"ray_traced:offset=epsilon,samples=4"}));
    EXPECT_EQ(texts(expand_settings("exact")), (Texts{"exact"}));
}

TEST(Grid, NamesWhatIsWrong) {
    const auto error = [](const char* text) { return usage_error([&] { static_cast<void>(expand_settings(text)); }); };
    EXPECT_EQ(error("ray_traced:samples"),
              "ray_traced: \"samples\": expected name=value, or name=value|value, with commas between");
    EXPECT_EQ(error("ray_traced:samples=4,samples=8"), "ray_traced: samples is set twice");
    EXPECT_EQ(error("ray_traced:samples=4|none"), "ray_traced: samples=none: expected an integer");
    EXPECT_EQ(error("shadow_zbuffer:resolution=16,filter=pcf,radius=8").substr(0, 35),
              "shadow_zbuffer: radius=8 and normal");
}

TEST(Grid, ReadsAFileOfSettings) {
    const TemporaryFolder folder;
    const std::string file = (folder.path() / "settings.txt").string();
    std::ofstream(file) << "# comment\n\nray_traced:samples=1|4  # two\n  shadow_zbuffer@fast\n";
    EXPECT_EQ(texts(settings_in_file(file)),
              (Texts{"ray_traced:samples=1", "ray_traced:samples=4", "shadow_zbuffer:resolution=512"}));
    std::ofstream(file) << "ray_traced\n\nray_traced:sample=1\n";
    try {
        static_cast<void>(settings_in_file(file));
        FAIL();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("settings.txt:3: ray_traced: unknown setting \"sample\""),
                  std::string::npos);
    }
}

TEST(Grid, KeepsOneOfSettingsThatDoTheSameOnAScene) {
    const auto choices = expand_settings("ray_traced:samples=1|16|64,sampler=random|sobol");
    EXPECT_EQ(choices.size(), 6u);
    EXPECT_EQ(texts(distinct(choices, facts_of("sun_on_plane"))), (Texts{"ray_traced"}));
    EXPECT_EQ(distinct(choices, facts_of("umbra_penumbra")).size(), 6u);
    const auto twice = expand_settings("ray_traced@default:samples=16|4");
    EXPECT_EQ(distinct(std::vector{twice[0], twice[1], twice[0]}, facts_of("umbra_penumbra")).size(), 2u);
}

TEST(Grid, EveryMethodHasASweepThatHoldsItsDefaultAndItsPresets) {
    for (const MethodInfo* info : methods()) {
        const auto sweep = default_sweep(*info);
        ASSERT_FALSE(sweep.empty()) << info->name;
        EXPECT_EQ(preset_of(sweep[0]), "default") << info->name;
        for (const Preset& preset : info->presets) {
            const Settings wanted = parse_method(fmt::format("{}@{}", info->name, preset.name)).settings;
            EXPECT_TRUE(std::ranges::any_of(sweep, [&](const MethodChoice& c) { return c.settings == wanted; }))
                << info->name << "@" << preset.name;
        }
        for (const MethodChoice& choice : sweep) EXPECT_NO_THROW(static_cast<void>(choice.make())) << choice.text();
    }
    EXPECT_EQ(preset_of(parse_method("shadow_zbuffer@best")), "best");
    EXPECT_EQ(preset_of(parse_method("shadow_zbuffer:resolution=300")), "");
}

TEST(Families, GrowAlongTheFirstSweptNumber) {
    const auto all = families(expand_settings("shadow_zbuffer:filter=nearest|pcf,resolution=1024|256|512"));
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].parameter, "resolution");
    EXPECT_EQ(texts(all[0].settings), (Texts{"shadow_zbuffer:resolution=256", "shadow_zbuffer:resolution=512",
                                             "shadow_zbuffer:resolution=1024"}));
    EXPECT_EQ(all[1].settings.size(), 3u);
    const auto volumes = families(expand_settings("shadow_volumes:edges=weighted|silhouette"));
    ASSERT_EQ(volumes.size(), 2u);
    EXPECT_EQ(volumes[0].parameter, "");
}

TEST(FirstGood, FindsTheBorderAndAsksFewTimes) {
    for (std::size_t count = 1; count <= 20; ++count)
        for (std::size_t border = 0; border <= count; ++border) {
            std::vector<std::size_t> asked;
            const auto found = first_good(count, [&](std::size_t k) {
                asked.push_back(k);
                return k >= border;
            });
            EXPECT_EQ(found, border < count ? std::optional(border) : std::nullopt) << count << " " << border;
            EXPECT_LE(double(asked.size()), 1 + std::ceil(std::log2(double(count))) + 1e-9);
            std::ranges::sort(asked);
            EXPECT_TRUE(std::ranges::adjacent_find(asked) == asked.end());
        }
    EXPECT_EQ(first_good(0, [](std::size_t) { return true; }), std::nullopt);
}

TEST(Limits, AreParsedAndRefused) {
    const Limit limit = parse_limit("edge_displacement_px.p95=0.5");
    EXPECT_EQ(limit.metric->name, "edge_displacement_px.p95");
    EXPECT_EQ(limit.most, 0.5);
    const auto error = [](const char* text) { return usage_error([&] { static_cast<void>(parse_limit(text)); }); };
    EXPECT_EQ(error("rmse"), "--max rmse: expected METRIC=LIMIT, as rmse=0.01");
    EXPECT_EQ(error("rmse=-1"), "--max rmse=-1: found the limit \"-1\", expected a finite number of at least 0");
    EXPECT_EQ(error("rmse=1x"), "--max rmse=1x: found the limit \"1x\", expected a finite number of at least 0");
    EXPECT_EQ(error("rnse=1"), "unknown metric \"rnse\"; did you mean rmse? (umbra list metrics names them)");
}

}  // namespace
}  // namespace umbra
