#include "umbra/core/io/gltf/notes.h"

#include <fmt/format.h>

namespace umbra {

void GltfNotes::warn(std::vector<std::string>& warnings) const {
    if (textures) warnings.emplace_back("Textures are ignored: surfaces have their factors' colours.");
    if (vertex_colours) warnings.emplace_back("Colours of vertices are ignored.");
    if (emissive_above_one)
        warnings.emplace_back("An emissiveFactor is above 1, which the format forbids: its value is used as given.");
    if (no_share)
        warnings.emplace_back(
            "A factor of a material is not from 0 to 1, as the format has it: the nearer end is used.");
    if (cut_away > 0)
        warnings.push_back(fmt::format(
            "{} primitives are left out: the alpha of their material is below its alphaCutoff (alphaMode MASK).",
            cut_away));
    if (without_joints > 0)
        warnings.push_back(
            fmt::format("{} primitives of nodes with a skin have no JOINTS_0: they stay where their nodes place them.",
                        without_joints));
    if (skin_weights > 0)
        warnings.push_back(fmt::format(
            "The weights of {} vertices' joints are negative or all 0: a negative one counts as 0, and where all are 0 "
            "the first joint moves the vertex.",
            skin_weights));
    if (no_position) warnings.emplace_back("A primitive without positions is left out.");
    if (points_and_lines > 0)
        warnings.push_back(fmt::format("{} primitives of points or lines are left out.", points_and_lines));
    if (hard_spots > 0)
        warnings.push_back(fmt::format(
            "{} spot lights have an innerConeAngle as large as their outerConeAngle, which the extension forbids: they "
            "have hard edges.",
            hard_spots));
    if (wide_spots > 0)
        warnings.push_back(
            fmt::format("{} spot lights have an outerConeAngle a little above pi/2: it is taken as pi/2.", wide_spots));
    normals.warn(warnings);
}

}  // namespace umbra
