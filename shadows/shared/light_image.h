// A hard light's image: where points and triangles are as the light sees them. A directional light has one plane, a
// position six faces of a cube around it.
#pragma once

#include <array>
#include <optional>

#include "umbra/core/scene/scene.h"

namespace umbra::binned_shadows_detail {

/// A rectangle of one face, and the least depth of what lies in it.
struct Extent {
    float low_u = 0, high_u = 0, low_v = 0, high_v = 0;
    float depth = 0;
    Extent()    = default;
    Extent(dvec2 low, dvec2 high, double least)
        : low_u(static_cast<float>(low.x)),
          high_u(static_cast<float>(high.x)),
          low_v(static_cast<float>(low.y)),
          high_v(static_cast<float>(high.y)),
          depth(static_cast<float>(least)) {}
};

class LightImage {
public:
    /// `centre`: near the scene, so that a directional light's image is centred. `reach`: the largest magnitude of the
    /// coordinates of all points and corners.
    LightImage(const Light& light, dvec3 centre, double reach);

    [[nodiscard]] int faces() const { return infinite_ ? 1 : 6; }

    struct Place {
        int face;
        dvec2 at;
        double depth;  ///< along the light's direction, or along the axis of the face: larger is farther
    };
    /// Off by far less than what extents are larger than their triangles. Nothing where `p`, which is rounded, lies so
    /// near to the light that its place could be anywhere.
    [[nodiscard]] std::optional<Place> place(dvec3 p) const;

    /// Covers all that the triangle covers of the face, and a little more. Nothing where it surely covers nothing.
    [[nodiscard]] std::optional<Extent> extent(int face, const std::array<dvec3, 3>& corners) const;

    /// A vector along which light travels to p, of any length.
    [[nodiscard]] dvec3 travel(dvec3 p) const { return infinite_ ? axes_[2] : p - origin_; }
    [[nodiscard]] bool infinite() const { return infinite_; }

private:
    /// (x, y, w) of a face: the place is (x / w, y / w).
    [[nodiscard]] dvec3 in_face(int face, dvec3 p) const;

    bool infinite_;
    double reach_;
    dvec3 origin_;                 ///< the light's position, or `centre`
    std::array<dvec3, 3> axes_{};  ///< of a directional light: right, up, the direction of travel
};

}  // namespace umbra::binned_shadows_detail
