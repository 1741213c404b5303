#include "umbra/core/io/scene_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "umbra/core/io/reading.h"
#include "umbra/core/scene/names.h"

namespace umbra {
namespace {

std::string json_string(std::string_view s) {
    return nlohmann::json(s).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The shortest digits that the reader, which goes through double, makes the same float of.
std::string number(float x) {
    if (x == 0) return std::signbit(x) ? "-0.0" : "0";  // "-0" is an integer, which has no sign of its own
    std::string text = fmt::format("{}", x);
    return static_cast<float>(std::strtod(text.c_str(), nullptr)) == x ? text
                                                                       : fmt::format("{}", static_cast<double>(x));
}
std::string vector(vec3 v) { return fmt::format("[{}, {}, {}]", number(v.x), number(v.y), number(v.z)); }

/// Members of one JSON object, those that differ from their defaults.
class Members {
public:
    void add(std::string_view key, const std::string& value) {
        text_ += fmt::format("{}\"{}\": {}", text_.empty() ? "" : ", ", key, value);
    }
    void differing(std::string_view key, float value, float fallback) {
        if (value != fallback) add(key, number(value));
    }
    void differing(std::string_view key, vec3 value, vec3 fallback) {
        if (value != fallback) add(key, vector(value));
    }
    [[nodiscard]] std::string text() const { return "{" + text_ + "}"; }

private:
    std::string text_;
};

std::string camera_text(const Camera& c) {
    Members m;
    m.add("eye", vector(c.eye));
    m.add("target", vector(c.target));
    m.add("up", vector(c.up));
    if (c.projection == Projection::perspective)
        m.add("fov", number(c.fov_y));
    else
        m.add("height", number(c.height));
    return m.text();
}

template <class Items, class Text>
std::string list(const Items& items, const Text& text) {
    std::string all;
    for (const auto& item : items) all += (all.empty() ? "" : ", ") + text(item);
    return "[" + all + "]";
}

std::string lobe_text(const LafortuneLobe& lobe) {
    Members m;
    m.add("C", list(lobe.rows, vector));
    m.add("k_s", vector(lobe.k_s));
    m.add("shininess", number(lobe.shininess));
    return m.text();
}

std::string distribution_text(const Photometry& table) {
    Members m;
    m.add("type", json_string(name_of(table.type)));
    m.add("vertical", list(table.vertical, number));
    m.add("horizontal", list(table.horizontal, number));
    std::vector<std::vector<float>> planes;
    for (auto at = table.candela.begin(); at != table.candela.end(); at += std::ptrdiff_t(table.vertical.size()))
        planes.emplace_back(at, at + std::ptrdiff_t(table.vertical.size()));
    m.add("candela", list(planes, [](const std::vector<float>& plane) { return list(plane, number); }));
    return m.text();
}

std::string material_text(const Material& material) {
    const Material fallback;
    Members m;
    m.differing("k_a", material.k_a, fallback.k_a);
    m.differing("k_d", material.k_d, fallback.k_d);
    m.differing("k_s", material.k_s, fallback.k_s);
    m.differing("O_d", material.O_d, fallback.O_d);
    m.differing("O_s", material.O_s, fallback.O_s);
    m.differing("emission", material.emission, fallback.emission);
    m.differing("shininess", material.shininess, fallback.shininess);
    if (material.lobe != fallback.lobe) m.add("lobe", json_string(name_of(material.lobe)));
    if (!material.two_sided) m.add("two_sided", "false");
    if (material.cutout) m.add("cutout", "true");
    m.differing("opacity", material.opacity, fallback.opacity);
    m.differing("reflect", material.reflect, fallback.reflect);
    m.differing("transmit", material.transmit, fallback.transmit);
    m.differing("transmit_colour", material.transmit_colour, fallback.transmit_colour);
    m.differing("index_of_refraction", material.index_of_refraction, fallback.index_of_refraction);
    if (!material.lobes.empty()) m.add("lobes", list(material.lobes, lobe_text));
    m.differing("tangent", material.tangent, fallback.tangent);
    return m.text();
}

void add_spot(Members& m, const Spot& spot) {
    // Degrees in double: the way back rounds to the same float of radians.
    const auto degrees = [](float radians) { return fmt::format("{}", glm::degrees(static_cast<double>(radians))); };
    m.add("falloff", json_string(name_of(spot.falloff)));
    m.add("cutoff", degrees(spot.cutoff));
    m.add("inner", degrees(spot.inner));
    m.add("exponent", number(spot.exponent));
}

void add_pose(Members& m, const Light& light) {
    const LightPose pose = light.camera_pose ? *light.camera_pose : pose_of(light);
    if (light.kind != LightKind::directional) m.add("position", vector(pose.position));
    if (light.kind == LightKind::directional || light.kind == LightKind::spot || light.kind == LightKind::disk ||
        light.photometry)
        m.add("direction", vector(pose.direction));
    if (light.kind == LightKind::rectangle) {
        m.add("edge_u", vector(pose.edge_u));
        m.add("edge_v", vector(pose.edge_v));
    }
    if (light.photometry) {
        m.add("along", vector(pose.along));
        m.add("distribution", distribution_text(*light.photometry));
    }
}

/// The names under "except" that an object of the scene has: a part of a scene may have lost some.
std::vector<std::string> exceptions_in(const Scene& scene, const Light& light) {
    std::vector<std::string> names;
    for (const std::string& name : light.except) {
        Light one;
        one.except = {name};
        if (std::any_of(scene.objects.begin(), scene.objects.end(),
                        [&](const Object& object) { return !lights_object(one, object.name); }))
            names.push_back(name);
    }
    return names;
}

}  // namespace

std::string native_light_text(const Scene& scene, const Light& light) {
    Members m;
    m.add("type", json_string(name_of(light.kind)));
    m.add("name", json_string(light.name));
    if (const auto names = exceptions_in(scene, light); !names.empty()) m.add("except", list(names, json_string));
    if (light.camera_pose) m.add("fixed_to", json_string(name_of(FixedTo::camera)));
    add_pose(m, light);
    if (light.kind == LightKind::disk || light.kind == LightKind::sphere) m.add("radius", number(light.radius));
    if (light.kind == LightKind::spot) add_spot(m, light.spot);
    m.differing("diffuse", light.diffuse, vec3(1));
    m.differing("specular", light.specular, vec3(1));
    m.differing("ambient", light.ambient, vec3(0));
    if (light.kind != LightKind::directional) {
        const Attenuation& a = light.attenuation;
        m.differing("attenuation", vec3(a.c1, a.c2, a.c3), light.photometry ? vec3(0) : vec3(1, 0, 0));
        if (!a.clamp) m.add("clamp", "false");
        m.differing("range", light.range, 0);
    }
    return m.text();
}

namespace {

std::string object_text(const Scene& scene, const Object& object, const std::string& material) {
    const auto first = scene.triangles.begin() + object.first_triangle;
    std::map<std::uint32_t, std::uint32_t> index;  // of the positions that it uses, in their order
    for (auto t = first; t != first + object.triangle_count; ++t)
        for (int k = 0; k < 3; ++k) index[(*t)[k]] = 0;
    std::string positions, normals, triangles;
    std::uint32_t next = 0;
    bool smooth        = false;
    for (auto& [position, number_in_object] : index) {
        number_in_object = next++;
        positions += fmt::format("{}{}", positions.empty() ? "" : ", ", vector(scene.positions[position]));
        normals += fmt::format("{}{}", normals.empty() ? "" : ", ", vector(scene.normals[position]));
        smooth = smooth || scene.normals[position] != vec3(0);
    }
    for (auto t = first; t != first + object.triangle_count; ++t)
        triangles += fmt::format("{}[{}, {}, {}]", triangles.empty() ? "" : ", ", index.at((*t)[0]), index.at((*t)[1]),
                                 index.at((*t)[2]));
    std::string off;
    for (const ObjectSwitch& each : kObjectSwitches)
        if (!(object.switches.*each.is_on)) off += fmt::format(", \"{}\": false", each.key);
    return fmt::format(
        "{{\"type\": \"triangles\", \"name\": {}, \"material\": {}{},\n     \"positions\": [{}],\n{}     "
        "\"triangles\": [{}]}}",
        json_string(object.name), json_string(material), off, positions,
        smooth ? fmt::format("     \"normals\": [{}],\n", normals) : "", triangles);
}

/// Names for the materials that no other has, and that are not empty.
std::vector<std::string> material_names(const Scene& scene) {
    std::vector<std::string> names;
    std::set<std::string> taken;
    for (const Material& m : scene.materials) {
        const std::string base = m.name.empty() ? "material" : m.name;
        std::string name       = base;
        for (int n = 2; !taken.insert(name).second; ++n) name = fmt::format("{} {}", base, n);
        names.push_back(name);
    }
    return names;
}

std::string fog_text(const Fog& fog) {
    std::string text = fmt::format("{{\"law\": \"{}\", \"distance\": \"{}\", \"colour\": {}", name_of(fog.law),
                                   name_of(fog.distance), vector(fog.colour));
    if (fog.law == FogLaw::linear)
        text += fmt::format(", \"start\": {}, \"end\": {}, \"near\": {}, \"far\": {}", number(fog.start),
                            number(fog.end), number(fog.near_share), number(fog.far_share));
    else
        text += fmt::format(", \"density\": {}", number(fog.density));
    if (fog.dims_lights) text += ", \"dims_lights\": true";
    return text + "}";
}

/// A list or an object of items, one a line.
template <class Items, class Text>
std::string lines(const Items& items, const Text& text) {
    std::string all;
    for (const auto& item : items) all += fmt::format("{}\n    {}", all.empty() ? "" : ",", text(item));
    return all;
}

}  // namespace

std::string native_text(const Scene& scene) {
    const std::vector<std::string> names = material_names(scene);
    std::vector<std::size_t> material_list(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) material_list[i] = i;

    std::string text = "{\n";
    if (!scene.title.empty()) text += fmt::format("  \"title\": {},\n", json_string(scene.title));
    if (!scene.shows.empty()) text += fmt::format("  \"shows\": {},\n", json_string(scene.shows));
    // Also where it is 0 and the reader would move the scene.
    if (scene.origin != dvec3(0) || local_origin(bounds(scene)) != dvec3(0))
        text += fmt::format("  \"origin\": [{}, {}, {}],\n", scene.origin.x, scene.origin.y, scene.origin.z);
    text +=
        fmt::format("  \"size\": [{}, {}],\n  \"camera\": {},\n", scene.width, scene.height, camera_text(scene.camera));
    text +=
        fmt::format("  \"ambient\": {}, \"background\": {}, \"tone\": \"{}\", \"exposure\": {}, \"viewer\": \"{}\",\n",
                    vector(scene.ambient), vector(scene.background), name_of(scene.tone), number(scene.exposure),
                    name_of(Viewer{scene.local_viewer}));
    if (scene.light_ambient != LightAmbient::constant)
        text += fmt::format("  \"light_ambient\": \"{}\",\n", name_of(scene.light_ambient));
    if (scene.specular_colour != SpecularColour::O_s)
        text += fmt::format("  \"specular_colour\": \"{}\",\n", name_of(scene.specular_colour));
    if (scene.ambient_coefficient != AmbientCoefficient::k_a)
        text += fmt::format("  \"ambient_coefficient\": \"{}\",\n", name_of(scene.ambient_coefficient));
    if (scene.transparent != TransparentOccluders::ignore)
        text += fmt::format("  \"transparent_occluders\": \"{}\",\n", name_of(scene.transparent));
    if (scene.fog.law != FogLaw::none) text += fmt::format("  \"fog\": {},\n", fog_text(scene.fog));
    text += fmt::format("  \"materials\": {{{}\n  }},\n", lines(material_list, [&](std::size_t i) {
                            return fmt::format("{}: {}", json_string(names[i]), material_text(scene.materials[i]));
                        }));
    text += fmt::format("  \"lights\": [{}\n  ],\n",
                        lines(scene.lights, [&](const Light& light) { return native_light_text(scene, light); }));
    text += fmt::format("  \"objects\": [{}\n  ]\n}}\n", lines(scene.objects, [&](const Object& object) {
                            return object_text(scene, object, names[object.material]);
                        }));
    return text;
}

}  // namespace umbra
