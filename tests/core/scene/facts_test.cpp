#include "umbra/core/scene/facts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>

#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

void add(Scene& scene, const std::string& name, const Mesh& mesh) {
    if (scene.materials.empty()) scene.materials.emplace_back();
    add_object(scene, name, mesh.positions, {}, mesh.triangles, 0);
}

Scene scene_of(const Mesh& mesh) {
    Scene scene;
    add(scene, "object", mesh);
    return scene;
}

ObjectFacts facts_of(const Mesh& mesh) { return find_facts(scene_of(mesh)).objects.at(0); }

Mesh moved(const Mesh& mesh, vec3 by) { return transformed(mesh, glm::translate(mat4(1), by)); }

const mat4 kSlanted = glm::rotate(glm::rotate(mat4(1), 0.7f, vec3(1, 2, -1) / std::sqrt(6.0f)), 0.3f, vec3(0, 1, 0));

TEST(ObjectFacts, BoxIsClosedAndOutward) {
    const ObjectFacts f = facts_of(make_box({1, 2, 3}));
    EXPECT_TRUE(f.closed);
    EXPECT_TRUE(f.outward);
    EXPECT_FALSE(f.planar);
    EXPECT_EQ(f.triangles, 12u);
    EXPECT_EQ(f.vertices, 8u);
    EXPECT_EQ(f.components, 1u);
    EXPECT_DOUBLE_EQ(f.area, 22);
    EXPECT_DOUBLE_EQ(f.volume, 6);
}

TEST(ObjectFacts, InsideOutBoxIsClosedButNotOutward) {
    Mesh box = make_box({1, 1, 1});
    for (uvec3& t : box.triangles) std::swap(t.y, t.z);
    const ObjectFacts f = facts_of(box);
    EXPECT_TRUE(f.closed);
    EXPECT_FALSE(f.outward);
    EXPECT_DOUBLE_EQ(f.volume, -1);
}

TEST(ObjectFacts, VolumeOfAFarBoxKeepsItsDigits) {
    const ObjectFacts f = facts_of(moved(make_box({1, 1, 1}), {1e6f, 1e6f, -1e6f}));
    EXPECT_NEAR(f.volume, 1, 1e-12);
}

TEST(ObjectFacts, EachFaultRaisesItsOwnCount) {
    const Mesh box = make_box({1, 1, 1});

    Mesh open = box;
    open.triangles.pop_back();
    EXPECT_EQ(facts_of(open).boundary_edges, 3u);
    EXPECT_FALSE(facts_of(open).closed);

    Mesh turned = box;
    std::swap(turned.triangles[0].x, turned.triangles[0].y);
    EXPECT_EQ(facts_of(turned).misoriented_edges, 3u);
    EXPECT_EQ(facts_of(turned).boundary_edges, 0u);
    EXPECT_FALSE(facts_of(turned).closed);

    Mesh doubled      = box;
    const uvec3 third = box.triangles[3];
    doubled.triangles.push_back({third.z, third.x, third.y});
    EXPECT_EQ(facts_of(doubled).duplicate_triangles, 1u);
    EXPECT_EQ(facts_of(doubled).nonmanifold_edges, 3u);
    EXPECT_EQ(facts_of(doubled).nonmanifold_vertices, 0u);
    EXPECT_FALSE(facts_of(doubled).closed);

    Mesh sliver = box;
    sliver.positions.push_back(0.5f * (box.positions[0] + box.positions[6]));
    sliver.triangles.push_back({0, 6, 8});
    EXPECT_EQ(facts_of(sliver).degenerate_triangles, 1u);
    EXPECT_FALSE(facts_of(sliver).closed);

    // Two boxes that touch in a corner: one part, closed edges, but one vertex with two fans.
    Mesh pair = box;
    for (const vec3& p : box.positions) pair.positions.push_back(p + vec3(1));
    for (const uvec3& t : box.triangles) pair.triangles.push_back(t + 8u);
    EXPECT_EQ(facts_of(pair).nonmanifold_vertices, 1u);
    EXPECT_EQ(facts_of(pair).components, 1u);
    EXPECT_EQ(facts_of(pair).vertices, 15u);
    EXPECT_FALSE(facts_of(pair).closed);
}

TEST(ObjectFacts, ThreeFacesOfOneEdgeAreOneFan) {
    const Mesh fan{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}}, {}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}};
    const ObjectFacts f = facts_of(fan);
    EXPECT_EQ(f.boundary_edges, 6u);
    EXPECT_EQ(f.nonmanifold_edges, 1u);
    EXPECT_EQ(f.nonmanifold_vertices, 0u);
}

TEST(Planes, BoxHasSixWhereverItStands) {
    for (const mat4& m : {mat4(1), kSlanted, glm::translate(kSlanted, vec3(100, 200, 300))}) {
        const SceneFacts facts = find_facts(scene_of(transformed(make_box({1, 1, 1}), m)));
        ASSERT_EQ(facts.planes.size(), 6u);
        EXPECT_NEAR(facts.planar_area_share, 1, 1e-6);
        for (const PlanarReceiver& p : facts.planes) EXPECT_EQ(p.triangles.size(), 2u);
    }
}

TEST(Planes, FloorOfManySmallTrianglesIsOneWhereverItStands) {
    for (const mat4& m : {mat4(1), kSlanted, glm::translate(kSlanted, vec3(3, 40, -5))}) {
        const Scene scene      = scene_of(transformed(make_plane(10, 10, 150), m));
        const SceneFacts facts = find_facts(scene);
        ASSERT_EQ(facts.planes.size(), 1u);
        EXPECT_EQ(facts.planes[0].triangles.size(), scene.triangles.size());
        EXPECT_TRUE(facts.objects[0].planar);
        EXPECT_NEAR(facts.planes[0].area, 100, 1e-4);
        EXPECT_LT(facts.planes[0].tolerance, 2e-5);
        for (const TriangleId t : facts.planes[0].triangles)
            for (int k = 0; k < 3; ++k)
                EXPECT_LE(
                    std::abs(glm::dot(facts.planes[0].normal, dvec3(scene.vertex(t, k))) - facts.planes[0].offset),
                    facts.planes[0].tolerance * (1 + 1e-6) + 1e-13);
    }
}

TEST(Planes, AxisParallelFloorIsExact) {
    Scene scene = scene_of(moved(make_plane(10, 10, 20), {0, 0.1f, 0}));
    add(scene, "ball", moved(make_sphere(1, 32, 16), {0, 2, 0}));
    const SceneFacts facts = find_facts(scene);
    ASSERT_EQ(facts.planes.size(), 1u);
    EXPECT_EQ(facts.planes[0].normal, dvec3(0, 1, 0));
    EXPECT_EQ(facts.planes[0].offset, static_cast<double>(0.1f));
    EXPECT_EQ(facts.planes[0].tolerance, 0);
    EXPECT_TRUE(facts.planes[0].exact);
}

/// A floor of 10^12 and a triangle 0.001 above it, as small. A level floor is exact, whatever its size; of a sloping
/// one only the words can tell that rounding has taken the triangle for a part of it.
TEST(Planes, OfAnySizeHoldNothingThatLiesOffThemOrAreNotExact) {
    const Mesh small{{{0, 1e-3f, 0}, {1e-3f, 1e-3f, 0}, {0, 1e-3f, 1e-3f}}, {}, {{0, 1, 2}}};
    for (const float far : {1e4f, 1e8f, 1e12f, 1e15f}) {
        const Mesh level{{{-far, 0, -far}, {far, 0, -far}, {0, 0, far}}, {}, {{0, 2, 1}}};
        Scene scene = scene_of(level);
        add(scene, "small", small);
        const SceneFacts facts = find_facts(scene);
        ASSERT_EQ(facts.planes.size(), 1u) << far;
        EXPECT_EQ(facts.planes[0].triangles, std::vector<TriangleId>{0}) << far;
        EXPECT_TRUE(facts.planes[0].exact) << far;

        Mesh slope = level;
        for (vec3& x : slope.positions) x.y = x.x;
        Scene alone = scene_of(slope);
        EXPECT_TRUE(find_facts(alone).planes.at(0).exact) << far;
        add(alone, "small", small);
        const PlanarReceiver plane = find_facts(alone).planes.at(0);
        EXPECT_EQ(plane.exact, plane.triangles.size() == 1) << far;
        slope.positions[2].y = std::nextafter(slope.positions[2].x + 1, far);
        add(alone, "other", slope);
        for (const PlanarReceiver& p : find_facts(alone).planes) EXPECT_EQ(p.exact, p.triangles.size() == 1) << far;
    }
}

TEST(Planes, JoinsObjectsAndBothSides) {
    // A tile beside a tile, one of them wound the other way, and a third a hair's breadth higher.
    Mesh down = moved(make_plane(1, 1), {1, 0, 0});
    for (uvec3& t : down.triangles) std::swap(t.y, t.z);
    Scene scene;
    add(scene, "tile", make_plane(2, 2));
    add(scene, "beside, facing down", down);
    add(scene, "higher", moved(make_plane(1, 1), {0, 1e-6f, 0}));
    const SceneFacts facts = find_facts(scene);
    ASSERT_EQ(facts.planes.size(), 2u);
    EXPECT_EQ(facts.planes[0].triangles.size(), 4u);
    EXPECT_EQ(facts.planes[0].normal, dvec3(0, 1, 0));
    EXPECT_EQ(facts.planes[1].triangles.size(), 2u);
}

TEST(Planes, SlowlyCurvingSurfaceIsNotChained) {
    // A strip of a cylinder of radius 1000: neighbouring faces differ by 0.0006 degrees, the ends by 0.6 degrees.
    const int n = 1000, half = n / 2;
    Mesh strip;
    for (int i = 0; i <= n; ++i) {
        const double angle = 1e-5 * (i - half);
        for (const float z : {0.0f, 10.0f})
            strip.positions.push_back(
                {static_cast<float>(1000 * std::sin(angle)), static_cast<float>(1000 * (std::cos(angle) - 1)), z});
    }
    for (unsigned i = 0; i < n; ++i) {
        strip.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 2});
        strip.triangles.push_back({2 * i + 1, 2 * i + 3, 2 * i + 2});
    }
    const SceneFacts facts = find_facts(scene_of(strip));
    EXPECT_FALSE(facts.objects[0].planar);
    EXPECT_TRUE(facts.planes.empty()) << facts.planes[0].triangles.size() << " triangles in one plane";
}

TEST(Planes, ShareDecides) {
    Scene scene = scene_of(make_plane(10, 10));
    add(scene, "small tile", moved(make_plane(1, 1), {0, 1, 0}));
    EXPECT_EQ(find_planes(scene, 0.005).size(), 2u);
    EXPECT_EQ(find_planes(scene, 0.02).size(), 1u);
}

Light light_at(vec3 position) {
    Light light;
    light.position = position;
    return light;
}

LightPlace place(const Light& light, Projection projection = Projection::perspective) {
    Scene scene             = scene_of(make_box({1, 1, 1}));
    scene.camera.projection = projection;
    scene.lights.push_back(light);
    return find_facts(scene).lights.at(0).place;
}

TEST(LightPlaces, TheFourCases) {  // the camera is at (0, 1, 5) and looks at the origin
    EXPECT_EQ(place(light_at({0, 1, 5})), LightPlace::at_eye);
    EXPECT_EQ(place(light_at({0, 1, 0})), LightPlace::inside_view);
    EXPECT_EQ(place(light_at({0, 30, 0})), LightPlace::outside_view);
    EXPECT_EQ(place(light_at({0, 2, 10})), LightPlace::outside_view) << "behind the eye";
    Light sun;
    sun.kind = LightKind::directional;
    EXPECT_EQ(place(sun), LightPlace::at_infinity);
    sun.direction = {0, -1, -5};
    EXPECT_EQ(place(sun), LightPlace::at_infinity);
    EXPECT_EQ(place(sun, Projection::orthographic), LightPlace::at_eye);
}

TEST(EyeInside, ClosedObjectsOnly) {
    const auto inside = [](const Mesh& mesh, vec3 eye) {
        Scene scene      = scene_of(mesh);
        scene.camera.eye = eye;
        return find_facts(scene).eye_inside_closed_object;
    };
    const Mesh torus = make_torus(2, 0.5f, 32, 16);
    EXPECT_TRUE(inside(torus, {2, 0, 0}));
    EXPECT_FALSE(inside(torus, {0, 0, 0})) << "in the hole, inside the box";
    Mesh box = make_box({2, 2, 2});
    EXPECT_TRUE(inside(box, {0.5f, 0.25f, 0}));
    for (uvec3& t : box.triangles) std::swap(t.y, t.z);
    EXPECT_TRUE(inside(box, {0.5f, 0.25f, 0})) << "wound inwards";
    box.triangles.pop_back();
    EXPECT_FALSE(inside(box, {0.5f, 0.25f, 0})) << "not closed";
}

bool lists(const std::vector<std::string>& list, const std::string& what) {
    return std::any_of(list.begin(), list.end(), [&](const std::string& s) { return s.find(what) != s.npos; });
}

/// One property at a time: its trait is required with it and not required without it.
TEST(Lists, EachPropertyOfMaterialsAndLightsIsATrait) {
    Scene plain = scene_of(make_box({1, 1, 1}));
    plain.lights.push_back(light_at({0, 30, 0}));
    plain.lights[0].attenuation = {};
    const auto expect           = [&](const Scene& with, const std::string& trait) {
        EXPECT_TRUE(lists(not_required_list(find_facts(plain)), trait)) << trait;
        EXPECT_TRUE(lists(requires_list(find_facts(with)), trait)) << trait;
    };
    Scene scene                = plain;
    scene.materials[0].opacity = 0.5f;
    expect(scene, "transparency");
    scene                       = plain;
    scene.materials[0].transmit = 0.5f;
    expect(scene, "transparency");
    scene                      = plain;
    scene.materials[0].reflect = 0.5f;
    expect(scene, "mirrors");
    scene                       = plain;
    scene.materials[0].emission = vec3(0.5f);
    expect(scene, "emission");
    scene                        = plain;
    scene.materials[0].two_sided = false;
    expect(scene, "one-sided lighting");
    scene                     = plain;
    scene.materials[0].cutout = true;
    expect(scene, "outlines cut by a texture");
    scene         = plain;
    scene.fog.law = FogLaw::exponential;
    expect(scene, "fog");
    scene                      = plain;
    scene.lights[0].photometry = std::make_shared<const Photometry>();
    expect(scene, "goniometric lights");
    scene                       = plain;
    scene.lights[0].camera_pose = pose_of(scene.lights[0]);
    expect(scene, "lights fixed to the camera");
    scene                  = plain;
    scene.lights[0].except = {"box"};
    expect(scene, "lights that leave out objects");
    scene                   = plain;
    scene.light_ambient     = LightAmbient::attenuated;
    scene.lights[0].ambient = vec3(0.5f);
    expect(scene, "attenuated ambient terms of lights");
    scene                    = plain;
    scene.lights[0].specular = vec3(1);
    scene.materials[0].lobes.emplace_back();
    expect(scene, "Lafortune lobes");
    scene                 = plain;
    scene.lights[0].range = 5;
    expect(scene, "attenuation");
    scene                          = plain;
    scene.lights[0].attenuation.c2 = 1;
    expect(scene, "attenuation");
}

TEST(Lists, EveryTraitIsInOneOfThem) {
    Scene scene = scene_of(make_box({1, 1, 1}));
    scene.lights.push_back(light_at({0, 30, 0}));
    SceneFacts facts = find_facts(scene);
    EXPECT_TRUE(lists(requires_list(facts), "1 point light"));
    EXPECT_TRUE(lists(requires_list(facts), "6 planar receivers with 100 %"));
    EXPECT_TRUE(lists(requires_list(facts), "1 closed occluder"));
    EXPECT_TRUE(lists(requires_list(facts), "ambient"));
    for (const char* absent : {"specular", "emission", "penumbra", "attenuation", "mirrors", "directional lights"})
        EXPECT_TRUE(lists(not_required_list(facts), absent)) << absent;

    scene.materials[0].k_s = vec3(0.5f);
    scene.ambient          = vec3(0);
    scene.lights[0].kind   = LightKind::sphere;
    scene.lights[0].radius = 1;
    facts                  = find_facts(scene);
    for (const char* present : {"specular", "penumbra", "1 sphere light"})
        EXPECT_TRUE(lists(requires_list(facts), present)) << present;
    EXPECT_TRUE(lists(not_required_list(facts), "ambient"));
    scene.lights[0].specular = vec3(0);
    EXPECT_TRUE(lists(not_required_list(find_facts(scene)), "specular")) << "a material that no light makes shine";
}

TEST(Uncomputed, IsNamedByTermAndByMaterialInUse) {
    Scene scene = scene_of(make_box({1, 1, 1}));
    EXPECT_TRUE(find_facts(scene).uncomputed.empty());
    scene.materials.assign(6, scene.materials[0]);
    for (std::size_t m = 0; m < 6; ++m) {
        scene.materials[m].name    = std::string(1, static_cast<char>('a' + m));
        scene.materials[m].opacity = 0.5f;
    }
    scene.materials[0].index_of_refraction = 1.5f;
    const Mesh box                         = make_box({1, 1, 1});
    std::string words;
    for (std::uint32_t m = 1; m < 5; ++m) {
        const std::vector<UncomputedTerm> found = find_facts(scene).uncomputed;
        ASSERT_EQ(found.size(), 2u) << "materials that no triangle has ask for nothing";
        EXPECT_EQ(found[0].materials.size(), m);
        EXPECT_EQ(found[0].term, "opacity");
        EXPECT_EQ(found[1].term, "index_of_refraction");
        words += in_words(found[0]) + "\n";
        add_object(scene, "box", box.positions, box.normals, box.triangles, m);
    }
    EXPECT_EQ(words,
              "opacity of material \"a\"\n"
              "opacity of materials \"a\" and \"b\"\n"
              "opacity of materials \"a\", \"b\" and \"c\"\n"
              "opacity of materials \"a\", \"b\", \"c\" and 1 more\n");
}

/// Surfaces are drawn opaque whatever their shadows: the sentence says both.
TEST(Uncomputed, OpacitySaysWhatShadowsDo) {
    Scene scene;
    scene.materials.push_back({.name = "glass", .opacity = 0.99f});
    const Mesh box = make_box({1, 1, 1});
    add_object(scene, "box", box.positions, box.normals, box.triangles, 0);
    for (const auto& [transparent, words] :
         {std::pair{TransparentOccluders::ignore, "They throw no shadow"},
          {TransparentOccluders::block, "They throw full shadows"},
          {TransparentOccluders::multiply, "Their shadows let through what they do"}}) {
        scene.transparent = transparent;
        const auto found  = find_uncomputed(scene);
        ASSERT_EQ(found.size(), 1u);
        EXPECT_TRUE(found[0].consequence.starts_with("surfaces are drawn opaque")) << found[0].consequence;
        EXPECT_NE(found[0].consequence.find(words), std::string_view::npos) << found[0].consequence;
    }
}

}  // namespace
}  // namespace umbra
