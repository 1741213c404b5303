#include "umbra/core/io/gltf/materials.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "umbra/core/io/gltf/extras.h"
#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/limits.h"

namespace umbra {
namespace {

double as_share(double x, GltfNotes& notes) {
    const double share = std::clamp(x, 0.0, 1.0);
    notes.no_share     = notes.no_share || share != x;
    return share;
}

double share_or(const JsonText& json, const JsonValue* object, std::string_view key, double fallback,
                GltfNotes& notes) {
    return as_share(number_or(json, object, key, kAnyNumber, fallback), notes);
}

void set_lobe(Material& m, dvec3 f0, double roughness) {
    const double a2 = std::pow(std::max(roughness, 1e-3), 4);
    m.k_s           = vec3(f0 * std::min(1.0, 1 / (4 * a2)));
    m.shininess     = static_cast<float>(std::clamp(1 / (2 * a2) - 0.5, 1.0, 10000.0));
}

}  // namespace

Material default_gltf_material() {
    Material m;
    m.name = "default";
    m.k_d = m.k_a = vec3(0);
    m.two_sided   = false;
    set_lobe(m, dvec3(1), 1);
    return m;
}

namespace {

// Textures are not read, but a fault in a reference to them may be a fault of the whole.
void check_textures(const JsonText& json, const JsonValue& object, std::initializer_list<std::string_view> keys,
                    GltfNotes& notes) {
    for (const auto key : keys)
        if (const JsonValue* t = find_member(object, key)) {
            (void)json.object(*t, key);
            notes.textures = true;
            for (const auto factor : {"scale", "strength"}) (void)number_or(json, t, factor, kAnyNumber, 1);
            if (const JsonValue* index = find_member(*t, "index"))
                (void)index_into(json, *index, "texture", list_of(json, json.root(), "textures").size());
        }
}

}  // namespace

AlphaMask read_alpha_mask(const JsonText& json, const JsonValue& material) {
    const JsonValue* mode = find_member(material, "alphaMode");
    const double cutoff   = number_or(json, &material, "alphaCutoff", kNotNegative, 0.5);
    if (!mode || json.choice(*mode, "alphaMode", {"OPAQUE", "MASK", "BLEND"}) != 1) return {};
    const JsonValue* gloss  = extension(json, material, "KHR_materials_pbrSpecularGlossiness");
    const JsonValue* values = gloss ? gloss : find_member(material, "pbrMetallicRoughness");
    const JsonValue* factor = values ? find_member(*values, gloss ? "diffuseFactor" : "baseColorFactor") : nullptr;
    const double alpha      = factor ? std::clamp(numbers(json, *factor, "the factor", 4, kAnyNumber)[3], 0.0, 1.0) : 1;
    if (alpha < cutoff) return {true, nullptr, 0};
    if (!values || cutoff == 0) return {};
    return {false, find_member(*values, gloss ? "diffuseTexture" : "baseColorTexture"), cutoff / alpha};
}

Material read_gltf_material(const JsonText& json, const JsonValue& v, std::size_t index, GltfNotes& notes) {
    const auto what = fmt::format("materials[{}]", index);
    (void)json.object(v, what);
    Material m             = default_gltf_material();
    m.name                 = name_or(json, v, fmt::format("material_{}", index));
    const JsonValue* pbr   = find_member(v, "pbrMetallicRoughness");
    const JsonValue* gloss = extension(json, v, "KHR_materials_pbrSpecularGlossiness");
    if (pbr) (void)json.object(*pbr, "pbrMetallicRoughness");

    std::vector<double> base{1, 1, 1, 1};
    const JsonValue* colour = gloss ? find_member(*gloss, "diffuseFactor")
                              : pbr ? find_member(*pbr, "baseColorFactor")
                                    : nullptr;
    if (colour) base = numbers(json, *colour, gloss ? "diffuseFactor" : "baseColorFactor", 4, kAnyNumber);
    for (double& x : base) x = as_share(x, notes);
    const dvec3 c(base[0], base[1], base[2]);
    m.O_d = vec3(c);
    if (gloss) {
        dvec3 f0 = vector_or(json, gloss, "specularFactor", kAnyNumber, dvec3(1));
        for (int k = 0; k < 3; ++k) f0[k] = as_share(f0[k], notes);
        m.k_d = vec3(static_cast<float>(1 - std::max({f0.x, f0.y, f0.z})));
        set_lobe(m, f0, 1 - share_or(json, gloss, "glossinessFactor", 1, notes));
    } else {
        const double metallic  = share_or(json, pbr, "metallicFactor", 1, notes);
        const double roughness = share_or(json, pbr, "roughnessFactor", 1, notes);
        m.k_d                  = vec3(static_cast<float>(0.96 * (1 - metallic)));
        set_lobe(m, 0.04 * (1 - metallic) + c * metallic, roughness);
    }
    m.k_a = m.k_d;

    const dvec3 emissive = vector_or(json, &v, "emissiveFactor", kNotNegative, dvec3(0));
    if (std::max({emissive.x, emissive.y, emissive.z}) > 1) notes.emissive_above_one = true;
    m.emission = vec3(emissive * number_or(json, extension(json, v, "KHR_materials_emissive_strength"),
                                           "emissiveStrength", kNotNegative, 1));
    if (extension(json, v, "KHR_materials_unlit")) {
        m.emission = vec3(c);
        m.k_a = m.k_d = m.k_s = vec3(0);
    }
    m.transmit = static_cast<float>(
        share_or(json, extension(json, v, "KHR_materials_transmission"), "transmissionFactor", 0, notes));
    if (m.transmit > 0) m.transmit_colour = vec3(glm::min(c, dvec3(1)));
    // Where the file is silent, glTF has 1.5, which only matters to materials that transmit.
    const JsonValue* given = extension(json, v, "KHR_materials_ior");
    const double ior       = number_or(json, given, "ior", kNotNegative, 1.5);
    if ((m.transmit > 0 || given) && ior > 0) m.index_of_refraction = static_cast<float>(ior);

    if (const JsonValue* mode = find_member(v, "alphaMode"))
        if (json.choice(*mode, "alphaMode", {"OPAQUE", "MASK", "BLEND"}) == 2) m.opacity = static_cast<float>(base[3]);
    if (const JsonValue* sides = find_member(v, "doubleSided")) m.two_sided = json.boolean(*sides, "doubleSided");

    check_textures(json, v, {"normalTexture", "occlusionTexture", "emissiveTexture"}, notes);
    if (pbr) check_textures(json, *pbr, {"baseColorTexture", "metallicRoughnessTexture"}, notes);
    if (const JsonValue* extras = find_umbra(v)) apply_material_extras(json, *extras, m);
    return m;
}

}  // namespace umbra
