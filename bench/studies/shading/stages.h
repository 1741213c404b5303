// One scene through the stages of a course on illumination: wireframe, hidden lines, the ambient term, flat, Gouraud
// and Phong shading, shadows, recursive rays.
#pragma once

#include <string_view>
#include <vector>

#include "umbra/bench/lab/prepare.h"
#include "umbra/core/image/image.h"
#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/render/ray.h"

namespace umbra {

enum class Lines : std::uint8_t { all, seen };

/// The edges of the scene in its camera's view, black on white, R G B displayed: those between two triangles of one
/// plane are left out. `seen`: only where no surface is in front of the edge, compared with the depths of the pixels
/// around, so that an edge may show through a surface by less than a pixel.
[[nodiscard]] Image draw_lines(const RayScene& rays, const Scene& scene, int width, int height, Lines lines);

struct Stage {
    std::string_view name;   ///< "wireframe": of the picture's file
    std::string_view about;  ///< one sentence
    Image picture;           ///< R G B displayed
};

/// Nine stages: wireframe, hidden_lines, ambient, flat, gouraud_diffuse, gouraud, phong, shadows, whitted. S_j is what
/// `ask` says, and only of the last two.
[[nodiscard]] std::vector<Stage> draw_stages(const PreparedScene& prepared, const AskVisibility& ask);

}  // namespace umbra
