// The colours of the class pictures, one a class of errors: for the pictures and for their legends.
//
// Three hues that colour-blind eyes keep apart, on grounds both dark and light: shadows that should not be are blue,
// light that should not be is orange to red, the terminator is green; within a hue the rarer and graver class is the
// stronger colour. What is right is grey, and shows the reference's S_j, so that one sees where on the scene one is.
// After Masataka Okabe, Kei Ito, Color Universal Design, 2008 (orange, sky blue, bluish green, vermillion, blue).
#pragma once

#include <array>
#include <string_view>

#include "umbra/core/errors/error_classes.h"

namespace umbra {

struct ErrorColour {
    ErrorClass error_class;
    std::string_view key;   ///< as in results.json: "acne"
    std::string_view name;  ///< for people: "acne"
    std::string_view srgb;  ///< "#rrggbb"
};

/// What the legend shows, in its order.
inline constexpr std::array kErrorPalette = {
    ErrorColour{ErrorClass::acne, "acne", "false shadow: acne", "#0a2a9c"},
    ErrorColour{ErrorClass::false_shadow, "false_shadow", "false shadow: other", "#0072b2"},
    ErrorColour{ErrorClass::false_shadow_edge, "false_shadow_edge", "false shadow: in the edge band", "#7cc4ee"},
    ErrorColour{ErrorClass::detachment, "detachment", "false light: detachment", "#e69f00"},
    ErrorColour{ErrorClass::leak, "leak", "false light: leak", "#c40000"},
    ErrorColour{ErrorClass::false_light, "false_light", "false light: of unknown occluder", "#d55e00"},
    ErrorColour{ErrorClass::false_light_edge, "false_light_edge", "false light: in the edge band", "#ffc861"},
    ErrorColour{ErrorClass::terminator_wrong, "terminator_wrong", "wrong at the terminator", "#009e73"},
    ErrorColour{ErrorClass::on_boundary, "on_boundary", "on the boundary: never wrong", "#cc79a7"},
};

}  // namespace umbra
