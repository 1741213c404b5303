// Where the boundaries of shadows lie in a picture, and how wide their penumbrae are, in pixels.
#pragma once

#include <optional>
#include <vector>

#include "umbra/core/errors/error_classes.h"

namespace umbra {

/// How far the method's shadow boundary lies from the reference's.
///
/// A boundary is where S passes 1/2 between two 4-neighbours of one surface (`one_surface`: the outline of an object in
/// front of a shadow is none) that both planes define; pieces on which the reference is on the boundary are left out.
/// Each such pair is one piece. It lies between the two centres where S, taken as linear, is 1/2: to a fraction of a
/// pixel in a penumbra, and for hard lights, where S is 0 and 1, midway. So hard boundaries are known to half a pixel
/// either way, equal planes are 0 apart, and a shift by whole pixels across the boundary is read exactly.
///
/// Measured from each piece of the reference to the nearest of the method's that does not have its light on the other
/// side. Acne and holes make pieces of their own, but none of the reference's looks for them unless they lie nearer
/// than the true boundary. A piece of the reference with nothing nearer than kFarthest is `unmatched` and part of no
/// mean: a shadow that is not there is no displaced one. So a shift by more than kFarthest is not read at all.
///
/// On boundaries oblique to the pixels of hard lights the mean is low: the pieces lie up to half a pixel off the
/// boundary, on either side, and the nearest of them is measured. The loss is below 10 % for shifts of 2 pixels and
/// more (shadow_edges_test measures it).
struct EdgeDisplacement {
    double mean = 0, p95 = 0, max = 0;  ///< pixels, of the matched pieces
    std::uint64_t pieces    = 0;        ///< of the reference's boundary
    std::uint64_t unmatched = 0;        ///< of these
};
inline constexpr double kFarthest = 8;  // pixels

/// Nothing where the reference has no boundary. Where the method has none near it, all pieces are unmatched, and mean,
/// p95 and max are 0.
[[nodiscard]] std::optional<EdgeDisplacement> edge_displacement(const PointBatch& points, const ClassPlane& classes,
                                                                const VisibilityPlane& s,
                                                                const VisibilityPlane& reference);

/// Effective width of the penumbrae: 6 times the integral of S (1 - S) over the points that both planes define, by the
/// length of the reference's line S = 1/2. A penumbra in which S rises evenly from 0 to 1, as behind a straight edge
/// that runs along a side of a rectangle light, has its own width; a boundary without penumbra has 0. The integral
/// asks little of the faint ends, where a sampled S is 0 or 1 most of the time. Both widths are by the one length,
/// which noise would lengthen. Where an object hides the line S = 1/2 and not the penumbra, both are too wide alike.
struct PenumbraWidth {
    double method = 0, reference = 0;  ///< pixels
};

/// Nothing where the reference's line S = 1/2 is shorter than a pixel.
[[nodiscard]] std::optional<PenumbraWidth> penumbra_width(const PointBatch& points, const ClassPlane& classes,
                                                          const VisibilityPlane& s, const VisibilityPlane& reference);

/// Do two neighbouring pixels see one surface? Each point is no farther from the plane of the other's triangle than a
/// pixel spans there.
[[nodiscard]] bool one_surface(const PointBatch& points, std::size_t i, std::size_t j);

/// The width of a pixel at point i's depth, across the line of sight, in world units.
[[nodiscard]] double pixel_span(const PointBatch& points, std::size_t i);

}  // namespace umbra
