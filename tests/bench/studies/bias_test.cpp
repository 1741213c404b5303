#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "umbra/bench/studies/bias/bias_study.h"
#include "umbra/core/base/error.h"
#include "umbra/core/errors/error_causes.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

fs::path scene(const char* name) { return fs::path(UMBRA_SCENES) / (std::string(name) + ".json"); }

BiasOptions options(const fs::path& out) {
    BiasOptions o;
    o.size     = {96, 54};
    o.map      = "resolution=512";
    o.out      = out;
    o.command  = "umbra bias";
    o.progress = [](const std::string&) {};
    return o;
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// Counts of one kind in one cell of the grid without normal offset.
std::uint64_t wrong(const Json& record, const Json& study, const char* kind, double constant, double slope) {
    const auto index = [](const Json& values, double v) {
        return std::size_t(std::ranges::find(values, Json(v)) - values.begin());
    };
    const Json& cell =
        study["slices"][0]["rows"].at(index(record["slopes"], slope)).at(index(record["constants"], constant));
    return cell[kind]["interior"].get<std::uint64_t>() + cell[kind]["edge"].get<std::uint64_t>();
}

class BiasCommand : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder;
        std::vector<std::string> failed;
        record_ =
            new Json(to_record(study_biases({scene("sun_on_plane"), scene("self_shadow"), scene("umbra_penumbra")},
                                            options(folder_->path() / "study"), failed)));
        EXPECT_TRUE(failed.empty());
    }
    static void TearDownTestSuite() {
        delete record_;
        delete folder_;
    }
    static TemporaryFolder* folder_;
    static Json* record_;
};
TemporaryFolder* BiasCommand::folder_ = nullptr;
Json* BiasCommand::record_            = nullptr;

TEST_F(BiasCommand, TooLittleRaisesFalseShadowTooMuchFalseLight) {
    for (const Json& study : (*record_)["bias"]) {
        const auto shadow = [&](double c, double s) { return wrong(*record_, study, "false_shadow", c, s); };
        const auto light  = [&](double c, double s) { return wrong(*record_, study, "false_light", c, s); };
        const auto points = study["points"].get<std::uint64_t>();
        EXPECT_GT(shadow(0, 0), points / 50) << study["scene"];
        EXPECT_LT(shadow(128, 128), points / 200) << study["scene"];
        EXPECT_GT(light(128, 128), points / 200) << study["scene"];
        EXPECT_LT(light(0, 0), points / 200) << study["scene"];
        // More bias moves points towards the light, so that no shadow comes and no light goes.
        double before = 0;
        for (const Json& constant : (*record_)["constants"]) {
            EXPECT_LE(shadow(constant.get<double>(), 0.5), shadow(before, 0.5)) << study["scene"] << ' ' << constant;
            EXPECT_GE(light(constant.get<double>(), 0.5), light(before, 0.5)) << study["scene"] << ' ' << constant;
            before = constant.get<double>();
        }
    }
}

/// Errors as `umbra compare` counts them: nothing is wrong at the terminator, of which self_shadow has much.
TEST_F(BiasCommand, CellsCountWhatCompareCounts) {
    for (const auto& [index, name] : {std::pair{1, "sun_on_plane"}, {2, "self_shadow"}}) {
        PreparedScene prepared   = prepare_scene(scene(name), {96, 54});
        const PointBatch& points = prepared.points;
        const MethodRun truth    = run_method(parse_method("exact"), prepared.scene, prepared.facts, points);
        const Json& study        = (*record_)["bias"][index];
        ASSERT_EQ(study["scene"], name);
        std::uint64_t at_terminator = 0;
        const auto same             = [&](const std::string& settings, const Json& errors) {
            const MethodRun run = run_method(parse_method("shadow_zbuffer:resolution=512," + settings), prepared.scene,
                                                         prepared.facts, points);
            ClassPlane classes  = error_classes(points, 0, run.planes[0], truth.planes[0], kHardTolerance);
            mark_terminator(classes, prepared.scene, points, 0);
            const VisibilityError e = count_errors(points, classes, run.planes[0], truth.planes[0]);
            at_terminator += e.terminator.wrong;
            EXPECT_EQ(study["points"], e.points);
            EXPECT_EQ(errors["false_shadow"]["interior"], e.false_shadow.interior) << settings;
            EXPECT_EQ(errors["false_shadow"]["edge"], e.false_shadow.edge) << settings;
            EXPECT_EQ(errors["false_light"]["interior"], e.false_light.interior) << settings;
            EXPECT_EQ(errors["false_light"]["edge"], e.false_light.edge) << settings;
        };
        same("bias=auto", study["automatic"]);
        same("bias=receiver_plane", study["receiver_plane"]);
        const Json &constants = (*record_)["constants"], &slopes = (*record_)["slopes"];
        for (const Json& slice : study["slices"])
            for (const auto& [row, column] : {std::pair{0, 0}, {3, 2}, {9, 4}, {2, 9}})
                same(fmt::format("bias=manual,constant={},slope={},normal_offset={}", constants[column].get<double>(),
                                 slopes[row].get<double>(), slice["normal_offset"].get<double>()),
                     slice["rows"][row][column]);
        EXPECT_GT(at_terminator, 0u) << name;
    }
}

TEST_F(BiasCommand, BestIsTheLeastOfTheGridAndTotalsAddUp) {
    const Json& all = (*record_)["bias"][0];
    EXPECT_EQ(all["scene"], "all");
    std::uint64_t points = 0, automatic = 0;
    const auto interior = [](const Json& e) {
        return e["false_shadow"]["interior"].get<std::uint64_t>() + e["false_light"]["interior"].get<std::uint64_t>();
    };
    for (const Json& study : (*record_)["bias"]) {
        std::uint64_t least = ~std::uint64_t{0};
        std::size_t better = 0, cells = 0;
        for (const Json& slice : study["slices"])
            for (const Json& row : slice["rows"])
                for (const Json& cell : row) {
                    least = std::min(least, interior(cell));
                    better += interior(cell) < interior(study["automatic"]);
                    ++cells;
                }
        EXPECT_EQ(interior(study["best_manual"]), least);
        EXPECT_EQ(study["settings_better_than_automatic"], better);
        EXPECT_EQ(study["settings"], cells);
        if (study["scene"] == "all") continue;
        points += study["points"].get<std::uint64_t>();
        automatic += interior(study["automatic"]);
    }
    EXPECT_EQ(all["points"], points);
    EXPECT_EQ(interior(all["automatic"]), automatic);
}

TEST_F(BiasCommand, WritesThePageAndTheData) {
    const fs::path out = folder_->path() / "study";
    EXPECT_EQ(Json::parse(text_of(out / "results.json")), *record_);
    EXPECT_TRUE(fs::exists(out / "report.css"));
    const std::string page = text_of(out / "index.html");
    for (const Json& study : (*record_)["bias"]) {
        EXPECT_NE(page.find(fmt::format("<section id=\"{}\"", study["scene"].get<std::string>())), std::string::npos);
        EXPECT_NE(page.find(study["title"].get<std::string>()), std::string::npos);
    }
    const auto occurrences = [&](std::string_view what) {
        std::size_t n = 0;
        for (std::size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1)) ++n;
        return n;
    };
    EXPECT_EQ(occurrences("<svg class=\"heat\""), 4 * (*record_)["bias"].size());
    // A ring a scene, and one in the legend.
    EXPECT_EQ(occurrences("class=\"best\""), (*record_)["bias"].size() + 1);
    EXPECT_EQ(occurrences("<script"), 0u);
    EXPECT_EQ(occurrences("{{"), 0u);
    EXPECT_NE(
        study_text(bias_report(from_record<BiasRecord>(parse_json(record_->dump(), "record")))).find("self_shadow"),
        std::string::npos);
}

TEST(BiasStudy, RefusesBiasesAsSettingsOfTheMap) {
    std::vector<std::string> failed;
    for (const char* map : {"constant=1", "bias=manual", "slope=2", "normal_offset=1", "resolution=0"}) {
        const TemporaryFolder folder;
        BiasOptions o = options(folder.path() / "out");
        o.map         = map;
        EXPECT_THROW((void)study_biases({scene("sun_on_plane")}, o, failed), UsageError) << map;
        EXPECT_FALSE(fs::exists(folder.path() / "out"));
    }
}

TEST(BiasStudy, ScenesThatCannotBeReadAreToldAndLeftOut) {
    const TemporaryFolder folder;
    std::vector<std::string> failed;
    const Json record = to_record(study_biases({folder.path() / "none.json"}, options(folder.path() / "out"), failed));
    EXPECT_EQ(failed.size(), 1u);
    EXPECT_TRUE(record["bias"].empty());
    EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

}  // namespace
}  // namespace umbra
