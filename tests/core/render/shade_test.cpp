#include "umbra/core/render/shade.h"

#include <gtest/gtest.h>

#include <cmath>

#include "umbra/core/base/parallel.h"

namespace umbra {
namespace {

/// One large triangle in the plane y = 0, normal +y, under lights that are handed in; surface points placed by hand.
struct Table {
    Scene scene;
    PointBatch points;
    std::vector<VisibilityPlane> planes;

    explicit Table(const Material& material, std::vector<Light> lights, vec3 eye = {0, 3, 4}) {
        scene.materials = {material};
        scene.lights    = std::move(lights);
        scene.ambient   = vec3(0);
        // The origin is at u = v = 1/3.
        add_object(scene, "floor", {{-30, 0, 30}, {30, 0, 30}, {0, 0, -60}}, {}, {{0, 1, 2}}, 0);
        points.eye = eye;
        points.resize(0);
    }
    /// Adds a point of the floor by its barycentrics and S_j = s for every light.
    void add(float u, float v, float s = 1) {
        const std::size_t i = points.size();
        points.resize(i + 1);
        set_point(points, i, scene, 0, u, v);
        planes.resize(scene.lights.size());
        for (VisibilityPlane& plane : planes) {
            plane.s.push_back(s);
            plane.answer.push_back(Answer::given);
            plane.half_width.push_back(0);
        }
    }
    Image shaded() {
        Camera camera;
        camera.eye    = points.eye;
        camera.target = vec3(0);
        points.raster = frame(camera, int(points.size()), 1);
        face_lights(points, scene);
        return shade(scene, points, planes);
    }
};

/// With random S_j, some of them the same in both.
TEST(Shade, FromAKnownPictureIsTheSamePicture) {
    Light first, second;
    first.kind = second.kind = LightKind::point;
    first.position = {1, 3, 2}, second.position = {-2, 2, 1};
    Material material;
    material.k_s = vec3(0.4f);
    Table known(material, {first, second});
    for (int i = 0; i < 200; ++i) known.add(0.2f + 0.002f * float(i), 0.3f, 0.25f * float(i % 5));
    Table other         = known;
    const Image picture = known.shaded();
    std::uint32_t seed  = 7;
    const auto random   = [&] { return (seed = seed * 1664525u + 1013904223u) >> 24; };
    for (std::size_t i = 0; i < 200; ++i)
        for (VisibilityPlane& plane : other.planes) {
            if (random() < 64) plane.s[i] = float(random()) / 255;
            if (random() < 32) plane.answer[i] = Answer::undefined;
        }
    const Image whole = other.shaded();
    EXPECT_NE(whole.data, picture.data);
    EXPECT_EQ(shade(other.scene, other.points, other.planes, known.planes, picture).data, whole.data);
    // Where S_j is the same, the known picture counts: it is not evaluated again.
    Image grey = picture;
    std::fill(grey.data.begin(), grey.data.end(), 0.5f);
    EXPECT_EQ(shade(other.scene, other.points, known.planes, known.planes, grey).data, grey.data);
    Table coloured = other;
    for (VisibilityPlane& plane : coloured.planes) plane.colour.assign(plane.s.size(), vec3(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(shade(other.scene, other.points, coloured.planes, other.planes, whole).data, coloured.shaded().data);
    Table tinted = coloured;  // S_j is the same, its colour is not
    for (VisibilityPlane& plane : tinted.planes) plane.colour[7] = vec3(0.125f, 0.25f, 0.5f);
    EXPECT_NE(tinted.shaded().data, coloured.shaded().data);
    EXPECT_EQ(shade(other.scene, other.points, tinted.planes, coloured.planes, coloured.shaded()).data,
              tinted.shaded().data);
}

vec3 rgb(const Image& image, std::size_t i) { return {image.at(i, 0), image.at(i, 1), image.at(i, 2)}; }

Light point_light(vec3 position) {
    Light light;
    light.name     = "lamp";
    light.kind     = LightKind::point;
    light.position = position;
    return light;
}

Material glossy(float shininess, Lobe lobe = Lobe::phong) {
    Material m;
    m.k_a       = vec3(0);
    m.k_d       = vec3(0);
    m.k_s       = vec3(1);
    m.shininess = shininess;
    m.lobe      = lobe;
    return m;
}

/// Angle of the view away from the mirror direction at which the highlight has fallen to one half: the light is
/// 30 degrees from the normal, the eye is turned in the plane of the two.
double half_width(Lobe lobe, float shininess) {
    const auto radiance = [&](double degrees) {
        const double e = (30 + degrees) * kPi / 180;
        const double l = 30 * kPi / 180;
        Light light    = point_light(vec3(float(-std::sin(l)), float(std::cos(l)), 0) * 5.0f);
        Table table(glossy(shininess, lobe), {light}, vec3(float(std::sin(e)), float(std::cos(e)), 0) * 5.0f);
        table.add(1.0f / 3, 1.0f / 3);
        return double(table.shaded().at(0, 0));
    };
    double low = 0, high = 59;
    for (int k = 0; k < 40; ++k) {
        const double middle                   = 0.5 * (low + high);
        (radiance(middle) > 0.5 ? low : high) = middle;
    }
    return low;
}

TEST(Shade, EqualsTheSumByHand) {
    Material m;
    m.k_a       = vec3(0.1f, 0.2f, 0.3f);
    m.k_d       = vec3(0.5f);
    m.k_s       = vec3(0.25f);
    m.O_d       = vec3(1, 0.5f, 0.25f);
    m.O_s       = vec3(1, 1, 0.5f);
    m.emission  = vec3(0.01f, 0.02f, 0.03f);
    m.shininess = 2;

    Light light       = point_light({0, 4, 3});  // d = 5, N.L = 0.8
    light.diffuse     = vec3(2, 1, 1);
    light.specular    = vec3(1, 2, 1);
    light.ambient     = vec3(0, 0, 1);
    light.attenuation = {.c1 = 0, .c2 = 0, .c3 = 0.08f, .clamp = true};  // 1 / 2

    // R = 2 (N.L) N - L = (0, 0.8, -0.6); the eye straight above: V = N, R.V = 0.8, (R.V)^2 = 0.64
    Table table(m, {light}, {0, 10, 0});
    table.scene.ambient = vec3(1, 1, 0);
    table.add(1.0f / 3, 1.0f / 3, 0.5f);
    const vec3 got = rgb(table.shaded(), 0);
    EXPECT_NEAR(got.r, 0.01 + 1 * 0.1 * 1 + 0.5 * 0.5 * (2 * 0.5 * 1 * 0.8 + 1 * 0.25 * 1 * 0.64), 1e-6);
    EXPECT_NEAR(got.g, 0.02 + 1 * 0.2 * 0.5 + 0.5 * 0.5 * (1 * 0.5 * 0.5 * 0.8 + 2 * 0.25 * 1 * 0.64), 1e-6);
    EXPECT_NEAR(got.b, 0.03 + 1 * 0.3 * 0.25 + 0.5 * 0.5 * (1 * 0.5 * 0.25 * 0.8 + 1 * 0.25 * 0.5 * 0.64), 1e-6);
}

TEST(Shade, BlinnPhongByHand) {
    // L at 60 degrees on one side, V along the normal: H is at 30 degrees, (N.H)^3 = (sqrt(3)/2)^3
    const float s = std::sqrt(3.0f) / 2;
    Table table(glossy(3, Lobe::blinn_phong), {point_light(vec3(s, 0.5f, 0) * 8.0f)}, {0, 7, 0});
    table.add(1.0f / 3, 1.0f / 3);
    EXPECT_NEAR(table.shaded().at(0, 0), 0.6495190528, 1e-6);
}

TEST(Shade, BlinnPhongNeedsFourTimesTheExponent) {
    // N.H makes half the angle of R.V: cos^n(a) = cos^m(a / 2) where m is near 4 n for small a.
    for (const float n : {50.0f, 200.0f, 1000.0f}) {
        const double phong = half_width(Lobe::phong, n);
        EXPECT_GT(half_width(Lobe::blinn_phong, n), 1.9 * phong) << n;
        EXPECT_NEAR(half_width(Lobe::blinn_phong, 4 * n) / phong, 1, 0.01) << n;
    }
}

TEST(Shade, AmbientAndEmissionStayInTheUmbra) {
    Material m;
    m.k_a      = vec3(0.3f);
    m.emission = vec3(0, 0.25f, 0);
    m.k_s      = vec3(1);
    Table table(m, {point_light({0, 4, 0})});
    table.scene.ambient           = vec3(0.5f);
    table.scene.lights[0].ambient = vec3(0.5f, 0, 0);  // a light's own ambient is not blocked either
    table.add(1.0f / 3, 1.0f / 3, 0);
    EXPECT_EQ(rgb(table.shaded(), 0), vec3(0.3f, 0.4f, 0.15f));
}

TEST(Shade, LightsSuperpose) {
    Material m  = glossy(20);
    m.k_d       = vec3(0.7f);
    Light left  = point_light({-3, 2, 1});
    Light right = point_light({4, 3, -2});
    Light sun;
    sun.kind      = LightKind::directional;
    sun.direction = {1, -2, 0.5f};
    vec3 sum(0);
    for (const Light& light : {left, right, sun}) {
        Table table(m, {light});
        table.add(0.3f, 0.35f, 0.75f);
        sum += rgb(table.shaded(), 0);
    }
    Table table(m, {left, right, sun});
    table.add(0.3f, 0.35f, 0.75f);
    const vec3 together = rgb(table.shaded(), 0);
    EXPECT_GT(together.r, 0.5f);
    EXPECT_NEAR(together.r, sum.r, 1e-6f);
}

TEST(Shade, LightBehindThePlaneGivesNothingWhateverTheVertexNormalsSay) {
    Table table(glossy(1), {point_light({9, -1, 0})});
    table.scene.materials[0].k_d = vec3(1);
    const vec3 leaning           = glm::normalize(vec3(1, 0.1f, 0));  // N.L > 0
    table.scene.normals          = {leaning, leaning, leaning};
    table.add(1.0f / 3, 1.0f / 3, 1);  // a method that wrongly says "lit" changes nothing
    EXPECT_EQ(rgb(table.shaded(), 0), vec3(0));
}

/// The facet faces the light, the vertex normals do not: N.L < 0 does not make negative light.
TEST(Shade, NormalsThatFaceAwayTakeNoLightAway) {
    Table table(glossy(1), {point_light({9, 1, 0})});
    table.scene.materials[0].k_d      = vec3(1);
    table.scene.materials[0].emission = vec3(0.5f);
    const vec3 leaning                = glm::normalize(vec3(-1, 0.05f, 0));
    table.scene.normals               = {leaning, leaning, leaning};
    table.add(1.0f / 3, 1.0f / 3, 1);
    EXPECT_EQ(rgb(table.shaded(), 0), vec3(0.5f));
}

TEST(Shade, TwoSidedMaterialIsLitWhereTheEyeIs) {
    Material m;
    m.k_a = vec3(0);
    m.k_d = vec3(1);
    Table below(m, {point_light({0, -4, 0}), point_light({0, 4, 0})}, {0, -3, 0});
    below.scene.lights[1].diffuse = vec3(0, 0, 1);
    below.add(1.0f / 3, 1.0f / 3);
    EXPECT_EQ(rgb(below.shaded(), 0), vec3(1));  // the light below alone

    Table one_sided(m, {point_light({0, -4, 0}), point_light({0, 4, 0})}, {0, -3, 0});
    one_sided.scene.lights[1].diffuse      = vec3(0, 0, 1);
    one_sided.scene.materials[0].two_sided = false;
    one_sided.add(1.0f / 3, 1.0f / 3);
    EXPECT_EQ(rgb(one_sided.shaded(), 0), vec3(0, 0, 1));  // the light above alone
}

TEST(Shade, VertexNormalsAreInterpolatedAndTurnedToTheEye) {
    Material m;
    m.k_a = vec3(0);
    m.k_d = vec3(1);
    for (const float side : {1.0f, -1.0f}) {         // the eye and the light above, below
        for (const float written : {1.0f, -1.0f}) {  // normals written outwards, inwards
            Light sun;
            sun.kind      = LightKind::directional;
            sun.direction = {0, -side, 0};
            Table table(m, {sun}, {0, 3 * side, 0});
            // Two corners lean by 60 degrees to +x; the third has no normal and lends the face's.
            const vec3 leaning  = written * vec3(std::sqrt(3.0f) / 2, 0.5f, 0);
            table.scene.normals = {leaning, leaning, vec3(0)};
            table.add(0, 0);     // N = leaning: N.L = 0.5
            table.add(0, 1);     // N = face: N.L = 1
            table.add(0, 0.5f);  // N at 30 degrees
            const Image image = table.shaded();
            EXPECT_NEAR(image.at(0, 0), 0.5, 1e-6);
            EXPECT_NEAR(image.at(1, 0), 1, 1e-6);
            EXPECT_NEAR(image.at(2, 0), std::sqrt(3.0) / 2, 1e-6);
        }
    }
}

TEST(Shade, InfiniteViewerSeesOneDirection) {
    Light sun;
    sun.kind      = LightKind::directional;
    sun.direction = {0, -1, 0};
    for (const bool local : {true, false}) {
        Table table(glossy(5), {sun}, {0, 6, 0});
        table.scene.local_viewer = local;
        table.points.eye         = {0, 6, 0.001f};  // looks almost straight down
        table.add(1.0f / 3, 1.0f / 3);              // beneath the eye
        table.add(0.4f, 1.0f / 3);                  // p = (4, 0, -0) away from it
        const Image image = table.shaded();
        EXPECT_NEAR(image.at(0, 0), 1, 1e-5);
        if (local) {
            EXPECT_LT(image.at(1, 0), 0.8f);
        } else {
            EXPECT_NEAR(image.at(1, 0), 1, 1e-5);
        }
    }
}

TEST(Shade, UndefinedPointsCountAsLitAndBackgroundStays) {
    Material m;
    m.k_a = vec3(0);
    m.k_d = vec3(1);
    Table table(m, {point_light({0, 4, 0})});
    table.scene.background = vec3(0.1f, 0.2f, 0.3f);
    table.add(1.0f / 3, 1.0f / 3, 0);
    table.add(1.0f / 3, 1.0f / 3, 0);
    table.planes[0].answer[0] = Answer::undefined;
    table.points.triangle[1]  = kNoTriangle;
    const Image image         = table.shaded();
    EXPECT_NEAR(image.at(0, 0), 1, 1e-6);
    EXPECT_EQ(rgb(image, 1), vec3(0.1f, 0.2f, 0.3f));
}

TEST(Shade, HighlightNarrowsMonotonicallyUpToAMillion) {
    // 0.1 degrees off the mirror direction: cos^n falls with n, and matches exp(n log cos) in double.
    const double e = 0.1 * kPi / 180;
    const vec3 eye(float(5 * std::sin(e)), float(5 * std::cos(e)), 0);
    const double angle = std::atan2(double(eye.x), double(eye.y));
    float before       = 2;
    for (const float n : {0.0f, 1.0f, 1e2f, 1e4f, 1e5f, 1e6f}) {
        Table table(glossy(n), {point_light({0, 5, 0})}, eye);
        table.add(1.0f / 3, 1.0f / 3);
        table.points.px[0] = table.points.py[0] = table.points.pz[0] = 0;  // not where barycentrics round it to
        const float got                                              = table.shaded().at(0, 0);
        EXPECT_TRUE(std::isfinite(got));
        EXPECT_LE(got, before);
        EXPECT_NEAR(got, std::exp(double(n) * std::log(std::cos(angle))), 2e-6) << n;
        before = got;
    }
}

TEST(Shade, StaysFiniteAsAttenuationExplodes) {
    Material m;
    m.k_d        = vec3(1);
    float before = std::numeric_limits<float>::max();
    for (const float height : {0.0f, 1e-20f, 1e-6f, 1e-3f, 1.0f, 1e3f, 1e15f}) {
        Light light       = point_light({0, height, 0});
        light.attenuation = {.c1 = 0, .c2 = 0, .c3 = 1, .clamp = false};
        Table table(m, {light});
        table.scene.lights[0].diffuse = vec3(1e10f);
        table.add(1.0f / 3, 1.0f / 3);
        table.points.px[0] = table.points.pz[0] = 0;
        const float got                         = table.shaded().at(0, 0);
        EXPECT_TRUE(std::isfinite(got)) << height;
        if (height > 0) {
            EXPECT_LE(got, before) << height;
            before = got;
        }
    }
}

TEST(Shade, SameBitsForAnyNumberOfThreads) {
    Material m = glossy(30);
    m.k_d      = vec3(0.6f);
    Table table(m, {point_light({1, 4, 2}), point_light({-5, 2, 0})});
    for (int i = 0; i < 5000; ++i) table.add(float(i % 71) / 150, float(i % 89) / 200, float(i % 7) / 7);
    const Image many = table.shaded();
    const ThreadLimit one(1);
    EXPECT_EQ(many.data, table.shaded().data);
}

TEST(Shade, RefusesPlanesThatDoNotFit) {
    Table table(glossy(1), {point_light({0, 4, 0})});
    table.add(0.2f, 0.2f);
    table.planes[0].s.clear();
    EXPECT_THROW(table.shaded(), std::logic_error);
    table.planes.clear();
    EXPECT_THROW(table.shaded(), std::logic_error);
}

Image picture(std::vector<float> data) {
    Image image(int(data.size() / 3), 1, {"R", "G", "B"});
    image.data = std::move(data);
    return image;
}

TEST(Displayed, ClampCutsEachChannel) {
    const Image d = displayed(picture({0.5f, 2, 0, 0.25f, 1, -1}), ToneMap::clamp, 1);
    EXPECT_EQ(d.data, (std::vector<float>{srgb_from_linear(0.5f), 1, 0, srgb_from_linear(0.25f), 1, 0}));
    EXPECT_NEAR(d.data[0], 0.735357, 1e-6);
}

TEST(Displayed, DivideScalesTheImageByItsMaximum) {
    const Image d = displayed(picture({0.5f, 4, 0, 1, 1, 2}), ToneMap::divide, 1);
    EXPECT_NEAR(linear_from_srgb(d.data[0]), 0.125, 1e-6);
    EXPECT_EQ(d.data[1], 1);
    EXPECT_NEAR(linear_from_srgb(d.data[5]), 0.5, 1e-6);
    // Where nothing is above 1, nothing changes.
    EXPECT_EQ(displayed(picture({0.5f, 0.1f, 0}), ToneMap::divide, 1).data,
              displayed(picture({0.5f, 0.1f, 0}), ToneMap::clamp, 1).data);
}

TEST(Displayed, HueKeepsRatiosAndOrder) {
    float before = 0;
    for (const float scale : {0.1f, 0.4f, 0.8f, 1.0f, 3.0f, 100.0f, 1e6f}) {
        const Image d = displayed(picture({scale, 0.5f * scale, 0.25f * scale}), ToneMap::hue, 1);
        const float r = linear_from_srgb(d.data[0]);
        EXPECT_NEAR(linear_from_srgb(d.data[1]) / r, 0.5, 1e-4) << scale;
        EXPECT_NEAR(linear_from_srgb(d.data[2]) / r, 0.25, 1e-4) << scale;
        EXPECT_LE(r, 1.0f);
        EXPECT_GT(r, before);
        before = r;
    }
}

/// Above the knee at 0.8: 0.9 is t = 1/2 beyond it, and becomes 0.8 + 0.2 t / (1 + t).
TEST(Displayed, HueBendsAtItsKnee) {
    EXPECT_NEAR(displayed(picture({0.9f, 0.9f, 0.9f}), ToneMap::hue, 1).data[0], srgb_from_linear(0.8f + 0.2f / 3),
                1e-6);
    EXPECT_NEAR(displayed(picture({0.8f, 0.8f, 0.8f}), ToneMap::hue, 1).data[0], srgb_from_linear(0.8f), 1e-6);
}

TEST(Displayed, ExposureComesFirst) { EXPECT_EQ(displayed(picture({0.5f, 0.25f, 0}), ToneMap::clamp, 4).data[1], 1); }

TEST(Displayed, WhatIsNotFiniteIsShownAsBlackOrWhite) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const ToneMap tone : {ToneMap::clamp, ToneMap::divide, ToneMap::hue})
        EXPECT_EQ(displayed(picture({nan, kInfinity, -kInfinity}), tone, 1).data, (std::vector<float>{0, 1, 0}));
}

TEST(Srgb, EncodesAndDecodes) {
    EXPECT_NEAR(srgb_from_linear(0.18f), 0.461356, 1e-6);
    EXPECT_NEAR(srgb_from_linear(0.002f), 0.02584, 1e-6);
    EXPECT_NEAR(linear_from_srgb(0.5f), 0.214041, 1e-6);
    EXPECT_EQ(srgb_from_linear(-0.18f), -srgb_from_linear(0.18f));
    for (int i = 0; i <= 255; ++i) EXPECT_EQ(std::lround(255 * srgb_from_linear(linear_from_srgb(float(i) / 255))), i);
}

}  // namespace
}  // namespace umbra
