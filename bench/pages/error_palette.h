// The classes of wrong points, one row a class: what results.json, the legends, the tables and the class pictures call
// and colour them.
//
// Three hues that colour-blind eyes keep apart, on light and on dark ground: false shadow is blue, false light orange
// to red, the terminator green. Within a hue the rarer and graver class has the stronger colour. Right points are grey
// and show the reference's S_j, so that a reader recognises the scene.
// Penumbra and noise have hues of their own, since they err either way: wine and olive.
// After Masataka Okabe, Kei Ito, Color Universal Design, 2008 (orange, sky blue, bluish green, vermillion, blue), and
// Paul Tol, Colour Schemes, 2021 (wine, olive).
#pragma once

#include <array>
#include <string_view>

#include "umbra/core/errors/error_classes.h"

namespace umbra {

struct ErrorColour {
    ErrorClass error_class;
    std::string_view key;       ///< "acne"
    std::string_view name;      ///< in a legend: "false shadow: acne"
    std::string_view srgb;      ///< "#rrggbb"
    std::string_view group;     ///< the object of an `errors` entry of results.json that counts it, with members
                                ///< `interior` and `edge`; empty where no table has columns for the class
    std::string_view member;    ///< its own count in that object; empty where it has none
    bool interior;              ///< outside the edge band and not at the terminator: a mistake of the method
    std::string_view sentence;  ///< what the class means
    std::string_view in_short;  ///< of interior classes: the fault, for those who see it for the first time
};

/// In the order of the legends. A new class is one more row: legends, tables and sums follow.
inline constexpr std::array kErrorPalette = {
    ErrorColour{ErrorClass::acne, "acne", "false shadow: acne", "#0a2a9c", "false_shadow", "acne", true,
                "Too dark: the surface shades itself, or the method names no occluder.",
                "lit surfaces that shade themselves"},
    ErrorColour{ErrorClass::false_shadow, "false_shadow", "false shadow: other", "#0072b2", "false_shadow", "", true,
                "Too dark: the method blames another surface.", "lit points in the shadow of another surface"},
    ErrorColour{ErrorClass::false_shadow_edge, "false_shadow_edge", "false shadow: edge band", "#7cc4ee",
                "false_shadow", "", false, "Too dark within 1.5 pixels of a shadow boundary.", ""},
    ErrorColour{ErrorClass::detachment, "detachment", "false light: detachment", "#e69f00", "false_light", "detachment",
                true, "Too bright next to a contact: the shadow is detached from its occluder (“peter-panning”).",
                "shadows that are detached from what casts them"},
    ErrorColour{ErrorClass::leak, "leak", "false light: leak", "#c40000", "false_light", "leak", true,
                "Too bright away from any contact: light leaks through an occluder.",
                "light that leaks through an occluder"},
    ErrorColour{ErrorClass::false_light, "false_light", "false light: unknown occluder", "#d55e00", "false_light", "",
                true, "Too bright: no occluder is known, so detachment and leak cannot be distinguished.",
                "shadows that are missing"},
    ErrorColour{ErrorClass::false_light_edge, "false_light_edge", "false light: edge band", "#ffc861", "false_light",
                "", false, "Too bright within 1.5 pixels of a shadow boundary.", ""},
    ErrorColour{ErrorClass::penumbra, "penumbra", "penumbra", "#882255", "", "", true,
                "Wrong by more than 0.1 where the reference is in penumbra: a missing or noisy penumbra.",
                "a penumbra, which is missing or noisy on the left"},
    ErrorColour{ErrorClass::noise, "noise", "noise", "#999933", "", "", true,
                "Wrong by its random numbers alone: the mean of runs with other seeds is right.",
                "noise of random numbers"},
    ErrorColour{ErrorClass::terminator_wrong, "terminator_wrong", "wrong at the terminator", "#009e73", "", "", false,
                "Wrong where the smooth normal faces away from the light: the sum multiplies S by 0 there.", ""},
    ErrorColour{ErrorClass::on_boundary, "on_boundary", "on the boundary: never wrong", "#cc79a7", "", "", false,
                "The segment to the light passes a silhouette or a border: no answer is wrong.", ""},
};

}  // namespace umbra
