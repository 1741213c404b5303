// The tables of names: complete, without repetition, and the names that scene files have always had.
#include "umbra/core/scene/names.h"

#include <gtest/gtest.h>

#include <set>

namespace umbra {
namespace {

template <class Enum>
void expect_table(const std::vector<std::string_view>& names) {
    std::set<std::string_view> different;
    std::vector<std::string_view> found;
    for (const Enum value : values_of<Enum>()) {
        found.push_back(name_of(value));
        different.insert(name_of(value));
    }
    EXPECT_EQ(found, names);
    EXPECT_EQ(different.size(), names.size());
}

TEST(Names, TablesHoldWhatSceneFilesWrite) {
    expect_table<LightKind>({"directional", "point", "spot", "rectangle", "disk", "sphere"});
    expect_table<SpotFalloff>({"cosine", "zachmann", "smooth"});
    expect_table<Lobe>({"phong", "blinn_phong"});
    expect_table<ToneMap>({"clamp", "divide", "hue"});
    expect_table<Viewer>({"local", "infinite"});
    expect_table<FogLaw>({"none", "linear", "exponential", "exponential_squared"});
    expect_table<FogDistance>({"radial", "depth"});
    expect_table<LightAmbient>({"constant", "attenuated"});
    expect_table<SpecularColour>({"O_s", "O_d"});
    expect_table<AmbientCoefficient>({"k_a", "k_d"});
    expect_table<PhotometricType>({"C", "B", "A"});
    expect_table<FixedTo>({"scene", "camera"});
    expect_table<Projection>({"perspective", "orthographic"});
}

TEST(Names, EachValueHasItsOwn) {
    EXPECT_EQ(name_of(LightKind::disk), "disk");
    EXPECT_EQ(to_string(LightKind::sphere), "sphere");
    EXPECT_EQ(name_of(SpotFalloff::zachmann), "zachmann");
    EXPECT_EQ(name_of(Lobe::blinn_phong), "blinn_phong");
    EXPECT_EQ(name_of(ToneMap::hue), "hue");
    EXPECT_EQ(name_of(Viewer::infinite), "infinite");
}

}  // namespace
}  // namespace umbra
