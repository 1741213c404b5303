// `umbra shading`: what its record, its table and its pictures say of a scene whose differences are known.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/studies/shading/shading_choice.h"
#include "umbra/bench/studies/shading/shading_study.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

/// A coarse shiny ball over a floor, and its shadow.
PreparedScene shiny_ball() {
    Scene scene;
    scene.name = "ball", scene.title = "Ball";
    scene.materials.resize(1);
    scene.materials[0].k_s = vec3(0.8f), scene.materials[0].shininess = 60;
    const Mesh sphere = make_sphere(1, 12, 6), floor = make_plane(8, 8);
    add_object(scene, "ball", sphere.positions, sphere.normals, sphere.triangles, 0);
    std::vector<vec3> low = floor.positions;
    for (vec3& p : low) p.y -= 1.5f;
    add_object(scene, "floor", low, {}, floor.triangles, 0);
    Light lamp;
    lamp.name = "lamp", lamp.position = {2, 4, 2};
    scene.lights.push_back(lamp);
    scene.camera.eye = {0, 2, 6};
    scene.width = 96, scene.height = 64;
    return prepare_scene(std::move(scene), "ball", {});
}

const Json& model(const Json& record, const std::string& name) {
    return *std::ranges::find_if(record["models"], [&](const Json& m) { return m["name"] == name; });
}

/// Seen from straight above, Gouraud shading of one triangle is linear in pixels, which has no kinks; Phong's bends.
TEST(ShadingStudy, KinksAreBendsAndNotSlopes) {
    const TemporaryFolder folder;
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "triangle", {{-9, 0, 9}, {9, 0, 9}, {0, 0, -12}}, {}, {{0, 1, 2}}, 0);
    Light lamp;
    lamp.name = "lamp", lamp.position = {-6, 4, 4};  // near a corner, which is the brightest by far
    scene.lights.push_back(lamp);
    scene.camera.eye = {0, 5, 0}, scene.camera.up = {0, 0, -1};
    scene.camera.projection = Projection::orthographic, scene.camera.height = 4;
    scene.width = scene.height = 64;
    ShadingOptions options;
    options.runs = 1;
    const Json record =
        to_record(compare_shading(prepare_scene(std::move(scene), "triangle", {}), options, folder.path()));
    EXPECT_LT(model(record, "gouraud")["kink"].get<double>(), 0.01);
    EXPECT_EQ(model(record, "phong")["kink"].get<double>(), 1);
    EXPECT_EQ(model(record, "flat")["kink"].get<double>(), 0);
}

/// A floor of one colour in each picture: the eye sees the difference of the two, 0.8 (1 - cos 60).
TEST(ShadingStudy, PerceivedDifferenceOfTwoColoursIsTheirs) {
    const TemporaryFolder folder;
    Scene scene;
    scene.materials.resize(1);
    add_object(scene, "floor", {{-9, 0, -9}, {9, 0, -9}, {9, 0, 9}, {-9, 0, 9}}, {}, {{0, 2, 1}, {0, 3, 2}}, 0);
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {std::sqrt(3.0f), -1, 0};
    scene.lights.push_back(sun);
    scene.camera.eye = {0, 5, 0}, scene.camera.up = {0, 0, -1};
    scene.camera.projection = Projection::orthographic, scene.camera.height = 4;
    scene.width = scene.height = 32;
    ShadingOptions options;
    options.runs = 1;
    const Json record =
        to_record(compare_shading(prepare_scene(std::move(scene), "floor", {}), options, folder.path()));
    EXPECT_NEAR(model(record, "constant")["perceived"].get<double>(), 0.8 * 0.5, 1e-5);
    EXPECT_NEAR(model(record, "flat")["perceived"].get<double>(), 0, 1e-6);
}

/// Finer faces come closer to Phong shading for the eye, too.
TEST(ShadingStudy, FinerFacesComeCloserForTheEyeToo) {
    const auto perceived = [](int longitudes, const char* name) {
        const TemporaryFolder folder;
        Scene scene;
        scene.materials.resize(1);
        const Mesh sphere = make_sphere(1, longitudes, longitudes / 2);
        add_object(scene, "ball", sphere.positions, sphere.normals, sphere.triangles, 0);
        Light sun;
        sun.kind = LightKind::directional, sun.direction = {-1, -1, -1};
        scene.lights.push_back(sun);
        scene.camera.eye = {0, 0, 4};
        scene.width = scene.height = 96;
        ShadingOptions options;
        options.runs = 1;
        const Json record =
            to_record(compare_shading(prepare_scene(std::move(scene), "ball", {}), options, folder.path()));
        return std::pair{model(record, name)["perceived"].get<double>(), model(record, name)["rmse"].get<double>()};
    };
    const auto coarse = perceived(8, "flat"), fine = perceived(32, "flat"), finest = perceived(96, "flat");
    EXPECT_GT(coarse.first, fine.first);
    EXPECT_GT(fine.first, finest.first);
    EXPECT_GT(finest.first, 0);
    EXPECT_EQ(perceived(8, "phong").first, 0);
    EXPECT_GT(coarse.first, perceived(8, "gouraud").first);
}

TEST(ShadingStudy, SaysWhatCheaperModelsCost) {
    const TemporaryFolder folder;
    const PreparedScene prepared = shiny_ball();
    ShadingOptions options;
    options.method    = parse_method("exact");
    options.runs      = 1;
    const Json record = to_record(compare_shading(prepared, options, folder.path()));
    const auto at     = [&](const char* name, const char* figure) { return model(record, name)[figure].get<double>(); };
    ASSERT_EQ(record["models"].size(), 10u);
    const auto surfaces = static_cast<double>(
        prepared.points.size() - static_cast<std::size_t>(std::ranges::count(prepared.points.triangle, kNoTriangle)));
    EXPECT_EQ(at("phong", "evaluations"), surfaces);
    for (const auto& [figure, value] :
         {std::pair{"rmse", 0.0}, {"flip", 0.0}, {"perceived", 0.0}, {"highlight", 1.0}, {"kink", 1.0}})
        EXPECT_EQ(at("phong", figure), value) << figure;
    EXPECT_EQ(at("constant", "asked"), 0);
    EXPECT_EQ(at("phong", "asked"), [&] {
        double asked = 0;
        for (std::size_t i = 0; i < prepared.points.size(); ++i) asked += prepared.points.asks(0, i) ? 1 : 0;
        return asked;
    }());
    EXPECT_LT(at("flat", "evaluations"), 100);
    EXPECT_LT(at("gouraud", "evaluations"), 100);
    // Faces show edges, and highlights between vertices are missed.
    EXPECT_GT(at("flat", "kink"), 1.2);
    EXPECT_LT(at("gouraud", "highlight"), 0.9);
    EXPECT_GT(at("flat", "rmse"), at("gouraud", "rmse"));
    EXPECT_GT(at("gouraud", "rmse"), at("every_second", "rmse"));
    EXPECT_GT(at("every_second", "rmse"), 0);
    // Angles from elsewhere: shadows as fine as Phong's, fewer directions, and an error between none and flat
    // shading's.
    for (const char* fast : {"differences", "taylor", "highlight_test"}) {
        EXPECT_EQ(at(fast, "asked"), at("phong", "asked")) << fast;
        EXPECT_LT(at(fast, "evaluations"), surfaces) << fast;
        EXPECT_GT(at(fast, "rmse"), 0) << fast;
        EXPECT_LT(at(fast, "rmse"), at("flat", "rmse")) << fast;
    }

    for (const Json& m : record["models"]) {
        const Image picture    = read_image(folder.path() / m["picture"].get<std::string>()).image,
                    difference = read_image(folder.path() / m["difference"].get<std::string>()).image,
                    phong      = read_image(folder.path() / "phong.png").image;
        double largest         = 0;
        for (std::size_t k = 0; k < picture.data.size(); ++k) {
            const double expected = std::clamp(0.5 + double(picture.data[k]) - double(phong.data[k]), 0.0, 1.0);
            largest               = std::max(largest, std::abs(double(difference.data[k]) - expected));
        }
        EXPECT_LT(largest, 2.0 / 255) << m["name"];
    }
}

TEST(ShadingStudy, TableAndPageShowTheRecord) {
    const TemporaryFolder folder;
    ShadingRecord record{.head      = {kResultsSchema, "1", "umbra shading"},
                         .method    = "exact",
                         .noise_bar = 0.05,
                         .models    = {{.name        = "flat",
                                        .evaluations = 1234,
                                        .asked       = 567,
                                        .ms          = 8.25,
                                        .rmse        = 0.0625,
                                        .flip        = 0.1875,
                                        .perceived   = 0.125,
                                        .highlight   = 0.75,
                                        .kink        = 2.5,
                                        .picture     = "flat.png",
                                        .difference  = "flat_difference.png"}},
                         .front     = {"flat", "phong"},
                         .stages    = {{"ambient", "One value", "stage_3_ambient.png"}}};
    record.scene.title = "T";
    const auto text    = [&] { return study_text(shading_report(record)); };
    EXPECT_EQ(text(),
              "model  sums  S_j asked  time, ms     RMSE     FLIP  perceived  highlight  kinks\n"
              "flat   1234        567      8.25  0.06250  0.18750    0.12500      0.750   2.50\n"
              "No other model is both faster and closer to phong (RMSE) than: flat, phong.\n");
    record.models[0].highlight = kUnknown;
    EXPECT_NE(text().find("0.12500          -   2.50"), std::string::npos) << text();
    record.models[0].highlight = 0.75;
    StagedFiles staged;
    write_study_page(shading_report(record), record.head, folder.path(), staged);
    staged.commit();
    std::ifstream in(folder.path() / "index.html");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    EXPECT_NE(page.find("src=\"stage_3_ambient.png\""), std::string::npos);
    EXPECT_NE(page.find("<figcaption>One value</figcaption>"), std::string::npos);
    const std::string cells =
        "<td>" + count(1234) +
        "</td><td>567</td><td>8.25</td><td>0.06250</td><td>0.18750</td><td>0.12500</td><td>0.750</td><td>2.50</td>";
    EXPECT_NE(page.find(cells), std::string::npos) << page.substr(page.find("<tbody>"), 400);
    EXPECT_NE(page.find("<p>No other model is both faster and closer to phong (RMSE) than: flat, phong.</p>"),
              std::string::npos);
}

/// Times of six rounds, and errors: constant is fast and wrong, flat and gouraud take the same time within noise,
/// differences is slower than phong.
ShadingRecord known_times() {
    ShadingRecord record{.views = 3, .noise_bar = 0.05};
    const auto add = [&](const char* name, double ms, double rmse, double flip) {
        ShadingModelRecord& model = record.models.emplace_back();
        model.name                = name;
        for (int round = 0; round < 6; ++round) model.times_ms.push_back(ms * (1 + 0.1 * round));
        model.worst = {rmse, flip, 2 * rmse};
    };
    add("constant", 1, 0.5, 0.5), add("flat", 2, 0.1, 0.02), add("gouraud", 2.04, 0.05, 0.04);
    add("phong", 8, 0, 0), add("differences", 10, 0.01, 0.01);
    record.front = shading_front(record.models);
    return record;
}

TEST(ShadingChoice, IsTheCheapestWithinLimits) {
    ShadingRecord record = known_times();
    const auto under     = [&](std::vector<std::string> limits) {
        std::vector<ShadingLimit> parsed;
        for (const std::string& limit : limits) parsed.push_back(parse_shading_limit(limit));
        return choose_shading(record, parsed);
    };
    EXPECT_EQ(record.front, (std::vector<std::string>{"constant", "flat", "gouraud", "phong"}));
    const ShadingChoiceRecord choice = under({"rmse=0.1"});
    EXPECT_EQ(choice.model, "flat");
    EXPECT_NEAR(choice.ms.value(), 2.5, 1e-12);
    EXPECT_EQ(choice.tied, std::vector<std::string>{"gouraud"});
    EXPECT_EQ(choice.runner_up.value().model, "phong");
    EXPECT_NEAR(choice.runner_up.value().ratio, 4, 1e-12);
    EXPECT_NEAR(choice.of_phong.value().ratio, 0.25, 1e-12);
    EXPECT_EQ(under({"rmse=0.09"}).model, "gouraud");
    EXPECT_EQ(under({"rmse=1", "flip=0.03"}).model, "flat");
    EXPECT_EQ(under({"rmse=0.09", "flip=0.03"}).model, "phong");
    EXPECT_EQ(under({"perceived=0.1"}).model, "gouraud");
    EXPECT_EQ(under({"perceived=0.099"}).model, "phong");
    EXPECT_EQ(under({"flip=0"}).model, "phong");

    record.choice = choice;
    EXPECT_EQ(shading_findings(record).back(),
              "With rmse at most 0.1 in each of 3 views, the cheapest is flat: 2.50 ms, 0.25 (0.25 to 0.25, 96.9 %) of "
              "phong's time. As cheap, as far as the noise of times lets one see: gouraud. Next: phong, 4.00 (4.00 to "
              "4.00, 96.9 %) times as long.");

    record.noise_bar = 0.42;
    record.choice    = under({"rmse=0.1"});
    EXPECT_FALSE(record.choice->model.has_value());
    EXPECT_EQ(shading_findings(record),
              (std::vector<std::string>{
                  "Not ranked by time, as times vary by 42 %: run it again when the machine is less busy.",
                  "With rmse at most 0.1 in each of 3 views: flat, gouraud, phong, differences. None is called the "
                  "cheapest, as times vary by 42 %."}));
    record.noise_bar = 0.05;

    record.models.erase(record.models.begin() + 3);
    const ShadingChoiceRecord none = under({"rmse=0.005"});
    EXPECT_TRUE(!none.model.has_value());
    EXPECT_EQ(none.nearest.value().model, "differences");
    EXPECT_NEAR(none.nearest.value().factor, 2, 1e-12);
    record.choice = none;
    EXPECT_EQ(shading_findings(record).back(),
              "With rmse at most 0.005 in each of 3 views: none. Nearest: differences, 2 times a limit.");
    for (const char* wrong : {"rmse", "kink=1", "rmse=-1", "rmse=1x", "=1", "rmse="})
        EXPECT_THROW((void)parse_shading_limit(wrong), UsageError) << wrong;
}

TEST(ShadingChoice, LimitsHoldInEveryView) {
    const TemporaryFolder folder;
    ShadingOptions options;
    options.runs = 2, options.views = 3;
    options.limits    = {parse_shading_limit("rmse=0")};
    const Json record = to_record(compare_shading(shiny_ball(), options, folder.path()));
    EXPECT_TRUE(record["choice"]["model"].is_null()) << "two rounds do not tell how much times vary";
    EXPECT_EQ(record["choice"]["tied"], Json{"phong"});
    EXPECT_EQ(record["front"], Json::array());
    EXPECT_EQ(record["choice"]["limits"], (Json{{{"metric", "rmse"}, {"most", 0.0}}}));
    options.runs = options.views = 1;
    const Json once              = to_record(compare_shading(shiny_ball(), options, folder.path()));
    bool larger                  = false;
    for (const Json& m : record["models"]) {
        EXPECT_EQ(m["times_ms"].size(), 2u);
        for (const char* figure : {"evaluations", "asked", "rmse", "kink"})
            EXPECT_EQ(m[figure], model(once, m["name"])[figure]) << m["name"] << ": rounds change times alone";
        for (const char* error : {"rmse", "flip", "perceived"}) {
            EXPECT_GE(m["worst"][error], m[error]) << m["name"] << ' ' << error;
            larger = larger || m["worst"][error] > m[error];
        }
    }
    EXPECT_TRUE(larger) << "the other views count, too";
}

}  // namespace
}  // namespace umbra
