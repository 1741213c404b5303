// Shading models: where the sum is evaluated, and what lies between. S_j is asked where the sum is, so that shadows are
// as coarse as the shading.
//
// This work is based on:
// Henri Gouraud. Continuous Shading of Curved Surfaces. 1971
// Bui Tuong Phong. Illumination for Computer Generated Pictures. 1975
// Cornelius van Overveld, Brian Wyvill. Phong Normal Interpolation Revisited. 1997
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "umbra/core/image/image.h"
#include "umbra/core/render/ask_visibility.h"
#include "umbra/core/render/points.h"

namespace umbra {

enum class ShadingModel : std::uint8_t {
    constant,        ///< one value a triangle, without directions: I_e + I_a k_a O_d + sum_j I_j k_d O_d n_z, no S_j
    flat,            ///< the sum at the centre of each triangle, with its face normal
    gouraud,         ///< the sum at vertices, interpolated over the triangle
    gouraud_screen,  ///< the same, interpolated in the picture: linear in pixels, not in space
    every_second,    ///< the sum at every second pixel of a row, the mean of its neighbours between; where these show
                     ///< another object, the sum
    highlight_test,  ///< phong with N.L interpolated, and highlights only on triangles that may have one: fast_phong.h
    taylor,          ///< phong with angles from a polynomial a triangle: fast_phong.h
    differences,     ///< phong with angles by additions along rows: fast_phong.h
    phong,           ///< the sum at each pixel, vertex normals interpolated
    quadratic        ///< the same, normals interpolated quadratically
};
inline constexpr std::array kShadingModels{
    ShadingModel::constant,     ShadingModel::flat,           ShadingModel::gouraud, ShadingModel::gouraud_screen,
    ShadingModel::every_second, ShadingModel::highlight_test, ShadingModel::taylor,  ShadingModel::differences,
    ShadingModel::phong,        ShadingModel::quadratic};
[[nodiscard]] constexpr std::string_view to_string(ShadingModel model) {
    constexpr std::array<std::string_view, 10> names{"constant",     "flat",           "gouraud", "gouraud_screen",
                                                     "every_second", "highlight_test", "taylor",  "differences",
                                                     "phong",        "quadratic"};
    return names[static_cast<std::size_t>(model)];
}

struct ShadedPicture {
    Image linear;                 ///< R G B, scene-linear
    std::size_t evaluations = 0;  ///< of the sum; of the three of fast_phong.h, of directions (PictureCosines)
};

/// A picture of a raster batch, faced to all lights. With `phong`, the picture is that of `shade`.
[[nodiscard]] ShadedPicture shade_by(ShadingModel model, const Scene& scene, const PointBatch& points,
                                     const AskVisibility& ask);

/// The normal, unit, where u and v weigh the second and third corner, of a triangle with these corners and unit normals
/// there: quadratic, with the middle of each edge as van Overveld and Wyvill have it. Along an edge d from n0 to n1
///     n(s) = n0 + s a + s^2 b,   b = 3 ((n0 + n1) . d) / (d . d) d,   a = n1 - n0 - b.
[[nodiscard]] dvec3 quadratic_normal(const std::array<dvec3, 3>& corners, const std::array<dvec3, 3>& normals, double u,
                                     double v);

}  // namespace umbra
