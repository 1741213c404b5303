// The sum: Phong's terms with S_j, evaluated in world space, and its conversion to a picture that can be displayed.
#pragma once

#include <array>
#include <span>

#include "umbra/core/image/image.h"
#include "umbra/core/render/points.h"
#include "umbra/core/render/visibility.h"

namespace umbra {

/// R G B, scene-linear, of a raster batch: I_e + I_a k_a O_d + sum_j S_j f_att,j I_j (...). `visibility` holds one
/// plane a light; undefined points count as lit (S_j = 1) and are not part of image errors. Fog, if any, is part of it.
/// Terms that no material or light asks for are not computed. Parallel; the same bits for any number of threads.
[[nodiscard]] Image shade(const Scene& scene, const PointBatch& points, std::span<const VisibilityPlane> visibility);

/// The same picture for less, where most points have the S_j of another one: `known` is that of `known_visibility`, and
/// the sum is evaluated only where the two differ.
[[nodiscard]] Image shade(const Scene& scene, const PointBatch& points, std::span<const VisibilityPlane> visibility,
                          std::span<const VisibilityPlane> known_visibility, const Image& known);

/// The normals at the corners of triangle t on the side of `face`, its geometric normal on the side that is seen. A
/// vertex whose normal is zero has that one.
[[nodiscard]] std::array<dvec3, 3> corner_normals(const Scene& scene, TriangleId t, dvec3 face);

/// N, unit: the vertex normals interpolated, on the side of the geometric normal (which faces the eye where the
/// material is two-sided). A vertex whose normal is zero lends the geometric one. Point i has a surface.
[[nodiscard]] dvec3 shading_normal(const Scene& scene, const PointBatch& points, std::size_t i);

/// Writes a light into the first three channels of a pixel, as floats of at most the largest.
void write_light(Image& image, std::size_t pixel, dvec3 light);

/// Exposure, then the scene's tone map (the lectures), then sRGB encoding: R G B in [0, 1] to be written as PNG.
[[nodiscard]] Image displayed(const Image& linear, ToneMap tone, float exposure);

}  // namespace umbra
