// The program as people and scripts see it: exit codes, messages, JSON.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace {

namespace fs = std::filesystem;

struct Answer {
    int exit_code = -1;
    std::string output;  ///< standard output and error together
};

Answer run(const std::string& command) {
    FILE* pipe = popen((command + " 2>&1 </dev/null").c_str(), "r");
    Answer answer;
    std::array<char, 4096> buffer{};
    for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
        answer.output.append(buffer.data(), n);
    const int status = pclose(pipe);
    answer.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return answer;
}

Answer umbra(const std::string& arguments) { return run(std::string(UMBRA_PROGRAM) + " " + arguments); }

const std::string kScene = std::string(UMBRA_SCENES) + "/sun_on_plane.json";

class Cli : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("umbra-cli-" + std::to_string(::getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string file(const char* name) const { return (folder_ / name).string(); }

    fs::path folder_;
};

TEST_F(Cli, UsageErrorsEndWithTwo) {
    const std::string render = "render " + kScene;
    for (const std::string& arguments : std::vector<std::string>{
             "", "paint", "render", render, render + " --method crayon -o " + file("a.png"),
             render + " --method ray_traced:samples=0 -o " + file("a.png"),
             render + " --method ray_traced:samples -o " + file("a.png"), render + " --size 0x0 -o " + file("a.png"),
             render + " -o " + file("a.tiff"), "--threads 0 list", "inspect --nonsense x"})
        EXPECT_EQ(umbra(arguments).exit_code, 2) << arguments << "\n" << umbra(arguments).output;
    EXPECT_NE(umbra("render " + kScene + " --method crayon -o " + file("a.png")).output.find("shadow_zbuffer"),
              std::string::npos);
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Cli, UnreadableInputEndsWithFourAndLeavesNothing) {
    std::ofstream(file("broken.json")) << "{\n  \"lights\": [ { \"type\": \"spott\" } ]\n}\n";
    const Answer answer = umbra("render " + file("broken.json") + " -o " + file("a.png"));
    EXPECT_EQ(answer.exit_code, 4);
    EXPECT_NE(answer.output.find("broken.json:2"), std::string::npos) << answer.output;
    EXPECT_NE(answer.output.find("spot"), std::string::npos) << answer.output;
    EXPECT_FALSE(fs::exists(file("a.png")));
    EXPECT_EQ(umbra("inspect " + file("nowhere.obj")).exit_code, 4);
    EXPECT_EQ(umbra("compare " + file("broken.json") + " -o " + file("out")).exit_code, 4);
    EXPECT_EQ(umbra("render " + kScene + " --size 32x18 -o /nonexistent/folder/a.png").exit_code, 4);
}

TEST_F(Cli, HelpAndVersionAreThereEverywhere) {
    for (const char* command : {"", "list", "inspect", "render", "compare", "diff", "accept", "report"}) {
        const Answer answer = umbra(std::string(command) + " --help");
        EXPECT_EQ(answer.exit_code, 0) << command;
        EXPECT_GT(answer.output.size(), 80u) << command;
    }
    EXPECT_EQ(umbra("--version").exit_code, 0);
}

TEST_F(Cli, ListNamesEveryMethodWithItsParameters) {
    const nlohmann::json record = nlohmann::json::parse(umbra("list --json").output);
    std::vector<std::string> names;
    for (const auto& m : record["methods"]) {
        names.push_back(m["name"]);
        EXPECT_FALSE(m["paper"].get<std::string>().empty());
        for (const auto& p : m["parameters"]) EXPECT_FALSE(p["doc"].get<std::string>().empty()) << p;
    }
    EXPECT_EQ(names, (std::vector<std::string>{"planar_projection", "shadow_volumes", "shadow_zbuffer", "ray_traced",
                                               "exact"}));
    EXPECT_GE(record["scenes"].size(), 11u);
}

TEST_F(Cli, InspectSaysWhoServesAndWhy) {
    const Answer answer = umbra("inspect " + kScene + " --silhouettes 50 --seed 3 --json");
    ASSERT_EQ(answer.exit_code, 0) << answer.output;
    const nlohmann::json record = nlohmann::json::parse(answer.output);
    for (const auto& m : record["methods"]) EXPECT_FALSE(m["serves"]["why"].get<std::string>().empty());
    for (const auto& s : record["silhouettes"]) EXPECT_GE(s["standard_error"].get<double>(), 0);
    EXPECT_EQ(umbra("inspect " + kScene + " --silhouettes 50 --seed 3 --json").output, answer.output);
}

TEST_F(Cli, RenderIsTheSameForAnyNumberOfThreads) {
    for (const char* method : {"planar_projection", "shadow_volumes", "shadow_zbuffer", "ray_traced"}) {
        const std::string options = " --size 160x90 --quiet --method " + std::string(method) + " -o ";
        ASSERT_EQ(umbra("--threads 1 render " + kScene + options + file("one.exr")).exit_code, 0);
        ASSERT_EQ(umbra("--threads 3 render " + kScene + options + file("three.exr")).exit_code, 0);
        EXPECT_EQ(umbra("diff " + file("one.exr") + " " + file("three.exr")).exit_code, 0) << method;
    }
}

TEST_F(Cli, DiffExitCodes) {
    ASSERT_EQ(umbra("render " + kScene + " --size 160x90 -o " + file("a.png")).exit_code, 0);
    ASSERT_EQ(umbra("render " + kScene + " --size 160x90 --method shadow_zbuffer:resolution=64 -o " + file("b.png"))
                  .exit_code,
              0);
    ASSERT_EQ(umbra("render " + kScene + " --size 80x45 -o " + file("c.png")).exit_code, 0);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("a.png")).exit_code, 0);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("b.png")).exit_code, 2);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("b.png") + " --fail 1").exit_code, 1);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("c.png")).exit_code, 3);
    EXPECT_EQ(umbra("diff " + file("a.png") + " " + file("none.png")).exit_code, 4);
    const nlohmann::json record =
        nlohmann::json::parse(umbra("diff " + file("a.png") + " " + file("b.png") + " --json").output);
    for (const char* key : {"mae", "rmse", "max", "psnr", "ssim", "flip", "worst"})
        EXPECT_TRUE(record.contains(key)) << key;
}

TEST_F(Cli, AcceptRenewsOnceAndCheckNeverWrites) {
    fs::copy(kScene, file("sun.json"));
    std::ofstream(file("canonical.txt")) << "# one scene\nsun.json\n";
    const std::string with_folders =
        "UMBRA_SCENES=" + folder_.string() + " UMBRA_GOLDEN=" + file("golden") + " " + UMBRA_PROGRAM + " accept ";
    EXPECT_EQ(run(with_folders + "moon").exit_code, 2);
    Answer answer = run(with_folders + "--check");
    EXPECT_EQ(answer.exit_code, 1);
    EXPECT_NE(answer.output.find("sun/shadow_zbuffer: new"), std::string::npos) << answer.output;
    EXPECT_FALSE(fs::exists(file("golden")));

    EXPECT_EQ(run(with_folders + "sun/exact sun/shadow_zbuffer").exit_code, 0);
    EXPECT_TRUE(fs::exists(file("golden/sun/exact.exr")));
    EXPECT_FALSE(fs::exists(file("golden/sun/ray_traced.exr")));
    EXPECT_EQ(run(with_folders).exit_code, 0);
    answer = run(with_folders);
    EXPECT_EQ(answer.exit_code, 0);
    EXPECT_EQ(answer.output, "nothing changed\n");
    EXPECT_EQ(run(with_folders + "--check").exit_code, 0);

    std::ofstream(file("golden/sun/figures.json")) << "no figures";
    EXPECT_EQ(run(with_folders + "--check").exit_code, 4);
    fs::remove(file("golden/sun/figures.json"));
    EXPECT_EQ(run(with_folders + "--check").exit_code, 1);
}

TEST_F(Cli, CompareThenReportAnewFromFilesAlone) {
    ASSERT_EQ(umbra("compare " + kScene + " --size 96x54 --methods ray_traced shadow_zbuffer:resolution=128 -o " +
                    file("out"))
                  .exit_code,
              0);
    ASSERT_TRUE(fs::exists(file("out/index.html")));
    ASSERT_TRUE(fs::exists(file("out/results.json")));
    ASSERT_EQ(umbra("report " + file("out/sun_on_plane") + " -o " + file("anew")).exit_code, 0);
    EXPECT_TRUE(fs::exists(file("anew/index.html")));
}

}  // namespace
