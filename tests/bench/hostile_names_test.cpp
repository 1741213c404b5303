// Names from scene files are data: they name files and channels that exist and are distinct, and text on pages.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "umbra/bench/compare/compare.h"
#include "umbra/bench/gate/diff_set.h"
#include "umbra/bench/report/report.h"
#include "umbra/core/base/error.h"
#include "umbra/core/image/image_io.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

const std::vector<std::string> kNames = {"lamp",
                                         "lamp",
                                         "Lamp",
                                         "LAMP",
                                         "",
                                         "..",
                                         ".",
                                         "a/b",
                                         "a\\b",
                                         "a.b",
                                         "con",
                                         "AUX",
                                         "../../etc/passwd",
                                         "<script>alert(1)</script>",
                                         "\"'&<>",
                                         "{{{x}}} {{#y}}",
                                         "%41%00%s%n",
                                         "new\nline",
                                         "tab\tand\x1b[31mcolour",
                                         "größe ☂",
                                         "lamp_2",
                                         "S.lamp",
                                         std::string(5000, 'x'),
                                         std::string(4999, 'x') + "y"};

/// A scene whose lights and objects all have these names, as a JSON file.
std::string scene_text(const std::vector<std::string>& names, const std::string& title = "<i>title</i> & {{x}}") {
    nlohmann::json scene = {{"title", title},
                            {"shows", "</p><script>alert(2)</script>"},
                            {"size", {16, 9}},
                            {"camera", {{"eye", {3, 4, 6}}, {"target", {0, 0, 0}}}}};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const double x = 0.1 * double(i);
        scene["lights"].push_back({{"type", "point"}, {"name", names[i]}, {"position", {x, 4, 0}}});
        scene["objects"].push_back({{"type", "box"},
                                    {"name", names[i]},
                                    {"size", {0.2, 0.2, 0.2}},
                                    {"transform", {{{"translate", {x - 1, 0.5, 0}}}}}});
    }
    scene["objects"].push_back({{"type", "plane"}, {"size", {8, 8}}});
    return scene.dump();
}

class HostileNames : public testing::Test {
protected:
    HostileNames() {
        options_.out           = folder_.path() / "out";
        options_.methods       = {"shadow_volumes", "shadow_zbuffer:resolution=16,bias=manual"};
        options_.repeats       = {1, 0};
        options_.pixel_samples = 1;
    }
    TemporaryFolder folder_;
    CompareOptions options_;
};

TEST_F(HostileNames, OfLightsAndObjectsMakeDistinctFilesAndChannels) {
    const fs::path file   = folder_.write("names.json", scene_text(kNames));
    const ScenesDone done = compare_scenes({file}, options_);
    ASSERT_EQ(done.names, std::vector<std::string>{"names"})
        << fmt::format("{}", done.failed.empty() ? "" : done.failed[0]);
    EXPECT_TRUE(done.stopped.empty());
    const Json record = Json::parse(text_of(options_.out / "names/results.json"));
    std::set<std::string> files, lights, folded;
    for (const Json& light : record["lights"]) {
        const std::string name = light["name"];
        EXPECT_LE(name.size(), 80u);
        std::string lower = name;
        std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
        EXPECT_TRUE(folded.insert(lower).second) << name << ": two names that differ in case alone";
        lights.insert(name);
    }
    EXPECT_EQ(lights.size(), kNames.size());
    for (const Json& method : record["methods"])
        for (const auto& [light, entry] : method["files"]["lights"].items()) {
            EXPECT_TRUE(lights.contains(light));
            for (const Json& name : entry) {
                EXPECT_TRUE(files.insert(name).second) << name;
                EXPECT_TRUE(fs::is_regular_file(options_.out / "names" / name.get<std::string>())) << name;
            }
        }
    EXPECT_EQ(files.size(), 2 * 3 * kNames.size());
    std::set<std::string> known(kNames.begin(), kNames.end());
    known.insert("plane");
    for (const Json& object : record["facts"]["objects"]) EXPECT_TRUE(known.contains(object["name"])) << object["name"];

    const LoadedImage exr = read_image(options_.out / "names/reference.exr");
    for (const std::string& light : lights)
        EXPECT_EQ(std::count(exr.image.channels.begin(), exr.image.channels.end(), "S." + light), 1) << light;
    const DiffSet same = diff_set(options_.out / "names", options_.out / "names", {}, {});
    EXPECT_EQ(same.worst(), Verdict::same);
}

TEST_F(HostileNames, AreTextOnPages) {
    const fs::path file = folder_.write("names.json", scene_text(kNames));
    ASSERT_EQ(compare_scenes({file}, options_).names.size(), 1u);
    write_report({options_.out / "names"}, options_.out);
    write_report({options_.out / "names"}, folder_.path() / "again");
    for (const fs::path& page : {options_.out / "index.html", options_.out / "names/index.html",
                                 folder_.path() / "again/index.html", folder_.path() / "again/names/index.html"}) {
        const std::string html = text_of(page);
        EXPECT_EQ(html.find("<script>"), std::string::npos) << page;
        EXPECT_EQ(html.find("<i>title"), std::string::npos) << page;
        EXPECT_NE(html.find("&lt;i&gt;title&lt;/i&gt; &amp; {{x}}"), std::string::npos) << page;
        EXPECT_TRUE(links_hold(page)) << page;
    }
    EXPECT_NE(text_of(options_.out / "names/index.html").find("{{{x}}} {{#y}}"), std::string::npos)
        << "no name is a template";
}

TEST_F(HostileNames, OfScenesStayInTheOutputFolder) {
    folder_.write("results.json", R"({"schema": 1, "version": "0"})");  // as if the folder above were a result of ours
    std::vector<fs::path> files;
    const std::string text = scene_text({"lamp"});
    for (const std::string name : {".", "..", "con", "ladders", "index.html", "two words", "größe", "<b>", "new\nline",
                                   "a/x", "b/x", "c/X", "-dash", "{{title}}"})
        files.push_back(folder_.write("scenes/" + name + ".json", text));
    files.push_back(folder_.write("scenes/" + std::string(240, 'n') + ".json", text));
    files.push_back(folder_.write("scenes/\xff.json", text));
    const ScenesDone done = compare_scenes(files, options_);
    EXPECT_EQ(done.names.size(), files.size()) << (done.failed.empty() ? "" : done.failed[0]);
    std::set<std::string> there;
    for (const auto& entry : fs::directory_iterator(options_.out)) there.insert(entry.path().filename().string());
    EXPECT_EQ(there.size(), files.size());
    for (const char* name : {"x", "x-2", "X-3", "con_", "ladders_", "_", "__"})
        EXPECT_TRUE(there.contains(name)) << name;
    EXPECT_TRUE(fs::exists(folder_.path() / "scenes/two words.json")) << "nothing outside the output folder is touched";
    write_report({options_.out}, options_.out);
    EXPECT_TRUE(links_hold(options_.out / "index.html"));
    for (const std::string& name : there) EXPECT_TRUE(links_hold(options_.out / name / "index.html")) << name;
    EXPECT_THROW((void)compare_scenes({files[0], files[0]}, options_), UsageError);
}

TEST_F(HostileNames, ThatAreNotUtf8AreReplaced) {
    const fs::path file =
        folder_.write("latin.obj", "mtllib none\no gar\xe7on\nusemtl caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    options_.command      = "umbra compare caf\xe9";
    const ScenesDone done = compare_scenes({file}, options_);
    ASSERT_EQ(done.names.size(), 1u) << (done.failed.empty() ? "" : done.failed[0]);
    EXPECT_EQ(Json::parse(text_of(options_.out / "latin/results.json"))["facts"]["objects"][0]["name"], "gar\ufffdon");
    write_report({options_.out / "latin"}, options_.out);
    EXPECT_TRUE(links_hold(options_.out / "latin/index.html"));
}

TEST_F(HostileNames, DoNotActOnTheMessagesThatQuoteThem) {
    const std::string lead(59, 'x');
    const Scene scene = load_scene(
        folder_.write("names.json", scene_text({"\u202eright to left", "a\u2066b\u2069c", "two\u2028lines",
                                                "a\x1b[31m\n", "größe ☂", lead + "☂", lead + "y and more"})));
    for (const char* quoted : {"\"?right to left\"", "\"a?b?c\"", "\"two?lines\"", "\"a?[31m?\"", "\"größe ☂\""})
        EXPECT_TRUE(std::ranges::any_of(scene.warnings, [&](const auto& w) { return w.find(quoted) != w.npos; }))
            << quoted;
    for (const std::string& quoted : {"\"" + lead + "...\"", "\"" + lead + "y...\""})
        EXPECT_TRUE(std::ranges::any_of(scene.warnings, [&](const auto& w) { return w.find(quoted) != w.npos; }))
            << quoted;
}

TEST_F(HostileNames, NothingIsRightWhereNothingIsJudged) {
    const fs::path file =
        folder_.write("away.json", R"({"size": [16, 9], "camera": {"eye": [0, 1, 0], "target": [0, 2, 0.1]},
        "lights": [{"name": "lamp", "type": "point", "position": [0, 4, 0]}], "objects": [{"type": "plane", "size": [8, 8]}]})");
    ASSERT_EQ(compare_scenes({file}, options_).names.size(), 1u);
    const Json record = Json::parse(text_of(options_.out / "away/results.json"));
    for (const Json& method : record["methods"]) {
        EXPECT_TRUE(method["coverage"].is_null());
        for (const char* what : {"/false_shadow/interior", "/false_shadow/edge", "/false_light/interior",
                                 "/false_light/leak", "/mae", "/rmse", "/max", "/bias"})
            EXPECT_TRUE(method["errors"][0][Json::json_pointer(what)].is_null()) << what;
    }
    write_report({options_.out / "away"}, options_.out);
    for (const char* page : {"index.html", "away/index.html"}) {
        const std::string html = text_of(options_.out / page);
        EXPECT_NE(html.find("udged"), std::string::npos) << page;
        EXPECT_EQ(html.find("0 wrong"), std::string::npos) << page;
        EXPECT_EQ(html.find("no wrong"), std::string::npos) << page;
    }
    EXPECT_NE(text_of(options_.out / "index.html").find("data-interior=\"\""), std::string::npos);
}

}  // namespace
}  // namespace umbra
