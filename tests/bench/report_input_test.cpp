// What the report makes of results.json files that lack parts, say something wrong or lie elsewhere.
#include "report_fixture.h"

namespace umbra {
namespace {

using namespace report_fixture;

TEST_F(Report, ToleratesWhatIsOptional) {
    put(out / "bare", {{"schema", kResultsSchema}, {"scene", {{"name", "bare_scene"}}}, {"methods", json::array()}});
    put(out / "thin", {{"schema", kResultsSchema},
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
         {Case{"/schema", 1, "results.json:/schema: found 1, expected 2, "},
          Case{"/schema", "1", "results.json:/schema: found \"1\", expected a number"},
          Case{"/scene/name", nullptr, "results.json:/scene/name: found nothing, expected a non-empty string"},
          Case{"/scene/title", 7, "results.json:/scene/title: found 7, expected a string"},
          Case{"/scene/warnings", "one", "results.json:/scene/warnings: found \"one\", expected an array"},
          Case{"/methods", 1, "results.json:/methods: found 1, expected an array"},
          Case{"/methods", nullptr, "results.json:/methods: found nothing, expected an array"},
          Case{"/methods/1/serves/how", "maybe",
               "results.json:/methods/1/serves/how: found \"maybe\", expected \"exactly\""},
          Case{"/methods/1/errors/0/mae", "0", "results.json:/methods/1/errors/0/mae: found \"0\", expected a number"},
          Case{"/methods/1/times/aim_ms", json::array(),
               "results.json:/methods/1/times/aim_ms: found an array, expected an object"},
          Case{"/methods/1/files/png", "gone.tiff",
               "results.json:/methods/1/files/png: found \"gone.tiff\", expected an existing file"},
          Case{"/methods/1/files/png", "../../secret",
               "results.json:/methods/1/files/png: found \"../../secret\", expected a file in the same folder"},
          Case{"/methods/1/files/png", "/etc/passwd",
               "results.json:/methods/1/files/png: found \"/etc/passwd\", expected a file in the same folder"},
          Case{"/methods/1/files/png", "javascript:alert(1)", ", expected an existing file"},
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
                                        {"[1]", "found an array, expected an object"},
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
        for (const std::string& link : links(read(out / scene / "index.html")))
            if (!link.starts_with("#")) {
                EXPECT_TRUE(fs::exists(out / scene / decoded(link))) << link;
            }
    }
}

TEST_F(Report, CountsAFolderOfOneSceneOnce) {
    put(out / "court", sample("court"));
    write(out / "results.json", sample("court").dump());  // the copy that a run of one scene leaves beside
    write_report({out}, out);
    EXPECT_EQ(files_below(out, ".html").size(), 2u);
}

}  // namespace
}  // namespace umbra
