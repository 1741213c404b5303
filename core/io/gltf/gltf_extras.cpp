// extras.umbra, an object beside what the format itself defines: an object's custom property "umbra" (of type Python in
// Blender) is written there. Its keys are those of the native scene files.
//
//   on                key                      value
//   scenes            title, shows             text
//                     ambient, background      a colour, or one number for grey
//                     tone                     "clamp", "divide" or "hue"
//                     exposure                 a positive number
//                     viewer                   "local" or "infinite"
//                     size                     [width, height]
//   materials         k_a k_d k_s O_d O_s emission   a colour or a number
//                     shininess                at least 0
//                     lobe                     "phong" or "blinn_phong"
//                     two_sided                true or false
//                     opacity reflect transmit 0 to 1
//                     index_of_refraction      a positive number
//   lights (of KHR_lights_punctual) and a node's "light"
//                     ambient diffuse specular a colour or a number: I_j
//                     colour, intensity        instead of diffuse and specular; I_j = intensity x colour
//                     attenuation, clamp       [c1, c2, c3]; true or false
//                     range                    a positive number
//                     falloff, exponent        spots: "cosine", "zachmann" or "smooth"
//   nodes             light                    an area light with the node's place:
//                       type                   "rectangle", "disk" or "sphere"
//                       size                   rectangle: [width, height] along the node's x and y
//                       radius                 disk, sphere
//                       name
// A rectangle and a disk face along the node's -z, as the format's own lights shine. The node's scale counts; a disk or
// sphere that it makes an ellipse is refused. Unless it says otherwise, an area light falls off with 1 / d^2.
#include "umbra/core/io/gltf/gltf_extras.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/gltf/gltf_data.h"
#include "umbra/core/io/scene_readers.h"

namespace umbra {
namespace {

constexpr Range kNotNegative{0, kMaxCoordinate, false, "a number of at least 0"};
constexpr Range kPositive{1e-30, kMaxCoordinate, false, "a positive number"};
constexpr Range kShare{0, 1, false, "a number from 0 to 1"};

vec3 colour(const JsonText& json, const JsonValue& v, std::string_view what) {
    if (std::holds_alternative<double>(v.data)) return vec3(static_cast<float>(json.number(v, what, kNotNegative)));
    return vec3(json.vector(v, what, kNotNegative));
}

void colour_of(const JsonText& json, const JsonFields& fields, std::string_view key, vec3& out) {
    if (const JsonValue* v = fields.find(key)) out = colour(json, *v, key);
}
void number_of(const JsonFields& fields, std::string_view key, const Range& range, float& out) {
    out = static_cast<float>(fields.number(key, range, double(out)));
}

void apply_light_fields(const JsonText& json, const JsonFields& fields, Light& light) {
    fields.exclude("colour", "diffuse");
    const float intensity = static_cast<float>(fields.number("intensity", kNotNegative, 1));
    if (fields.find("colour") || fields.find("intensity")) light.diffuse = light.specular = vec3(intensity);
    if (const JsonValue* v = fields.find("colour"))
        light.diffuse = light.specular = intensity * colour(json, *v, "colour");
    if (const JsonValue* v = fields.find("diffuse")) light.diffuse = intensity * colour(json, *v, "diffuse");
    if (const JsonValue* v = fields.find("specular")) light.specular = intensity * colour(json, *v, "specular");
    colour_of(json, fields, "ambient", light.ambient);
    number_of(fields, "range", kPositive, light.range);
    if (const JsonValue* v = fields.find("attenuation")) {
        const vec3 c(json.vector(*v, "attenuation", kNotNegative));
        if (c == vec3(0))
            json.fail(*v, "attenuation is [0, 0, 0], which divides by zero (f = 1 / (c1 + c2 d + c3 d^2))");
        light.attenuation = {c.x, c.y, c.z, true};
    }
    light.attenuation.clamp = fields.boolean("clamp", light.attenuation.clamp);
}

}  // namespace

const JsonValue* find_umbra(const JsonValue& object) {
    const JsonValue* extras = find_member(object, "extras");
    return extras ? find_member(*extras, "umbra") : nullptr;
}

const JsonValue* find_scene_umbra(const JsonText& json) {
    const JsonArray& scenes = list_of(json, json.root(), "scenes");
    if (scenes.empty()) return nullptr;
    const JsonValue* chosen = find_member(json.root(), "scene");
    return find_umbra(scenes[chosen ? index_into(json, *chosen, "scene", scenes.size()) : 0]);
}

void apply_material_extras(const JsonText& json, const JsonValue& umbra, Material& material) {
    const JsonFields fields(json, umbra, "extras.umbra of a material",
                            {"k_a", "k_d", "k_s", "O_d", "O_s", "emission", "shininess", "lobe", "two_sided", "opacity",
                             "reflect", "transmit", "index_of_refraction"});
    colour_of(json, fields, "k_a", material.k_a);
    colour_of(json, fields, "k_d", material.k_d);
    colour_of(json, fields, "k_s", material.k_s);
    colour_of(json, fields, "O_d", material.O_d);
    colour_of(json, fields, "O_s", material.O_s);
    colour_of(json, fields, "emission", material.emission);
    number_of(fields, "shininess", kNotNegative, material.shininess);
    number_of(fields, "opacity", kShare, material.opacity);
    number_of(fields, "reflect", kShare, material.reflect);
    number_of(fields, "transmit", kShare, material.transmit);
    number_of(fields, "index_of_refraction", kPositive, material.index_of_refraction);
    material.two_sided = fields.boolean("two_sided", material.two_sided);
    if (const JsonValue* v = fields.find("lobe"))
        material.lobe = json.choice(*v, "lobe", {"phong", "blinn_phong"}) == 0 ? Lobe::phong : Lobe::blinn_phong;
}

void apply_light_extras(const JsonText& json, const JsonValue& umbra, Light& light) {
    const JsonFields fields(json, umbra, "extras.umbra of a light",
                            {"colour", "intensity", "diffuse", "specular", "ambient", "attenuation", "clamp", "range",
                             "falloff", "exponent"});
    apply_light_fields(json, fields, light);
    if (const JsonValue* v = fields.find("falloff")) {
        if (light.kind != LightKind::spot) json.fail(*v, "falloff of a light that is not a spot");
        light.spot.falloff = static_cast<SpotFalloff>(json.choice(*v, "falloff", {"cosine", "zachmann", "smooth"}));
    }
    number_of(fields, "exponent", kNotNegative, light.spot.exponent);
}

std::optional<Light> read_area_light(const JsonText& json, const JsonValue& umbra, const dmat4& m) {
    const JsonFields node(json, umbra, "extras.umbra of a node", {"light"});
    const JsonValue* v = node.find("light");
    if (!v) return std::nullopt;
    const JsonFields fields(json, *v, "light",
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
    switch (json.choice(type, "type", {"rectangle", "disk", "sphere"})) {
        case 0: {
            light.kind            = LightKind::rectangle;
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
        case 1:
            light.kind   = LightKind::disk;
            light.radius = static_cast<float>(json.number(fields.require("radius"), "radius", kPositive) * lx);
            if (!same(lx, ly)) json.fail(type, "the node's scale makes this disk an ellipse");
            light.direction = vec3(-z / (lz > 0 ? lz : 1));
            break;
        default:
            light.kind   = LightKind::sphere;
            light.radius = static_cast<float>(json.number(fields.require("radius"), "radius", kPositive) * lx);
            if (!same(lx, ly) || !same(lx, lz)) json.fail(type, "the node's scale makes this sphere an ellipsoid");
    }
    if (light.kind == LightKind::rectangle ? fields.find("radius") : fields.find("size"))
        json.fail(*v, "a rectangle has a size, a disk and a sphere a radius");
    apply_light_fields(json, fields, light);
    return light;
}

SceneExtras apply_scene_extras(const JsonText& json, const JsonValue& umbra, Scene& scene) {
    const JsonFields fields(json, umbra, "extras.umbra of a scene",
                            {"title", "shows", "ambient", "background", "tone", "exposure", "viewer", "size"});
    scene.title = fields.string("title", scene.title);
    scene.shows = fields.string("shows", "");
    colour_of(json, fields, "ambient", scene.ambient);
    colour_of(json, fields, "background", scene.background);
    number_of(fields, "exposure", kPositive, scene.exposure);
    if (const JsonValue* v = fields.find("viewer"))
        scene.local_viewer = json.choice(*v, "viewer", {"local", "infinite"}) == 0;
    if (const JsonValue* v = fields.find("tone"))
        scene.tone = static_cast<ToneMap>(json.choice(*v, "tone", {"clamp", "divide", "hue"}));
    if (const JsonValue* v = fields.find("size")) {
        const JsonArray& list = json.array(*v, "size", "[width, height]");
        if (list.size() != 2) json.wrong_type(*v, "size", "[width, height]");
        scene.width  = json.integer(list[0], "width", 1, kMaxPictureSide);
        scene.height = json.integer(list[1], "height", 1, kMaxPictureSide);
    }
    return {fields.find("ambient") != nullptr, fields.find("exposure") != nullptr};
}

}  // namespace umbra
