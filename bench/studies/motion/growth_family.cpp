#include "umbra/bench/studies/motion/growth_family.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "umbra/core/base/suggest.h"
#include "umbra/core/render/gbuffer.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

void add_body(Scene& scene, const std::string& name, const Mesh& mesh, vec3 at) {
    const Mesh placed = transformed(mesh, glm::translate(mat4(1), at));
    add_object(scene, name, placed.positions, placed.normals, placed.triangles, 0);
}

/// A floor of 8 x 8 under one point light, seen from above; no body yet.
Scene empty_floor() {
    Scene scene;
    scene.materials.push_back({.name = "grey"});
    add_body(scene, "floor", make_plane(8, 8), vec3(0));
    Light light;
    light.name     = "light";
    light.position = {2.3f, 6.1f, 1.7f};
    scene.lights.push_back(light);
    scene.camera.eye    = {0.7f, 5.3f, 7.1f};
    scene.camera.target = {0, 0.4f, 0};
    scene.width         = 320;
    scene.height        = 240;
    return scene;
}

/// A torus of about `triangles` triangles above the floor: it shades the floor and itself.
void add_torus(Scene& scene, double triangles) {
    const int around = std::max(4, static_cast<int>(std::lround(std::sqrt(triangles))));
    const int tube   = std::max(3, static_cast<int>(std::lround(triangles / 2 / around)));
    add_body(scene, "torus", make_torus(1.5f, 0.6f, around, tube), {0, 1.3f, 0});
}

Scene triangles_scene(double x) {
    Scene scene = empty_floor();
    add_torus(scene, x - 2);
    return scene;
}
double count_triangles(const Scene& scene, double /*x*/) { return static_cast<double>(scene.triangles.size()); }

/// Boxes in a square grid above the floor. They shade the same part of it however many they are.
Scene bodies_scene(double x) {
    Scene scene         = empty_floor();
    const int side      = std::max(1, static_cast<int>(std::lround(std::sqrt(x / 12))));
    const float spacing = 6.0f / static_cast<float>(side), size = 0.4f * spacing;
    const Mesh box = make_box(vec3(size));
    Mesh all;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
            const vec3 at((static_cast<float>(column) + 0.5f) * spacing - 3, 0.8f + 0.5f * size,
                          (static_cast<float>(row) + 0.5f) * spacing - 3);
            const auto first = static_cast<std::uint32_t>(all.positions.size());
            for (const vec3 p : box.positions) all.positions.push_back(p + at);
            for (const uvec3 t : box.triangles) all.triangles.push_back(t + uvec3(first));
        }
    add_body(scene, "boxes", all, vec3(0));
    return scene;
}

Scene pixels_scene(double x) {
    Scene scene = empty_floor();
    add_torus(scene, 2e4);
    scene.width = scene.height = static_cast<int>(std::lround(std::sqrt(x)));
    return scene;
}
double count_pixels(const Scene& scene, double /*x*/) { return static_cast<double>(scene.width) * scene.height; }

Scene lights_scene(double x) {
    Scene scene       = empty_floor();
    const Light light = scene.lights[0];
    const int lights  = static_cast<int>(std::lround(x));
    add_torus(scene, 2e4);
    scene.lights.assign(static_cast<std::size_t>(lights), light);
    for (int j = 0; j < lights; ++j) {
        const double angle = 2 * kPi * j / lights;
        Light& placed      = scene.lights[static_cast<std::size_t>(j)];
        placed.name        = fmt::format("light_{}", j + 1);
        placed.position = {static_cast<float>(2.9 * std::cos(angle)), 6.1f, static_cast<float>(2.9 * std::sin(angle))};
    }
    return scene;
}
double count_lights(const Scene& scene, double /*x*/) { return static_cast<double>(scene.lights.size()); }

Scene samples_scene(double /*x*/) {
    Scene scene     = empty_floor();
    Light& light    = scene.lights[0];
    light.kind      = LightKind::rectangle;
    light.edge_u    = {1.2f, 0, 0};
    light.edge_v    = {0, 0, -1.2f};
    light.direction = glm::normalize(glm::cross(light.edge_u, light.edge_v));
    add_torus(scene, 2e3);
    scene.width = 192, scene.height = 144;
    return scene;
}

Scene resolution_scene(double /*x*/) { return triangles_scene(2e4); }
double as_asked(const Scene& /*scene*/, double x) { return x; }

const GrowthFamily kFamilies[] = {
    {"triangles", "Triangles of one body",
     "A torus above a floor is cut into more and more triangles; the picture, its shadow and the silhouette's shape "
     "stay.",
     "triangles", 1e3, 1e6, 4.1e6, std::sqrt(10.0), triangles_scene, count_triangles},
    {"bodies", "Number of bodies",
     "More and smaller boxes above a floor, all of them in one object; the part of the floor that they shade stays, "
     "the "
     "length of their silhouettes grows with their number.",
     "triangles", 1.2e2, 1.2e5, 4.1e6, std::sqrt(10.0), bodies_scene, count_triangles},
    {"pixels", "Pixels of the picture", "A torus of 20,000 triangles in square pictures of more and more pixels.",
     "pixels", 128.0 * 128, 2048.0 * 2048, 8192.0 * 8192, 4, pixels_scene, count_pixels},
    {"lights", "Point lights", "More and more point lights in a circle above a torus of 20,000 triangles.", "lights", 1,
     16, 64, 2, lights_scene, count_lights},
    {"samples",
     "Samples of an area light",
     "A rectangular light above a torus of 2,000 triangles; methods that sample it take more and more samples.",
     "samples",
     4,
     1024,
     4096,
     4,
     samples_scene,
     as_asked,
     {"samples", "light_samples"}},
    {"resolution",
     "Resolution of a map",
     "A torus of 20,000 triangles; methods with a map get more and more texels along its sides.",
     "texels along a side",
     256,
     8192,
     16384,
     2,
     resolution_scene,
     as_asked,
     {"resolution"}},
};

}  // namespace

std::vector<double> GrowthFamily::sizes(double up_to) const {
    std::vector<double> all;
    for (int k = 0; least * std::pow(factor, k) <= up_to * (1 + 1e-9); ++k)
        all.push_back(std::round(least * std::pow(factor, k)));
    return all;
}

std::vector<MethodChoice> GrowthFamily::at(const MethodChoice& choice, double x) const {
    if (parameters.empty()) return {choice};
    for (const Parameter& p : choice.settings.parameters())
        if (std::ranges::find(parameters, p.name) != parameters.end()) {
            MethodChoice set = choice;
            set.settings.set(p.name, x);
            return {set};
        }
    return {};
}

std::span<const GrowthFamily> growth_families() { return kFamilies; }

const GrowthFamily& find_growth_family(const std::string& name) {
    return entry_named("--over: unknown size", name, kFamilies, &GrowthFamily::name);
}

PreparedScene prepare_growth(const GrowthFamily& family, double x) {
    PreparedScene p;
    p.scene      = family.scene(x);
    p.scene.name = family.name;
    check_memory(p.scene, fmt::format("{} = {:g}", family.name, x), p.scene.width, p.scene.height, 1, Work::picture);
    p.facts  = find_facts(p.scene);
    p.points = primary_points(RayScene(p.scene), p.scene, p.scene.camera, p.scene.width, p.scene.height);
    return p;
}

}  // namespace umbra
