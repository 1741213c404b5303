// Names that no file can have are as wrong as names of files that are not there, and no more.
#include <gtest/gtest.h>

#include "umbra/bench/report/report.h"
#include "umbra/core/base/error.h"
#include "umbra/tests/support/scene_files.h"

namespace umbra {
namespace {

const std::string kLong(300, 'x');

TEST(LongNames, OfMeshesAreRefusedAtTheirPlace) {
    const TemporaryFolder folder;
    const auto scene = folder.write("scene.json", R"({"objects":[{"type":"mesh","file":")" + kLong + R"(.obj"}]})");
    EXPECT_NE(refusal(scene).find("scene.json:1:35: the mesh cannot be read"), std::string::npos) << refusal(scene);
}

TEST(LongNames, OfPicturesAreRefusedAtTheirPlaceInResults) {
    const TemporaryFolder folder;
    (void)folder.write("run/results.json", R"({"schema":2,"scene":{"name":"a"},"methods":[{"name":"m","serves":{"how":)"
                                           R"("exactly"},"files":{"exr":")" +
                                               kLong + R"(","png":")" + kLong + R"("}}]})");
    try {
        write_report({folder.path() / "run"}, folder.path() / "out");
        ADD_FAILURE() << "was not refused";
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("expected an existing file"), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace umbra
