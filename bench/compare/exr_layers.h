// What the EXRs of `umbra compare` and `umbra render` hold; docs/exr.md is its table for readers.
#pragma once

#include <span>

#include "umbra/bench/lab/outcome.h"
#include "umbra/bench/lab/run.h"
#include "umbra/core/image/image.h"

namespace umbra {

/// Which channels a file has besides R, G, B and, of each light, S and answer.
struct ExrLayers {
    bool geometry  = false;                  ///< the points' exact names, positions, normals, the camera's matrices
    bool reference = false;                  ///< half widths, and which points the reference judges
    std::span<const Explained> explained{};  ///< one a light, for the classes; empty: none
};

/// The whole content of one run's file; metadata name objects, codes and units. `linear` is the sum in R, G, B; its
/// metadata are kept.
[[nodiscard]] Image exr_image(const Image& linear, const Scene& scene, const PointBatch& points, const MethodRun& run,
                              const ExrLayers& layers);

/// Matrices of row vectors as OpenEXR's standard attributes define them. Camera space: x right, y up, z along the view.
/// NDC: x and y from (0, 0) at the picture's upper left corner to (1, 1) at its lower right; z is 1 / depth under a
/// perspective camera and the depth under an orthographic one.
[[nodiscard]] std::array<float, 16> world_to_camera(const CameraFrame& frame);
[[nodiscard]] std::array<float, 16> world_to_ndc(const CameraFrame& frame);

}  // namespace umbra
