#include "umbra/bench/report/report.h"
#include "umbra/bench/cli/ladder_command.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "umbra/bench/pages/report_chart.h"
#include "umbra/core/base/error.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string read(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write(const fs::path& file, std::string_view content) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::vector<fs::path> files_below(const fs::path& folder, const std::string& ending) {
    std::vector<fs::path> files;
    if (!fs::exists(folder)) return files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().extension() == ending) files.push_back(entry.path());
    return files;
}

std::vector<std::string> attributes(const std::string& html, const std::vector<std::string>& names) {
    std::vector<std::string> values;
    for (const std::string& name : names) {
        const std::string opening = " " + name + "=\"";
        for (auto at = html.find(opening); at != std::string::npos; at = html.find(opening, at)) {
            at += opening.size();
            values.push_back(html.substr(at, html.find('"', at) - at));
        }
    }
    return values;
}

std::string decoded(const std::string& url) {
    std::string text;
    for (std::size_t i = 0; i < url.size(); ++i) {
        if (url[i] != '%') {
            text += url[i];
            continue;
        }
        text += static_cast<char>(std::stoi(url.substr(i + 1, 2), nullptr, 16));
        i += 2;
    }
    return text;
}

json timing(double median) { return {{"median", median}, {"min", median * 0.9}, {"max", median * 1.2}, {"runs", 5}}; }

json method(const std::string& name, const std::vector<std::string>& lights) {
    json m = {{"id", name},
              {"name", name},
              {"title", "The " + name},
              {"paper", "A paper, 1978"},
              {"summary", "What it does."},
              {"text", name + ":resolution=512"},
              {"parameters", {{"resolution", "512"}}},
              {"serves", {{"how", "approximately"}, {"why", "it has texels"}}},
              {"times", {{"build_ms", timing(4)}, {"aim_ms", timing(2)}, {"visibility_ms", timing(1)}}},
              {"memory_bytes", 1 << 20},
              {"coverage", 0.99996},
              {"image", {{"rmse", 0.01}, {"psnr", 40}, {"ssim", 0.99}, {"flip", 0.02}}},
              {"files", {{"exr", name + ".exr"}, {"png", name + ".png"}, {"flip", name + ".flip.png"}}}};
    for (const std::string& light : lights) {
        m["errors"].push_back(
            {{"light", light},
             {"points", 230400},
             {"undefined", 0},
             {"on_boundary", 3},
             {"lit", 200000},
             {"umbra", 30400},
             {"penumbra", 0},
             {"false_shadow", {{"interior", 12}, {"edge", 1034}, {"acne", nullptr}}},
             {"false_light", {{"interior", 0}, {"edge", 987}, {"detachment", nullptr}, {"leak", nullptr}}},
             {"mae", 0.008},
             {"rmse", 0.09},
             {"max", 1},
             {"bias", -0.0002},
             {"edge_displacement_px", nullptr}});
        m["light_times"].push_back({{"light", light}, {"aim_ms", timing(1)}, {"visibility_ms", timing(0.5)}});
        m["files"]["lights"][light] = {{"visibility", name + ".S." + light + ".png"},
                                       {"difference", name + ".diff." + light + ".png"}};
    }
    return m;
}

/// A whole results.json as `umbra compare` writes it: two lights, two methods that serve, one that does not.
json sample(const std::string& name) {
    const std::vector<std::string> lights = {"lamp", "blue sky #2"};
    json reference_lights;
    for (const std::string& light : lights) reference_lights[light] = {{"visibility", "reference.S." + light + ".png"}};
    json unserved = {{"id", "planar_projection"},
                     {"name", "planar_projection"},
                     {"title", "Planar projection"},
                     {"serves", {{"how", "not"}, {"why", "\"blue sky\" is an area light"}}}};
    return {{"schema", 1},
            {"version", "0.1.0"},
            {"command", "umbra compare scenes/court.json -o results"},
            {"machine",
             {{"cpu", "A CPU"},
              {"cores", 2},
              {"threads", 2},
              {"memory_bytes", 1 << 30},
              {"system", "Debian"},
              {"compiler", "g++"}}},
            {"scene",
             {{"name", name},
              {"title", "The " + name},
              {"shows", "One sentence."},
              {"source", "scenes/court.json"},
              {"warnings", {"no camera: one was placed"}}}},
            {"facts",
             {{"triangles", 1234567},
              {"objects",
               {{{"name", "floor"},
                 {"triangles", 2},
                 {"vertices", 4},
                 {"boundary_edges", 4},
                 {"components", 1},
                 {"closed", false},
                 {"outward", false},
                 {"planar", true},
                 {"area", 4.0},
                 {"volume", 0}}}},
              {"planes", {{{"area", 4}}}},
              {"planar_area_share", 0.5},
              {"requires", {"point lights"}},
              {"not_required", {"transparency"}}}},
            {"size", {{"width", 640}, {"height", 360}}},
            {"lights",
             {{{"name", "lamp"}, {"kind", "point"}, {"place", "inside_view"}},
              {{"name", "blue sky #2"}, {"kind", "directional"}, {"place", "at_infinity"}}}},
            {"times", {{"load_ms", 1}, {"gbuffer_ms", 9}}},
            {"reference",
             {{"name", "ray_traced"},
              {"title", "Ray-traced"},
              {"text", "ray_traced:samples=1024"},
              {"exact", false},
              {"note", "It is sampled."},
              {"files", {{"exr", "reference.exr"}, {"png", "reference.png"}, {"lights", reference_lights}}}}},
            {"methods", {unserved, method("shadow_zbuffer", lights), method("ray_traced", lights)}}};
}

/// Every file name in a results.json: what stands below `files`, but for the names of the lights.
void each_file(const json& value, const std::function<void(const std::string&)>& visit) {
    if (value.is_string() && (value.get<std::string>().ends_with(".png") || value.get<std::string>().ends_with(".exr")))
        visit(value.get<std::string>());
    if (value.is_structured())
        for (const json& item : value) each_file(item, visit);
}

class Report : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder           = fs::temp_directory_path() /
                 ("umbra_report_test_" + std::string(test->name()) + "_" + std::to_string(::getpid()));
        fs::remove_all(folder);
        fs::create_directories(folder);
        out = folder / "results";
    }
    void TearDown() override { fs::remove_all(folder); }

    static void put(const fs::path& where, const json& results) {
        write(where / "results.json", results.dump());
        each_file(results, [&](const std::string& name) { write(where / name, "a picture"); });
    }
    void expect_refusal(const std::string& message_part) const {
        try {
            write_report({out}, out);
            ADD_FAILURE() << "not refused; expected: " << message_part;
        } catch (const InputError& error) {
            EXPECT_TRUE(contains(error.what(), message_part)) << error.what() << "\n  expected: " << message_part;
        }
        EXPECT_FALSE(fs::exists(out / "index.html"));
        EXPECT_TRUE(files_below(out, ".part").empty());
    }

    fs::path folder, out;
};

TEST_F(Report, LinksAreRelativeAndResolve) {
    put(out / "court", sample("court"));
    put(out / "a scene, 100 % odd", sample("odd"));
    write_report({out}, out);
    const auto pages = files_below(out, ".html");
    ASSERT_EQ(pages.size(), 3u);
    std::size_t checked = 0;
    for (const fs::path& page : pages) {
        for (const std::string& link : attributes(read(page), {"href", "src"})) {
            ASSERT_FALSE(link.empty()) << page;
            EXPECT_FALSE(contains(link, ":") || link.starts_with("/")) << link;
            const auto hash       = link.find('#');
            const fs::path target = hash == 0 ? page : page.parent_path() / decoded(link.substr(0, hash));
            ASSERT_TRUE(fs::is_regular_file(target)) << page << ": " << link;
            if (hash != std::string::npos) {
                EXPECT_TRUE(contains(read(target), " id=\"" + link.substr(hash + 1) + "\"")) << page << ": " << link;
            }
            ++checked;
        }
    }
    EXPECT_GT(checked, 60u);
}

TEST_F(Report, ShowsEveryPictureThatTheFileNames) {
    const json results = sample("court");
    put(out / "court", results);
    write_report({out}, out);
    std::set<std::string> shown;
    for (const std::string& link : attributes(read(out / "court/index.html"), {"href", "src"}))
        shown.insert(decoded(link));
    each_file(results, [&](const std::string& name) { EXPECT_TRUE(shown.contains(name)) << name; });
}

TEST_F(Report, IdsAreUniqueAndReferencesToThemResolve) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    for (const fs::path& page : files_below(out, ".html")) {
        const std::string html = read(page);
        std::set<std::string> ids;
        for (const std::string& id : attributes(html, {"id"})) EXPECT_TRUE(ids.insert(id).second) << page << ": " << id;
        for (const std::string& id : attributes(html, {"aria-labelledby", "aria-describedby"}))
            EXPECT_TRUE(ids.contains(id)) << page << ": " << id;
    }
}

TEST_F(Report, NamesNoHost) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    for (const char* ending : {".html", ".css", ".js"})
        for (const fs::path& file : files_below(out, ending)) {
            EXPECT_FALSE(contains(read(file), "://")) << file;
            EXPECT_FALSE(contains(read(file), "@import") || contains(read(file), "url(//")) << file;
        }
}

TEST_F(Report, EscapesWhatFilesSay) {
    const std::string hostile = "<script>alert(1)</script>\"'&";
    json results              = sample("court");
    for (const char* key : {"title", "shows", "source"}) results["scene"][key] = hostile + key;
    results["scene"]["warnings"]           = {hostile};
    results["command"]                     = hostile;
    results["machine"]["cpu"]              = hostile;
    results["reference"]["note"]           = hostile;
    results["reference"]["title"]          = hostile;
    results["facts"]["requires"]           = {hostile};
    results["facts"]["objects"][0]["name"] = hostile;
    results["lights"][0]["kind"]           = hostile;
    results["lights"].push_back({{"name", hostile}});
    for (json& m : results["methods"]) {
        for (const char* key : {"title", "paper", "summary", "text"}) m[key] = hostile;
        m["serves"]["why"] = hostile;
        m["parameters"]    = {{hostile, hostile}};
    }
    put(out / "court", results);
    write_report({out}, out, {.title = hostile});
    for (const fs::path& page : files_below(out, ".html")) {
        const std::string html = read(page);
        EXPECT_FALSE(contains(html, "<script>alert")) << page;
        EXPECT_FALSE(contains(html, "</script>\"")) << page;
        EXPECT_TRUE(contains(html, "&lt;script&gt;alert(1)&lt;/script&gt;&quot;&apos;&amp;")) << page;
    }
}

TEST_F(Report, SaysInWordsWhoDidNotServeAndWhy) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    EXPECT_TRUE(contains(read(out / "index.html"), "title=\"&quot;blue sky&quot; is an area light\">not served</a>"));
    EXPECT_TRUE(contains(read(out / "court/index.html"),
                         "<dt>Planar projection</dt><dd>&quot;blue sky&quot; is an area light</dd>"));
}

TEST_F(Report, SaysThatTheReferenceIsSampled) {
    json results = sample("court");
    put(out / "court", results);
    write_report({out}, out);
    for (const fs::path& page : files_below(out, ".html"))
        EXPECT_TRUE(contains(read(page), "sampled, <strong>not exact</strong>. It is sampled.")) << page;
    results["reference"]["exact"] = true;
    put(out / "court", results);
    write_report({out}, out);
    for (const fs::path& page : files_below(out, ".html")) EXPECT_FALSE(contains(read(page), "not exact")) << page;
}

TEST_F(Report, SumsOverLightsAndNeverAddsInteriorToEdge) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    const std::string html = read(out / "index.html");
    // Two lights: 2 (12 + 0) in the interior, 2 (1034 + 987) at the edge, MAE their mean, 4 + 2 + 1 ms; 99.996 % is not
    // all.
    EXPECT_TRUE(contains(html, " wrong\">24 <small>on 99.9 %</small></td><td>4\u202f042</td><td>0.00800</td>")) << html;
    EXPECT_TRUE(contains(html, "data-cover=\"0.99996\">7.00</td>"));
    EXPECT_TRUE(contains(html, "1\u202f234\u202f567 triangles"));
}

TEST_F(Report, ToleratesWhatIsOptional) {
    put(out / "bare", {{"schema", 1}, {"scene", {{"name", "bare_scene"}}}, {"methods", json::array()}});
    put(out / "thin", {{"schema", 1},
                       {"scene", {{"name", "thin"}, {"title", nullptr}}},
                       {"lights", {{{"name", "lamp"}}}},
                       {"methods",
                        {{{"name", "ray_traced"}, {"serves", {{"how", "exactly"}}}, {"errors", {{{"light", "lamp"}}}}},
                         {{"name", "shadow_volumes"}, {"serves", {{"how", "not"}}}}}}});
    write_report({out}, out);
    EXPECT_TRUE(contains(read(out / "bare/index.html"), "<h1>bare scene</h1>"));
    EXPECT_TRUE(contains(read(out / "thin/index.html"), "ray traced"));
}

TEST_F(Report, LeavesOutLinksToExrsThatAreGone) {
    put(out / "court", sample("court"));
    fs::remove(out / "court/ray_traced.exr");
    write_report({out}, out);
    EXPECT_FALSE(contains(read(out / "court/index.html"), "ray_traced.exr"));
    EXPECT_TRUE(contains(read(out / "court/index.html"), "shadow_zbuffer.exr"));
}

TEST_F(Report, RefusesAPlaceThatIsWrong) {
    struct Case {
        const char* place;
        json value;
        const char* message;
    };
    for (const Case& c :
         {Case{"/schema", 2, "results.json:/schema: found 2 (1, "},
          Case{"/schema", "1", "results.json:/schema: found \"1\" (a number"},
          Case{"/scene/name", nullptr, "results.json:/scene/name: found nothing (a string"},
          Case{"/scene/title", 7, "results.json:/scene/title: found 7 (a string"},
          Case{"/scene/warnings", "one", "results.json:/scene/warnings: found \"one\" (an array"},
          Case{"/methods", 1, "results.json:/methods: found 1 (an array"},
          Case{"/methods", nullptr, "results.json:/methods: found nothing (an array"},
          Case{"/methods/1/serves/how", "maybe", "results.json:/methods/1/serves/how: found \"maybe\" (\"exactly\""},
          Case{"/methods/1/errors/0/mae", "0", "results.json:/methods/1/errors/0/mae: found \"0\" (a number"},
          Case{"/methods/1/times/aim_ms", json::array(),
               "results.json:/methods/1/times/aim_ms: found an array (an object"},
          Case{"/methods/1/files/png", "gone.tiff",
               "results.json:/methods/1/files/png: found \"gone.tiff\" (a file that is there"},
          Case{"/methods/1/files/png", "../../secret",
               "results.json:/methods/1/files/png: found \"../../secret\" (a file in the same folder"},
          Case{"/methods/1/files/png", "/etc/passwd",
               "results.json:/methods/1/files/png: found \"/etc/passwd\" (a file in the same folder"},
          Case{"/methods/1/files/png", "javascript:alert(1)", "(a file that is there"},
          Case{"/size/width", 1e300, "results.json:/size/width: found 1e+300"}}) {
        json results = sample("court");
        put(out / "court", results);
        results[json::json_pointer(c.place)] = c.value;
        write(out / "court/results.json", results.dump());
        expect_refusal(c.message);
    }
}

TEST_F(Report, RefusesWhatIsNotJsonWithLineAndColumn) {
    for (const auto& [text, message] : {std::pair{"{\n  \"schema\": 1,\n  \"scene\": }", "results.json:3:12: not JSON"},
                                        {"", "results.json:1:1: not JSON"},
                                        {"{\"schema\": 1", "not JSON, or cut off here"},
                                        {"{\"schema\": 1e999}", "a number is out of range"},
                                        {"[1]", "found an array (an object"},
                                        {"\xff\xfe", "results.json:1:1: not JSON"}}) {
        write(out / "court/results.json", text);
        expect_refusal(message);
    }
}

TEST_F(Report, RefusesFoldersWithoutResults) {
    expect_refusal("No such file or directory");
    fs::create_directories(out / "empty");
    expect_refusal("holds no results.json");
    EXPECT_THROW(write_report({}, out), UsageError);
}

TEST_F(Report, ARefusedRunLeavesTheOldPages) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    const std::string before = read(out / "index.html");
    put(out / "aaa", sample("aaa"));
    json last                  = sample("zzz");
    last["facts"]["triangles"] = 2e9;  // the last to be looked at: the other pages are written beside already
    put(out / "zzz", last);
    fs::remove(out / "zzz/reference.png");
    EXPECT_THROW(write_report({out}, out), InputError);
    EXPECT_EQ(read(out / "index.html"), before);
    EXPECT_FALSE(fs::exists(out / "aaa/index.html"));
    EXPECT_TRUE(files_below(out, ".part").empty());
}

TEST_F(Report, WritesTheSameBytesAgain) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    const std::string index = read(out / "index.html"), page = read(out / "court/index.html");
    write_report({out}, out);
    EXPECT_EQ(read(out / "index.html"), index);
    EXPECT_EQ(read(out / "court/index.html"), page);
}

TEST_F(Report, GathersOtherFoldersSoThatOneCanBeHandedOut) {
    put(folder / "monday/court", sample("court"));
    put(folder / "tuesday", sample("court"));  // a single scene, its results.json at the top
    write_report({folder / "monday", folder / "tuesday", folder / "monday"}, out);
    fs::remove_all(folder / "monday");
    fs::remove_all(folder / "tuesday");
    EXPECT_EQ(files_below(out, ".html").size(), 3u);
    for (const char* scene : {"court", "court-2"}) {
        EXPECT_TRUE(fs::exists(out / scene / "index.html"));
        EXPECT_TRUE(fs::exists(out / scene / "results.json"));
        for (const std::string& link : attributes(read(out / scene / "index.html"), {"href", "src"}))
            if (!link.starts_with("#")) {
                EXPECT_TRUE(fs::exists(out / scene / decoded(link))) << link;
            }
    }
}

TEST_F(Report, SaysWhereMethodsBreakIfLaddersWereClimbed) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    EXPECT_FALSE(contains(read(out / "index.html"), "id=\"stability\""));

    LadderOptions options;
    options.names   = {"needles", "shininess"};
    options.methods = {"shadow_zbuffer"};
    options.out     = folder / "climbed";
    climb_ladders(options);
    for (const bool inside : {false, true}) {
        // Elsewhere it is gathered into the report; in the report's own folder it is no scene.
        if (inside) fs::rename(folder / "climbed", out / "climbed");
        write_report(inside ? std::vector{out} : std::vector{out, folder / "climbed"}, out);
        const std::string index = read(out / "index.html");
        const std::string page  = inside ? "climbed/" : "ladders/";
        EXPECT_TRUE(contains(index, "href=\"" + page + "index.html#needles\""));
        EXPECT_TRUE(contains(index, "src=\"" + page + "breaks/needles.shadow_zbuffer.classes.png\""))
            << "a telling break";
        EXPECT_TRUE(contains(index, "The sum"));
        for (const char* file : {"index.html", "results.json", "report.css", "breaks/needles.shadow_zbuffer.json",
                                 "breaks/needles.shadow_zbuffer.truth.png"})
            EXPECT_TRUE(fs::is_regular_file(out / page / file)) << page << file;
        if (!inside) fs::remove_all(out / "ladders");
    }
}

TEST_F(Report, CountsAFolderOfOneSceneOnce) {
    put(out / "court", sample("court"));
    write(out / "results.json", sample("court").dump());  // the copy that a run of one scene leaves beside
    write_report({out}, out);
    EXPECT_EQ(files_below(out, ".html").size(), 2u);
}

TEST_F(Report, DoesNotHoldTheReferenceAgainstItself) {
    json results                 = sample("court");
    results["reference"]["text"] = results["methods"][2]["text"];  // ray_traced:resolution=512
    put(out / "court", results);
    write_report({out}, out);
    EXPECT_TRUE(contains(read(out / "index.html"), "colspan=\"3\">the reference</td><td class=\"ms\""));
    const std::string page = read(out / "court/index.html");
    EXPECT_FALSE(contains(page, "ray_traced.diff.lamp.png") || contains(page, "ray_traced.flip.png"));
    EXPECT_TRUE(contains(page, "shadow_zbuffer.diff.lamp.png"));
    EXPECT_TRUE(contains(page, "The ray_traced (the reference)"));
}

TEST_F(Report, RunsOfOneMethodAreToldApartByTheirSettings) {
    json results   = sample("court");
    json second    = results["methods"][1];
    second["id"]   = "shadow_zbuffer-2";
    second["text"] = "shadow_zbuffer:resolution=2048";
    results["methods"].push_back(second);
    put(out / "court", results);
    write_report({out}, out);
    for (const fs::path& page : files_below(out, ".html"))
        for (const char* label : {"The shadow_zbuffer (resolution=512)", "The shadow_zbuffer (resolution=2048)"})
            EXPECT_TRUE(contains(read(page), label)) << page << ": " << label;
}

TEST(ErrorTimeChart, PlacesZeroErrorsOnTheirOwnLineAndSurvivesOddNumbers) {
    const json chart =
        error_time_chart({{"exact", 1, 10, 0, 0}, {"coarse", 0, 0, 1e-300, 1}, {"slow", 1e12, 1e13, 1, 2}});
    EXPECT_EQ(chart["marks"][0]["y"], "278.0");
    EXPECT_LE(chart["x_ticks"].size(), 8u);
    EXPECT_LE(chart["y_ticks"].size(), 8u);
    for (const json& mark : chart["marks"])
        for (const char* key : {"x", "camera_x", "y", "label_x", "label_y"}) {
            const double at = std::stod(mark[key].get<std::string>());
            EXPECT_TRUE(std::isfinite(at) && at >= 0 && at <= 440) << key << " " << at;
        }
}

TEST(ErrorTimeChart, SlowerIsRightAndWorseIsUp) {
    const json chart = error_time_chart({{"a", 1, 10, 0.001, 0}, {"b", 20, 200, 0.1, 1}});
    const auto at    = [&](int i, const char* key) { return std::stod(chart["marks"][i][key].get<std::string>()); };
    EXPECT_LT(at(0, "camera_x"), at(0, "x"));
    EXPECT_LT(at(0, "x"), at(1, "x"));
    EXPECT_GT(at(0, "y"), at(1, "y"));
}

TEST(ErrorTimeChart, LabelsOfEqualMarksDoNotCoverOneAnother) {
    const json chart = error_time_chart(
        {{"planar projection", 1, 2, 0, 0}, {"shadow volumes", 1, 2, 0, 1}, {"ray-traced", 1, 2, 0, 2}});
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < i; ++k) {
            const json &a = chart["marks"][i], &b = chart["marks"][k];
            const auto value = [](const json& m, const char* key) { return std::stod(m[key].get<std::string>()); };
            EXPECT_TRUE(std::abs(value(a, "label_y") - value(b, "label_y")) >= 13 ||
                        std::abs(value(a, "label_x") - value(b, "label_x")) >= 60)
                << a << b;
        }
}

}  // namespace
}  // namespace umbra
