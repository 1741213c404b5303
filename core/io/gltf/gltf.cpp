// glTF 2.0 scenes, .gltf and .glb.
//
// The document is read as JSON that knows its places, and not by one of the glTF libraries: those at hand follow
// indices and lengths of the file unchecked, and can name no line. What is read here is a small part of the format.
//
//   glTF                            here
//   pbrMetallicRoughness            c = baseColorFactor, m = metallicFactor, F0 = 0.04 (1 - m) + c m, a = roughness^2:
//                                   O_d = c, k_d = 0.96 (1 - m)     the diffuse share that the specular one leaves
//                                   k_a = k_d
//                                   k_s = F0 min(1, 1 / (4 a^2))    the microfacet lobe's peak F0 D / 4, but no
//                                                                   brighter than a mirror; so k_d O_d + k_s <= 1
//                                   n   = 1 / (2 a^2) - 1/2         in [1, 10000]: Blinn-Phong's 2 / a^2 - 2 [Walter
//                                                                   et al. 2007] is 4 times as wide in the angle of R
//                                                                   [Fisher, Woo 1994]
//   KHR_materials_pbrSpecularGlossiness  O_d = diffuse, F0 = specular, roughness = 1 - glossiness
//   emissiveFactor                  emission, times KHR_materials_emissive_strength
//   KHR_materials_unlit             emission = c, nothing else
//   baseColorFactor's alpha         opacity, unless alphaMode is OPAQUE
//   KHR_materials_transmission, _ior  transmit, index_of_refraction
//   doubleSided                     two_sided
//   KHR_lights_punctual             I_j = colour x intensity, as is (lux or candela); f_att = 1 / d^2 without limit;
//                                   range as a sharp limit; spots with falloff `smooth`
//   exposure                        1; with punctual lights 1 / E where the median E over the triangles of the light
//                                   that arrives, sum_j f_att,j I_j, lies outside [0.1, 2]
//   (no ambient light)              I_a = 0.1
//   textures, vertex colours, skins, morph targets, animations   not read, with a warning
//   points, lines                   left out, with a warning
//   extras.umbra                    gltf_extras.cpp
//
// This work is based on:
// Khronos Group. glTF 2.0 Specification. 2021; KHR_lights_punctual. 2018
// Bruce Walter, Stephen Marschner, Hongsong Li, Kenneth Torrance. Microfacet Models for Refraction through Rough
// Surfaces. 2007
// Frederick Fisher, Andrew Woo. R.E versus N.H Specular Highlights. Graphics Gems IV. 1994
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <unordered_map>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "umbra/core/base/error.h"
#include "umbra/core/io/gltf/gltf_data.h"
#include "umbra/core/io/gltf/gltf_extras.h"
#include "umbra/core/io/scene_readers.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {
namespace {

using std::filesystem::path;

constexpr Range kAny{-kMaxCoordinate, kMaxCoordinate, false, "a number"};
constexpr Range kNotNegative{0, kMaxCoordinate, false, "a number of at least 0"};
constexpr Range kPositive{1e-30, kMaxCoordinate, false, "a positive number"};
constexpr Range kShare{0, 1, false, "a number from 0 to 1"};

// ---- the container ----

struct Document {
    SourceText json;
    std::string whole;  ///< the .glb, which `bin` points into
    std::optional<std::string_view> bin;
};

// A .glb is a header of 12 bytes and chunks: JSON first, then perhaps BIN.
Document open_document(const path& file) {
    Document document;
    SourceText source = read_text(file);
    if (source.text.empty()) throw InputError(fmt::format("{}: empty (a glTF 2.0 file would be right)", source.file));
    std::string ending = file.extension().string();
    const bool binary  = source.text.starts_with("glTF");
    if (!binary && (ending == ".glb" || ending == ".GLB"))
        throw InputError(
            fmt::format("{}: byte 0: does not begin with the letters glTF, as every .glb does", source.file));
    if (!binary) {
        document.json = std::move(source);
        return document;
    }

    document.whole  = std::move(source.text);
    const auto fail = [&](std::size_t byte, const std::string& message) {
        throw InputError(fmt::format("{}: byte {}: {}", source.file, byte, message));
    };
    const std::string_view all = document.whole;
    const auto word            = [&](std::size_t at) {
        std::uint32_t x = 0;
        std::memcpy(&x, all.data() + at, 4);
        return x;
    };
    if (all.size() < 20) fail(0, fmt::format("{} bytes (a .glb has at least 20)", all.size()));
    if (word(4) != 2) fail(4, fmt::format("version {} of the container (2 would be right)", word(4)));
    if (word(8) != all.size())
        fail(8, fmt::format("the header says {} bytes, but the file has {}", word(8), all.size()));
    std::optional<std::string_view> json;
    std::size_t at = 12;
    for (int chunk = 0; at < all.size(); ++chunk) {
        if (all.size() - at < 8) fail(at, "the file ends within the head of a chunk");
        const std::uint32_t length = word(at), type = word(at + 4);
        if (length > all.size() - at - 8)
            fail(at, fmt::format("a chunk of {} bytes, but {} are left", length, all.size() - at - 8));
        const std::string_view body   = all.substr(at + 8, length);
        constexpr std::uint32_t kJson = 0x4e4f534a, kBin = 0x004e4942;
        if (chunk == 0 && type != kJson) fail(at + 4, "the first chunk is not JSON");
        if (chunk == 0) json = body;
        if (chunk == 1 && type == kBin) document.bin = body;
        at += 8 + length;
    }
    document.json = SourceText{source.file + " (JSON chunk)", std::string(json.value_or(""))};
    return document;
}

// ---- extensions ----

// What is needed to understand the geometry must be known; what only changes looks may be missed.
void check_extensions(const JsonText& json, std::vector<std::string>& warnings) {
    static constexpr std::array<std::string_view, 7> kRead{"KHR_lights_punctual",
                                                           "KHR_mesh_quantization",
                                                           "KHR_materials_unlit",
                                                           "KHR_materials_emissive_strength",
                                                           "KHR_materials_transmission",
                                                           "KHR_materials_ior",
                                                           "KHR_materials_pbrSpecularGlossiness"};
    static constexpr std::array<std::string_view, 5> kLooks{"KHR_texture_", "EXT_texture_", "MSFT_texture_",
                                                            "KHR_materials_", "KHR_animation_"};
    const auto is_read = [](std::string_view name) {
        return std::find(kRead.begin(), kRead.end(), name) != kRead.end();
    };
    const auto is_looks = [](std::string_view name) {
        return std::any_of(kLooks.begin(), kLooks.end(),
                           [&](std::string_view prefix) { return name.starts_with(prefix); });
    };
    for (const JsonValue& v : list_of(json, json.root(), "extensionsRequired")) {
        const std::string& name = json.string(v, "the name of an extension");
        if (!is_read(name) && !is_looks(name))
            json.fail(v, fmt::format("the file requires the extension {:.60}, which is not read (an export without it "
                                     "would be right)",
                                     name));
    }
    std::vector<std::string> ignored;
    for (const JsonValue& v : list_of(json, json.root(), "extensionsUsed"))
        if (const std::string& name = json.string(v, "the name of an extension"); !is_read(name))
            ignored.push_back(name);
    if (ignored.size() > 10) ignored.resize(10);
    if (!ignored.empty())
        warnings.push_back(fmt::format("Extensions that are not read are ignored: {}.", fmt::join(ignored, ", ")));
}

// ---- reading members ----

double number_or(const JsonText& json, const JsonValue* object, std::string_view key, const Range& range,
                 double fallback) {
    const JsonValue* v = object ? find_member(*object, key) : nullptr;
    return v ? json.number(*v, key, range) : fallback;
}

std::vector<double> numbers(const JsonText& json, const JsonValue& v, std::string_view what, std::size_t n,
                            const Range& range) {
    const std::string right = fmt::format("{} numbers [...]", n);
    const JsonArray& list   = json.array(v, what, right);
    if (list.size() != n) json.wrong_type(v, what, right);
    std::vector<double> out;
    for (const JsonValue& x : list) out.push_back(json.number(x, what, range));
    return out;
}

dvec3 vector_or(const JsonText& json, const JsonValue* object, std::string_view key, const Range& range,
                dvec3 fallback) {
    const JsonValue* v = object ? find_member(*object, key) : nullptr;
    return v ? json.vector(*v, key, range) : fallback;
}

const JsonValue* extension(const JsonText& json, const JsonValue& object, std::string_view name) {
    const JsonValue* all = find_member(object, "extensions");
    if (!all) return nullptr;
    (void)json.object(*all, "extensions");
    const JsonValue* v = find_member(*all, name);
    if (v) (void)json.object(*v, name);
    return v;
}

std::string name_of(const JsonText& json, const JsonValue& object, std::string_view fallback) {
    const JsonValue* v = find_member(object, "name");
    if (!v) return std::string(fallback);
    const std::string& name = json.string(*v, "name");
    return name.empty() ? std::string(fallback) : name.substr(0, 200);
}

// ---- materials ----

void set_lobe(Material& m, dvec3 f0, double roughness) {
    const double a2 = std::pow(std::max(roughness, 1e-3), 4);
    m.k_s           = vec3(f0 * std::min(1.0, 1 / (4 * a2)));
    m.shininess     = static_cast<float>(std::clamp(1 / (2 * a2) - 0.5, 1.0, 10000.0));
}

Material default_material() {
    Material m;  // the format's default: a rough white metal
    m.name = "default";
    m.k_d = m.k_a = vec3(0);
    m.two_sided   = false;
    set_lobe(m, dvec3(1), 1);
    return m;
}

struct Seen {
    bool textures = false, too_bright = false, colours = false, skins = false, morphs = false, no_position = false;
    std::size_t points_and_lines = 0;
};

// Textures are not read, but a fault in what refers to them may be a fault of the whole.
void check_textures(const JsonText& json, const JsonValue& object, std::initializer_list<std::string_view> keys,
                    Seen& seen) {
    for (const auto key : keys)
        if (const JsonValue* t = find_member(object, key)) {
            (void)json.object(*t, key);
            seen.textures = true;
            for (const auto factor : {"scale", "strength"}) (void)number_or(json, t, factor, kAny, 1);
            if (const JsonValue* index = find_member(*t, "index"))
                (void)index_into(json, *index, "texture", list_of(json, json.root(), "textures").size());
        }
}

Material read_material(const JsonText& json, const JsonValue& v, std::size_t index, Seen& seen) {
    const auto what = fmt::format("materials[{}]", index);
    (void)json.object(v, what);
    Material m             = default_material();
    m.name                 = name_of(json, v, fmt::format("material_{}", index));
    const JsonValue* pbr   = find_member(v, "pbrMetallicRoughness");
    const JsonValue* gloss = extension(json, v, "KHR_materials_pbrSpecularGlossiness");
    if (pbr) (void)json.object(*pbr, "pbrMetallicRoughness");

    std::vector<double> base{1, 1, 1, 1};
    const JsonValue* colour = gloss ? find_member(*gloss, "diffuseFactor")
                              : pbr ? find_member(*pbr, "baseColorFactor")
                                    : nullptr;
    if (colour) base = numbers(json, *colour, gloss ? "diffuseFactor" : "baseColorFactor", 4, kShare);
    const dvec3 c(base[0], base[1], base[2]);
    m.O_d = vec3(c);
    if (gloss) {
        const dvec3 f0 = vector_or(json, gloss, "specularFactor", kShare, dvec3(1));
        m.k_d          = vec3(static_cast<float>(1 - std::max({f0.x, f0.y, f0.z})));
        set_lobe(m, f0, 1 - number_or(json, gloss, "glossinessFactor", kShare, 1));
    } else {
        const double metallic  = number_or(json, pbr, "metallicFactor", kShare, 1);
        const double roughness = number_or(json, pbr, "roughnessFactor", kShare, 1);
        m.k_d                  = vec3(static_cast<float>(0.96 * (1 - metallic)));
        set_lobe(m, 0.04 * (1 - metallic) + c * metallic, roughness);
    }
    m.k_a = m.k_d;

    const dvec3 emissive = vector_or(json, &v, "emissiveFactor", kNotNegative, dvec3(0));
    if (std::max({emissive.x, emissive.y, emissive.z}) > 1) seen.too_bright = true;
    m.emission = vec3(emissive * number_or(json, extension(json, v, "KHR_materials_emissive_strength"),
                                           "emissiveStrength", kNotNegative, 1));
    if (extension(json, v, "KHR_materials_unlit")) {
        m.emission = vec3(c);
        m.k_a = m.k_d = m.k_s = vec3(0);
    }
    m.transmit = static_cast<float>(
        number_or(json, extension(json, v, "KHR_materials_transmission"), "transmissionFactor", kShare, 0));
    const double ior = number_or(json, extension(json, v, "KHR_materials_ior"), "ior", kNotNegative, 1.5);
    if (m.transmit > 0 && ior > 0) m.index_of_refraction = static_cast<float>(ior);

    if (const JsonValue* mode = find_member(v, "alphaMode");
        mode && json.choice(*mode, "alphaMode", {"OPAQUE", "MASK", "BLEND"}) > 0)
        m.opacity = static_cast<float>(base[3]);
    if (const JsonValue* sides = find_member(v, "doubleSided")) m.two_sided = json.boolean(*sides, "doubleSided");

    check_textures(json, v, {"normalTexture", "occlusionTexture", "emissiveTexture"}, seen);
    if (pbr) check_textures(json, *pbr, {"baseColorTexture", "metallicRoughnessTexture"}, seen);
    if (const JsonValue* extras = find_umbra(v)) apply_material_extras(json, *extras, m);
    return m;
}

// ---- lights ----

// A punctual light before a node places it; nothing where its type is unknown.
std::optional<Light> read_light(const JsonText& json, const JsonValue& v, std::size_t index,
                                std::vector<std::string>& warnings) {
    const auto what = fmt::format("lights[{}]", index);
    (void)json.object(v, what);
    Light light;
    light.name            = name_of(json, v, "");
    const JsonValue* type = find_member(v, "type");
    if (!type) json.fail(v, what + " has no type (directional, point or spot would be right)");
    const std::string& kind = json.string(*type, "type");
    if (kind == "directional")
        light.kind = LightKind::directional;
    else if (kind == "point")
        light.kind = LightKind::point;
    else if (kind == "spot")
        light.kind = LightKind::spot;
    else {
        warnings.push_back(
            fmt::format("{} \"{}\" is of the unknown type \"{:.40}\" (known: directional, point, spot): "
                        "it is left out.",
                        what, light.name, kind));
        return std::nullopt;
    }
    const dvec3 colour = vector_or(json, &v, "color", kNotNegative, dvec3(1));
    light.diffuse      = vec3(colour * number_or(json, &v, "intensity", kNotNegative, 1));
    light.specular     = light.diffuse;
    light.attenuation  = {0, 0, 1, false};
    if (const JsonValue* range = find_member(v, "range")) {
        light.range = static_cast<float>(json.number(*range, "range", kPositive));
        if (light.kind == LightKind::directional) {
            light.range = 0;
            warnings.push_back(fmt::format("{} \"{}\" is directional: its range is ignored.", what, light.name));
        }
    }
    if (light.kind == LightKind::directional) light.attenuation = {1, 0, 0, true};
    if (light.kind == LightKind::spot) {
        const JsonValue* spot = find_member(v, "spot");
        if (!spot) json.fail(v, what + " is a spot light without \"spot\" (\"spot\": {} would be right)");
        (void)json.object(*spot, "spot");
        // Exporters write the float next to pi/2, which is a little above it.
        const double outer =
            number_or(json, spot, "outerConeAngle",
                      {1e-6, double(float(kPi / 2)), false, "an angle above 0, at most pi/2"}, kPi / 4);
        const double inner = number_or(json, spot, "innerConeAngle", kNotNegative, 0);
        light.spot.falloff = SpotFalloff::smooth;
        light.spot.cutoff  = static_cast<float>(outer);
        light.spot.inner   = static_cast<float>(inner);
        if (light.spot.inner >= light.spot.cutoff)
            json.fail(*spot,
                      fmt::format("{}: innerConeAngle {:g} is not less than outerConeAngle {:g}", what, inner, outer));
    }
    if (const JsonValue* extras = find_umbra(v)) apply_light_extras(json, *extras, light);
    return light;
}

// ---- cameras ----

struct Lens {
    Camera camera;
    double aspect = 0;  ///< 0: the file leaves it open
};

Lens read_camera(const JsonText& json, const JsonValue& v, std::size_t index, std::vector<std::string>& warnings) {
    const auto what = fmt::format("cameras[{}]", index);
    (void)json.object(v, what);
    Lens lens;
    const JsonValue* type = find_member(v, "type");
    if (!type) json.fail(v, what + " has no type (perspective or orthographic would be right)");
    const bool perspective = json.choice(*type, "type", {"perspective", "orthographic"}) == 0;
    const JsonValue* p     = find_member(v, perspective ? "perspective" : "orthographic");
    if (!p) json.fail(v, fmt::format("{} has no \"{}\"", what, perspective ? "perspective" : "orthographic"));
    (void)json.object(*p, what);
    const auto need = [&](std::string_view key, const Range& range) {
        const JsonValue* x = find_member(*p, key);
        if (!x) json.fail(*p, fmt::format("{} has no {}", what, key));
        return json.number(*x, key, range);
    };
    const double znear = perspective ? need("znear", kPositive) : need("znear", kNotNegative);
    if (const JsonValue* zfar = find_member(*p, "zfar"); zfar || !perspective) {
        const double z = zfar ? json.number(*zfar, "zfar", kPositive) : need("zfar", kPositive);
        if (z <= znear) json.fail(*zfar, fmt::format("zfar {:g} is not beyond znear {:g}", z, znear));
    }
    if (perspective) {
        const double yfov = need("yfov", {0, kPi, true, "an angle between 0 and pi"});
        lens.camera.fov_y = static_cast<float>(glm::degrees(yfov));
        lens.aspect       = number_or(json, p, "aspectRatio", kPositive, 0);
    } else {
        const double x = need("xmag", kAny), y = need("ymag", kAny);
        if (x == 0 || y == 0) json.fail(*p, what + ": xmag or ymag is 0 (positive numbers would be right)");
        if (x < 0 || y < 0) warnings.push_back(what + ": xmag and ymag are taken without their sign.");
        lens.camera.projection = Projection::orthographic;
        lens.camera.height     = static_cast<float>(2 * std::abs(y));
        lens.aspect            = std::abs(x / y);
    }
    return lens;
}

// The picture's longer side is 640 pixels.
void set_size(Scene& scene, double aspect) {
    if (aspect == 0) return;
    scene.width  = aspect >= 1 ? 640 : int(std::lround(std::max(1.0, 640 * aspect)));
    scene.height = aspect >= 1 ? int(std::lround(std::max(1.0, 640 / aspect))) : 640;
}

// ---- nodes ----

struct Node {
    const JsonValue* json = nullptr;
    dmat4 local{1};
    std::vector<std::size_t> children;
};

dmat4 local_transform(const JsonText& json, const JsonValue& v, const std::string& what) {
    const JsonValue* matrix = find_member(v, "matrix");
    if (!matrix) {
        const dvec3 t = vector_or(json, &v, "translation", kAny, dvec3(0));
        const dvec3 s = vector_or(json, &v, "scale", kAny, dvec3(1));
        glm::dquat q(1, 0, 0, 0);
        if (const JsonValue* r = find_member(v, "rotation")) {
            const auto x = numbers(json, *r, "rotation", 4, kAny);
            q            = glm::dquat(x[3], x[0], x[1], x[2]);
            if (const double length = glm::length(q); std::abs(length - 1) > 0.01)
                json.fail(*r, fmt::format("rotation has length {:g} (a unit quaternion would be right)", length));
            q = glm::normalize(q);
        }
        dmat4 m(glm::mat3_cast(q));
        for (int k = 0; k < 3; ++k) m[k] *= s[k];
        m[3] = dvec4(t, 1);
        return m;
    }
    for (const auto key : {"translation", "rotation", "scale"})
        if (find_member(v, key))
            json.fail(v, fmt::format("{} has both matrix and {} (one of them would be right)", what, key));
    const auto x = numbers(json, *matrix, "matrix", 16, kAny);
    dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = x[std::size_t(i)];
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
        json.fail(*matrix,
                  fmt::format("the last row of matrix is ({:g}, {:g}, {:g}, {:g}) ((0, 0, 0, 1) would be right)",
                              m[0][3], m[1][3], m[2][3], m[3][3]));
    return m;
}

std::vector<Node> read_nodes(const JsonText& json) {
    const JsonArray& list = list_of(json, json.root(), "nodes");
    std::vector<Node> nodes(list.size());
    constexpr auto kRoot = std::size_t(-1);
    std::vector<std::size_t> parent(list.size(), kRoot);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const auto what = fmt::format("nodes[{}]", i);
        (void)json.object(list[i], what);
        nodes[i].json  = &list[i];
        nodes[i].local = local_transform(json, list[i], what);
        for (const JsonValue& c : list_of(json, list[i], "children")) {
            const std::size_t child = index_into(json, c, "node", list.size());
            if (parent[child] != kRoot)
                json.fail(c, fmt::format("node {} is a child of node {} already (one parent would be right)", child,
                                         parent[child]));
            parent[child] = i;
            nodes[i].children.push_back(child);
        }
    }
    // With one parent each, whoever climbs more steps than there are nodes runs in a circle. Those whose way up is
    // known to end are not climbed again.
    std::vector<bool> ends(list.size(), false);
    for (std::size_t i = 0; i < list.size(); ++i) {
        std::vector<std::size_t> way;
        for (std::size_t n = i; n != kRoot && !ends[n]; n = parent[n]) {
            if (way.size() > list.size())
                json.fail(list[i], fmt::format("nodes[{}] is its own ancestor (a tree would be right)", i));
            way.push_back(n);
        }
        for (const std::size_t n : way) ends[n] = true;
    }
    return nodes;
}

// The nodes where the walk begins: those of the scene, or all that have no parent.
std::vector<std::size_t> read_roots(const JsonText& json, const std::vector<Node>& nodes, Scene& scene) {
    const JsonArray& scenes = list_of(json, json.root(), "scenes");
    const JsonValue* chosen = find_member(json.root(), "scene");
    std::size_t which       = 0;
    if (chosen) which = index_into(json, *chosen, "scene", scenes.size());
    std::vector<bool> is_child(nodes.size(), false);
    for (const Node& n : nodes)
        for (const std::size_t c : n.children) is_child[c] = true;
    std::vector<std::size_t> roots;
    if (scenes.empty()) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (!is_child[i]) roots.push_back(i);
        if (!nodes.empty()) scene.warnings.emplace_back("The file has no scenes: all its nodes are taken.");
        return roots;
    }
    if (scenes.size() > 1 && !chosen)
        scene.warnings.push_back(
            fmt::format("The file names none of its {} scenes as the one to show: the first is "
                        "taken.",
                        scenes.size()));
    const JsonValue& s = scenes[which];
    (void)json.object(s, "scene");
    if (find_member(s, "name")) scene.title = name_of(json, s, "");
    std::vector<bool> taken(nodes.size(), false);
    for (const JsonValue& v : list_of(json, s, "nodes")) {
        const std::size_t n = index_into(json, v, "node", nodes.size());
        if (taken[n] || is_child[n])
            json.fail(v, fmt::format("node {} is {} (a scene's nodes are roots, each once)", n,
                                     taken[n] ? "named twice" : "the child of another"));
        taken[n] = true;
        roots.push_back(n);
    }
    return roots;
}

// ---- meshes ----

struct Primitive {
    std::string name;
    Mesh mesh;  ///< in its own space, with the positions that its triangles use
    std::optional<std::size_t> material;
};

std::vector<uvec3> as_triangles(const std::vector<std::uint32_t>& v, int mode) {
    std::vector<uvec3> out;
    if (mode == 4)
        for (std::size_t i = 0; i + 2 < v.size(); i += 3) out.emplace_back(v[i], v[i + 1], v[i + 2]);
    if (mode == 5)
        for (std::size_t i = 0; i + 2 < v.size(); ++i) out.emplace_back(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]);
    if (mode == 6)
        for (std::size_t i = 0; i + 2 < v.size(); ++i) out.emplace_back(v[i + 1], v[i + 2], v[0]);
    return out;
}

std::optional<Primitive> read_primitive(const JsonText& json, const GltfData& data, const JsonValue& v,
                                        const std::string& what, std::size_t materials, Seen& seen,
                                        std::vector<std::string>& warnings) {
    (void)json.object(v, what);
    Primitive primitive;
    if (const JsonValue* m = find_member(v, "material"))
        primitive.material = index_into(json, *m, "material", materials);
    const JsonValue* mode_value = find_member(v, "mode");
    const int mode              = mode_value ? int(whole(json, *mode_value, "mode", 0, 6)) : 4;
    const JsonValue* attributes = find_member(v, "attributes");
    if (!attributes) json.fail(v, what + " has no attributes");

    const auto& accessors        = data.accessors();
    const GltfAccessor* position = nullptr;
    const GltfAccessor* normal   = nullptr;
    const GltfAccessor* first    = nullptr;
    for (const JsonMember& a : json.object(*attributes, "attributes")) {
        const GltfAccessor& accessor = accessors[index_into(json, a.value, a.key, accessors.size())];
        if (first && accessor.count != first->count)
            json.fail(a.value, fmt::format("{} has {} elements, another attribute {} (the same number would be right)",
                                           a.key, accessor.count, first->count));
        first = &accessor;
        if (a.key == "POSITION" || a.key == "NORMAL") {
            if (accessor.components != 3 || accessor.component_type == 5125)
                json.fail(a.value, fmt::format("{} is no accessor of type VEC3 and float", a.key));
            (a.key == "POSITION" ? position : normal) = &accessor;
        }
        if (a.key == "COLOR_0") seen.colours = true;
    }
    if (find_member(v, "targets")) seen.morphs = true;
    const GltfAccessor* index = nullptr;
    if (const JsonValue* i = find_member(v, "indices")) {
        index = &accessors[index_into(json, *i, "indices", accessors.size())];
        if (index->components != 1 ||
            (index->component_type != 5121 && index->component_type != 5123 && index->component_type != 5125))
            json.fail(*i, "indices are no accessor of type SCALAR and 5121, 5123 or 5125");
    }
    if (extension(json, v, "KHR_draco_mesh_compression") && position && position->bytes.empty())
        json.fail(v, what + " is compressed by KHR_draco_mesh_compression (an export without it would be right)");
    if (!position) {
        seen.no_position = true;
        return std::nullopt;
    }
    if (mode < 4) {
        ++seen.points_and_lines;
        return std::nullopt;
    }

    std::vector<std::uint32_t> corners;
    if (index) {
        corners = data.indices(*index);
        for (std::size_t i = 0; i < corners.size(); ++i)
            if (corners[i] >= position->count)
                json.fail(*index->json, fmt::format("index {} of {} is {}, but there are {} positions, counted from 0",
                                                    i, what, corners[i], position->count));
    } else {
        if (position->count > kMaxTriangles * 3) json.fail(*position->json, "too many positions");
        for (std::uint32_t i = 0; i < position->count; ++i) corners.push_back(i);
    }
    if (corners.size() < 3 || (mode == 4 && corners.size() % 3 != 0))
        warnings.push_back(fmt::format("{} has {} corners, which {}.", what, corners.size(),
                                       corners.size() < 3 ? "make no triangle" : "leave some over: they are left out"));
    primitive.mesh.triangles = as_triangles(corners, mode);

    // Only what triangles use is kept: many primitives may share one long list of positions.
    const std::vector<vec3> positions = data.vectors(*position);
    const std::vector<vec3> normals   = normal ? data.vectors(*normal) : std::vector<vec3>{};
    std::vector<std::uint32_t> local(positions.size(), 0xffffffffu);
    for (uvec3& t : primitive.mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            std::uint32_t& l = local[t[k]];
            if (l == 0xffffffffu) {
                l = std::uint32_t(primitive.mesh.positions.size());
                primitive.mesh.positions.push_back(positions[t[k]]);
                if (normal) primitive.mesh.normals.push_back(normals[t[k]]);
            }
            t[k] = l;
        }
    return primitive;
}

std::vector<std::vector<Primitive>> read_meshes(const JsonText& json, const GltfData& data, std::size_t materials,
                                                Seen& seen, std::vector<std::string>& warnings) {
    std::vector<std::vector<Primitive>> meshes;
    const JsonArray& list   = list_of(json, json.root(), "meshes");
    std::uint64_t triangles = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
        (void)json.object(list[i], fmt::format("meshes[{}]", i));
        const std::string name      = name_of(json, list[i], fmt::format("mesh_{}", i));
        const JsonArray& primitives = list_of(json, list[i], "primitives");
        std::vector<Primitive> mesh;
        for (std::size_t p = 0; p < primitives.size(); ++p) {
            const auto what = fmt::format("meshes[{}].primitives[{}]", i, p);
            auto primitive  = read_primitive(json, data, primitives[p], what, materials, seen, warnings);
            if (!primitive) continue;
            primitive->name = primitives.size() > 1 ? fmt::format("{}.{}", name, p) : name;
            triangles += primitive->mesh.triangles.size();
            if (triangles > kMaxTriangles)
                json.fail(primitives[p], fmt::format("more than {} triangles with this one", kMaxTriangles));
            mesh.push_back(std::move(*primitive));
        }
        meshes.push_back(std::move(mesh));
    }
    return meshes;
}

// In double, so that a deep hierarchy does not blur positions. A transform that flattens leaves no normals.
Mesh placed(const Mesh& mesh, const dmat4& m) {
    const dmat3 linear(m);
    const double det = glm::determinant(linear);
    Mesh out;
    out.positions.reserve(mesh.positions.size());
    for (const vec3 p : mesh.positions) out.positions.emplace_back(dvec3(m * dvec4(dvec3(p), 1)));
    if (!mesh.normals.empty() && det != 0 && std::isfinite(det)) {
        const dmat3 for_normals = glm::transpose(glm::inverse(linear));
        for (const vec3 n : mesh.normals) {
            const dvec3 turned  = for_normals * dvec3(n);
            const double length = glm::length(turned);
            out.normals.emplace_back(length > 0 && std::isfinite(length) ? turned / length : dvec3(0));
        }
    }
    out.triangles = mesh.triangles;
    if (det < 0)
        for (uvec3& t : out.triangles) std::swap(t.y, t.z);
    return out;
}

// ---- exposure ----

// Lights in lux and candela make pictures of any brightness. What arrives at the middle triangle is made 1.
void set_exposure(Scene& scene) {
    constexpr std::size_t kSamples = 4096;
    const std::size_t step         = scene.triangles.size() / kSamples + 1;
    std::vector<float> arriving;
    for (std::size_t t = 0; t < scene.triangles.size(); t += step) {
        const auto id     = TriangleId(t);
        const vec3 centre = scene.vertex(id, 0) / 3.0f + scene.vertex(id, 1) / 3.0f + scene.vertex(id, 2) / 3.0f;
        vec3 sum(0);
        for (const Light& light : scene.lights) sum += falloff(light, centre) * light.diffuse;
        arriving.push_back(std::max({sum.r, sum.g, sum.b}));
    }
    std::erase_if(arriving, [](float e) { return !(e > 0) || !std::isfinite(e); });  // outside cones and ranges
    if (arriving.empty()) return;
    const auto middle = arriving.begin() + std::ptrdiff_t(arriving.size() / 2);
    std::nth_element(arriving.begin(), middle, arriving.end());
    if (*middle >= 0.1f && *middle <= 2.0f) return;
    scene.exposure = 1 / *middle;
    scene.warnings.push_back(
        fmt::format("The lights are given in lux or candela, of which {:.3g} arrive at the middle "
                    "triangle: the exposure is set to {:.3g}.",
                    *middle, scene.exposure));
}

void warn_of(const Seen& seen, std::vector<std::string>& warnings) {
    if (seen.textures) warnings.emplace_back("Textures are ignored: surfaces have their factors' colours.");
    if (seen.colours) warnings.emplace_back("Colours of vertices are ignored.");
    if (seen.too_bright)
        warnings.emplace_back("An emissiveFactor is above 1, which the format forbids: it is taken as it is.");
    if (seen.skins) warnings.emplace_back("Skins are not applied: meshes stand as their nodes place them.");
    if (seen.morphs) warnings.emplace_back("Morph targets are ignored.");
    if (seen.no_position) warnings.emplace_back("A primitive without positions is left out.");
    if (seen.points_and_lines > 0)
        warnings.push_back(fmt::format("{} primitives of points or lines are left out.", seen.points_and_lines));
}

// ---- the scene ----

class Walk {
public:
    Walk(const JsonText& json, SceneFile& read) : json_(json), read_(read), scene_(read.scene) {}

    std::vector<std::vector<Primitive>> meshes;
    std::vector<std::optional<Light>> lights;
    std::vector<Lens> lenses;
    Seen seen;

    // Every node's references are checked, those of no scene included, and how much they would place: many nodes may
    // share one large mesh.
    void check(const std::vector<Node>& nodes) {
        std::uint64_t triangles = 0;
        for (const Node& n : nodes) {
            if (const JsonValue* v = find_member(*n.json, "mesh")) {
                for (const Primitive& p : meshes[index_into(json_, *v, "mesh", meshes.size())])
                    triangles += p.mesh.triangles.size();
                if (triangles > kMaxTriangles)
                    json_.fail(*v, fmt::format("more than {} triangles with this node", kMaxTriangles));
            }
            if (const JsonValue* v = find_member(*n.json, "camera"))
                (void)index_into(json_, *v, "camera", lenses.size());
            if (const JsonValue* v = light_of(n)) (void)index_into(json_, *v, "light", lights.size());
        }
    }

    void walk(const std::vector<Node>& nodes, const std::vector<std::size_t>& roots) {
        struct Visit {
            std::size_t node;
            dmat4 parent;
        };
        std::vector<Visit> open;  // own stack: a hierarchy may be as deep as the file is long
        for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, dmat4(1)});
        while (!open.empty()) {
            const Visit visit = open.back();
            open.pop_back();
            const Node& node      = nodes[visit.node];
            const dmat4 transform = visit.parent * node.local;
            place(node, transform);
            for (auto c = node.children.rbegin(); c != node.children.rend(); ++c) open.push_back({*c, transform});
        }
    }

    // What no node placed. A file without nodes is a library of meshes: they are shown where they are.
    void finish(bool no_nodes) {
        if (no_nodes && !meshes.empty()) {
            scene_.warnings.emplace_back("The file has no nodes: all its meshes are taken, where they are.");
            for (const auto& mesh : meshes) add_mesh(json_.root(), "", mesh, dmat4(1));
        }
        if (!lights.empty() && !placed_light_)
            scene_.warnings.emplace_back("No node of the scene places one of the file's lights: they are left out.");
        if (!lenses.empty() && !lens_)
            scene_.warnings.emplace_back("No node of the scene places one of the file's cameras: they are left out.");
        aim_camera();
    }

private:
    // The camera looks along its node's -z; the target lies where the scene's middle is, or somewhere before the eye.
    void aim_camera() {
        if (!lens_) return;
        Camera camera       = lens_->camera;
        const dvec3 eye     = dvec3(camera_transform_[3]);
        const dvec3 forward = direction(camera_transform_, 2, -1, "camera");
        const Box box       = bounds(scene_);
        const double middle = box.empty() ? 0 : glm::dot(dvec3(box.centre()) - eye, forward);
        camera.eye          = vec3(eye);
        camera.target       = vec3(eye + forward * std::max({middle, 1e-3 * glm::length(eye), middle > 0 ? 0.0 : 1.0}));
        camera.up           = vec3(direction(camera_transform_, 1, 1, "camera"));
        scene_.camera       = camera;
        read_.has_camera    = true;
        set_size(scene_, lens_->aspect);
    }

    const JsonValue* light_of(const Node& n) const {
        const JsonValue* e = extension(json_, *n.json, "KHR_lights_punctual");
        if (!e) return nullptr;
        const JsonValue* v = find_member(*e, "light");
        if (!v) json_.fail(*e, "KHR_lights_punctual of a node has no light");
        return v;
    }

    dvec3 direction(const dmat4& m, int axis, double sign, std::string_view what) const {
        const dvec3 d  = dvec3(m[axis]) * sign;
        const double l = glm::length(d);
        if (!(l > 0) || !std::isfinite(l))
            throw InputError(
                fmt::format("{}: a {}'s node has a transform without direction", json_.source().file, what));
        return d / l;
    }

    void add_mesh(const JsonValue& at, const std::string& name, const std::vector<Primitive>& primitives,
                  const dmat4& m) {
        for (const Primitive& p : primitives) {
            if (p.mesh.triangles.empty()) continue;
            const Mesh mesh = placed(p.mesh, m);
            for (const vec3 q : mesh.positions)
                if (!(std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)}) <= float(kMaxCoordinate)))
                    json_.fail(at, fmt::format("this node places a vertex at ({:g}, {:g}, {:g}) (magnitudes up to {:g} "
                                               "would be right)",
                                               q.x, q.y, q.z, kMaxCoordinate));
            add_object(scene_, name.empty() ? p.name : name, mesh.positions, mesh.normals, mesh.triangles,
                       material_of(p));
        }
    }

    void place(const Node& node, const dmat4& m) {
        const JsonValue& v     = *node.json;
        const std::string name = name_of(json_, v, "");
        if (const JsonValue* mesh = find_member(v, "mesh"))
            add_mesh(v, name, meshes[index_into(json_, *mesh, "mesh", meshes.size())], m);
        if (find_member(v, "skin")) seen.skins = true;
        if (const JsonValue* camera = find_member(v, "camera")) {
            const std::size_t c = index_into(json_, *camera, "camera", lenses.size());
            if (!lens_) {
                lens_             = lenses[c];
                camera_transform_ = m;
            } else if (!warned_of_cameras_) {
                warned_of_cameras_ = true;
                scene_.warnings.emplace_back("The scene has several cameras: the first is taken.");
            }
        }
        if (const JsonValue* l = light_of(node)) {
            placed_light_ = true;
            if (const auto& kind = lights[index_into(json_, *l, "light", lights.size())]) {
                Light light = *kind;
                if (!name.empty() && light.name.empty()) light.name = name;
                light.position = vec3(dvec3(m[3]));
                if (light.kind != LightKind::point) light.direction = vec3(direction(m, 2, -1, "light"));
                add_light(v, std::move(light));
            }
        }
        if (const JsonValue* extras = find_umbra(v))
            if (auto light = read_area_light(json_, *extras, m)) {
                if (light->name.empty()) light->name = name;
                add_light(v, std::move(*light));
            }
    }

    void add_light(const JsonValue& node, Light light) {
        if (scene_.lights.size() >= kMaxLights) json_.fail(node, fmt::format("more than {} lights", kMaxLights));
        scene_.lights.push_back(std::move(light));
    }

    std::uint32_t material_of(const Primitive& p) {
        if (p.material) return std::uint32_t(*p.material);
        if (!default_) {
            default_ = std::uint32_t(scene_.materials.size());
            scene_.materials.push_back(default_material());
        }
        return *default_;
    }

    const JsonText& json_;
    SceneFile& read_;
    Scene& scene_;
    std::optional<Lens> lens_;
    dmat4 camera_transform_{1};
    bool warned_of_cameras_ = false;
    bool placed_light_      = false;
    std::optional<std::uint32_t> default_;
};

void check_version(const JsonText& json) {
    (void)json.object(json.root(), "the document");
    const JsonValue* asset = find_member(json.root(), "asset");
    if (!asset)
        json.fail(json.root(), "no \"asset\", so this is not glTF (\"asset\": {\"version\": \"2.0\"} would be right)");
    (void)json.object(*asset, "asset");
    const JsonValue* version = find_member(*asset, "version");
    if (!version) json.fail(*asset, "asset has no version (\"2.0\" would be right)");
    if (!json.string(*version, "version").starts_with("2."))
        json.fail(*version,
                  fmt::format("version \"{:.20}\" (\"2.0\" would be right)", json.string(*version, "version")));
}

}  // namespace

SceneFile read_gltf(const path& file) {
    Document document = open_document(file);
    const JsonText json(std::move(document.json));
    check_version(json);

    SceneFile read;
    Scene& scene   = read.scene;
    auto& warnings = scene.warnings;
    check_extensions(json, warnings);
    const GltfData data(json, file, document.bin);

    Walk walk(json, read);
    const JsonArray& materials = list_of(json, json.root(), "materials");
    for (std::size_t i = 0; i < materials.size(); ++i)
        scene.materials.push_back(read_material(json, materials[i], i, walk.seen));
    if (const JsonValue* punctual = extension(json, json.root(), "KHR_lights_punctual")) {
        const JsonArray& list = list_of(json, *punctual, "lights");
        for (std::size_t i = 0; i < list.size(); ++i) walk.lights.push_back(read_light(json, list[i], i, warnings));
    }
    const JsonArray& cameras = list_of(json, json.root(), "cameras");
    for (std::size_t i = 0; i < cameras.size(); ++i) walk.lenses.push_back(read_camera(json, cameras[i], i, warnings));
    walk.meshes = read_meshes(json, data, materials.size(), walk.seen, warnings);

    const std::vector<Node> nodes = read_nodes(json);
    walk.check(nodes);
    walk.walk(nodes, read_roots(json, nodes, scene));
    walk.finish(nodes.empty());

    scene.ambient      = vec3(0.1f);
    bool says_ambient  = false;
    bool says_exposure = false;
    if (const JsonValue* extras = find_scene_umbra(json)) {
        const SceneExtras said = apply_scene_extras(json, *extras, scene);
        says_ambient           = said.ambient;
        says_exposure          = said.exposure;
    }
    if (!says_ambient) warnings.emplace_back("glTF knows no ambient light: I_a = 0.1 is assumed.");
    if (!says_exposure) set_exposure(scene);
    warn_of(walk.seen, warnings);
    return read;
}

}  // namespace umbra
