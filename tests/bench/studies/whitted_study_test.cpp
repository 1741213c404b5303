// `umbra whitted`: its pictures, its record and its page of scenes whose rays are known.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

#include "umbra/bench/compare/compare.h"
#include "umbra/bench/lab/antialias.h"
#include "umbra/bench/lab/asked_method.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/studies/light/formula_scene.h"
#include "umbra/bench/studies/light/whitted.h"
#include "umbra/bench/studies/whitted/whitted_study.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/image/metrics.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/scene/primitives.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

/// A mirror behind a ball of glass on a floor, and a square that shades a part of the floor which the mirror lights.
Scene mirror_scene() {
    Scene scene;
    scene.name = "mirrors", scene.title = "Mirrors";
    scene.materials.resize(3);
    scene.materials[1].reflect = 0.8f;
    scene.materials[2].reflect = 0.1f, scene.materials[2].transmit = 0.8f;
    scene.materials[2].index_of_refraction = 1.5f;
    const Mesh floor = make_plane(12, 12), ball = make_sphere(0.7f, 24, 12), square = make_plane(0.8f, 0.8f);
    add_object(scene, "floor", floor.positions, {}, floor.triangles, 0);
    add_object(scene, "mirror", {{-2, 0, 3}, {-2, 0, -3}, {-2, 3, -3}, {-2, 3, 3}}, {}, {{0, 1, 2}, {0, 2, 3}}, 1);
    std::vector<vec3> up = ball.positions, over = square.positions;
    for (vec3& p : up) p += vec3(0.5f, 0.7f, -1.5f);
    for (vec3& p : over) p += vec3(0.55f, 1, 0.1f);
    add_object(scene, "ball", up, ball.normals, ball.triangles, 2);
    add_object(scene, "square", over, {}, square.triangles, 0);
    Light lamp;
    lamp.name = "lamp", lamp.position = {1, 2, 0};
    scene.lights.push_back(lamp);
    scene.camera.eye = {1.5f, 3, 6}, scene.camera.target = {-0.5f, 0.5f, 0};
    scene.width = 64, scene.height = 48;
    return scene;
}

PreparedScene prepared_mirrors() { return prepare_scene(mirror_scene(), "mirrors", {}); }

WhittedOptions quick() {
    WhittedOptions options;
    options.method        = parse_method("ray_traced");
    options.pixel_samples = 1;
    return options;
}

WhittedRecord typed(const Json& record) { return from_record<WhittedRecord>(parse_json(record.dump(), "record")); }

Json traced(const PreparedScene& prepared, const WhittedOptions& options, const std::filesystem::path& folder) {
    return to_record(trace_whitted(prepared, options, folder));
}

Image file_of(const TemporaryFolder& folder, const Json& name) {
    return read_image(folder.path() / name.get<std::string>()).image;
}

/// What a PNG keeps of a picture.
double largest_difference(const Image& a, const Image& b) { return image_error(a, b).max; }

TEST(WhittedStudy, RecordAndPicturesAreWhatWasTraced) {
    const TemporaryFolder folder;
    const PreparedScene prepared = prepared_mirrors();
    const Json record            = traced(prepared, quick(), folder.path());

    const Scene& scene = prepared.scene;
    const RayScene rays(scene);
    const RayTree tree = trace_rays(rays, scene, prepared.points, {.depth = 5, .least_weight = 0.0003});
    AskedMethod shadows(scene, prepared.facts, parse_method("ray_traced"));
    const TreeLight light = light_of_rays(scene, tree, [&](const PointBatch& points) { return shadows(points); });
    ASSERT_EQ(record["depths"].size(), 5u);
    const Image whole = gather(scene, tree, light, 5);
    for (std::size_t d = 0; d < 5; ++d) {
        const Json& found       = record["depths"][d];
        const RayCounts& counts = tree.levels[d].counts;
        EXPECT_EQ(found["depth"], d + 1);
        EXPECT_EQ(found["eye"], counts.eye);
        EXPECT_EQ(found["reflected"], counts.reflected);
        EXPECT_EQ(found["refracted"], counts.refracted);
        EXPECT_EQ(found["met"], counts.met);
        EXPECT_EQ(found["left"], counts.eye + counts.reflected + counts.refracted - counts.met);
        EXPECT_EQ(found["shadow"], counts.shadow);
        EXPECT_EQ(found["total_reflections"], counts.total);
        EXPECT_EQ(found["too_light"], counts.too_light);
        EXPECT_EQ(found["too_deep"], counts.too_deep);
        const Image linear = gather(scene, tree, light, static_cast<int>(d) + 1);
        EXPECT_DOUBLE_EQ(found["rmse"].get<double>(), image_error(whole, linear).rmse);
        EXPECT_LT(largest_difference(file_of(folder, found["picture"]), displayed(linear, scene.tone, 1)), 0.6 / 255);
    }
    EXPECT_EQ(record["depths"][4]["rmse"], 0.0);
    EXPECT_GT(record["depths"][0]["rmse"].get<double>(), record["depths"][1]["rmse"].get<double>());
    EXPECT_GT(tree.levels[1].counts.reflected, 100u);
    EXPECT_GT(tree.levels[1].counts.refracted, 50u);
    EXPECT_LT(largest_difference(file_of(folder, record["picture"]), displayed(whole, scene.tone, 1)), 0.6 / 255);

    const std::vector<std::uint32_t> trees = rays_by_eye_ray(tree);
    EXPECT_EQ(record["most_rays_a_pixel"], double(*std::ranges::max_element(trees)));
    const Image ray_map = file_of(folder, record["rays_picture"]);
    for (std::size_t i = 0; i < trees.size(); ++i) EXPECT_EQ(ray_map.at(i, 0) == 0, trees[i] == 1) << i;

    double sum = 0, fractions = 0;
    for (const Json& phase : record["phases"]) {
        sum += phase["ms"].get<double>(), fractions += phase["fraction"].get<double>();
        EXPECT_NEAR(phase["fraction"].get<double>() * record["total_ms"].get<double>(), phase["ms"].get<double>(),
                    1e-9);
    }
    EXPECT_NEAR(sum, record["total_ms"].get<double>(), 1e-9);
    EXPECT_NEAR(fractions, 1, 1e-12);
    EXPECT_EQ(record["ways"][0]["ms"], record["total_ms"]);
}

/// Rays where surfaces mirror or transmit alone, and rays everywhere: one picture. The tree of boxes and the test of
/// every triangle: one answer.
TEST(WhittedStudy, WaysMakeOnePictureAndSearchFindsTheSame) {
    const TemporaryFolder folder;
    WhittedOptions options = quick();
    options.least_weight   = 0.05;  // cuts rays that are mirrored twice by glass
    const Json record      = traced(prepared_mirrors(), options, folder.path());
    ASSERT_EQ(record["ways"].size(), 4u);
    std::vector<double> rays;
    for (const Json& way : record["ways"]) {
        rays.push_back(way["rays"].get<double>());
        if (way["name"] == "any_weight") continue;
        EXPECT_EQ(way["different_pixels"], 0) << way["name"];
        EXPECT_EQ(way["max_difference"], 0.0) << way["name"];
    }
    EXPECT_EQ(rays[0], rays[1]);
    EXPECT_GT(rays[2], rays[1] + 500);
    double too_light = 0;
    for (const Json& d : record["depths"]) too_light += d["too_light"].get<double>();
    EXPECT_GT(too_light, 0);
    EXPECT_GT(rays[3], rays[0] + 10);
    EXPECT_GT(record["ways"][3]["different_pixels"], 0);
    EXPECT_LT(record["ways"][3]["max_difference"].get<double>(), 2 * 0.05);
    const Json& search = record["search"];
    EXPECT_EQ(search["different"], 0);
    EXPECT_EQ(search["rays"], search["of"]);  // so few that all are tested
    EXPECT_EQ(search["of"].get<double>(), rays[0] - 64 * 48);
    EXPECT_EQ(search["triangles"], mirror_scene().triangles.size());
    EXPECT_GT(search["ratio"].get<double>(), 1);
    ASSERT_EQ(search["ways"].size(), 5u);
    for (const Json& way : search["ways"]) {
        EXPECT_EQ(way["different"], 0) << way;
        EXPECT_LT(way["triangles"].get<double>(), static_cast<double>(mirror_scene().triangles.size())) << way;
    }
}

/// Mirror images that are kept are right where the eye has not moved, and err the more the farther it moves.
TEST(WhittedStudy, KeptMirrorImagesErrAsTheEyeMoves) {
    const TemporaryFolder folder;
    const Json record = traced(prepared_mirrors(), quick(), folder.path());
    const Json& kept  = record["kept"];
    ASSERT_EQ(kept.size(), 4u);
    EXPECT_EQ(kept[0]["rmse"], 0.0);
    EXPECT_EQ(kept[0]["kept"], 1.0);
    EXPECT_GT(kept[1]["rmse"].get<double>(), 0);
    EXPECT_GT(kept[3]["rmse"].get<double>(), 2 * kept[1]["rmse"].get<double>());
    EXPECT_GT(kept[3]["kept"].get<double>(), 0.5);
    EXPECT_GT(largest_difference(file_of(folder, kept[3]["picture"]), file_of(folder, kept[3]["truth"])), 0.05);
    EXPECT_EQ(largest_difference(file_of(folder, kept[0]["picture"]), file_of(folder, record["picture"])), 0);
}

/// The square's shadow lies where the mirror sends the lamp's light: dark under S_j, and marked.
TEST(WhittedStudy, MarksLightThatNoMethodSees) {
    const TemporaryFolder folder;
    const Json record = traced(prepared_mirrors(), quick(), folder.path());
    const Json& blind = record["blind"];
    EXPECT_EQ(blind["planes"], 1);
    EXPECT_GT(blind["points"].get<int>(), blind["points_in_shadow"].get<int>());
    EXPECT_GT(blind["points_in_shadow"].get<int>(), 5);
    // Orange pixels are redder than blue.
    const Image map = file_of(folder, blind["picture"]);
    int orange      = 0;
    for (std::size_t i = 0; i < map.pixels(); ++i) orange += map.at(i, 0) > map.at(i, 2) + 0.3f ? 1 : 0;
    EXPECT_EQ(orange, blind["points_in_shadow"].get<int>());

    Scene dull                = mirror_scene();
    dull.materials[1].reflect = 0;
    const Json none           = traced(prepare_scene(std::move(dull), "dull", {}), quick(), folder.path());
    EXPECT_TRUE(none["blind"].is_null());
}

/// A scene without mirrors, an area light sampled by point: the picture of `umbra render`, to the same bits.
TEST(WhittedStudy, WithoutMirrorsIsWhatRenderDraws) {
    const TemporaryFolder folder;
    const auto file = std::filesystem::path(UMBRA_SCENES) / "umbra_penumbra.json";
    for (const int samples : {1, 4}) {
        RenderOptions render;
        render.method = "ray_traced", render.size = {96, 54}, render.pixel_samples = samples;
        render.out = folder.path() / "rendered.png";
        ASSERT_TRUE(render_scene(file, render));
        WhittedOptions options = quick();
        options.pixel_samples  = samples;
        const Json record      = traced(prepare_scene(file, {96, 54}), options, folder.path());
        EXPECT_EQ(file_of(folder, record["picture"]).data, read_image(render.out).image.data) << samples;
        EXPECT_EQ(record["depths"].size(), 1u);
        EXPECT_TRUE(record["search"].is_null());
    }
}

/// Several rays a pixel smooth edges inside mirrors, too.
TEST(WhittedStudy, MoreRaysAPixelComeCloserToManyRays) {
    const TemporaryFolder folder;
    const PreparedScene prepared = prepared_mirrors();
    const auto picture           = [&](int samples) {
        WhittedOptions options = quick();
        options.pixel_samples  = samples;
        return file_of(folder, traced(prepared, options, folder.path())["picture"]);
    };
    const Image many = picture(64);
    const auto error = [&](int samples) {  // of pixels that show the mirror
        const Image image = picture(samples);
        double sum        = 0;
        for (std::size_t i = 0; i < image.pixels(); ++i) {
            const TriangleId t = prepared.points.triangle[i];
            if (t == kNoTriangle || prepared.scene.triangle_object[t] != 1) continue;
            for (std::size_t c = 0; c < 3; ++c)
                sum += std::pow(static_cast<double>(image.at(i, c)) - static_cast<double>(many.at(i, c)), 2);
        }
        return sum;
    };
    const double one = error(1), four = error(4), sixteen = error(16);
    EXPECT_LT(four, 0.7 * one);
    EXPECT_LT(sixteen, 0.85 * four);
    WhittedOptions options = quick();
    options.pixel_samples  = 4;
    EXPECT_EQ(traced(prepared, options, folder.path())["depths"][0]["eye"], 4 * 64 * 48);
}

TEST(WhittedStudy, WarnsOfWhatItDoesNotComputeAlone) {
    const TemporaryFolder folder;
    const auto file = folder.write("scene.json", R"({
      "camera": {"eye": [0, 2, 6], "target": [0, 0, 0]},
      "materials": {"a": {"reflect": 0.5}, "b": {"transmit": 0.5, "index_of_refraction": 1.5, "opacity": 0.5}},
      "lights": [{"type": "point", "position": [3, 4, 5]}],
      "objects": [{"type": "plane", "material": "a"}, {"type": "box", "material": "b"}]})");
    Scene scene     = load_scene(file);
    ASSERT_EQ(scene.warnings.size(), 4u);
    correct_warnings(scene);
    EXPECT_TRUE(scene.warnings.empty());
    scene.warnings = {"Something else."};
    correct_warnings(scene);
    EXPECT_EQ(scene.warnings.size(), 1u);
}

/// A pane over a plane, whose blending is half of each; the other picture shows one or the other.
TEST(WhittedStudy, ScreenDoorIsComparedWithBlending) {
    const TemporaryFolder folder;
    const auto file = folder.write("scene.json", R"({"size": [32, 32],
      "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}, "lights": [],
      "materials": {"pane": {"k_a": 0, "emission": 1, "opacity": 0.5}, "wall": {"k_a": 0, "emission": 0}},
      "objects": [{"type": "box", "size": [9, 9, 0.1], "material": "wall", "transform": [{"translate": [0, 0, -2]}]},
                  {"type": "triangles", "material": "pane", "positions": [[-9, -9, 0], [9, -9, 0], [0, 18, 0]],
                   "triangles": [[0, 1, 2]]}]})");
    WhittedOptions options;
    options.pixel_samples = 1;
    const Json record     = traced(prepare_scene(file, {}), options, folder.path());
    const Json& door      = record["screen_door"];
    ASSERT_FALSE(door.is_null());
    EXPECT_NEAR(door["rmse"].get<double>(), 0.5, 1e-6);
    const Image blended = read_image(folder.path() / "whitted.png").image,
                shown   = read_image(folder.path() / door["picture"].get<std::string>()).image;
    std::size_t whole   = 0;
    for (std::size_t i = 0; i < shown.pixels(); ++i) {
        EXPECT_NEAR(double(blended.at(i, 0)), double(srgb_from_linear(0.5f)), 1.0 / 255);
        whole += shown.at(i, 0) == 1;
    }
    EXPECT_EQ(whole, shown.pixels() / 2);
}

TEST(WhittedStudy, SinglePictureHasOneOfThePixelsRays) {
    const TemporaryFolder folder, coarse;
    const PreparedScene prepared = prepare_scene(mirror_scene(), "mirrors", {48, 28});
    const Json record            = traced(prepared, {.method = {}, .pixel_samples = 9, .command = ""}, folder.path());
    ASSERT_FALSE(record["single"].is_null());
    // The middle one of nine regular places is the pixel's centre, through which the only ray of a pixel passes.
    const Json centres = traced(prepared, {.method = {}, .pixel_samples = 1, .command = ""}, coarse.path());
    EXPECT_TRUE(centres["single"].is_null());
    const Image single = read_image(folder.path() / record["single"]["picture"].get<std::string>()).image,
                centre = read_image(coarse.path() / "whitted.png").image,
                whole  = read_image(folder.path() / "whitted.png").image;
    ASSERT_EQ(single.data.size(), centre.data.size());
    EXPECT_LT(image_error(centre, single).differing, single.pixels() / 100);
    EXPECT_GT(image_error(whole, single).differing, single.pixels() / 100);
    EXPECT_GT(record["single"]["rmse"].get<double>(), 0);
    EXPECT_GT(record["single"]["flip"].get<double>(), 0);
}

/// A second picture with the ball and a box by formula: what FormulaScene traces, with and without shadows.
TEST(WhittedStudy, FormulaRecordAndPictureAreWhatWasTraced) {
    Scene scene                 = mirror_scene();
    const Mesh box              = make_box({0.4f, 0.3f, 0.5f});
    std::vector<vec3> positions = box.positions;
    for (vec3& p : positions) p += vec3(-0.5f, 0.5f, 1);
    add_object(scene, "box", positions, {}, box.triangles, 2);
    for (const bool shadows : {true, false}) {
        const TemporaryFolder folder;
        const PreparedScene prepared = prepare_scene(scene, "mirrors", {});
        WhittedOptions options       = quick();
        options.bodies               = find_bodies(prepared.scene);
        if (!shadows) options.method.reset();
        const Json record        = traced(prepared, options, folder.path());
        const Json& found        = record["formula"];
        const CameraFrame raster = frame(scene.camera, 64, 48);
        const FormulaScene formula(prepared.scene, *options.bodies);
        const RayTree tree = formula.trace(raster, {.depth = 5, .least_weight = 0.0003});
        ASSERT_EQ(found["depths"].size(), tree.levels.size());
        RayCounts all;
        std::vector<std::vector<VisibilityPlane>> visibility;
        for (std::size_t d = 0; d < tree.levels.size(); ++d) {
            const RayCounts& counts = tree.levels[d].counts;
            EXPECT_EQ(found["depths"][d]["depth"], d + 1);
            EXPECT_EQ(found["depths"][d]["eye"], counts.eye);
            EXPECT_EQ(found["depths"][d]["reflected"], counts.reflected);
            EXPECT_EQ(found["depths"][d]["refracted"], counts.refracted);
            EXPECT_EQ(found["depths"][d]["met"], counts.met);
            EXPECT_EQ(found["depths"][d]["shadow"], counts.shadow);
            EXPECT_EQ(found["depths"][d]["too_deep"], counts.too_deep);
            all.eye += counts.eye, all.reflected += counts.reflected, all.refracted += counts.refracted;
            all.met += counts.met, all.shadow += counts.shadow, all.total += counts.total;
            visibility.push_back(shadows ? formula.visibility(tree, d)
                                         : lit_everywhere(prepared.scene, tree.levels[d].points));
        }
        const Json totals = {{"eye", all.eye}, {"reflected", all.reflected}, {"refracted", all.refracted},
                             {"met", all.met}, {"shadow", all.shadow},       {"total_reflections", all.total}};
        EXPECT_EQ(found["totals"], totals);
        EXPECT_EQ(found["rays"], all.traced());
        EXPECT_GT(all.refracted, 100u);
        double reflected = 0;
        for (const Json& d : record["depths"]) reflected += d["reflected"].get<double>();
        EXPECT_EQ(found["totals_of_triangles"]["reflected"], reflected);
        EXPECT_EQ(found["bodies"], (Json{{"spheres", 1}, {"boxes", 1}, {"cylinders", 0}, {"cones", 0}, {"tori", 0}}));
        EXPECT_EQ(found["triangles_replaced"], 24u * 22 + 12);
        EXPECT_EQ(found["triangles_left"], scene.triangles.size() - 24 * 22 - 12);
        EXPECT_TRUE(found["light_samples"].is_null());
        EXPECT_GT(found["ms"], 0.0);
        const Image image = gather(scene, tree, light_of_rays(scene, tree, visibility), 5);
        const Image shown = displayed(image, scene.tone, 1);
        EXPECT_LT(largest_difference(file_of(folder, found["picture"]), shown), 0.6 / 255);
        EXPECT_GT(found["rmse"], 0.0);
        EXPECT_LT(found["rmse"].get<double>(), 0.1) << "the same scene";
        EXPECT_GT(found["max_difference"], found["rmse"]);
        EXPECT_GT(found["flip"], 0.0);
        EXPECT_LT(found["flip"].get<double>(), 0.1);
    }
    scene.lights[0].kind = LightKind::sphere, scene.lights[0].radius = 0.1f;
    const TemporaryFolder folder;
    const PreparedScene prepared = prepare_scene(scene, "mirrors", {});
    WhittedOptions options       = quick();
    options.bodies               = find_bodies(prepared.scene);
    EXPECT_EQ(traced(prepared, options, folder.path())["formula"]["light_samples"], kFormulaLightSamples);
    options.bodies.reset();
    EXPECT_TRUE(traced(prepared, options, folder.path())["formula"].is_null());
}

TEST(WhittedStudy, RefusesMethodsThatNeedARaster) {
    MethodInfo info;
    EXPECT_EQ(refusal_of(info), "");
    info.needs_raster = true;
    EXPECT_NE(refusal_of(info).find("raster"), std::string::npos);
    for (const MethodInfo* method : methods()) EXPECT_EQ(refusal_of(*method).empty(), !method->needs_raster);
}

/// Every figure of a record with numbers that differ is where its head says.
TEST(WhittedStudy, TableAndPageShowTheRecord) {
    Json record = {
        {"schema", 2},
        {"version", "1"},
        {"command", "umbra whitted"},
        {"scene", {{"title", "T"}, {"warnings", {"Something is missing."}}}},
        {"method", "exact"},
        {"depth", 4},
        {"least_weight", 0.125},
        {"pixel_samples", 9},
        {"pixel_places", "jittered"},
        {"glossy", false},
        {"picture", "whitted.png"},
        {"rays_picture", "rays.png"},
        {"most_rays_a_pixel", 7.5},
        {"undefined", 77},
        {"total_ms", 40.25},
        {"blind", {{"planes", 1}, {"points", 23}, {"points_in_shadow", 19}, {"picture", "blind.png"}}},
        {"screen_door", {{"rmse", 0.3125}, {"flip", 0.4375}, {"rays", 87}, {"ms", 2.5}, {"picture", "door.png"}}},
        {"single", {{"rmse", 0.34375}, {"flip", 0.46875}, {"picture", "single.png"}}}};
    record["depths"] = Json::array();
    record["depths"].push_back({{"depth", 2},
                                {"eye", 11},
                                {"reflected", 1201},
                                {"refracted", 1302},
                                {"met", 1403},
                                {"left", 1504},
                                {"shadow", 1605},
                                {"total_reflections", 1706},
                                {"too_light", 1807},
                                {"too_deep", 1908},
                                {"rmse", 0.0625},
                                {"flip", 0.1875},
                                {"picture", "depth_2.png"}});
    record["phases"]       = Json::array({{{"name", "shadows"}, {"ms", 30.5}, {"fraction", 0.75}}});
    record["ways"]         = Json::array({{{"name", "eye_rays"},
                                           {"rays", 456},
                                           {"ms", 50.5},
                                           {"different_pixels", 3},
                                           {"max_difference", 0.375},
                                           {"growth", 1.75}}});
    record["kept"]         = nullptr;
    record["search"]       = {{"triangles", 8},
                              {"rays", 9},
                              {"of", 10},
                              {"tree_us", 0.25},
                              {"search_us", 12.5},
                              {"ratio", 50},
                              {"all_by_search_ms", 1500},
                              {"different", 4},
                              {"ways", Json::array({{{"name", "octree"},
                                                     {"build_ms", 5115},
                                                     {"us", 5216},
                                                     {"volumes", 5317},
                                                     {"triangles", 5418},
                                                     {"different", 5519}}})}};
    record["formula"]      = {{"bodies", {{"spheres", 31}, {"boxes", 32}, {"cones", 1}}},
                              {"triangles_replaced", 3301},
                              {"triangles_left", 3402},
                              {"light_samples", 16},
                              {"totals",
                               {{"eye", 3503},
                                {"reflected", 3604},
                                {"refracted", 3705},
                                {"met", 3806},
                                {"shadow", 3907},
                                {"total_reflections", 4008}}},
                              {"totals_of_triangles",
                               {{"eye", 4109},
                                {"reflected", 4210},
                                {"refracted", 4311},
                                {"met", 4412},
                                {"shadow", 4513},
                                {"total_reflections", 4614}}},
                              {"rays", 4715},
                              {"ms", 48.5},
                              {"rmse", 0.03125},
                              {"max_difference", 0.875},
                              {"flip", 0.046875},
                              {"picture", "formula.png"}};
    const std::string text = study_text(whitted_report(typed(record)));
    EXPECT_NE(
        text.find(
            "by formula (spheres: 31, boxes: 32, cones: 1, instead of 3301 triangles): 48.5 ms; RMSE 0.03125, FLIP 0.0469, "
            "largest difference 0.875\n"),
        std::string::npos)
        << text;
    EXPECT_NE(text.find("\nreflected               4210        3604\n"), std::string::npos) << text;
    EXPECT_NE(text.find("    2   11       1201       1302           1403  1504         1605       1807      1908  "
                        "0.06250\n"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("shadows      30.5     75.0\n"), std::string::npos) << text;
    EXPECT_NE(text.find("eye_rays     456      50.5                   3\n"), std::string::npos) << text;
    EXPECT_NE(text.find("a ray: 0.250 µs by the tree of boxes, 12.5 µs against all 8 triangles (9 rays)"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("23 pixels, 19 of them in shadow"), std::string::npos) << text;
    EXPECT_NE(text.find("taken as lit: 77"), std::string::npos) << text;
    EXPECT_NE(text.find("RMSE 0.31250, 87 rays"), std::string::npos) << text;

    const TemporaryFolder folder;
    StagedFiles staged;
    write_study_page(whitted_report(typed(record)), typed(record).head, folder.path(), staged);
    staged.commit();
    std::ifstream in(folder.path() / "index.html");
    const std::string page{std::istreambuf_iterator<char>(in), {}};
    std::string cells = "<th scope=\"row\">2</th>";
    for (const int value : {1201, 1302, 1403, 1504, 1605, 1706, 1807, 1908}) cells += "<td>" + count(value) + "</td>";
    for (const std::string& part :
         std::vector<std::string>{cells + "<td>0.06250</td><td>0.1875</td>",
                                  "<td>30.5</td><td>75.0</td>",
                                  "<td>456</td><td>50.5</td><td>3</td><td>0.375</td>",
                                  "11 eye rays, " + count(1201) + " reflected rays, " + count(1302),
                                  count(1605) + " shadow rays; 40.2 ms",
                                  "against each of 8 triangles: 12.5 µs a ray instead of 0.250 µs",
                                  "50.0 times as long (one thread, 9 of 10 secondary rays; 4 met",
                                  "would take 1.50 s",
                                  "<img src=\"whitted.png\"",
                                  "<img src=\"rays.png\"",
                                  "<img src=\"blind.png\"",
                                  "<img src=\"depth_2.png\"",
                                  "<img src=\"door.png\"",
                                  "87 rays; RMSE 0.31250 from the picture, FLIP 0.4375",
                                  "One eye ray a pixel: RMSE 0.34375 from the picture, FLIP 0.4688.",
                                  "23 pixels of diffuse",
                                  "19 of them (orange)",
                                  "<img src=\"formula.png\"",
                                  "31 spheres, 32 boxes, 1 cone",
                                  "instead of " + count(3301) + " triangles; " + count(3402) + " triangles remain",
                                  "the mean of 16 of them",
                                  count(4715) + " rays, 48.5 ms; RMSE 0.03125",
                                  "FLIP 0.0469, largest difference 0.875",
                                  "reflected rays</th><td>" + count(4210) + "</td><td>" + count(3604),
                                  "total reflections</th><td>" + count(4614) + "</td><td>" + count(4008),
                                  "is below 0.125",
                                  "at depth 4",
                                  "9 eye rays a pixel, each anywhere in its part of the pixel",
                                  "white 7.5",
                                  "77 answers of the method were undefined",
                                  "Something is missing.",
                                  "<code>exact</code>"})
        EXPECT_NE(page.find(part), std::string::npos) << part;
    EXPECT_NE(page.find("every mirror here is perfect"), std::string::npos);
    record["glossy"] = true;
    record["search"] = record["kept"] = record["blind"] = record["screen_door"] = record["single"] = record["formula"] =
        nullptr,
    record["undefined"] = 0;
    StagedFiles again;
    write_study_page(whitted_report(typed(record)), typed(record).head, folder.path(), again);
    again.commit();
    std::ifstream other(folder.path() / "index.html");
    const std::string plain{std::istreambuf_iterator<char>(other), {}};
    EXPECT_EQ(plain.find("against each of"), std::string::npos);
    EXPECT_EQ(plain.find("Not seen:"), std::string::npos);
    EXPECT_EQ(plain.find("Screen door"), std::string::npos);
    EXPECT_EQ(plain.find("by formula"), std::string::npos);
    EXPECT_EQ(study_text(whitted_report(typed(record))).find("by formula"), std::string::npos);
    EXPECT_EQ(plain.find("every mirror here is perfect"), std::string::npos);
    EXPECT_EQ(plain.find("were undefined"), std::string::npos);
    EXPECT_NE(plain.find("This scene has no plane mirror."), std::string::npos);
}

}  // namespace
}  // namespace umbra
