// Terms that materials ask for and pictures of the sum do not have (`umbra whitted` does): found once, warned about by
// readers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "umbra/core/scene/scene.h"

namespace umbra {

/// One term of a material that some object with triangles sets to other than its default.
struct UncomputedTerm {
    std::string_view term;               ///< as native scenes write it: "opacity"
    std::string_view consequence;        ///< the substitute in the picture, for people
    std::vector<std::string> materials;  ///< their names, in the scene's order; not empty
};

/// The term that `umbra whitted` does not have either, and the one that S_j lacks.
inline constexpr std::string_view kCutout = "cutout";

/// In a fixed order: opacity, transmit, reflect, index_of_refraction, cutout; those that no material asks for are left
/// out.
[[nodiscard]] std::vector<UncomputedTerm> find_uncomputed(const Scene& scene);

/// "opacity of material \"glass\"", "opacity of materials \"a\", \"b\", \"c\" and 4 more".
[[nodiscard]] std::string in_words(const UncomputedTerm& term);

}  // namespace umbra
