#include <algorithm>
#include <set>

#include "report_fixture.h"
#include "umbra/bench/cli/ladder_command.h"
#include "umbra/core/image/image_io.h"
#include "umbra/tests/support/html_table.h"

namespace umbra {
namespace {

using namespace report_fixture;

/// 640 x 360, lit and correct except for one leak.
Image class_picture() {
    Image image(640, 360, {"R", "G", "B"});
    std::fill(image.data.begin(), image.data.end(), 0xf2 / 255.0f);
    for (std::size_t c = 0; c < 3; ++c) image.at(1000, c) = c == 0 ? 0xc4 / 255.0f : 0;
    return image;
}

TEST_F(Report, LinksAreRelativeAndResolve) {
    put(out / "court", sample("court"));
    put(out / "a scene, 100 % odd", sample("odd"));
    write_report({out}, out);
    const auto pages = files_below(out, ".html");
    ASSERT_EQ(pages.size(), 3u);
    std::size_t checked = 0;
    for (const fs::path& page : pages) {
        for (const std::string& link : links(read(page))) {
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
    for (const std::string& link : links(read(out / "court/index.html"))) shown.insert(decoded(link));
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

TEST_F(Report, SaysHowFarARunThatGoesOnHasCome) {
    put(out / "court", sample("court"));
    write_report({out}, out, {.so_far = "1 of 2 scenes"});
    EXPECT_TRUE(contains(read(out / "index.html"), ">Written while the run went on, with 1 of 2 scenes. Load"));
    write_report({out}, out);
    EXPECT_FALSE(contains(read(out / "index.html"), "while the run went on"));
}

TEST_F(Report, SaysThatTheReferenceIsSampled) {
    json results = sample("court");
    put(out / "court", results);
    write_report({out}, out);
    for (const fs::path& page : files_below(out, ".html"))
        EXPECT_TRUE(contains(read(page), "<strong>not exact</strong>. It is sampled.")) << page;
    EXPECT_TRUE(contains(read(out / "court/index.html"), "compared with the inexact reference"));
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
    EXPECT_TRUE(contains(html, " wrong\">24 <small>on &gt; 99.9 %</small></td><td>4\u202f042</td><td>0.00800</td>"))
        << html;
    EXPECT_TRUE(contains(html, "data-cover=\"0.99996\" data-interior=\"24\">7.00</td>"));
    EXPECT_TRUE(contains(html, "1\u202f234\u202f567 triangles"));
}

/// A script of values is handed out where it is a call with JSON alone: what a record names might be anybody's.
TEST_F(Report, HandsOutNoScriptButValues) {
    json record      = sample("court");
    record["values"] = "values.js";
    put(out / "from" / "court", record);
    const auto reported = [&](const std::string& script) {
        write(out / "from" / "court" / "values.js", script);
        write_report({out / "from"}, out / "to");
        return read(out / "to" / "court" / "values.js");
    };
    EXPECT_EQ(reported("umbraValues({\"schema\": 1});\n"), "umbraValues({\"schema\":1});\n");
    EXPECT_EQ(reported("umbraValues({\"a\":\"</script>\\u00e4\"});\n"), "umbraValues({\"a\":\"</script>\\u00e4\"});\n");
    for (const char* foreign : {"alert(1);\n", "umbraValues({});alert(1);\n", "umbraValues(alert(1));\n",
                                "umbraValues({}", "umbraValues([1]);\n", "umbraValues(1);\n", ""})
        EXPECT_THROW((void)reported(foreign), InputError) << foreign;
    EXPECT_EQ(read(out / "to" / "court" / "values.js"), "umbraValues({\"a\":\"</script>\\u00e4\"});\n")
        << "and keeps what was there";
}

/// A setting has its figures under its own name, also where it is the only one of its method.
TEST_F(Report, CallsASettingByItsSettings) {
    json record                  = sample("court");
    record["methods"][2]["text"] = "ray_traced:samples=4";
    put(out / "court", record);
    write_report({out}, out);
    for (const char* page : {"index.html", "court/index.html"}) {
        EXPECT_TRUE(contains(read(out / page), "The ray_traced (samples=4)")) << page;
        EXPECT_FALSE(contains(read(out / page), "The ray_traced<")) << page;
    }
}

TEST_F(Report, BeginsWithTheSceneAndTheMethodThatAreMostWrong) {
    json mild = sample("mild"), grave = sample("grave");
    // Two lights: 2 (12 + 0) wrong points; the second method of the second scene has 4 more.
    grave["methods"][2]["errors"][1]["false_light"] = {{"interior", 4}, {"edge", 0}, {"leak", 3}};
    for (const char* light : {"lamp", "blue sky #2"})
        grave["methods"][2]["files"]["lights"][light]["classes"] = std::string("ray_traced.classes.") + light + ".png";
    put(out / "a", mild);
    put(out / "z", grave);
    const auto picture = class_picture();
    for (const char* light : {"lamp", "blue sky #2"})
        write_image(out / "z" / (std::string("ray_traced.classes.") + light + ".png"), picture);
    write_report({out}, out);
    const std::string index = read(out / "index.html");
    const std::string front = index.substr(0, index.find("id=\"about\""));
    EXPECT_TRUE(contains(
        front,
        "<a href=\"z/index.html\"><b>The grave</b></a>: left the shadows of “The ray_traced”, right those of the "
        "reference. Away from shadow edges, 28 of 460\u202f800 points are wrong on the left. Most often: lit points in "
        "the shadow of another surface.</p>"))
        << front;
    // The slider's pair, and the class picture of the light with the most wrong points.
    EXPECT_TRUE(contains(front, "<div class=\"half right\"><img src=\"z/reference.png\""));
    EXPECT_TRUE(contains(front, "<div class=\"half left\"><img src=\"z/ray_traced.png\""));
    EXPECT_TRUE(contains(front, "src=\"z/ray_traced.classes.blue%20sky%20%232.png\""));
    EXPECT_FALSE(contains(front, "ray_traced.classes.lamp.png"));
    EXPECT_TRUE(contains(front, "1 ring around a small group of wrong interior points."));
    // Its legend has the one class of the picture.
    EXPECT_TRUE(contains(front, "false light: leak"));
    EXPECT_FALSE(contains(front, "false shadow: acne"));
    // A scene's page begins with its own pair.
    const std::string page = read(out / "z/index.html");
    EXPECT_TRUE(contains(page, "<div class=\"half left\"><img src=\"ray_traced.png\""));
    EXPECT_TRUE(contains(page, "Rings mark groups"));
    EXPECT_TRUE(contains(read(out / "a/index.html"), "<div class=\"half left\"><img src=\"shadow_zbuffer.png\""));
    EXPECT_FALSE(contains(read(out / "a/index.html"), "Rings mark groups"));
}

TEST_F(Report, ASceneWithoutErrorsSaysSo) {
    json results = sample("court");
    for (json& m : results["methods"])
        if (m.contains("errors"))
            for (json& error : m["errors"]) error["false_shadow"]["interior"] = 0;
    results["reference"]["exact"] = true;
    put(out / "court", results);
    write_report({out}, out);
    EXPECT_TRUE(contains(read(out / "court/index.html"),
                         "All 2 methods: no wrong interior point against the exact reference, where they answer."));
    EXPECT_TRUE(contains(read(out / "index.html"), "Away from shadow edges, all of 460\u202f800 points are right."));
}

TEST_F(Report, RefusesAClassPictureThatIsNone) {
    json results                                                = sample("court");
    results["methods"][1]["files"]["lights"]["lamp"]["classes"] = "classes.png";
    put(out / "court", results);
    expect_refusal("classes.png");
}

TEST_F(Report, NamesNoFolderOfTheMachine) {
    json results               = sample("court");
    results["command"]         = "umbra compare /home/ann/court.json -o /srv/out";
    results["scene"]["source"] = "/home/ann/court.json";
    put(out / "court", results);
    write_report({out}, out);
    for (const fs::path& page : files_below(out, ".html")) {
        EXPECT_FALSE(contains(read(page), "/home/ann") || contains(read(page), "/srv")) << page;
        EXPECT_TRUE(contains(read(page), "umbra compare court.json -o out")) << page;
    }
}

TEST_F(Report, WhatNeedsAScriptIsHiddenUntilItRuns) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    const std::string page = read(out / "court/index.html");
    EXPECT_TRUE(contains(page, "<li class=\"screen\" hidden><a href=\"#compare\">"));
    EXPECT_TRUE(contains(
        page,
        "<section id=\"compare\" data-src=\"values.js\" class=\"screen\" aria-labelledby=\"compare-title\" hidden>"));
    EXPECT_TRUE(contains(read(out / "index.html"), "<form class=\"finder\" hidden>"));
    // Every script that a page names is there.
    std::size_t scripts = 0;
    for (const fs::path& file : files_below(out, ".html"))
        for (const std::string& src : attributes(read(file), {"src"}))
            if (src.ends_with(".js")) {
                EXPECT_TRUE(fs::is_regular_file(file.parent_path() / src)) << src;
                ++scripts;
            }
    EXPECT_EQ(scripts, 6u);
}

TEST_F(Report, AClassThatIsCountedGetsItsColumn) {
    json results = sample("court");
    put(out / "court", results);
    write_report({out}, out);
    EXPECT_FALSE(contains(read(out / "court/index.html"), "<th scope=\"col\">Acne</th>"));
    results["methods"][1]["errors"][0]["false_shadow"]["acne"] = 5;
    put(out / "court", results);
    write_report({out}, out);
    const std::string page = read(out / "court/index.html");
    EXPECT_TRUE(contains(page,
                         "<th colspan=\"3\" scope=\"colgroup\"><span class=\"key\" style=\"background: "
                         "#0072b2\"></span>False shadow</th>"));
    EXPECT_TRUE(contains(page, "<th scope=\"col\">Acne</th>"));
    EXPECT_TRUE(contains(page, "<td class=\"wrong\">12</td><td>1\u202f034</td><td>5</td><td>0</td><td>987</td>"));
}

/// Points that no method is asked for, since their objects receive no shadows: a column where there are some.
TEST_F(Report, PointsOfObjectsWithoutShadowsAreCountedApart) {
    json results = sample("court");
    put(out / "court", results);
    write_report({out}, out);
    const std::string column = "Unshadowed", none = read(out / "court/index.html");
    EXPECT_FALSE(contains(none, column));
    EXPECT_TRUE(contains(none, "<tr class=\"group\"><th colspan=\"9\" scope=\"rowgroup\">lamp</th></tr>"));
    results["methods"][1]["errors"][0]["unshadowed"] = 2345;
    put(out / "court", results);
    write_report({out}, out);
    const std::string page = read(out / "court/index.html");
    const other_readers::HtmlTable table(page, "regions-caption");
    const std::string method = results["methods"][1]["title"], other = results["methods"][2]["title"];
    EXPECT_EQ(table.at("lamp / " + method, column), "2\u202f345");
    EXPECT_EQ(table.at("lamp / " + other, column), "0");
    EXPECT_EQ(table.at("blue sky #2 / " + method, column), "0");
    EXPECT_TRUE(contains(page, "<tr class=\"group\"><th colspan=\"10\" scope=\"rowgroup\">lamp</th></tr>"));
}

TEST_F(Report, PenumbraAndNoiseAreNoOtherFalseShadow) {
    json results = sample("court");
    for (const std::size_t method : {1, 2})
        for (json& error : results["methods"][method]["errors"]) {
            error["penumbra_error"] = {{"false_shadow", 9}, {"false_light", 0}};
            error["noise_error"]    = {{"false_shadow", 2}, {"false_light", 0}};
        }
    put(out / "court", results);
    write_report({out}, out);
    EXPECT_TRUE(contains(read(out / "court/index.html"), "(2 false shadow, 18 in penumbrae, 4 by noise)"));
    EXPECT_TRUE(contains(read(out / "index.html"), "Most often: a penumbra, which is missing or noisy on the left."));
}

TEST_F(Report, WritesTheSameBytesAgain) {
    put(out / "court", sample("court"));
    write_report({out}, out);
    const std::string index = read(out / "index.html"), page = read(out / "court/index.html");
    write_report({out}, out);
    EXPECT_EQ(read(out / "index.html"), index);
    EXPECT_EQ(read(out / "court/index.html"), page);
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
        EXPECT_TRUE(contains(read(out / page / "index.html"), "<a href=\"../index.html\">Report</a>"));
        for (const char* file : {"index.html", "results.json", "report.css", "breaks/needles.shadow_zbuffer.json",
                                 "breaks/needles.shadow_zbuffer.truth.png"})
            EXPECT_TRUE(fs::is_regular_file(out / page / file)) << page << file;
        if (!inside) fs::remove_all(out / "ladders");
    }
}

/// What one record calls shadow_zbuffer another calls shadow_zbuffer-2, by the order of its command line.
TEST_F(Report, AColumnIsOneSettingWhateverRecordsCallIt) {
    json court = sample("court"), yard = sample("yard");
    json& by_default   = court["methods"][1];
    by_default["text"] = "shadow_zbuffer";
    json small         = by_default;
    small["id"] = "shadow_zbuffer-2", small["text"] = "shadow_zbuffer:resolution=64";
    court["methods"].push_back(small);
    json& only   = yard["methods"][1];
    only["text"] = "shadow_zbuffer:resolution=64";
    for (json& error : only["errors"]) error["false_shadow"]["interior"] = 444;
    put(out / "court", court);
    put(out / "yard", yard);
    write_report({out}, out);
    const std::string index = read(out / "index.html");
    EXPECT_TRUE(contains(index, ">The shadow_zbuffer</a></th>"));
    EXPECT_TRUE(contains(index, ">The shadow_zbuffer (resolution=64)</a></th>"));
    EXPECT_TRUE(contains(index, "<code>shadow_zbuffer:resolution=64</code>"));
    // Columns: rays and the small map, which answer on both scenes, the default map, planar projection.
    const auto begin      = index.find("The yard</a></th>");
    const std::string row = index.substr(begin, index.find("</tr>", begin) - begin);
    const auto not_run = row.find("not run"), figure = row.find(">888"), rays = row.find("<td class=\"ms\"");
    ASSERT_NE(not_run, std::string::npos) << row;
    ASSERT_NE(figure, std::string::npos) << row;
    EXPECT_EQ(row.find("not run", not_run + 1), std::string::npos) << row;
    EXPECT_LT(rays, figure) << row;
    EXPECT_LT(figure, not_run) << row;
}

/// Who answers on all scenes is seen first, whoever stands first in a record.
TEST_F(Report, MethodsThatAnswerOnMoreScenesStandFirst) {
    const json court = sample("court");  // planar_projection, which does not serve it, shadow_zbuffer, ray_traced
    json yard        = sample("yard");
    yard["methods"].erase(1);
    put(out / "court", court);
    put(out / "yard", yard);
    write_report({out}, out);
    const std::string index = read(out / "index.html");
    const auto column       = [&](const std::string& label) { return index.find(">" + label + "</a></th>"); };
    ASSERT_NE(column("Planar projection"), std::string::npos);
    EXPECT_LT(column("The ray_traced"), column("The shadow_zbuffer")) << "two scenes, one";
    EXPECT_LT(column("The shadow_zbuffer"), column("Planar projection")) << "one scene, none";
    EXPECT_LT(index.find("<dt>The ray_traced <code>"), index.find("<dt>The shadow_zbuffer <code>"));
}

/// Two versions of a program may mean other settings by one text.
TEST_F(Report, SettingsDifferInWhatTheirTextLeavesOut) {
    json court = sample("court"), yard = sample("yard");
    for (json* scene : {&court, &yard}) (*scene)["methods"][1]["text"] = "shadow_zbuffer";
    yard["methods"][1]["parameters"]["resolution"] = "1024";
    yard["methods"][2]["parameters"]["new"]        = "1";  // which the other record does not know
    put(out / "court", court);
    put(out / "yard", yard);
    write_report({out}, out);
    const std::string index = read(out / "index.html");
    for (const char* label :
         {">The shadow_zbuffer (resolution=512)<", ">The shadow_zbuffer (resolution=1024)<", ">The ray_traced<"})
        EXPECT_TRUE(contains(index, label)) << label;
}

TEST_F(Report, KeepsEveryRunOfLadders) {
    put(out / "court", sample("court"));
    LadderOptions options;
    options.names   = {"shininess"};
    options.methods = {"shadow_zbuffer"};
    options.out     = folder / "first";
    climb_ladders(options);
    fs::copy(folder / "first", folder / "second", fs::copy_options::recursive);
    json second                   = json::parse(read(folder / "second/results.json"));
    second["ladders"][0]["title"] = "Another run";
    write(folder / "second/results.json", second.dump(1));
    for (int again = 0; again < 2; ++again) {  // the second time the report's folder holds copies of both
        write_report({out, folder / "first", folder / "second"}, out);
        const std::string index = read(out / "index.html");
        for (const char* part : {"id=\"stability\"", "id=\"stability-2\"", "href=\"ladders/index.html#shininess\"",
                                 "href=\"ladders-2/index.html#shininess\"", "Another run", ">Stability 1</a>",
                                 "Stability 2: where each method breaks"})
            EXPECT_TRUE(contains(index, part)) << part;
        EXPECT_FALSE(contains(index, "id=\"stability-3\""));
        EXPECT_TRUE(contains(read(out / "ladders-2/index.html"), "Another run"));
        EXPECT_FALSE(contains(read(out / "ladders/index.html"), "Another run"));
        std::set<std::string> ids;
        for (const std::string& id : attributes(index, {"id"})) EXPECT_TRUE(ids.insert(id).second) << id;
    }
}

TEST_F(Report, DoesNotCompareTheReferenceWithItself) {
    json results                 = sample("court");
    results["reference"]["text"] = results["methods"][2]["text"];
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
        for (const char* label : {">The shadow_zbuffer<", "The shadow_zbuffer (resolution=2048)"})
            EXPECT_TRUE(contains(read(page), label)) << page << ": " << label;
}

}  // namespace
}  // namespace umbra
