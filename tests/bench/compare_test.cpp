// compare: what it writes, that it follows its schema, that it replaces nothing that is not its own.
#include "umbra/bench/compare/compare.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "umbra/bench/base/files.h"
#include "umbra/bench/cli/long_runs.h"
#include "umbra/bench/report/report.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/tests/support/json_schema.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

void write(const fs::path& file, std::string_view text) { std::ofstream(file, std::ios::binary) << text; }

void expect_valid(const Json& json) { EXPECT_TRUE(fits(results_schema().dump(), json.dump())); }

class Compare : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("umbra-compare-" + std::to_string(::getpid()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        scene_ = folder_ / "lamp_over_box.json";
        write(scene_, R"({
            "shows": "A box under a lamp & a panel <here>.",
            "camera": {"eye": [0, 3, 6], "target": [0, 0.5, 0]},
            "lights": [{"name": "lamp", "type": "point", "position": [2, 4, 1]},
                       {"name": "panel", "type": "rectangle", "position": [-2, 4, 1], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]}],
            "objects": [{"name": "floor", "type": "plane", "size": [8, 8]},
                        {"name": "ball", "type": "sphere", "radius": 1.2, "transform": [{"translate": [1.8, 1.2, 0.8]}]},
                        {"name": "box", "type": "box", "size": [1, 1, 1], "transform": [{"translate": [0, 1, 0]}]}]
        })");
        options_.out     = folder_ / "out";
        options_.size    = {96, 54};
        options_.command = "umbra compare lamp_over_box.json -o out";
        options_.repeats = {1, 0};
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path folder_, scene_;
    CompareOptions options_;
};

/// A large light close above the floor, half hidden by a board: the part that is hidden matters more, or less, to
/// irradiance than its area says.
TEST_F(Compare, IrradianceIsComparedWithIrradiance) {
    const fs::path scene = folder_ / "board.json";
    write(scene, R"({
        "shows": "A large light close above a floor, and a board that hides part of it.",
        "camera": {"eye": [0, 2, 5], "target": [0, 0, 0]},
        "lights": [{"name": "panel", "type": "rectangle", "position": [0, 1.5, 0], "edge_u": [4, 0, 0], "edge_v": [0, 0, 4]}],
        "objects": [{"name": "floor", "type": "plane", "size": [6, 6]},
                    {"name": "board", "type": "box", "size": [1.5, 0.05, 3], "transform": [{"translate": [1, 0.6, 0]}]}]
    })");
    options_.methods = {"ray_traced:samples=1024", "ray_traced:samples=1024,measure=irradiance", "shadow_volumes"};
    ASSERT_EQ(compare_scenes({scene}, options_).names.size(), 1u);
    const Json record = Json::parse(text_of(options_.out / "board" / "results.json"));
    expect_valid(record);
    const Json &area = record["methods"][0], &irradiance = record["methods"][1];
    EXPECT_EQ(area["measures"], "area");
    EXPECT_EQ(area["compared_with"], "exact");
    EXPECT_EQ(irradiance["measures"], "irradiance");
    EXPECT_EQ(irradiance["compared_with"], "exact:measure=irradiance");
    EXPECT_LT(area["errors"][0]["rmse"].get<double>(), 0.004);
    EXPECT_LT(irradiance["errors"][0]["rmse"].get<double>(), 0.004);

    // The two truths are far apart here, so that neither could pass for the other.
    const Image a = read_image(options_.out / "board" / "ray_traced.exr").image;
    const Image b = read_image(options_.out / "board" / "ray_traced-2.exr").image;
    double most   = 0;
    for (std::size_t i = 0; i < a.pixels(); ++i) {
        const std::size_t c = static_cast<std::size_t>(std::ranges::find(a.channels, "S.panel") - a.channels.begin());
        most                = std::max(most, std::abs(double(a.at(i, c)) - double(b.at(i, c))));
    }
    EXPECT_GT(most, 0.05);
}

TEST_F(Compare, RecordFollowsItsSchemaAndNamesFilesThatExist) {
    const ScenesDone done = compare_scenes({scene_}, options_);
    ASSERT_TRUE(done.failed.empty()) << done.failed[0];
    ASSERT_EQ(done.names, std::vector<std::string>{"lamp_over_box"});

    for (const fs::path& file : {options_.out / "lamp_over_box/results.json", options_.out / "results.json"}) {
        const std::string text = text_of(file);
        EXPECT_TRUE(fits(results_schema().dump(), text)) << file;
        EXPECT_EQ(record_text(from_record<Results>(read_results(file))), text) << "what is read and written again";

        const Json json    = Json::parse(text);
        std::size_t served = 0;
        for (const Json& method : json["methods"]) {
            if (method["serves"]["how"] == "not") continue;
            ++served;
            for (const char* key : {"exr", "png", "flip"})
                EXPECT_TRUE(fs::exists(file.parent_path() / method["files"][key])) << method["files"][key];
            for (const Json& light : method["files"]["lights"])
                for (const Json& name : light) EXPECT_TRUE(fs::exists(file.parent_path() / name)) << name;
            EXPECT_EQ(method["errors"].size(), 2u);
        }
        EXPECT_GE(served, 3u);
    }
}

/// A floor that receives no shadows, and a box over it: its points are counted, and compared nowhere.
/// The bytes of "data:image/png;base64,...", as a picture of 8 bits.
Image decoded(const std::string& url, const fs::path& folder) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/",
                      head   = "data:image/png;base64,";
    EXPECT_TRUE(url.starts_with(head));
    std::string bytes;
    std::uint32_t bits = 0;
    int held           = 0;
    for (const char c : url.substr(head.size())) {
        if (c == '=') break;
        bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
        if ((held += 6) >= 8) bytes += static_cast<char>(bits >> (held -= 8) & 255);
    }
    write(folder / "values.png", bytes);
    return read_image(folder / "values.png").image;
}

/// What a page shows under the cursor is what the planes of the EXR files hold.
TEST_F(Compare, ValuesOfThePageAreThoseOfThePlanes) {
    options_.methods = {"shadow_zbuffer:resolution=64", "planar_projection"};
    ASSERT_EQ(compare_scenes({scene_}, options_).names.size(), 1u);
    const fs::path folder = options_.out / "lamp_over_box";
    const Json record     = Json::parse(text_of(folder / "results.json"));
    ASSERT_EQ(record["values"], "values.js");
    const std::string script = text_of(folder / "values.js"), call = "umbraValues(";
    ASSERT_TRUE(script.starts_with(call) && script.ends_with(");\n"));
    const Json values = Json::parse(script.substr(call.size(), script.size() - call.size() - 3));
    EXPECT_EQ(values["lights"], (Json{"lamp", "panel"}));
    EXPECT_EQ(values["objects"][0], (Json{"floor", 2}));
    EXPECT_EQ(values["columns"][1]["who"], "Shadow z-buffer (resolution=64)");
    const Image reference = read_image(folder / "reference.exr").image, faces = decoded(values["faces"], folder_);
    const auto byte = [](const Image& image, std::size_t i, std::size_t c) {
        return static_cast<unsigned>(std::lround(255 * image.at(i, c)));
    };
    const auto& triangle = reference.integers.at("id.face");
    for (std::size_t i = 0; i < faces.pixels(); ++i)
        ASSERT_EQ((byte(faces, i, 0) << 16 | byte(faces, i, 1) << 8 | byte(faces, i, 2)) - 1, triangle[i]) << i;
    std::size_t shadow = 0, wrong = 0, undefined = 0;
    for (const auto& [column, file] : {std::pair{0, "reference"}, {1, "shadow_zbuffer"}, {2, "planar_projection"}}) {
        const Image exr = read_image(folder / (std::string(file) + ".exr")).image;
        for (const auto& [k, light] : {std::pair{0, "lamp"}, {1, "panel"}}) {
            const Image plane       = decoded(values["columns"][column]["planes"][k], folder_);
            const std::string named = light;
            const auto s            = std::size_t(std::ranges::find(exr.channels, "S." + named) - exr.channels.begin());
            const auto& answers     = exr.integers.at("answer." + named);
            for (std::size_t i = 0; i < exr.pixels(); ++i) {
                ASSERT_EQ(byte(plane, i, 2), answers[i] == 0 ? 0u : 255u) << file << ' ' << light << ' ' << i;
                if (answers[i] != 0) {
                    ASSERT_EQ(byte(plane, i, 0), std::lround(255 * exr.at(i, s))) << file << ' ' << i;
                }
                if (column > 0) {
                    ASSERT_EQ(byte(plane, i, 1), exr.integers.at("class." + named)[i]) << file << ' ' << i;
                }
                shadow += byte(plane, i, 0) == 0;
                wrong += column > 0 && byte(plane, i, 1) > static_cast<unsigned>(ErrorClass::terminator_wrong);
                undefined += answers[i] == 0;
            }
        }
    }
    EXPECT_GT(shadow, 100u);
    EXPECT_GT(wrong, 10u);
    EXPECT_GT(undefined, 10u);
}

TEST_F(Compare, PointsThatReceiveNoShadowsAreCountedApart) {
    const fs::path scene = folder_ / "lit.json";
    write(scene, R"({
        "shows": "A floor that no shadow falls on.",
        "camera": {"eye": [0, 3, 6], "target": [0, 0.5, 0]},
        "lights": [{"name": "sun", "type": "directional", "direction": [0, -1, -0.5]}],
        "objects": [{"name": "floor", "type": "plane", "size": [8, 8], "receives_shadows": false},
                    {"name": "box", "type": "box", "size": [1, 1, 1], "transform": [{"translate": [0, 1, 0]}]}]
    })");
    options_.methods  = {"ray_traced", "shadow_zbuffer"};
    const Json record = to_record(compare_scene(scene, options_));
    expect_valid(record);
    EXPECT_EQ(record["facts"]["objects"][0]["receives_shadows"], false);
    EXPECT_FALSE(record["facts"]["objects"][1].contains("receives_shadows"));
    const PreparedScene prepared = prepare_scene(scene, {96, 54}, 1);
    int floor = 0, box = 0;
    for (const TriangleId t : prepared.points.triangle)
        if (t != kNoTriangle) ++(prepared.scene.triangle_object[t] == 0 ? floor : box);
    for (const Json& method : record["methods"]) {
        const Json& e = method["errors"][0];
        EXPECT_EQ(e["unshadowed"], floor) << "the sun is above all of it";
        EXPECT_EQ(e["points"].get<int>() + e["undefined"].get<int>() + e["on_boundary"].get<int>() +
                      e["away"].get<int>() + e["not_judged"].get<int>(),
                  box);
    }
}

TEST_F(Compare, AReferenceTooDearJudgesAStratifiedSample) {
    options_.methods = {"ray_traced", "exact"};
    const Json whole = to_record(compare_scene(scene_, options_));
    EXPECT_TRUE(whole["reference"]["judged"].is_null());
    options_.points   = 300;
    const Json sample = to_record(compare_scene(scene_, options_)), again = to_record(compare_scene(scene_, options_));

    const Json& judged = sample["reference"]["judged"];
    EXPECT_NEAR(judged["points"], 300.0, 100);
    for (std::size_t m = 0; m < 2; ++m) {
        const Json &lamp = sample["methods"][m]["errors"][0], &panel = sample["methods"][m]["errors"][1];
        EXPECT_EQ(lamp, whole["methods"][m]["errors"][0]) << "a light without an area is judged everywhere";
        EXPECT_EQ(panel, again["methods"][m]["errors"][1]) << "the sample is always the same";
        const auto of = [](const Json& e) {
            return e["points"].get<int>() + e["undefined"].get<int>() + e["on_boundary"].get<int>() +
                   e["away"].get<int>() + e["not_judged"].get<int>();
        };
        EXPECT_EQ(of(panel), judged["of"]);
        EXPECT_LE(panel["points"], judged["points"]);
        const int all = whole["methods"][m]["errors"][1]["terminator"]["normal_away"];
        EXPECT_GT(all, 5);
        EXPECT_LT(2 * panel["terminator"]["normal_away"].get<int>(), all) << "what is not judged is not counted";
        EXPECT_GT(panel["points"], 100);
        EXPECT_FALSE(panel["penumbra_width_px"].is_null()) << "guesses say where boundaries are";
        EXPECT_GT(panel["penumbra"], 5);
    }
    // Judged are exact answers and not guesses: exact agrees with itself, and rays err by about what they err overall.
    EXPECT_EQ(sample["methods"][1]["errors"][1]["max"], 0);
    const double mae = whole["methods"][0]["errors"][1]["mae"], sampled = sample["methods"][0]["errors"][1]["mae"];
    EXPECT_GT(sampled, 0.2 * mae);
    EXPECT_LT(sampled, 5 * mae);
}

/// Lit everywhere, but fails where its parameter says.
enum class Fails : std::uint8_t { never, build, aim, look, visibility, contract };
struct FailingOptions {
    Fails at = Fails::never;
};
class Failing : public MethodWith<FailingOptions> {
public:
    explicit Failing(const Settings& settings) : MethodWith(settings) {}

    [[nodiscard]] Service serves(const SceneFacts&) const override { return {How::approximately, "for a test"}; }
    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        if (options.at == Fails::build) throw std::runtime_error("no stone left");
        return MethodWith::build(scene, facts);
    }
    [[nodiscard]] std::unique_ptr<const Aimed> aim(const Built& built, LightId light) const override {
        if (options.at == Fails::aim && built.scene.lights[light].name == "panel")
            throw UsageError("the panel is too large");
        return MethodWith::aim(built, light);
    }
    [[nodiscard]] std::unique_ptr<const Looked> look(const Built& built, const PointBatch& points) const override {
        if (options.at == Fails::look) throw MethodError("it sees nothing");
        return MethodWith::look(built, points);
    }
    void visibility(const Aimed& aimed, const Looked& looked, Visibility out) const override {
        const PointBatch& points = looked.points;
        if (options.at == Fails::visibility && aimed.light == 1) throw std::bad_alloc();
        for (std::size_t i = 0; i < points.size(); ++i)
            if (points.asks(aimed.light, i)) out.s[i] = options.at == Fails::contract ? 1.5f : 1;
    }
};

int builds = 0;

/// Fails when it is timed, after its answers have been written.
class FailsAgain final : public Method {
public:
    explicit FailsAgain(const Settings&) {}
    [[nodiscard]] Service serves(const SceneFacts&) const override { return {How::approximately, "once"}; }
    [[nodiscard]] std::unique_ptr<const Built> build(const Scene& scene, const SceneFacts& facts) const override {
        if (++builds > 1) throw std::runtime_error("not again");
        return Method::build(scene, facts);
    }
    void visibility(const Aimed&, const Looked&, Visibility) const override {}
};

TEST_F(Compare, AMethodThatFailsWhenItIsTimedLeavesNoValues) {
    MethodInfo info;
    info.name        = "once";
    info.title       = "Only once";
    info.create      = create<FailsAgain>;
    options_.methods = {"shadow_zbuffer"};
    options_.choices.emplace_back(info);
    options_.repeats = {3, 1000};
    builds           = 0;
    ASSERT_EQ(compare_scenes({scene_}, options_).stopped.size(), 1u);
    EXPECT_GT(builds, 1);
    EXPECT_FALSE(fs::exists(options_.out / "lamp_over_box/once.exr"));
    const std::string values = text_of(options_.out / "lamp_over_box/values.js");
    EXPECT_EQ(values.find("Only once"), std::string::npos);
    EXPECT_NE(values.find("\"Shadow z-buffer\""), std::string::npos);
}

TEST_F(Compare, AMethodThatFailsLosesNoOther) {
    MethodInfo info;
    info.name       = "failing";
    info.title      = "Failing";
    info.parameters = {parameter<&FailingOptions::at>("at", "Where it fails.",
                                                      {.choices = "never|build|aim|look|visibility|contract"})};
    info.create     = create<Failing>;

    options_.methods = {"shadow_zbuffer"};
    struct Case {
        const char *phase, *light, *message;
    };
    const std::vector<Case> cases = {{"build", nullptr, "no stone left"},
                                     {"aim", "panel", "the panel is too large"},
                                     {"look", nullptr, "it sees nothing"},
                                     {"visibility", "panel", "not enough memory"},
                                     {"contract", "lamp", "failing breaks its contract at point"},
                                     {"never", nullptr, ""}};
    for (const Case& c : cases) options_.choices.emplace_back(info).settings.set("at", std::string_view(c.phase));
    const ScenesDone done = compare_scenes({scene_}, options_);
    ASSERT_EQ(done.names, std::vector<std::string>{"lamp_over_box"});
    EXPECT_TRUE(done.failed.empty());
    ASSERT_EQ(done.stopped.size(), 5u);
    EXPECT_EQ(done.stopped[1], "lamp_over_box: failing:at=aim: It failed at light panel: the panel is too large");

    const Json record = Json::parse(text_of(options_.out / "lamp_over_box/results.json"));
    expect_valid(record);
    ASSERT_EQ(record["methods"].size(), 7u);
    EXPECT_FALSE(record["methods"][0].contains("failed"));
    for (std::size_t k = 0; k < 5; ++k) {
        const Json& method = record["methods"][k + 1];
        ASSERT_TRUE(method.contains("failed")) << cases[k].phase;
        EXPECT_EQ(method["failed"]["light"], cases[k].light ? Json(cases[k].light) : Json()) << cases[k].phase;
        EXPECT_NE(method["failed"]["message"].get<std::string>().find(cases[k].message), std::string::npos);
        EXPECT_EQ(method["serves"]["how"], "not");
        EXPECT_FALSE(method.contains("errors"));
    }
    EXPECT_EQ(record["methods"][6]["errors"].size(), 2u) << "the others go on";
    EXPECT_TRUE(fs::exists(options_.out / "lamp_over_box/failing-6.exr"));
}

TEST_F(Compare, AFarSceneRecordsWhatItsNumbersAreRelativeTo) {
    const fs::path far = folder_ / "far.json";
    write(far, R"({
        "camera": {"eye": [5000001, 3, -2999994], "target": [5000000, 0.5, -3000000]},
        "lights": [{"name": "lamp", "type": "point", "position": [5000002, 4, -2999999]}],
        "objects": [{"type": "plane", "size": 8, "transform": [{"translate": [5000000, 0, -3000000]}]}]
    })");
    options_.methods      = {"ray_traced"};
    const ScenesDone done = compare_scenes({far}, options_);
    ASSERT_TRUE(done.failed.empty()) << done.failed[0];
    const Json json = Json::parse(text_of(options_.out / "results.json"));
    EXPECT_EQ(json["scene"]["origin"], (Json{5000000, 0, -3000000}));
    expect_valid(json);
}

TEST_F(Compare, SchemaRefusesWhatItShould) {
    options_.methods   = {"ray_traced"};
    Json good          = to_record(compare_scene(scene_, options_));
    const auto accepts = [](const Json& record) -> bool { return fits(results_schema().dump(), record.dump()); };
    EXPECT_TRUE(accepts(good));
    for (const char* pointer :
         {"/methods/0/errors/0/false_light/interior", "/methods/0/coverage", "/reference/exact", "/schema"}) {
        Json bad                         = good;
        bad[Json::json_pointer(pointer)] = "wrong";
        EXPECT_FALSE(accepts(bad)) << pointer;
    }
    good["methods"][0]["colour"] = "an unknown key";
    EXPECT_FALSE(accepts(good));
}

TEST_F(Compare, PictureFileHoldsOnePlaneALight) {
    options_.methods = {"shadow_zbuffer"};
    compare_scene(scene_, options_);
    const LoadedImage exr = read_image(options_.out / "lamp_over_box/shadow_zbuffer.exr");
    EXPECT_EQ(exr.image.channels, (std::vector<std::string>{"R", "G", "B", "S.lamp", "S.panel"}));
    EXPECT_EQ(exr.image.integers.size(), 4u) << "answer and class of each light";
    EXPECT_EQ(exr.image.metadata.at("umbra:method"), "shadow_zbuffer");
}

TEST_F(Compare, SamePlanesWhateverTheRepeats) {
    options_.methods = {"shadow_volumes"};
    compare_scene(scene_, options_);
    const std::string once = text_of(options_.out / "lamp_over_box/shadow_volumes.S.lamp.png");
    options_.repeats       = {3, 1e9};
    compare_scene(scene_, options_);
    EXPECT_EQ(once, text_of(options_.out / "lamp_over_box/shadow_volumes.S.lamp.png"));
}

TEST_F(Compare, ReplacesOnlyItsOwnFolders) {
    fs::create_directories(options_.out / "lamp_over_box");
    write(options_.out / "lamp_over_box/thesis.tex", "two years of work");
    EXPECT_THROW((void)compare_scene(scene_, options_), InputError);
    EXPECT_EQ(text_of(options_.out / "lamp_over_box/thesis.tex"), "two years of work");
}

TEST_F(Compare, UnreadableSceneLeavesTheOldResult) {
    options_.methods = {"ray_traced"};
    compare_scene(scene_, options_);
    const std::string before = text_of(options_.out / "lamp_over_box/results.json");
    write(scene_, "{ \"lights\": [");
    const ScenesDone done = compare_scenes({scene_}, options_);
    EXPECT_EQ(done.failed.size(), 1u);
    EXPECT_EQ(text_of(options_.out / "lamp_over_box/results.json"), before);
    for (const fs::directory_entry& entry : fs::directory_iterator(options_.out))
        EXPECT_NE(entry.path().filename().string()[0], '.') << "left over: " << entry.path();
}

TEST_F(Compare, OneThrowLosesOneSceneOnly) {
    const fs::path bad = folder_ / "bad.json", broken = folder_ / "broken.json";
    fs::copy_file(scene_, bad);
    write(broken, "{ \"lights\": [");
    options_.methods = {"ray_traced"};
    std::vector<std::string> lines;
    options_.progress = [&](const std::string& what) {
        lines.push_back(what);
        if (what.find("bad: ray_traced") != std::string::npos) throw std::runtime_error("a planted defect");
    };
    const ScenesDone done = compare_scenes({bad, broken, scene_}, options_);
    EXPECT_EQ(done.names, std::vector<std::string>{"lamp_over_box"});
    ASSERT_EQ(done.failed.size(), 2u);
    EXPECT_EQ(done.failed[0], "bad: a planted defect");
    EXPECT_TRUE(done.internal);
    EXPECT_FALSE(compare_scenes({broken}, options_).internal) << "that is the input's fault";
    EXPECT_TRUE(fs::exists(options_.out / "lamp_over_box/results.json"));
    EXPECT_FALSE(fs::exists(options_.out / "bad"));
    EXPECT_EQ(lines[0], "[1/3] bad: loading");
    EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
        return line.starts_with("[3/3] lamp_over_box: ray_traced, ") && line.ends_with(" left");
    })) << lines.back();
}

TEST_F(Compare, WrongMethodsAreRefusedBeforeTheFirstScene) {
    options_.methods = {"ray_traced", "crayon"};
    EXPECT_THROW((void)compare_scenes({scene_}, options_), UsageError);
    options_.methods   = {"ray_traced"};
    options_.reference = "crayon";
    EXPECT_THROW((void)compare_scenes({scene_}, options_), UsageError);
    EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(Compare, ScenesOfOneNameHaveFoldersOfTheirOwn) {
    fs::create_directories(folder_ / "other");
    fs::copy_file(scene_, folder_ / "other/lamp_over_box.json");
    options_.methods = {"ray_traced"};
    EXPECT_EQ(compare_scenes({scene_, folder_ / "other/lamp_over_box.json"}, options_).names,
              (std::vector<std::string>{"lamp_over_box", "lamp_over_box-2"}));
    EXPECT_TRUE(fs::exists(options_.out / "lamp_over_box-2/results.json"));
    EXPECT_THROW((void)compare_scenes({scene_, scene_}, options_), UsageError);
}

/// Whoever waits for the ladders of a report can read its scenes.
TEST_F(Compare, PagesOfAllScenesAreThereBeforeWhatFollows) {
    const fs::path first = options_.out / "index.html";
    const auto linked    = [&](const char* scene) {
        return bytes_of(first).find(fmt::format("href=\"{}/index.html\"", scene)) != std::string::npos;
    };
    options_.methods = {"ray_traced"};
    int asked        = 0;
    const auto then  = [&]() -> std::vector<fs::path> {
        ++asked;
        EXPECT_TRUE(linked("lamp_over_box"));
        EXPECT_TRUE(linked("lamp_over_box-2"));
        EXPECT_TRUE(links_hold(first));
        return {};
    };
    fs::create_directories(folder_ / "other");
    fs::copy_file(scene_, folder_ / "other/lamp_over_box.json");
    Common common;
    common.quiet = true;
    compare_on_terminal({scene_, folder_ / "other/lamp_over_box.json"}, options_, common, {.then = then});
    EXPECT_EQ(asked, 1);
    EXPECT_TRUE(linked("lamp_over_box-2"));
}

TEST(ParseSize, TakesSizesOnly) {
    EXPECT_EQ(parse_size("1920x1080").width, 1920);
    EXPECT_EQ(parse_size("1920x1080").height, 1080);
    for (const char* bad :
         {"", "x", "12", "12x", "x12", "0x5", "-3x5", "12x12x12", "99999x1", "16384x16384", "1e3x10", " 4x4"})
        EXPECT_THROW((void)parse_size(bad), UsageError) << bad;
}

}  // namespace
}  // namespace umbra
