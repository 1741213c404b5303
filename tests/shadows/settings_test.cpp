// Settings reach the member that they were made for.
#include "umbra/shadows/settings.h"

#include <gtest/gtest.h>

#include "umbra/core/base/error.h"
#include "umbra/shadows/method.h"
#include "umbra/tests/support/known_scenes.h"

namespace umbra {
namespace {

// Several methods have a struct of this name in an unnamed namespace with a member of this name, each at another
// offset.
struct Options {
    double before[4]{};
    int samples = 3;
};

const std::vector<Parameter> kParameters{parameter<&Options::samples>("samples", "A number.", {.min = 1, .max = 100})};

TEST(Parameters, BelongToTheStructOfTheirOwnFile) {
    EXPECT_EQ(Settings(kParameters).as<Options>().samples, 3);
    Settings settings(kParameters);
    settings.set("samples", "7");
    EXPECT_EQ(settings.as<Options>().samples, 7);

    const KnownScene known = known_scene("penumbra_of_half_plane");
    const SceneFacts facts = find_facts(known.scene);
    for (const char* text : {"ray_traced:samples=7", "brute_force:samples=7"}) {
        const Service service = parse_method(text).make()->serves(facts);
        EXPECT_NE(service.why.find(" 7 "), std::string::npos) << text << ": " << service.why;
    }
}

TEST(Parameters, RangesIncludeTheirEndsAndNothingBeyond) {
    for (const char* inside : {"1", "100"}) EXPECT_NO_THROW(Settings(kParameters).set("samples", inside)) << inside;
    for (const char* beyond : {"0", "101", "-1", "100000"})
        EXPECT_THROW(Settings(kParameters).set("samples", beyond), UsageError) << beyond;
}

TEST(Parameters, BooleansAreReadAsTheyArePrinted) {
    const Parameter parameter{.name = "bilinear", .doc = "", .max = 1, .type = Parameter::Type::boolean};
    EXPECT_EQ(parameter.text(1), "true");
    EXPECT_EQ(parameter.text(0), "false");
    EXPECT_EQ(parameter.parse("true"), 1);
    EXPECT_EQ(parameter.parse("false"), 0);
}

}  // namespace
}  // namespace umbra
