// The meshes that set-up obtains: only the files that the scenes were made with are taken.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "umbra/tests/support/temporary_folder.h"

namespace umbra {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// With an archive of two meshes, of which one is not what its hash says, one has no hash, and no network.
TEST(FetchReal, RefusesFilesWithAnotherHash) {
    const TemporaryFolder folder;
    fs::copy_file(fs::path(UMBRA_SCENES) / "fetch_real", folder.path() / "fetch_real");
    (void)folder.write("data/meshes/bear.off", "right\n");
    (void)folder.write("data/meshes/cow.off", "wrong\n");
    (void)folder.write("data/meshes/camel.off", "unknown\n");
    const std::string in = "cd " + folder.path().string() + " && ";
    ASSERT_EQ(
        std::system((in + "tar -czf data.tar.gz data && printf '%s  bear.off\\n' $(sha256sum <data/meshes/bear.off | "
                          "cut -d ' ' -f 1) >real.sha256 && printf '%064d  cow.off\\n' 0 >>real.sha256")
                        .c_str()),
        0);
    (void)folder.write("real/dragon.ply", "is there\n");
    const int status = std::system((in + "UMBRA_CGAL_DATA=data.tar.gz bash ./fetch_real 2>log").c_str());
    EXPECT_NE(status, 0);
    EXPECT_EQ(read(folder.path() / "real/bear.off"), "right\n");
    EXPECT_FALSE(fs::exists(folder.path() / "real/cow.off"));
    EXPECT_FALSE(fs::exists(folder.path() / "real/camel.off"));
    EXPECT_EQ(read(folder.path() / "real/dragon.ply"), "is there\n");
    const std::string log = read(folder.path() / "log");
    EXPECT_NE(log.find("cow.off: refused: its SHA-256 is "), std::string::npos) << log;
    EXPECT_NE(log.find("camel.off: refused"), std::string::npos) << log;
}

}  // namespace
}  // namespace umbra
