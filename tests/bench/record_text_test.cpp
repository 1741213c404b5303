// Names in files need not be UTF-8, and results.json must be all the same.
#include <gtest/gtest.h>

#include "umbra/bench/compare/compare.h"
#include "umbra/bench/compare/record.h"
#include "umbra/bench/lab/describe.h"
#include "umbra/bench/report/report.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

TEST(RecordText, ReplacesWhatIsNotUtf8) {
    EXPECT_EQ(json_text({{"name",
                          "K\xfc"
                          "che"}}),
              "{\n \"name\": \"K\xef\xbf\xbd"
              "che\"\n}\n");
    EXPECT_EQ(json_text({{"name",
                          "K\xc3\xbc"
                          "che"}}),
              "{\n \"name\": \"K\xc3\xbc"
              "che\"\n}\n");
}

/// Sums over the lights, each phase under its own name.
TEST(RecordText, ReferencesHaveTheTimesOfTheirPhases) {
    Scene scene;
    scene.lights.resize(2);
    ReferenceRun ran{.run = {.choice = parse_method("exact")}, .judged = 3, .of = 4, .stand_in = "ray_traced"};
    ran.run.times = {.build = 100, .aim = {10, 20}, .look = 4, .visibility = {1, 2}};
    const Json record =
        to_record(reference_record({{.choice = parse_method("exact"), .exact = true, .note = {}}, ran}, scene));
    EXPECT_EQ(record["times"]["build_ms"]["median"], 100);
    EXPECT_EQ(record["times"]["build_ms"]["max"], 100);
    EXPECT_EQ(record["times"]["build_ms"]["runs"], 1);
    EXPECT_EQ(record["times"]["aim_ms"]["median"], 30);
    EXPECT_EQ(record["times"]["aim_ms"]["min"], 30);
    EXPECT_EQ(record["times"]["aim_ms"]["runs"], 1);
    EXPECT_EQ(record["times"]["look_ms"]["median"], 4) << "once for both";
    EXPECT_EQ(record["times"]["visibility_ms"]["median"], 3);
    EXPECT_EQ(record["times"]["visibility_ms"]["max"], 3);
    EXPECT_EQ(record["judged"]["points"], 3);
    EXPECT_EQ(record["judged"]["of"], 4);
}

TEST(RecordText, AMeshWithNamesInLatin1IsComparedAndReported) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "K\xfc"
        "che.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\no T\xfcr\xff\nusemtl r\xe9\nf 1 2 3\n");
    CompareOptions options;
    options.methods       = {"shadow_volumes"};
    options.size          = {8, 6};
    options.out           = folder.path() / "out";
    options.command       = "umbra compare " + file.string();
    const ScenesDone done = compare_scenes({file}, options);
    EXPECT_TRUE(done.failed.empty()) << done.failed.front();
    ASSERT_EQ(done.names.size(), 1u);
    write_report({options.out}, folder.path() / "report");
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "report/index.html"));
}

}  // namespace
}  // namespace umbra
