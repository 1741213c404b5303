// The fraction of light from one direction that a surface reflects towards another: the lobes of the sum, and checks of
// them.
//
// This work is based on:
// Bui Tuong Phong. Illumination for Computer Generated Pictures. 1975
// James Blinn. Models of Light Reflection for Computer Synthesized Pictures. 1977
// Eric Lafortune, Sing-Choong Foo, Kenneth Torrance, Donald Greenberg. Non-Linear Approximation of Reflectance
// Functions. 1997
// Robert Lewis. Making Shaders More Physically Plausible. 1994
// Fabian Giesen. Phong Normalization Factor Derivation. 2009
#pragma once

#include <functional>

#include "umbra/core/scene/materials.h"

namespace umbra {

/// R.V or N.H, as the material's `lobe` says, with unit N, L, V: [-1, 1]. 0 where V = -L, which has no H.
[[nodiscard]] double lobe_cosine(const Material& material, dvec3 n, dvec3 l, dvec3 v);

/// (R.V)^n or (N.H)^n, as the material's `lobe` says, with unit N, L, V: [0, 1]. 0 where V = -L, which has no H.
[[nodiscard]] double specular_lobe(const Material& material, dvec3 n, dvec3 l, dvec3 v);

/// The sum of the material's Lafortune lobes k_s (e . C l)^n, per channel, with unit N, L and e = V. Negative (e . C l)
/// count as 0. Where the material's tangent is parallel to N, a direction perpendicular to N that depends on N alone
/// is taken.
[[nodiscard]] dvec3 lafortune_lobes(const Material& material, dvec3 n, dvec3 l, dvec3 v);

/// The terms of the sum for one light with I_j = 1 and f_att,j = S_j = 1, per channel: k_d O_d (N.L) + k_s O_s (lobe) +
/// the Lafortune lobes; 0 where N.L <= 0. Unit N, L, V.
[[nodiscard]] dvec3 reflected(const Material& material, dvec3 n, dvec3 l, dvec3 v);

/// A reflectance function of one channel in a local frame, z its normal: of unit directions to the light and to the
/// eye, both with z > 0. Per steradian.
using Brdf = std::function<double(dvec3 l, dvec3 v)>;

/// The reflectance of the sum, red channel: `reflected` / (pi N.L). A light of I_j is taken to bring an irradiance of
/// pi I_j (N.L), so that k_d O_d = 1 reflects all of it.
[[nodiscard]] Brdf brdf_of_sum(const Material& material);

/// The same terms as a reflectance function that is multiplied by N.L, red channel: k_d O_d / pi + k_s O_s p (lobe),
/// where p makes a lobe with k_s O_s = 1 reflect all light of normal incidence: (n + 2) / (2 pi) for Phong's (Lewis),
/// (n + 2) (n + 4) / (8 pi (2^(-n/2) + n)) for Blinn's (Giesen). Lafortune's lobes, whose peaks depend on C, have no
/// such factor.
[[nodiscard]] Brdf brdf_with_cosine(const Material& material);

/// Figures of a reflectance function, found by sampling.
struct BrdfFigures {
    double largest     = 0;     ///< value of f
    double reciprocity = 0;     ///< the largest |f(l, v) - f(v, l)|, as a fraction of `largest`; 0: reciprocal
    double anisotropy  = 0;     ///< the largest change of f where l and v turn about the normal by one radian, as a
                                ///< fraction of `largest`; 0: isotropic
    double energy = 0;          ///< the largest integral over v of f(l, v) cos(v), of all l: above 1, more light leaves
                                ///< than arrives
    double without_cosine = 0;  ///< the same without the cosine, as DE2 prints it
};

/// Measured for directions l at 0, 15, ..., 75, 85 and 89 degrees from the normal, at 8 angles about it, and v on a
/// grid of `steps` by 4 `steps` midpoints of equal solid angle. `steps` >= 1. Rounding leaves 1e-12 where a figure
/// should be 0.
[[nodiscard]] BrdfFigures measure_brdf(const Brdf& f, int steps = 64);

}  // namespace umbra
