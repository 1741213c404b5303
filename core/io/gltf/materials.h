// glTF's materials as Phong's; the mapping is described in gltf.cpp. Internal to core.
#pragma once

#include "umbra/core/io/gltf/notes.h"
#include "umbra/core/io/json_text.h"
#include "umbra/core/scene/materials.h"

namespace umbra {

/// The format's default: a rough white metal.
[[nodiscard]] Material default_gltf_material();

/// The part of a surface that alphaMode leaves.
struct AlphaMask {
    bool nothing             = false;    ///< the factor's alpha is below alphaCutoff, and no texture makes it more
    const JsonValue* texture = nullptr;  ///< refers to the texture whose alpha decides; null: none
    double least             = 0;        ///< the texture's alpha from which on the surface is there
};
/// `material` is one of the file's.
[[nodiscard]] AlphaMask read_alpha_mask(const JsonText& json, const JsonValue& material);

/// materials[index]. Notes textures and values that the format forbids.
[[nodiscard]] Material read_gltf_material(const JsonText& json, const JsonValue& v, std::size_t index,
                                          GltfNotes& notes);

}  // namespace umbra
