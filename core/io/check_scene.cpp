// The checks that scenes of all formats pass, whatever their readers checked before.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/check_camera.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/io/vector_text.h"

namespace umbra {
namespace {

using std::filesystem::path;

[[noreturn]] void refuse(const path& file, std::string_view what) {
    throw InputError(fmt::format("{}: {}", file.string(), what));
}

bool is_finite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool holds(const Range& range, vec3 v) { return range.holds(v.x) && range.holds(v.y) && range.holds(v.z); }
/// Checks of one thing's terms, which messages name: "FILE: WHOSE: WHICH is X, expected ...".
class Terms {
public:
    Terms(const path& file, std::string whose) : file_(file), whose_(std::move(whose)) {}

    [[noreturn]] void fail(std::string_view what) const { refuse(file_, fmt::format("{}: {}", whose_, what)); }
    void number(std::string_view which, float x, const Range& range) const {
        if (!range.holds(x)) fail(fmt::format("{} is {:g}, expected {}", which, x, range.words));
    }
    void vector(std::string_view which, vec3 v, const Range& range) const {
        if (!holds(range, v))
            fail(fmt::format("{} is {}, expected of each component {}", which, vector_text(v), range.words));
    }
    void direction(std::string_view which, vec3 d) const {
        if (!is_finite(d) || d == vec3(0))
            fail(fmt::format("{} is {}, expected a finite vector other than 0", which, vector_text(d)));
    }

private:
    const path& file_;
    std::string whose_;
};

void check_geometry(const Scene& scene, const path& file) {
    if (scene.triangles.size() > kMaxTriangles)
        refuse(file, fmt::format("{} triangles, expected at most {}", scene.triangles.size(), kMaxTriangles));
    for (const vec3 p : scene.positions)
        if (!holds(kAnyNumber, p))
            refuse(file,
                   fmt::format("a vertex at {}, expected of each coordinate {}", vector_text(p), kAnyNumber.words));
    if (scene.normals.size() != scene.positions.size())
        throw std::logic_error("check_scene: one normal a position is expected");
    for (const vec3 n : scene.normals)
        if (!is_finite(n)) refuse(file, fmt::format("a vertex normal {}, expected finite numbers", vector_text(n)));
    for (const uvec3& t : scene.triangles)
        if (std::max({t.x, t.y, t.z}) >= scene.positions.size())
            refuse(file, fmt::format("a triangle of the vertices {}, {}, {} (there are {}, counted from 0)", t.x, t.y,
                                     t.z, scene.positions.size()));
    for (const Object& o : scene.objects)
        if (o.material >= scene.materials.size())
            throw std::logic_error("check_scene: object " + o.name + " has no material");
}

// Colours are bounded like coordinates, so that products of two of them stay finite.
void check_material(const Material& m, const path& file) {
    const Terms terms(file, fmt::format("material \"{}\"", m.name));
    terms.vector("k_a", m.k_a, kNotNegative);
    terms.vector("k_d", m.k_d, kNotNegative);
    terms.vector("k_s", m.k_s, kNotNegative);
    terms.vector("O_d", m.O_d, kNotNegative);
    terms.vector("O_s", m.O_s, kNotNegative);
    terms.vector("emission", m.emission, kNotNegative);
    terms.number("opacity", m.opacity, kShare);
    terms.number("reflect", m.reflect, kShare);
    terms.number("transmit", m.transmit, kShare);
    terms.vector("transmit_colour", m.transmit_colour, kShare);
    terms.number("shininess", m.shininess, kNotNegative);
    terms.number("index_of_refraction", m.index_of_refraction, kPositive);
    for (const LafortuneLobe& lobe : m.lobes) {
        for (const vec3 row : lobe.rows) terms.vector("a row of C", row, kAnyNumber);
        terms.vector("k_s of a lobe", lobe.k_s, kNotNegative);
        terms.number("shininess of a lobe", lobe.shininess, kNotNegative);
    }
    if (!m.lobes.empty()) terms.direction("tangent", m.tangent);
}

void check_spot(const Spot& s, const Terms& terms) {
    constexpr double kDegrees = 180 / kPi;
    if (!kConeAngleRadians.holds(s.cutoff))
        terms.fail(fmt::format("the cone's half angle is {:g} degrees, expected {}", double(s.cutoff) * kDegrees,
                               kConeAngle.words));
    if (s.falloff == SpotFalloff::smooth && !(s.inner >= 0 && s.inner <= s.cutoff))
        terms.fail(
            fmt::format("the inner half angle is {:g} degrees, the outer one {:g}, expected an inner angle of at "
                        "least 0 and at most the outer one",
                        double(s.inner) * kDegrees, double(s.cutoff) * kDegrees));
    terms.number("exponent", s.exponent, kNotNegative);
}

void check_photometry(const Light& light, const Terms& terms) {
    if (const std::string fault = fault_of(*light.photometry); !fault.empty()) terms.fail(fault);
    terms.direction("direction", light.direction);
    terms.direction("along", light.along);
    if (glm::cross(dvec3(light.direction), dvec3(light.along)) == dvec3(0))
        terms.fail("along is parallel to the light's direction");
}

void check_light(const Light& light, const path& file) {
    const Terms terms(file, fmt::format("light \"{}\"", light.name));
    terms.vector("ambient", light.ambient, kNotNegative);
    terms.vector("diffuse", light.diffuse, kNotNegative);
    terms.vector("specular", light.specular, kNotNegative);
    terms.vector("position", light.position, kAnyNumber);
    const vec3 attenuation(light.attenuation.c1, light.attenuation.c2, light.attenuation.c3);
    terms.vector("attenuation", attenuation, kNotNegative);
    if (attenuation == vec3(0))
        terms.fail("attenuation is (0, 0, 0), which divides by zero, expected at least one number above 0");
    terms.number("range", light.range, kNotNegative);

    switch (light.kind) {
        case LightKind::point:
            if (light.photometry) check_photometry(light, terms);
            break;
        case LightKind::directional: terms.direction("direction", light.direction); break;
        case LightKind::spot:
            terms.direction("direction", light.direction);
            check_spot(light.spot, terms);
            break;
        case LightKind::rectangle: {
            terms.vector("edge_u", light.edge_u, kAnyNumber);
            terms.vector("edge_v", light.edge_v, kAnyNumber);
            const vec3 normal(glm::cross(dvec3(light.edge_u), dvec3(light.edge_v)));
            if (!is_finite(normal) || normal == vec3(0)) terms.fail("its edges span no area");
            break;
        }
        case LightKind::disk: terms.direction("direction", light.direction); [[fallthrough]];
        case LightKind::sphere: terms.number("radius", light.radius, kPositive); break;
    }
}

}  // namespace

void check_camera(const Scene& scene, const path& file) {
    const Camera& c = scene.camera;
    const Terms terms(file, "camera");
    terms.vector("eye", c.eye, kAnyNumber);
    terms.vector("target", c.target, kAnyNumber);
    terms.vector("up", c.up, kAnyNumber);
    const dvec3 view = dvec3(c.target) - dvec3(c.eye);
    if (view == dvec3(0)) terms.fail(fmt::format("eye and target are the same point {}", vector_text(c.eye)));
    if (c.up == vec3(0)) terms.fail("up is (0, 0, 0), expected a direction");
    // Nearer than some 1e-6 radians the picture's turn about its axis would be rounding noise.
    if (glm::length(glm::cross(glm::normalize(view), glm::normalize(dvec3(c.up)))) < 1e-6)
        terms.fail(
            fmt::format("up {} is parallel to the view direction {}", vector_text(c.up), vector_text(vec3(view))));
    if (c.projection == Projection::perspective) terms.number("fov", c.fov_y, kFieldOfView);
    if (c.projection == Projection::orthographic) terms.number("height", c.height, kPositive);
    if (scene.width < 1 || scene.height < 1 || scene.width > kMaxPictureSide || scene.height > kMaxPictureSide)
        terms.fail(
            fmt::format("the picture is {} x {}, expected 1 to {} each", scene.width, scene.height, kMaxPictureSide));
}

void check_scene(const SceneFile& read, const path& file) {
    const Scene& scene = read.scene;
    check_geometry(scene, file);
    for (const Material& m : scene.materials) check_material(m, file);
    const Terms terms(file, "scene");
    terms.vector("ambient", scene.ambient, kNotNegative);
    terms.vector("background", scene.background, kNotNegative);
    terms.vector("fog", scene.fog.colour, kNotNegative);
    if (read.has_camera) check_camera(scene, file);
    if (scene.lights.size() > kMaxLights)
        refuse(file, fmt::format("{} lights, expected at most {}", scene.lights.size(), kMaxLights));
    for (const Light& light : scene.lights) check_light(light, file);
}

}  // namespace umbra
