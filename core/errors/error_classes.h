// The class of each point's error: one a point, from which the counts and the picture both come.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// Two planes tell whether a point is wrong, which way, and whether it lies in the edge band. Why it is wrong takes the
/// scene and the triangles that the methods hold responsible: core/errors/error_causes.h turns the general class of an
/// interior error, `false_shadow` and `false_light`, into the special one.
enum class ErrorClass : std::uint8_t {
    no_surface,        ///< the eye ray met nothing
    away,              ///< the whole light is behind the point's triangle: S_j = 0 for every method
    terminator_away,   ///< the same, where the shading normal faces the light: dark for the facet, bright for the sum
    not_judged,        ///< the reference was evaluated at a sample of the points, and this one is not in it
    undefined,         ///< either plane leaves the point open
    on_boundary,       ///< the reference says so: no method is wrong there
    right,             ///< within the tolerance
    terminator,        ///< right, where the shading normal has all of the light behind it, but the facet has not
    terminator_wrong,  ///< wrong there: the sum makes nothing of S_j at such a point
    false_shadow_edge,
    false_shadow,  ///< interior, and not known to be acne
    acne,          ///< interior, cast by the point's own surface or by nothing that the method could name
    false_light_edge,
    false_light,  ///< interior, and no occluder is named that would tell detachment from leak
    detachment,   ///< interior, at a contact ("peter-panning")
    leak,         ///< interior, elsewhere
    penumbra,     ///< interior, where the reference has a penumbra of an area light: it is missing, or wrong
    noise,        ///< interior, and the mean of runs with other random numbers is right
    unshadowed    ///< Facing::unshadowed: S_j = 1 for every method
};

/// The names of the classes in the order of their codes, as files and pages write them.
inline constexpr std::array<std::string_view, 19> kErrorClassNames = {"no_surface",
                                                                      "away",
                                                                      "terminator_away",
                                                                      "not_judged",
                                                                      "undefined",
                                                                      "on_boundary",
                                                                      "right",
                                                                      "terminator",
                                                                      "terminator_wrong",
                                                                      "false_shadow_edge",
                                                                      "false_shadow",
                                                                      "acne",
                                                                      "false_light_edge",
                                                                      "false_light",
                                                                      "detachment",
                                                                      "leak",
                                                                      "penumbra",
                                                                      "noise",
                                                                      "unshadowed"};
static_assert(kErrorClassNames.size() == static_cast<std::size_t>(ErrorClass::unshadowed) + 1);

/// S_j above 1 - kFullOrNone is lit, below kFullOrNone umbra, between them penumbra.
inline constexpr float kFullOrNone = 1.0f / 1024;

[[nodiscard]] constexpr bool is_penumbra(float s) { return s >= kFullOrNone && s <= 1 - kFullOrNone; }

/// Do both planes define the point, so that it is right or wrong?
[[nodiscard]] constexpr bool is_compared(ErrorClass c) { return c >= ErrorClass::right && c != ErrorClass::unshadowed; }

/// Does it say where boundaries are? A value that is not judged does, too.
[[nodiscard]] constexpr bool is_drawn(ErrorClass c) { return is_compared(c) || c == ErrorClass::not_judged; }

using ClassPlane = std::vector<ErrorClass>;  ///< one a point of a raster batch

/// Compares two planes of one raster batch. A point is wrong where |s - reference| > `tolerance` + the reference's half
/// width: a false shadow where s is below the reference, a false light where it is above. `judged`, one entry a point,
/// is 0 where the reference's value is only good enough to find edges; empty: every point is judged. Throws
/// std::logic_error where the batch has no raster or a plane is of another size. `tolerance` > 0.
[[nodiscard]] ClassPlane error_classes(const PointBatch& points, LightId light, const VisibilityPlane& s,
                                       const VisibilityPlane& reference, float tolerance,
                                       std::span<const std::uint8_t> judged = {});

/// 1 in the edge band of the reference plane: where a shadow that lies up to 1.5 pixels off could be wrong by more than
/// `tolerance`, so that a wrong value says something about sampling in the image and nothing about the method.
///
/// A shadow boundary passes between two 4-neighbours that both have a surface point, a light not `away` and a defined
/// reference, where the reference changes by more than tolerance / 1.5 from one to the other: at any change for hard
/// lights; for area lights where the penumbra is steep, and not at its faint ends. The band holds the pixels whose
/// centre is within 1.5 pixels (Euclidean) of the point midway between such two centres. Where the light turns `away`
/// there is no boundary, since facing is decided once and exactly. The outline of an object in front of a shadow does
/// count: between two pixels, a shadow's boundary and an occlusion cannot be distinguished.
[[nodiscard]] std::vector<std::uint8_t> edge_band(const PointBatch& points, LightId light,
                                                  const VisibilityPlane& reference, float tolerance);

}  // namespace umbra
