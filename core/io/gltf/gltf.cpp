// glTF 2.0 scenes, .gltf and .glb.
//
// The document is read as JSON with the offset of each value, not by one of the glTF libraries: those at hand follow
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
//   baseColorFactor's alpha         opacity; alphaMode OPAQUE: 1, MASK: 1 from alphaCutoff on, else 0
//   KHR_materials_transmission, _ior  transmit, transmit_colour (the base colour), index_of_refraction
//   doubleSided                     two_sided
//   KHR_lights_punctual             I_j = colour x intensity, as is (lux or candela); f_att = 1 / d^2 without limit;
//                                   range as a sharp limit; spots with falloff `smooth`, whose inner angle is moved
//                                   to where the extension's own formula reaches its largest value; equal angles: a
//                                   hard edge, with a warning
//   exposure                        1; with punctual lights 1 / E where the median E over the triangles of the light
//                                   that arrives, sum_j f_att,j I_j, lies outside [0.1, 2]
//   (no ambient light)              I_a = 0.1
//   textures, vertex colours, skins, morph targets, animations   not read, with a warning
//   EXT_mesh_gpu_instancing         an object for each instance and primitive
//   points, lines                   left out, with a warning
//   extras.umbra                    extras.cpp
//
// This work is based on:
// Khronos Group. glTF 2.0 Specification. 2021; KHR_lights_punctual. 2018
// Bruce Walter, Stephen Marschner, Hongsong Li, Kenneth Torrance. Microfacet Models for Refraction through Rough
// Surfaces. 2007
// Frederick Fisher, Andrew Woo. R.E versus N.H Specular Highlights. Graphics Gems IV. 1994
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

std::vector<std::optional<Light>> read_lights(const JsonText& json, GltfNotes& notes,
                                              std::vector<std::string>& warnings) {
    std::vector<std::optional<Light>> lights;
    if (const JsonValue* punctual = extension(json, json.root(), "KHR_lights_punctual")) {
        const JsonArray& list = list_of(json, *punctual, "lights");
        for (std::size_t i = 0; i < list.size(); ++i)
            lights.push_back(read_punctual_light(json, list[i], i, notes, warnings));
    }
    return lights;
}

std::vector<Lens> read_lenses(const JsonText& json, std::vector<std::string>& warnings) {
    std::vector<Lens> lenses;
    const JsonArray& list = list_of(json, json.root(), "cameras");
    for (std::size_t i = 0; i < list.size(); ++i) lenses.push_back(read_lens(json, list[i], i, warnings));
    return lenses;
}

/// What belongs to the whole scene: its name, and the terms of extras.umbra or what is assumed instead.
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

SceneFile read_gltf(const std::filesystem::path& file) {
    GltfFile source = open_gltf(file);
    const JsonText json(std::move(source.json));
    check_version(json);

    SceneFile read;
    auto& warnings = read.scene.warnings;
    warnings       = std::move(source.warnings);
    check_extensions(json, warnings);
    const GltfData data(json, file, source.bin);

    GltfNotes notes;
    GltfParts parts;
    read.scene.materials = read_materials(json, notes);
    parts.lights         = read_lights(json, notes, warnings);
    parts.lenses         = read_lenses(json, warnings);
    parts.meshes         = read_meshes(json, data, read.scene.materials.size(), notes, warnings);

    std::vector<Node> nodes = read_nodes(json);
    read_instances(json, data, nodes);
    GltfSceneBuilder builder(json, parts, read, notes);
    builder.check_references(nodes);
    builder.place_trees(nodes, read_roots(json, nodes, warnings));
    if (nodes.empty()) builder.place_all_meshes();
    builder.finish();

    read_scene_terms(json, read.scene);
    notes.warn(warnings);
    return read;
}

}  // namespace umbra
