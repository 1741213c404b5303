// The EXRs of compare and render, read back: every channel and attribute is as docs/exr.md says.
#include "umbra/bench/compare/exr_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "umbra/bench/compare/compare.h"
#include "umbra/bench/lab/outcome.h"
#include "umbra/core/image/image_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// Column `files` of the tables of docs/exr.md by the name in their first column, with its type.
struct Row {
    std::string type, files;
};
std::map<std::string, Row> documented(const std::string& type_of_attributes) {
    std::map<std::string, Row> rows;
    std::ifstream in(fs::path(UMBRA_TOP) / "docs/exr.md");
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with("| `")) continue;
        std::istringstream cells(line);
        std::vector<std::string> cell;
        for (std::string c; std::getline(cells, c, '|');) cell.push_back(c);
        const auto trim = [](std::string s) {
            s.erase(0, s.find_first_not_of(" `"));
            s.erase(s.find_last_not_of(" `") + 1);
            return s;
        };
        const std::string type  = trim(cell.at(2));
        const bool is_attribute = type == "string" || type == "m44f";
        if (is_attribute == (type_of_attributes == "attributes")) rows[trim(cell.at(1))] = {type, trim(cell.at(3))};
    }
    return rows;
}

/// What a file of a kind holds by the document: NAME TYPE, with `<light>` once a light.
std::set<std::string> expected(const std::string& table, const std::string& kind) {
    std::set<std::string> all;
    for (const auto& [name, row] : documented(table)) {
        if (row.files.find("all") == std::string::npos && row.files.find(kind) == std::string::npos) continue;
        const std::size_t at = name.find("<light>");
        if (at == std::string::npos)
            all.insert(name + " " + row.type);
        else
            for (const char* light : {"lamp", "panel"}) all.insert(name.substr(0, at) + light + " " + row.type);
    }
    return all;
}

std::set<std::string> channels(const Image& image) {
    std::set<std::string> all;
    for (const std::string& name : image.channels) all.insert(name + " float");
    for (const auto& integer : image.integers) all.insert(integer.first + " uint");
    return all;
}

std::set<std::string> attributes(const Image& image) {
    std::set<std::string> all;
    for (const auto& entry : image.metadata)
        if (entry.first.starts_with("umbra:")) all.insert(entry.first + " string");
    for (const auto& entry : image.matrices) all.insert(entry.first + " m44f");
    return all;
}

class ExrLayersOf : public testing::Test {
protected:
    void SetUp() override {
        scene_ = folder_.path() / "scene.json";
        std::ofstream(scene_) << R"({
            "camera": {"eye": [1, 3, 6], "target": [0, 0.5, 0]},
            "lights": [{"name": "lamp", "type": "point", "position": [2, 4, 1]},
                       {"name": "panel", "type": "rectangle", "position": [-2, 4, 1], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]}],
            "objects": [{"name": "floor", "type": "plane", "size": [8, 8]},
                        {"name": "box", "type": "box", "size": [1, 1, 1], "transform": [{"translate": [0, 1, 0]}]},
                        {"name": "ball", "type": "sphere", "radius": 0.6, "transform": [{"translate": [2, 0.6, 1]}]}]
        })";
        options_.methods = {"shadow_zbuffer:resolution=64", "planar_projection"};
        options_.out     = folder_.path() / "out";
        options_.size    = {96, 54};
        options_.points  = 500;
        options_.command = "umbra compare";
        options_.repeats = {1, 0};
    }
    TemporaryFolder folder_;
    fs::path scene_;
    CompareOptions options_;
};

TEST_F(ExrLayersOf, FilesHoldWhatTheDocumentSays) {
    compare_scene(scene_, options_);
    const Image reference = read_image(options_.out / "scene/reference.exr").image;
    EXPECT_EQ(channels(reference), expected("channels", "reference"));
    EXPECT_EQ(attributes(reference), expected("attributes", "reference"));
    const Image method = read_image(options_.out / "scene/shadow_zbuffer.exr").image;
    EXPECT_EQ(channels(method), expected("channels", "methods"));
    EXPECT_EQ(attributes(method), expected("attributes", "methods"));
    ASSERT_TRUE(render_scene(scene_, {.method        = "ray_traced",
                                      .size          = {96, 54},
                                      .out           = folder_.path() / "a.exr",
                                      .command       = "umbra render",
                                      .with_geometry = true}));
    const Image rendered = read_image(folder_.path() / "a.exr").image;
    EXPECT_EQ(channels(rendered), expected("channels", "geometry"));
    EXPECT_EQ(attributes(rendered), expected("attributes", "geometry"));
}

TEST_F(ExrLayersOf, AFarSceneSaysWhatPositionsAreRelativeTo) {
    std::ofstream(scene_) << R"({
        "camera": {"eye": [5000001, 3, -2999994], "target": [5000000, 0.5, -3000000]},
        "lights": [{"name": "lamp", "type": "point", "position": [5000002, 4, -2999999]}],
        "objects": [{"type": "plane", "size": 8, "transform": [{"translate": [5000000, 0, -3000000]}]}]
    })";
    ASSERT_TRUE(render_scene(scene_, {.method        = "ray_traced",
                                      .size          = {16, 9},
                                      .out           = folder_.path() / "a.exr",
                                      .command       = "umbra render",
                                      .with_geometry = true}));
    EXPECT_EQ(read_image(folder_.path() / "a.exr").image.metadata.at("umbra:origin"), "5000000 0 -3000000");
}

TEST_F(ExrLayersOf, GeometryNamesEveryPointExactly) {
    compare_scene(scene_, options_);
    const PreparedScene prepared = prepare_scene(scene_, options_.size);
    const Scene& scene           = prepared.scene;
    const PointBatch& points     = prepared.points;
    const Image image            = read_image(options_.out / "scene/reference.exr").image;
    const auto value             = [&](const char* name, std::size_t i) {
        const auto at = std::find(image.channels.begin(), image.channels.end(), name);
        return image.at(i, std::size_t(at - image.channels.begin()));
    };
    const auto transformed = [&](const char* matrix, vec3 p) {
        const auto& m = image.matrices.at(matrix);
        dvec4 out(0);
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r) out[c] += double(r < 3 ? p[r] : 1) * double(m[std::size_t(4 * r + c)]);
        return dvec3(out) / out.w;
    };
    std::size_t hits = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(image.integers.at("id.face")[i], points.triangle[i]);
        if (points.triangle[i] == kNoTriangle) {
            EXPECT_EQ(image.integers.at("id.object")[i], kNoTriangle);
            EXPECT_EQ(value("Z", i), kInfinity);
            continue;
        }
        ++hits;
        ASSERT_EQ(image.integers.at("id.object")[i], scene.triangle_object[points.triangle[i]]);
        ASSERT_EQ(value("barycentric.u", i), points.u[i]);
        ASSERT_EQ(value("barycentric.v", i), points.v[i]);
        const vec3 p(value("P.x", i), value("P.y", i), value("P.z", i));
        ASSERT_EQ(p, points.position(i));
        ASSERT_EQ(vec3(value("N.x", i), value("N.y", i), value("N.z", i)), points.normal(i));
        const std::size_t column = i % 96, row = i / 96;
        const dvec3 ndc = transformed("worldToNDC", p), camera = transformed("worldToCamera", p);
        ASSERT_NEAR(ndc.x * 96, double(column) + 0.5, 1e-3);
        ASSERT_NEAR(ndc.y * 54, double(row) + 0.5, 1e-3);
        ASSERT_NEAR(camera.z, double(value("Z", i)), 1e-4);
        ASSERT_NEAR(ndc.z, 1 / camera.z, 1e-4);
        ASSERT_GT(camera.x * (ndc.x - 0.5), -1e-6) << "x to the right";
        ASSERT_LT(camera.y * (ndc.y - 0.5), 1e-6) << "y up";
        for (LightId j = 0; j < 2; ++j)
            ASSERT_EQ(image.integers.at("facing." + scene.lights[j].name)[i], std::uint32_t(points.facing[j][i]));
    }
    EXPECT_GT(hits, 1000u);
    const Json objects = Json::parse(image.metadata.at("umbra:objects"));
    ASSERT_EQ(objects.size(), 3u);
    EXPECT_EQ(objects[1]["name"], "box");
    EXPECT_EQ(objects[1]["first_triangle"], scene.objects[1].first_triangle);
    EXPECT_EQ(objects[1]["triangles"], 12);
}

TEST_F(ExrLayersOf, AnswersClassesAndJudgedPointsAreThoseOfTheRun) {
    compare_scene(scene_, options_);
    const PreparedScene prepared = prepare_scene(scene_, options_.size);
    const ReferenceRun reference = run_reference(default_reference(prepared.facts), prepared.scene, prepared.facts,
                                                 prepared.points, options_.points);
    const Image of_reference     = read_image(options_.out / "scene/reference.exr").image;
    for (LightId j = 0; j < 2; ++j) {
        const std::string& light = prepared.scene.lights[j].name;
        const auto judged        = reference.run.judged_points(j);
        for (std::size_t i = 0; i < prepared.points.size(); ++i)
            ASSERT_EQ(of_reference.integers.at("judged." + light)[i], judged.empty() || judged[i] ? 1u : 0u);
    }
    std::set<std::uint32_t> answers, classes;
    for (const char* name : {"shadow_zbuffer:resolution=64", "planar_projection"}) {
        const MethodRun run = run_method(parse_method(name), prepared.scene, prepared.facts, prepared.points);
        const Image image   = read_image(options_.out / ("scene/" + std::string(run.choice.info->name) + ".exr")).image;
        for (LightId j = 0; j < 2; ++j) {
            const std::string& light = prepared.scene.lights[j].name;
            const ClassPlane truth   = explain(prepared.scene, prepared.points, j, run, reference.run).classes;
            const auto &answer = image.integers.at("answer." + light), &code = image.integers.at("class." + light);
            const auto s = std::find(image.channels.begin(), image.channels.end(), "S." + light);
            for (std::size_t i = 0; i < truth.size(); ++i) {
                ASSERT_EQ(answer[i], std::uint32_t(run.planes[j].answer[i]));
                ASSERT_EQ(std::isnan(image.at(i, std::size_t(s - image.channels.begin()))), answer[i] == 0);
                ASSERT_EQ(code[i], std::uint32_t(truth[i])) << name << ' ' << light << ' ' << i;
            }
            answers.insert(answer.begin(), answer.end());
            classes.insert(code.begin(), code.end());
        }
        EXPECT_NE(image.metadata.at("umbra:class").find("15 leak, 16 penumbra, 17 noise"), std::string::npos);
    }
    EXPECT_EQ(answers.size(), 2u) << "one of the methods leaves points undefined";
    EXPECT_GT(classes.size(), 5u);
}

TEST(WorldToNdc, OfAnOrthographicCamera) {
    Camera camera;
    camera.projection   = Projection::orthographic;
    camera.eye          = {1, 2, 5};
    const CameraFrame f = frame(camera, 40, 20);
    const dvec3 p       = f.ray_origin(10, 5) + 3.0 * f.forward;
    const auto m        = world_to_ndc(f);
    dvec4 out(0);
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) out[c] += (r < 3 ? p[r] : 1) * double(m[std::size_t(4 * r + c)]);
    EXPECT_NEAR(out.x, 0.25, 1e-6);
    EXPECT_NEAR(out.y, 0.25, 1e-6);
    EXPECT_NEAR(out.z, 3, 1e-6);
    EXPECT_NEAR(out.w, 1, 1e-6);
}

}  // namespace
}  // namespace umbra
