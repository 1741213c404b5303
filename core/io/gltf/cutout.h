// alphaMode MASK with a texture: the outline is cut into triangles, texel by texel, so that all methods see it.
// Internal to core.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "umbra/core/io/gltf/data.h"
#include "umbra/core/scene/primitives.h"

namespace umbra {

/// The texels that a texture leaves of a surface, each a square: its nearest texel decides on a point.
struct Cutout {
    enum class Wrap : std::uint8_t { repeat, mirror, clamp };

    int width = 0, height = 0;
    std::vector<std::uint8_t> kept;  ///< one a texel, row by row from the top
    std::array<Wrap, 2> wrap{};
    dvec2 offset{0}, scale{1};  ///< of texture coordinates (KHR_texture_transform)
    std::uint64_t set = 0;      ///< TEXCOORD_n

    /// Whether the texel is there, of a texture that goes on without end.
    [[nodiscard]] bool keeps(std::int64_t x, std::int64_t y) const;
};

/// The texels of materials[].pbrMetallicRoughness.baseColorTexture whose alpha is at least `least`. Throws InputError
/// where the image cannot be read.
[[nodiscard]] Cutout read_cutout(const JsonText& json, GltfData& data, const JsonValue& texture, double least);

/// The rest of a mesh whose positions have these texture coordinates. Neighbouring texels make one rectangle, and
/// each rectangle one polygon of each triangle. Nothing where that takes more than `most` triangles, or looks at more
/// texels than a few seconds allow.
[[nodiscard]] std::optional<Mesh> cut_out(const Mesh& mesh, const std::vector<dvec2>& at, const Cutout& cutout,
                                          std::size_t most);

}  // namespace umbra
