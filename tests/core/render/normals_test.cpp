// Normals that are not of unit length, and normals under transforms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "umbra/bench/studies/light/shading_models.h"
#include "umbra/core/io/scene_io.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/render/shade.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

/// Diffuse light from infinity is linear in the normal. So the sum with the interpolated normal, its length left as it
/// is, is the sum at the corners, interpolated: Gouraud shading. Phong shading makes it unit, and is brighter.
TEST(Normals, NotNormalisedAreGouraudForDiffuseLightFromInfinity) {
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].k_a = vec3(0), scene.materials[0].k_d = vec3(0.5f, 1, 0.25f);
    Light sun;
    sun.name = "sun", sun.kind = LightKind::directional, sun.direction = {0.3f, -1, 0.1f};
    scene.lights.push_back(sun);
    const std::vector<vec3> normals{glm::normalize(vec3(-1, 1, 0)), glm::normalize(vec3(2, 1.5f, 0)),
                                    glm::normalize(vec3(0, 1, -1))};
    add_object(scene, "sheet", {{-2, 0, 1}, {2, 0, 1}, {0, 0, -3}}, normals, {{0, 1, 2}}, 0);
    scene.camera.eye = {0, 1.5f, 3}, scene.camera.target = {0, 0, -1};
    const PointBatch points = primary_points(RayScene(scene), scene, scene.camera, 64, 48);
    const auto all_lit      = [](const PointBatch& at) {
        std::vector<VisibilityPlane> planes(1, VisibilityPlane(at.size()));
        planes[0].s.assign(at.size(), 1.0f);
        return planes;
    };
    PointBatch faced = points;
    face_lights(faced, scene);
    const Image gouraud = shade_by(ShadingModel::gouraud, scene, faced, all_lit).linear;
    const Image phong   = shade_by(ShadingModel::phong, scene, faced, all_lit).linear;
    const dvec3 l       = -glm::normalize(dvec3(sun.direction));
    double brighter     = 0;
    std::size_t shown   = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points.triangle[i] == kNoTriangle) continue;
        ++shown;
        const double u = points.u[i], v = points.v[i];
        const dvec3 n = (1 - u - v) * dvec3(normals[0]) + u * dvec3(normals[1]) + v * dvec3(normals[2]);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(gouraud.at(i, c),
                        static_cast<double>(scene.materials[0].k_d[static_cast<int>(c)]) * glm::dot(n, l), 1e-6);
        brighter = std::max(brighter, static_cast<double>(phong.at(i, 1)) - static_cast<double>(gouraud.at(i, 1)));
    }
    EXPECT_GT(shown, 500u);
    EXPECT_GT(brighter, 0.2);
}

/// A normal in OpenGL under a modelview matrix: the inverse transpose, then one of two lengths.
struct OpenGlNormal {
    dvec3 normalize;  ///< GL_NORMALIZE: of unit length
    dvec3 rescale;    ///< GL_RESCALE_NORMAL: over the length of the third row of the matrix' inverse
};
OpenGlNormal open_gl_normal(const dmat3& m, dvec3 n) {
    const dmat3 inverse = glm::inverse(m);
    const dvec3 turned  = glm::transpose(inverse) * n;
    const dvec3 row(inverse[0][2], inverse[1][2], inverse[2][2]);
    return {glm::normalize(turned), turned / glm::length(row)};
}

/// The largest |rescale - normalize| over a sphere's normals. Checks that objects of scenes get the normals of
/// GL_NORMALIZE.
double largest_difference(const mat4& m) {
    const Mesh sphere = make_sphere(1, 24, 12), moved = transformed(sphere, m);
    double largest = 0;
    for (std::size_t i = 0; i < sphere.normals.size(); ++i) {
        const OpenGlNormal n = open_gl_normal(dmat3(m), dvec3(sphere.normals[i]));
        EXPECT_LT(glm::distance(n.normalize, dvec3(moved.normals[i])), 1e-5);
        largest = std::max(largest, glm::distance(n.normalize, n.rescale));
    }
    return largest;
}

TEST(Normals, RescalingIsNormalisingForEvenScaleAlone) {
    const mat4 turn = glm::rotate(mat4(1), 0.7f, glm::normalize(vec3(1, 2, 3)));
    EXPECT_LT(largest_difference(turn), 1e-6);
    EXPECT_LT(largest_difference(turn * glm::scale(mat4(1), vec3(3))), 1e-6);
    EXPECT_LT(largest_difference(glm::scale(mat4(1), vec3(0.25f)) * turn), 1e-6);
    // Stretched by 3 along z: normals along x or y come out three times as long, and their faces as bright.
    EXPECT_NEAR(largest_difference(glm::scale(mat4(1), vec3(1, 1, 3))), 2, 1e-5);
    EXPECT_GT(largest_difference(turn * glm::scale(mat4(1), vec3(1, 3, 0.25f))), 0.5);
}

/// The scene's bodies are spheres with even and uneven scales: ellipsoids, whose normals a formula gives.
TEST(Normals, OfTheUnevenlyScaledScene) {
    const Scene scene  = load_scene(std::string(UMBRA_SCENES) + "/uneven_scale.json");
    std::size_t uneven = 0;
    for (const Object& object : scene.objects) {
        if (object.name == "ground") continue;
        Box box;
        for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
            for (int k = 0; k < 3; ++k) box = extend(box, scene.vertex(t, k));
        const dvec3 centre(box.centre()), radii = 0.5 * dvec3(box.size());
        uneven += radii.x > 1.5 * radii.y || radii.y > 1.5 * radii.x;
        for (TriangleId t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
            for (int k = 0; k < 3; ++k) {
                const dvec3 gradient = (dvec3(scene.vertex(t, k)) - centre) / (radii * radii);
                const dvec3 normal(scene.normals[scene.triangles[t][k]]);
                EXPECT_GT(glm::dot(glm::normalize(gradient), normal), 1 - 1e-5) << object.name;
            }
    }
    EXPECT_EQ(uneven, 2u);
}

}  // namespace
}  // namespace umbra
