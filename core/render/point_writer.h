// Surface points from the hits of eye rays, eight at a time. Internal to core/render.
#pragma once

#include <cstdint>

#include "umbra/core/render/points.h"
#include "umbra/core/render/tiles.h"

namespace umbra {

/// The hits of eight eye rays, as 4 x 2 pixels.
struct Hits8 {
    TriangleId triangle[8];
    float u[8], v[8];                  ///< as Embree has them: their last bits depend on the processor
    double origin[3][8], along[3][8];  ///< the rays, in world space
};

/// Where eight rays meet the planes of the triangles that Embree named, in double and so alike on all processors, and
/// the values that set_point and face_lights compute from that, to the same bits: all but the loads are loops over
/// lanes. Cases that need a second look are left to those two: barycentrics at or over an edge, slivers, triangles that
/// the eye or a light sees edge-on.
///
/// Threads may write different tiles of one batch. The batch has its raster, eye and size; `scene` and `batch` outlive
/// the writer.
class PointWriter {
public:
    /// Makes room for the facings of all lights of the scene.
    PointWriter(const Scene& scene, PointBatch& batch);

    /// Has the processor load the memory that the tile is written to. A tile's rows lie far apart, and stores that wait
    /// for them, one after the other, take longer than all that is computed.
    void claim(const PointTile& tile) const;

    /// Pixels (x .. x+3, y .. y+1), those inside the raster. False where it left facings of some to face_open_points.
    [[nodiscard]] bool write(const Hits8& hits, int x, int y) const;

    /// After all pixels of the tile are written.
    void face_open_points(const PointTile& tile) const;

private:
    struct Points8;
    struct Triangles8;

    void load_corners(const TriangleId* triangles, int count, Triangles8& to) const;
    void load(const TriangleId (&triangles)[8], Triangles8& to) const;
    [[nodiscard]] dvec3 to_eye() const;
    bool place(const Hits8& hits, Triangles8& triangles, Points8& out) const;
    template <class Count>
    void store(const Hits8& hits, const Points8& points, int lane, std::size_t i, Count count) const;

    void clear(std::size_t i) const;

    const Scene& scene_;
    PointBatch& batch_;
    bool window_        = false;
    bool all_two_sided_ = true;
    bool all_receive_   = true;  ///< shadows
};

}  // namespace umbra
