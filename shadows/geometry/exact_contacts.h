// The triangles that a segment to a hard light touches without crossing any of them, taken together: whether the
// segments to all lights that are close enough are blocked, or none, or only some.
//
// Seen along the segment, a touched triangle is a wedge around it: half a plane where an edge is met, less where a
// corner is. Two triangles of a surface that meet in an edge are two halves, and block together. The lights nearby
// disagree where some of the directions around the segment are covered and others are not: at a silhouette or a border.
//
// This work is based on:
// Herbert Edelsbrunner, Ernst Muecke. Simulation of Simplicity. 1990
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "umbra/shadows/geometry/exact_segment.h"

namespace umbra::exact_visibility {

class Contacts {
public:
    /// Refers to the segment.
    explicit Contacts(const Segment& segment);

    /// A triangle that the segment touches (Segment::meeting), and the fraction that it lets through, per channel.
    void add(vec3 x, vec3 y, vec3 z, vec3 passes);

    struct Together {
        vec3 passed;  ///< the fraction that arrives, per channel; where the lights nearby disagree, the most
        bool agreed;  ///< on it all lights that are close enough agree, and the segment begins on no triangle
    };
    [[nodiscard]] Together together() const;

private:
    /// A direction across the segment: a vector less its part along the segment.
    struct Across {
        Rational x, y;
    };
    /// Counterclockwise, by more than 0 and at most half a turn.
    struct Wedge {
        Across from, to;
    };
    struct Cover {
        Wedge wedge;
        vec3 passes;
    };
    using Corners = std::array<Rational3, 3>;

    [[nodiscard]] static Rational turn(const Across& a, const Across& b) { return a.x * b.y - a.y * b.x; }
    [[nodiscard]] static bool same_direction(const Across& a, const Across& b);
    [[nodiscard]] static bool comes_before(const Across& a, const Across& b);
    [[nodiscard]] static bool goes_on_within(const Across& ray, const Wedge& wedge);
    [[nodiscard]] static Wedge left_of(const Across& ray) { return {ray, {-ray.x, -ray.y}}; }
    [[nodiscard]] static std::optional<Wedge> common(const Wedge& a, const Wedge& b);
    [[nodiscard]] static Together around(std::span<const Cover> covers, const std::optional<Wedge>& domain);

    [[nodiscard]] Across across(const Rational3& v) const;
    [[nodiscard]] std::optional<Wedge> inside(const Corners& corner, std::array<bool, 3> is_zero) const;
    void add_at_start(const Corners& corner, const Rational3& normal, vec3 passes);

    const Segment& segment_;
    const Rational3 direction_;
    std::size_t axis_ = 0;         ///< one along which the direction is not 0
    std::vector<Cover> between_;   ///< touched between both ends
    std::vector<Cover> at_start_;  ///< touched by the surface point: they cover it as seen from within its own triangle
    bool begins_on_one_ = false, edge_on_ = false;
};

/// Adds a triangle that the segment touches; the first one makes the contacts.
inline void add_contact(std::optional<Contacts>& contacts, const Segment& segment, const Scene& scene, TriangleId t) {
    if (!contacts) contacts.emplace(segment);
    contacts->add(scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2), scene.lets_through(t));
}

}  // namespace umbra::exact_visibility
