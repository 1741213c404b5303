// The shadows that triangles throw onto one side of a plane, from one point of a light.
//
//            light *            w = H - h > 0 between plane and light; a point at height h goes to
//                 / \           q = v + (v - light) h / (H - h), in the plane's coordinates
//          v ____/___\    H
//          h    /     \         Whether p lies in the triangle's shadow is decided without q: by the sides of p to the
//    _________q_________p___    three planes through the light and an edge, which need no division and hold where
//                               q runs off to infinity. q only bounds the shadow.
//
// Only what lies between plane and light is projected; what is behind the light, or under the plane, would cast shadows
// that are not there.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "umbra/core/scene/facts.h"
#include "umbra/core/scene/scene.h"

namespace umbra::planar {

/// One side of a receiver's plane, with coordinates of its own: x and y in the plane, z the height over it on that
/// side, from an origin in the plane, so that neither a far nor a large scene costs digits. World units.
struct Receiver {
    std::uint32_t plane = 0;  ///< index of the plane that it is a side of
    dvec3 origin{0}, e1{0}, e2{0}, normal{0};
    dvec2 low{+kInfinity}, high{-kInfinity};  ///< bounds of the plane's triangles, in its coordinates
    double tolerance = 0;                     ///< greatest distance of their corners from the plane

    /// By how much heights over it may be off at points whose magnitude is `size`, in its coordinates. None along an
    /// axis of the world, where they are differences of two floats: these have the right sign.
    [[nodiscard]] double doubt_of_height(double size) const {
        const bool is_exact = (normal.x == 0) + (normal.y == 0) + (normal.z == 0) == 2;
        return tolerance + (is_exact ? 0 : 8 * 0x1p-53 * size);
    }
    [[nodiscard]] dvec3 local(dvec3 world) const { return local_direction(world - origin); }
    [[nodiscard]] dvec3 local_direction(dvec3 d) const {
        return {glm::dot(e1, d), glm::dot(e2, d), glm::dot(normal, d)};
    }
};

/// The side of `plane` that its normal points to (`side` = +1), or the other (-1). `index` becomes Receiver::plane.
[[nodiscard]] Receiver make_receiver(const Scene& scene, const PlanarReceiver& plane, std::uint32_t index, int side);

/// Bounds on a receiver's plane, in its coordinates.
struct Reach {
    dvec2 low{+kInfinity}, high{-kInfinity};
};

/// One point to project from, world space: a hard light, or one of an area light's samples.
struct Source {
    bool at_infinity = false;
    vec3 at{0};  ///< position; at infinity the direction towards the light
};

/// The light as one source, in its centre.
[[nodiscard]] Source centre_of(const Light& light);

/// The sources of a light, of equal weight: `samples` points of an area light, one of any other.
[[nodiscard]] std::vector<Source> sources_of(const Light& light, int samples);

/// A source in a receiver's coordinates.
struct LocalSource {
    bool at_infinity;
    dvec3 at;

    LocalSource(const Receiver& receiver, const Source& source)
        : at_infinity(source.at_infinity),
          at(at_infinity ? receiver.local_direction(dvec3(source.at)) : receiver.local(dvec3(source.at))) {}

    /// Whether the source lights this side of the plane.
    [[nodiscard]] bool is_above() const { return at.z > 0; }

    /// The shadow of x on the plane; x lies below a source that is not at infinity.
    [[nodiscard]] dvec2 project(dvec3 x) const {
        if (at_infinity) return dvec2(x) - dvec2(at) * (x.z / at.z);
        return dvec2(x) + (dvec2(x) - dvec2(at)) * (x.z / (at.z - x.z));
    }
};

/// The triangles that can cast a shadow. One casts none onto the receiver that it belongs to.
struct Occluders {
    static constexpr std::uint32_t kNoPlane = 0xffffffffu;

    const Scene* scene = nullptr;         ///< outlives this object
    std::vector<TriangleId> triangles;    ///< those that have an area
    std::vector<std::uint32_t> plane_of;  ///< for each triangle of the scene: Receiver::plane, or kNoPlane
};

using Triangle = std::array<dvec3, 3>;  ///< corners in a receiver's coordinates
[[nodiscard]] inline Triangle local_triangle(const Scene& scene, TriangleId t, const Receiver& receiver) {
    return {receiver.local(dvec3(scene.vertex(t, 0))), receiver.local(dvec3(scene.vertex(t, 1))),
            receiver.local(dvec3(scene.vertex(t, 2)))};
}

/// Bounds of a triangle's shadow, in a receiver's coordinates, in floats rounded outwards. A triangle that the plane
/// cuts is several pieces. One of which rounding hides whether the plane cuts it is a piece, too.
struct Shadow {
    vec2 low{+kInfinity}, high{-kInfinity};
    std::uint32_t triangle = 0;  ///< index into the scene, or into Shadows::pieces
    bool is_piece          = false;
    bool may_be_none       = false;  ///< rounding hides whether any of it is: no point is surely within it
    bool from_behind       = false;  ///< the source is behind the triangle, by its winding
};

/// The shadows of a run of triangles. Runs have the same length for any number of threads.
struct Shadows {
    std::vector<Shadow> shadows;
    std::vector<Triangle> pieces;
    std::vector<TriangleId> piece_of;  ///< for each piece: the triangle that it was cut from
    std::vector<double> slack;         ///< for each piece: how far its corners may be off

    [[nodiscard]] TriangleId caster(const Shadow& s) const { return s.is_piece ? piece_of[s.triangle] : s.triangle; }
    [[nodiscard]] std::size_t memory_bytes() const;
};

/// Where the receiver's points are: they are off the plane by its tolerance, and are moved onto it along their rays
/// from the source, which is above it.
[[nodiscard]] Reach reach_of(const Receiver& receiver, const LocalSource& source);

/// The shadows of some triangles on one receiver from one source, in runs; none where the source is not above the
/// receiver, and none of the receiver's own triangles.
[[nodiscard]] std::vector<Shadows> project(const Occluders& occluders, std::span<const TriangleId> triangles,
                                           const Receiver& receiver, const Source& source);

/// The side of a point (x, y) of the plane to the plane through the source and one edge: sign of x * a + y * b + c.
struct EdgeFunction {
    double a, b, c;
    [[nodiscard]] double at(double x, double y) const { return a * x + b * y + c; }
};

/// det(from - source, to - from, p - from) times `sign`. Both triangles of an edge get the same, of opposite signs.
[[nodiscard]] EdgeFunction side_of_edge(const LocalSource& source, dvec3 from, dvec3 to, double sign);

/// A bound on the magnitudes of the points that may be asked: |x| + |y|, twice.
[[nodiscard]] double farthest(const Reach& reach);

/// By how much side_of_edge may be off at points whose magnitudes are `far` at most, if the ends may be off by `slack`.
[[nodiscard]] double doubt_of_side(const LocalSource& source, dvec3 from, dvec3 to, double far, double slack = 0);

/// A side of a shadow. A value of at most the magnitude `doubt` may have the wrong sign.
struct ShadowSide {
    EdgeFunction value{0, 0, 0};
    double doubt = 0;
};

/// The three sides of one of `run`'s shadows, positive inside, at points whose magnitudes are `far` at most. `source`
/// is the one that it was projected from.
[[nodiscard]] std::array<ShadowSide, 3> sides_of(const Scene& scene, const Receiver& receiver,
                                                 const LocalSource& source, const Shadows& run, const Shadow& shadow,
                                                 double far);

/// The first triangle whose shadow holds the point `at` of the plane, kNoTriangle where none does.
[[nodiscard]] TriangleId first_over(const Scene& scene, const Receiver& receiver, const LocalSource& source,
                                    std::span<const Shadows> runs, dvec2 at);

}  // namespace umbra::planar
