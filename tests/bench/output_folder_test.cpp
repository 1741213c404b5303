// Output folders: whole or not at all, one run at a time, nothing of a killed run left, no file of a user lost.
#include <gtest/gtest.h>

#include "umbra/bench/base/files.h"
#include "umbra/bench/base/own_files.h"
#include "umbra/bench/base/place_lock.h"
#include "umbra/bench/base/staged_files.h"
#include "umbra/bench/base/staged_folder.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

class Output : public testing::Test {
protected:
    [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
    /// A result as an earlier run wrote it: a record, the picture that it names, its page.
    void old_result(const std::string& folder = "out") const {
        folder_.write(folder + "/results.json",
                      R"({"schema": 1, "version": "0", "methods": [{"files": {"png": "a.png"}}]})");
        folder_.write(folder + "/a.png", "a picture");
        folder_.write(folder + "/index.html", R"(<meta name="generator" content="umbra">)");
        folder_.write(folder + "/report.css", "");
    }
    [[nodiscard]] std::set<std::string> names(const std::string& folder = ".") const {
        std::set<std::string> all;
        for (const auto& entry : fs::directory_iterator(at(folder))) all.insert(entry.path().filename().string());
        return all;
    }
    [[nodiscard]] std::string text(const std::string& name) const { return bytes_of(at(name)); }
    /// Writes a new result and commits.
    void replace(const fs::path& to) const {
        StagedFolder staged(to);
        write_text(staged.folder() / "b.png", "another");
        staged.commit();
    }

    TemporaryFolder folder_;
};

TEST_F(Output, BytesAreReadAsTheyAre) {
    write_text(at("a"), std::string_view("\r\n\0 \xff\n", 6));
    EXPECT_EQ(text("a"), std::string("\r\n\0 \xff\n", 6));
    EXPECT_EQ(text("none"), "");
}

TEST_F(Output, AFolderIsReplacedWhole) {
    old_result();
    {
        StagedFolder staged(at("out"));
        write_text(staged.folder() / "b.png", "another");
        EXPECT_TRUE(fs::exists(at("out/a.png")));
    }
    EXPECT_EQ(names("out"), (std::set<std::string>{"a.png", "index.html", "report.css", "results.json"}));
    EXPECT_EQ(names(), std::set<std::string>{"out"}) << "not committed: nothing is left";
    replace(at("out/"));
    EXPECT_EQ(names("out"), std::set<std::string>{"b.png"});
    EXPECT_EQ(names(), std::set<std::string>{"out"});
}

TEST_F(Output, AUsersFileIsNeitherRemovedNorWrittenOver) {
    for (const char* mine : {"out/thesis.tex", "out/old/x", "out/.hidden", "out/b.png"}) {
        old_result();
        folder_.write(mine, "years of work");
        EXPECT_THROW(replace(at("out")), InputError) << mine;
        EXPECT_EQ(text(mine), "years of work");
        fs::remove_all(at("out"));
    }
    for (const char* record : {"{}", "[1]", "no JSON", R"({"schema": 1})"}) {
        folder_.write("out/results.json", record);
        EXPECT_THROW(replace(at("out")), InputError) << record;
        EXPECT_THROW(check_writable_beside(at("out")), InputError) << record;
        fs::remove_all(at("out"));
    }
    folder_.write("out", "a file");
    EXPECT_THROW(replace(at("out")), InputError);
    folder_.write("site/index.html", "<p>home</p>");
    EXPECT_THROW(check_writable_beside(at("site")), InputError);
    folder_.write("css/report.css", "p {}");
    EXPECT_THROW(check_writable_beside(at("css")), InputError);
    old_result("ours");
    folder_.write("ours/thesis.tex", "years of work");
    check_writable_beside(at("ours"));  // it stays where it is
    check_writable_beside(at("missing"));
}

TEST_F(Output, WhatAppearsDuringARunIsKept) {
    StagedFolder staged(at("out"));
    folder_.write("out/thesis.tex", "years of work");
    EXPECT_THROW(staged.commit(), InputError);
    EXPECT_EQ(text("out/thesis.tex"), "years of work");
}

TEST_F(Output, ALinkLeadsToThePlace) {
    old_result("real");
    fs::create_directory_symlink(at("real"), at("link"));
    replace(at("link"));
    EXPECT_TRUE(fs::is_symlink(at("link")));
    EXPECT_EQ(names("real"), std::set<std::string>{"b.png"});
}

TEST_F(Output, OneRunAtATime) {
    const StagedFolder first(at("out"));
    EXPECT_THROW(StagedFolder(at("out")), InputError);
    EXPECT_THROW(StagedFolder(at("x/../out/")), InputError);
    const StagedFolder other(at("out2"));
    const PlaceLock lock = PlaceLock::inside(at("shared"));
    EXPECT_THROW(static_cast<void>(PlaceLock::inside(at("shared"))), InputError);
    EXPECT_TRUE(fs::exists(first.folder())) << "a live run's files stay";
}

TEST_F(Output, TheNextRunClearsAwayWhatAKilledOneLeft) {
    old_result("out/scene");
    for (const char* left :
         {"out/.umbra-lock", "out/.scene.umbra-lock", "out/.scene.umbra-new/a.exr", "out/.other.umbra-new/a.exr",
          "out/.umbra-part.index.html", "out/scene/.umbra-part.index.html"})
        folder_.write(left, "half");
    folder_.write("out/.mine", "not ours");
    { const PlaceLock lock = PlaceLock::inside(at("out")); }
    EXPECT_EQ(names("out"), (std::set<std::string>{".mine", "scene"}));
    EXPECT_FALSE(fs::exists(at("out/scene/.umbra-part.index.html")));

    // Between the two renames of a file system that cannot swap folders.
    fs::rename(at("out/scene"), at("out/.scene.umbra-old"));
    { const StagedFolder staged(at("out/scene")); }
    EXPECT_TRUE(fs::exists(at("out/scene/a.png"))) << "the old result is restored";
    EXPECT_FALSE(fs::exists(at("out/.scene.umbra-old")));
}

TEST_F(Output, ALiveRunsFilesAreNotClearedAway) {
    const StagedFolder ladders(at("out/ladders"));
    write_text(ladders.folder() / "a.png", "in work");
    { const PlaceLock lock = PlaceLock::inside(at("out")); }
    EXPECT_TRUE(fs::exists(ladders.folder() / "a.png"));
    EXPECT_THROW(StagedFolder(at("out/ladders")), InputError);
}

TEST_F(Output, FilesAppearTogether) {
    folder_.write("a.txt", "old");
    folder_.write("gone.txt", "old");
    {
        StagedFiles staged;
        staged.write(at("a.txt"), "new");
        EXPECT_EQ(text("a.txt"), "old");
    }
    EXPECT_EQ(names(), (std::set<std::string>{"a.txt", "gone.txt"}));
    StagedFiles staged;
    staged.write(at("a.txt"), "new");
    write_text(staged.place(at("deep/b.txt")), "by the caller");
    staged.remove(at("gone.txt"));
    EXPECT_TRUE(fs::exists(at("gone.txt")));
    staged.commit();
    EXPECT_EQ(text("a.txt") + text("deep/b.txt"), "newby the caller");
    EXPECT_FALSE(fs::exists(at("gone.txt")));
}

TEST(FolderName, FitsEverySystemAndStaysDistinct) {
    for (const char* plain : {"sun_on_plane", "two words", "größe", "a.b-c", "{{x}}", "日本"})
        EXPECT_EQ(folder_name(plain), plain);
    const std::pair<std::string, std::string> changed[] = {{"", "_"},
                                                           {".", "_"},
                                                           {"..", "__"},
                                                           {".hidden", "_hidden"},
                                                           {"end.", "end_"},
                                                           {"a/b\\c", "a_b_c"},
                                                           {"<b>\"x\"", "_b__x_"},
                                                           {"new\nline", "new_line"},
                                                           {"con", "con_"},
                                                           {"LPT1.txt", "LPT1.txt_"},
                                                           {"ladders", "ladders_"},
                                                           {"index.html", "index.html_"},
                                                           {"\xff\xfe", "__"},
                                                           {"x\xc3", "x_"}};
    for (const auto& [name, folder] : changed) EXPECT_EQ(folder_name(name), folder) << name;
    const std::string a = folder_name(std::string(5000, 'x')), b = folder_name(std::string(5001, 'x'));
    EXPECT_LE(a.size(), 110u);
    EXPECT_NE(a, b);
    std::string wide;
    for (int i = 0; i < 60; ++i) wide += "é";
    EXPECT_EQ(folder_name(wide).substr(0, 100), wide.substr(0, 100)) << "cut between characters";
}

}  // namespace
}  // namespace umbra
