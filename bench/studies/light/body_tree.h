// Rays against many bodies by formula: a tree of their bounds in Embree, the formulas in double.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "umbra/bench/studies/light/bodies.h"
#include "umbra/bench/studies/light/formula_bodies.h"

namespace umbra {

/// Where a line is inside a body; t in lengths of `direction`. See through_sphere and the others.
[[nodiscard]] Passages through_body(const Body& body, dvec3 origin, dvec3 direction);

/// The place on the body's surface that is nearest to a place close to it, and the unit normal there, outwards.
struct OnSurface {
    dvec3 position, normal;
};
[[nodiscard]] OnSurface onto_surface(const Body& body, dvec3 p);

/// A ray, in world space.
struct BodyRay {
    dvec3 origin{0}, direction{0, 0, 1};              ///< the latter unit
    std::uint32_t from = kNoBody;                     ///< on whose surface it starts: it meets that body where it
                                                      ///< leaves it, if it runs inwards, and else not at all
    double reach   = static_cast<double>(kInfinity);  ///< what is farther away is not met
    bool is_of_eye = false;                           ///< it passes through bodies that the camera does not see
};

/// What a ray meets first.
struct BodyMeeting {
    std::uint32_t body = kNoBody;  ///< none: it meets none
    double t           = 0;        ///< distance
};

/// Built once; all queries are const and may run from many threads at once. Rays ignore what is nearer to their start
/// than the rounding of double, for bodies whose surfaces coincide.
class BodyTree {
public:
    /// `lets_through`: one a body, the fraction of light that passes its surface once, per channel. `seen`: one a body,
    /// 0 where the camera does not see it; empty: it sees all. Throws std::runtime_error where Embree fails.
    BodyTree(std::vector<Body> bodies, std::vector<vec3> lets_through, std::vector<std::uint8_t> seen = {});
    ~BodyTree();

    [[nodiscard]] const Body& body(std::uint32_t b) const;

    /// The first surface that the ray crosses, entering the body or leaving it; of equal ones that of the lowest
    /// number.
    [[nodiscard]] BodyMeeting first(const BodyRay& ray) const;

    /// The fraction of light that all surfaces on the ray leave: their product; 1 without any.
    [[nodiscard]] dvec3 lets_through(const BodyRay& ray) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace umbra
