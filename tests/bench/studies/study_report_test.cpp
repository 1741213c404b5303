// A study's value: its text, its page and its files, of a table whose cells are known.
#include <gtest/gtest.h>

#include <fstream>

#include <nlohmann/json.hpp>

#include "umbra/bench/base/own_files.h"
#include "umbra/bench/pages/report_text.h"
#include "umbra/bench/studies/study_report.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

StudyReport known() {
    return {
        .title = "Known",
        .page =
            "{{#tables.rays}}{{>study_table}}{{/tables.rays}}{{#pictures.all}}{{>study_picture}}"
            "{{/pictures.all}}{{#sentences}}<p>{{#parts}}{{>study_words}}{{/parts}}</p>{{/sentences}}",
        .tables    = {{"rays",
                       "Rays of `eye`",
                       {{"name", "kind", kCode},
                        {"cost.ms", "time", decimals(2), "ms"},
                        {"errors.edge", "edge", kCount, "", "errors"},
                        {"errors.all", "S_j", kCount, "", "errors"},
                        {.key = "note", .head = "note", .shown = Shown::on_page}},
                       {{{"name", "eye, \"first\""}, {"cost", {{"ms", 1.25}}}, {"errors", {{"edge", 12}, {"all", 1234}}}},
                        {{"name", "<b>"}, {"cost", {{"ms", nullptr}}}, {"errors", {{"edge", 3}}}, {"note", "n"}}}}},
        .pictures  = {{"all", {{"a.png", "A picture", "S_j of `eye`."}}}},
        .sentences = {{"Found " + count(1234) + " of S_j."}, {"For pages.", Shown::on_page}}};
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST(StudyReport, TextAlignsColumnsUnderTheirGroups) {
    EXPECT_EQ(study_text(known()),
              "                            errors\n"
              "kind          time, ms  edge   S_j\n"
              "eye, \"first\"      1.25    12  1234\n"
              "<b>                  -     3     -\n"
              "Found 1234 of S_j.\n");
}

TEST(StudyReport, CsvHasNumbersInFullAndQuotesText) {
    EXPECT_EQ(table_csv(known().tables[0]),
              "name,cost.ms,errors.edge,errors.all,note\n"
              "\"eye, \"\"first\"\"\",1.25,12,1234,\n"
              "<b>,,3,,n\n");
}

TEST(StudyReport, PageShowsTheSameCells) {
    const TemporaryFolder folder;
    StagedFiles staged;
    write_study_page(known(), {.version = "1", .command = "umbra known"}, folder.path(), staged);
    staged.commit();
    const std::string page = text_of(folder.path() / "index.html");
    for (const std::string& part : std::vector<std::string>{
             "<span>Rays of <code>eye</code></span>", "<th scope=\"colgroup\" colspan=\"2\">errors</th>",
             "<th scope=\"col\">time, ms</th><th scope=\"col\">edge</th><th scope=\"col\">S<sub>j</sub></th>",
             "</code></th><td>1.25</td><td>12</td><td>" + count(1234) + "</td><td>–</td>",
             "<th scope=\"row\"><code>&lt;b&gt;</code></th><td>–</td><td>3</td><td>–</td><td>n</td>",
             "<img src=\"a.png\" alt=\"A picture\"><figcaption>S<sub>j</sub> of <code>eye</code>.</figcaption>",
             "<p>Found " + count(1234) + " of S<sub>j</sub>.</p>", "<p>For pages.</p>"})
        EXPECT_NE(page.find(part), std::string::npos) << part << '\n' << page;
}

struct KnownRecord {
    HeadRecord head{};
    std::vector<std::string> csv{};
};
DESCRIBE(KnownRecord) {
    of.all(&R::head);
    MEMBERS(csv);
}

TEST(StudyReport, FolderIsReplacedAsAWholeAndNamesItsFiles) {
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "out";
    const auto make    = [](const fs::path&) { return KnownRecord{head_record("umbra known")}; };
    const auto report  = [](const KnownRecord&) { return known(); };
    for (int time = 0; time < 2; ++time) {
        const Json record = to_record(write_study(out, make, report));
        EXPECT_EQ(record["csv"], Json{"rays.csv"});
        EXPECT_EQ(Json::parse(text_of(out / "results.json")), record);
        EXPECT_EQ(text_of(out / "rays.csv"), table_csv(known().tables[0]));
        EXPECT_TRUE(fs::exists(out / "index.html"));
    }
    std::ofstream(out / "mine.csv") << "1";
    EXPECT_THROW((void)write_study(out, make, report), InputError);
}

TEST(StudyReport, FilesBesideOthersAreNotWrittenOverWhereNoRecordNamesThem) {
    const TemporaryFolder folder;
    folder.write("bias.csv", "mine");
    EXPECT_NO_THROW(check_writable_beside(folder.path()));
    EXPECT_THROW(check_writable_beside(folder.path(), {"bias.csv"}), InputError);
    folder.write("results.json", R"({"schema": 2, "version": "1", "csv": ["bias.csv"]})");
    EXPECT_NO_THROW(check_writable_beside(folder.path(), {"bias.csv"}));
}

}  // namespace
}  // namespace umbra
