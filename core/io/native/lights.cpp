#include "umbra/core/io/native/lights.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/ies.h"
#include "umbra/core/io/native/directions.h"
#include "umbra/core/io/native/sun.h"
#include "umbra/core/io/scene_terms.h"

namespace umbra {
namespace {

using Keys = std::vector<std::string_view>;

LightKind read_kind(const JsonText& json, const JsonValue& v) {
    const auto& members = json.object(v, "a light");
    const auto type = std::find_if(members.begin(), members.end(), [](const JsonMember& m) { return m.key == "type"; });
    if (type == members.end()) json.fail(v, "a light has no \"type\"");
    return json.choice<LightKind>(type->value, "light type");
}

Keys keys_of(LightKind kind) {
    Keys keys{"type", "name", "on", "fixed_to", "except", "colour", "intensity", "diffuse", "specular", "ambient"};
    const auto add = [&](const Keys& more) { keys.insert(keys.end(), more.begin(), more.end()); };
    if (kind != LightKind::directional) add({"position", "attenuation", "clamp", "range"});
    switch (kind) {
        case LightKind::directional: add({"direction", "sun"}); break;
        case LightKind::point: add({"ies", "distribution", "direction", "target", "along"}); break;
        case LightKind::spot: add({"direction", "target", "falloff", "exponent", "cutoff", "inner"}); break;
        case LightKind::rectangle: add({"size", "direction", "target", "up", "edge_u", "edge_v"}); break;
        case LightKind::disk: add({"direction", "target", "radius"}); break;
        case LightKind::sphere: add({"radius"}); break;
    }
    return keys;
}

void read_intensities(const JsonText& json, const JsonFields& f, Light& light) {
    const vec3 base      = colour_or(json, f, "colour", vec3(1));
    const auto intensity = static_cast<float>(f.number("intensity", kNotNegative, 1));
    f.exclude("colour", "diffuse");
    light.diffuse  = intensity * colour_or(json, f, "diffuse", base);
    light.specular = intensity * colour_or(json, f, "specular", base);
    light.ambient  = colour_or(json, f, "ambient", vec3(0));
}

void read_position(const JsonText& json, const JsonFields& f, const dvec3& origin, Light& light) {
    light.position = vec3(json.vector(f.require("position"), "position", kAnyNumber) - origin);
    light.range    = static_cast<float>(f.number("range", kPositive, 0));
    if (const JsonValue* a = f.find("attenuation")) light.attenuation = read_attenuation(json, *a);
    light.attenuation.clamp = f.boolean("clamp", light.attenuation.clamp);
}

/// A direction, or where and when the sun shines.
void read_directional(const JsonText& json, const JsonFields& f, Light& light) {
    f.exclude("direction", "sun");
    const JsonValue* sun = f.find("sun");
    if (sun != nullptr && f.find("fixed_to") != nullptr) f.exclude("fixed_to", "sun");
    light.direction = sun != nullptr ? read_sun(json, *sun) : read_direction(json, f.require("direction"), "direction");
}

std::vector<float> read_numbers(const JsonText& json, const JsonValue& v, std::string_view what) {
    std::vector<float> numbers;
    for (const JsonValue& number : json.array(v, what, "a list of numbers"))
        numbers.push_back(static_cast<float>(json.number(number, what, kAnyNumber)));
    return numbers;
}

/// The table of intensities, written out: a list of them for each horizontal angle.
Photometry read_distribution(const JsonText& json, const JsonValue& v) {
    const JsonFields f(json, v, "a distribution", {"type", "vertical", "horizontal", "candela"});
    Photometry table;
    if (const JsonValue* type = f.find("type")) table.type = json.choice<PhotometricType>(*type, "photometric type");
    table.vertical = read_numbers(json, f.require("vertical"), "vertical");
    table.horizontal =
        f.find("horizontal") ? read_numbers(json, *f.find("horizontal"), "horizontal") : std::vector<float>{0};
    const JsonValue& candela = f.require("candela");
    const JsonArray& planes  = json.array(candela, "candela", "a list of lists, one for each horizontal angle");
    if (planes.size() != table.horizontal.size())
        json.fail(candela, fmt::format("candela has {} lists, expected one for each of the {} horizontal angles",
                                       planes.size(), table.horizontal.size()));
    for (const JsonValue& plane : planes) {
        const std::vector<float> values = read_numbers(json, plane, "candela");
        if (values.size() != table.vertical.size())
            json.fail(plane, fmt::format("{} intensities, expected one for each of the {} vertical angles",
                                         values.size(), table.vertical.size()));
        table.candela.insert(table.candela.end(), values.begin(), values.end());
    }
    if (const std::string fault = fault_of(table); !fault.empty()) json.fail(v, fault);
    return table;
}

Photometry read_ies_of(const JsonText& json, const JsonValue& v, const std::filesystem::path& folder,
                       std::vector<std::string>& warnings) {
    try {
        return read_ies(folder / json.string(v, "ies"), warnings);
    } catch (const InputError& e) {
        json.fail(v, fmt::format("the photometric file cannot be read: {}", e.what()));
    }
}

/// The direction of a goniometric light, and the turn of its table about it.
void read_goniometric(const JsonText& json, const JsonFields& f, const std::filesystem::path& folder,
                      const dvec3& origin, Light& light, std::vector<std::string>& warnings) {
    f.exclude("ies", "distribution");
    const JsonValue *ies = f.find("ies"), *distribution = f.find("distribution");
    if (ies == nullptr && distribution == nullptr) {
        for (const std::string_view key : {"direction", "target", "along"})
            if (const JsonValue* given = f.find(key))
                json.fail(*given, fmt::format("{} is of a point light with ies or distribution", key));
        return;
    }
    light.photometry = std::make_shared<const Photometry>(ies != nullptr ? read_ies_of(json, *ies, folder, warnings)
                                                                         : read_distribution(json, *distribution));
    if (f.find("attenuation") == nullptr) light.attenuation = {0, 0, 1, f.boolean("clamp", false)};
    light.direction = direction_or_target(json, f, light.position, origin, vec3(0, -1, 0));
    const dvec3 axis(light.direction);
    light.along = is_parallel(dvec3(1, 0, 0), axis) ? vec3(0, 0, 1) : vec3(1, 0, 0);
    if (const JsonValue* along = f.find("along")) {
        light.along = read_direction(json, *along, "along");
        if (is_parallel(dvec3(light.along), axis)) json.fail(*along, "along is parallel to the light's direction");
    }
}

void read_spot(const JsonText& json, const JsonFields& f, const dvec3& origin, Light& light) {
    light.direction = direction_or_target(json, f, light.position, origin, std::nullopt);
    if (const JsonValue* falloff = f.find("falloff"))
        light.spot.falloff = json.choice<SpotFalloff>(*falloff, "falloff");
    light.spot.exponent = static_cast<float>(f.number("exponent", kNotNegative, double(light.spot.exponent)));
    const double cutoff = f.number("cutoff", kConeAngle, 45);
    const double inner  = f.number("inner", kInnerConeAngle, 0);
    if (inner > cutoff)
        json.fail(*f.find("inner"),
                  fmt::format("inner is {:g} degrees, cutoff {:g}, expected inner at most cutoff", inner, cutoff));
    light.spot.cutoff = static_cast<float>(glm::radians(cutoff));
    light.spot.inner  = static_cast<float>(glm::radians(inner));
}

/// Two edges, or a size and where it faces.
void read_rectangle(const JsonText& json, const JsonFields& f, const dvec3& origin, Light& light) {
    for (const std::string_view other : {"size", "direction", "target", "up"}) f.exclude("edge_u", other);
    if (f.find("edge_u") || f.find("edge_v")) {
        light.edge_u  = read_direction(json, f.require("edge_u"), "edge_u");
        light.edge_v  = read_direction(json, f.require("edge_v"), "edge_v");
        const dvec3 u = glm::normalize(dvec3(light.edge_u)), v = glm::normalize(dvec3(light.edge_v));
        if (std::abs(glm::dot(u, v)) > 1e-4)
            json.fail(*f.find("edge_v"), "edge_v is not perpendicular to edge_u, as a rectangle's edges are");
        return;
    }
    constexpr std::string_view expected = "two numbers [width, height]";
    const JsonValue& v                  = f.require("size");
    const auto& size                    = json.array(v, "size", expected);
    if (size.size() != 2) json.wrong_type(v, "size", expected);
    const dvec3 axis = glm::normalize(dvec3(direction_or_target(json, f, light.position, origin, vec3(0, -1, 0))));
    dvec3 up{0, 1, 0};
    if (const JsonValue* given = f.find("up")) {
        up = glm::normalize(dvec3(read_direction(json, *given, "up")));
        if (is_parallel(up, axis)) json.fail(*given, "up is parallel to the direction that the light faces");
    } else if (is_parallel(up, axis)) {
        up = {0, 0, 1};
    }
    const dvec3 u = glm::normalize(glm::cross(up, axis));
    light.edge_u  = vec3(json.number(size[0], "width", kPositive) * u);
    light.edge_v  = vec3(json.number(size[1], "height", kPositive) * glm::cross(axis, u));
}

/// Without a radius it is a point.
void read_sphere(const JsonText& json, const JsonFields& f, Light& light, std::vector<std::string>& warnings) {
    const JsonValue& radius = f.require("radius");
    if (const auto* number = std::get_if<double>(&radius.data); number && *number == 0) {
        light.kind = LightKind::point;
        warnings.emplace_back("A sphere light of radius 0 is taken as a point light.");
    } else {
        light.radius = static_cast<float>(json.number(radius, "radius", kPositive));
    }
}

/// "except": a list of names of objects.
std::vector<std::string> read_exceptions(const JsonText& json, const JsonFields& f) {
    std::vector<std::string> names;
    if (const JsonValue* v = f.find("except"))
        for (const JsonValue& name : json.array(*v, "except", "a list of names of objects"))
            names.push_back(json.string(name, "the name of an object"));
    return names;
}

Light read_light(const JsonText& json, const JsonValue& v, const std::filesystem::path& folder,
                 const dvec3& scene_origin, bool& on, std::vector<std::string>& warnings) {
    Light light;
    light.kind = read_kind(json, v);
    const JsonFields f(json, v, fmt::format("a {} light", to_string(light.kind)), keys_of(light.kind));
    light.name   = f.string("name", "");
    on           = f.boolean("on", true);
    light.except = read_exceptions(json, f);
    read_intensities(json, f, light);
    const JsonValue* fixed = f.find("fixed_to");
    const bool to_camera   = fixed != nullptr && json.choice<FixedTo>(*fixed, "fixed_to") == FixedTo::camera;
    const dvec3 origin     = to_camera ? dvec3(0) : scene_origin;
    if (light.kind == LightKind::directional)
        read_directional(json, f, light);
    else
        read_position(json, f, origin, light);
    if (light.kind == LightKind::point) read_goniometric(json, f, folder, origin, light, warnings);
    if (light.kind == LightKind::spot) read_spot(json, f, origin, light);
    if (light.kind == LightKind::rectangle) read_rectangle(json, f, origin, light);
    if (light.kind == LightKind::disk)
        light.direction = direction_or_target(json, f, light.position, origin, vec3(0, -1, 0));
    if (light.kind == LightKind::disk)
        light.radius = static_cast<float>(json.number(f.require("radius"), "radius", kPositive));
    if (light.kind == LightKind::sphere) read_sphere(json, f, light, warnings);
    if (to_camera) light.camera_pose = pose_of(light);
    return light;
}

/// Names of objects, and NAME of NAME/PART: the names that lights_object() knows.
std::set<std::string_view> names_and_beginnings(const std::vector<Object>& objects) {
    std::set<std::string_view> names;
    for (const Object& object : objects) {
        const std::string_view name = object.name;
        names.insert(name);
        for (std::size_t slash = name.find('/'); slash != name.npos; slash = name.find('/', slash + 1))
            names.insert(name.substr(0, slash));
    }
    return names;
}

}  // namespace

void read_native_lights(const JsonText& json, const JsonValue& v, const std::filesystem::path& folder,
                        const dvec3& origin, std::vector<Light>& lights, std::vector<std::string>& warnings) {
    std::vector<std::string> all;
    for (const JsonValue& entry : json.array(v, "lights", "a list of lights")) {
        if (lights.size() >= kMaxLights) json.fail(entry, fmt::format("more than {} lights", kMaxLights));
        bool on     = true;
        Light light = read_light(json, entry, folder, origin, on, all);
        if (on) lights.push_back(std::move(light));
    }
    for (const std::string& warning : all)
        if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(warning);
}

void check_exceptions(const JsonText& json, const JsonValue& lights, const std::vector<Object>& objects) {
    const std::set<std::string_view> names = names_and_beginnings(objects);
    for (const JsonValue& light : json.array(lights, "lights", "a list of lights"))
        for (const JsonMember& member : json.object(light, "a light")) {
            if (member.key != "except") continue;
            for (const JsonValue& entry : json.array(member.value, "except", "a list of names of objects"))
                if (const std::string& name = json.string(entry, "the name of an object"); !names.contains(name))
                    json.unknown(entry.offset, "object", name, {names.begin(), names.end()});
        }
}

}  // namespace umbra
