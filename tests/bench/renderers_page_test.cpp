#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "umbra/bench/base/files.h"
#include "umbra/bench/compare/compare.h"
#include "umbra/bench/contenders/contender.h"
#include "umbra/bench/pages/report_page.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/report/finding.h"
#include "umbra/bench/report/report.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

/// Text between tags, one space for each run of white space.
std::string text_of_page(const fs::path& page) {
    std::string text = std::regex_replace(bytes_of(page), std::regex("<[^>]*>"), " ");
    return std::regex_replace(text, std::regex("\\s+"), " ");
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(RenderersPage, ShowsEachContenderOnEachScene) {
    const TemporaryFolder folder;
    const fs::path out      = folder.path() / "out";
    const MethodInfo& wrong = program_method("wrong",
                                             {.command = {UMBRA_PLANTED_CONTENDER, "exchanged"},
                                              .says    = introduction({UMBRA_PLANTED_CONTENDER, "exchanged"}, ".")},
                                             ".");
    CompareOptions options;
    options.methods = {"ray_traced"};
    options.with    = {MethodChoice(wrong)};
    options.size    = {48, 27};
    options.out     = out;
    options.repeats = {.max_runs = 1, .budget_ms = 1};
    const fs::path scenes(UMBRA_SCENES);
    const ScenesDone done = compare_scenes(
        {scenes / "light_inside_view.json", scenes / "umbra_penumbra.json", scenes / "eclipse.json"}, options);
    ASSERT_EQ(done.failed, std::vector<std::string>());
    write_report({out}, out);

    const auto of = [&](const char* scene) {
        return from_record<Results>(read_results(out / scene / "results.json")).methods.at(1);
    };
    const MethodRecord hard = of("light_inside_view"), area = of("umbra_penumbra"), disk = of("eclipse");
    ASSERT_FALSE(disk.ran);
    const auto marked = [](double n) {
        return fmt::format("<td{}>{}</td>", n > 0 ? " class=\"wrong\"" : "", count(n));
    };
    const auto cells = [&](const std::vector<MethodRecord>& methods) {
        double points = 0, undefined = 0, shadow = 0, light = 0, edge = 0, squares = 0, errors = 0;
        for (const MethodRecord& method : methods) {
            const ErrorRecord& e = method.errors.at(0);
            const auto n         = static_cast<double>(e.points.value());
            points += n, undefined += static_cast<double>(e.undefined);
            shadow += static_cast<double>(e.false_shadow->interior.value());
            light += static_cast<double>(e.false_light->interior.value());
            edge += static_cast<double>(e.false_shadow->edge.value() + e.false_light->edge.value());
            squares += e.rmse.value() * e.rmse.value() * n, errors += e.bias.value() * n;
        }
        EXPECT_GT(shadow + light, 0);
        EXPECT_NE(shadow, light);
        EXPECT_NE(edge, shadow + light);
        return fmt::format("<td>{}</td><td>{}</td>{}{}<td>{}</td><td>{}</td><td>{}</td>", count(points),
                           count(undefined), marked(shadow), marked(light), count(edge),
                           score(std::sqrt(squares / points)), score(errors / points));
    };
    const std::string html = bytes_of(out / "renderers.html");
    const auto row         = [](const std::string& begin) { return "<tr><th scope=\"row\">" + begin; };
    for (const MethodRecord& method : {hard, area}) {
        const std::string text = row("Planted 1</th>") + cells({method}) +
                                 fmt::format("<td>{}</td><td>{}</td></tr>", milliseconds(totals(method).object_ms),
                                             milliseconds(10));  // four phases of 2.5
        EXPECT_TRUE(contains(html, text)) << text;
    }
    EXPECT_TRUE(contains(html, row("Planted 1</th><td colspan=\"9\" class=\"unserved\">") + disk.serves.why));
    const std::string all = "</a></th><td>2 of 3</td>" + cells({hard, area}) + "</tr>";
    EXPECT_TRUE(contains(html, all)) << all;
    const std::string page = text_of_page(out / "renderers.html");
    EXPECT_TRUE(contains(page, "Planted 1"));
    EXPECT_FALSE(contains(page, "Ray-traced")) << "a method of our own is no contender";
    EXPECT_TRUE(links_hold(out / "renderers.html"));
    EXPECT_TRUE(contains(text_of_page(out / "index.html"), "Renderers against the truth"));
}

TEST(RenderersPage, IsNotThereWithoutContenders) {
    const TemporaryFolder folder;
    CompareOptions options;
    options.methods = {"ray_traced"};
    options.size    = {32, 18};
    options.out     = folder.path() / "out";
    options.repeats = {.max_runs = 1, .budget_ms = 1};
    static_cast<void>(compare_scenes({fs::path(UMBRA_SCENES) / "light_inside_view.json"}, options));
    write_report({options.out}, options.out);
    EXPECT_FALSE(fs::exists(options.out / "renderers.html"));
}

}  // namespace
}  // namespace umbra
