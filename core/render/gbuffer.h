// The G-buffer: which surface point each pixel sees.
#pragma once

#include "umbra/core/render/points.h"
#include "umbra/core/render/ray.h"
#include "umbra/core/scene/camera.h"

namespace umbra {

/// The G-buffer: the surface point that each pixel centre sees, in parallel, packets of 8.
/// face_lights is called on the result. Deterministic for any number of threads. Throws InputError where the eye, or
/// the edge of an orthographic window, is more than 2^51 times as far from the scene as the scene is wide.
[[nodiscard]] PointBatch primary_points(const RayScene& rays, const Scene& scene, const Camera& camera, int width,
                                        int height);
/// The same into a batch whose memory is used again, as for the next picture of a moving camera.
void primary_points(const RayScene& rays, const Scene& scene, const Camera& camera, int width, int height,
                    PointBatch& batch);

}  // namespace umbra
