// Reading any scene: the reader that the ending names, then the checks and defaults that all formats share.
#include "umbra/core/io/scene_io.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/base/predicates.h"
#include "umbra/core/io/scene_readers.h"

namespace umbra {
namespace {

using std::filesystem::path;

std::string lower_ending(const path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending;
}

[[noreturn]] void refuse(const path& file, std::string_view what) {
    throw InputError(fmt::format("{}: {}", file.string(), what));
}

bool is_finite(dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool in_range(dvec3 v) {
    return is_finite(v) && std::abs(v.x) <= kMaxCoordinate && std::abs(v.y) <= kMaxCoordinate &&
           std::abs(v.z) <= kMaxCoordinate;
}
std::string text(dvec3 v) { return fmt::format("({:g}, {:g}, {:g})", v.x, v.y, v.z); }

// Of length 1; zero stays zero. What has that length but for rounding is left alone, so that a scene that is written
// and read again keeps its bits.
vec3 unit(vec3 v) {
    const double square = glm::dot(dvec3(v), dvec3(v));
    if (std::abs(square - 1) <= 0x1p-22 || square == 0) return v;
    return vec3(dvec3(v) / std::sqrt(square));
}

void check_geometry(Scene& scene, const path& file) {
    if (scene.triangles.size() > kMaxTriangles)
        refuse(file, fmt::format("{} triangles (at most {} are read)", scene.triangles.size(), kMaxTriangles));
    for (const vec3 p : scene.positions)
        if (!in_range(p))
            refuse(file, fmt::format("a vertex at {} (finite coordinates of magnitude up to {:g} would be right)",
                                     text(p), kMaxCoordinate));
    if (scene.normals.size() != scene.positions.size())
        throw std::logic_error("finish_scene: one normal a position is expected");
    for (vec3& n : scene.normals) {
        if (!is_finite(n)) refuse(file, fmt::format("a vertex normal {} (finite numbers would be right)", text(n)));
        n = unit(n);  // zero stands for the face normal
    }
    for (const uvec3& t : scene.triangles)
        if (std::max({t.x, t.y, t.z}) >= scene.positions.size())
            refuse(file, fmt::format("a triangle of the vertices {}, {}, {} (there are {}, counted from 0)", t.x, t.y,
                                     t.z, scene.positions.size()));
    for (const Object& o : scene.objects)
        if (o.material >= scene.materials.size())
            throw std::logic_error("finish_scene: object " + o.name + " has no material");
}

// Whether the triangle has no area, exactly: its normal has no component along any axis. The largest one as computed
// is asked first, so that the exact predicate rarely has to leave its filter.
bool is_degenerate(const Scene& scene, TriangleId t) {
    const vec3 a = scene.vertex(t, 0), b = scene.vertex(t, 1), c = scene.vertex(t, 2);
    const dvec3 n   = glm::abs(glm::cross(dvec3(b) - dvec3(a), dvec3(c) - dvec3(a)));
    const int first = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
    for (int k = 0; k < 3; ++k) {
        vec3 axis{0};
        axis[(first + k) % 3] = 1;
        if (side_of_direction(a, b, c, axis) != 0) return false;
    }
    return true;
}

void warn_of_geometry(Scene& scene) {
    if (scene.triangles.empty()) {
        scene.warnings.push_back("The file has no triangles: the picture shows the background alone.");
        return;
    }
    TriangleId degenerate = 0;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t) degenerate += is_degenerate(scene, t);
    if (degenerate > 0)
        scene.warnings.push_back(
            fmt::format("{} of {} triangles have no area: they are kept, but are not seen and "
                        "block no light.",
                        degenerate, scene.triangles.size()));
}

void check_colour(const path& file, const std::string& whose, std::string_view which, vec3 c) {
    // Bounded like coordinates, so that products of two of them stay finite.
    if (!in_range(c) || glm::any(glm::lessThan(c, vec3(0))))
        refuse(file, fmt::format("{}: {} is {} (numbers of at least 0 would be right)", whose, which, text(c)));
}

void check_share(const path& file, const std::string& whose, std::string_view which, float x) {
    if (!(x >= 0 && x <= 1))
        refuse(file, fmt::format("{}: {} is {:g} (a number from 0 to 1 would be right)", whose, which, x));
}

void check_material(Scene& scene, const Material& m, const path& file) {
    const std::string whose = fmt::format("material \"{}\"", m.name);
    check_colour(file, whose, "k_a", m.k_a);
    check_colour(file, whose, "k_d", m.k_d);
    check_colour(file, whose, "k_s", m.k_s);
    check_colour(file, whose, "O_d", m.O_d);
    check_colour(file, whose, "O_s", m.O_s);
    check_colour(file, whose, "emission", m.emission);
    check_share(file, whose, "opacity", m.opacity);
    check_share(file, whose, "reflect", m.reflect);
    check_share(file, whose, "transmit", m.transmit);
    if (!(m.shininess >= 0 && std::isfinite(m.shininess)))
        refuse(file, fmt::format("{}: shininess is {:g} (a number of at least 0 would be right)", whose, m.shininess));
    if (!(m.index_of_refraction > 0 && std::isfinite(m.index_of_refraction)))
        refuse(file, fmt::format("{}: index_of_refraction is {:g} (a positive number would be right)", whose,
                                 m.index_of_refraction));
    if (const vec3 sum = m.k_d + m.k_s; std::max({sum.r, sum.g, sum.b}) > 1.00001f)
        scene.warnings.push_back(fmt::format("Material \"{}\" gives back more light than it gets: k_d + k_s is {:g}.",
                                             m.name, std::max({sum.r, sum.g, sum.b})));
}

// A direction whose largest component lies in [0.5, 1): scaled by a power of two, so that its rounding stays as it was
// and no square of it overflows or vanishes.
vec3 scaled_to_one(vec3 d) {
    int exponent = 0;
    std::frexp(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}), &exponent);
    return {std::ldexp(d.x, -exponent), std::ldexp(d.y, -exponent), std::ldexp(d.z, -exponent)};
}

void check_light(Light& light, const path& file) {
    const std::string whose = fmt::format("light \"{}\"", light.name);
    const auto fail         = [&](std::string_view what) { refuse(file, fmt::format("{}: {}", whose, what)); };

    check_colour(file, whose, "ambient", light.ambient);
    check_colour(file, whose, "diffuse", light.diffuse);
    check_colour(file, whose, "specular", light.specular);
    if (!in_range(light.position))
        fail(fmt::format("position is {} (finite numbers would be right)", text(light.position)));
    const auto [c1, c2, c3, clamp] = light.attenuation;
    if (!(c1 >= 0 && c2 >= 0 && c3 >= 0 && std::isfinite(c1) && std::isfinite(c2) && std::isfinite(c3)))
        fail(fmt::format("attenuation is {} (finite numbers of at least 0 would be right)", text({c1, c2, c3})));
    if (c1 == 0 && c2 == 0 && c3 == 0)
        fail("attenuation is (0, 0, 0), which divides by zero (at least one of the three above 0 would be right)");
    if (!(light.range >= 0 && std::isfinite(light.range)))
        fail(fmt::format("range is {:g} (a number of at least 0 would be right)", light.range));

    if (light.kind == LightKind::rectangle) {
        if (!in_range(light.edge_u) || !in_range(light.edge_v))
            fail(fmt::format("its edges are {} and {} (finite numbers would be right)", text(light.edge_u),
                             text(light.edge_v)));
        light.direction = vec3(glm::cross(dvec3(light.edge_u), dvec3(light.edge_v)));
        if (!is_finite(light.direction) || light.direction == vec3(0)) fail("its edges span no area");
    }
    if (light.kind != LightKind::point && light.kind != LightKind::sphere) {
        if (!is_finite(light.direction) || light.direction == vec3(0))
            fail(fmt::format("direction is {} (finite and not zero would be right)", text(light.direction)));
        light.direction = light.kind == LightKind::directional ? scaled_to_one(light.direction) : unit(light.direction);
    }
    if ((light.kind == LightKind::disk || light.kind == LightKind::sphere) &&
        !(light.radius > 0 && light.radius <= kMaxCoordinate))
        fail(fmt::format("radius is {:g} (a positive number would be right)", light.radius));
    if (light.kind == LightKind::spot) {
        const Spot& s = light.spot;
        if (!(s.cutoff > 0 && double(s.cutoff) <= kPi / 2 + 1e-6))
            fail(fmt::format("the cone's half angle is {:g} degrees (above 0, at most 90 would be right)",
                             double(s.cutoff) * 180 / kPi));
        if (s.falloff == SpotFalloff::smooth && !(s.inner >= 0 && s.inner < s.cutoff))
            fail(
                fmt::format("the inner half angle is {:g} degrees, the outer one {:g} (at least 0 and less than the "
                            "outer would be right)",
                            double(s.inner) * 180 / kPi, double(s.cutoff) * 180 / kPi));
        if (!(s.exponent >= 0 && std::isfinite(s.exponent)))
            fail(fmt::format("exponent is {:g} (a number of at least 0 would be right)", s.exponent));
    }
}

// Names become channels S.<name> of images, where a dot would open a layer, and parts of file names.
void name_lights(Scene& scene) {
    std::set<std::string> taken;
    for (Light& light : scene.lights) {
        std::string name;
        for (const char c : light.name) {
            const bool fits =
                (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
            if (fits || name.empty() || name.back() != '_') name += fits ? c : '_';
        }
        if (name.empty()) name = to_string(light.kind);
        std::string unique = name;
        for (int n = 2; !taken.insert(unique).second; ++n) unique = fmt::format("{}_{}", name, n);
        if (!light.name.empty() && unique != light.name)
            scene.warnings.push_back(
                fmt::format("Light \"{}\" is called {} in images and tables.", light.name, unique));
        light.name = unique;
    }
}

// From the front, a little from the right and from above, at the distance from which the bounding sphere fits.
void give_camera(Scene& scene) {
    Camera& camera = scene.camera;
    camera         = Camera{};
    camera.fov_y   = 40;
    const Box box  = bounds(scene);
    if (!box.empty()) {
        const dvec3 low(box.min), high(box.max);
        const double radius = std::max(glm::length(high - low) / 2, 1e-6 * glm::length(low + high) / 2 + 1e-12);
        const double aspect = double(scene.width) / double(scene.height);
        const double half_y = glm::radians(double(camera.fov_y)) / 2;
        const double half   = std::min(half_y, std::atan(std::tan(half_y) * aspect));
        const dvec3 towards = glm::normalize(dvec3(0.45, 0.5, 1));
        camera.target       = vec3((low + high) / 2.0);
        camera.eye          = vec3((low + high) / 2.0 + radius / std::sin(half) * towards);
    }
    scene.warnings.push_back(
        fmt::format("The file has no camera: one that shows the whole scene from the front is assumed "
                    "(eye {}, target {}, 40 degrees high).",
                    text(camera.eye), text(camera.target)));
}

void give_light(Scene& scene) {
    Light light;
    light.name      = "default";
    light.kind      = LightKind::directional;
    light.direction = {0.5f, -1.0f, -0.625f};
    scene.lights.push_back(light);
    scene.warnings.push_back(
        "The file has no light: a white one at infinity is assumed, from above on the left in front "
        "(direction (0.5, -1, -0.625), called \"default\").");
}

void check_camera(const Scene& scene, const path& file) {
    const Camera& c  = scene.camera;
    const dvec3 view = dvec3(c.target) - dvec3(c.eye);
    const auto fail  = [&](std::string_view what) { refuse(file, fmt::format("camera: {}", what)); };
    if (!in_range(c.eye) || !in_range(c.target) || !in_range(c.up)) fail("a coordinate is not finite or too large");
    if (view == dvec3(0)) fail(fmt::format("eye and target are the same point {}", text(c.eye)));
    if (c.up == vec3(0)) fail("up is (0, 0, 0)");
    // Nearer than some 1e-6 radians the picture's turn about its axis would be rounding noise.
    if (glm::length(glm::cross(glm::normalize(view), glm::normalize(dvec3(c.up)))) < 1e-6)
        fail(fmt::format("up {} is parallel to the view direction {}", text(c.up), text(view)));
    if (c.projection == Projection::perspective && !(c.fov_y > 0 && c.fov_y < 180))
        fail(fmt::format("fov is {:g} degrees (between 0 and 180 would be right)", c.fov_y));
    if (c.projection == Projection::orthographic && !(c.height > 0 && c.height <= kMaxCoordinate))
        fail(fmt::format("height is {:g} (a positive number would be right)", c.height));
    if (scene.width < 1 || scene.height < 1 || scene.width > kMaxPictureSide || scene.height > kMaxPictureSide)
        fail(fmt::format("the picture is {} x {} (1 to {} each would be right)", scene.width, scene.height,
                         kMaxPictureSide));
}

}  // namespace

SceneFile read_by_ending(const path& file, const std::vector<std::string_view>& endings) {
    const std::string ending = lower_ending(file);
    if (std::find(endings.begin(), endings.end(), ending) == endings.end())
        refuse(file, fmt::format("{} (known: {})",
                                 ending.empty() ? "no ending, so the format is not known"
                                                : fmt::format("unknown ending \"{}\"", ending),
                                 fmt::join(endings, " ")));
    if (ending == ".json") return read_native(file);
    if (ending == ".gltf" || ending == ".glb") return read_gltf(file);
    if (ending == ".obj") return read_obj(file);
    if (ending == ".nff") return read_nff(file);
    return read_bare_mesh(file);
}

Scene finish_scene(SceneFile&& read, const path& file) {
    Scene scene  = std::move(read.scene);
    scene.name   = file.stem().string();
    scene.source = file.generic_string();
    if (scene.title.empty()) scene.title = scene.name;

    check_geometry(scene, file);
    warn_of_geometry(scene);
    for (const Material& m : scene.materials) check_material(scene, m, file);
    check_colour(file, "scene", "ambient", scene.ambient);
    check_colour(file, "scene", "background", scene.background);
    if (!read.has_camera) give_camera(scene);
    check_camera(scene, file);
    if (scene.lights.size() > kMaxLights)
        refuse(file, fmt::format("{} lights (at most {} are read)", scene.lights.size(), kMaxLights));
    for (Light& light : scene.lights) check_light(light, file);
    if (scene.lights.empty() && !read.may_be_dark) give_light(scene);
    name_lights(scene);
    return scene;
}

Scene load_scene(const path& file) {
    return finish_scene(read_by_ending(file, {".json", ".gltf", ".glb", ".obj", ".nff", ".ply", ".off", ".stl"}), file);
}

}  // namespace umbra
