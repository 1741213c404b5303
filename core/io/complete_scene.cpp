// Completion of scenes of all formats: defaults, unit directions, names, and the warnings about them.
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "umbra/core/io/arriving_light.h"
#include "umbra/core/io/check_camera.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/io/vector_text.h"
#include "umbra/core/scene/topology.h"
#include "umbra/core/scene/uncomputed.h"

namespace umbra {
namespace {

// The vector scaled to length 1; zero stays zero. A vector of that length up to rounding is left alone, so that a scene
// that is written and read again keeps its bits.
vec3 unit(vec3 v) {
    const double square = glm::dot(dvec3(v), dvec3(v));
    if (std::abs(square - 1) <= 0x1p-22 || square == 0) return v;
    return vec3(dvec3(v) / std::sqrt(square));
}

// A direction whose largest component lies in [0.5, 1): scaled by a power of two, so that its rounding stays as it was
// and no square of it overflows or vanishes.
vec3 scaled_to_one(vec3 d) {
    int exponent = 0;
    std::frexp(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}), &exponent);
    return {std::ldexp(d.x, -exponent), std::ldexp(d.y, -exponent), std::ldexp(d.z, -exponent)};
}

void normalise_direction(Light& light) {
    switch (light.kind) {
        case LightKind::point:
        case LightKind::sphere: return;
        case LightKind::directional: light.direction = scaled_to_one(light.direction); return;
        case LightKind::rectangle:
            light.direction = vec3(glm::cross(dvec3(light.edge_u), dvec3(light.edge_v)));
            [[fallthrough]];
        case LightKind::spot:
        case LightKind::disk: light.direction = unit(light.direction); return;
    }
}

std::string lower(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

// A name for a message: a long one is cut, between two characters of UTF-8; a question mark replaces characters that
// would act on the message around it: control characters, and those of Unicode that end a line or turn the direction of
// text (U+2028 to U+202E, E2 80 A8 to AE; U+2066 to U+2069, E2 81 A6 to A9).
std::string shortened(const std::string& name) {
    constexpr std::size_t most = 60;
    const auto byte = [&](std::size_t k) { return k < name.size() ? static_cast<unsigned char>(name[k]) : 0; };
    std::string shown;
    for (std::size_t k = 0; k < name.size();) {
        const std::string_view lead = std::string_view(name).substr(k, 2);
        const int last              = byte(k + 2);
        std::size_t bytes           = 1;
        while ((byte(k + bytes) & 0xc0) == 0x80) ++bytes;
        if (k + bytes > most && name.size() > most) return shown + "...";
        const bool acts = byte(k) < 0x20 || byte(k) == 0x7f || (lead == "\xe2\x80" && last >= 0xa8 && last <= 0xae) ||
                          (lead == "\xe2\x81" && last >= 0xa6 && last <= 0xa9);
        shown += acts ? "?" : name.substr(k, bytes);
        k += bytes;
    }
    return shown;
}

// Names become channels S.<name> of images, where a dot would open a layer and OpenEXR allows 255 bytes, and parts of
// file names, which some systems compare without regard to case.
void name_lights(Scene& scene) {
    constexpr std::size_t longest = 64;
    std::set<std::string> taken;
    for (Light& light : scene.lights) {
        std::string name;
        for (const char c : light.name) {
            const bool fits =
                (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
            if (fits || name.empty() || name.back() != '_') name += fits ? c : '_';
        }
        if (name.empty()) name = to_string(light.kind);
        if (name.size() > longest) name.resize(longest);
        std::string unique = name;
        for (int n = 2; !taken.insert(lower(unique)).second; ++n) unique = fmt::format("{}_{}", name, n);
        if (!light.name.empty() && unique != light.name)
            scene.warnings.push_back(
                fmt::format("Light \"{}\" is called {} in images and tables.", shortened(light.name), unique));
        light.name = unique;
    }
}

// From the front, a little from the right and from above, at the distance from which the bounding sphere fits.
void assume_camera(Scene& scene) {
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
                    vector_text(camera.eye), vector_text(camera.target)));
}

void assume_light(Scene& scene) {
    Light light;
    light.name      = "default";
    light.kind      = LightKind::directional;
    light.direction = {0.5f, -1.0f, -0.625f};
    scene.lights.push_back(light);
    scene.warnings.push_back(
        "The file has no light: a white one at infinity is assumed, from above on the left in front "
        "(direction (0.5, -1, -0.625), called \"default\").");
}

void warn_of_geometry(Scene& scene) {
    if (scene.triangles.empty()) {
        scene.warnings.push_back("The file has no triangles: the picture shows the background alone.");
        return;
    }
    TriangleId degenerate = 0;
    for (TriangleId t = 0; t < scene.triangles.size(); ++t)
        degenerate += is_degenerate(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2));
    if (degenerate > 0)
        scene.warnings.push_back(
            fmt::format("{} of {} triangles have no area: they are kept, but are not seen and block no light.",
                        degenerate, scene.triangles.size()));
}

void warn_of_bright_materials(Scene& scene) {
    for (const Material& m : scene.materials)
        if (const vec3 sum = m.k_d + m.k_s; std::max({sum.r, sum.g, sum.b}) > 1.00001f)
            scene.warnings.push_back(
                fmt::format("Material \"{}\" reflects more light than it receives: k_d + k_s is "
                            "{:g}.",
                            m.name, std::max({sum.r, sum.g, sum.b})));
}

void warn_of_uncomputed(Scene& scene) {
    for (const UncomputedTerm& term : find_uncomputed(scene))
        scene.warnings.push_back(fmt::format("The {} is not computed: {}.", in_words(term), term.consequence));
}

}  // namespace

Scene complete_scene(SceneFile&& read, const std::filesystem::path& file) {
    Scene scene  = std::move(read.scene);
    scene.name   = file.stem().string();
    scene.source = file.generic_string();
    if (scene.title.empty()) scene.title = scene.name;

    for (vec3& n : scene.normals) n = unit(n);  // zero means the face normal
    warn_of_geometry(scene);
    warn_of_bright_materials(scene);
    warn_of_uncomputed(scene);
    if (!read.has_camera) {
        assume_camera(scene);
        check_camera(scene, file);
    }
    place_fixed_lights(scene);
    for (Light& light : scene.lights) normalise_direction(light);
    if (scene.lights.empty() && !read.may_be_dark) assume_light(scene);
    name_lights(scene);
    warn_of_invisible_lights(scene);
    return scene;
}

}  // namespace umbra
