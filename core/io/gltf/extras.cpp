// extras.umbra, an object that the format leaves to programs: an object's custom property "umbra" (of type Python in
// Blender) is written there. Its keys are those of the native scene files.
//
//   on                key                      value
//   scenes            title, shows             text
//                     ambient, background      a colour, or one number for grey
//                     tone                     "clamp", "divide" or "hue"
//                     exposure                 a positive number
//                     viewer                   "local" or "infinite"
//                     light_ambient            "constant" or "attenuated"
//                     specular_colour          "O_s" or "O_d"
//                     ambient_coefficient      "k_a" or "k_d"
//                     transparent_occluders    "ignore", "block" or "multiply"
//                     size                     [width, height]
//   materials         k_a k_d k_s O_d O_s emission   a colour, or one number for grey
//                     shininess                at least 0
//                     lobe                     "phong" or "blinn_phong"
//                     two_sided, cutout        true or false
//                     opacity reflect transmit 0 to 1
//                     transmit_colour          three numbers from 0 to 1
//                     index_of_refraction      a positive number
//                     lobes, tangent           Lafortune lobes; a vector
//   lights (of KHR_lights_punctual) and a node's "light"
//                     ambient diffuse specular a colour, or one number for grey: I_j
//                     colour, intensity        instead of diffuse and specular; I_j = intensity x colour
//                     attenuation, clamp       [c1, c2, c3] or "photometric"; true or false
//                     range                    a positive number
//                     falloff, exponent        spots: "cosine", "zachmann" or "smooth"
//   nodes             light                    an area light with the node's position:
//                       type                   "rectangle", "disk" or "sphere"
//                       size                   rectangle: [width, height] along the node's x and y
//                       radius                 disk, sphere
//                       name
//                     casts_shadows, receives_shadows, seen_by_camera   true or false: of the node's mesh
// A rectangle and a disk face along the node's -z, as the format's own lights shine. The node's scale counts; a disk or
// sphere that it makes an ellipse is refused. Unless it says otherwise, an area light falls off with 1 / d^2.
#include "umbra/core/io/gltf/extras.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/io/scene_terms.h"
#include "umbra/core/scene/names.h"

namespace umbra {
namespace {

void apply_light_fields(const JsonText& json, const JsonFields& fields, Light& light) {
    fields.exclude("colour", "diffuse");
    const auto intensity = static_cast<float>(fields.number("intensity", kNotNegative, 1));
    if (fields.find("colour") || fields.find("intensity"))
        light.diffuse = light.specular = intensity * colour_or(json, fields, "colour", vec3(1));
    if (const JsonValue* v = fields.find("diffuse")) light.diffuse = intensity * read_colour(json, *v, "diffuse");
    if (const JsonValue* v = fields.find("specular")) light.specular = intensity * read_colour(json, *v, "specular");
    light.ambient = colour_or(json, fields, "ambient", light.ambient);
    light.range   = static_cast<float>(fields.number("range", kPositive, double(light.range)));
    if (const JsonValue* v = fields.find("attenuation")) light.attenuation = read_attenuation(json, *v);
    light.attenuation.clamp = fields.boolean("clamp", light.attenuation.clamp);
}

}  // namespace

const JsonValue* find_umbra(const JsonValue& object) {
    const JsonValue* extras = find_member(object, "extras");
    return extras ? find_member(*extras, "umbra") : nullptr;
}

const JsonValue* find_scene_umbra(const JsonText& json) {
    const JsonValue* shown = shown_scene(json);
    return shown ? find_umbra(*shown) : nullptr;
}

void apply_material_extras(const JsonText& json, const JsonValue& umbra, Material& material) {
    const JsonFields fields(json, umbra, "extras.umbra of a material", material_keys());
    apply_material_terms(json, fields, material);
}

void apply_light_extras(const JsonText& json, const JsonValue& umbra, Light& light) {
    const JsonFields fields(json, umbra, "extras.umbra of a light",
                            {"colour", "intensity", "diffuse", "specular", "ambient", "attenuation", "clamp", "range",
                             "falloff", "exponent"});
    apply_light_fields(json, fields, light);
    if (const JsonValue* v = fields.find("falloff")) {
        if (light.kind != LightKind::spot) json.fail(*v, "falloff is for spot lights only");
        light.spot.falloff = json.choice<SpotFalloff>(*v, "falloff");
    }
    light.spot.exponent = static_cast<float>(fields.number("exponent", kNotNegative, double(light.spot.exponent)));
}

namespace {

Light read_area_light(const JsonText& json, const JsonValue& v, const dmat4& m) {
    const JsonFields fields(json, v, "light",
                            {"type", "name", "size", "radius", "colour", "intensity", "diffuse", "specular", "ambient",
                             "attenuation", "clamp", "range"});
    const JsonValue& type = fields.require("type");
    Light light;
    light.name        = fields.string("name", "");
    light.attenuation = {0, 0, 1, false};
    light.position    = vec3(dvec3(m[3]));
    const dvec3 x(m[0]), y(m[1]), z(m[2]);
    const double lx = glm::length(x), ly = glm::length(y), lz = glm::length(z);
    const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-4 * std::max(a, b); };
    light.kind      = json.choice<LightKind>(type, "type", {LightKind::rectangle, LightKind::disk, LightKind::sphere});
    switch (light.kind) {
        case LightKind::rectangle: {
            const JsonValue& size = fields.require("size");
            const JsonArray& list = json.array(size, "size", "[width, height]");
            if (list.size() != 2) json.wrong_type(size, "size", "[width, height]");
            const double w = json.number(list[0], "width", kPositive), h = json.number(list[1], "height", kPositive);
            if (std::abs(glm::dot(x, y)) > 1e-5 * lx * ly)
                json.fail(type, "the node's transform makes this rectangle a parallelogram");
            // cross(edge_u, edge_v) points along -z of the node, also where the node mirrors.
            light.edge_u = vec3(x * w);
            light.edge_v = vec3(y * (glm::dot(glm::cross(x, y), z) > 0 ? -h : h));
            break;
        }
        case LightKind::disk:
            light.radius = static_cast<float>(json.number(fields.require("radius"), "radius", kPositive) * lx);
            if (!same(lx, ly)) json.fail(type, "the node's scale makes this disk an ellipse");
            light.direction = vec3(-z / (lz > 0 ? lz : 1));
            break;
        default:
            light.radius = static_cast<float>(json.number(fields.require("radius"), "radius", kPositive) * lx);
            if (!same(lx, ly) || !same(lx, lz)) json.fail(type, "the node's scale makes this sphere an ellipsoid");
    }
    if (light.kind == LightKind::rectangle ? fields.find("radius") : fields.find("size"))
        json.fail(v, "a rectangle has a size, a disk and a sphere a radius");
    apply_light_fields(json, fields, light);
    return light;
}

}  // namespace

NodeExtras read_node_extras(const JsonText& json, const JsonValue& umbra, const dmat4& transform, bool has_mesh) {
    std::vector<std::string_view> keys{"light"};
    for (const ObjectSwitch& each : kObjectSwitches) keys.push_back(each.key);
    const JsonFields fields(json, umbra, "extras.umbra of a node", keys);
    NodeExtras extras;
    apply_object_switches(fields, extras.switches);
    for (const ObjectSwitch& each : kObjectSwitches)
        if (const JsonValue* v = fields.find(each.key); v && !has_mesh)
            json.fail(*v, fmt::format("{} is for nodes with a mesh only", each.key));
    if (const JsonValue* light = fields.find("light")) extras.light = read_area_light(json, *light, transform);
    return extras;
}

SceneExtras apply_scene_extras(const JsonText& json, const JsonValue& umbra, Scene& scene) {
    const JsonFields fields(json, umbra, "extras.umbra of a scene",
                            {"title", "shows", "ambient", "background", "tone", "exposure", "viewer", "light_ambient",
                             "specular_colour", "ambient_coefficient", "transparent_occluders", "fog", "size"});
    scene.title = fields.string("title", scene.title);
    scene.shows = fields.string("shows", "");
    apply_picture_terms(json, fields, scene);
    if (const JsonValue* v = fields.find("size")) read_picture_size(json, *v, scene);
    return {fields.find("ambient") != nullptr, fields.find("exposure") != nullptr};
}

}  // namespace umbra
