// Objects added to a scene one by one: what they become, and how often memory grows.
#include "umbra/core/scene/scene.h"

#include <array>

#include <gtest/gtest.h>

namespace umbra {
namespace {

/// The lists of a scene double when they are full: as many moves as 20,000 has doublings (15), never one an object.
TEST(AddObject, MemoryGrowsByDoubling) {
    Scene scene;
    constexpr std::uint32_t kObjects = 20'000;
    std::size_t moves                = 0;
    for (std::uint32_t i = 0; i < kObjects; ++i) {
        const std::array capacities{scene.positions.capacity(), scene.normals.capacity(), scene.triangles.capacity(),
                                    scene.triangle_object.capacity(), scene.objects.capacity()};
        const std::uint32_t index =
            add_object(scene, "corner", {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)}, {}, {uvec3(0, 1, 2)}, 0);
        EXPECT_EQ(index, i);
        moves += capacities[0] != scene.positions.capacity();
        moves += capacities[1] != scene.normals.capacity();
        moves += capacities[2] != scene.triangles.capacity();
        moves += capacities[3] != scene.triangle_object.capacity();
        moves += capacities[4] != scene.objects.capacity();
    }
    EXPECT_LE(moves, std::size_t{5 * 20});
    ASSERT_EQ(scene.triangles.size(), kObjects);
    EXPECT_EQ(scene.triangles.back(), uvec3(3 * (kObjects - 1)) + uvec3(0, 1, 2));
    EXPECT_EQ(scene.triangle_object.back(), kObjects - 1);
}

}  // namespace
}  // namespace umbra
