// The report shows every figure of results.json where its headings say: a record whose figures are all different, and
// tables, charts, captions and links read back from the pages.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "report_fixture.h"
#include "umbra/bench/pages/error_palette.h"
#include "umbra/bench/pages/report_chart.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/core/image/image_io.h"
#include "umbra/tests/support/html_table.h"

namespace umbra {
namespace {

using namespace report_fixture;
using other_readers::HtmlTable;

json milliseconds_of(double median, double min, double max) {
    return {{"median", median}, {"min", min}, {"max", max}, {"runs", 3}};
}

/// Two lights and three methods as in `sample`, but no figure occurs twice.
json distinct(const std::string& name) {
    json results     = sample(name);
    results["size"]  = {{"width", 640}, {"height", 360}};
    results["times"] = {{"load_ms", 11}, {"facts_ms", 12}, {"rays_build_ms", 13}, {"gbuffer_ms", 14}, {"shade_ms", 15}};
    results["machine"]["memory_bytes"] = std::int64_t{50} << 30;
    results["reference"]["judged"]     = {{"points", 1234}, {"of", 5678}, {"guess", "ray_traced:samples=256"}};
    results["facts"]["objects"][0]     = {{"name", "ring"},   {"triangles", 21}, {"vertices", 22},
                                          {"components", 23}, {"closed", true},  {"outward", true},
                                          {"planar", false},  {"area", 2.4},     {"volume", 0.25}};
    results["facts"]["extent"]         = {{"min", {-1, 2, 5}}, {"max", {2, 6, 17}}};
    int n                              = 100;
    for (std::size_t m = 1; m < 3; ++m) {
        json& method           = results["methods"][m];
        const double k         = double(m);
        method["times"]        = {{"build_ms", milliseconds_of(40 + k, 30 + k, 50 + k)},
                                  {"aim_ms", milliseconds_of(20 + k, 10 + k, 25 + k)},
                                  {"look_ms", milliseconds_of(8.3 + k, 7.3 + k, 9.4 + k)},
                                  {"visibility_ms", milliseconds_of(4 + k, 2 + k, 6 + k)}};
        method["memory_bytes"] = (m + 6) << 20;
        method["coverage"]     = 0.875;
        method["parameters"]   = {{"resolution", 512}};
        method["image"] = {{"rmse", 0.0123}, {"psnr", 31.5}, {"ssim", 0.9321}, {"flip", 0.0456}, {"flip_hdr", 0.077}};
        method["light_times"] = {{{"light", "lamp"},
                                  {"aim_ms", milliseconds_of(7.1, 7.1, 7.1)},
                                  {"visibility_ms", milliseconds_of(1.3, 1.3, 1.3)}},
                                 {{"light", "blue sky #2"},
                                  {"aim_ms", milliseconds_of(5.7, 5.7, 5.7)},
                                  {"visibility_ms", milliseconds_of(2.9, 2.9, 2.9)}}};
        for (json& e : method["errors"]) {
            const auto next = [&] { return ++n; };
            e["points"] = next(), e["lit"] = next(), e["umbra"] = next(), e["penumbra"] = next();
            e["undefined"] = next(), e["on_boundary"] = next(), e["away"] = next(), e["not_judged"] = next();
            e["false_shadow"] = {{"interior", next()}, {"edge", next()}, {"acne", next()}};
            e["false_light"]  = {{"interior", next()}, {"edge", next()}, {"detachment", next()}, {"leak", next()}};
            e["interior"]     = {{"lit", next()}, {"umbra", next()}, {"penumbra", next()}};
            e["terminator"]   = {{"facet_away", next()}, {"normal_away", next()}, {"wrong", next()}};
            e["mae"] = 0.001 * next(), e["rmse"] = 0.001 * next(), e["max"] = 0.001 * next(),
            e["bias"]                 = -0.001 * next();
            e["edge_displacement_px"] = {{"mean", 0.01 * next()},
                                         {"p95", 0.01 * next()},
                                         {"max", 0.01 * next()},
                                         {"pieces", 9},
                                         {"unmatched", 0}};
            e["penumbra_width_px"]    = {{"method", 0.1 * next()}, {"reference", 0.1 * next()}};
            e["noise"]                = {{"runs", 8}, {"noise_rmse", 0.0001 * next()}, {"bias_rmse", 0.0001 * next()}};
            e["bracket"]              = {{"max_half_width", 0.00001 * next()}};
        }
    }
    return results;
}

std::string fixed(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

class PageFigures : public Report {
protected:
    void SetUp() override {
        Report::SetUp();
        results = distinct("court");
        put(out / "court", results);
        write_report({out}, out);
        page  = read(out / "court/index.html");
        index = read(out / "index.html");
    }
    /// Figure of an error, as JSON pointer.
    [[nodiscard]] double figure(std::size_t method, std::size_t light, const std::string& pointer) const {
        return results["methods"][method]["errors"][light].at(json::json_pointer(pointer)).get<double>();
    }
    json results;
    std::string page, index;
};

TEST_F(PageFigures, TablesOfErrors) {
    const HtmlTable errors(page, "errors-caption"), causes(page, "causes-caption"), regions(page, "regions-caption");
    struct Place {
        const HtmlTable* table;
        std::string column, pointer;
        int digits;
    };
    const std::vector<Place> places = {
        {&errors, "False shadow / Interior", "/false_shadow/interior", 0},
        {&errors, "False shadow / Edge band", "/false_shadow/edge", 0},
        {&errors, "False shadow / Acne", "/false_shadow/acne", 0},
        {&errors, "False light / Interior", "/false_light/interior", 0},
        {&errors, "False light / Edge band", "/false_light/edge", 0},
        {&errors, "False light / Detachment", "/false_light/detachment", 0},
        {&errors, "False light / Leak", "/false_light/leak", 0},
        {&errors, "MAE", "/mae", 3},
        {&errors, "RMSE", "/rmse", 3},
        {&errors, "Max", "/max", 3},
        {&errors, "Points", "/points", 0},
        {&causes, "Wrong in the interior, points / Lit", "/interior/lit", 0},
        {&causes, "Wrong in the interior, points / Umbra", "/interior/umbra", 0},
        {&causes, "Wrong in the interior, points / Penumbra", "/interior/penumbra", 0},
        {&causes, "At the terminator, points / Triangle away", "/terminator/facet_away", 0},
        {&causes, "At the terminator, points / Normal away", "/terminator/normal_away", 0},
        {&causes, "At the terminator, points / Wrong", "/terminator/wrong", 0},
        {&causes, "Edge displacement, pixels / Mean", "/edge_displacement_px/mean", 2},
        {&causes, "Edge displacement, pixels / 95 %", "/edge_displacement_px/p95", 2},
        {&causes, "Edge displacement, pixels / Max", "/edge_displacement_px/max", 2},
        {&causes, "Penumbra width, pixels / Method", "/penumbra_width_px/method", 1},
        {&causes, "Penumbra width, pixels / Reference", "/penumbra_width_px/reference", 1},
        {&causes, "Sampling, RMSE of S / Noise", "/noise/noise_rmse", 4},
        {&causes, "Sampling, RMSE of S / Bias", "/noise/bias_rmse", 4},
        {&causes, "Reference, ± S", "/bracket/max_half_width", 5},
        {&regions, "Points", "/points", 0},
        {&regions, "Lit", "/lit", 0},
        {&regions, "Umbra", "/umbra", 0},
        {&regions, "Penumbra", "/penumbra", 0},
        {&regions, "Undefined", "/undefined", 0},
        {&regions, "On the boundary", "/on_boundary", 0},
        {&regions, "Facing away", "/away", 0},
        {&regions, "Not in the sample", "/not_judged", 0},
    };
    const std::array lights = {"lamp", "blue sky #2"};
    const std::array labels = {"", "The shadow_zbuffer", "The ray_traced"};
    for (std::size_t m = 1; m < 3; ++m)
        for (std::size_t j = 0; j < 2; ++j) {
            const std::string row = fmt::format("{} / {}", lights[j], labels[m]);
            for (const Place& place : places) {
                // Three significant digits; all figures of one kind have as many before the point.
                const double value      = figure(m, j, place.pointer);
                const std::string found = place.table->at(row, place.column);
                EXPECT_EQ(found.substr(0, fixed(value, place.digits).size()), fixed(value, place.digits))
                    << row << ": " << place.column;
            }
            EXPECT_EQ(errors.at(row, "Bias"), "−" + fixed(-figure(m, j, "/bias"), 3));
            for (const HtmlTable* table : {&errors, &causes})
                EXPECT_EQ(table->at(row, "Coverage of all lights, %"), "87.5");
        }
    // Wrong interior points are marked; the edge band is not.
    EXPECT_TRUE(contains(page, fmt::format("<td class=\"wrong\">{}</td>", figure(1, 0, "/false_shadow/interior"))));
    EXPECT_TRUE(contains(page, fmt::format("<td>{}</td>", figure(1, 0, "/false_shadow/edge"))));
}

/// A shadow that is not there has no mean in the record; the page says how far its edge is away at least.
TEST_F(PageFigures, EdgesThatAreNotFoundAreTheReachAway) {
    const auto edges = [&](std::size_t m) -> json& {
        return results["methods"][m]["errors"][0]["edge_displacement_px"];
    };
    edges(1) = {{"mean", nullptr}, {"p95", nullptr}, {"max", nullptr}, {"pieces", 9}, {"unmatched", 9}, {"reach", 8}};
    edges(2) = {{"mean", 1}, {"p95", 1.5}, {"max", 2}, {"pieces", 10}, {"unmatched", 1}, {"reach", 8}};
    put(out / "court", results);
    write_report({out}, out);
    page = read(out / "court/index.html");
    const HtmlTable causes(page, "causes-caption");
    const auto row = [&](const char* label) {
        std::vector<std::string> cells;
        for (const char* column : {"Mean", "95 %", "Max", "Unmatched"})
            cells.push_back(causes.at(label, fmt::format("Edge displacement, pixels / {}", column)));
        return cells;
    };
    EXPECT_EQ(row("lamp / The shadow_zbuffer"), (std::vector<std::string>{"≥ 8.00", "≥ 8.00", "≥ 8.00", "9"}));
    EXPECT_EQ(row("lamp / The ray_traced"), (std::vector<std::string>{"≥ 1.70", "2.00", "≥ 8.00", "1"}));
}

/// Phases of seven rounds on a machine that gets slower from round to round.
json in_turns(double build, double aim, double visibility) {
    json times = {{"order", json::array()}};
    for (const auto& [name, ms] :
         {std::pair{"build_ms", build}, std::pair{"aim_ms", aim}, std::pair{"visibility_ms", visibility}}) {
        times[name] = milliseconds_of(ms, ms, ms);
        for (int round = 0; round < 7; ++round) times[name]["samples"].push_back(ms * (1 + 0.5 * round));
    }
    for (int round = 0; round < 7; ++round) times["order"].push_back(round % 3);
    return times;
}

/// Build 41, aim 21, visibility 5 ms against 7.24, 11.26 and 15: the first is 3 times as fast for a camera (5 : 15),
/// the second twice as fast for an object (33.5 : 67), and for a light (26 : 26.26) they differ by 1 %. The control
/// differs from itself by 2 %.
TEST_F(PageFigures, RatiosOfTimes) {
    const auto page_of = [&] {
        put(out / "court", results);
        write_report({out}, out);
        return read(out / "court/index.html");
    };
    EXPECT_FALSE(contains(page, "ratios-caption")) << "a record without samples";
    results["methods"][1]["times"] = in_turns(41, 21, 5);
    results["methods"][2]["times"] = in_turns(7.24, 11.26, 15);
    results["turns"]               = {
                      {"calibration_ms", {20, 21, 22}},
                      {"control", {{"text", results["methods"][1]["text"]}, {"again", in_turns(41 * 1.02, 21 * 1.02, 5 * 1.02)}}}};
    const std::string with = page_of();
    const HtmlTable ratios(with, "ratios-caption");
    const std::string first = "The shadow_zbuffer", second = "The ray_traced";
    EXPECT_EQ(ratios.at(first, "Object"), "×2.00 (2.00–2.00, 98.4 %)");
    EXPECT_EQ(ratios.at(second, "Object"), "fastest");
    EXPECT_EQ(ratios.at(first, "Light"), "fastest");
    EXPECT_EQ(ratios.at(second, "Light"), "no difference");
    EXPECT_EQ(ratios.at(first, "Camera"), "fastest");
    EXPECT_EQ(ratios.at(second, "Camera"), "×3.00 (3.00–3.00, 98.4 %)");
    EXPECT_TRUE(contains(with,
                         "object 2.0 %; light 2.0 %; camera 2.0 %; a fixed amount of work took 21.0 ms, between "
                         "20.0 and 22.0, in 3 rounds"));

    // A cold run is of no round, and without a control nothing can be said to differ.
    results["methods"][2]["times"]["order"] = json::array();
    EXPECT_EQ(HtmlTable(page_of(), "ratios-caption").at(second, "Camera"), "×3.00, one run");
    results["methods"][2]["times"]["order"] = {0};
    EXPECT_EQ(HtmlTable(page_of(), "ratios-caption").at(second, "Camera"), "×3.00, one run") << "one round is one run";
    results["methods"][2]["times"] = in_turns(7.24, 11.26, 15);
    for (const char* phase : {"build_ms", "aim_ms", "visibility_ms"})
        results["methods"][2]["times"][phase]["samples"].erase(5),
            results["methods"][2]["times"][phase]["samples"].erase(5);
    EXPECT_EQ(HtmlTable(page_of(), "ratios-caption").at(second, "Camera"), "×3.00, 5 rounds") << "no interval";
    results["methods"][2]["times"] = in_turns(7.24, 11.26, 15);
    results["turns"]["control"]    = nullptr;
    EXPECT_EQ(HtmlTable(page_of(), "ratios-caption").at(second, "Camera"), "no difference");
}

/// Build 4, aim 6, look 10, visibility 5 ms against 4, 6, 15 and 15: an object 25 : 40, a light 11 : 21, a camera 15 : 30.
TEST_F(PageFigures, RatiosOfTimesCountTheLookWhereItIsRepeated) {
    const auto with_look = [](double look, double visibility) {
        json times       = in_turns(4, 6, visibility);
        times["look_ms"] = in_turns(0, 0, look)["visibility_ms"];
        return times;
    };
    results["methods"][1]["times"] = with_look(10, 5);
    results["methods"][2]["times"] = with_look(15, 15);
    results["turns"]               = {{"calibration_ms", {20, 21, 22}},
                                      {"control", {{"text", results["methods"][1]["text"]}, {"again", with_look(10.1, 5.05)}}}};
    put(out / "court", results);
    write_report({out}, out);
    const HtmlTable ratios(read(out / "court/index.html"), "ratios-caption");
    EXPECT_EQ(ratios.at("The ray_traced", "Object"), "×1.60 (1.60–1.60, 98.4 %)");
    EXPECT_EQ(ratios.at("The ray_traced", "Light"), "×1.91 (1.91–1.91, 98.4 %)");
    EXPECT_EQ(ratios.at("The ray_traced", "Camera"), "×2.00 (2.00–2.00, 98.4 %)");
}

/// Build 41, aim 21, look 9.3, visibility 5 ms: a moved camera takes 14.3, a moved light 26, a moved object 76.3.
TEST_F(PageFigures, TablesOfTimes) {
    const HtmlTable times(page, "times-caption"), by_light(page, "light-times-caption");
    const std::string row = "The shadow_zbuffer";
    EXPECT_EQ(times.at(row, "Phase, ms / Build"), "41.0 31.0–51.0");
    EXPECT_EQ(times.at(row, "Phase, ms / Aim"), "21.0 11.0–26.0");
    EXPECT_EQ(times.at(row, "Phase, ms / Look"), "9.30 8.30–10.4");
    EXPECT_EQ(times.at(row, "Phase, ms / Visibility"), "5.00 3.00–7.00");
    EXPECT_EQ(times.at(row, "What moved, ms / Object"), "76.3");
    EXPECT_EQ(times.at(row, "What moved, ms / Light"), "26.0");
    EXPECT_EQ(times.at(row, "What moved, ms / Camera"), "14.3");
    EXPECT_EQ(times.at(row, "Memory, MiB"), "7.00");
    EXPECT_EQ(times.at(row, "Coverage, %"), "87.5");
    EXPECT_EQ(by_light.at(row, "Light"), "lamp");
    EXPECT_EQ(by_light.at(row, "Aim"), "7.10");
    EXPECT_EQ(by_light.at(row, "Visibility"), "1.30");
    EXPECT_EQ(by_light.at(row + " #2", "Aim"), "5.70");
    EXPECT_TRUE(contains(page,
                         "reading the scene 11.0; analysing the scene 12.0; building the ray tracer&apos;s tree "
                         "13.0; tracing the camera rays 14.0; shading 15.0; "))
        << page.substr(page.find("Shared by all"), 300);
}

TEST_F(PageFigures, TablesOfPicturesMethodsAndObjects) {
    const HtmlTable image(page, "image-caption"), methods(page, "methods-caption"), objects(page, "objects-caption");
    EXPECT_EQ(image.at("The ray_traced", "RMSE"), "0.0123");
    EXPECT_EQ(image.at("The ray_traced", "PSNR, dB"), "31.5");
    EXPECT_EQ(image.at("The ray_traced", "SSIM"), "0.9321");
    EXPECT_EQ(image.at("The ray_traced", "FLIP, mean"), "0.0456");
    EXPECT_EQ(methods.at("The shadow_zbuffer", "Parameters"), "resolution=512");
    EXPECT_EQ(methods.at("Planar projection", "Serves"), "not served");
    EXPECT_EQ(objects.at("ring", "Surface"), "closed");
    EXPECT_EQ(objects.at("ring", "Triangles"), "21");
    EXPECT_EQ(objects.at("ring", "Vertices"), "22");
    EXPECT_EQ(objects.at("ring", "Parts"), "23");
    EXPECT_EQ(objects.at("ring", "Area, units²"), "2.40");
    EXPECT_EQ(objects.at("ring", "Volume, units³"), "0.250");
    EXPECT_NE(page.find("<dt>Size</dt><dd>3 × 4 × 12 units, diagonal 13</dd>"), std::string::npos);
}

/// A picture draws all points, its figures speak of those that are answered: both say how many these are.
TEST_F(PageFigures, QualityOfAPictureStandsBesideItsCoverage) {
    results["methods"][2]["coverage"] = 1;
    put(out / "court", results);
    write_report({out}, out);
    page = read(out / "court/index.html");
    const HtmlTable image(page, "image-caption");
    EXPECT_EQ(image.at("The shadow_zbuffer", "Coverage, %"), "87.5");
    EXPECT_EQ(image.at("The ray_traced", "Coverage, %"), "100");
    EXPECT_TRUE(contains(page, "<span>FLIP map, mean 0.0456; covers 87.5 %, the rest is hatched</span>"));
    EXPECT_TRUE(contains(page, "<span>FLIP map, mean 0.0456</span>")) << "of the method that answers all points";
    EXPECT_TRUE(contains(page, "the pixel of the reference stands in for its own"));
    EXPECT_TRUE(contains(page, "<span>The shadow_zbuffer (covers 87.5 %)</span>")) << "the key of the chart";
    EXPECT_TRUE(contains(page, "<span>The ray_traced</span>"));
}

TEST_F(PageFigures, OneCoreIsNotOneCores) {
    results["machine"]["cores"] = results["machine"]["threads"] = 1;
    put(out / "court", results);
    write_report({out}, out);
    EXPECT_TRUE(contains(read(out / "court/index.html"), "1 core, 1 thread used, 50 GiB"));
}

TEST_F(PageFigures, WordsAroundThePictures) {
    EXPECT_TRUE(contains(page, "640 × 360 pixels"));
    EXPECT_TRUE(contains(page, "2 cores, 2 threads used, 50 GiB"));
    EXPECT_TRUE(contains(page, "Area lights are compared at 1\u202f234 of 5\u202f678 points"));
    EXPECT_TRUE(contains(page, "shadow edges but are not compared"));
    EXPECT_TRUE(contains(page, "come from ray_traced:samples=256"));
    const int wrong = int(figure(1, 0, "/false_shadow/interior") + figure(1, 0, "/false_light/interior") +
                          figure(1, 1, "/false_shadow/interior") + figure(1, 1, "/false_light/interior"));
    EXPECT_TRUE(contains(page, fmt::format("<b>The shadow_zbuffer</b> <span>{} wrong interior points, 76.3 ms; covers "
                                           "87.5 %, the rest is drawn lit</span>",
                                           wrong)));
    EXPECT_TRUE(contains(page, "<b>Reference</b> <span>The ray_traced: not exact") ||
                contains(page, "<b>Reference</b> <span>Ray-traced: not exact</span>"));
    // Below each light's pictures are its own counts.
    for (std::size_t j = 0; j < 2; ++j)
        EXPECT_TRUE(
            contains(page, fmt::format("<span>interior: {} false shadow, {} false light ({} acne, {} detachment, "
                                       "{} leak)</span>",
                                       figure(1, j, "/false_shadow/interior"), figure(1, j, "/false_light/interior"),
                                       figure(1, j, "/false_shadow/acne"), figure(1, j, "/false_light/detachment"),
                                       figure(1, j, "/false_light/leak"))))
            << j;
}

/// The picture that a text names: the file behind an image whose `alt` begins so.
std::string image_of(const std::string& html, const std::string& what, const std::string& who) {
    const std::regex image("<img src=\"([^\"]*)\" alt=\"[^\"]*\" data-who=\"" + who + "\" data-what=\"" + what + "\"");
    std::smatch found;
    return std::regex_search(html, found, image) ? decoded(found[1]) : "none";
}

TEST_F(PageFigures, PicturesAreWhatTheirNamesSay) {
    EXPECT_EQ(image_of(page, "S of lamp", "The shadow_zbuffer"), "shadow_zbuffer.S.lamp.png");
    EXPECT_EQ(image_of(page, "difference of lamp", "The shadow_zbuffer"), "shadow_zbuffer.diff.lamp.png");
    EXPECT_EQ(image_of(page, "S of lamp", "Reference"), "reference.S.lamp.png");
    EXPECT_EQ(image_of(page, "picture", "The ray_traced"), "ray_traced.png");
    EXPECT_EQ(image_of(page, "FLIP map", "The ray_traced"), "ray_traced.flip.png");
    // The method with most wrong points is on the slider's left.
    EXPECT_TRUE(contains(page, "<div class=\"half left\"><img src=\"ray_traced.png\""));
    EXPECT_TRUE(contains(page, "<div class=\"half right\"><img src=\"reference.png\""));
    EXPECT_TRUE(contains(page, "<div class=\"tag left\">The ray_traced</div>"));
    EXPECT_TRUE(contains(page, "<div class=\"tag right\">Reference</div>"));
}

TEST_F(PageFigures, ClassPicturesAreShownAsClasses) {
    Image classes(640, 360, {"R", "G", "B"});
    std::fill(classes.data.begin(), classes.data.end(), 0xf2 / 255.0f);
    for (json& light : results["methods"][1]["files"]["lights"])
        light["classes"] = light["visibility"].get<std::string>() + ".classes.png";
    put(out / "court", results);
    for (const json& light : results["methods"][1]["files"]["lights"])
        write_image(out / "court" / light["classes"].get<std::string>(), classes);
    write_report({out}, out);
    EXPECT_EQ(image_of(read(out / "court/index.html"), "errors of lamp", "The shadow_zbuffer"),
              "shadow_zbuffer.S.lamp.png.classes.png");
}

TEST_F(PageFigures, ExplainedPointsHaveTheirReasonsAndTheirPlaces) {
    json& method                                 = results["methods"][1];
    const std::string png                        = "shadow_zbuffer.classes.lamp.png";
    method["files"]["lights"]["lamp"]["classes"] = png;
    const auto answer                            = [](double s, std::uint32_t triangle, const std::string& object) {
        return json{{"method", "m"},
                    {"visibility", s},
                    {"verdict", s > 0 ? "lit" : "umbra"},
                    {"blocker", {{"triangle", triangle}, {"object", object}}},
                    {"at", 0.25},
                    {"towards", {1, 2, 3}},
                    {"margin", nullptr},
                    {"unit", ""},
                    {"evidence", json::array()}};
    };
    json point                       = {{"class", "leak"},
                                        {"pixel", {320, 100}},
                                        {"on", {{"triangle", 71}, {"object", "hall"}}},
                                        {"method", answer(1, 72, "arch")},
                                        {"truth", answer(0, 73, "tower")},
                                        {"segment", {{320.5, 100.5}, {401.5, 7.25}}},
                                        {"method_blocker", {{11, 12}, {13, 14}, {15, 16}}},
                                        {"truth_blocker", {{21, 22}, {23, 24}, {25, 26}}},
                                        {"texel", {{31, 32}, {33, 34}, {35, 36}, {37, 38}}}};
    point["method"]["difference"]    = "The tower <stands> there.";
    method["errors"][0]["explained"] = {point};
    put(out / "court", results);
    Image classes(640, 360, {"R", "G", "B"});
    std::fill(classes.data.begin(), classes.data.end(), 0xf2 / 255.0f);
    write_image(out / "court" / png, classes);
    EXPECT_FALSE(contains(page, "id=\"why\""));
    write_report({out}, out);
    const std::string html = read(out / "court/index.html"), why = html.substr(html.find("<section id=\"why\""));
    ASSERT_TRUE(contains(html, "<section id=\"why\""));
    const std::string section = why.substr(0, why.find("</section>"));
    for (const char* part :
         {"<summary><b>The shadow_zbuffer</b>, light lamp: ", "background: #c40000", "false light: leak",
          "column 320, row 100, on triangle 71 of hall", "href=\"shadow_zbuffer.classes.lamp.png\"",
          "viewBox=\"213.83 40.50 213.33 120.00\"", "cx=\"320.5\" cy=\"100.5\"",
          "<polyline class=\"ray\" points=\"320.5,100.5 401.5,7.25\"/>",
          "<polygon class=\"method\" points=\"11,12 13,14 15,16\"/>",
          "<polygon class=\"truth\" points=\"21,22 23,24 25,26\"/>",
          "<polygon class=\"texel\" points=\"31,32 33,34 35,36 37,38\"/>",
          "<dt>The shadow_zbuffer</dt><dd>lit, S 1; triangle 72 of arch blocks at 0.25 of the way to the light</dd>",
          "<dd>umbra, S 0; triangle 73 of tower blocks at 0.25 of the way to the light</dd>",
          "<dd>The tower &lt;stands&gt; there.</dd>"})
        EXPECT_TRUE(contains(section, part)) << part << "\n" << section;
}

TEST_F(PageFigures, Summary) {
    double interior = 0, edge = 0, absolute = 0, points = 0;
    for (std::size_t j = 0; j < 2; ++j) {
        for (const char* group : {"/false_shadow", "/false_light"}) {
            interior += figure(1, j, std::string(group) + "/interior");
            edge += figure(1, j, std::string(group) + "/edge");
        }
        absolute += figure(1, j, "/mae") * figure(1, j, "/points");
        points += figure(1, j, "/points");
    }
    const std::regex cells(
        fmt::format(" wrong\">{:.0f} <small>on 87.5 %</small></td><td>{:.0f}</td><td>{:.3f}</td><td[^>]*"
                    "data-interior=\"{:.0f}\"[^>]*>76.3</td>",
                    interior, edge, absolute / points, interior));
    EXPECT_TRUE(std::regex_search(index, cells)) << index.substr(index.find("87.5 %") - 400, 900);
    std::smatch raw;
    ASSERT_TRUE(std::regex_search(index, raw, std::regex("data-mae=\"([^\"]*)\"")));
    EXPECT_NEAR(std::stod(raw[1]), absolute / points, 1e-12);
}

/// The star of the summary ranks nothing where times vary by more than 30 %, or are of too few rounds to tell.
TEST_F(PageFigures, TheSummaryHoldsTheNoiseOfTimes) {
    const auto row_at = [&](const json& noise_bar) {
        results["turns"] = {{"calibration_ms", {20}}, {"noise_bar", noise_bar}, {"control", nullptr}};
        put(out / "court", results);
        write_report({out}, out);
        const std::string html = read(out / "index.html");
        const std::size_t at   = html.find("<tr data-noise=");
        return html.substr(at, html.find('>', at) - at);
    };
    EXPECT_TRUE(contains(index, "<tr data-noise=\"\"><th")) << "a record without turns";
    EXPECT_EQ(row_at(0.12), "<tr data-noise=\"0.12\"");
    EXPECT_EQ(row_at(0.3), "<tr data-noise=\"0.3\"");
    EXPECT_EQ(row_at(0.31), "<tr data-noise=\"0.31\" data-loud");
    EXPECT_EQ(row_at(nullptr), "<tr data-noise=\"inf\" data-loud");
}

/// From few triangles to many, and links that follow this order.
TEST_F(PageFigures, ScenesAreInOrder) {
    for (const auto& [name, triangles] : {std::pair{"b", 10}, {"a", 2000}, {"c", 300}}) {
        json scene                  = distinct(name);
        scene["facts"]["triangles"] = triangles;
        put(out / name, scene);
    }
    fs::remove_all(out / "court");
    write_report({out}, out);
    const std::string all = read(out / "index.html"), middle = read(out / "c/index.html");
    EXPECT_LT(all.find("The b</a>"), all.find("The c</a>"));
    EXPECT_LT(all.find("The c</a>"), all.find("The a</a>"));
    EXPECT_TRUE(contains(middle, "<a rel=\"prev\" href=\"../b/index.html\">← The b</a>"));
    EXPECT_TRUE(contains(middle, "<a rel=\"next\" href=\"../a/index.html\">The a →</a>"));
}

/// Legend, scales and captions: colours and the words beside them.
TEST_F(PageFigures, LegendsNameTheirColours) {
    const std::vector<std::pair<std::string, std::string>> legend = {{"#0a2a9c", "false shadow: acne"},
                                                                     {"#0072b2", "false shadow: other"},
                                                                     {"#7cc4ee", "false shadow: edge band"},
                                                                     {"#e69f00", "false light: detachment"},
                                                                     {"#c40000", "false light: leak"},
                                                                     {"#d55e00", "false light: unknown occluder"},
                                                                     {"#ffc861", "false light: edge band"},
                                                                     {"#882255", "penumbra"},
                                                                     {"#999933", "noise"},
                                                                     {"#009e73", "wrong at the terminator"},
                                                                     {"#cc79a7", "on the boundary: never wrong"}};
    for (const auto& [colour, name] : legend)
        EXPECT_TRUE(contains(page, fmt::format("fill=\"{}\" stroke=\"currentColor\"/></svg> {}</li>", colour, name)))
            << name;
    EXPECT_TRUE(contains(page, "width=\"14\" height=\"17\" fill=\"#6e6e72\""));
    EXPECT_TRUE(contains(page, "fill=\"#f2f2f2\" stroke=\"currentColor\"/></svg> right: umbra, lit"));
    EXPECT_TRUE(contains(page, "id=\"difference-scale\"><stop offset=\"0\" stop-color=\"#053061\"/>"));
    EXPECT_TRUE(contains(page, "<stop offset=\"1\" stop-color=\"#67001f\"/></linearGradient>"));
    EXPECT_TRUE(contains(page, "id=\"visibility-scale\"><stop offset=\"0\" stop-color=\"#000\"/>"));
    EXPECT_TRUE(contains(page, "<text x=\"10\" y=\"12\">false shadow</text>"));
    EXPECT_TRUE(contains(page, "<text x=\"310\" y=\"12\" text-anchor=\"end\">false light</text>"));
    for (const ErrorColour& entry : kErrorPalette)
        EXPECT_EQ(entry.interior, entry.name.find("edge band") == std::string_view::npos &&
                                      entry.error_class != ErrorClass::terminator_wrong &&
                                      entry.error_class != ErrorClass::on_boundary)
            << entry.name;
}

/// Two methods a decade apart on both axes. Time runs to the right and errors upwards, a decade is as wide everywhere;
/// the filled mark is the rebuild, the hollow one the camera; each mark has its method's colour.
TEST(ChartFigures, MarksAreWhereTheirValuesAre) {
    const json chart = error_time_chart({{"a", 1, 10, 0.01, 0}, {"b", 10, 100, 0.1, 1}, {"c", 100, 1000, 0.001, 2}});
    const auto at    = [&](std::size_t mark, const char* key) {
        return std::stod(chart["marks"][mark][key].get<std::string>());
    };
    EXPECT_EQ(chart["marks"][0]["label"], "a");
    const double decade = at(1, "camera_x") - at(0, "camera_x");
    EXPECT_GT(decade, 20);
    for (std::size_t m = 0; m < 3; ++m) {
        EXPECT_NEAR(at(m, "x") - at(m, "camera_x"), decade, 0.2) << m;
        EXPECT_NEAR(at(m, "camera_x"), at(0, "camera_x") + double(m) * decade, 0.2) << m;
        EXPECT_EQ(chart["marks"][m]["colour"], std::to_string(m));
        const auto begins_at = [&](const char* shape, const char* x) {
            return chart["marks"][m][shape].get<std::string>().starts_with(
                fmt::format("M{} ", chart["marks"][m][x].get<std::string>()));
        };
        EXPECT_TRUE(begins_at("shape", "x"));
        EXPECT_TRUE(begins_at("camera_shape", "camera_x"));
    }
    EXPECT_NEAR(at(0, "y") - at(1, "y"), at(2, "y") - at(0, "y"), 0.2) << "larger errors are higher";
    EXPECT_GT(at(0, "y"), at(1, "y") + 20);
    // Ticks: 1 ms is where the first camera is.
    for (const json& tick : chart["x_ticks"])
        if (tick["label"] == "1") {
            EXPECT_EQ(tick["at"], chart["marks"][0]["camera_x"]);
        }
}

TEST(TextFigures, ShortTimesHaveDigitsUntilAClockHasNone) {
    EXPECT_EQ(milliseconds(0.05), "0.0500");
    EXPECT_EQ(milliseconds(0.0005), "< 0.001");
    EXPECT_EQ(milliseconds(0), "0");
}

TEST_F(PageFigures, ChartDrawsTheRebuildFilled) {
    const std::regex mark(
        "<g class=\"mark-(\\d)\"><line x1=\"([0-9.]+)\" x2=\"([0-9.]+)\" y1=\"[0-9.]+\" y2=\"[0-9.]+\"/>"
        "<path class=\"camera\" d=\"M([0-9.]+) [^\"]*\"/><path d=\"M([0-9.]+) ");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(page, found, mark));
    EXPECT_EQ(found[2], found[4]) << "hollow: the camera, where the line begins";
    EXPECT_EQ(found[3], found[5]) << "filled: the rebuild, where it ends";
    EXPECT_LT(std::stod(found[2]), std::stod(found[3]));
}

}  // namespace
}  // namespace umbra
