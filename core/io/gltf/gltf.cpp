// glTF 2.0 scenes, .gltf and .glb.
//
// The document is read as JSON with the offset of each value, not by one of the glTF libraries: those at hand follow
// indices and lengths of the file unchecked, and can name no line. This file reads a small part of the format.
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
//   baseColorFactor's alpha         alphaMode BLEND: opacity; MASK: below alphaCutoff the primitive is left out
//   alphaMode MASK with a texture   the texels whose alpha is at least alphaCutoff, as polygons (cutout.h); `cutout`
//                                   where they would be too many, or the image is not read
//   KHR_materials_transmission, _ior  transmit, transmit_colour (the base colour), index_of_refraction
//   doubleSided                     two_sided
//   KHR_lights_punctual             I_j = colour x intensity, as is (lux or candela); f_att = 1 / d^2 without limit;
//                                   range as a sharp limit; spots with falloff `smooth`, whose inner angle is moved
//                                   to where the extension's own formula reaches its largest value; equal angles: a
//                                   hard edge, with a warning
//   EXT_lights_area (draft)         rectangle, disk: I_j = colour x intensity (nits) x area: candela along the axis;
//                                   f_att = 1 / d^2 without limit
//   exposure                        1; with punctual lights 1 / E where the median E over the triangles of the light
//                                   that arrives, sum_j f_att,j I_j, lies outside [0.1, 2]
//   (no ambient light)              I_a = 0.1
//   morph targets                   displaced by the weights of the mesh, or of the node where it has some
//   skins                           sum_k w_k J_k B_k p / sum_k w_k: joints J_k where the file's nodes place them,
//                                   inverse bind matrices B_k; the transform of the mesh's own node does not count
//   textures, vertex colours, animations   not read, with a warning
//   EXT_mesh_gpu_instancing         an object for each instance and primitive
//   KHR_node_visibility             what is not visible is left out, with all below it
//   points, lines                   left out, with a warning
//   extras.umbra                    extras.cpp
//
// This work is based on:
// Khronos Group. glTF 2.0 Specification. 2021; KHR_lights_punctual. 2018; EXT_lights_area. Draft of 2025
// Bruce Walter, Stephen Marschner, Hongsong Li, Kenneth Torrance. Microfacet Models for Refraction through Rough
// Surfaces. 2007
// Frederick Fisher, Andrew Woo. R.E versus N.H Specular Highlights. Graphics Gems IV. 1994
#include <algorithm>

#include <fmt/format.h>

#include "umbra/core/base/error.h"
#include "umbra/core/io/gltf/cameras.h"
#include "umbra/core/io/gltf/container.h"
#include "umbra/core/io/gltf/data.h"
#include "umbra/core/io/gltf/exposure.h"
#include "umbra/core/io/gltf/extras.h"
#include "umbra/core/io/gltf/lights.h"
#include "umbra/core/io/gltf/materials.h"
#include "umbra/core/io/gltf/members.h"
#include "umbra/core/io/gltf/meshes.h"
#include "umbra/core/io/gltf/nodes.h"
#include "umbra/core/io/gltf/notes.h"
#include "umbra/core/io/gltf/scene_builder.h"
#include "umbra/core/io/scene_readers.h"

namespace umbra {
namespace {

std::vector<Material> read_materials(const JsonText& json, GltfNotes& notes) {
    std::vector<Material> materials;
    const JsonArray& list = list_of(json, json.root(), "materials");
    for (std::size_t i = 0; i < list.size(); ++i) materials.push_back(read_gltf_material(json, list[i], i, notes));
    return materials;
}

/// A texture that cannot be read leaves surfaces whole, as all textures do.
void read_masks(const JsonText& json, GltfData& data, std::vector<std::string>& warnings, GltfParts& parts) {
    const JsonArray& list = list_of(json, json.root(), "materials");
    for (std::size_t i = 0; i < list.size(); ++i) {
        AlphaMask& mask = parts.masks.emplace_back(read_alpha_mask(json, list[i]));
        parts.cutouts.emplace_back();
        if (!mask.texture) continue;
        try {
            parts.cutouts.back() = read_cutout(json, data, *mask.texture, mask.least);
            if (std::ranges::all_of(parts.cutouts.back()->kept, [](auto texel) { return texel != 0; }))
                mask.texture = nullptr;
        } catch (const InputError& e) {
            warnings.push_back(
                fmt::format("The texture that cuts the outlines of materials[{}] is not read: {}.", i, e.what()));
        }
    }
}

void read_lights(const JsonText& json, GltfNotes& notes, std::vector<std::string>& warnings, GltfParts& parts) {
    if (const JsonValue* punctual = extension(json, json.root(), kPunctualLights)) {
        const JsonArray& list = list_of(json, *punctual, "lights");
        for (std::size_t i = 0; i < list.size(); ++i)
            parts.lights.push_back(read_punctual_light(json, list[i], i, notes, warnings));
    }
    if (const JsonValue* flat = extension(json, json.root(), kAreaLights)) {
        const JsonArray& list = list_of(json, *flat, "lights");
        for (std::size_t i = 0; i < list.size(); ++i)
            parts.area_lights.push_back(read_flat_light(json, list[i], i, warnings));
    }
}

std::vector<Lens> read_lenses(const JsonText& json, std::vector<std::string>& warnings) {
    std::vector<Lens> lenses;
    const JsonArray& list = list_of(json, json.root(), "cameras");
    for (std::size_t i = 0; i < list.size(); ++i) lenses.push_back(read_lens(json, list[i], i, warnings));
    return lenses;
}

/// Terms of the whole scene: its name, and the terms of extras.umbra or the defaults in their place.
void read_scene_terms(const JsonText& json, Scene& scene) {
    if (const JsonValue* shown = shown_scene(json)) scene.title = name_or(json, *shown, "");
    scene.ambient = vec3(0.1f);
    SceneExtras given;
    if (const JsonValue* extras = find_scene_umbra(json)) given = apply_scene_extras(json, *extras, scene);
    if (!given.ambient) scene.warnings.emplace_back("glTF has no ambient light: I_a = 0.1 is assumed.");
    if (!given.exposure) set_exposure(scene);
    warn_of_units(scene);
}

}  // namespace

SceneFile read_gltf(const std::filesystem::path& file, const Reading& reading) {
    GltfFile source = open_gltf(file);
    const JsonText json(std::move(source.json));
    check_version(json);

    SceneFile read;
    auto& warnings = read.scene.warnings;
    warnings       = std::move(source.warnings);
    check_extensions(json, warnings);
    if (!list_of(json, json.root(), "animations").empty())
        warnings.emplace_back("Animations are ignored: nodes stand where the file places them.");
    GltfData data(json, file, source.bin);

    GltfNotes notes;
    GltfParts parts;
    read.scene.materials = read_materials(json, notes);
    read_masks(json, data, warnings, parts);
    read_lights(json, notes, warnings, parts);
    parts.lenses = read_lenses(json, warnings);
    parts.meshes = read_meshes(json, data, read.scene.materials.size(), notes, warnings);

    std::vector<Node> nodes = read_nodes(json);
    read_instances(json, data, nodes);
    parts.skins = read_skins(json, data, nodes.size());
    GltfSceneBuilder builder(json, data, parts, reading.origin, read, notes);
    builder.check_references(nodes);
    builder.place_trees(nodes, read_roots(json, nodes, warnings));
    if (nodes.empty()) builder.place_all_meshes();
    builder.finish();

    read_scene_terms(json, read.scene);
    notes.warn(warnings);
    return read;
}

}  // namespace umbra
