#include "umbra/core/io/scene_terms.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "umbra/core/image/image.h"
#include "umbra/core/io/limits.h"
#include "umbra/core/scene/names.h"

namespace umbra {
namespace {

float number_or(const JsonFields& fields, std::string_view key, const Range& range, float fallback) {
    return static_cast<float>(fields.number(key, range, static_cast<double>(fallback)));
}

}  // namespace

vec3 read_colour(const JsonText& json, const JsonValue& v, std::string_view what) {
    if (std::holds_alternative<double>(v.data)) return vec3(static_cast<float>(json.number(v, what, kNotNegative)));
    if (const auto* s = std::get_if<std::string>(&v.data)) {
        const bool hex =
            s->size() == 7 && (*s)[0] == '#' && s->find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
        if (hex) {
            vec3 c;
            for (int k = 0; k < 3; ++k) {
                const int byte = std::stoi(s->substr(static_cast<std::size_t>(1 + 2 * k), 2), nullptr, 16);
                c[k]           = linear_from_srgb(static_cast<float>(byte) / 255);
            }
            return c;
        }
    }
    if (!std::holds_alternative<JsonArray>(v.data)) json.wrong_type(v, what, "a number, [r, g, b] or \"#rrggbb\"");
    return vec3(json.vector(v, what, kNotNegative));
}

vec3 colour_or(const JsonText& json, const JsonFields& fields, std::string_view key, vec3 fallback) {
    const JsonValue* v = fields.find(key);
    return v ? read_colour(json, *v, key) : fallback;
}

Attenuation read_attenuation(const JsonText& json, const JsonValue& v) {
    if (std::holds_alternative<std::string>(v.data)) {
        (void)json.choice(v, "attenuation", {"photometric"});
        return {0, 0, 1, false};
    }
    const vec3 c(json.vector(v, "attenuation", kNotNegative));
    if (c == vec3(0))
        json.fail(
            v,
            "attenuation is [0, 0, 0], so that f = 1 / (c1 + c2 d + c3 d^2) divides by zero, expected at least one "
            "number above 0");
    return {c.x, c.y, c.z, true};
}

void read_picture_size(const JsonText& json, const JsonValue& v, Scene& scene) {
    constexpr std::string_view expected = "two whole numbers [width, height]";
    const JsonArray& sides              = json.array(v, "size", expected);
    if (sides.size() != 2) json.wrong_type(v, "size", expected);
    scene.width  = json.integer(sides[0], "width", 1, kMaxPictureSide);
    scene.height = json.integer(sides[1], "height", 1, kMaxPictureSide);
}

const std::vector<std::string_view>& material_keys() {
    static const std::vector<std::string_view> keys{
        "k_a",   "k_d",       "k_s",     "O_d",     "O_s",      "emission",        "shininess",
        "lobe",  "two_sided", "opacity", "reflect", "transmit", "transmit_colour", "index_of_refraction",
        "lobes", "tangent",   "cutout"};
    return keys;
}

void apply_object_switches(const JsonFields& fields, ObjectSwitches& switches) {
    for (const ObjectSwitch& each : kObjectSwitches)
        switches.*each.is_on = fields.boolean(each.key, switches.*each.is_on);
}

namespace {

/// Three numbers for a diagonal matrix, or three rows.
std::array<vec3, 3> read_matrix(const JsonText& json, const JsonValue& v) {
    const JsonArray& list = json.array(v, "C", "[x, y, z] of a diagonal, or three rows [x, y, z]");
    if (list.empty() || !std::holds_alternative<JsonArray>(list[0].data)) {
        const vec3 d(json.vector(v, "C", kAnyNumber));
        return {vec3(d.x, 0, 0), vec3(0, d.y, 0), vec3(0, 0, d.z)};
    }
    if (list.size() != 3) json.wrong_type(v, "C", "[x, y, z] of a diagonal, or three rows [x, y, z]");
    std::array<vec3, 3> rows;
    for (std::size_t k = 0; k < 3; ++k) rows.at(k) = vec3(json.vector(list[k], "a row of C", kAnyNumber));
    return rows;
}

std::vector<LafortuneLobe> read_lobes(const JsonText& json, const JsonValue& v) {
    std::vector<LafortuneLobe> lobes;
    for (const JsonValue& entry : json.array(v, "lobes", "a list of lobes")) {
        const JsonFields fields(json, entry, "a lobe", {"C", "k_s", "shininess"});
        LafortuneLobe lobe;
        if (const JsonValue* matrix = fields.find("C")) lobe.rows = read_matrix(json, *matrix);
        lobe.k_s       = read_colour(json, fields.require("k_s"), "k_s");
        lobe.shininess = number_or(fields, "shininess", kNotNegative, lobe.shininess);
        lobes.push_back(lobe);
    }
    return lobes;
}

}  // namespace

void apply_material_terms(const JsonText& json, const JsonFields& fields, Material& m) {
    m.k_a      = colour_or(json, fields, "k_a", m.k_a);
    m.k_d      = colour_or(json, fields, "k_d", m.k_d);
    m.k_s      = colour_or(json, fields, "k_s", m.k_s);
    m.O_d      = colour_or(json, fields, "O_d", m.O_d);
    m.O_s      = colour_or(json, fields, "O_s", m.O_s);
    m.emission = colour_or(json, fields, "emission", m.emission);
    if (const JsonValue* lobe = fields.find("lobe")) m.lobe = json.choice<Lobe>(*lobe, "lobe");
    m.shininess = number_or(fields, "shininess", kNotNegative, m.shininess);
    m.two_sided = fields.boolean("two_sided", m.two_sided);
    m.cutout    = fields.boolean("cutout", m.cutout);
    m.opacity   = number_or(fields, "opacity", kShare, m.opacity);
    m.reflect   = number_or(fields, "reflect", kShare, m.reflect);
    m.transmit  = number_or(fields, "transmit", kShare, m.transmit);
    if (const JsonValue* colour = fields.find("transmit_colour"))
        m.transmit_colour = vec3(json.vector(*colour, "transmit_colour", kShare));
    m.index_of_refraction = number_or(fields, "index_of_refraction", kPositive, m.index_of_refraction);
    if (const JsonValue* lobes = fields.find("lobes")) m.lobes = read_lobes(json, *lobes);
    if (const JsonValue* tangent = fields.find("tangent")) {
        m.tangent = vec3(json.vector(*tangent, "tangent", kAnyNumber));
        if (m.tangent == vec3(0)) json.fail(*tangent, "tangent is (0, 0, 0), expected a vector with a direction");
    }
}

namespace {

/// Only the keys that the law uses may be given.
void read_fog(const JsonText& json, const JsonValue& v, Fog& fog) {
    const JsonFields fields(json, v, "fog",
                            {"law", "distance", "colour", "density", "start", "end", "near", "far", "dims_lights"});
    fog     = {};
    fog.law = json.choice<FogLaw>(fields.require("law"), "law");
    if (const JsonValue* distance = fields.find("distance"))
        fog.distance = json.choice<FogDistance>(*distance, "distance");
    fog.colour        = colour_or(json, fields, "colour", fog.colour);
    fog.dims_lights   = fields.boolean("dims_lights", fog.dims_lights);
    const bool linear = fog.law == FogLaw::linear, none = fog.law == FogLaw::none;
    for (const std::string_view key : {"start", "end", "near", "far"})
        if (const JsonValue* given = fields.find(key); given != nullptr && !linear)
            json.fail(*given, fmt::format("{} is of linear fog, and this one is {}", key, name_of(fog.law)));
    if (const JsonValue* given = fields.find("density"); given != nullptr && (linear || none))
        json.fail(*given, fmt::format("density is of exponential fog, and this one is {}", name_of(fog.law)));
    if (!linear && !none)
        fog.density = static_cast<float>(json.number(fields.require("density"), "density", kNotNegative));
    if (!linear) return;
    fog.start      = number_or(fields, "start", kNotNegative, fog.start);
    fog.end        = static_cast<float>(json.number(fields.require("end"), "end", kPositive));
    fog.near_share = number_or(fields, "near", kShare, fog.near_share);
    fog.far_share  = number_or(fields, "far", kShare, fog.far_share);
    if (!(fog.start < fog.end))
        json.fail(v, fmt::format("fog from {} to {}, expected an end beyond the start", fog.start, fog.end));
}

}  // namespace

void apply_picture_terms(const JsonText& json, const JsonFields& fields, Scene& scene) {
    scene.ambient    = colour_or(json, fields, "ambient", scene.ambient);
    scene.background = colour_or(json, fields, "background", scene.background);
    if (const JsonValue* tone = fields.find("tone")) scene.tone = json.choice<ToneMap>(*tone, "tone");
    scene.exposure = number_or(fields, "exposure", kPositive, scene.exposure);
    if (const JsonValue* fog = fields.find("fog")) read_fog(json, *fog, scene.fog);
    if (const JsonValue* viewer = fields.find("viewer"))
        scene.local_viewer = json.choice<Viewer>(*viewer, "viewer") == Viewer::local;
    if (const JsonValue* v = fields.find("light_ambient"))
        scene.light_ambient = json.choice<LightAmbient>(*v, "light_ambient");
    if (const JsonValue* v = fields.find("specular_colour"))
        scene.specular_colour = json.choice<SpecularColour>(*v, "specular_colour");
    if (const JsonValue* v = fields.find("ambient_coefficient"))
        scene.ambient_coefficient = json.choice<AmbientCoefficient>(*v, "ambient_coefficient");
    if (const JsonValue* v = fields.find("transparent_occluders"))
        scene.transparent = json.choice<TransparentOccluders>(*v, "transparent_occluders");
}

}  // namespace umbra
