// The distribution of a goniometric light: a table of luminous intensities by direction, interpolated between its
// angles.
//
// This work is based on:
// Illuminating Engineering Society. LM-63-02: Standard File Format for the Electronic Transfer of Photometric Data.
// 2002
#pragma once

#include <string>
#include <vector>

#include "umbra/core/base/math.h"

namespace umbra {

/// How the two angles of a table name a direction. f is the light's direction, s its `along`, perpendicular to f;
/// V the vertical, H the horizontal angle.
enum class PhotometricType : std::uint8_t {
    /// V from f, 0 to 180 degrees; H around f from s, anticlockwise seen along f (from above, if the light points
    /// down).
    C,
    B,  ///< cos H (cos V f + sin V u) + sin H s with u = s x f: the angles' common axis is s
    A   ///< cos V (cos H f + sin H s) + sin V u: the common axis is u
};

/// Intensities on a grid of angles, in degrees, increasing. I_j of the light is multiplied by an intensity; in the
/// files of manufacturers its unit is the candela.
struct Photometry {
    PhotometricType type = PhotometricType::C;
    std::vector<float> vertical;    ///< C: within [0, 180]; A, B: within [-90, 90]. At least one
    std::vector<float> horizontal;  ///< C: 0; 0 to 90, 180 or 360; 90 to 270. A, B: 0 to 90, -90 to 90. The part that
                                    ///< is missing is symmetric
    std::vector<float> candela;     ///< one a pair: candela[h * vertical.size() + v], >= 0
};

/// The fault that makes a table unusable, as "the horizontal angles end at 120 degrees, expected ...", or empty.
[[nodiscard]] std::string fault_of(const Photometry& table);

/// The intensity at these angles, degrees: bilinear between the table's, 0 outside its vertical angles. `table` has no
/// fault. A, B: angles within [-90, 90]; C: `vertical` within [0, 180], any `horizontal`.
[[nodiscard]] double intensity_at(const Photometry& table, double vertical, double horizontal);

/// The intensity towards `to`. All three vectors are of any length > 0; only the part of `along` that is perpendicular
/// to `direction` counts. Of a table of type A or B, 0 in the half space behind the light.
[[nodiscard]] double intensity_towards(const Photometry& table, dvec3 direction, dvec3 along, dvec3 to);

/// The integral of the intensity over all directions: lumens where intensities are candelas. Exact along meridians for
/// intensities that are linear between the table's angles, by the trapezoid rule from meridian to meridian.
[[nodiscard]] double flux(const Photometry& table);

/// The largest intensity of the table.
[[nodiscard]] float peak(const Photometry& table);

}  // namespace umbra
